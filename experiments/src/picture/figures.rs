//! Pictures of the paper's Fig. 3, 6 and 7.

use surepose::geometry::{Map as MapFrame, Point};
use surepose_figures::drive::{true_way, unwrapped, walls};
use surepose_figures::plot::{
    Color, DotPaint, MapPlot, Mark, Panel, Picture, Stroke, Subplot, XyPlot, column, hstack, hstack_column,
};
use surepose_sim::Arena;
use surepose_sim::robot::Scenario;

use crate::reproduce::{LawSample, Parked, PathFollowing, PathRuns, StabilizedRun};

/// Draws Fig. 3: the law without sensors, to three goals, under bounded noise; and Eq. (28) as printed, which
/// diverges.
pub fn fig3(goals: &[StabilizedRun], printed: &[LawSample], corrected: &[LawSample]) -> Picture {
    let mut map = MapPlot::new("Fig. 3: the control law under the paper's noise").pose(
        "start",
        (0.0, 0.0),
        0.0,
        Color::Black,
    );
    for (i, goal) in goals.iter().enumerate() {
        let [x, y, heading] = goal.figures.goal;
        let (color, way) = (Color::from_series(i), goal.motion.iter().map(|at| (at.x_m, at.y_m)).collect());
        map = map.trace(format!("goal at {heading}°"), way, Stroke::solid(color)).pose(
            "",
            (x, y),
            heading.to_radians(),
            color,
        );
    }
    let over =
        |motion: &[LawSample]| motion.iter().map(|at| (at.time_s, at.goal_distance_m)).collect::<Vec<_>>();
    let mut distances = Panel::new("Distance from the goal", "ρ [m]").logarithmic();
    for (i, goal) in goals.iter().enumerate() {
        let label = format!("goal at {}°", goal.figures.goal[2]);
        distances = distances.series(label, over(&goal.motion), Stroke::solid(Color::from_series(i)));
    }
    let signs = Panel::new("Local law (28), from 4 mm off", "ρ [m]")
        .series("as printed", over(printed), Stroke::solid(Color::Orange))
        .series("sign corrected", over(corrected), Stroke::solid(Color::Black))
        .logarithmic();
    // The two panels have different durations, so each has its own time axis.
    let panels = [distances, signs].map(|panel| XyPlot::over("time [s]").panel(panel).cells());
    hstack_column(map.cell(), panels.into_iter().flatten().collect())
}

/// Draws Fig. 6: two paths, followed with and without the filter.
pub fn fig6(following: &PathFollowing) -> Picture {
    let arena = Arena::loop_world();
    let draw = |title: &str, shape: &PathRuns, magnified: Window| {
        let (without, with) = (points(&shape.without_ekf), points(&shape.with_ekf));
        let map = MapPlot::new(title)
            .walls(arena.walls().iter().map(|wall| [(wall.start.x, wall.start.y), (wall.end.x, wall.end.y)]))
            .dots("without EKF, every 5 s", marked(&without), DotPaint::Plain(Color::Vermilion))
            .dots("with EKF, every 5 s", marked(&with), DotPaint::Plain(Color::Blue))
            .trace("without EKF", without, Stroke::solid(Color::Vermilion))
            .trace("with EKF", with, Stroke::wide(Color::Blue))
            .trace("path", points(&shape.path), Stroke::thin(Color::Black));
        with_inset(map, "Inset: the marked corner", magnified)
    };
    hstack(vec![
        draw("Fig. 6 a: a rounded rectangle", &following.rounded_rectangle, [(3.9, 0.7), (4.6, 1.2)]),
        draw("Fig. 6 b: a rounded triangle", &following.rounded_triangle, [(3.8, 0.6), (4.5, 1.1)]),
    ])
}

/// Two opposite corners of a rectangle in the map \[m].
pub(super) type Window = [(f64, f64); 2];

/// Draws `map` with a marked rectangle, and that rectangle enlarged below.
pub(super) fn with_inset(map: MapPlot, title: &str, [low, high]: Window) -> Subplot {
    let inset = map.clone().titled(title).window(low, high).cell();
    let edges = vec![vec![low, (high.0, low.1), high, (low.0, high.1), low]];
    column(vec![map.outlines("inset", edges, Stroke::thin(Color::Black)).cell(), inset])
}

/// Number of samples of a path at 0.1 s between two markers.
const BETWEEN_MARKERS: usize = 50;

/// Returns the points that are marked.
pub(super) fn marked(path: &[(f64, f64)]) -> Vec<(f64, f64)> {
    path.iter().step_by(BETWEEN_MARKERS).copied().collect()
}

/// Draws Fig. 7: the complete robot to three goals: paths, speed and heading, with the law of Surepose and with that of the paper.
pub fn fig7(surepose: &[Parked], paper: &[Parked]) -> Picture {
    let drawn = [
        parked(surepose, "law surepose", ["a", "b", "c"]),
        parked(paper, "law of Tran et al. (2012)", ["d", "e", "f"]),
    ];
    let (maps, charts): (Vec<_>, Vec<_>) = drawn.into_iter().unzip();
    hstack_column(column(maps), charts.into_iter().flatten().collect())
}

fn parked(goals: &[Parked], law: &str, [first, second, third]: [&str; 3]) -> (Subplot, Vec<Subplot>) {
    let mut map =
        MapPlot::new(format!("Fig. 7 {first}: the robot's paths, {law}")).walls(walls(&Scenario::default()));
    let mut speed = Panel::new(format!("Fig. 7 {second}: speed, {law}"), "v [m/s]").marks([Mark::Level(0.0)]);
    let mut heading = Panel::new(format!("Fig. 7 {third}: heading, {law}; dashed: the goals'"), "θ [°]");
    for (i, parked) in goals.iter().enumerate() {
        let [x, y, degrees] = parked.figures.goal;
        let (color, label) = (Color::from_series(i), format!("goal at {degrees}°"));
        let over = |value: &dyn Fn(&surepose_sim::simulation::Sample) -> f64| {
            parked.samples.iter().map(|sample| (sample.time_s, value(sample))).collect::<Vec<_>>()
        };
        map = map.trace(label.clone(), true_way(&parked.samples), Stroke::solid(color)).pose(
            "",
            (x, y),
            degrees.to_radians(),
            color,
        );
        speed = speed.series(label.clone(), over(&|sample| sample.v_m_s), Stroke::solid(color));
        heading = heading
            .series(label, unwrapped(over(&|sample| sample.heading_deg)), Stroke::solid(color))
            .marks([Mark::Level(degrees)]);
    }
    map = map.pose("start", (0.0, 0.0), 0.0, Color::Black);
    (map.cell(), XyPlot::over("time [s]").panel(speed).panel(heading).cells())
}

fn points(points: &[Point<MapFrame, f64>]) -> Vec<(f64, f64)> {
    points.iter().map(|point| (point.x, point.y)).collect()
}
