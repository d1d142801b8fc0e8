//! The margin over the angles, for a picture: how fast W falls at the least, for each way of seeing the goal.

use std::collections::BinaryHeap;

use crate::annulus::ratio;
use crate::certificate::{Certificate, RefusalReason, Request, WANTED};
use crate::controller::SampledController;
use crate::descent::Descent;
use crate::interval::Interval;
use crate::lyapunov::LyapunovFunction;
use crate::prioritized_box::PrioritizedBox;
use crate::region::Region;

/// Lower bounds of −Ẇ over (α̂, φ̂), at a range of distances.
#[derive(Clone, Debug, PartialEq)]
pub struct MarginMap {
    /// Nearest and farthest true distance \[m].
    pub rho: (f64, f64),
    /// Number of cells along each angle, from −π to π.
    pub side: usize,
    /// Lower bounds of −Ẇ \[1/s], α̂ by α̂, φ̂ within; negative infinity where the fall was not shown.
    pub fall: Vec<f64>,
}

/// What the margin is of, and how finely.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarginRequest {
    /// Nearest and farthest true distance \[m].
    pub rho: (f64, f64),
    /// Number of cells along each angle in a quadrant.
    pub per_quadrant: usize,
    /// Boxes that a cell is cut into, at most; more of them where the fall is not shown yet. The more, the tighter the
    /// bounds, and the longer it takes.
    pub boxes: usize,
    /// Without noise and without the wheels' limits.
    pub bare: bool,
    /// What is shown of all cells already \[1/s]: a certificate's own rate, where there is one.
    pub shown: Option<f64>,
}

/// The margin of what a certificate says, or of what it could not show.
#[derive(Clone, Debug, PartialEq)]
pub struct Margins {
    /// At the capture radius, or at the largest useful one where there is none.
    pub nearest: MarginMap,
    /// From there to the edge of the workspace, range by range.
    pub ranges: Vec<MarginMap>,
}

/// The fall that is wished for first \[1/s]: twice what certificates usually show.
const WISH: f64 = 2.0 * WANTED[0];
/// Into how many times more boxes a cell is cut in which the fall is not shown yet.
const MAX_STALLED_ROUNDS: usize = 4;

/// The margin outside of the radius of `certificate`, which answered `request`; none if `watch` ended it, which is
/// told the part that is done, and says whether to go on.
pub fn margins<L: SampledController>(
    request: &Request<'_, L>,
    certificate: &Certificate,
    (per_quadrant, boxes): (usize, usize),
    mut watch: impl FnMut(f64) -> bool,
) -> Option<Margins> {
    let bare = certificate.reason == Some(RefusalReason::UnstableByItself);
    let radius = certificate.capture_radius.unwrap_or(request.max_capture_radius);
    let mut edges = vec![radius];
    let mut far = radius;
    while far < request.workspace {
        far = (far * ratio(far, request.noise.position)).min(request.workspace);
        edges.push(far);
    }
    let required = core::iter::once((radius, radius)).chain(edges.windows(2).map(|pair| (pair[0], pair[1])));
    let count = edges.len() as f64;
    let mut maps = Vec::new();
    for (done, rho) in required.enumerate() {
        let asked = MarginRequest { rho, per_quadrant, boxes, bare, shown: certificate.decrease_rate };
        let watch = |part: f64| watch((done as f64 + part) / count);
        maps.push(margin_map(request, certificate.lyapunov, asked, watch)?);
    }
    let mut maps = maps.into_iter();
    Some(Margins { nearest: maps.next()?, ranges: maps.collect() })
}

impl Margins {
    /// The least of each cell's over all distances.
    pub fn least(&self) -> MarginMap {
        let mut least = self.nearest.clone();
        for range in &self.ranges {
            least.rho.1 = least.rho.1.max(range.rho.1);
            for (least, here) in least.fall.iter_mut().zip(&range.fall) {
                *least = least.min(*here);
            }
        }
        least
    }
}

/// The margin with `lyapunov`, one value of α̂ after the other; none if `watch` ended it, which is told the part that is
/// done, and says whether to go on.
///
/// In each cell the worst box is halved until the boxes are spent, so that the bounds approach the truth from below.
pub fn margin_map<L: SampledController>(
    request: &Request<'_, L>,
    lyapunov: LyapunovFunction,
    asked: MarginRequest,
    mut watch: impl FnMut(f64) -> bool,
) -> Option<MarginMap> {
    let MarginRequest { rho, per_quadrant, boxes, bare, shown } = asked;
    let known = shown.unwrap_or(f64::NEG_INFINITY);
    let mut descent = if bare { request.bare(lyapunov) } else { request.descent(lyapunov) };
    let rho_set = Interval::new(rho.0, rho.1);
    descent.prepare(rho_set);
    let drift = Interval::symmetric(descent.noise.position);
    // A region lies within one quadrant of each angle.
    let cells: Vec<Interval> = Region::quadrants()
        .flat_map(|angle| (0..per_quadrant).map(move |i| angle.piece(i, per_quadrant)))
        .collect();
    let mut fall = Vec::with_capacity(cells.len() * cells.len());
    for (a, &alpha) in cells.iter().enumerate() {
        let region = |&phi: &Interval| Region { rho: rho_set, drift, alpha, phi };
        fall.extend(cells.iter().map(region).map(|region| least_fall(&descent, region, boxes, known)));
        if !watch((a + 1) as f64 / cells.len() as f64) {
            return None;
        }
    }
    Some(MarginMap { rho, side: cells.len(), fall })
}

/// A lower bound of −Ẇ in `region`, where it is at least `known`, by `boxes` halvings of the worst part.
fn least_fall<L: SampledController>(
    descent: &Descent<'_, L>,
    region: Region,
    boxes: usize,
    known: f64,
) -> f64 {
    // What is known of the whole is known of its parts.
    let mut discrete_states = descent.discrete_states.clone();
    let mut bounded = |region: Region, known: f64| {
        // The more is wanted, the finer is what is looked at; and a bound is one only where the wish came true.
        let shown = [WISH, 0.0].into_iter().find_map(|required| {
            let fall = descent.fall(&region, required, &mut discrete_states);
            (fall.rate <= -required && fall.jump <= 0.0).then_some(-fall.rate)
        });
        PrioritizedBox { priority: -known.max(shown.unwrap_or(known)), region }
    };
    let mut parts = BinaryHeap::from([bounded(region, known)]);
    let mut least = known;
    for round in 0..MAX_STALLED_ROUNDS * boxes {
        let Some(worst) = parts.pop() else { break };
        least = -worst.priority;
        if round >= boxes && least > 0.0 {
            return least;
        }
        let (low, high) = worst.region.halves();
        parts.extend([low, high].map(|half| bounded(half, least)));
    }
    parts.peek().map_or(least, |worst| -worst.priority)
}
