//! On a path: nowhere is no reason to forget where the target is, and a thousand rounds are like the first.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on has failed")]

use surepose::closed_loop::{Followed, Follower};
use surepose::{Angle, Body, Drive, Float, FollowLaw, Integration, Limits, Map, Path, Pose, Twist, Wheels};

fn follower<S: Float>() -> Follower<S, 8> {
    let of = S::of;
    let start = Pose::new(of(2.0), of(1.0), Angle::zero());
    Follower {
        drive: Drive::new(of(0.05), of(0.6)),
        path: Path::rounded_rectangle(start, of(3.0), of(2.0), of(0.5)).unwrap(),
        law: FollowLaw { speed: of(0.2), k_along: of(1.0), k_across: of(12.0), k_heading: of(2.1) },
        limits: Limits { wheel_speed: of(0.3), wheel_acceleration: of(5.0) },
        period: of(0.1),
    }
}

/// The robot after `rounds`, having gone where its wheels were told to; the most by which it was off its target after the
/// first \[m].
fn driven<S: Float>(rounds: f64) -> f64 {
    let follower = follower::<S>();
    let start = follower.path.at(S::of(0.0)).map_from_target;
    let mut pose: Pose<Map, Body, S> = Pose::new(start.x, start.y, start.heading);
    let (mut followed, mut most) = (Followed::<S>::fresh(), 0.0_f64);
    while followed.rounds.to_f64() < rounds {
        let (wheels, next) = follower.step(followed, pose);
        let rims = follower.drive.rims_from_turns(wheels.scaled(follower.period));
        pose = pose.moved(follower.drive.motion_from_travel(rims), Integration::Arc);
        followed = next;
        let target = follower.path.at(followed.along).map_from_target;
        if followed.rounds.to_f64() >= 1.0 {
            most = most.max(pose.origin().distance(target.origin()).to_f64());
        }
        assert!(followed.along < follower.path.length());
    }
    most
}

/// 9 km. A way that were counted over all rounds would have 1 mm for its last digit in f32, and steps of 20.
#[test]
fn a_thousand_rounds_are_like_the_first_ones_in_f32() {
    let (first, all, exactly) = (driven::<f32>(3.0), driven::<f32>(1000.0), driven::<f64>(3.0));
    assert!(first < 0.01 && (first - exactly).abs() < 1e-4, "{first} m, {exactly} m in f64");
    assert!(all < 2.0 * first, "{all} m after {first} m");
}

#[test]
fn nowhere_the_wheels_rest_and_the_target_waits() {
    let follower = follower::<f64>();
    let start: Pose<Map, Body, f64> = Pose::new(2.0, 1.0, Angle::zero());
    let (wheels, before) = follower.step(Followed::fresh(), start);
    assert!(wheels.right > 0.0 && before.along > 0.0);
    for nowhere in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (wheels, waiting) = follower.step(before, Pose::new(nowhere, 1.0, Angle::zero()));
        assert_eq!(
            (wheels, waiting),
            (Wheels::rest(), Followed { granted: Twist::rest(), ..before }),
            "{nowhere}"
        );
        let (wheels, after) = follower.step(waiting, start);
        assert!(wheels.right > 0.0 && after.along > before.along, "{nowhere}: {after:?}");
    }
}
