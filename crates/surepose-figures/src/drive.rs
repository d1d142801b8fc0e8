//! One drive: its way with the walls, and what happened over time.

use core::f64::consts::TAU;

use surepose::param;
use surepose_sim::robot::Scenario;
use surepose_sim::simulation::{ControlMode, Sample};

use crate::plot::{Color, MapPlot, Mark, Panel, Picture, Stroke, Subplot, XyPlot, hstack, hstack_column};

/// Time between two ellipses \[s].
const ELLIPSE_EVERY: f64 = 1.0;
/// Three standard deviations that can be seen on a map of metres \[m].
const VISIBLE: f64 = 0.06;
/// Half the side of the window around the goal \[m].
const WINDOW: f64 = 0.03;

/// The way with the walls, start and goal; and the last centimetres, with the tolerance.
pub fn trajectory(scenario: &Scenario, samples: &[Sample]) -> Picture {
    hstack(vec![from_above(scenario, samples).cell(), at_the_goal(scenario, samples)])
}

/// v and ω, asked and true.
pub fn velocities(samples: &[Sample]) -> Picture {
    XyPlot::over("time [s]")
        .panel(speeds(Panel::new("Speed", "v [m/s]"), samples, ["asked", "true"]))
        .panel(turn_rate(samples))
        .picture()
}

/// Heading error and distance from the goal.
pub fn heading_error(scenario: &Scenario, samples: &[Sample]) -> Picture {
    XyPlot::over("time [s]").panel(heading(scenario, samples)).panel(distance(scenario, samples)).picture()
}

/// V of the law in charge, with the changes of law.
pub fn lyapunov(samples: &[Sample]) -> Picture {
    let title = "V_g of the global law; shaded: V_l of the local law; dashed: hand-over, arrival";
    XyPlot::over("time [s]").panel(descent(title, samples)).picture()
}

/// The drive at one glance, small enough for a column of text; titles say what is what, so that legends take no room.
pub fn overview(scenario: &Scenario, samples: &[Sample]) -> Picture {
    let chart = XyPlot::over("time [s]")
        .compact()
        .panel(speeds(Panel::new("Speed: true (blue), asked (grey)", "v [m/s]"), samples, ["", ""]))
        .panel(heading(scenario, samples))
        .panel(descent("V; shaded: local law; dashed: hand-over, arrival", samples));
    hstack_column(from_above(scenario, samples).compact().cell(), chart.cells())
}

/// How many times ellipses are enlarged on a map of the whole way: a laser knows the place to millimetres, and on a map of
/// metres that is nothing to see.
pub(super) fn enlargement(samples: &[Sample]) -> f64 {
    let mut quantile_plots: Vec<f64> = every(samples, ELLIPSE_EVERY).into_iter().map(spread).collect();
    quantile_plots.sort_by(f64::total_cmp);
    let typical = quantile_plots.get(quantile_plots.len() / 2).copied().unwrap_or(VISIBLE);
    [1.0, 10.0, 30.0].into_iter().find(|factor| typical * factor >= VISIBLE).unwrap_or(30.0)
}

fn from_above(scenario: &Scenario, samples: &[Sample]) -> MapPlot {
    let (start, goal) = (scenario.start(), scenario.goal());
    let shown = every(samples, ELLIPSE_EVERY);
    let factor = enlargement(samples);
    let label =
        if factor > 1.0 { format!("3σ × {factor}, each second") } else { "3σ, each second".to_owned() };
    let here = |sample: &Sample| (sample.estimated_x_m, sample.estimated_y_m);
    let ellipses = shown.into_iter().map(|sample| ellipse(sample, here(sample), 3.0 * factor)).collect();
    MapPlot::new("From start to goal")
        .walls(walls(scenario))
        .trace("true way", true_way(samples), Stroke::wide(Color::Silver))
        .trace("estimated way", estimated_way(samples), Stroke::thin(Color::Vermilion))
        .outlines(label, ellipses, Stroke::thin(Color::Blue))
        .pose("start", (start.x, start.y), start.heading.radians(), Color::Green)
        .pose("goal", (goal.x, goal.y), goal.heading.radians(), Color::Purple)
}

