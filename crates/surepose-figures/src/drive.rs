//! Pictures of one drive: path, walls and time series.

use core::f64::consts::TAU;

use surepose::param;
use surepose_sim::robot::Scenario;
use surepose_sim::simulation::{ControlMode, Sample};

use crate::plot::{Color, MapPlot, Mark, Panel, Picture, Stroke, Subplot, XyPlot, hstack, hstack_column};

/// Interval between two ellipses \[s].
const ELLIPSE_EVERY: f64 = 1.0;
/// Size of three standard deviations that is visible on a map of several meters \[m].
const VISIBLE: f64 = 0.06;
/// Half the side of the window around the goal \[m].
const WINDOW: f64 = 0.03;

/// Draws path, walls, start and goal, and the last centimeters with the tolerance.
pub fn trajectory(scenario: &Scenario, samples: &[Sample]) -> Picture {
    hstack(vec![from_above(scenario, samples).cell(), at_the_goal(scenario, samples)])
}

/// Draws v and ω, commanded and true.
pub fn velocities(samples: &[Sample]) -> Picture {
    XyPlot::over("time [s]")
        .panel(speeds(Panel::new("Speed", "v [m/s]"), samples, ["commanded", "true"]))
        .panel(turn_rate(samples))
        .picture()
}

/// Draws heading error and distance to the goal.
pub fn heading_error(scenario: &Scenario, samples: &[Sample]) -> Picture {
    XyPlot::over("time [s]").panel(heading(scenario, samples)).panel(distance(scenario, samples)).picture()
}

/// Draws V of the active law and the switches between laws.
pub fn lyapunov(samples: &[Sample]) -> Picture {
    let title = "V_g of the global law; shaded: V_l of the local law; dashed: switch, arrival";
    XyPlot::over("time [s]").panel(descent(title, samples)).picture()
}

/// Draws an overview that fits a text column; panel titles replace legends.
pub fn overview(scenario: &Scenario, samples: &[Sample]) -> Picture {
    let chart = XyPlot::over("time [s]")
        .compact()
        .panel(speeds(Panel::new("Speed: true (blue), commanded (gray)", "v [m/s]"), samples, ["", ""]))
        .panel(heading(scenario, samples))
        .panel(descent("V; shaded: local law; dashed: switch, arrival", samples));
    hstack_column(from_above(scenario, samples).compact().cell(), chart.cells())
}

/// Returns the scale factor of ellipses: a standard deviation of millimeters is otherwise invisible on a map
/// of meters.
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
    let label = if factor > 1.0 {
        format!("3σ × {factor}, one per second")
    } else {
        "3σ, one per second".to_owned()
    };
    let here = |sample: &Sample| (sample.estimated_x_m, sample.estimated_y_m);
    let ellipses = shown.into_iter().map(|sample| ellipse(sample, here(sample), 3.0 * factor)).collect();
    MapPlot::new("From start to goal")
        .walls(walls(scenario))
        .trace("true path", true_way(samples), Stroke::wide(Color::Silver))
        .trace("estimated path", estimated_way(samples), Stroke::thin(Color::Vermilion))
        .outlines(label, ellipses, Stroke::thin(Color::Blue))
        .pose("start", (start.x, start.y), start.heading.radians(), Color::Green)
        .pose("goal", (goal.x, goal.y), goal.heading.radians(), Color::Purple)
}

/// Draws the neighborhood of the goal, relative to the goal.
fn at_the_goal(scenario: &Scenario, samples: &[Sample]) -> Subplot {
    let goal = scenario.goal();
    let from_goal =
        |points: Vec<(f64, f64)>| points.into_iter().map(|(x, y)| (x - goal.x, y - goal.y)).collect();
    let tolerance = scenario.config.number(&param::POSITION_TOLERANCE);
    let circle = turn().map(|(cos, sin)| (tolerance * cos, tolerance * sin)).collect();
    let mut map = MapPlot::new("The last centimeters")
        .outlines("tolerance", vec![circle], Stroke::solid(Color::Purple))
        .trace("true path", from_goal(true_way(samples)), Stroke::wide(Color::Silver))
        .trace("estimated path", from_goal(estimated_way(samples)), Stroke::thin(Color::Vermilion));
    let here = |sample: &Sample| (sample.estimated_x_m - goal.x, sample.estimated_y_m - goal.y);
    let near = every(samples, ELLIPSE_EVERY).into_iter().chain(samples.last());
    let near = near.filter(|sample| here(sample).0.abs().max(here(sample).1.abs()) < WINDOW);
    let ellipses = near.map(|sample| ellipse(sample, here(sample), 3.0)).collect();
    map = map.outlines("3σ, one per second", ellipses, Stroke::thin(Color::Blue));
    if let Some(end) = samples.last() {
        let at = (end.x_m - goal.x, end.y_m - goal.y);
        map = map.pose("true pose at the end", at, end.heading_deg.to_radians(), Color::Black);
    }
    map.pose("goal", (0.0, 0.0), goal.heading.radians(), Color::Purple)
        .window((-WINDOW, -WINDOW), (WINDOW, WINDOW))
        .axes(1000.0, "x from the goal [mm]", "y from the goal [mm]")
        .cell()
}

