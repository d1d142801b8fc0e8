use super::{Health, Reason, Supervisor, Verdict, Vigilance};
use crate::{Agreement, Angle, Belief, Outcome, Pose, Refusal, Stamp, Wheels};

const START: Stamp = Stamp::from_nanoseconds(0);

fn supervisor() -> Supervisor<f64> {
    Supervisor::new(Vigilance::default(), START)
}

fn belief(std: f64) -> Belief<f64> {
    Belief::new(Pose::new(0.0, 0.0, Angle::zero()), [std, std, 0.01])
}

fn seen(explained: u16, beyond: u16) -> Agreement<f64> {
    Agreement { beams: 100, explained, before: 100 - explained - beyond, beyond, missing: 0, misfit: 100.0 }
}

#[test]
fn nothing_wrong_nothing_said() {
    let mut supervisor = supervisor();
    for k in 1..=100 {
        let now = Stamp::from_seconds(0.1 * f64::from(k));
        supervisor.rolled(now, Ok(()));
        supervisor.measured(now, Outcome::Accepted { nis: 2.0 }, 2);
        // A fifth of the beams hidden.
        supervisor.looked(&seen(78, 2), 1.0);
        supervisor.followed(Wheels::new(6.0, 6.0), Wheels::new(5.8, 6.1));
        assert_eq!(supervisor.verdict(now, &belief(0.01)), Verdict::Go);
        assert_eq!(supervisor.health(now, &belief(0.01)), Health::Healthy);
    }
}

#[test]
fn lost_after_six_scans_and_until_found() {
    let mut supervisor = supervisor();
    for against in [seen(30, 5), seen(90, 0), seen(70, 20), seen(30, 5), seen(0, 0), seen(30, 5), seen(30, 5)]
    {
        supervisor.looked(&against, 1.0);
        assert_ne!(supervisor.health(START, &belief(0.01)), Health::Lost);
    }
    supervisor.looked(&seen(30, 5), 1.0);
    assert_eq!(supervisor.verdict(START, &belief(0.01)), Verdict::Stop(Reason::Lost));
    for _ in 0..100 {
        supervisor.looked(&seen(99, 0), 1.0);
    }
    assert_eq!(supervisor.health(START, &belief(0.01)), Health::Lost);
    supervisor.found(START);
    assert_eq!(supervisor.health(START, &belief(0.01)), Health::Healthy);
}

#[test]
fn compass_alone_tells_a_turned_robot() {
    let mut supervisor = supervisor();
    for _ in 0..15 {
        assert_eq!(supervisor.health(START, &belief(0.01)), Health::Healthy);
        supervisor.measured(START, Outcome::Refused(Refusal::Outlier), 1);
    }
    assert_eq!(supervisor.health(START, &belief(0.01)), Health::Lost);
}

#[test]
fn every_other_sign_has_its_reason() {
    let later = Stamp::from_seconds(6.0);
    let mut silent = supervisor();
    silent.rolled(later, Err(Refusal::NotFinite));
    assert_eq!(silent.verdict(later, &belief(0.01)), Verdict::Stop(Reason::OdometrySilent));

    let mut unaided = supervisor();
    unaided.rolled(later, Ok(()));
    assert_eq!(unaided.verdict(later, &belief(0.01)), Verdict::Slow(Reason::Unaided));

    assert_eq!(supervisor().verdict(START, &belief(0.5)), Verdict::Slow(Reason::Uncertain));
    assert_eq!(supervisor().verdict(START, &belief(2.0)), Verdict::Stop(Reason::Uncertain));

    let mut inconsistent = supervisor();
    let mut stuck = supervisor();
    for _ in 0..100 {
        inconsistent.measured(START, Outcome::Accepted { nis: 8.0 }, 2);
        stuck.followed(Wheels::new(6.0, 6.0), Wheels::new(0.0, 6.0));
    }
    assert_eq!(inconsistent.verdict(START, &belief(0.01)), Verdict::Slow(Reason::Inconsistent));
    assert_eq!(stuck.verdict(START, &belief(0.01)), Verdict::Slow(Reason::WheelsNotFollowing));
    stuck.followed(Wheels::new(f64::NAN, 6.0), Wheels::new(0.0, 6.0));
    assert_eq!(stuck.verdict(START, &belief(0.01)), Verdict::Slow(Reason::WheelsNotFollowing));
}