/// The neighbourhood of the goal, seen from it.
fn at_the_goal(scenario: &Scenario, samples: &[Sample]) -> Subplot {
    let goal = scenario.goal();
    let from_goal =
        |points: Vec<(f64, f64)>| points.into_iter().map(|(x, y)| (x - goal.x, y - goal.y)).collect();
    let tolerance = scenario.config.number(&param::POSITION_TOLERANCE);
    let circle = turn().map(|(cos, sin)| (tolerance * cos, tolerance * sin)).collect();
    let mut map = MapPlot::new("The last centimetres")
        .outlines("tolerance", vec![circle], Stroke::solid(Color::Purple))
        .trace("true way", from_goal(true_way(samples)), Stroke::wide(Color::Silver))
        .trace("estimated way", from_goal(estimated_way(samples)), Stroke::thin(Color::Vermilion));
    let here = |sample: &Sample| (sample.estimated_x_m - goal.x, sample.estimated_y_m - goal.y);
    let near = every(samples, ELLIPSE_EVERY).into_iter().chain(samples.last());
    let near = near.filter(|sample| here(sample).0.abs().max(here(sample).1.abs()) < WINDOW);
    let ellipses = near.map(|sample| ellipse(sample, here(sample), 3.0)).collect();
    map = map.outlines("3σ, each second", ellipses, Stroke::thin(Color::Blue));
    if let Some(end) = samples.last() {
        let at = (end.x_m - goal.x, end.y_m - goal.y);
        map = map.pose("true pose at the end", at, end.heading_deg.to_radians(), Color::Black);
    }
    map.pose("goal", (0.0, 0.0), goal.heading.radians(), Color::Purple)
        .window((-WINDOW, -WINDOW), (WINDOW, WINDOW))
        .axes(1000.0, "x from the goal [mm]", "y from the goal [mm]")
        .cell()
}

fn speeds(panel: Panel, samples: &[Sample], [asked, actual]: [&str; 2]) -> Panel {
    panel
        .series(asked, over(samples, |s| s.commanded_v_m_s), Stroke::wide(Color::Silver))
        .series(actual, over(samples, |s| s.v_m_s), Stroke::solid(Color::Blue))
        .marks([Mark::Level(0.0)])
}

fn turn_rate(samples: &[Sample]) -> Panel {
    Panel::new("Turn rate", "ω [°/s]")
        .series("asked", over(samples, |s| s.commanded_omega_deg_s), Stroke::wide(Color::Silver))
        .series("true", over(samples, |s| s.omega_deg_s), Stroke::solid(Color::Blue))
        .marks([Mark::Level(0.0)])
}

fn heading(scenario: &Scenario, samples: &[Sample]) -> Panel {
    let tolerance = scenario.config.number(&param::HEADING_TOLERANCE).to_degrees();
    Panel::new("True heading error; dashed: tolerance", "θ error [°]")
        .series("", unwrapped(over(samples, |s| s.heading_error_deg)), Stroke::solid(Color::Blue))
        .marks([Mark::Level(tolerance), Mark::Level(-tolerance)])
}

fn distance(scenario: &Scenario, samples: &[Sample]) -> Panel {
    Panel::new("True distance from the goal; dashed: tolerance", "ρ [m]")
        .series("", over(samples, |s| s.goal_distance_m), Stroke::solid(Color::Blue))
        .marks([Mark::Level(scenario.config.number(&param::POSITION_TOLERANCE))])
        .logarithmic()
}

/// When V is V_l. It goes on falling while the robot holds: it is the law that counts, not the mode.
fn local_law_intervals(samples: &[Sample]) -> Vec<(f64, f64)> {
    stretches(samples, |sample| sample.local)
}

fn descent(title: &str, samples: &[Sample]) -> Panel {
    let local = local_law_intervals(samples);
    let holding = stretches(samples, |sample| sample.mode == ControlMode::Holding);
    // What the marks are is said in the title: beside them, near the end of the drive, there is no room for it.
    let marks =
        [local.first(), holding.first()].map(|found| found.map(|(at, _)| Mark::At(*at, String::new())));
    Panel::new(title, "V")
        .series("", over(samples, |s| s.lyapunov), Stroke::solid(Color::Green))
        .shaded(local, Color::Sky)
        .marks(marks.into_iter().flatten())
        .logarithmic()
}

fn over(samples: &[Sample], value: impl Fn(&Sample) -> f64) -> Vec<(f64, f64)> {
    samples.iter().map(|sample| (sample.time_s, value(sample))).collect()
}

/// The same angles \[°] without jumps by a turn.
pub fn unwrapped(mut series: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut before: Option<f64> = None;
    for (_, angle) in &mut series {
        if let Some(before) = before {
            *angle -= 360.0 * ((*angle - before) / 360.0).round();
        }
        before = Some(*angle);
    }
    series
}

