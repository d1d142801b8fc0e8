//! How long does the local law stay in charge at the least, once it has taken over?

use std::collections::BinaryHeap;

use surepose::{Memory, Scalar};

use crate::descent::Descent;
use crate::fork::explore;
use crate::interval::Interval;
use crate::mind::Mind;
use crate::ranked::Ranked;
use crate::region::Region;
use crate::settle::seen_moving;
use crate::subject::Subject;

/// Into how many distances the seen goal is cut.
const RINGS: usize = 256;
/// No more ticks than these are looked for.
const MOST_TICKS: usize = 500;
/// Regions looked at for the growth of the distance, times the minds looked at in each.
const WORK: usize = 14_000;
/// Into how many pieces the noise along the robot is cut.
const PIECES: usize = 8;
/// Ways that the law may take where the goal may be anywhere.
const MOST_WAYS: usize = 8192;

/// The least number of ticks between one in which the local law takes over and the next in which it hands back, whatever
/// the noise; 0 if none could be shown.
///
/// The local law takes over where the goal is *seen* near, so that the robot is truly not farther than that and the noise.
/// It hands back where the goal is seen farther than a distance that depends on what it remembers. Between the two noise can
/// lie, but the robot must truly have been led away: ρ² grows by no more than a bound in each tick.
pub(crate) fn dwell<L: Subject>(descent: &Descent<'_, L>, capture: f64, boxes: &mut usize) -> usize {
    let Some(takes_over) = reach(descent, capture, false) else { return 0 };
    let Some(keeps) = reach(descent, capture, true) else { return 0 };
    let Some(mut trims) = trims_afar(descent) else { return 0 };
    let Some(growth) = growth(descent, takes_over.max(keeps), boxes) else { return 0 };
    let mut square = Interval::point(takes_over + descent.noise.position).squared();
    for ticks in 0..MOST_TICKS {
        let farthest = square.sqrt().hi();
        let drift = Interval::symmetric(descent.noise.position);
        let rho = if ticks == 0 { takes_over } else { farthest };
        let drift = if ticks == 0 { Interval::point(0.0) } else { drift };
        let region = Region::anywhere(Interval::new(0.0, rho), drift);
        let mut next: Option<Interval> = None;
        for mind in descent.minds_known().filter(|mind| mind.near == (ticks > 0)) {
            let memory = descent.step(&region, mind.memory(trims)).memory;
            if ticks > 0 && !memory.near.certain() {
                return ticks;
            }
            if memory.near.possible() {
                next = Some(next.map_or(memory.trims, |all| all.hull(memory.trims)));
            }
        }
        let Some(next) = next else { return 0 };
        trims = next;
        square = square + Interval::new(0.0, growth);
    }
    MOST_TICKS
}

/// The largest seen distance, in steps, at which the local law can be in charge after a tick, having been `before` or not;
/// none if that is not within a few capture radii, or nowhere.
fn reach<L: Subject>(descent: &Descent<'_, L>, capture: f64, before: bool) -> Option<f64> {
    let all = Interval::new(0.0, 4.0 * capture);
    let possible =
        |rho: Interval| descent.local_possible(&Region::anywhere(rho, Interval::point(0.0)), before);
    if possible(Interval::new(all.hi(), 1e6)) {
        return None;
    }
    (0..RINGS).rev().map(|ring| all.piece(ring, RINGS)).find(|rho| possible(*rho)).map(Interval::hi)
}

/// For how many ticks a law can remember to have trimmed where the local one is not in charge.
fn trims_afar<L: Subject>(descent: &Descent<'_, L>) -> Option<Interval> {
    let everywhere = Region::anywhere(Interval::new(0.0, 1e6), Interval::point(0.0));
    let mut trims = Memory::<Interval>::fresh().trims;
    let complete = descent.minds_known().all(|mind| {
        let program = || descent.step(&everywhere, mind.memories()).memory;
        explore(MOST_WAYS, program, |memory| {
            if !memory.near.certain() {
                trims = trims.hull(memory.trims);
            }
        })
    });
    complete.then_some(trims)
}

/// Bound of what a tick of the local law can add to the square of the true distance \[m²].
fn growth<L: Subject>(descent: &Descent<'_, L>, reach: f64, boxes: &mut usize) -> Option<f64> {
    let seen = Interval::new(0.0, reach);
    let minds: Vec<Mind> = descent.minds_known().collect();
    let all = Region::around(seen, &crate::noise::Noise::default());
    let ranked = |region: Region| Ranked { badness: growth_in(descent, &minds, &region), region };
    let mut open: BinaryHeap<Ranked> = all.map(ranked).collect();
    for _ in 0..WORK / minds.len().max(1) {
        let Some(worst) = open.pop() else { break };
        *boxes += 1;
        let (low, high) = worst.region.halves_at_goal();
        open.extend([low, high].map(ranked));
    }
    open.peek().map(|worst| worst.badness).filter(|growth| growth.is_finite())
}

/// The same in `region`; infinite where nothing is known.
fn growth_in<L: Subject>(descent: &Descent<'_, L>, minds: &[Mind], region: &Region) -> f64 {
    let mut outcomes = Vec::new();
    let known = minds.iter().all(|mind| {
        descent.outcomes_of(region, *mind, MOST_WAYS, &mut outcomes)
            || !descent.local_possible_from(region, *mind)
    });
    if !known {
        return f64::INFINITY;
    }
    let drive = descent.drive.cast();
    let noise = Interval::symmetric(descent.noise.position);
    let (ahead, aside) = region.true_place(descent.noise.heading);
    let time = Interval::new(0.0, descent.period);
    let mut growth = 0.0_f64;
    for outcome in outcomes.iter().filter(|outcome| outcome.mind.near) {
        let twist = descent.noise.driven(&drive, outcome.twist);
        for piece in 0..PIECES {
            // d(ρ²)/dt = −2·v·x with the goal x ahead.
            let ahead = ahead + noise.piece(piece, PIECES);
            let (ahead, _) = seen_moving(ahead, aside + noise, twist, time);
            let rate = Interval::point(-2.0) * twist.v * ahead * time;
            growth = growth.max(rate.hi());
        }
    }
    growth
}

impl Region {
    /// Where the goal truly lies in the robot's axes, but for the noise of the position: seen, and turned by the noise of
    /// the heading.
    pub(crate) fn true_place(&self, heading_noise: f64) -> (Interval, Interval) {
        let (sin, cos) = (self.alpha + Interval::symmetric(heading_noise)).sin_cos();
        (self.seen_rho() * cos, self.seen_rho() * sin)
    }

    /// Two halves along the side that matters most to the speed: the distance, then the bearing.
    fn halves_at_goal(&self) -> (Self, Self) {
        let (mut low, mut high) = (*self, *self);
        let sides = [100.0 * self.rho.width(), self.alpha.width(), 0.02 * self.phi.width()];
        if sides[0] >= sides[1].max(sides[2]) {
            (low.rho, high.rho) = self.rho.halves();
        } else if sides[1] >= sides[2] {
            (low.alpha, high.alpha) = self.alpha.halves();
        } else {
            (low.phi, high.phi) = self.phi.halves();
        }
        (low, high)
    }
}
