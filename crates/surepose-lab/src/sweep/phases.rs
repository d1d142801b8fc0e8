//! One period of every trial of a fleet, in short loops.
//!
//! Each loop is compiled into vector instructions. They are short so that the processor can work on many turns of a
//! loop at once: a trial's period is one long chain of operations that wait for each other.

use surepose::{
    Angle, Body, Direction, Engaged, Facing, Goal, HybridLaw, Integration, Law, Mask, Memory, Motion,
    Navigation, Point, Pose, Scalar, Twist, Wheels,
};
use surepose_lanes::{Element, Work, on_widest};

use super::bench::{DRIVE, HEADING_TOLERANCE, Noise, POSITION_TOLERANCE, limits};
use super::fleet::{Fleet, Numbers, Robot};

/// Carries every trial one `period` \[s] forward.
pub(super) fn step<T: Element>(fleet: &mut Fleet<T>, law: &Law<f64>, noise: &Noise, period: f64) {
    let noise = (*noise != Noise::NONE).then_some(noise);
    if noise.is_some() {
        on_widest(Draw(fleet));
    }
    on_widest(Look(fleet, noise));
    decide(fleet, law);
    drive(fleet, noise, period);
    judge(fleet);
}

/// Asks the law what every trial's robot shall do.
pub(super) fn decide<T: Element>(fleet: &mut Fleet<T>, law: &Law<f64>) {
    on_widest(Ask(fleet, law, Face));
    on_widest(Ask(fleet, law, Engage));
    on_widest(Ask(fleet, law, Steer));
}

/// Does it for one `period` \[s], as exactly as the wheels do.
pub(super) fn drive<T: Element>(fleet: &mut Fleet<T>, noise: Option<&Noise>, period: f64) {
    on_widest(Drive(fleet, noise, period));
    on_widest(Move(fleet));
}

/// Notes what came of it.
pub(super) fn judge<T: Element>(fleet: &mut Fleet<T>) {
    on_widest(Judge(fleet));
}

/// Whether any trial has been `held` for so long.
pub(super) fn any_held<T: Element>(fleet: &Fleet<T>, held: T) -> bool {
    on_widest(Anyone(&fleet.score.held, held))
}

/// Whether any number is as large as another.
struct Anyone<'a, T: Element>(&'a Numbers<T>, T);

impl<T: Element> Work for Anyone<'_, T> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let mut any = false;
        for number in &self.0.0 {
            any |= *number >= self.1;
        }
        any
    }
}

/// Draws this period's noise.
struct Draw<'a, T: Element>(&'a mut Fleet<T>);

impl<T: Element> Work for Draw<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Fleet { streams, deviates, .. } = self.0;
        streams.normals(deviates);
    }
}

/// Sees the goal from the estimated pose.
struct Look<'a, T: Element>(&'a mut Fleet<T>, Option<&'a Noise>);

impl<T: Element> Work for Look<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(fleet, noise) = self;
        if let Some(noise) = noise {
            let (position, heading) = (Robot::<T>::of(noise.position), Robot::<T>::of(noise.heading));
            for k in Numbers::<T>::rows::<1>() {
                let at = fleet.pose(k);
                let (x, y, turn) = (fleet.deviate(0, k), fleet.deviate(1, k), fleet.deviate(2, k));
                let estimate =
                    Pose::new(at.x + x * position, at.y + y * position, at.heading.nudged(turn * heading));
                fleet.see(k, estimate);
            }
        } else {
            for k in Numbers::<T>::rows::<1>() {
                fleet.see(k, fleet.pose(k));
            }
        }
    }
}

impl<T: Element> Fleet<T> {
    #[inline(always)]
    fn pose(&self, k: usize) -> Pose<Goal, Body, Robot<T>> {
        Pose::new(self.x.get(k), self.y.get(k), Angle::from_wrapped(self.heading.get(k)))
    }

    #[inline(always)]
    pub(super) fn see(&mut self, k: usize, estimate: Pose<Goal, Body, Robot<T>>) {
        let (rho, bearing) = estimate.origin().polar_to(Point::new(Robot::of(0.0), Robot::of(0.0)));
        self.rho.set(k, rho);
        self.bearing.set(k, bearing.radians());
        self.estimated.set(k, estimate.heading.radians());
    }

    /// What [`see`](Self::see) saw. α is a difference that the next loop makes as well, and this one is the longest.
    #[inline(always)]
    fn seen(&self, k: usize) -> Navigation<Robot<T>> {
        let (bearing, heading) = (self.bearing.get(k), self.estimated.get(k));
        Navigation::toward(self.rho.get(k), Angle::from_wrapped(bearing), Angle::from_wrapped(heading))
    }

    #[inline(always)]
    fn deviate(&self, of: usize, k: usize) -> Robot<T> {
        self.deviates[of].get_as(k)
    }

