use crate::estimation::{Belief, MeasurementOutcome, RejectReason};
use crate::geometry::{Angle, Pose};
use crate::kinematics::WheelPair;
use crate::lidar::BeamStats;
use crate::time::Stamp;

use super::{FaultReason, Health, SafetyAction, Supervisor, SupervisorConfig};

const START: Stamp = Stamp::from_nanoseconds(0);

fn supervisor() -> Supervisor<f64> {
    Supervisor::new(SupervisorConfig::default(), START)
}

fn belief(std: f64) -> Belief<f64> {
    Belief::new(Pose::new(0.0, 0.0, Angle::zero()), [std, std, 0.01])
}

fn stats(hits: u16, behind_wall: u16) -> BeamStats<f64> {
    BeamStats {
        beams: 100,
        hits,
        short: 100 - hits - behind_wall,
        behind_wall,
        missed_returns: 0,
        neg2_log_likelihood: 100.0,
    }
}

#[test]
fn consistent_inputs_raise_no_fault() {
    let mut supervisor = supervisor();
    for k in 1..=100 {
        let now = Stamp::from_seconds(0.1 * f64::from(k));
        supervisor.on_odometry(now, true);
        supervisor.on_measurement(now, MeasurementOutcome::Accepted { nis: 2.0 }, 2);
        // A fifth of the beams hidden.
        supervisor.on_scan(&stats(78, 2), 1.0);
        supervisor.on_wheel_speeds(WheelPair::new(6.0, 6.0), WheelPair::new(5.8, 6.1));
        assert_eq!(supervisor.action(now, &belief(0.01)), SafetyAction::Proceed);
        assert_eq!(supervisor.health(now, &belief(0.01)), Health::Healthy);
    }
}

#[test]
fn lost_after_six_scans_and_until_relocalized() {
    let mut supervisor = supervisor();
    for contradicting in
        [stats(25, 5), stats(90, 0), stats(70, 20), stats(25, 5), stats(0, 0), stats(25, 5), stats(25, 5)]
    {
        supervisor.on_scan(&contradicting, 1.0);
        assert_ne!(supervisor.health(START, &belief(0.01)), Health::Lost);
    }
    supervisor.on_scan(&stats(25, 5), 1.0);
    assert_eq!(supervisor.action(START, &belief(0.01)), SafetyAction::Stop(FaultReason::Lost));
    for _ in 0..100 {
        supervisor.on_scan(&stats(99, 0), 1.0);
    }
    assert_eq!(supervisor.health(START, &belief(0.01)), Health::Lost);
    supervisor.on_relocalized(START);
    assert_eq!(supervisor.health(START, &belief(0.01)), Health::Healthy);
}

/// Things on no map hide nearly half of the beams, and the others end at walls.
#[test]
fn clutter_alone_does_not_mark_the_robot_lost() {
    let mut supervisor = supervisor();
    for _ in 0..100 {
        supervisor.on_scan(&stats(52, 3), 1.0);
        assert_eq!(supervisor.health(START, &belief(0.01)), Health::Healthy);
    }
    // As many hits, while the others pass through walls.
    for _ in 0..6 {
        supervisor.on_scan(&stats(52, 15), 1.0);
    }
    assert_eq!(supervisor.health(START, &belief(0.01)), Health::Lost);
}

/// A robot that slipped toward a wall sees it too near, as it sees things on no map: the map does not explain the scan, which
/// starts the search for another pose, and does not contradict it, which would make the robot lost.
#[test]
fn hidden_walls_are_neither_explained_nor_contradicted() {
    let supervisor = supervisor();
    let explained =
        |stats: BeamStats<f64>| (supervisor.agrees_with_map(&stats), supervisor.contradicts_map(&stats));
    assert_eq!(explained(stats(95, 0)), (true, false));
    assert_eq!(explained(stats(52, 3)), (false, false));
    assert_eq!(explained(stats(52, 15)), (false, true));
    assert_eq!(explained(stats(20, 0)), (false, true), "hardly any wall is seen");
}

#[test]
fn compass_outliers_alone_mark_the_robot_lost() {
    let mut supervisor = supervisor();
    for _ in 0..15 {
        assert_eq!(supervisor.health(START, &belief(0.01)), Health::Healthy);
        supervisor.on_measurement(START, MeasurementOutcome::Rejected(RejectReason::Outlier), 1);
    }
    assert_eq!(supervisor.health(START, &belief(0.01)), Health::Lost);
}

