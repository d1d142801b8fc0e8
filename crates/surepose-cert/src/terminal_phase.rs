//! Terminal phase near the goal: heading bound and dwell time of the local mode.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use surepose::control::NavigationVariables;
use surepose::scalar::Scalar;

use crate::controller::SampledController;
use crate::counterexample::{Counterexample, Rng};
use crate::descent::{BranchOutcome, Descent};
use crate::discrete_state::{DiscreteState, first_shown};
use crate::disturbed_state::DisturbedState;
use crate::interval::Interval;
use crate::region::{Region, seen_moving};

/// Bounds near the goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TerminalPhase {
    /// Heading bound b of the local mode \[rad]. `None`: not shown.
    ///
    /// V = ½θ_e² + ½(ρ cos α/ℓ)² decreases at every tick that ends in local mode and has |θ_e| above this
    /// bound, except on the out leg of a sidestep. A tick in local mode that begins with |θ_e| ≤ b ends so, with the same exception.
    /// From θ_0 and x_0 at entry, |θ_e| therefore never exceeds max(b, √(θ_0² + (x_0/ℓ)²)).
    pub heading_bound: Option<f64>,
    /// Length ℓ in V \[m].
    pub length: f64,
    /// Least number of ticks in local mode after entry, for any noise. 0: not shown. At most 500.
    pub switch_dwell: usize,
}

impl TerminalPhase {
    /// Whether noise cannot toggle the local mode at every tick.
    pub fn has_switch_hysteresis(&self) -> bool {
        self.switch_dwell > 1
    }
}

/// Heading bounds tried, in addition to twice the heading noise \[rad].
const HEADINGS: [f64; 2] = [0.12, 0.24];
/// ℓ \[m]; large, so that the distance term, which noise can raise by millimeters, has little weight.
const LENGTH: f64 = 0.4;
/// Number of random states in the search for a violation.
const LOCAL_TRIALS: usize = 20_000;
/// Distances at which the local mode must be active \[m].
const ON_THE_GOAL: fn() -> Interval = || Interval::new(0.0, 1e-6);
/// Maximum number of boxes per heading bound.
const MAX_REGIONS: usize = 100_000;
/// Angular width \[rad] below which a box is not bisected.
const MIN_WIDTH: f64 = 4e-3;
/// Numbers of pieces of the along-track noise; the second is used where the first fails.
const PIECES: [usize; 2] = [1, 13];

pub(crate) fn terminal_phase<L: SampledController>(
    descent: &mut Descent<'_, L>,
    capture: f64,
    boxes: &mut usize,
) -> TerminalPhase {
    let heading_bound = heading_bound(descent, capture, boxes);
    let switch_dwell = crate::switch::dwell(descent, capture, boxes);
    TerminalPhase { heading_bound, length: LENGTH, switch_dwell }
}

/// Heading bound of [`TerminalPhase`]. `None`: not shown, or the local mode may be inactive at the goal.
pub(crate) fn heading_bound<L: SampledController>(
    descent: &mut Descent<'_, L>,
    capture: f64,
    boxes: &mut usize,
) -> Option<f64> {
    // The tick of the mode switch is included: all reachable discrete states are considered.
    descent.prepare_for_any_past();
    let (near, whole) = reach_of_local(descent, capture);
    if !whole || !descent.local_certain(&Region::anywhere(ON_THE_GOAL(), Interval::point(0.0))) {
        return None;
    }
    let above = HEADINGS.into_iter().map(|above| 2.0 * descent.noise.heading + above);
    above.into_iter().find(|bound| heading_falls(descent, near, *bound, LENGTH, boxes))
}