    #[inline(always)]
    fn facing(&self, k: usize) -> Facing<Robot<T>> {
        let (alpha, phi) = (self.alpha.get(k), self.phi.get(k));
        Facing {
            goal: Navigation {
                rho: self.rho.get(k),
                alpha: Angle::from_wrapped(alpha),
                phi: Angle::from_wrapped(phi),
            },
            cos: self.cos.get(k),
            sinc: self.sinc.get(k),
            // θ − θ₂, and the goal's heading is 0.
            heading_error: Angle::from_wrapped(self.estimated.get(k)),
            reverse: self.reverse.mask(k),
        }
    }

    #[inline(always)]
    fn memory(&self, k: usize) -> Memory<Robot<T>> {
        Memory {
            near: self.near.mask(k),
            reverse: self.reverse.mask(k),
            side: self.side.get(k),
            trims: self.trims.get(k),
            travel: self.travel.get(k),
        }
    }

    #[inline(always)]
    fn wanted(&self, k: usize) -> Twist<Robot<T>> {
        Twist::new(self.v.get(k), self.omega.get(k))
    }

    #[inline(always)]
    fn set_motion(&mut self, k: usize, motion: Motion<Robot<T>>) {
        self.length.set(k, motion.length);
        self.turn.set(k, motion.turn);
    }

    #[inline(always)]
    fn drive(&mut self, k: usize) {
        let motion = Motion { length: self.length.get(k), turn: self.turn.get(k) };
        let pose = self.pose(k).moved(motion, Integration::Arc);
        self.x.set(k, pose.x);
        self.y.set(k, pose.y);
        self.heading.set(k, pose.heading.radians());
    }
}

/// Which step of the law's decision a loop takes.
trait Step {
    /// Takes it for the robot of lane `k`.
    fn robot<T: Element>(fleet: &mut Fleet<T>, law: &Law<Robot<T>>, k: usize);
}

/// Decides which end goes first.
struct Face;

impl Step for Face {
    #[inline(always)]
    fn robot<T: Element>(fleet: &mut Fleet<T>, law: &Law<Robot<T>>, k: usize) {
        let facing = law.face(&fleet.seen(k), &fleet.memory(k));
        fleet.alpha.set(k, facing.goal.alpha.radians());
        fleet.phi.set(k, facing.goal.phi.radians());
        fleet.cos.set(k, facing.cos);
        fleet.sinc.set(k, facing.sinc);
        fleet.reverse.set_mask(k, facing.reverse);
    }
}

/// Decides which law is in charge.
struct Engage;

impl Step for Engage {
    #[inline(always)]
    fn robot<T: Element>(fleet: &mut Fleet<T>, law: &Law<Robot<T>>, k: usize) {
        let Engaged { error, memory } = law.engage(&fleet.facing(k), fleet.memory(k));
        fleet.error.set(k, error);
        fleet.near.set_mask(k, memory.near);
        fleet.side.set(k, memory.side);
        fleet.trims.set(k, memory.trims);
    }
}

/// Decides how the end that goes first moves.
struct Steer;

impl Step for Steer {
    #[inline(always)]
    fn robot<T: Element>(fleet: &mut Fleet<T>, law: &Law<Robot<T>>, k: usize) {
        let engaged = Engaged { error: fleet.error.get(k), memory: fleet.memory(k) };
        let decision = law.steer(None, &fleet.facing(k), engaged);
        fleet.travel.set(k, decision.memory.travel);
        fleet.v.set(k, decision.twist.v);
        fleet.omega.set(k, decision.twist.omega);
    }
}

/// Asks the law for one step of its decision.
struct Ask<'a, T: Element, H>(&'a mut Fleet<T>, &'a Law<f64>, H);

impl<T: Element, H: Step> Work for Ask<'_, T, H> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(fleet, law, _) = self;
        // Which law it is, which way it goes and whether it rests are the same for all: a loop for each keeps that out of it.
        match law.cast::<Robot<T>>() {
            Law::Paper(law) => all::<T, H>(fleet, &Law::Paper(law)),
            Law::Hybrid(law) => match law.direction {
                Direction::Auto => going::<T, H>(fleet, law, Direction::Auto),
                Direction::Forward => going::<T, H>(fleet, law, Direction::Forward),
                Direction::Reverse => going::<T, H>(fleet, law, Direction::Reverse),
            },
        }
    }
}

#[inline(always)]
fn going<T: Element, H: Step>(fleet: &mut Fleet<T>, law: HybridLaw<Robot<T>>, direction: Direction) {
    let law = HybridLaw { direction, ..law };
    match law.rest {
        Some(rest) => all::<T, H>(fleet, &Law::Hybrid(HybridLaw { rest: Some(rest), ..law })),
        None => all::<T, H>(fleet, &Law::Hybrid(HybridLaw { rest: None, ..law })),
    }
}

#[inline(always)]
fn all<T: Element, H: Step>(fleet: &mut Fleet<T>, law: &Law<Robot<T>>) {
    for k in Numbers::<T>::rows::<1>() {
        H::robot(fleet, law, k);
    }
}

/// Turns the wheels, within their limits and as inexactly as they do.
struct Drive<'a, T: Element>(&'a mut Fleet<T>, Option<&'a Noise>, f64);

