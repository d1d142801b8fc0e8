//! Pictures of a sweep: results over the start poses, and histograms.

use core::f64::consts::{PI, TAU};

use surepose::control::NavigationVariables;
use surepose::geometry::{Angle, Body, Goal, Map as MapFrame, Pose};
use surepose_montecarlo::sweep::{HEADING_TOLERANCE, POSITION_TOLERANCE, Quantiles, Trial};

use crate::plot::{
    Color, DotPaint, Heatmap, HeatmapCell, MapPlot, Panel, Picture, Scale, Stroke, Subplot, XyPlot, hstack,
    vstack,
};

/// Number of trials below which each is a dot; above, trials are binned into cells.
const CROWD: usize = 400;
/// Mean number of trials per cell, and the range of cells per side.
const PER_CELL: f64 = 15.0;
const SIDES: (f64, f64) = (8.0, 60.0);
/// Ratio of a square's side to the extent of its contents.
const MARGIN: f64 = 1.02;
/// Number of bars of a histogram.
const BARS: usize = 60;
/// Maximum error shown, in tolerances.
const TOLERANCES_SHOWN: f64 = 3.0;

const FAILED: Color = Color::Vermilion;

/// Draws success and time over the start position, and time over the directions of start and goal.
pub fn start_map(trials: &[Trial]) -> Picture {
    let places: Vec<_> = trials.iter().map(|trial| (trial.start_x_m, trial.start_y_m)).collect();
    let directions: Vec<_> = trials.iter().map(directions).collect();
    let plane = square_around(&places);
    let circle = Square { low: (-PI, -PI), side: TAU };

    let successes: Vec<_> = trials.iter().map(|trial| Some(if trial.success { 1.0 } else { 0.0 })).collect();
    let success = Shown::of(&places, &successes, plane, mean);
    let ratios: Vec<_> = trials.iter().map(Trial::time_ratio).collect();
    let by_place = Shown::of(&places, &ratios, plane, median);
    let by_direction = Shown::of(&directions, &ratios, circle, median);

    let rate = Scale::new("successful trials [%]", 0.0, 1.0).times(100.0);
    // One scale for both, for comparison.
    let medians: Vec<f64> = by_place.values().into_iter().chain(by_direction.values()).collect();
    let (ratio, most) = ratio_scale(medians, trials.len() >= CROWD);
    let timed = MapPlot::new(format!("Time / optimal time; darkest: {} or more", short(most)));
    let failed = |at: &[(f64, f64)]| -> Vec<_> {
        at.iter().zip(trials).filter(|(_, trial)| !trial.success).map(|(at, _)| *at).collect()
    };
    let ran = trials.iter().filter(|trial| trial.success).count();
    let title = format!("Success over the start: {ran} of {}", counted(trials.len()));
    let directed = MapPlot::new("Time / optimal time over the directions at the start")
        .axes(1f64.to_degrees(), "bearing of the goal α [°]", "direction of approach φ [°]")
        .numbered_every(45.0);
    hstack(vec![
        success.drawn(MapPlot::new(title), rate, failed(&places)),
        by_place.drawn(timed, ratio.clone(), failed(&places)),
        by_direction.drawn(directed, ratio, failed(&directions)),
    ])
}

/// Draws the distributions of time and final errors.
pub fn quantile_plots(trials: &[Trial]) -> Picture {
    let all = |value: fn(&Trial) -> Option<f64>| trials.iter().filter_map(value).collect::<Vec<_>>();
    let tolerances = |tolerance: f64| TOLERANCES_SHOWN * tolerance;
    let (position, heading) = (1e3 * POSITION_TOLERANCE, HEADING_TOLERANCE.to_degrees());
    vstack(vec![
        histogram("Time / optimal time", ("time / optimal time", ""), &all(Trial::time_ratio), 1.0, None),
        histogram(
            "Final distance",
            ("final position error [mm]", " mm"),
            &all(|trial| Some(1e3 * trial.final_position_error_m)),
            0.0,
            Some((position, tolerances(position))),
        ),
        histogram(
            "Final heading error",
            ("final heading error [°]", "°"),
            &all(|trial| Some(trial.final_heading_error_deg)),
            0.0,
            Some((heading, tolerances(heading))),
        ),
    ])
}

/// Returns bearing of the goal and direction of approach at the start \[rad].
fn directions(trial: &Trial) -> (f64, f64) {
    let heading = Angle::from_degrees(trial.start_heading_deg);
    let start: Pose<MapFrame, Body, f64> = Pose::new(trial.start_x_m, trial.start_y_m, heading);
    let goal: Pose<MapFrame, Goal, f64> = Pose::identity();
    let seen = NavigationVariables::from_poses(start, goal);
    (seen.alpha.radians(), seen.phi.radians())
}