#[test]
fn pace_never_exceeds_one() {
    for (verdict, pace) in
        [(Verdict::Go, 1.0), (Verdict::Slow(Reason::Unaided), 0.3), (Verdict::Stop(Reason::Lost), 0.0)]
    {
        assert!((verdict.pace::<f64>() - pace).abs() < f64::EPSILON);
    }
}

/// Every beam is explained, and all together put the robot elsewhere: a push, which one broken scan is not.
#[test]
fn scans_that_agree_on_another_place_make_it_lost() {
    let mut supervisor = supervisor();
    supervisor.looked(&seen(95, 0), 1e6);
    for _ in 0..20 {
        supervisor.looked(&seen(95, 0), 1.0);
        assert_eq!(supervisor.health(START, &belief(0.01)), Health::Healthy);
    }
    let scans = (1..50).find(|_| {
        supervisor.looked(&seen(95, 0), 4.5);
        supervisor.health(START, &belief(0.01)) == Health::Lost
    });
    assert!(scans.is_some_and(|scans| (10..=15).contains(&scans)), "{scans:?}");
    supervisor.found(START);
    supervisor.looked(&seen(95, 0), 1.0);
    assert_eq!(supervisor.verdict(START, &belief(0.01)), Verdict::Go);
}

/// Put down where hardly anything is near, a robot sees little that contradicts it, and misses much.
#[test]
fn walls_that_are_missing_make_it_lost() {
    let mut supervisor = supervisor();
    for missing in [0, 4, 40] {
        let void = Agreement { beams: 6, explained: 0, before: 0, beyond: 6, missing, misfit: 100.0 };
        (0..6).for_each(|_| supervisor.looked(&void, 1.0));
        assert_eq!(supervisor.health(START, &belief(0.01)) == Health::Lost, missing == 40, "{missing}");
    }
}

#[test]
fn a_scan_that_says_nothing_changes_nothing() {
    let few = Agreement { beams: 5, explained: 5, ..seen(0, 0) };
    let mut supervisor = supervisor();
    for _ in 0..20 {
        supervisor.looked(&few, 20.0);
        supervisor.looked(&seen(95, 0), f64::NAN);
        assert_eq!(supervisor.verdict(START, &belief(0.01)), Verdict::Go);
    }
    // And what is no number leaves it able to tell.
    for _ in 0..20 {
        supervisor.looked(&seen(95, 0), f64::INFINITY);
    }
    assert_eq!(supervisor.health(START, &belief(0.01)), Health::Lost);
}

/// Odometry of an hour ahead, from one wrong stamp: nobody knows what the robot does now.
#[test]
fn odometry_of_the_future_is_silent_until_the_clock_that_counts_is_known() {
    let (now, ahead) = (Stamp::from_seconds(1.0), Stamp::from_seconds(3600.0));
    let mut supervisor = supervisor();
    supervisor.rolled(ahead, Ok(()));
    supervisor.measured(ahead, Outcome::Accepted { nis: 1.0 }, 1);
    assert_eq!(supervisor.verdict(now, &belief(0.01)), Verdict::Stop(Reason::OdometrySilent));
    supervisor.rolled(now, Ok(()));
    assert_eq!(supervisor.verdict(now, &belief(0.01)), Verdict::Go);
    // What helped the robot by the other clock does not help it for an hour.
    let later = now.after(6.0);
    supervisor.rolled(later, Ok(()));
    assert_eq!(supervisor.verdict(later, &belief(0.01)), Verdict::Slow(Reason::Unaided));
}

#[test]
fn a_belief_that_is_no_number_is_not_driven_by() {
    assert_eq!(supervisor().verdict(START, &belief(f64::NAN)), Verdict::Stop(Reason::Uncertain));
}