impl<T: Element> Work for Drive<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(fleet, noise, period) = self;
        let (drive, limits, period) = (DRIVE.cast(), limits().cast(), Robot::<T>::of(period));
        // What the limits leave of a twist, held for a period, is the whole twist held for that part of it.
        if let Some(noise) = noise {
            let (one, std) = (Robot::<T>::of(1.0), Robot::<T>::of(noise.wheels));
            for k in Numbers::<T>::rows::<1>() {
                let rims = drive.rims_from_twist(fleet.wanted(k));
                let right = one + fleet.deviate(3, k) * std;
                let left = one + fleet.deviate(4, k) * std;
                let turning = Wheels::new(rims.right * right, rims.left * left);
                fleet.set_motion(k, drive.motion_from_travel(turning.scaled(limits.share(rims) * period)));
            }
        } else {
            for k in Numbers::<T>::rows::<1>() {
                let wanted = fleet.wanted(k);
                fleet.set_motion(k, wanted.over(limits.share(drive.rims_from_twist(wanted)) * period));
            }
        }
    }
}

/// Moves as far as the wheels turn.
struct Move<'a, T: Element>(&'a mut Fleet<T>);

impl<T: Element> Work for Move<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for k in Numbers::<T>::rows::<1>() {
            self.0.drive(k);
        }
    }
}

/// Notes how often every robot turned its travel round, and whether it is inside the tolerance.
struct Judge<'a, T: Element>(&'a mut Fleet<T>);

impl<T: Element> Work for Judge<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let fleet = self.0;
        let score = &mut fleet.score;
        let (zero, one) = (Robot::<T>::of(0.0), Robot::<T>::of(1.0));
        for k in Numbers::<T>::rows::<1>() {
            let (x, y, heading) = (fleet.x.get(k), fleet.y.get(k), fleet.heading.get(k));
            let (speed, way, legs) = (fleet.v.get(k), fleet.length.get(k).abs(), score.legs.get(k));
            let (held, held_path, held_turns) =
                (score.held.get(k), score.held_path.get(k), score.held_turns.get(k));

            // A leg ends where the speed that the wheels are told changes its sign, a rest between left out.
            let (moving, turned) = (speed.abs().gt(zero), (speed * legs).lt(zero));
            let turn = Robot::select(turned, one, zero);
            let number = legs.abs().max(Robot::select(moving, one, zero)) + turn;

            let close = !Robot::of(POSITION_TOLERANCE * POSITION_TOLERANCE).lt(x.squared() + y.squared());
            let inside = close.and(!Robot::of(HEADING_TOLERANCE).lt(heading.abs()));
            let holding = inside.and(held.gt(zero));

            score.path.set(k, score.path.get(k) + way);
            score.legs.set(k, number.with_sign_of(Robot::select(moving, speed, legs)));
            score.held.set(k, Robot::select(inside, held + one, zero));
            score.held_path.set(k, Robot::select(holding, held_path + way, zero));
            score.held_turns.set(k, Robot::select(holding, held_turns + turn, zero));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Fleet, Judge, on_widest};

    /// Cusps of a robot in a lane in the middle that is told `speeds`, `x` \[m] from the goal.
    fn cusps_at(x: f64, speeds: &[f64]) -> f64 {
        let mut fleet = Fleet::<f64>::default();
        fleet.x.0[77] = x;
        for speed in speeds {
            fleet.v.0[77] = *speed;
            on_widest(Judge(&mut fleet));
        }
        assert!(fleet.score.legs.0[76].abs() < 0.5, "the neighbour stands still");
        fleet.score.cusps(77)
    }

    #[test]
    fn a_cusp_is_a_change_of_the_speeds_sign() {
        let close = |a: f64, b: f64| (a - b).abs() < 0.5;
        let cusps = |speeds: &[f64]| cusps_at(1.0, speeds);
        assert!(close(cusps(&[0.1; 20]), 0.0));
        assert!(close(cusps(&[0.1, 0.1, -0.1, -0.1]), 1.0));
        assert!(close(cusps(&[0.1, -1e-6, 1e-6, -0.1]), 3.0));
        // A rest is none, neither is the start's.
        assert!(close(cusps(&[0.0, -0.1, 0.0, 0.0, -0.1]), 0.0));
        assert!(close(cusps(&[-0.1, 0.0, 0.0, 0.1]), 1.0));
    }

    #[test]
    fn way_and_cusps_of_a_robot_that_holds_the_goal_do_not_count() {
        assert!(cusps_at(0.0, &[0.1, -0.1, 0.1]).abs() < 0.5);
        let mut fleet = Fleet::<f64>::default();
        // It comes inside, leaves again, comes inside to stay, and holds the goal for one more period.
        for (x, speed) in [(1.0, 0.1), (0.0, -0.1), (0.0, 0.1), (1.0, 0.1), (0.0, -0.1), (0.0, 0.1)] {
            (fleet.x.0[3], fleet.v.0[3], fleet.length.0[3]) = (x, speed, speed * 0.02);
            on_widest(Judge(&mut fleet));
        }
        assert!((fleet.score.path(3) - 5.0 * 0.002).abs() < 1e-12, "{}", fleet.score.path(3));
        assert!((fleet.score.cusps(3) - 3.0).abs() < 0.5, "{}", fleet.score.cusps(3));
    }
}