/// From when to when the samples were such.
fn stretches(samples: &[Sample], condition: impl Fn(&Sample) -> bool) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    let mut inside = false;
    for sample in samples {
        let now = condition(sample);
        match found.last_mut() {
            Some(last) if inside => last.1 = sample.time_s,
            _ if now => found.push((sample.time_s, sample.time_s)),
            _ => {}
        }
        inside = now;
    }
    found
}

/// Every so many seconds a sample.
fn every(samples: &[Sample], seconds: f64) -> Vec<&Sample> {
    let mut next = seconds;
    let due = |sample: &&Sample| {
        let due = sample.time_s >= next;
        next = if due { next + seconds } else { next };
        due
    };
    samples.iter().filter(due).collect()
}

/// Three standard deviations of the worse coordinate \[m].
fn spread(sample: &Sample) -> f64 {
    3.0 * sample.variance_x_m2.max(sample.variance_y_m2).max(0.0).sqrt()
}

/// The contour of so many standard deviations around (x, y).
fn ellipse(sample: &Sample, (x, y): (f64, f64), sigmas: f64) -> Vec<(f64, f64)> {
    // With P = L Lᵀ the contour is L·(cos, sin).
    let l11 = sample.variance_x_m2.max(0.0).sqrt();
    let l21 = if l11 > 0.0 { sample.covariance_xy_m2 / l11 } else { 0.0 };
    let l22 = (sample.variance_y_m2 - l21 * l21).max(0.0).sqrt();
    turn().map(|(cos, sin)| (x + sigmas * l11 * cos, y + sigmas * (l21 * cos + l22 * sin))).collect()
}

/// Cosines and sines once round.
fn turn() -> impl Iterator<Item = (f64, f64)> {
    (0..=48).map(|i| f64::from(i) * TAU / 48.0).map(|angle| (angle.cos(), angle.sin()))
}

/// The walls of the arena, each as its two end points \[m].
pub fn walls(scenario: &Scenario) -> Vec<[(f64, f64); 2]> {
    let segments = scenario.arena.walls().iter();
    segments.map(|wall| [(wall.start.x, wall.start.y), (wall.end.x, wall.end.y)]).collect()
}

/// The true positions along the samples \[m].
pub fn true_way(samples: &[Sample]) -> Vec<(f64, f64)> {
    samples.iter().map(|sample| (sample.x_m, sample.y_m)).collect()
}

fn estimated_way(samples: &[Sample]) -> Vec<(f64, f64)> {
    samples.iter().map(|sample| (sample.estimated_x_m, sample.estimated_y_m)).collect()
}

#[cfg(test)]
mod tests {
    use surepose_sim::robot::Scenario;
    use surepose_sim::simulation::{ControlMode, simulate};

    use super::{local_law_intervals, overview, stretches};

    /// The V that is drawn is V_l from the switch to the end of the drive, which the robot spends holding.
    #[test]
    fn shading_covers_all_of_the_local_law() {
        let (samples, _) = simulate(&Scenario::default(), 1);
        let local = local_law_intervals(&samples);
        let holding = stretches(&samples, |sample| sample.mode == ControlMode::Holding);
        let (Some(last), Some(end), Some(held)) = (local.last(), samples.last(), holding.last()) else {
            panic!("{local:?}, {holding:?}");
        };
        assert!(last.0 < held.0 && held.1 >= end.time_s && last.1 >= end.time_s, "{local:?}, {holding:?}");
        // Where V changes from one law's to the other's it jumps, and nowhere else does it grow by a half.
        for pair in samples.windows(2) {
            assert!(pair[0].local != pair[1].local || pair[1].lyapunov < 1.5 * pair[0].lyapunov + 1e-4);
        }
    }

    /// In a README's column of 830 px nothing is drawn smaller than at four fifths: letters of 12 px stay above 9.
    #[test]
    fn overview_is_no_wider_than_can_be_read_in_a_column() {
        let scenario = Scenario::default();
        let svg = overview(&scenario, &simulate(&scenario, 1).0).svg();
        let width = svg.split("width=\"").nth(1).and_then(|rest| rest.split('"').next());
        let width: f64 = width.and_then(|width| width.parse().ok()).expect("a width");
        assert!(width <= 830.0 / 0.8, "{width}");
        assert!(svg.contains("dashed: hand-over, arrival"));
    }
}
