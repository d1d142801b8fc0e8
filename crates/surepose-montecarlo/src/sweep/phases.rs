//! One period of every trial of a batch, as a sequence of short loops.
//!
//! Each loop compiles to vector instructions. Short loops let the processor overlap many iterations; a whole
//! period of a trial is one long dependency chain.

use surepose::control::{
    ActiveMode, DirectedError, Direction, HybridLaw, HybridState, Law, NavigationVariables,
};
use surepose::geometry::{Angle, Body, Goal, Point, Pose};
use surepose::kinematics::{Integration, Motion, Twist, WheelPair};
use surepose::scalar::{Mask, Scalar};
use surepose_simd::{Element, Kernel, dispatch_simd};

use super::bench::{DRIVE, HEADING_TOLERANCE, POSITION_TOLERANCE, SweepNoise, limits};
use super::trial_batch::{BatchArray, LaneScalar, TrialBatch};

/// Advances every trial by one `period` \[s].
pub(super) fn step<T: Element>(batch: &mut TrialBatch<T>, law: &Law<f64>, noise: &SweepNoise, period: f64) {
    let noise = (*noise != SweepNoise::NONE).then_some(noise);
    if noise.is_some() {
        dispatch_simd(Draw(batch));
    }
    dispatch_simd(Look(batch, noise));
    decide(batch, law);
    drive(batch, noise, period);
    judge(batch);
}

/// Computes the law's command for every trial.
pub(super) fn decide<T: Element>(batch: &mut TrialBatch<T>, law: &Law<f64>) {
    dispatch_simd(Ask(batch, law, SelectDirection));
    dispatch_simd(Ask(batch, law, SelectMode));
    dispatch_simd(Ask(batch, law, ComputeForMode));
}

/// Applies the commands for one `period` \[s], with the noise of the wheels.
pub(super) fn drive<T: Element>(batch: &mut TrialBatch<T>, noise: Option<&SweepNoise>, period: f64) {
    dispatch_simd(ApplyCommand(batch, noise, period));
    dispatch_simd(Move(batch));
}

/// Updates success and statistics of every trial.
pub(super) fn judge<T: Element>(batch: &mut TrialBatch<T>) {
    dispatch_simd(Judge(batch));
}

/// Kernel: draws the noise of this period.
struct Draw<'a, T: Element>(&'a mut TrialBatch<T>);

impl<T: Element> Kernel for Draw<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let TrialBatch { streams, deviates, .. } = self.0;
        streams.normals(deviates);
    }
}

/// Kernel: computes the navigation variables from the estimated pose.
struct Look<'a, T: Element>(&'a mut TrialBatch<T>, Option<&'a SweepNoise>);

impl<T: Element> Kernel for Look<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(batch, noise) = self;
        if let Some(noise) = noise {
            let (position, heading) =
                (LaneScalar::<T>::from_f64(noise.position), LaneScalar::<T>::from_f64(noise.heading));
            for k in BatchArray::<T>::rows::<1>() {
                let at = batch.pose(k);
                let (x, y, turn) = (batch.deviate(0, k), batch.deviate(1, k), batch.deviate(2, k));
                let estimate = Pose::new(
                    at.x + x * position,
                    at.y + y * position,
                    at.heading.rotated_by_small(turn * heading),
                );
                batch.see(k, estimate);
            }
        } else {
            for k in BatchArray::<T>::rows::<1>() {
                batch.see(k, batch.pose(k));
            }
        }
    }
}

impl<T: Element> TrialBatch<T> {
    #[inline(always)]
    fn pose(&self, k: usize) -> Pose<Goal, Body, LaneScalar<T>> {
        Pose::new(self.x.get(k), self.y.get(k), Angle::from_radians_unchecked(self.heading.get(k)))
    }

    #[inline(always)]
    pub(super) fn see(&mut self, k: usize, estimate: Pose<Goal, Body, LaneScalar<T>>) {
        let (rho, bearing) =
            estimate.origin().polar_to(Point::new(LaneScalar::from_f64(0.0), LaneScalar::from_f64(0.0)));
        self.rho.set(k, rho);
        self.bearing.set(k, bearing.radians());
        self.estimated.set(k, estimate.heading.radians());
    }