fn speeds(panel: Panel, samples: &[Sample], [commanded, actual]: [&str; 2]) -> Panel {
    panel
        .series(commanded, over(samples, |s| s.commanded_v_m_s), Stroke::wide(Color::Silver))
        .series(actual, over(samples, |s| s.v_m_s), Stroke::solid(Color::Blue))
        .marks([Mark::Level(0.0)])
}

fn turn_rate(samples: &[Sample]) -> Panel {
    Panel::new("Turn rate", "ω [°/s]")
        .series("commanded", over(samples, |s| s.commanded_omega_deg_s), Stroke::wide(Color::Silver))
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

/// Returns the intervals in which V is V_l. They include the holding time: the active law counts, not the
/// mode.
fn local_law_intervals(samples: &[Sample]) -> Vec<(f64, f64)> {
    stretches(samples, |sample| sample.local)
}

fn descent(title: &str, samples: &[Sample]) -> Panel {
    let local = local_law_intervals(samples);
    let holding = stretches(samples, |sample| sample.mode == ControlMode::Holding);
    // The title explains the marks: near the end of the drive there is no room for labels.
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

/// Unwraps angles \[°].
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

/// Returns the time intervals in which `condition` holds.
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

/// Returns one sample per `seconds`.
fn every(samples: &[Sample], seconds: f64) -> Vec<&Sample> {
    let mut next = seconds;
    let due = |sample: &&Sample| {
        let due = sample.time_s >= next;
        next = if due { next + seconds } else { next };
        due
    };
    samples.iter().filter(due).collect()
}

/// Returns three standard deviations of the less certain coordinate \[m].
fn spread(sample: &Sample) -> f64 {
    3.0 * sample.variance_x_m2.max(sample.variance_y_m2).max(0.0).sqrt()
}

/// Returns the contour of `sigmas` standard deviations around (x, y).
fn ellipse(sample: &Sample, (x, y): (f64, f64), sigmas: f64) -> Vec<(f64, f64)> {
    // With P = L Lᵀ the contour is L·(cos, sin).
    let l11 = sample.variance_x_m2.max(0.0).sqrt();
    let l21 = if l11 > 0.0 { sample.covariance_xy_m2 / l11 } else { 0.0 };
    let l22 = (sample.variance_y_m2 - l21 * l21).max(0.0).sqrt();
    turn().map(|(cos, sin)| (x + sigmas * l11 * cos, y + sigmas * (l21 * cos + l22 * sin))).collect()
}

/// Returns cosines and sines of a full circle.
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

    /// V_l is plotted from the switch to the end of the drive, including the holding time.
    #[test]
    fn shading_covers_the_whole_time_of_the_local_law() {
        let (samples, _) = simulate(&Scenario::default(), 1);
        let local = local_law_intervals(&samples);
        let holding = stretches(&samples, |sample| sample.mode == ControlMode::Holding);
        let (Some(last), Some(end), Some(held)) = (local.last(), samples.last(), holding.last()) else {
            panic!("{local:?}, {holding:?}");
        };
        assert!(last.0 < held.0 && held.1 >= end.time_s && last.1 >= end.time_s, "{local:?}, {holding:?}");
        // V jumps where the laws switch; elsewhere it never grows by a half.
        for pair in samples.windows(2) {
            assert!(pair[0].local != pair[1].local || pair[1].lyapunov < 1.5 * pair[0].lyapunov + 1e-4);
        }
    }

    /// In a README column of 830 px the scale is at least 0.8, so that 12 px letters are at least 9 px.
    #[test]
    fn overview_fits_a_readme_column() {
        let scenario = Scenario::default();
        let svg = overview(&scenario, &simulate(&scenario, 1).0).svg();
        let width = svg.split("width=\"").nth(1).and_then(|rest| rest.split('"').next());
        let width: f64 = width.and_then(|width| width.parse().ok()).expect("a width");
        assert!(width <= 830.0 / 0.8, "{width}");
        assert!(svg.contains("dashed: switch, arrival"));
    }
}
