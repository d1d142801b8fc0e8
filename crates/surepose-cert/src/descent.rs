//! Does W fall in this region, at every tick, whatever the noise does?

use core::f64::consts::PI;

use surepose::{Decision, Drive, Memory, Scalar, Twist};

use crate::fork::explore;
use crate::interval::Interval;
use crate::mind::Mind;
use crate::noise::Noise;
use crate::region::{Region, half_turns};
use crate::search::first_shown;
use crate::subject::Subject;
use crate::weight::{Truth, Weight, window};

/// Ways through the law beyond which a region is cut rather than followed: it is too large.
const MOST_WAYS: usize = 64;

/// Width of α̂ \[rad], and bound of Ẇ \[1/s], above which cutting the noise does not help: the region is to be cut.
const COARSE: f64 = 0.15;
const HOPELESS: f64 = 3.0;

/// What is to be shown, for one law and one period.
pub(crate) struct Descent<'a, L> {
    pub(crate) subject: &'a L,
    pub(crate) drive: Drive<f64>,
    pub(crate) noise: Noise,
    pub(crate) period: f64,
    pub(crate) weight: Weight,
    /// Whether the wheels' limits are in force.
    pub(crate) limited: bool,
    /// The minds that the law can be in.
    pub(crate) minds: Vec<Mind>,
    /// What no rim may be told to exceed \[m/s].
    pub(crate) rim_limit: f64,
    /// Every mind that the law can come to be in, wherever the goal is.
    pub(crate) reachable: Vec<Mind>,
}

/// One thing that the law may do in a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Outcome {
    pub(crate) mind: Mind,
    pub(crate) twist: Twist<Interval>,
}

/// Upper bounds of what W does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fall {
    /// Ẇ, averaged over the period \[1/s].
    pub(crate) rate: f64,
    /// The jump of W where the law changes its mind.
    pub(crate) jump: f64,
}