/// A square in a plane.
#[derive(Clone, Copy)]
struct Square {
    low: (f64, f64),
    side: f64,
}

/// Values over a square.
enum Shown {
    /// A statistic of each cell.
    Cells(Heatmap),
    /// Individual values.
    Dots(Square, Vec<(f64, f64)>, Vec<f64>),
}

impl Shown {
    /// Shows each of `values` at its place; if there are many, the `summary` of each cell.
    fn of(
        places: &[(f64, f64)],
        values: &[Option<f64>],
        square: Square,
        summary: fn(&mut [f64]) -> f64,
    ) -> Self {
        let known = places.iter().zip(values).filter_map(|(at, value)| value.map(|value| (*at, value)));
        if places.len() < CROWD {
            let (places, values) = known.unzip();
            return Self::Dots(square, places, values);
        }
        let Square { low, side } = square;
        let columns = (places.len() as f64 / PER_CELL).sqrt().floor().clamp(SIDES.0, SIDES.1);
        let cell = side / columns;
        let columns = columns as usize;
        let cell_of = |(x, y): (f64, f64)| {
            let at = |value: f64, low: f64| (((value - low) / cell) as usize).min(columns - 1);
            at(y, low.1) * columns + at(x, low.0)
        };
        let mut lists = vec![Vec::new(); columns * columns];
        let mut cells = vec![HeatmapCell::Nothing; columns * columns];
        for place in places {
            if let Some(tile) = cells.get_mut(cell_of(*place)) {
                *tile = HeatmapCell::Plain(FAILED);
            }
        }
        for (place, value) in known {
            if let Some(list) = lists.get_mut(cell_of(place)) {
                list.push(value);
            }
        }
        for (tile, list) in cells.iter_mut().zip(&mut lists).filter(|(_, list)| !list.is_empty()) {
            *tile = HeatmapCell::Value(summary(list));
        }
        Self::Cells(Heatmap { low, side: cell, columns, cells })
    }

    fn values(&self) -> Vec<f64> {
        match self {
            Self::Dots(_, _, values) => values.clone(),
            Self::Cells(heatmap) => {
                let value = |tile: &HeatmapCell| {
                    if let HeatmapCell::Value(value) = tile { Some(*value) } else { None }
                };
                heatmap.cells.iter().filter_map(value).collect()
            }
        }
    }

    /// Adds the values to `map`, with the trials that `failed` if they are drawn individually.
    fn drawn(self, map: MapPlot, scale: Scale, failed: Vec<(f64, f64)>) -> Subplot {
        let map = map.scale(scale);
        let map = match self {
            Self::Cells(heatmap) => {
                let none = heatmap.cells.contains(&HeatmapCell::Plain(FAILED));
                map.heatmap(heatmap, none.then(|| ("no success".to_owned(), FAILED)))
            }
            Self::Dots(Square { low, side }, places, values) => {
                let high = (low.0 + side, low.1 + side);
                map.window(low, high).dots("", places, DotPaint::Values(values))
            }
        };
        if failed.is_empty() || failed.len() > CROWD {
            return map.cell();
        }
        map.dots("failed", failed, DotPaint::Plain(FAILED)).cell()
    }
}

/// Returns a scale from the minimum to the 95 % quantile of the shown values, and that maximum.
fn ratio_scale(mut shown: Vec<f64>, of_cells: bool) -> (Scale, f64) {
    shown.sort_by(f64::total_cmp);
    let least = shown.first().copied().unwrap_or(1.0);
    let most = Quantiles::from_values(shown).map_or(1.1, |spread| spread.p95);
    let what = if of_cells { "time / optimal time, median per cell" } else { "time / optimal time" };
    let most = most.max(least + 0.02);
    (Scale::new(what, least, most), most)
}

