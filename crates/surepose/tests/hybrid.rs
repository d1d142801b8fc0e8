//! The hybrid law: it descends, it does not change its mind on noise, and it parks, noise or not.

#![allow(clippy::float_cmp, reason = "legs are exact values")]

use proptest::prelude::*;
use surepose::control::{
    BrakingProfile, Controller, ControllerState, Deadband, Direction, Gains, HybridLaw, HybridState, Law,
    Limits, LocalLaw, NavigationVariables, Tolerance, Tran2012Law,
};
use surepose::geometry::{Angle, Body, Goal, Map, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist};
use surepose::scalar::Float;

const PI: f64 = core::f64::consts::PI;

fn drive<S: Float>() -> DiffDrive<S> {
    DiffDrive::new(S::from_f64(0.05), S::from_f64(0.6))
}

fn limits<S: Float>(acceleration: f64) -> Limits<S> {
    Limits::symmetric(S::from_f64(0.3), S::from_f64(acceleration))
}

fn law<S: Float>(period: f64, direction: Direction) -> HybridLaw<S> {
    HybridLaw::fitted(&drive(), &limits(f64::INFINITY), S::from_f64(period), direction)
}

fn navigation(rho: f64, alpha: f64, phi: f64) -> NavigationVariables<f64> {
    NavigationVariables { rho, alpha: Angle::from_radians(alpha), phi: Angle::from_radians(phi) }
}

fn angle() -> impl Strategy<Value = f64> {
    -PI..PI
}

fn memory(local_mode: bool, reverse: bool, turn_direction: f64) -> HybridState<f64> {
    HybridState { local_mode, reverse, turn_direction, ..HybridState::new() }
}

/// The goal as the end that goes first sees it, and how that end moves.
fn in_direction_of_travel(
    n: NavigationVariables<f64>,
    reverse: bool,
    twist: Twist<f64>,
) -> (NavigationVariables<f64>, Twist<f64>) {
    if reverse { (n.reversed(), Twist::new(-twist.v, twist.omega)) } else { (n, twist) }
}

/// A small, seeded source of standard normal numbers: the sum of twelve uniform ones.
struct Noise(u64);

