//! Upper bounds of the change of W in a box, for all disturbances within bounds.

use core::f64::consts::{PI, TAU};

use surepose::control::{ControlOutput, HybridState};
use surepose::kinematics::{DiffDrive, Twist};
use surepose::scalar::Scalar;

use crate::branching::explore_branches;
use crate::controller::SampledController;
use crate::discrete_state::{DiscreteState, first_shown};
use crate::interval::Interval;
use crate::lyapunov::{LyapunovFunction, Truth, window};
use crate::noise::{DrivenTwist, NoiseBounds};
use crate::region::{Region, half_turns};

/// Maximum number of branches per box. A box with more branches is bisected.
const MAX_BRANCHES: usize = 64;

/// Width of α̂ \[rad] and bound of Ẇ \[1/s] above which the box is bisected, not its noise interval.
const COARSE: f64 = 0.15;
const HOPELESS: f64 = 3.0;

/// Angle beyond ±π \[rad] for which a law without turn direction keeps the representative of the estimate.
///
/// At ±π rounding alone decides on which side the true angle is. The representative beyond ±π has a square that exceeds the smallest
/// one by at most 4π times this angle.
const ON_THE_CUT: f64 = 1e-13;

/// Decrease problem for one control law and one period.
pub(crate) struct Descent<'a, L> {
    pub(crate) controller: &'a L,
    pub(crate) drive: DiffDrive<f64>,
    pub(crate) noise: NoiseBounds,
    pub(crate) period: f64,
    pub(crate) lyapunov: LyapunovFunction,
    /// Whether the wheel limits apply.
    pub(crate) limited: bool,
    /// Discrete states considered for the current range of distances.
    pub(crate) discrete_states: Vec<DiscreteState>,
    /// Speed that no wheel command may exceed, at the rim \[m/s].
    pub(crate) rim_limit: f64,
    /// All reachable discrete states, for any goal position.
    pub(crate) reachable: Vec<DiscreteState>,
}

/// Result of one branch of the control law in a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BranchOutcome {
    pub(crate) discrete_state: DiscreteState,
    pub(crate) twist: Twist<Interval>,
}

/// Upper bounds of the change of W.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DecreaseBound {
    /// Mean of Ẇ over the period \[1/s].
    pub(crate) rate: f64,
    /// Jump of W at a change of the discrete state.
    pub(crate) jump: f64,
}

