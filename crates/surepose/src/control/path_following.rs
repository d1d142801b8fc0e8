//! Along a path, for the experiment of [Tran2012] Fig. 6: [Soetanto2003] with a moving target.

use crate::geometry::{Angle, Body, Map, Pose, Target};
use crate::kinematics::Twist;
use crate::scalar::Scalar;

use super::path::Path;

/// The robot, seen from the point of the path that it should be at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathError<S> {
    /// x, how far the robot is ahead of the target along the path \[m].
    pub along_track: S,
    /// y, how far it is to the left of the path \[m].
    pub cross_track: S,
    /// θ_e, how far it is turned from the path's direction.
    pub heading: Angle<S>,
}

impl<S: Scalar> PathError<S> {
    /// The robot seen from the target.
    #[inline]
    pub fn from_poses(map_from_body: Pose<Map, Body, S>, map_from_target: Pose<Map, Target, S>) -> Self {
        let target_from_body = map_from_target.inverse() * map_from_body;
        Self {
            along_track: target_from_body.x,
            cross_track: target_from_body.y,
            heading: target_from_body.heading,
        }
    }

    /// The rates (ẋ, ẏ, θ̇_e) under `command` on a path of this `curvature`: [Soetanto2003] Eq. (3).
    #[inline]
    pub fn rates(&self, curvature: S, command: &PathCommand<S>) -> (S, S, S) {
        let PathCommand { twist, target_speed } = *command;
        let (sin, cos) = self.heading.sin_cos();
        let one = S::from_f64(1.0);
        (
            twist.v * cos - target_speed * (one - curvature * self.cross_track),
            twist.v * sin - curvature * target_speed * self.along_track,
            twist.omega - curvature * target_speed,
        )
    }
}

/// Twist of the robot and speed of the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathCommand<S> {
    /// The robot's twist.
    pub twist: Twist<S>,
    /// ṡ, how fast the target moves along the path \[m/s].
    pub target_speed: S,
}

impl<S: Scalar> PathCommand<S> {
    /// Everything times `factor`: the same way, taken at another speed.
    #[must_use]
    #[inline]
    pub fn scaled(self, factor: S) -> Self {
        Self { twist: self.twist.scaled(factor), target_speed: self.target_speed * factor }
    }
}

/// The law that brings the robot onto the path and keeps it there.
///
/// The target is no fixed schedule: it waits for the robot, so that nothing depends on where on the path the robot
/// starts, and the law has no singularity at the path's centre of curvature.
///
/// `ṡ = v·cos θ_e + k_x·x`, `ω = κ·ṡ − k_θ·θ_e − k_y·v·y·sinc θ_e`.
///
/// | symbol | meaning | unit | range |
/// |---|---|---|---|
/// | `speed` | v | m/s | ≠ 0 |
/// | `k_along` | k_x, gain of the target | 1/s | > 0 |
/// | `k_across` | k_y, gain of the sideways error | 1/m² | > 0 |
/// | `k_heading` | k_θ, gain of the heading error | 1/s | > 0 |
///
/// Near the path ÿ + k_θ·ẏ + k_y·v²·y = 0: critically damped where k_θ = 2·|v|·√k_y.
///
/// # Departure
/// [Tran2012] does not say how its robot follows the paths of Fig. 6. This is the law of [Soetanto2003] with its
/// approach angle δ = 0, for which no derivative of the path's curvature is needed.
///
/// # Guarantee
/// Without noise and in continuous time V̇ = −k_x·x² − (k_θ/k_y)·θ_e² ≤ 0 at every speed, and y → 0 as long as the
/// robot moves. One positive factor on (v, ω, ṡ) scales V̇ and keeps its sign. Tested by
/// `path_following::tests::lyapunov_function_decreases_as_stated`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathFollowingLaw<S> {
    /// v \[m/s].
    pub speed: S,
    /// k_x \[1/s].
    pub k_along: S,
    /// k_y \[1/m²].
    pub k_across: S,
    /// k_θ \[1/s].
    pub k_heading: S,
}

impl<S: Scalar> PathFollowingLaw<S> {
    /// The twist of the robot and the speed of the target.
    #[inline]
    pub fn compute(&self, error: &PathError<S>, curvature: S) -> PathCommand<S> {
        let heading = error.heading.radians();
        let sinc = heading.sinc();
        let target_speed = self.target_speed(error);
        let omega = curvature * target_speed
            - self.k_heading * heading
            - self.k_across * self.speed * error.cross_track * sinc;
        PathCommand { twist: Twist::new(self.speed, omega), target_speed }
    }