/// Searches for a state near the goal in which V does not decrease without noise. `None`: none found.
pub(crate) fn local_counterexample<L: SampledController>(
    descent: &mut Descent<'_, L>,
    capture: f64,
) -> Option<Counterexample> {
    // If no discrete state of the local mode is reachable, all reachable states are tried.
    let discrete_states = Some(local_states(descent)).filter(|discrete_states| !discrete_states.is_empty());
    let discrete_states = discrete_states.unwrap_or_else(|| descent.known_states().collect());
    let (near, _) = reach_of_local(descent, capture);
    let mut rng = Rng(0x10ca_11a5);
    (0..LOCAL_TRIALS).find_map(|k| {
        let rho = near.hi() * rng.part();
        // With the goal at the robot's side, the along-track distance is 0 and only the turn matters.
        let alpha = if k % 2 == 0 { FRAC_PI_2 * rng.either().signum() } else { PI * rng.either() };
        let discrete_state = *discrete_states.get(k % discrete_states.len().max(1))?;
        let disturbed_state = DisturbedState::polar(rho, alpha, PI * rng.either(), discrete_state);
        let transition = disturbed_state.simulate(
            descent.controller,
            &descent.drive,
            descent.period,
            &descent.lyapunov,
            descent.limited,
        );
        let side = transition.discrete_state.turn_direction;
        let fall = local_lyapunov(&transition.before, side) - local_lyapunov(&transition.after, side);
        let counts = transition.before.heading_error().radians().abs() > HEADINGS[0];
        let violates = if transition.discrete_state.local_mode {
            counts && transition.discrete_state.claims_heading() && fall <= 1e-12
        } else {
            rho < ON_THE_GOAL().hi()
        };
        violates.then_some(Counterexample { disturbed_state, transition, limited: descent.limited })
    })
}

/// V of [`TerminalPhase`] for turn direction `side`, to rounding.
fn local_lyapunov(goal: &NavigationVariables<f64>, side: i8) -> f64 {
    let (_, cos) = goal.alpha.sin_cos();
    let (error, side) = (goal.heading_error().radians(), f64::from(side));
    let heading = if error * side > FRAC_PI_2 { error - TAU * side } else { error };
    let ahead = goal.rho * cos / LENGTH;
    0.5 * (heading * heading + ahead * ahead)
}

/// Reachable discrete states of the local mode with a decided turn direction.
fn local_states<L: SampledController>(descent: &Descent<'_, L>) -> Vec<DiscreteState> {
    descent
        .known_states()
        .filter(|discrete_state| discrete_state.local_mode && discrete_state.turn_direction != 0)
        .collect()
}

/// Estimated distances at which the local mode can be active \[m], and whether the range is complete.
fn reach_of_local<L: SampledController>(descent: &Descent<'_, L>, capture: f64) -> (Interval, bool) {
    const RINGS: usize = 64;
    // The mode may persist or begin in the tick; both cases count.
    let possible =
        |region: &Region| [true, false].into_iter().any(|before| descent.local_possible(region, before));
    let all = Interval::new(0.0, 4.0 * capture);
    let beyond = Region::anywhere(Interval::new(all.hi(), 1e6), Interval::point(0.0));
    let farthest = (0..RINGS)
        .rev()
        .map(|ring| all.piece(ring, RINGS))
        .find(|rho| possible(&Region::anywhere(*rho, Interval::point(0.0))));
    let reach = farthest.map_or(0.0, Interval::hi);
    (Interval::new(0.0, reach), !possible(&beyond))
}

/// Shows that V decreases in local mode wherever |θ_e| ≥ `bound` \[rad].
fn heading_falls<L: SampledController>(
    descent: &Descent<'_, L>,
    near: Interval,
    bound: f64,
    length: f64,
    boxes: &mut usize,
) -> bool {
    let mut open: Vec<Region> = Region::around_seen(near).collect();
    let mut looked = 0;
    let mut discrete_states = descent.discrete_states.clone();
    while let Some(region) = open.pop() {
        looked += 1;
        *boxes += 1;
        if first_shown(&mut discrete_states, |discrete_state, known| {
            shown_for(descent, &region, discrete_state, known, (bound, length))
        }) {
            continue;
        }
        if looked > MAX_REGIONS || region.size() < MIN_WIDTH {
            return false;
        }
        let (low, high) = region.halves_near();
        open.extend([low, high]);
    }
    true
}