fn mean(values: &mut [f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn median(values: &mut [f64]) -> f64 {
    Quantiles::from_values(values.iter().copied()).map_or(f64::NAN, |spread| spread.p50)
}

/// Returns a square around all places.
fn square_around(places: &[(f64, f64)]) -> Square {
    let (mut low, mut high) = ((f64::MAX, f64::MAX), (f64::MIN, f64::MIN));
    for (x, y) in places {
        low = (low.0.min(*x), low.1.min(*y));
        high = (high.0.max(*x), high.1.max(*y));
    }
    if low.0 > high.0 {
        return Square { low: (-1.0, -1.0), side: 2.0 };
    }
    let side = (high.0 - low.0).max(high.1 - low.1).max(0.1) * MARGIN;
    Square { low: (0.5 * (low.0 + high.0 - side), 0.5 * (low.1 + high.1 - side)), side }
}

/// Draws a histogram of `values` from `least` to a high quantile or to some tolerances. A `unit` follows
/// every number except those of the axis.
fn histogram(
    title: &str,
    (label, unit): (&str, &str),
    values: &[f64],
    least: f64,
    tolerance: Option<(f64, f64)>,
) -> Vec<Subplot> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let quantile = |q: f64| sorted.get((q * sorted.len() as f64) as usize).or(sorted.last()).copied();
    let nearly_all = quantile(0.995).unwrap_or(least + 1.0);
    let most = tolerance.map_or(nearly_all, |(_, shown)| nearly_all.min(shown)).max(least + 1e-3);
    let low = sorted.first().map_or(least, |first| first.min(least));
    let width = (most - low) / BARS as f64;
    let edges: Vec<f64> = (0..=BARS).map(|k| low + k as f64 * width).collect();
    let mut counts = vec![0.0; BARS];
    let mut beyond = 0;
    for value in &sorted {
        // The upper end of the axis belongs to the last bar.
        let bar = (((value - low) / width) as usize).min(BARS - 1);
        match counts.get_mut(bar) {
            Some(count) if *value <= most => *count += 1.0,
            _ => beyond += 1,
        }
    }
    let top = 1.08 * counts.iter().fold(1.0, |most: f64, count| most.max(*count));
    let mut beyond = if beyond > 0 { vec![counted(beyond)] } else { Vec::new() };
    let trials = counted(sorted.len());
    let spread = Quantiles::from_values(sorted);
    let marks = [
        ("median", spread.map(|spread| spread.p50), Color::Black),
        ("95 % below", spread.map(|spread| spread.p95), Color::Blue),
        ("tolerance", tolerance.map(|(tolerance, _)| tolerance), Color::Vermilion),
    ];
    let mut panel = Panel::default();
    for (name, at, color) in marks {
        let Some(at) = at else { continue };
        let number = format!("{}{unit}", short(at));
        if at <= most {
            let line = vec![(at, 0.0), (at, top)];
            panel = panel.series(format!("{name}: {number}"), line, Stroke::solid(color));
        } else {
            // A legend entry would refer to a line outside the axis.
            beyond.push(format!("{name} {number}"));
        }
    }
    let rest =
        if beyond.is_empty() { String::new() } else { format!("; beyond the axis: {}", beyond.join(", ")) };
    let title = format!("{title}: {trials}{rest}");
    let panel = panel.titled(title, "trials").range(0.0, top).bars(edges, counts, Color::Sky);
    XyPlot::over(label).panel(panel).cells()
}

/// Formats a number of trials.
fn counted(trials: usize) -> String {
    format!("{trials} {}", if trials == 1 { "trial" } else { "trials" })
}

/// Formats a value with three significant digits.
fn short(value: f64) -> String {
    if value.abs() >= 1e6 {
        return format!("{value:.2e}");
    }
    let before_point = value.abs().max(1e-9).log10().floor() + 1.0;
    format!("{value:.*}", (3.0 - before_point).clamp(0.0, 4.0) as usize)
}

#[cfg(test)]
mod tests {
    use crate::plot::vstack;

    use super::histogram;

    /// The legend lists lines on the axis; the title lists lines beyond it.
    #[test]
    fn lines_beyond_the_axis_are_listed_in_the_title() {
        let values: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let drawn = |tolerance| drawn(&values, Some(tolerance));
        let (far, near) = (drawn((10.0, 30.0)), drawn((1.0, 3.0)));
        assert!(far.contains("tolerance 10.0 mm") && !far.contains("tolerance: "), "beyond the axis");
        assert!(near.contains("tolerance: 1.00 mm") && !near.contains("tolerance 1.00"), "on the axis");
    }

    /// The maximum value is at the upper end of the axis and is drawn.
    #[test]
    fn one_trial_is_drawn() {
        let svg = drawn(&[1.5], None);
        assert!(svg.contains("Errors: 1 trial<") && svg.contains("median: 1.50 mm"), "{svg}");
    }

    /// Errors of diverging robots.
    #[test]
    fn titles_fit_their_panel() {
        let svg = drawn(&[1.234e300; 1000], Some((10.0, 30.0)));
        let title = svg.split(['<', '>']).find(|text| text.starts_with("Errors")).expect("a title");
        assert!(title.contains("beyond the axis: 1000 trials, median 1.23e300 mm"), "{title}");
        assert!(title.len() < 100, "{title}");
    }

    fn drawn(values: &[f64], tolerance: Option<(f64, f64)>) -> String {
        vstack(vec![histogram("Errors", ("error [mm]", " mm"), values, 0.0, tolerance)]).svg()
    }
}