impl<L: Subject> Descent<'_, L> {
    /// The same, knowing which minds the law can come to.
    pub(crate) fn with_minds_found(mut self) -> Self {
        self.reachable = self.find_reachable();
        self
    }

    /// The step that the robot is told.
    pub(crate) fn step(&self, region: &Region, memory: Memory<Interval>) -> Decision<Interval> {
        let decision = self.subject.decide(&region.seen(), memory);
        if self.limited {
            Decision { twist: self.subject.grant(decision.twist), ..decision }
        } else {
            decision
        }
    }

    /// What the law does in `region`, having been of `mind`; nothing if that cannot be told.
    pub(crate) fn outcomes(&self, region: &Region, mind: Mind, into: &mut Vec<Outcome>) -> bool {
        self.outcomes_of(region, mind, MOST_WAYS, into)
    }

    /// The same, following more ways or fewer.
    pub(crate) fn outcomes_of(
        &self,
        region: &Region,
        mind: Mind,
        most: usize,
        into: &mut Vec<Outcome>,
    ) -> bool {
        let mut known = true;
        let program = || self.step(region, mind.memories());
        let complete = explore(most, program, |Decision { twist, memory }| match Mind::of(&memory) {
            Some(mind) => {
                let outcome = Outcome { mind, twist };
                if !into.contains(&outcome) {
                    into.push(outcome);
                }
            }
            None => known = false,
        });
        known && complete
    }

    /// Whether the local law can be in charge after this tick, having been in charge before or not.
    pub(crate) fn local_possible(&self, region: &Region, before: bool) -> bool {
        self.minds_known()
            .filter(|mind| mind.near == before)
            .any(|mind| self.local_possible_from(region, mind))
    }

    /// Whether the local law can be in charge after a tick that began with `mind`.
    pub(crate) fn local_possible_from(&self, region: &Region, mind: Mind) -> bool {
        self.step(region, mind.memories()).memory.near.possible()
    }

    /// Whether the local law is in charge after this tick, whoever was before.
    pub(crate) fn local_certain(&self, region: &Region) -> bool {
        self.minds_known().all(|mind| self.step(region, mind.memories()).memory.near.certain())
    }

    /// Considers, from here on, every mind that the law can come to be in anywhere: for noise without bounds.
    pub(crate) fn prepare_for_any_past(&mut self) {
        self.minds.clone_from(&self.reachable);
    }

    /// Every mind that the law can come to be in, wherever the goal is.
    pub(crate) fn minds_known(&self) -> impl Iterator<Item = Mind> + '_ {
        self.reachable.iter().copied()
    }

    /// Considers, from here on, the minds that the law can be in at true distances `rho`.
    pub(crate) fn prepare(&mut self, rho: Interval) {
        if !self.limited {
            // Nothing bounds how far away the tick before began.
            return self.prepare_for_any_past();
        }
        let fastest = (self.rim_limit * (1.0 + self.noise.rim_speed_part) + self.noise.rim_speed).next_up();
        self.minds = self.minds_at(rho, (fastest * self.period).next_up());
    }

    /// The minds that the law can be in at true distances `rho`: the fresh one, and those that the tick before can have
    /// left it in, which began at most `step` \[m] farther or nearer.
    fn minds_at(&self, rho: Interval, step: f64) -> Vec<Mind> {
        let drift = Interval::symmetric(step) + Interval::symmetric(self.noise.position);
        let here = Region::anywhere(rho, drift);
        let mut minds: Vec<Mind> = self
            .minds_known()
            .flat_map(|before| Mind::possible(&self.step(&here, before.memories()).memory))
            .filter(|after| self.reachable.contains(after))
            .collect();
        minds.push(Mind::FRESH);
        minds.sort_by_key(|mind| mind.index());
        minds.dedup();
        minds
    }

    /// The fresh mind, and all that the law can come to from it, wherever the goal is.
    fn find_reachable(&self) -> Vec<Mind> {
        let everywhere = Region::anywhere(Interval::new(0.0, 1e6), Interval::point(0.0));
        let mut reachable = vec![Mind::FRESH];
        let mut next = 0;
        while let Some(&before) = reachable.get(next) {
            let memory = self.step(&everywhere, before.memories()).memory;
            let new: Vec<Mind> = Mind::possible(&memory).filter(|after| !reachable.contains(after)).collect();
            reachable.extend(new);
            next += 1;
        }
        reachable
    }

    /// Bounds what W does in `region` for a law that was of one of `minds`; stops where it is above −`wanted` anyway, and
    /// brings the mind where it is to the front.
    pub(crate) fn fall(&self, region: &Region, wanted: f64, minds: &mut [Mind]) -> Fall {
        let mut fall = Fall { rate: f64::NEG_INFINITY, jump: f64::NEG_INFINITY };
        let turn = region.turn(&self.noise);
        first_shown(minds, |mind, known| {
            let complete = self.fall_from(region, mind, (turn, wanted), known, &mut fall);
            if !complete {
                fall = Fall { rate: f64::INFINITY, jump: f64::INFINITY };
            }
            fall.jump <= 0.0 && fall.rate <= -wanted
        });
        fall
    }

    /// The same for one mind, added to `fall`, as far as its outcomes are not `known`; false where nothing is known of one.
    fn fall_from(
        &self,
        region: &Region,
        before: Mind,
        (turn, wanted): (f64, f64),
        known: &mut Vec<Outcome>,
        fall: &mut Fall,
    ) -> bool {
        let mut from_here = Vec::new();
        if !self.outcomes(region, before, &mut from_here) {
            return false;
        }
        for outcome in from_here {
            if outcome.mind.side == 0 && !self.stays_undecided() {
                return false;
            }
            if (before != Mind::FRESH || self.stays_undecided()) && !before.weighs_as(outcome.mind) {
                fall.jump = fall.jump.max(self.jump(region, before, outcome.mind, turn));
            }
            if !known.contains(&outcome) {
                if self.limited && self.too_fast(&outcome) {
                    return false;
                }
                fall.rate = fall.rate.max(self.rate(region, &outcome, turn, wanted));
                known.push(outcome);
            }
            if fall.jump > 0.0 || fall.rate > -wanted {
                break;
            }
        }
        true
    }

    /// Whether the law never decides on a side. Else the fresh mind is that of the first tick only, and W, which
    /// depends on the side, begins after it.
    fn stays_undecided(&self) -> bool {
        self.minds.iter().all(|mind| mind.side == 0)
    }

    /// Whether a rim is told to exceed its limit, beyond rounding.
    fn too_fast(&self, outcome: &Outcome) -> bool {
        let rims = self.drive.cast().rims_from_twist(outcome.twist).largest();
        rims.lo() > self.rim_limit * (1.0 + 1e-9)
    }

    /// How W jumps when the law changes from mind `before` to `after`.
    fn jump(&self, region: &Region, before: Mind, after: Mind, turn: f64) -> f64 {
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
        if !window(before.side).encloses(was) {
            let other = if was.mid() > 0.0 { from.0 - 2 } else { from.0 + 2 };
            squares = squares.max(bearing(other));
        }
        if before.reverse != after.reverse {
            // |φ| becomes π − |φ|: the square falls by 2π(|φ| − π/2).
            let was = (region.phi + half_turns(from.1) + Interval::symmetric(turn)).abs();
            let least = was.lo().min((half_turns(2) - was).lo());
            let pi = half_turns(1);
            let square = pi * (pi - Interval::point(2.0) * Interval::point(least));
            squares = (squares + (self.weight.approach * square.hi()).next_up()).next_up();
        }
        0.5 * squares
    }

    /// How W falls while the twist of `outcome` is held.
    fn rate(&self, region: &Region, outcome: &Outcome, turn: f64, wanted: f64) -> f64 {
        let twist = self.noise.driven(&self.drive.cast(), outcome.twist);
        let mut worst = f64::INFINITY;
        for (slices, times) in [(1, 1), (4, 1), (8, 2)] {
            worst = f64::NEG_INFINITY;
            for slice in 0..slices {
                let e = Interval::symmetric(turn).piece(slice, slices);
                worst = worst.max(self.rate_at(region, outcome.mind, e, twist, times));
                if worst > -wanted {
                    break;
                }
            }
            let hopeless = region.alpha.width() > COARSE || worst > HOPELESS;
            if worst <= -wanted || hopeless {
                break;
            }
        }
        worst
    }

    /// The goal as it truly lies where its direction is `e` more than seen.
    pub(crate) fn truth(&self, region: &Region, mind: Mind, e: Interval) -> Truth {
        let lift = region.lift(mind);
        Truth {
            rho: region.rho,
            bearing: region.alpha + half_turns(lift.0) + e + Interval::symmetric(self.noise.heading),
            approach: region.phi + half_turns(lift.1) + e,
            reverse: mind.reverse,
        }
    }

    /// The same where the direction of the goal is `e` more than seen.
    fn rate_at(&self, region: &Region, mind: Mind, e: Interval, twist: Twist<Interval>, times: usize) -> f64 {
        let Truth { bearing, approach, .. } = self.truth(region, mind, e);
        let mut worst = f64::NEG_INFINITY;
        for bearing in
            if mind.side == 0 { on_circle(bearing) } else { [Some(bearing), None] }.into_iter().flatten()
        {
            for approach in on_circle(approach).into_iter().flatten() {
                let truth = Truth { rho: region.rho, bearing, approach, reverse: mind.reverse };
                if mind.side != 0 {
                    let inside = truth
                        .swept(twist, self.period)
                        .is_some_and(|swept| window(mind.side).encloses(swept.bearing));
                    if !inside {
                        return f64::INFINITY;
                    }
                }
                worst = worst.max(self.weight.mean_rate(&truth, twist, self.period, times));
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
