//! Lower bound of the local mode's dwell time.

use std::collections::BinaryHeap;

use surepose::control::HybridState;
use surepose::scalar::Scalar;

use crate::branching::explore_branches;
use crate::controller::SampledController;
use crate::descent::{BranchOutcome, Descent};
use crate::discrete_state::DiscreteState;
use crate::interval::Interval;
use crate::prioritized_box::PrioritizedBox;
use crate::region::{Region, seen_moving};

/// Number of pieces of the estimated distance.
const RINGS: usize = 256;
/// Largest dwell time searched \[ticks].
const MAX_TICKS: usize = 500;
/// Boxes evaluated for the growth of the distance, times discrete states per box.
const WORK: usize = 14_000;
/// Number of pieces of the along-track noise.
const PIECES: usize = 8;
/// Maximum number of branches of the control law, for any goal position.
const MAX_BRANCHES: usize = 8192;

/// Returns the least number of ticks from entry into the local mode to exit from it, or to a sidestep, for any noise.
///
/// 0: no bound was shown. The local mode begins at a small *estimated* distance, so the true distance is at
/// most that plus the position noise. It ends at an estimated distance that depends on the hybrid state.
/// Noise can bridge part of the difference; the true motion must supply the rest, and ρ² grows by a bounded
/// amount per tick.
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
            straight_states(descent).filter(|discrete_state| discrete_state.local_mode == (ticks > 0))
        {
            let set = discrete_state.memory(trim_ticks, DiscreteState::ANY_LATERAL());
            let memory = descent.step(&region, set).state;
            let stays = memory.local_mode.certain() && memory.sidestep.magnitude() <= 0.0;
            if ticks > 0 && !stays {
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

/// Reachable discrete states outside of sidesteps, and after the first tick if that decides a turn direction.
fn straight_states<L: SampledController>(descent: &Descent<'_, L>) -> impl Iterator<Item = DiscreteState> {
    let decides = descent.known_states().any(|discrete_state| discrete_state.turn_direction != 0);
    descent.known_states().filter(move |discrete_state| {
        discrete_state.sidestep == 0 && (discrete_state.turn_direction != 0 || !decides)
    })
}

/// Largest estimated distance at which the local mode can be active after a tick \[m].
///
/// `before` is the mode before the tick. `None`: the distance exceeds four capture radii, or no such distance
/// exists.
fn reach<L: SampledController>(descent: &Descent<'_, L>, capture: f64, before: bool) -> Option<f64> {
    let all = Interval::new(0.0, 4.0 * capture);
    let possible = |rho: Interval| {
        let region = Region::anywhere(rho, Interval::point(0.0));
        straight_states(descent)
            .filter(|discrete_state| discrete_state.local_mode == before)
            .any(|discrete_state| descent.local_possible_from(&region, discrete_state))
    };
    if possible(Interval::new(all.hi(), 1e6)) {
        return None;
    }
    (0..RINGS).rev().map(|ring| all.piece(ring, RINGS)).find(|rho| possible(*rho)).map(Interval::hi)
}

/// Range of the trim tick count outside of the local mode. `None`: not determined.
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

/// Bounds the growth of the squared true distance per tick in local mode \[m²], before the first sidestep. `None`: no bound.
fn growth<L: SampledController>(descent: &Descent<'_, L>, reach: f64, boxes: &mut usize) -> Option<f64> {
    let seen = Interval::new(0.0, reach);
    let discrete_states: Vec<DiscreteState> = straight_states(descent).collect();
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

/// Bounds the growth in `region` \[m²]. ∞: no bound.
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
    let stays =
        |outcome: &&BranchOutcome| outcome.discrete_state.local_mode && outcome.discrete_state.sidestep == 0;
    for outcome in outcomes.iter().filter(stays) {
        let twist = descent.noise.driven(&drive, outcome.twist).all;
        for piece in 0..PIECES {
            // d(ρ²)/dt = −2·v·x, with the goal at x in the body frame.
            let ahead = ahead + noise.piece(piece, PIECES);
            let (ahead, _) = seen_moving(ahead, aside + noise, twist, time);
            let rate = Interval::point(-2.0) * twist.v * ahead * time;
            growth = growth.max(rate.hi());
        }
    }
    growth
}

impl Region {
    /// Goal position in the body frame \[m], with the heading noise but without the position noise.
    pub(crate) fn true_place(&self, heading_noise: f64) -> (Interval, Interval) {
        let (sin, cos) = (self.alpha + Interval::symmetric(heading_noise)).sin_cos();
        (self.seen_rho() * cos, self.seen_rho() * sin)
    }

    /// Bisects the side with the most influence on the speed: first distance, then bearing.
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
