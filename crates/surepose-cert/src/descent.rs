//! Does W fall in this region, at every tick, whatever the noise does?

use core::f64::consts::PI;

use surepose::control::{ControlOutput, HybridState};
use surepose::kinematics::{DiffDrive, Twist};
use surepose::scalar::Scalar;

use crate::branching::explore_branches;
use crate::controller::SampledController;
use crate::discrete_state::{DiscreteState, first_shown};
use crate::interval::Interval;
use crate::lyapunov::{LyapunovFunction, Truth, window};
use crate::noise::NoiseBounds;
use crate::region::{Region, half_turns};

/// Ways through the law beyond which a region is cut rather than followed: it is too large.
const MAX_BRANCHES: usize = 64;

/// Width of α̂ \[rad], and bound of Ẇ \[1/s], above which cutting the noise does not help: the region is to be cut.
const COARSE: f64 = 0.15;
const HOPELESS: f64 = 3.0;

/// What is to be shown, for one law and one period.
pub(crate) struct Descent<'a, L> {
    pub(crate) controller: &'a L,
    pub(crate) drive: DiffDrive<f64>,
    pub(crate) noise: NoiseBounds,
    pub(crate) period: f64,
    pub(crate) lyapunov: LyapunovFunction,
    /// Whether the wheels' limits are in force.
    pub(crate) limited: bool,
    /// The discrete states that the law can be in.
    pub(crate) discrete_states: Vec<DiscreteState>,
    /// What no rim may be told to exceed \[m/s].
    pub(crate) rim_limit: f64,
    /// Every discrete state that the law can come to be in, wherever the goal is.
    pub(crate) reachable: Vec<DiscreteState>,
}

/// One thing that the law may do in a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BranchOutcome {
    pub(crate) discrete_state: DiscreteState,
    pub(crate) twist: Twist<Interval>,
}

/// Upper bounds of what W does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DecreaseBound {
    /// Ẇ, averaged over the period \[1/s].
    pub(crate) rate: f64,
    /// The jump of W where the law changes its discrete state.
    pub(crate) jump: f64,
}