    /// Returns the variables stored by [`see`](Self::see). α is recomputed by the next loop, because this
    /// loop is the longest.
    #[inline(always)]
    fn seen(&self, k: usize) -> NavigationVariables<LaneScalar<T>> {
        let (bearing, heading) = (self.bearing.get(k), self.estimated.get(k));
        NavigationVariables::from_polar(
            self.rho.get(k),
            Angle::from_radians_unchecked(bearing),
            Angle::from_radians_unchecked(heading),
        )
    }

    #[inline(always)]
    fn deviate(&self, of: usize, k: usize) -> LaneScalar<T> {
        self.deviates[of].get_as(k)
    }

    #[inline(always)]
    fn directed_error(&self, k: usize) -> DirectedError<LaneScalar<T>> {
        let (alpha, phi) = (self.alpha.get(k), self.phi.get(k));
        DirectedError {
            goal: NavigationVariables {
                rho: self.rho.get(k),
                alpha: Angle::from_radians_unchecked(alpha),
                phi: Angle::from_radians_unchecked(phi),
            },
            cos: self.cos.get(k),
            sinc: self.sinc.get(k),
            // θ − θ₂ with a goal heading of 0.
            heading_error: Angle::from_radians_unchecked(self.estimated.get(k)),
            reverse: self.reverse.mask(k),
        }
    }

    #[inline(always)]
    fn state(&self, k: usize) -> HybridState<LaneScalar<T>> {
        HybridState {
            local_mode: self.local_mode.mask(k),
            reverse: self.reverse.mask(k),
            turn_direction: self.turn_direction.get(k),
            trim_ticks: self.trim_ticks.get(k),
            drive_direction: self.drive_direction.get(k),
            sidestep: self.sidestep.get(k),
            lateral: self.lateral.get(k),
        }
    }

    #[inline(always)]
    fn desired(&self, k: usize) -> Twist<LaneScalar<T>> {
        Twist::new(self.v.get(k), self.omega.get(k))
    }

    #[inline(always)]
    fn set_motion(&mut self, k: usize, motion: Motion<LaneScalar<T>>) {
        self.length.set(k, motion.length);
        self.turn.set(k, motion.turn);
    }

    #[inline(always)]
    fn drive(&mut self, k: usize) {
        let motion = Motion { length: self.length.get(k), turn: self.turn.get(k) };
        let pose = self.pose(k).integrate(motion, Integration::Arc);
        self.x.set(k, pose.x);
        self.y.set(k, pose.y);
        self.heading.set(k, pose.heading.radians());
    }
}

/// Stage of the law that a loop computes.
trait Step {
    /// Computes it for the robot of lane `k`.
    fn robot<T: Element>(batch: &mut TrialBatch<T>, law: &Law<LaneScalar<T>>, k: usize);
}

/// Selects the direction of travel.
struct SelectDirection;

impl Step for SelectDirection {
    #[inline(always)]
    fn robot<T: Element>(batch: &mut TrialBatch<T>, law: &Law<LaneScalar<T>>, k: usize) {
        let directed = law.select_direction(&batch.seen(k), &batch.state(k));
        batch.alpha.set(k, directed.goal.alpha.radians());
        batch.phi.set(k, directed.goal.phi.radians());
        batch.cos.set(k, directed.cos);
        batch.sinc.set(k, directed.sinc);
        batch.reverse.set_mask(k, directed.reverse);
    }
}

/// Selects the active law.
struct SelectMode;

impl Step for SelectMode {
    #[inline(always)]
    fn robot<T: Element>(batch: &mut TrialBatch<T>, law: &Law<LaneScalar<T>>, k: usize) {
        let ActiveMode { error, state } = law.select_mode(&batch.directed_error(k), batch.state(k));
        batch.error.set(k, error);
        batch.local_mode.set_mask(k, state.local_mode);
        batch.turn_direction.set(k, state.turn_direction);
        batch.trim_ticks.set(k, state.trim_ticks);
        batch.sidestep.set(k, state.sidestep);
        batch.lateral.set(k, state.lateral);
    }
}

