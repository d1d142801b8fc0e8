//! How long does the local law stay in charge at the least, once it has taken over?

use std::collections::BinaryHeap;

use surepose::control::HybridState;
use surepose::scalar::Scalar;

use crate::branching::explore_branches;
use crate::controller::SampledController;
use crate::descent::Descent;
use crate::discrete_state::DiscreteState;
use crate::interval::Interval;
use crate::prioritized_box::PrioritizedBox;
use crate::region::{Region, seen_moving};

/// Into how many distances the seen goal is cut.
const RINGS: usize = 256;
/// No more ticks than these are looked for.
const MAX_TICKS: usize = 500;
/// Regions looked at for the growth of the distance, times the discrete states looked at in each.
const WORK: usize = 14_000;
/// Into how many pieces the noise along the robot is cut.
const PIECES: usize = 8;
/// Ways that the law may take where the goal may be anywhere.
const MAX_BRANCHES: usize = 8192;

/// The least number of ticks between one in which the local law takes over and the next in which it hands back, whatever
/// the noise; 0 if none could be shown.
///
/// The local law takes over where the goal is *seen* near, so that the robot is truly not farther than that and the noise.
/// It hands back where the goal is seen farther than a distance that depends on what it remembers. Between the two noise can
/// lie, but the robot must truly have been led away: ρ² grows by no more than a bound in each tick.
pub(crate) fn dwell<L: SampledController>(
    descent: &Descent<'_, L>,
    capture: f64,
    boxes: &mut usize,
) -> usize {
    let Some(takes_over) = reach(descent, capture, false) else { return 0 };
    let Some(keeps) = reach(descent, capture, true) else { return 0 };
    let Some(mut trim_ticks) = trim_ticks_afar(descent) else { return 0 };
    let Some(growth) = growth(descent, takes_over.max(keeps), boxes) else { return 0 };
    let mut square = Interval::point(takes_over + descent.noise.position).squared();
    for ticks in 0..MAX_TICKS {
        let farthest = square.sqrt().hi();
        let drift = Interval::symmetric(descent.noise.position);
        let rho = if ticks == 0 { takes_over } else { farthest };
        let drift = if ticks == 0 { Interval::point(0.0) } else { drift };
        let region = Region::anywhere(Interval::new(0.0, rho), drift);
        let mut next: Option<Interval> = None;
        for discrete_state in
            descent.known_states().filter(|discrete_state| discrete_state.local_mode == (ticks > 0))
        {
            let memory = descent.step(&region, discrete_state.memory(trim_ticks)).state;
            if ticks > 0 && !memory.local_mode.certain() {
                return ticks;
            }
            if memory.local_mode.possible() {
                next = Some(next.map_or(memory.trim_ticks, |all| all.hull(memory.trim_ticks)));
            }
        }
        let Some(next) = next else { return 0 };
        trim_ticks = next;
        square = square + Interval::new(0.0, growth);
    }
    MAX_TICKS
}

/// The largest seen distance, in steps, at which the local law can be in charge after a tick, having been `before` or not;
/// none if that is not within a few capture radii, or nowhere.
fn reach<L: SampledController>(descent: &Descent<'_, L>, capture: f64, before: bool) -> Option<f64> {
    let all = Interval::new(0.0, 4.0 * capture);
    let possible =
        |rho: Interval| descent.local_possible(&Region::anywhere(rho, Interval::point(0.0)), before);
    if possible(Interval::new(all.hi(), 1e6)) {
        return None;
    }
    (0..RINGS).rev().map(|ring| all.piece(ring, RINGS)).find(|rho| possible(*rho)).map(Interval::hi)
}

/// For how many ticks a law can remember to have trimmed where the local one is not in charge.
fn trim_ticks_afar<L: SampledController>(descent: &Descent<'_, L>) -> Option<Interval> {
    let everywhere = Region::anywhere(Interval::new(0.0, 1e6), Interval::point(0.0));
    let mut trim_ticks = HybridState::<Interval>::new().trim_ticks;
    let complete = descent.known_states().all(|discrete_state| {
        let program = || descent.step(&everywhere, discrete_state.as_memory_set()).state;
        explore_branches(MAX_BRANCHES, program, |memory| {
            if !memory.local_mode.certain() {
                trim_ticks = trim_ticks.hull(memory.trim_ticks);
            }
        })
    });
    complete.then_some(trim_ticks)
}

/// Bound of what a tick of the local law can add to the square of the true distance \[m²].
fn growth<L: SampledController>(descent: &Descent<'_, L>, reach: f64, boxes: &mut usize) -> Option<f64> {
    let seen = Interval::new(0.0, reach);
    let discrete_states: Vec<DiscreteState> = descent.known_states().collect();
    let all = Region::around(seen, &crate::noise::NoiseBounds::default());
    let ranked =
        |region: Region| PrioritizedBox { priority: growth_in(descent, &discrete_states, &region), region };
    let mut open: BinaryHeap<PrioritizedBox> = all.map(ranked).collect();
    for _ in 0..WORK / discrete_states.len().max(1) {
        let Some(worst) = open.pop() else { break };
        *boxes += 1;
        let (low, high) = worst.region.halves_at_goal();
        open.extend([low, high].map(ranked));
    }
    open.peek().map(|worst| worst.priority).filter(|growth| growth.is_finite())
}

/// The same in `region`; infinite where nothing is known.
fn growth_in<L: SampledController>(
    descent: &Descent<'_, L>,
    discrete_states: &[DiscreteState],
    region: &Region,
) -> f64 {
    let mut outcomes = Vec::new();
    let known = discrete_states.iter().all(|discrete_state| {
        descent.branch_outcomes(region, *discrete_state, MAX_BRANCHES, &mut outcomes)
            || !descent.local_possible_from(region, *discrete_state)
    });
    if !known {
        return f64::INFINITY;
    }
    let drive = descent.drive.cast();
    let noise = Interval::symmetric(descent.noise.position);
    let (ahead, aside) = region.true_place(descent.noise.heading);
    let time = Interval::new(0.0, descent.period);
    let mut growth = 0.0_f64;
    for outcome in outcomes.iter().filter(|outcome| outcome.discrete_state.local_mode) {
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
