//! Fig. 7 of the paper: the complete robot parks at three goals.

use serde::Serialize;
use surepose::param;
use surepose_config::Config;
use surepose_sim::robot::Scenario;
use surepose_sim::simulation::{Sample, Simulation, SimulationOutcome};

/// Goals of [Tran2012] Sec. 5, (x \[m], y \[m], heading \[°]); the start is (0, 0, 0).
pub const PAPER_GOALS: [[f64; 3]; 3] = [[2.0, 2.0, 30.0], [2.0, 2.0, 60.0], [2.0, 2.0, 90.0]];

/// Observation time after arrival at the goal \[s].
const WATCHED: f64 = 3.0;

/// Result of one goal, named as in the command line's JSON.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GoalFigures {
    /// Goal: x \[m], y \[m], heading \[°].
    pub goal: [f64; 3],
    /// Whether the true pose came to rest at the goal.
    pub reached: bool,
    /// True distance to the goal at the end.
    pub final_position_error_m: f64,
    /// True heading error at the end.
    pub final_heading_error_deg: f64,
    /// Maximum true speed during the observation at the goal.
    pub final_speed_m_s: f64,
    /// Maximum true turn rate during the observation at the goal.
    pub final_turn_rate_deg_s: f64,
}

/// Figures and samples of one goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Parked {
    /// Figures.
    pub figures: GoalFigures,
    /// Samples of the drive and of three seconds at the goal.
    pub samples: Vec<Sample>,
}

/// Drives the complete simulated robot of `config` to the paper's three goals in its arena.
pub fn parking(config: &Config, seed: u64) -> Vec<Parked> {
    PAPER_GOALS.iter().map(|goal| park(config, *goal, seed)).collect()
}

fn park(config: &Config, goal: [f64; 3], seed: u64) -> Parked {
    let [x, y, heading] = goal;
    let values = [
        (&param::START_X, 0.0),
        (&param::START_Y, 0.0),
        (&param::START_HEADING, 0.0),
        (&param::GOAL_X, x),
        (&param::GOAL_Y, y),
        (&param::GOAL_HEADING, heading),
    ];
    let config = config.clone().with_preset("fig7", &values);
    let period = config.number(&param::PERIOD);
    let mut simulation = Simulation::new(&Scenario { config, ..Scenario::default() }, seed);
    let mut samples: Vec<Sample> = simulation.by_ref().collect();
    let reached = simulation.summary().outcome == SimulationOutcome::Reached;

    let watched: Vec<Sample> = (0..(WATCHED / period).ceil() as usize).map(|_| simulation.tick()).collect();
    let largest = |value: fn(&Sample) -> f64| watched.iter().map(|s| value(s).abs()).fold(0.0, f64::max);
    let end = simulation.summary();
    let figures = GoalFigures {
        goal,
        reached,
        final_position_error_m: end.final_position_error_m,
        final_heading_error_deg: end.final_heading_error_deg,
        final_speed_m_s: largest(|sample| sample.v_m_s),
        final_turn_rate_deg_s: largest(|sample| sample.omega_deg_s),
    };
    samples.extend(watched);
    Parked { figures, samples }
}

#[cfg(test)]
mod tests {
    use surepose_config::Config;

    use super::parking;

    #[test]
    fn all_three_goals_are_reached_and_held() {
        for parked in parking(&Config::default(), 1) {
            let figures = parked.figures;
            assert!(figures.reached, "{figures:?}");
            assert!(figures.final_position_error_m <= 0.01, "{figures:?}");
            assert!(figures.final_heading_error_deg <= 1.0, "{figures:?}");
            assert!(figures.final_speed_m_s <= 0.0, "{figures:?}");
            assert!(figures.final_turn_rate_deg_s <= 0.0, "{figures:?}");
            let fastest = parked.samples.iter().map(|s| s.v_m_s.abs()).fold(0.0, f64::max);
            assert!(fastest > 0.25, "maximum speed: {fastest} m/s");
        }
    }

    #[test]
    fn a_goal_reached_only_by_the_estimate_is_not_reached() {
        let config = ["laser.beams=2", "compass.std_deg=180"]
            .into_iter()
            .fold(Config::default(), |config, option| config.with_option(option).unwrap());
        let all = parking(&config, 1);
        for figures in all.iter().map(|parked| parked.figures) {
            let there = figures.final_position_error_m <= 0.01 && figures.final_heading_error_deg <= 1.0;
            assert_eq!(figures.reached, there, "{figures:?}");
        }
        assert!(all.iter().any(|parked| !parked.figures.reached));
    }
}