/// Shows the decrease in `region` from `discrete_state`; skips outcomes in `harmless`.
fn shown_for<L: SampledController>(
    descent: &Descent<'_, L>,
    region: &Region,
    discrete_state: DiscreteState,
    harmless: &mut Vec<BranchOutcome>,
    (bound, length): (f64, f64),
) -> bool {
    let mut outcomes = Vec::new();
    if !descent.outcomes(region, discrete_state, &mut outcomes) {
        return !descent.local_possible_from(region, discrete_state);
    }
    outcomes.retain(|outcome| outcome.discrete_state.claims_heading() && !harmless.contains(outcome));
    let shown = outcomes.iter().all(|outcome| {
        let truth = region.heading_error(outcome.discrete_state) + Interval::symmetric(descent.noise.heading);
        let parts = [Interval::new(bound, TAU), Interval::new(-TAU, -bound)];
        let mut errors = parts.into_iter().filter_map(|part| truth.intersection(part));
        let inside = truth.intersection(Interval::symmetric(bound));
        inside.is_none_or(|error| stays_within(descent, outcome, error, bound))
            && errors.all(|error| falls(descent, region, outcome, error, length))
    });
    harmless.append(&mut outcomes);
    shown
}

/// Whether |θ_e| ≤ `bound` during a tick with initial heading error `error` \[rad].
fn stays_within<L: SampledController>(
    descent: &Descent<'_, L>,
    outcome: &BranchOutcome,
    error: Interval,
    bound: f64,
) -> bool {
    let omega = descent.noise.driven(&descent.drive.cast(), outcome.twist).all.omega;
    let time = Interval::new(0.0, descent.period);
    // Rounding widens an unchanged error by an ulp, which the rest of the tick does not.
    let edge = Interval::symmetric(bound * (1.0 + 1e-12));
    edge.encloses(error + time * omega)
}

/// Whether V̇ < 0 during a tick with initial heading error `error` \[rad], with the along-track noise in
/// pieces.
fn falls<L: SampledController>(
    descent: &Descent<'_, L>,
    region: &Region,
    outcome: &BranchOutcome,
    error: Interval,
    length: f64,
) -> bool {
    let twist = descent.noise.driven(&descent.drive.cast(), outcome.twist).all;
    let noise = Interval::symmetric(descent.noise.position);
    let (seen_ahead, aside) = region.true_place(descent.noise.heading);
    let aside = aside + noise;
    let time = Interval::new(0.0, descent.period);
    let per_square = Interval::point(1.0) / Interval::point(length).squared();
    let turning = (error + time * twist.omega) * twist.omega;
    PIECES.into_iter().any(|pieces| {
        // The noise has its largest effect at an end of its range, so the end pieces come first.
        let mut ends_first = (0..pieces).map(|k| if k % 2 == 0 { k / 2 } else { pieces - 1 - k / 2 });
        ends_first.all(|piece| {
            let (ahead, rate) = seen_moving(seen_ahead + noise.piece(piece, pieces), aside, twist, time);
            (turning + ahead * rate * per_square).hi() < 0.0
        })
    })
}

impl Region {
    /// Iterates over boxes with estimated distances `rho`, by quadrants of both angles.
    fn around_seen(rho: Interval) -> impl Iterator<Item = Self> {
        Self::around(rho, &crate::noise::NoiseBounds::default())
    }

    /// Bisects the wider angle, or the distance.
    fn halves_near(&self) -> (Self, Self) {
        let (mut low, mut high) = (*self, *self);
        let (alpha, phi) = (self.alpha.width(), self.phi.width());
        if self.rho.width() > 0.02 * alpha.max(phi) {
            (low.rho, high.rho) = self.rho.halves();
        } else if alpha > phi {
            (low.alpha, high.alpha) = self.alpha.halves();
        } else {
            (low.phi, high.phi) = self.phi.halves();
        }
        (low, high)
    }

    /// Estimated θ_e, unwrapped toward the turn direction of `discrete_state`, which is the sign of −θ_e
    /// \[rad].
    fn heading_error(&self, discrete_state: DiscreteState) -> Interval {
        let plain = self.phi - self.alpha;
        let turns = (plain.mid() / TAU).round();
        let error = plain - crate::region::half_turns(2) * Interval::point(turns);
        if -error.mid() * f64::from(discrete_state.turn_direction) < -FRAC_PI_2 {
            return error - crate::region::half_turns(2 * discrete_state.turn_direction);
        }
        error
    }
}