impl Noise {
    fn draw(&mut self) -> f64 {
        let mut uniform = || {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

proptest! {
    /// W = c·ln ρ + ½(α² + hφ²) falls everywhere outside the capture radius, whatever the memory: c = 2, h = 0.1.
    #[test]
    fn global_law_descends(
        rho in 0.0331..5.0, alpha in angle(), phi in angle(), reverse: bool, period in 0.005..0.1, slow: bool,
    ) {
        let n = navigation(rho, alpha, phi);
        let limits = limits(if slow { 0.1 } else { 1e4 });
        let law = HybridLaw::fitted(&drive(), &limits, period, Direction::Auto);
        let braking = BrakingProfile::from_limits(&drive(), &limits);
        let remembered = memory(false, reverse, n.alpha.radians().signum());
        let output = Law::Hybrid(law).compute_with_braking(Some(&braking), &n, remembered);
        prop_assert!(!output.state.local_mode);
        let (front, twist) = in_direction_of_travel(n, output.state.reverse, output.twist);
        prop_assume!(front.alpha.radians() * output.state.turn_direction >= 0.0); // not continued beyond ±π
        let (rho_rate, alpha_rate, phi_rate) = front.rates(twist);
        let rate = 2.0 * rho_rate / rho + front.alpha.radians() * alpha_rate + 0.1 * front.phi.radians() * phi_rate;
        prop_assert!(rate < 0.0, "dW/dt = {rate}");
        prop_assert!(twist.v >= 0.0, "the front backs off");
    }

    /// V̇_l ≤ 0 wherever the local law is in charge, (26)–(29).
    #[test]
    fn local_law_descends(rho in 0.0..0.0197, alpha in angle(), phi in angle(), reverse: bool) {
        let n = navigation(rho, alpha, phi);
        let side = -n.heading_error().radians().signum();
        let output = law(0.02, Direction::Auto).compute(&n, memory(true, reverse, side));
        prop_assume!(output.state.local_mode);
        let rate = LocalLaw { k_v: 1.0, k_theta: 1.0 }.lyapunov_rate(&n, output.twist);
        prop_assert!(rate <= 1e-12, "{rate}");
    }

    /// The robot turns round only where W falls by it.
    #[test]
    fn reversal_is_a_descent(alpha in angle(), phi in angle(), reverse: bool) {
        let law = law(0.02, Direction::Auto);
        let n = navigation(1.0, alpha, phi);
        let turned = law.compute(&n, memory(false, reverse, 1.0)).state.reverse;
        let level = |reverse: bool| {
            let front = if reverse { n.reversed() } else { n };
            0.5 * (front.alpha.radians().powi(2) + law.gains.h * front.phi.radians().powi(2))
        };
        prop_assert!(turned == reverse || level(turned) < level(reverse) - 4.0);
    }

    /// Every number in, a finite twist out.
    #[test]
    fn every_input_has_a_finite_answer(
        rho in any::<f64>(), alpha in any::<f64>(), phi in any::<f64>(), local_mode: bool, reverse: bool, side in -1.0..1.0,
    ) {
        let n = NavigationVariables { rho, alpha: Angle::from_radians(alpha), phi: Angle::from_radians(phi) };
        for law in [Law::Hybrid(law(0.02, Direction::Auto)), Law::Tran2012(paper())] {
            let twist = law.compute(&n, memory(local_mode, reverse, side)).twist;
            prop_assert!(twist.v.is_finite() && twist.omega.is_finite(), "{twist:?}");
        }
    }
}

fn paper() -> Tran2012Law<f64> {
    Tran2012Law { gains: Gains::tran2012(), capture_radius: 0.01, capture_heading: PI }
}

#[test]
fn odd_inputs_have_a_finite_answer() {
    let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, f64::MIN_POSITIVE, f64::MAX, PI, -PI];
    for (rho, alpha, phi) in odd.iter().flat_map(|r| odd.iter().flat_map(move |a| odd.map(|p| (*r, *a, p)))) {
        let n = NavigationVariables { rho, alpha: Angle::from_radians(alpha), phi: Angle::from_radians(phi) };
        for law in [Law::Hybrid(law(0.02, Direction::Auto)), Law::Tran2012(paper())] {
            let twist = law.compute(&n, HybridState::new()).twist;
            assert!(twist.v.is_finite() && twist.omega.is_finite(), "{twist:?} for {n:?}");
        }
    }
}

/// Near α = ±π noise flips the sign of the wrapped angle. The robot keeps the side that it has begun with.
#[test]
fn turn_direction_survives_noise() {
    let law: HybridLaw<f64> = law(0.02, Direction::Forward);
    for side in [-1.0, 1.0] {
        let mut noise = Noise(7);
        let mut remembered = memory(false, false, side);
        for _ in 0..10_000 {
            let n = navigation(1.0, PI + 0.1 * noise.draw(), 0.3);
            let output = law.compute(&n, remembered);
            assert!(output.twist.omega * side > 0.0);
            remembered = output.state;
        }
    }
}

/// A goal abeam is equally far for nose and tail. Once chosen, the direction stays.
#[test]
fn drive_direction_survives_noise() {
    let law: HybridLaw<f64> = law(0.02, Direction::Auto);
    let mut noise = Noise(11);
    let mut remembered = HybridState::new();
    let mut chosen = None;
    for _ in 0..10_000 {
        let n = navigation(1.0, 0.5 * PI + 0.2 * noise.draw(), 0.5 * PI + 0.2 * noise.draw());
        remembered = law.compute(&n, remembered).state;
        assert_eq!(*chosen.get_or_insert(remembered.reverse), remembered.reverse);
    }
}

/// Each gain removes less than the whole error per period.
#[test]
fn fitted_gains_suit_the_period() {
    for period in [0.005, 0.02, 0.1, 0.5] {
        let gains = Gains::<f64>::for_loop(period, &limits(1e6));
        assert!(gains.k_v * period < 0.21 && gains.k_alpha * period < 0.25);
        assert!(gains.k_theta * period < 1.0 + 1e-12, "beyond 1 a turn overshoots");
    }
}

struct ParkingResult {
    reached: bool,
    /// Number of switches between the laws.
    switches: u32,
    /// \[m]
    distance: f64,
}

/// Drives from `start` to the origin, the pose seen with noise of `position` \[m] and `heading` \[rad].
fn park<S: Float>(
    controller: &Controller<S>,
    start: (f64, f64, f64),
    mut noise: Noise,
    (position, heading): (f64, f64),
) -> ParkingResult {
    let goal: Pose<Map, Goal, S> = Pose::new(S::from_f64(0.0), S::from_f64(0.0), Angle::zero());
    let mut pose: Pose<Map, Body, S> =
        Pose::new(S::from_f64(start.0), S::from_f64(start.1), Angle::from_radians(S::from_f64(start.2)));
    let mut state = ControllerState::new();
    let mut result = ParkingResult { reached: false, switches: 0, distance: 0.0 };
    let ticks = (120.0 / controller.period.to_f64()) as u32;
    for _ in 0..ticks {
        let seen = Pose::new(
            pose.x + S::from_f64(position * noise.draw()),
            pose.y + S::from_f64(position * noise.draw()),
            pose.heading.rotated_by(S::from_f64(heading * noise.draw())),
        );
        let step = controller.step(state, seen, goal);
        assert!(controller.drive.wheel_speeds_from_twist(step.limited).max_abs().to_f64() <= 0.3 + 1e-6);
        result.switches += u32::from(step.state.hybrid.local_mode != state.hybrid.local_mode);
        pose = pose.integrate(step.limited.integrate_for(controller.period), Integration::Arc);
        state = step.state;
        result.distance = NavigationVariables::from_poses(pose, goal).rho.to_f64();
        result.reached = state.goal_checker.reached(&controller.tolerance);
        if result.reached {
            break;
        }
    }
    result
}

fn controller<S: Float>(period: f64, acceleration: f64, direction: Direction) -> Controller<S> {
    let tolerance = Tolerance {
        position: S::from_f64(0.01),
        heading: S::from_f64(1f64.to_radians()),
        dwell: S::from_f64(1.0),
        hysteresis: S::from_f64(1.5),
    };
    Controller::fitted(drive(), limits(acceleration), S::from_f64(period), direction, tolerance)
}

fn start() -> impl Strategy<Value = (f64, f64, f64)> {
    (-3.0..3.0, -3.0..3.0, angle())
}

fn direction() -> impl Strategy<Value = Direction> {
    prop_oneof![Just(Direction::Auto), Just(Direction::Forward), Just(Direction::Reverse)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// From everywhere, in both formats, at both periods, with and without an acceleration limit.
    #[test]
    fn every_start_parks(start in start(), direction in direction(), slow: bool, limited: bool) {
        let (period, acceleration) = (if slow { 0.1 } else { 0.02 }, if limited { 0.5 } else { 1e4 });
        let double = park(&controller::<f64>(period, acceleration, direction), start, Noise(1), (0.0, 0.0));
        prop_assert!(double.reached && double.distance < 0.01, "stands {} m off", double.distance);
        let single = park(&controller::<f32>(period, acceleration, direction), start, Noise(1), (0.0, 0.0));
        prop_assert!(single.reached && single.distance < 0.01, "f32 stands {} m off", single.distance);
    }

    /// The estimate of a laser localisation; the switch does not chatter.
    #[test]
    fn every_start_parks_with_noise(start in start(), direction in direction(), slow: bool, seed in 1u64..) {
        let period = if slow { 0.1 } else { 0.02 };
        let result = park(&controller::<f64>(period, 1e4, direction), start, Noise(seed), (0.0017, 0.0013));
        prop_assert!(result.reached && result.distance < 0.012, "stands {} m off", result.distance);
        prop_assert!(result.switches <= 7, "switched {} times", result.switches);
    }
}

/// The deadband suppresses motion by noise and reverses only for errors larger than the noise.
#[test]
fn deadband_suppresses_noise_driven_motion() {
    let with_deadband = |noise: f64| HybridLaw {
        deadband: Some(Deadband::from_noise(noise, 0.02)),
        ..law::<f64>(0.02, Direction::Forward)
    };
    let drives = |noise: f64, ahead: f64, drive_direction: f64| -> i32 {
        let n = navigation(ahead.abs(), if ahead < 0.0 { PI } else { 0.0 }, 0.0);
        let v = with_deadband(noise)
            .compute(&n, HybridState { local_mode: true, drive_direction, ..memory(true, false, 1.0) })
            .twist
            .v;
        i32::from(v > 0.0) - i32::from(v < 0.0)
    };
    // Once with the reach of the given noise, once with the upper bound of the reach. A robot at rest is within
    // 0.35 capture radii of the goal, where the local law turns it.
    for (noise, reach) in [(0.005, 0.005 * 0.12 / 0.02_f64.sqrt()), (1.0, 0.13 * 0.033)] {
        assert!(2.4 * reach < 0.35 * 0.033);
        assert_eq!([0.9, 1.1, -2.3, -2.5].map(|k| drives(noise, k * reach, 1.0)), [0, 1, 0, -1]);
        assert_eq!([-0.9, -1.1, 2.3, 2.5].map(|k| drives(noise, k * reach, -1.0)), [0, -1, 0, 1]);
    }
}

/// The heading is trimmed by a recursive mean: of `n` sightings of a robot that stands still, each counts the same.
#[test]
fn trimming_averages_the_measurements() {
    let law: HybridLaw<f64> = law(0.1, Direction::Forward);
    let gain = |trim_ticks: f64| {
        let n = navigation(0.0, 0.0, 0.01);
        let step = law.compute(&n, HybridState { trim_ticks, ..memory(true, false, -1.0) });
        assert!((step.state.trim_ticks - (trim_ticks + 1.0).min(25.0)).abs() < 1e-9);
        -step.twist.omega / 0.01 * 0.1
    };
    for n in 0..7 {
        assert!((gain(f64::from(n)) - 1.0 / f64::from(n + 1)).abs() < 1e-9, "tick {n}");
    }
    assert!(gain(1e6) > 0.1, "an error that grows again is followed");
}

/// A goal abeam: the robot turns by 45°, drives to the axis of the goal, and returns, without getting farther away.
#[test]
fn sidestep_reduces_the_lateral_error() {
    let law: HybridLaw<f64> = law(0.02, Direction::Auto);
    for (side, reverse) in [(-1.0, false), (1.0, false), (-1.0, true), (1.0, true)] {
        let offset = 0.02;
        let mut pose: Pose<Goal, Body, f64> = Pose::new(0.0, side * offset, Angle::zero());
        let mut state = memory(true, reverse, 1.0);
        let (mut largest_turn, mut largest_distance, mut legs) = (0.0_f64, 0.0_f64, Vec::new());
        for _ in 0..150 {
            let output = law.compute(&NavigationVariables::from_goal_frame(pose), state);
            if output.state.sidestep != state.sidestep {
                legs.push(output.state.sidestep.abs());
            }
            let twist = limits(f64::INFINITY).limit_speed(&drive(), output.twist);
            pose = pose.integrate(twist.integrate_for(0.02), Integration::Arc);
            state = output.state;
            largest_turn = largest_turn.max(pose.heading.degrees().abs());
            largest_distance = largest_distance.max(pose.x.hypot(pose.y));
        }
        assert_eq!(legs, [1.0, 0.5, 0.0], "out, back, none");
        assert!((43.0..47.0).contains(&largest_turn), "turned by {largest_turn}°");
        assert!(largest_distance < offset + 1e-4, "{largest_distance} m from the goal");
        assert!(pose.y.abs() < 0.15 * offset && pose.x.abs() < 1e-3, "ended at {pose:?}");
        assert!(pose.heading.degrees().abs() < 0.1, "ended at {pose:?}");
    }
}

/// Estimates that scatter across the threshold start no sidestep: their mean decides.
#[test]
fn noise_alone_starts_no_sidestep() {
    let law: HybridLaw<f64> = law(0.02, Direction::Auto);
    let mut noise = Noise(5);
    let mut state = memory(true, false, 1.0);
    let mut beyond = 0;
    for _ in 0..10_000 {
        let seen: Pose<Goal, Body, f64> =
            Pose::new(0.0, 0.003 + 0.005 * noise.draw(), Angle::from_radians(0.002 * noise.draw()));
        beyond += u32::from(seen.y > 0.25 * law.capture_radius);
        state = law.compute(&NavigationVariables::from_goal_frame(seen), state).state;
        assert!(state.local_mode && state.sidestep == 0.0);
    }
    assert!(beyond > 1000, "the noise is too small to test anything: {beyond}");
}
