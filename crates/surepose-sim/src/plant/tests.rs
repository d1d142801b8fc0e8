use surepose::kinematics::{DiffDrive, Twist, WheelPair};
use surepose::time::Stamp;

use super::{Plant, PlantModel};

const DRIVE: DiffDrive<f64> = DiffDrive::new(0.05, 0.6);
const PERIOD: f64 = 0.01;

/// Sends one twist per period and returns the twist at the end of each, and the mean one.
fn driven(model: &PlantModel, twists: impl IntoIterator<Item = Twist<f64>>) -> Vec<[Twist<f64>; 2]> {
    let mut plant = Plant::default();
    let mut now = Stamp::default();
    let step = |twist: Twist<f64>| {
        plant.send(model, now, DRIVE.wheel_rates_from_twist(twist));
        let WheelPair { right, left } = plant.advance(model, &DRIVE, now, PERIOD);
        now = now.after(PERIOD);
        let twist = |right, left| {
            DRIVE.twist_from_wheel_speeds(DRIVE.wheel_travel_from_angle(WheelPair { right, left }))
        };
        [twist(right.end, left.end), twist(right.mean, left.mean)]
    };
    twists.into_iter().map(step).collect()
}

fn ahead(speeds: impl IntoIterator<Item = f64>) -> impl Iterator<Item = Twist<f64>> {
    speeds.into_iter().map(|v| Twist::new(v, 0.0))
}

#[test]
fn default_plant_passes_commands_through() {
    let (model, mut plant, now) = (PlantModel::default(), Plant::default(), Stamp::default());
    for rates in [WheelPair::new(0.1, -3.3), WheelPair::new(1e-12, 6.0)] {
        plant.send(&model, now, rates);
        let WheelPair { right, left } = plant.advance(&model, &DRIVE, now, PERIOD);
        assert_eq!(
            (WheelPair::new(right.mean, left.mean), WheelPair::new(right.end, left.end)),
            (rates, rates)
        );
    }
}

/// y(t) = v·(1 − exp(−t/τ)), and the travel is its integral.
#[test]
fn lag_is_exponential() {
    let lag = 0.3;
    let model = PlantModel { lag, ..PlantModel::default() };
    let mut travel = 0.0;
    for (tick, [end, mean]) in driven(&model, ahead([0.2; 100])).into_iter().enumerate() {
        let time = PERIOD * (tick + 1) as f64;
        travel += mean.v * PERIOD;
        let settled = 1.0 - (-time / lag).exp();
        assert!((end.v - 0.2 * settled).abs() < 1e-14, "{time}: {end:?}");
        assert!((travel - 0.2 * (time - lag * settled)).abs() < 1e-14, "{time}: {travel}");
    }
}

/// The lag's answer to a ramp: y(t) = a·(t − τ·(1 − exp(−t/τ))).
#[test]
fn lag_follows_a_ramp_in_closed_form() {
    let (lag, acceleration) = (0.3, 0.1);
    let model = PlantModel { lag, wheel_acceleration: acceleration, ..PlantModel::default() };
    for (tick, [end, _]) in driven(&model, ahead([1.0; 100])).into_iter().enumerate() {
        let time = PERIOD * (tick + 1) as f64;
        let expected = acceleration * (time - lag * (1.0 - (-time / lag).exp()));
        assert!((end.v - expected).abs() < 1e-14, "{time}: {end:?}");
    }
}

#[test]
fn delay_shifts_commands_exactly() {
    let model = PlantModel { command_delay: 0.03, ..PlantModel::default() };
    let speeds: Vec<f64> = (0..50).map(|tick| 0.1 * (0.3 * f64::from(tick)).sin()).collect();
    let (late, prompt) =
        (driven(&model, ahead(speeds.clone())), driven(&PlantModel::default(), ahead(speeds)));
    assert_eq!(late[3..], prompt[..47]);
    assert!(late[..3].iter().flatten().all(|twist| *twist == Twist::zero()));
}

