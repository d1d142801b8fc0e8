//! Draws one picture of each kind from synthetic data into the given directory.

use std::f64::consts::TAU;
use std::path::Path;

use surepose_figures::plot::{Color, MapPlot, Mark, Panel, Stroke, XyPlot, hstack};

fn main() -> Result<(), surepose_figures::PlotError> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    let folder = Path::new(&folder);
    let way: Vec<(f64, f64)> =
        (0..=100).map(|i| f64::from(i) / 100.0).map(|s| (2.0 * s, 2.0 * s * s)).collect();
    let seen = way.iter().map(|(x, y)| (x + 0.02 * (9.0 * y).sin(), y + 0.02 * (7.0 * x).cos())).collect();
    let circle = |(x, y): (f64, f64), r: f64| -> Vec<(f64, f64)> {
        (0..=40)
            .map(|i| f64::from(i) * TAU / 40.0)
            .map(|a| (x + r * a.cos(), y + 0.6 * r * a.sin()))
            .collect()
    };
    let ellipses = || way.iter().step_by(10).map(|p| circle(*p, 0.08)).collect::<Vec<_>>();
    let corners = [(-1.0, -1.0), (4.0, -1.0), (4.0, 3.0), (-1.0, 3.0), (-1.0, -1.0)];
    let walls = corners.windows(2).map(|w| [w[0], w[1]]).chain([[(1.5, 1.8), (2.5, 1.8)]]);
    let map = MapPlot::new("From start to goal")
        .walls(walls)
        .outlines("3σ of the estimate", ellipses(), Stroke::thin(Color::Blue))
        .trace("true path", way.clone(), Stroke::wide(Color::Silver))
        .trace("estimated path", seen, Stroke::thin(Color::Vermilion))
        .pose("start", (0.0, 0.0), 0.0, Color::Green)
        .pose("goal", (2.0, 2.0), 0.5, Color::Purple);
    let close = MapPlot::new("At the goal")
        .trace("", way.clone(), Stroke::solid(Color::Black))
        .outlines("", vec![circle((2.0, 2.0), 0.03)], Stroke::thin(Color::Purple))
        .pose("", (2.0, 2.0), 0.5, Color::Purple)
        .window((1.95, 1.95), (2.05, 2.05))
        .axes(1000.0, "x [mm]", "y [mm]");
    hstack(vec![map.cell(), close.cell()]).save(folder, "map")?;
    let over = |f: &dyn Fn(f64) -> f64| {
        (0..=200).map(|i| f64::from(i) * 0.06).map(|t| (t, f(t))).collect::<Vec<_>>()
    };
    XyPlot::over("time [s]")
        .panel(
            Panel::new("Speed", "v [m/s]")
                .series("commanded", over(&|t| 0.3 * (-t / 4.0).exp()), Stroke::thin(Color::Vermilion))
                .series("measured", over(&|t| 0.3 * (-t / 5.0).exp()), Stroke::solid(Color::Blue))
                .marks([Mark::At(9.0, "local mode".to_owned()), Mark::Level(0.0)])
                .shaded([(9.0, 12.0)], Color::Sky),
        )
        .panel(Panel::new("Turn rate", "ω [°/s]").series(
            "measured",
            over(&|t| 20.0 * t.sin()),
            Stroke::solid(Color::Blue),
        ))
        .panel(
            Panel::new("Lyapunov function", "V")
                .series("V of the active mode", over(&|t| 4.0 * (-t).exp()), Stroke::solid(Color::Green))
                .logarithmic(),
        )
        .picture()
        .save(folder, "chart")
}