impl<L: SampledController> Descent<'_, L> {
    /// Fills in the reachable discrete states.
    pub(crate) fn with_reachable_states(mut self) -> Self {
        self.reachable = self.find_reachable();
        self
    }

    /// Computes the commanded twist and the next hybrid state.
    pub(crate) fn step(&self, region: &Region, memory: HybridState<Interval>) -> ControlOutput<Interval> {
        let output = self.controller.compute(&region.seen(), memory);
        if self.limited {
            ControlOutput { twist: self.controller.limit(output.twist), ..output }
        } else {
            output
        }
    }

    /// Adds all outcomes in `region` from `discrete_state` to `into`; returns `false` if they are not
    /// determined.
    pub(crate) fn outcomes(
        &self,
        region: &Region,
        discrete_state: DiscreteState,
        into: &mut Vec<BranchOutcome>,
    ) -> bool {
        self.branch_outcomes(region, discrete_state, MAX_BRANCHES, into)
    }

    /// [`Descent::outcomes`] with at most `most` branches.
    pub(crate) fn branch_outcomes(
        &self,
        region: &Region,
        discrete_state: DiscreteState,
        most: usize,
        into: &mut Vec<BranchOutcome>,
    ) -> bool {
        let mut known = true;
        let program = || self.step(region, discrete_state.as_memory_set());
        let complete = explore_branches(most, program, |ControlOutput { twist, state: memory }| {
            match DiscreteState::from_memory(&memory) {
                Some(discrete_state) => {
                    let outcome = BranchOutcome { discrete_state, twist };
                    if !into.contains(&outcome) {
                        into.push(outcome);
                    }
                }
                None => known = false,
            }
        });
        known && complete
    }

    /// Whether the local mode can be active after a tick; `before` is its value before the tick.
    pub(crate) fn local_possible(&self, region: &Region, before: bool) -> bool {
        self.known_states()
            .filter(|discrete_state| discrete_state.local_mode == before)
            .any(|discrete_state| self.local_possible_from(region, discrete_state))
    }

    /// Whether the local mode can be active after a tick from `discrete_state`.
    pub(crate) fn local_possible_from(&self, region: &Region, discrete_state: DiscreteState) -> bool {
        self.step(region, discrete_state.as_memory_set()).state.local_mode.possible()
    }

    /// Whether the local mode is active after a tick from every reachable discrete state.
    pub(crate) fn local_certain(&self, region: &Region) -> bool {
        self.known_states().all(|discrete_state| {
            self.step(region, discrete_state.as_memory_set()).state.local_mode.certain()
        })
    }

    /// Considers all reachable discrete states, as unbounded noise requires.
    pub(crate) fn prepare_for_any_past(&mut self) {
        self.discrete_states.clone_from(&self.reachable);
    }

    /// Iterates over all reachable discrete states, for any goal position.
    pub(crate) fn known_states(&self) -> impl Iterator<Item = DiscreteState> + '_ {
        self.reachable.iter().copied()
    }

    /// Considers only the discrete states possible at true distances `rho` \[m].
    pub(crate) fn prepare(&mut self, rho: Interval) {
        if !self.limited {
            // Without limits, the distance before the previous tick is unbounded.
            return self.prepare_for_any_past();
        }
        let fastest = (self.rim_limit * (1.0 + self.noise.rim_speed_part) + self.noise.rim_speed).next_up();
        self.discrete_states = self.states_at(rho, (fastest * self.period).next_up());
    }

    /// Returns the discrete states possible at true distances `rho`.
    ///
    /// These are the initial state and the results of a previous tick that began at most `step` \[m] away.
    fn states_at(&self, rho: Interval, step: f64) -> Vec<DiscreteState> {
        let drift = Interval::symmetric(step) + Interval::symmetric(self.noise.position);
        let here = Region::anywhere(rho, drift);
        let mut discrete_states: Vec<DiscreteState> = self
            .known_states()
            .flat_map(|before| DiscreteState::possible(&self.step(&here, before.as_memory_set()).state))
            .filter(|after| self.reachable.contains(after))
            .collect();
        discrete_states.push(DiscreteState::INITIAL);
        discrete_states.sort_by_key(|discrete_state| discrete_state.index());
        discrete_states.dedup();
        discrete_states
    }

    /// Computes all discrete states reachable from the initial one, for any goal position.
    fn find_reachable(&self) -> Vec<DiscreteState> {
        let everywhere = Region::anywhere(Interval::new(0.0, 1e6), Interval::point(0.0));
        let mut reachable = vec![DiscreteState::INITIAL];
        let mut next = 0;
        while let Some(&before) = reachable.get(next) {
            let memory = self.step(&everywhere, before.as_memory_set()).state;
            let new: Vec<DiscreteState> =
                DiscreteState::possible(&memory).filter(|after| !reachable.contains(after)).collect();
            reachable.extend(new);
            next += 1;
        }
        reachable
    }

    /// Bounds the change of W in `region` over all `discrete_states`.
    ///
    /// The evaluation stops at the first state with a bound above −`required` and moves that state to the
    /// front.
    pub(crate) fn fall(
        &self,
        region: &Region,
        required: f64,
        discrete_states: &mut [DiscreteState],
    ) -> DecreaseBound {
        let mut fall = DecreaseBound { rate: f64::NEG_INFINITY, jump: f64::NEG_INFINITY };
        let turn = region.turn(&self.noise);
        first_shown(discrete_states, |discrete_state, known| {
            let complete = self.fall_from(region, discrete_state, (turn, required), known, &mut fall);
            if !complete {
                fall = DecreaseBound { rate: f64::INFINITY, jump: f64::INFINITY };
            }
            fall.jump <= 0.0 && fall.rate <= -required
        });
        fall
    }

    /// Merges the bounds for one discrete state into `fall`; skips `known` outcomes. `false`: no bound
    /// exists.
    fn fall_from(
        &self,
        region: &Region,
        before: DiscreteState,
        (turn, required): (f64, f64),
        known: &mut Vec<BranchOutcome>,
        fall: &mut DecreaseBound,
    ) -> bool {
        let mut from_here = Vec::new();
        if !self.outcomes(region, before, &mut from_here) {
            return false;
        }
        for outcome in from_here {
            if outcome.discrete_state.turn_direction == 0 && !self.stays_undecided() {
                return false;
            }
            if (before != DiscreteState::INITIAL || self.stays_undecided())
                && !before.has_same_lyapunov(outcome.discrete_state)
            {
                fall.jump = fall.jump.max(self.jump(region, before, outcome.discrete_state, turn));
            }
            if !known.contains(&outcome) {
                if self.limited && self.too_fast(&outcome) {
                    return false;
                }
                fall.rate = fall.rate.max(self.rate(region, &outcome, turn, required));
                known.push(outcome);
            }
            if fall.jump > 0.0 || fall.rate > -required {
                break;
            }
        }
        true
    }

    /// Whether the control law never decides on a turn direction.
    ///
    /// Otherwise the initial state exists in the first tick only, and W is defined after that tick.
    fn stays_undecided(&self) -> bool {
        self.discrete_states.iter().all(|discrete_state| discrete_state.turn_direction == 0)
    }

    /// Whether a wheel command certainly exceeds the speed limit, beyond rounding.
    fn too_fast(&self, outcome: &BranchOutcome) -> bool {
        let rims = self.drive.cast().wheel_speeds_from_twist(outcome.twist).max_abs();
        rims.lo() > self.rim_limit * (1.0 + 1e-9)
    }

    /// Bounds the jump of W at the change from discrete state `before` to `after`.
    fn jump(&self, region: &Region, before: DiscreteState, after: DiscreteState, turn: f64) -> f64 {
        let shift = Interval::symmetric(turn) + Interval::symmetric(self.noise.heading);
        let (from, to) = (region.lift(before), region.lift(after));
        let alpha = region.alpha + shift;
        // Both terms contain the same noise, so a² − b² is evaluated as (a − b)(a + b).
        let bearing = |from: i8| {
            let rise = half_turns(to.0 - from) * (alpha + alpha + half_turns(to.0) + half_turns(from));
            if to.0 == from { 0.0 } else { rise.hi() }
        };
        let mut squares = bearing(from.0);
        // At the edge of its window, the true previous bearing may have the other representative.
        let was = alpha + half_turns(from.0);
        if !window(before.turn_direction).encloses(was) {
            let other = if was.mid() > 0.0 { from.0 - 2 } else { from.0 + 2 };
            squares = squares.max(bearing(other));
        }
        if before.reverse != after.reverse {
            // φ| becomes π − |φ|, so φ² decreases by 2π(|φ| − π/2).
            let was = (region.phi + half_turns(from.1) + Interval::symmetric(turn)).abs();
            let least = was.lo().min((half_turns(2) - was).lo());
            let pi = half_turns(1);
            let square = pi * (pi - Interval::point(2.0) * Interval::point(least));
            squares = (squares + (self.lyapunov.approach * square.hi()).next_up()).next_up();
        }
        0.5 * squares
    }

    /// Bounds the mean of Ẇ while the twist of `outcome` is held \[1/s].
    fn rate(&self, region: &Region, outcome: &BranchOutcome, turn: f64, required: f64) -> f64 {
        let twist = self.noise.driven(&self.drive.cast(), outcome.twist);
        let mut worst = f64::INFINITY;
        for (slices, times) in [(1, 1), (4, 1), (8, 2)] {
            worst = f64::NEG_INFINITY;
            for slice in 0..slices {
                let e = Interval::symmetric(turn).piece(slice, slices);
                worst = worst.max(self.rate_at(region, outcome.discrete_state, e, &twist, times));
                if worst > -required {
                    break;
                }
            }
            let hopeless = region.alpha.width() > COARSE || worst > HOPELESS;
            if worst <= -required || hopeless {
                break;
            }
        }
        worst
    }

    /// Returns the true goal geometry for a direction error `e` \[rad] (true minus estimated).
    pub(crate) fn truth(&self, region: &Region, discrete_state: DiscreteState, e: Interval) -> Truth {
        let lift = region.lift(discrete_state);
        Truth {
            rho: region.rho,
            bearing: region.alpha + half_turns(lift.0) + e + Interval::symmetric(self.noise.heading),
            approach: region.phi + half_turns(lift.1) + e,
            reverse: discrete_state.reverse,
        }
    }

    /// Bounds the mean of Ẇ for a direction error `e` \[rad] \[1/s].
    fn rate_at(
        &self,
        region: &Region,
        discrete_state: DiscreteState,
        e: Interval,
        twist: &DrivenTwist,
        times: usize,
    ) -> f64 {
        let Truth { bearing, approach, .. } = self.truth(region, discrete_state, e);
        let mut worst = f64::NEG_INFINITY;
        // What the representatives beyond ±π add to W in one tick.
        let beyond = (1.0 + self.lyapunov.approach) * 2.0 * TAU * ON_THE_CUT / self.period;
        for bearing in
            if discrete_state.turn_direction == 0 { on_circle(bearing) } else { [Some(bearing), None] }
                .into_iter()
                .flatten()
        {
            for approach in on_circle(approach).into_iter().flatten() {
                let truth = Truth { rho: region.rho, bearing, approach, reverse: discrete_state.reverse };
                if discrete_state.turn_direction != 0 {
                    let inside = truth
                        .swept(twist.all, self.period)
                        .is_some_and(|swept| window(discrete_state.turn_direction).encloses(swept.bearing));
                    if !inside {
                        return f64::INFINITY;
                    }
                }
                worst = worst.max(self.lyapunov.mean_rate(&truth, twist, self.period, times) + beyond);
            }
        }
        worst
    }
}

/// Splits an angle at ±π and wraps the outer part; W uses the smallest square.
///
/// An angle beyond ±π by at most [`ON_THE_CUT`] is not wrapped.
fn on_circle(angle: Interval) -> [Option<Interval>; 2] {
    let circle = Interval::symmetric(PI + ON_THE_CUT);
    let turn = if angle.mid() > 0.0 { half_turns(-2) } else { half_turns(2) };
    let outside = !circle.encloses(angle);
    [angle.intersection(circle), if outside { (angle + turn).intersection(circle) } else { None }]
}