/// With acceleration a and deceleration d the speed is the ramp, and the travel its area, corners included.
#[test]
fn acceleration_and_deceleration_have_their_own_limit() {
    let model = PlantModel { wheel_acceleration: 0.5, wheel_deceleration: 0.2, ..PlantModel::default() };
    // The corner at 0.203/0.5 = 0.406 s lies within a period.
    let up = driven(&model, ahead([0.203; 60]));
    assert!((up[39][0].v - 0.2).abs() < 1e-14 && (up[59][0].v - 0.203).abs() < 1e-14);
    let travel: f64 = up.iter().map(|[_, mean]| mean.v * PERIOD).sum();
    assert!((travel - (0.203 * 0.6 - 0.203 * 0.203 / (2.0 * 0.5))).abs() < 1e-14, "{travel}");
    // From 0.1 through 0 to −0.1: 0.5 s of braking and 0.2 s of acceleration.
    let reversal = driven(&model, ahead([0.1; 30].into_iter().chain([-0.1; 80])));
    assert!((reversal[30 + 24][0].v - 0.05).abs() < 1e-14, "{:?}", reversal[54]);
    assert!((reversal[30 + 59][0].v + 0.05).abs() < 1e-14, "{:?}", reversal[89]);
    assert!((reversal[30 + 70][0].v + 0.1).abs() < 1e-14);
}

#[test]
fn base_executes_nothing_below_its_dead_band() {
    let model = PlantModel { min_speed: 0.02, min_turn_rate: 0.1, ..PlantModel::default() };
    for (sent, executed) in [
        (Twist::new(0.019, 0.2), Twist::new(0.0, 0.2)),
        (Twist::new(-0.05, -0.09), Twist::new(-0.05, 0.0)),
        (Twist::new(0.019, 0.09), Twist::zero()),
        (Twist::new(0.02, 0.1), Twist::new(0.02, 0.1)),
    ] {
        let [end, mean] = driven(&model, [sent])[0];
        assert!((end.v - executed.v).abs() < 1e-15 && (end.omega - executed.omega).abs() < 1e-14, "{end:?}");
        assert!((mean.v - executed.v).abs() < 1e-15, "{mean:?}");
    }
}

/// The right wheel of an arc turns, the left one is below its dead band.
#[test]
fn wheel_does_not_turn_below_its_dead_band() {
    let model = PlantModel { min_wheel_speed: 0.03, ..PlantModel::default() };
    let [end, _] = driven(&model, [Twist::new(0.04, 0.05)])[0];
    let rims = DRIVE.wheel_speeds_from_twist(end);
    assert!((rims.right - 0.055).abs() < 1e-15 && rims.left.abs() < 1e-15, "{rims:?}");
    assert_eq!(driven(&model, ahead([0.0299]))[0], [Twist::zero(); 2]);
}

#[test]
fn breakaway_speed_starts_a_wheel_and_a_lower_one_keeps_it_turning() {
    let model = PlantModel { min_wheel_speed: 0.01, breakaway_speed: 0.03, ..PlantModel::default() };
    let speeds: Vec<f64> = driven(&model, ahead([0.02, 0.03, 0.02, 0.009, 0.02, -0.03, 0.02]))
        .iter()
        .map(|[end, _]| end.v)
        .collect();
    for (speed, expected) in speeds.iter().zip([0.0, 0.03, 0.02, 0.0, 0.0, -0.03, 0.0]) {
        assert!((speed - expected).abs() < 1e-15, "{speeds:?}");
    }
}

#[test]
fn lagging_wheel_comes_to_rest() {
    let model = PlantModel { lag: 0.3, ..PlantModel::default() };
    let ends = driven(&model, ahead([0.3; 100].into_iter().chain([0.0; 400])));
    assert_eq!(ends[499], [Twist::zero(); 2]);
}