impl<L: SampledController> Descent<'_, L> {
    /// The same, knowing which discrete states the law can come to.
    pub(crate) fn with_reachable_states(mut self) -> Self {
        self.reachable = self.find_reachable();
        self
    }

    /// The step that the robot is told.
    pub(crate) fn step(&self, region: &Region, memory: HybridState<Interval>) -> ControlOutput<Interval> {
        let output = self.controller.compute(&region.seen(), memory);
        if self.limited {
            ControlOutput { twist: self.controller.limit(output.twist), ..output }
        } else {
            output
        }
    }

    /// What the law does in `region`, having been of `discrete_state`; nothing if that cannot be told.
    pub(crate) fn outcomes(
        &self,
        region: &Region,
        discrete_state: DiscreteState,
        into: &mut Vec<BranchOutcome>,
    ) -> bool {
        self.branch_outcomes(region, discrete_state, MAX_BRANCHES, into)
    }

    /// The same, following more ways or fewer.
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

    /// Whether the local law can be in charge after this tick, having been in charge before or not.
    pub(crate) fn local_possible(&self, region: &Region, before: bool) -> bool {
        self.known_states()
            .filter(|discrete_state| discrete_state.local_mode == before)
            .any(|discrete_state| self.local_possible_from(region, discrete_state))
    }

    /// Whether the local law can be in charge after a tick that began with `discrete_state`.
    pub(crate) fn local_possible_from(&self, region: &Region, discrete_state: DiscreteState) -> bool {
        self.step(region, discrete_state.as_memory_set()).state.local_mode.possible()
    }

    /// Whether the local law is in charge after this tick, whoever was before.
    pub(crate) fn local_certain(&self, region: &Region) -> bool {
        self.known_states().all(|discrete_state| {
            self.step(region, discrete_state.as_memory_set()).state.local_mode.certain()
        })
    }

    /// Considers, from here on, every discrete state that the law can come to be in anywhere: for noise without bounds.
    pub(crate) fn prepare_for_any_past(&mut self) {
        self.discrete_states.clone_from(&self.reachable);
    }

    /// Every discrete state that the law can come to be in, wherever the goal is.
    pub(crate) fn known_states(&self) -> impl Iterator<Item = DiscreteState> + '_ {
        self.reachable.iter().copied()
    }

    /// Considers, from here on, the discrete states that the law can be in at true distances `rho`.
    pub(crate) fn prepare(&mut self, rho: Interval) {
        if !self.limited {
            // Nothing bounds how far away the tick before began.
            return self.prepare_for_any_past();
        }
        let fastest = (self.rim_limit * (1.0 + self.noise.rim_speed_part) + self.noise.rim_speed).next_up();
        self.discrete_states = self.states_at(rho, (fastest * self.period).next_up());
    }

    /// The discrete states that the law can be in at true distances `rho`: the fresh one, and those that the tick before can have
    /// left it in, which began at most `step` \[m] farther or nearer.
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

    /// The fresh discrete state, and all that the law can come to from it, wherever the goal is.
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

    /// Bounds what W does in `region` for a law that was of one of `discrete_states`; stops where it is above −`required` anyway, and
    /// brings the discrete state where it is to the front.
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

    /// The same for one discrete state, added to `fall`, as far as its outcomes are not `known`; false where nothing is known of one.
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

    /// Whether the law never decides on a side. Else the fresh discrete state is that of the first tick only, and W, which
    /// depends on the side, begins after it.
    fn stays_undecided(&self) -> bool {
        self.discrete_states.iter().all(|discrete_state| discrete_state.turn_direction == 0)
    }

    /// Whether a rim is told to exceed its limit, beyond rounding.
    fn too_fast(&self, outcome: &BranchOutcome) -> bool {
        let rims = self.drive.cast().wheel_speeds_from_twist(outcome.twist).max_abs();
        rims.lo() > self.rim_limit * (1.0 + 1e-9)
    }

    /// How W jumps when the law changes from discrete state `before` to `after`.
    fn jump(&self, region: &Region, before: DiscreteState, after: DiscreteState, turn: f64) -> f64 {
        let shift = Interval::symmetric(turn) + Interval::symmetric(self.noise.heading);
        let (from, to) = (region.lift(before), region.lift(after));
        let alpha = region.alpha + shift;
        // The noise is the same on both sides, so a² − b² is taken as (a − b)(a + b).
        let bearing = |from: i8| {
            let rise = half_turns(to.0 - from) * (alpha + alpha + half_turns(to.0) + half_turns(from));
            if to.0 == from { 0.0 } else { rise.hi() }
        };
        let mut squares = bearing(from.0);
        // At the edge of its window the true bearing before may have been continued the other way.
        let was = alpha + half_turns(from.0);
        if !window(before.turn_direction).encloses(was) {
            let other = if was.mid() > 0.0 { from.0 - 2 } else { from.0 + 2 };
            squares = squares.max(bearing(other));
        }
        if before.reverse != after.reverse {
            // |φ| becomes π − |φ|: the square falls by 2π(|φ| − π/2).
            let was = (region.phi + half_turns(from.1) + Interval::symmetric(turn)).abs();
            let least = was.lo().min((half_turns(2) - was).lo());
            let pi = half_turns(1);
            let square = pi * (pi - Interval::point(2.0) * Interval::point(least));
            squares = (squares + (self.lyapunov.approach * square.hi()).next_up()).next_up();
        }
        0.5 * squares
    }

    /// How W falls while the twist of `outcome` is held.
    fn rate(&self, region: &Region, outcome: &BranchOutcome, turn: f64, required: f64) -> f64 {
        let twist = self.noise.driven(&self.drive.cast(), outcome.twist);
        let mut worst = f64::INFINITY;
        for (slices, times) in [(1, 1), (4, 1), (8, 2)] {
            worst = f64::NEG_INFINITY;
            for slice in 0..slices {
                let e = Interval::symmetric(turn).piece(slice, slices);
                worst = worst.max(self.rate_at(region, outcome.discrete_state, e, twist, times));
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

    /// The goal as it truly lies where its direction is `e` more than seen.
    pub(crate) fn truth(&self, region: &Region, discrete_state: DiscreteState, e: Interval) -> Truth {
        let lift = region.lift(discrete_state);
        Truth {
            rho: region.rho,
            bearing: region.alpha + half_turns(lift.0) + e + Interval::symmetric(self.noise.heading),
            approach: region.phi + half_turns(lift.1) + e,
            reverse: discrete_state.reverse,
        }
    }

    /// The same where the direction of the goal is `e` more than seen.
    fn rate_at(
        &self,
        region: &Region,
        discrete_state: DiscreteState,
        e: Interval,
        twist: Twist<Interval>,
        times: usize,
    ) -> f64 {
        let Truth { bearing, approach, .. } = self.truth(region, discrete_state, e);
        let mut worst = f64::NEG_INFINITY;
        for bearing in
            if discrete_state.turn_direction == 0 { on_circle(bearing) } else { [Some(bearing), None] }
                .into_iter()
                .flatten()
        {
            for approach in on_circle(approach).into_iter().flatten() {
                let truth = Truth { rho: region.rho, bearing, approach, reverse: discrete_state.reverse };
                if discrete_state.turn_direction != 0 {
                    let inside = truth
                        .swept(twist, self.period)
                        .is_some_and(|swept| window(discrete_state.turn_direction).encloses(swept.bearing));
                    if !inside {
                        return f64::INFINITY;
                    }
                }
                worst = worst.max(self.lyapunov.mean_rate(&truth, twist, self.period, times));
            }
        }
        worst
    }
}

/// An angle cut where it leaves [−π, π], the part outside brought in: W takes the smallest square.
fn on_circle(angle: Interval) -> [Option<Interval>; 2] {
    let circle = Interval::symmetric(PI.next_up());
    let turn = if angle.mid() > 0.0 { half_turns(-2) } else { half_turns(2) };
    let outside = !circle.encloses(angle);
    [angle.intersection(circle), if outside { (angle + turn).intersection(circle) } else { None }]
}
