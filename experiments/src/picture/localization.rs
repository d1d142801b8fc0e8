//! Pictures of the paper's Fig. 4 and Fig. 5: estimates with four sets of sensors.

use surepose_figures::plot::{Color, DotPaint, MapPlot, Mark, Panel, Picture, Stroke, XyPlot, hstack_column};

use super::figures::{marked, with_inset};
use surepose_sim::Arena;

use crate::reproduce::{Configuration, DeviationSample};

/// Window of the moving RMS on a logarithmic axis \[s].
const WINDOW: f64 = 4.0;

/// One run with one set of sensors.
pub type LocalizationRun = (Configuration, Vec<DeviationSample>);

/// Draws Fig. 4: the estimated paths of each set of sensors, the true path, and the errors.
pub fn fig4(runs: &[LocalizationRun]) -> Picture {
    let arena = Arena::loop_world();
    let walls = arena.walls().iter().map(|wall| [(wall.start.x, wall.start.y), (wall.end.x, wall.end.y)]);
    let mut map = MapPlot::new("Fig. 4: estimated paths in the loop world, first run").walls(walls);
    let mut positions =
        Panel::new(format!("Position error of the estimate, rms over {WINDOW} s"), "error [m]").logarithmic();
    let mut headings =
        Panel::new(format!("Heading error of the estimate, rms over {WINDOW} s"), "error [°]").logarithmic();
    for (i, (configuration, moments)) in runs.iter().enumerate() {
        let (label, stroke) = (configuration.name(), stroke(i));
        let way: Vec<_> = moments.iter().map(|moment| (moment.belief.pose.x, moment.belief.pose.y)).collect();
        map = map.dots("", marked(&way), DotPaint::Plain(stroke.color)).trace(label, way, stroke);
        positions = positions.series(label, smoothed(moments, |[x, y, _]| x.hypot(y)), stroke);
        headings = headings.series(label, smoothed(moments, |[_, _, heading]| heading.to_degrees()), stroke);
    }
    if let Some((_, moments)) = runs.first() {
        let truth: Vec<_> = moments.iter().map(|moment| (moment.truth.x, moment.truth.y)).collect();
        map = map.dots("truth, every 5 s", marked(&truth), DotPaint::Plain(Color::Black)).trace(
            "truth",
            truth,
            Stroke::thin(Color::Black),
        );
    }
    let chart = XyPlot::over("time [s]").panel(positions).panel(headings);
    hstack_column(with_inset(map, "Inset: the marked corner", [(3.9, 2.8), (4.6, 3.1)]), chart.cells())
}

/// The third set of sensors is nearly as accurate as the fourth: a wider line stays visible below it.
fn stroke(index: usize) -> Stroke {
    let width = if index == 2 { 3.2 } else { 1.3 };
    Stroke { width, ..Stroke::solid(Color::from_series(index)) }
}

/// Returns the root mean square of an error over a window around each sample.
///
/// Unsmoothed errors pass through 0, which is unreadable on a logarithmic axis.
fn smoothed(moments: &[DeviationSample], error: fn([f64; 3]) -> f64) -> Vec<(f64, f64)> {
    let squares: Vec<_> = moments
        .iter()
        .map(|moment| (moment.time, error(moment.belief.error(moment.truth)).powi(2)))
        .collect();
    let near = |time: f64| squares.iter().filter(move |(at, _)| (at - time).abs() <= 0.5 * WINDOW);
    let mean = |time: f64| near(time).map(|(_, square)| square).sum::<f64>() / near(time).count() as f64;
    moments.iter().map(|moment| (moment.time, mean(moment.time).sqrt())).collect()
}

/// Draws Fig. 5: deviations in x and y over time, with odometry alone and without it at its own scale.
pub fn fig5(runs: &[LocalizationRun]) -> Picture {
    let mut chart = XyPlot::over("time [s]");
    for (axis, name) in ["x", "y"].into_iter().enumerate() {
        let letter = ["a", "b"][axis];
        for corrected_only in [false, true] {
            let which = if corrected_only { "with corrections" } else { "all" };
            let title = format!("Fig. 5 {letter}: deviation in {name}, first run, {which}");
            let mut panel = Panel::new(title, format!("Δ{name} [mm]")).marks([Mark::Level(0.0)]);
            for (i, (configuration, moments)) in runs.iter().enumerate() {
                if corrected_only && *configuration == Configuration::Odometry {
                    continue;
                }
                let deviation =
                    moments.iter().map(|moment| (moment.time, 1e3 * moment.belief.error(moment.truth)[axis]));
                panel = panel.series(configuration.name(), deviation.collect(), stroke(i));
            }
            chart = chart.panel(panel);
        }
    }
    chart.picture()
}