/// Computes the command of the active law.
struct ComputeForMode;

impl Step for ComputeForMode {
    #[inline(always)]
    fn robot<T: Element>(batch: &mut TrialBatch<T>, law: &Law<LaneScalar<T>>, k: usize) {
        let mode = ActiveMode { error: batch.error.get(k), state: batch.state(k) };
        let output = law.compute_for_mode(None, &batch.directed_error(k), mode);
        batch.drive_direction.set(k, output.state.drive_direction);
        batch.v.set(k, output.twist.v);
        batch.omega.set(k, output.twist.omega);
    }
}

/// Kernel: runs one stage of the law.
struct Ask<'a, T: Element, H>(&'a mut TrialBatch<T>, &'a Law<f64>, H);

impl<T: Element, H: Step> Kernel for Ask<'_, T, H> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(batch, law, _) = self;
        // Variant, direction and deadband of the law are the same in all lanes: one specialized loop for
        // each.
        match law.cast::<LaneScalar<T>>() {
            Law::Tran2012(law) => all::<T, H>(batch, &Law::Tran2012(law)),
            Law::Hybrid(law) => match law.direction {
                Direction::Auto => going::<T, H>(batch, law, Direction::Auto),
                Direction::Forward => going::<T, H>(batch, law, Direction::Forward),
                Direction::Reverse => going::<T, H>(batch, law, Direction::Reverse),
            },
        }
    }
}

#[inline(always)]
fn going<T: Element, H: Step>(
    batch: &mut TrialBatch<T>,
    law: HybridLaw<LaneScalar<T>>,
    direction: Direction,
) {
    let law = HybridLaw { direction, ..law };
    match law.deadband {
        Some(deadband) => all::<T, H>(batch, &Law::Hybrid(HybridLaw { deadband: Some(deadband), ..law })),
        None => all::<T, H>(batch, &Law::Hybrid(HybridLaw { deadband: None, ..law })),
    }
}

#[inline(always)]
fn all<T: Element, H: Step>(batch: &mut TrialBatch<T>, law: &Law<LaneScalar<T>>) {
    for k in BatchArray::<T>::rows::<1>() {
        H::robot(batch, law, k);
    }
}

/// Kernel: applies wheel limits and noise.
struct ApplyCommand<'a, T: Element>(&'a mut TrialBatch<T>, Option<&'a SweepNoise>, f64);

impl<T: Element> Kernel for ApplyCommand<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self(batch, noise, period) = self;
        let (drive, limits, period) = (DRIVE.cast(), limits().cast(), LaneScalar::<T>::from_f64(period));
        // Limits scale a twist; held for a period, this equals the whole twist held for a fraction of the
        // period.
        if let Some(noise) = noise {
            let (one, std) = (LaneScalar::<T>::from_f64(1.0), LaneScalar::<T>::from_f64(noise.wheels));
            for k in BatchArray::<T>::rows::<1>() {
                let rims = drive.wheel_speeds_from_twist(batch.desired(k));
                let right = one + batch.deviate(3, k) * std;
                let left = one + batch.deviate(4, k) * std;
                let turning = WheelPair::new(rims.right * right, rims.left * left);
                batch.set_motion(
                    k,
                    drive.motion_from_travel(turning.scaled(limits.scale_factor(rims) * period)),
                );
            }
        } else {
            for k in BatchArray::<T>::rows::<1>() {
                let desired = batch.desired(k);
                batch.set_motion(
                    k,
                    desired
                        .integrate_for(limits.scale_factor(drive.wheel_speeds_from_twist(desired)) * period),
                );
            }
        }
    }
}

/// Kernel: integrates the motion of the wheels.
struct Move<'a, T: Element>(&'a mut TrialBatch<T>);

impl<T: Element> Kernel for Move<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for k in BatchArray::<T>::rows::<1>() {
            self.0.drive(k);
        }
    }
}

