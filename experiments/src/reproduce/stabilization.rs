//! Fig. 3 of the paper: the law in continuous time under bounded noise, and Eq. (28) as printed.

use serde::Serialize;
use surepose::control::{HybridState, LocalLaw, NavigationVariables, Tran2012Law};
use surepose::geometry::{Angle, Body, Goal, Map, Pose};
use surepose::kinematics::{Integration, Twist};
use surepose_sim::{Seed, Stream};

use super::parking::PAPER_GOALS;

/// Simulation step \[s]; the paper's gains are for continuous time, so k_α·ΔT must be far below 1.
const STEP: f64 = 1e-3;

/// Duration of the simulation of each goal \[s].
const DURATION: f64 = 4.0;

/// Duration of the simulation of the local law \[s]; as printed, ρ grows like exp(k_v·t).
const LOCAL_DURATION: f64 = 0.5;

/// Bound of every disturbance: ε_ρ \[m], ε_α, ε_φ \[rad], ε_v \[m/s], ε_ω \[rad/s], [Tran2012] Sec. 5.1.
const NOISE: f64 = 0.001;

/// ε_P \[m], which the paper does not give: five times the noise bound.
const CAPTURE_RADIUS: f64 = 5.0 * NOISE;

/// Tolerance at the goal \[m, °], and duration before the end \[s].
const TOLERANCE: (f64, f64) = (0.01, 1.0);
const HOLD: f64 = 1.0;

/// Result of one goal, named as in the command line's JSON.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StabilizationFigures {
    /// Goal: x \[m], y \[m], heading \[°].
    pub goal: [f64; 3],
    /// Whether the robot was within 1 cm and 1° for the last second.
    pub reached: bool,
    /// Distance to the goal at the end.
    pub final_position_error_m: f64,
    /// Heading error at the end.
    pub final_heading_error_deg: f64,
}

/// A sample of a simulated motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LawSample {
    /// Time since the start.
    pub time_s: f64,
    /// Position.
    pub x_m: f64,
    /// Position.
    pub y_m: f64,
    /// Heading.
    pub heading_deg: f64,
    /// Speed.
    pub v_m_s: f64,
    /// Turn rate.
    pub omega_deg_s: f64,
    /// Distance to the goal.
    pub goal_distance_m: f64,
    /// Heading error.
    pub heading_error_deg: f64,
}

/// Figures and motion of one goal.
#[derive(Clone, Debug, PartialEq)]
pub struct StabilizedRun {
    /// Figures.
    pub figures: StabilizationFigures,
    /// The motion, one sample per millisecond.
    pub motion: Vec<LawSample>,
}

/// Drives to the paper's three goals from (0, 0, 0), with its gains and noise bounds.
///
/// # Departure
/// h, k_θ and ε_P are not given in print; (28) has its sign corrected. The noise is uniform between its
/// bounds.
pub fn stabilization(seed: u64) -> Vec<StabilizedRun> {
    let law = Tran2012Law {
        gains: surepose::control::Gains::tran2012(),
        capture_radius: CAPTURE_RADIUS,
        capture_heading: core::f64::consts::PI,
    };
    let noise = Seed(seed).stream("fig3");
    let stabilise = |goal: &[f64; 3]| {
        let start = Pose::identity();
        let mut memory = HybridState::new();
        let motion = simulate(start, *goal, DURATION, noise.clone(), |seen| {
            let output = law.compute(seen, memory);
            memory = output.state;
            output.twist
        });
        StabilizedRun { figures: judge(*goal, &motion), motion }
    };
    PAPER_GOALS.iter().map(stabilise).collect()
}

/// Simulates the local law from the edge of its domain: corrected, or as printed in (28).
///
/// As printed the robot diverges from the goal; as corrected its distance never increases.
pub fn local_law(as_printed: bool) -> Vec<LawSample> {
    let gains = surepose::control::Gains::tran2012();
    let corrected = LocalLaw { k_v: gains.k_v, k_theta: gains.k_theta };
    let law = if as_printed { corrected.as_printed() } else { corrected };
    let [x, y, heading] = PAPER_GOALS[0];
    let start = Pose::new(x - 0.8 * CAPTURE_RADIUS, y, Angle::from_degrees(heading));
    simulate(start, PAPER_GOALS[0], LOCAL_DURATION, Seed(0).stream("fig3"), |seen| law.twist(seen))
}

/// Simulates `law` with bounded noise on both measurement and motion.
fn simulate(
    start: Pose<Map, Body, f64>,
    [x, y, heading]: [f64; 3],
    duration: f64,
    mut noise: Stream,
    mut law: impl FnMut(&NavigationVariables<f64>) -> Twist<f64>,
) -> Vec<LawSample> {
    let goal: Pose<Map, Goal, f64> = Pose::new(x, y, Angle::from_degrees(heading));
    let mut pose = start;
    let mut disturbance = || noise.uniform(-NOISE, NOISE);
    let mut moment = |k: usize| {
        let actual = NavigationVariables::from_poses(pose, goal);
        let seen = NavigationVariables {
            rho: actual.rho + disturbance(),
            alpha: actual.alpha.rotated_by(disturbance()),
            phi: actual.phi.rotated_by(disturbance()),
        };
        let desired = law(&seen);
        let instant = LawSample {
            time_s: k as f64 * STEP,
            x_m: pose.x,
            y_m: pose.y,
            heading_deg: pose.heading.degrees(),
            v_m_s: desired.v,
            omega_deg_s: desired.omega.to_degrees(),
            goal_distance_m: actual.rho,
            heading_error_deg: actual.heading_error().degrees(),
        };
        let twist = Twist::new(desired.v + disturbance(), desired.omega + disturbance());
        pose = pose.integrate(twist.integrate_for(STEP), Integration::Arc);
        instant
    };
    (0..(duration / STEP) as usize).map(&mut moment).collect()
}

fn judge(goal: [f64; 3], motion: &[LawSample]) -> StabilizationFigures {
    let inside = |instant: &&LawSample| {
        instant.goal_distance_m < TOLERANCE.0 && instant.heading_error_deg.abs() < TOLERANCE.1
    };
    let inside_for = motion.iter().rev().take_while(inside).count() as f64 * STEP;
    let end = motion.last();
    StabilizationFigures {
        goal,
        reached: inside_for >= HOLD,
        final_position_error_m: end.map_or(f64::INFINITY, |end| end.goal_distance_m),
        final_heading_error_deg: end.map_or(f64::INFINITY, |end| end.heading_error_deg.abs()),
    }
}

#[cfg(test)]
mod tests {
    use super::{CAPTURE_RADIUS, local_law, stabilization};

    #[test]
    fn papers_three_goals_are_reached_under_its_noise() {
        for stabilised in stabilization(1) {
            let figures = stabilised.figures;
            assert!(figures.reached, "{figures:?}");
            assert!(figures.final_position_error_m < 0.01, "{figures:?}");
            assert!(figures.final_heading_error_deg < 1.0, "{figures:?}");
        }
    }

    /// The sign error of [Tran2012] Eq. (27), (28), as a motion.
    #[test]
    fn the_printed_local_law_diverges_and_the_corrected_one_does_not() {
        let farthest = |printed: bool| {
            local_law(printed).iter().map(|instant| instant.goal_distance_m).fold(0.0, f64::max)
        };
        assert!(farthest(false) < CAPTURE_RADIUS, "{}", farthest(false));
        assert!(farthest(true) > 0.1, "{}", farthest(true));
    }
}
