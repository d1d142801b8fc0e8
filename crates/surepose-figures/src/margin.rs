//! Pictures of the certificate's margin: lower bound of the decrease of W over direction and distance.

use core::f64::consts::PI;

use surepose::control::NavigationVariables;
use surepose::geometry::{Angle, Body, Goal, Map as MapFrame, Pose};
use surepose_cert::{DisturbedState, MarginMap, Margins};
use surepose_montecarlo::sweep::Quantiles;

use crate::plot::{
    Color, DotPaint, Heatmap, HeatmapCell, MapPlot, Panel, Picture, Scale, Stroke, XyPlot, hstack,
};

const NOT_SHOWN: Color = Color::Vermilion;

/// Draws the margin over (α, φ) at the capture radius and at its minimum over all distances. A state in which
/// W rises is marked, if one is known. If the decrease is not proved everywhere, the first map is at the
/// largest distances with a gap.
pub fn margin(margins: &Margins, rises: Option<&DisturbedState>) -> Picture {
    let least = margins.least();
    // One scale for both, for comparison; small margins are resolved because they matter most.
    let shown = |of: &MarginMap| Quantiles::from_values(of.fall.iter().copied().filter(|fall| *fall > 0.0));
    let most = shown(&least).or(shown(&margins.nearest)).map_or(1.0, |spread| spread.p95);
    let scale = Scale::new(format!("lower bound of −dW/dt [1/s]; darkest: {most:.2} or more"), 0.0, most);
    let map = |title: String, of: &MarginMap| {
        let side = of.side.max(1);
        let cell = |k: usize| {
            // The map is stored α̂ by α̂; a picture is stored in rows of φ̂.
            let fall = of.fall.get((k % side) * side + k / side).copied().unwrap_or(f64::NAN);
            if fall > 0.0 { HeatmapCell::Value(fall) } else { HeatmapCell::Plain(NOT_SHOWN) }
        };
        let cells: Vec<HeatmapCell> = (0..of.fall.len()).map(cell).collect();
        let gaps = cells.contains(&HeatmapCell::Plain(NOT_SHOWN));
        let heatmap = Heatmap { low: (-PI, -PI), side: 2.0 * PI / side as f64, columns: side, cells };
        let map = MapPlot::new(title)
            .heatmap(heatmap, gaps.then(|| ("not proved".to_owned(), NOT_SHOWN)))
            .scale(scale.clone())
            .axes(
                1f64.to_degrees(),
                "estimated bearing of the goal α [°]",
                "estimated direction of approach φ [°]",
            )
            .numbered_every(45.0);
        // Only on the map of its own distance.
        let inside = |at: &&DisturbedState| {
            let rho = at.x.hypot(at.y);
            of.rho.0 <= rho && rho <= of.rho.1
        };
        match rises.filter(inside) {
            Some(at) => {
                map.dots("W increases in one tick", vec![seen(at)], DotPaint::Plain(Color::Black)).cell()
            }
            None => map.cell(),
        }
    };
    let whole = |of: &&MarginMap| of.fall.iter().all(|fall| *fall > 0.0);
    let edge = margins.ranges.iter().rev().find(|range| !whole(range));
    let first = match edge {
        Some(range) => map(format!("Farthest gap: {}", distances(range)), range),
        None => {
            map(format!("Margin at the capture radius, {}", distances(&margins.nearest)), &margins.nearest)
        }
    };
    hstack(vec![first, map(format!("Least margin from {}", distances(&least)), &least)])
}

/// Draws the minimum margin over the distance.
pub fn margin_over_distance(margins: &Margins) -> Picture {
    let worst = |map: &MarginMap| map.fall.iter().copied().fold(f64::INFINITY, f64::min);
    // A gap is not a margin of 0, so the line is interrupted.
    let (mut runs, mut gaps, mut most) = (vec![Vec::new()], Vec::new(), 0.1_f64);
    for range in &margins.ranges {
        let (near, far) = range.rho;
        let fall = worst(range);
        if fall > 0.0 {
            if let Some(run) = runs.last_mut() {
                run.extend([(near, fall), (far, fall)]);
            }
            most = most.max(fall);
        } else {
            runs.push(Vec::new());
            gaps.push((near, far));
        }
    }
    let note = if gaps.is_empty() { "" } else { "; shaded: not proved" };
    let panel = Panel::new(format!("Lower bound of −dW/dt over all directions{note}"), "−dW/dt [1/s]")
        .range(0.0, 1.08 * most)
        .shaded(gaps, NOT_SHOWN);
    let panel = runs
        .into_iter()
        .filter(|run| !run.is_empty())
        .fold(panel, |panel, run| panel.series("", run, Stroke::solid(Color::Blue)));
    XyPlot::over("true distance from the goal ρ [m]").logarithmic().panel(panel).picture()
}

/// Returns the estimated bearing and direction of approach of a state \[rad].
fn seen(at: &DisturbedState) -> (f64, f64) {
    let heading = Angle::from_radians(at.heading + at.noise_heading);
    let estimate: Pose<MapFrame, Body, f64> = Pose::new(at.x + at.noise_x, at.y + at.noise_y, heading);
    let goal: Pose<MapFrame, Goal, f64> = Pose::identity();
    let seen = NavigationVariables::from_poses(estimate, goal);
    (seen.alpha.radians(), seen.phi.radians())
}

fn distances(of: &MarginMap) -> String {
    let (near, far) = of.rho;
    let short = |meters: f64| format!("{meters:.3}").trim_end_matches('0').trim_end_matches('.').to_owned();
    if near < far { format!("{} m to {} m", short(near), short(far)) } else { format!("{} m", short(near)) }
}

#[cfg(test)]
mod tests {
    use surepose_cert::{MarginMap, Margins};

    use super::margin_over_distance;

    /// Gaps are distinguishable from a margin of 0, even if there are only gaps.
    #[test]
    fn gaps_are_shaded_and_named() {
        let map = |rho, fall: f64| MarginMap { rho, side: 1, fall: vec![fall] };
        let drawn = |falls: [f64; 2]| {
            let ranges = vec![map((0.1, 1.0), falls[0]), map((1.0, 5.0), falls[1])];
            let nearest = map((0.1, 0.1), falls[0]);
            margin_over_distance(&Margins { nearest, ranges }).svg()
        };
        let gap = f64::NEG_INFINITY;
        assert!(!drawn([0.3, 0.2]).contains("not proved"));
        for falls in [[gap, 0.2], [0.3, gap], [gap, gap]] {
            let svg = drawn(falls);
            assert!(svg.contains("shaded: not proved") && svg.contains("true distance"), "{falls:?}");
        }
    }
}
