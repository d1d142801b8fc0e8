//! Pictures of a replay: path and scans on the map, errors and consistency over time.

use surepose_replay::Track;

use crate::plot::{Color, MapPlot, Panel, Picture, Stroke, XyPlot};

/// Quantile 99 % of χ² with 3 degrees of freedom.
const CONSISTENT_NEES: f64 = 11.34;
/// Smallest NEES on the logarithmic axis.
const MIN_NEES: f64 = 1e-3;

/// Draws walls, beam end points, the estimated path and the reference path.
pub fn replay_map(track: &Track) -> Picture {
    let estimated = track.points.iter().map(|point| (point.pose.x, point.pose.y)).collect();
    let reference: Vec<_> =
        track.points.iter().filter_map(|point| point.truth).map(|truth| (truth.x, truth.y)).collect();
    let mut map = MapPlot::new("Replay").walls(track.walls.iter().copied());
    if !track.beam_ends.is_empty() {
        map = map.points("beam end points", track.beam_ends.clone(), Color::Vermilion);
    }
    if !reference.is_empty() {
        map = map.trace("reference path", reference, Stroke::solid(Color::Green));
    }
    map = map.trace("estimated path", estimated, Stroke::solid(Color::Blue));
    if let Some(first) = track.points.first() {
        map = map.pose("start", (first.pose.x, first.pose.y), first.pose.heading.radians(), Color::Blue);
    }
    map.picture()
}

/// Draws position error, heading error and NEES over time; `None` without judged estimates.
pub fn replay_errors(track: &Track) -> Option<Picture> {
    let start = track.points.first()?.time;
    let judged: Vec<_> =
        track.points.iter().filter_map(|point| Some((point, point.truth?, point.nees?))).collect();
    let (first, last) = (judged.first()?.0.time - start, judged.last()?.0.time - start);
    let over_time = |value: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        judged.iter().enumerate().map(|(index, (point, ..))| (point.time - start, value(index))).collect()
    };
    let position = over_time(&|index| judged[index].0.pose.origin().distance(judged[index].1.origin()));
    let deviation = over_time(&|index| {
        let [x, y, _] = judged[index].0.std;
        3.0 * (x * x + y * y).sqrt()
    });
    let heading =
        over_time(&|index| (judged[index].0.pose.heading - judged[index].1.heading).radians().to_degrees());
    let nees = over_time(&|index| judged[index].2.max(MIN_NEES));
    let limit = vec![(first, CONSISTENT_NEES), (last, CONSISTENT_NEES)];
    let position = Panel::new("Position error", "[m]")
        .series("error", position, Stroke::solid(Color::Blue))
        .series("3 σ", deviation, Stroke::solid(Color::Green));
    let heading = Panel::new("Heading error", "[°]").series("", heading, Stroke::solid(Color::Blue));
    let nees = Panel::new("NEES", "")
        .series("NEES", nees, Stroke::solid(Color::Blue))
        .series("99 %", limit, Stroke::solid(Color::Vermilion))
        .logarithmic();
    Some(XyPlot::over("time [s]").panel(position).panel(heading).panel(nees).picture())
}
