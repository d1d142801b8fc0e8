//! The paper's Fig. 4 and Fig. 5: where four sets of sensors believe the robot to be.

use surepose_plot::{Chart, Color, Map, Mark, Panel, Picture, Stroke, beside_column};
use surepose_sim::Arena;

use crate::reproduce::{Configuration, Moment};

/// One run, as one set of sensors saw it.
pub type Localised = (Configuration, Vec<Moment>);

/// Fig. 4: the ways that each set of sensors believes in, against the truth; and how far off each one is.
pub fn fig4(runs: &[Localised]) -> Picture {
    let arena = Arena::loop_world();
    let walls = arena.walls().iter().map(|wall| [(wall.start.x, wall.start.y), (wall.end.x, wall.end.y)]);
    let mut map = Map::new("Fig. 4: estimated ways in the loop world").walls(walls);
    if let Some((_, moments)) = runs.first() {
        let truth = moments.iter().map(|moment| (moment.truth.x, moment.truth.y)).collect();
        map = map.trace("truth", truth, Stroke::wide(Color::Silver));
    }
    let mut positions = Panel::new("Distance of the estimate from the truth", "error [m]").logarithmic();
    let mut headings = Panel::new("Heading error of the estimate", "error [°]").logarithmic();
    for (i, (configuration, moments)) in runs.iter().enumerate() {
        let (label, stroke) = (configuration.name(), Stroke::solid(Color::of_series(i)));
        let way = moments.iter().map(|moment| (moment.belief.pose.x, moment.belief.pose.y)).collect();
        map = map.trace(label, way, stroke);
        let over = |value: fn([f64; 3]) -> f64| {
            moments.iter().map(|moment| (moment.time, value(moment.belief.error(moment.truth)))).collect()
        };
        let thin = Stroke { width: 1.2, ..stroke };
        positions = positions.series(label, over(|[x, y, _]| x.hypot(y)), thin);
        headings = headings.series(label, over(|[_, _, heading]| heading.to_degrees().abs()), thin);
    }
    let chart = Chart::over("time [s]").panel(positions).panel(headings);
    beside_column(map.cell(), chart.cells())
}

/// Fig. 5: the deviations in x and y over time; each once with odometry alone, and once without, on its own scale.
pub fn fig5(runs: &[Localised]) -> Picture {
    let mut chart = Chart::over("time [s]");
    for (axis, name) in ["x", "y"].into_iter().enumerate() {
        let letter = ["a", "b"][axis];
        for corrected_only in [false, true] {
            let which = if corrected_only { "with corrections" } else { "all" };
            let title = format!("Fig. 5 {letter}: deviation in {name}, {which}");
            let mut panel = Panel::new(title, format!("{name} [mm]")).marks([Mark::Level(0.0)]);
            for (i, (configuration, moments)) in runs.iter().enumerate() {
                if corrected_only && *configuration == Configuration::Odometry {
                    continue;
                }
                let deviation =
                    moments.iter().map(|moment| (moment.time, 1e3 * moment.belief.error(moment.truth)[axis]));
                let stroke = Stroke { width: 1.2, ..Stroke::solid(Color::of_series(i)) };
                panel = panel.series(configuration.name(), deviation.collect(), stroke);
            }
            chart = chart.panel(panel);
        }
    }
    chart.picture()
}