#[test]
fn every_other_fault_has_its_reason() {
    let later = Stamp::from_seconds(6.0);
    let mut silent = supervisor();
    silent.on_odometry(later, false);
    assert_eq!(silent.action(later, &belief(0.01)), SafetyAction::Stop(FaultReason::OdometryTimeout));

    let mut unaided = supervisor();
    unaided.on_odometry(later, true);
    assert_eq!(unaided.action(later, &belief(0.01)), SafetyAction::Slowdown(FaultReason::DeadReckoningOnly));

    assert_eq!(supervisor().action(START, &belief(0.5)), SafetyAction::Slowdown(FaultReason::Uncertain));
    assert_eq!(supervisor().action(START, &belief(2.0)), SafetyAction::Stop(FaultReason::Uncertain));

    let mut inconsistent = supervisor();
    let mut stuck = supervisor();
    for _ in 0..100 {
        inconsistent.on_measurement(START, MeasurementOutcome::Accepted { nis: 8.0 }, 2);
        stuck.on_wheel_speeds(WheelPair::new(6.0, 6.0), WheelPair::new(0.0, 6.0));
    }
    assert_eq!(inconsistent.action(START, &belief(0.01)), SafetyAction::Slowdown(FaultReason::Inconsistent));
    assert_eq!(stuck.action(START, &belief(0.01)), SafetyAction::Slowdown(FaultReason::WheelTrackingError));
    stuck.on_wheel_speeds(WheelPair::new(f64::NAN, 6.0), WheelPair::new(0.0, 6.0));
    assert_eq!(stuck.action(START, &belief(0.01)), SafetyAction::Slowdown(FaultReason::WheelTrackingError));
}

#[test]
fn pace_never_exceeds_one() {
    for (action, speed_scale) in [
        (SafetyAction::Proceed, 1.0),
        (SafetyAction::Slowdown(FaultReason::DeadReckoningOnly), 0.3),
        (SafetyAction::Stop(FaultReason::Lost), 0.0),
    ] {
        assert!((action.speed_scale::<f64>() - speed_scale).abs() < f64::EPSILON);
    }
}

/// Every beam is explained, and all together put the robot elsewhere: a push, which one broken scan is not.
#[test]
fn scans_consistent_with_another_pose_mark_the_robot_lost() {
    let mut supervisor = supervisor();
    supervisor.on_scan(&stats(95, 0), 1e6);
    for _ in 0..20 {
        supervisor.on_scan(&stats(95, 0), 1.0);
        assert_eq!(supervisor.health(START, &belief(0.01)), Health::Healthy);
    }
    let scans = (1..50).find(|_| {
        supervisor.on_scan(&stats(95, 0), 4.5);
        supervisor.health(START, &belief(0.01)) == Health::Lost
    });
    assert!(scans.is_some_and(|scans| (10..=15).contains(&scans)), "{scans:?}");
    supervisor.on_relocalized(START);
    supervisor.on_scan(&stats(95, 0), 1.0);
    assert_eq!(supervisor.action(START, &belief(0.01)), SafetyAction::Proceed);
}

/// Put down where hardly anything is near, a robot sees little that contradicts it, and misses much.
#[test]
fn missed_returns_mark_the_robot_lost() {
    let mut supervisor = supervisor();
    for missed_returns in [0, 4, 40] {
        let sparse = BeamStats {
            beams: 6,
            hits: 0,
            short: 0,
            behind_wall: 6,
            missed_returns,
            neg2_log_likelihood: 100.0,
        };
        (0..6).for_each(|_| supervisor.on_scan(&sparse, 1.0));
        assert_eq!(
            supervisor.health(START, &belief(0.01)) == Health::Lost,
            missed_returns == 40,
            "{missed_returns}"
        );
    }
}

#[test]
fn uninformative_scans_change_nothing() {
    let few = BeamStats { beams: 5, hits: 5, ..stats(0, 0) };
    let mut supervisor = supervisor();
    for _ in 0..20 {
        supervisor.on_scan(&few, 20.0);
        supervisor.on_scan(&stats(95, 0), f64::NAN);
        assert_eq!(supervisor.action(START, &belief(0.01)), SafetyAction::Proceed);
    }
    // And what is no number leaves it able to tell.
    for _ in 0..20 {
        supervisor.on_scan(&stats(95, 0), f64::INFINITY);
    }
    assert_eq!(supervisor.health(START, &belief(0.01)), Health::Lost);
}

/// One stamp an hour ahead: the current motion is unknown.
#[test]
fn future_odometry_times_out_until_the_clock_is_known() {
    let (now, ahead) = (Stamp::from_seconds(1.0), Stamp::from_seconds(3600.0));
    let mut supervisor = supervisor();
    supervisor.on_odometry(ahead, true);
    supervisor.on_measurement(ahead, MeasurementOutcome::Accepted { nis: 1.0 }, 1);
    assert_eq!(supervisor.action(now, &belief(0.01)), SafetyAction::Stop(FaultReason::OdometryTimeout));
    supervisor.on_odometry(now, true);
    assert_eq!(supervisor.action(now, &belief(0.01)), SafetyAction::Proceed);
    // What helped the robot by the other clock does not help it for an hour.
    let later = now.after(6.0);
    supervisor.on_odometry(later, true);
    assert_eq!(
        supervisor.action(later, &belief(0.01)),
        SafetyAction::Slowdown(FaultReason::DeadReckoningOnly)
    );
}

#[test]
fn invalid_belief_stops_the_robot() {
    assert_eq!(supervisor().action(START, &belief(f64::NAN)), SafetyAction::Stop(FaultReason::Uncertain));
}
