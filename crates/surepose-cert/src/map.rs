//! Margin maps: lower bounds of −Ẇ over the estimated angles, for plots.

use std::collections::BinaryHeap;

use crate::annulus::ratio;
use crate::certificate::{Certificate, RefusalReason, Request, WANTED};
use crate::controller::SampledController;
use crate::descent::Descent;
use crate::interval::Interval;
use crate::lyapunov::LyapunovFunction;
use crate::prioritized_box::PrioritizedBox;
use crate::region::Region;

/// Lower bounds of −Ẇ over (α̂, φ̂) for a range of distances.
#[derive(Clone, Debug, PartialEq)]
pub struct MarginMap {
    /// Smallest and largest true distance \[m].
    pub rho: (f64, f64),
    /// Number of cells per angle, from −π to π.
    pub side: usize,
    /// Lower bounds of −Ẇ \[1/s]; the index of φ̂ varies fastest. −∞: no bound was shown.
    pub fall: Vec<f64>,
}

/// Parameters of a margin map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarginRequest {
    /// Smallest and largest true distance \[m].
    pub rho: (f64, f64),
    /// Number of cells per angle and quadrant.
    pub per_quadrant: usize,
    /// Number of bisections per cell; up to four times as many while no decrease is shown.
    ///
    /// A larger number gives tighter bounds and takes longer.
    pub boxes: usize,
    /// Whether to omit noise and wheel limits.
    pub bare: bool,
    /// Lower bound already known for all cells \[1/s], for example the certified rate. `None`: unknown.
    pub shown: Option<f64>,
}

/// Margin maps for a certificate or a refusal.
#[derive(Clone, Debug, PartialEq)]
pub struct Margins {
    /// Map at the capture radius, or at the largest acceptable one after a refusal.
    pub nearest: MarginMap,
    /// Maps from that radius to the edge of the workspace, one per range of distances.
    pub ranges: Vec<MarginMap>,
}

/// Decrease rate requested first \[1/s]: twice the rate that certificates usually show.
const WISH: f64 = 2.0 * WANTED[0];
/// Factor on the number of bisections for cells without a shown decrease.
const MAX_STALLED_ROUNDS: usize = 4;

/// Computes the margin maps for the answer `certificate` to `request`.
///
/// `watch` receives the completed fraction (0 to 1) and returns whether to continue. `None`: `watch` returned
/// `false`.
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
    /// Minimum of each cell over all distances.
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

/// Computes one margin map for `lyapunov`.
///
/// `watch` receives the completed fraction (0 to 1) and returns whether to continue. `None`: `watch` returned
/// `false`. In each cell, the worst box is bisected until the boxes are used up; the bounds approach the true
/// value from below.
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
    // Each region lies within one quadrant of each angle.
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

/// Lower bound of −Ẇ in `region`, at least `known`, by `boxes` bisections of the worst box \[1/s].
fn least_fall<L: SampledController>(
    descent: &Descent<'_, L>,
    region: Region,
    boxes: usize,
    known: f64,
) -> f64 {
    // A bound known for a box holds for its parts.
    let mut discrete_states = descent.discrete_states.clone();
    let mut bounded = |region: Region, known: f64| {
        // A higher requested rate gives a finer evaluation; the result is a bound only if the request is met.
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