/// Kernel: counts reversals, and checks the tolerance.
struct Judge<'a, T: Element>(&'a mut TrialBatch<T>);

impl<T: Element> Kernel for Judge<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let batch = self.0;
        let score = &mut batch.score;
        let (zero, one) = (LaneScalar::<T>::from_f64(0.0), LaneScalar::<T>::from_f64(1.0));
        for k in BatchArray::<T>::rows::<1>() {
            let (x, y, heading) = (batch.x.get(k), batch.y.get(k), batch.heading.get(k));
            let (speed, way, legs) = (batch.v.get(k), batch.length.get(k).abs(), score.legs.get(k));
            let (held, held_path, held_turns) =
                (score.held.get(k), score.held_path.get(k), score.held_turns.get(k));

            // A leg ends where the commanded speed changes its sign; zero speed in between is ignored.
            let (moving, turned) = (speed.abs().gt(zero), (speed * legs).lt(zero));
            let turn = LaneScalar::select(turned, one, zero);
            let number = legs.abs().max(LaneScalar::select(moving, one, zero)) + turn;

            let close =
                !LaneScalar::from_f64(POSITION_TOLERANCE * POSITION_TOLERANCE).lt(x.squared() + y.squared());
            let inside = close.and(!LaneScalar::from_f64(HEADING_TOLERANCE).lt(heading.abs()));
            let holding = inside.and(held.gt(zero));

            score.path.set(k, score.path.get(k) + way);
            score.legs.set(k, number.copysign(LaneScalar::select(moving, speed, legs)));
            score.held.set(k, LaneScalar::select(inside, held + one, zero));
            score.held_path.set(k, LaneScalar::select(holding, held_path + way, zero));
            score.held_turns.set(k, LaneScalar::select(holding, held_turns + turn, zero));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Judge, TrialBatch, dispatch_simd};

    /// Returns the cusps of a robot in a middle lane with commanded `speeds`, at `x` \[m] from the goal.
    fn cusps_at(x: f64, speeds: &[f64]) -> f64 {
        let mut batch = TrialBatch::<f64>::default();
        batch.x.0[77] = x;
        for speed in speeds {
            batch.v.0[77] = *speed;
            dispatch_simd(Judge(&mut batch));
        }
        assert!(batch.score.legs.0[76].abs() < 0.5, "the neighbor has no cusps");
        batch.score.cusps(77)
    }

    #[test]
    fn a_cusp_is_a_sign_change_of_the_speed() {
        let close = |a: f64, b: f64| (a - b).abs() < 0.5;
        let cusps = |speeds: &[f64]| cusps_at(1.0, speeds);
        assert!(close(cusps(&[0.1; 20]), 0.0));
        assert!(close(cusps(&[0.1, 0.1, -0.1, -0.1]), 1.0));
        assert!(close(cusps(&[0.1, -1e-6, 1e-6, -0.1]), 3.0));
        // Zero speed is not a cusp, nor is the start.
        assert!(close(cusps(&[0.0, -0.1, 0.0, 0.0, -0.1]), 0.0));
        assert!(close(cusps(&[-0.1, 0.0, 0.0, 0.1]), 1.0));
    }

    #[test]
    fn path_and_cusps_while_holding_the_goal_do_not_count() {
        assert!(cusps_at(0.0, &[0.1, -0.1, 0.1]).abs() < 0.5);
        let mut batch = TrialBatch::<f64>::default();
        // The robot enters the tolerance, leaves it, enters it for good, and holds the goal for one more
        // period.
        for (x, speed) in [(1.0, 0.1), (0.0, -0.1), (0.0, 0.1), (1.0, 0.1), (0.0, -0.1), (0.0, 0.1)] {
            (batch.x.0[3], batch.v.0[3], batch.length.0[3]) = (x, speed, speed * 0.02);
            dispatch_simd(Judge(&mut batch));
        }
        assert!((batch.score.path(3) - 5.0 * 0.002).abs() < 1e-12, "{}", batch.score.path(3));
        assert!((batch.score.cusps(3) - 3.0).abs() < 0.5, "{}", batch.score.cusps(3));
    }
}