    /// Computes the command for a robot at `map_from_body` whose target is at `along_track` \[m] on `path`, held for `period`
    /// \[s].
    ///
    /// A held input cannot follow a step of the curvature, so κ is its mean over the travel of the target in the period.
    #[inline]
    pub fn compute_on_path<const N: usize>(
        &self,
        map_from_body: Pose<Map, Body, S>,
        path: &Path<S, N>,
        along_track: S,
        period: S,
    ) -> PathCommand<S> {
        let point = path.at(along_track);
        let error = PathError::from_poses(map_from_body, point.map_from_target);
        let ahead = self.target_speed(&error) * period;
        let still = ahead.abs().lt(S::from_f64(1e-6));
        let turn = path.at(along_track + ahead).map_from_target.heading - point.map_from_target.heading;
        let mean = turn.radians() / S::select(still, S::from_f64(1.0), ahead);
        self.compute(&error, S::select(still, point.curvature, mean))
    }

    #[inline]
    fn target_speed(&self, error: &PathError<S>) -> S {
        let (_, cos) = error.heading.sin_cos();
        self.speed * cos + self.k_along * error.along_track
    }

    /// V = ½(x² + y²) + θ_e²/(2·k_y).
    pub fn lyapunov(&self, error: &PathError<S>) -> S {
        let point = error.along_track.squared() + error.cross_track.squared();
        (point + error.heading.radians().squared() / self.k_across) * S::from_f64(0.5)
    }

    /// V̇ under any `command`, on a path of this `curvature`.
    pub fn lyapunov_rate(&self, error: &PathError<S>, curvature: S, command: &PathCommand<S>) -> S {
        let (along_track, cross_track, heading) = error.rates(curvature, command);
        error.along_track * along_track
            + error.cross_track * cross_track
            + error.heading.radians() * heading / self.k_across
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use crate::geometry::{Angle, Body, Map, Pose};
    use crate::kinematics::{Integration, Motion};

    use super::{PathError, PathFollowingLaw};
    use crate::control::Path;

    const LAW: PathFollowingLaw<f64> =
        PathFollowingLaw { speed: 0.3, k_along: 1.0, k_across: 12.0, k_heading: 2.1 };

    proptest! {
        /// V̇ = −k_x·x² − (k_θ/k_y)·θ_e², from the rates and by moving both robot and target a little.
        #[test]
        fn lyapunov_function_decreases_as_stated(
            x in -3.0..3.0_f64, y in -3.0..3.0_f64, theta in -3.1..3.1_f64, curvature in -3.0..3.0_f64,
            speed in -0.5..0.5_f64,
        ) {
            let law = PathFollowingLaw { speed, ..LAW };
            let error = PathError { along_track: x, cross_track: y, heading: Angle::from_radians(theta) };
            let command = law.compute(&error, curvature);
            let stated = -law.k_along * x * x - law.k_heading / law.k_across * theta * theta;
            let rate = law.lyapunov_rate(&error, curvature, &command);
            prop_assert!((rate - stated).abs() < 1e-9 * (1.0 + stated.abs()));

            let step = 1e-6;
            let moved = |period: f64| {
                let body: Pose<Map, Body, f64> = Pose::new(x, y, Angle::from_radians(theta));
                let length = command.target_speed * period;
                let motion = Motion { length, turn: length * curvature };
                let target = Pose::identity().integrate(motion, Integration::Arc);
                let body = body.integrate(command.twist.integrate_for(period), Integration::Arc);
                law.lyapunov(&PathError::from_poses(body, target))
            };
            let difference = (moved(step) - moved(-step)) / (2.0 * step);
            prop_assert!((difference - stated).abs() < 1e-5 * (1.0 + stated.abs()), "{difference} {stated}");
        }
    }

    /// With the curvature at the start of each period instead of its mean the rectangle is missed by 6 mm.
    #[test]
    fn robot_comes_onto_both_paths_and_stays_there() {
        let start = Pose::new(2.0, 1.0, Angle::zero());
        let rectangle = Path::rounded_rectangle(start, 3.0, 2.0, 0.5).unwrap();
        let triangle = Path::rounded_triangle(start, 3.0, 0.5).unwrap();
        for k in 0..16_u32 {
            let turn = f64::from(k) * 0.4;
            let (x, y) = (2.0 + 0.5 * turn.cos(), 1.0 + 0.5 * turn.sin());
            let body = Pose::new(x, y, Angle::from_radians(-turn));
            assert!(off_path(&rectangle, body) < 2e-3, "rectangle, start {k}");
            assert!(off_path(&triangle, body) < 2e-3, "triangle, start {k}");
        }
    }

    /// The largest distance from the target in the second minute, sampled every 0.1 s.
    fn off_path<const N: usize>(path: &Path<f64, N>, mut body: Pose<Map, Body, f64>) -> f64 {
        let (mut along_track, mut farthest) = (0.0, 0.0_f64);
        for tick in 0..1200 {
            let command = LAW.compute_on_path(body, path, along_track, 0.1);
            body = body.integrate(command.twist.integrate_for(0.1), Integration::Arc);
            along_track += command.target_speed * 0.1;
            if tick > 600 {
                farthest =
                    farthest.max(body.origin().distance(path.at(along_track).map_from_target.origin()));
            }
        }
        farthest
    }
}
