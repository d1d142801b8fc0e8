//! Errors that the actuators add to the noise: dead time that is not predicted, and pulses in place of small speeds.

use surepose::control::{ActuatorModel, Limits, MAX_PENDING, MinSpeeds};
use surepose::kinematics::DiffDrive;

use crate::noise::NoiseBounds;

/// Pulses exceed the configured minimum by this factor at most, with room for rounding.
const PULSE_MARGIN: f64 = 1.021;

/// Actuators of the base, and the model of them that the controller has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorErrors {
    /// The model that the controller predicts with and modulates pulses for.
    pub model: ActuatorModel<f64>,
    /// Dead time of the base between a command and its effect \[s].
    pub delay: f64,
}

impl ActuatorErrors {
    /// Base with the dead time of its `model`.
    pub fn from_model(model: ActuatorModel<f64>) -> Self {
        Self { model, delay: model.delay }
    }

    /// Base that executes every command at once.
    pub fn ideal() -> Self {
        Self::from_model(ActuatorModel::ideal())
    }

    /// Returns `noise` with the errors that the actuators add.
    ///
    /// The certificate then covers the *predicted* pose: the true pose at the time at which the next command takes effect.
    ///
    /// - A predicted dead time adds what the pose errors grow to on the way: the heading error times the distance, and the errors of
    ///   the wheels.
    /// - The rest of the dead time, at most Δ, is a pose error: V·Δ and 2V/b·Δ, with wheel separation b.
    /// - A speed below its minimum becomes rest or a pulse. In each tick the rim differs from the asked speed by at most the pulse, and
    ///   by twice as much in pulses of several ticks. A pulse of v or ω can make the other speed yield by as much.
    pub fn widen(
        &self,
        noise: NoiseBounds,
        drive: &DiffDrive<f64>,
        limits: &Limits<f64>,
        period: f64,
    ) -> NoiseBounds {
        let fastest = limits.wheel_speed * (1.0 + noise.rim_speed_part) + noise.rim_speed;
        let predicted = self.model.delay.min(MAX_PENDING as f64 * period);
        let missed = (self.delay - predicted).abs();
        let rim_error = noise.rim_speed_part * limits.wheel_speed + noise.rim_speed;
        let per_rim = 2.0 / drive.wheel_separation;
        let on_the_way = predicted.min(self.delay);
        let heading = noise.heading + per_rim * (fastest * missed + rim_error * on_the_way);
        let position = noise.position + fastest * missed + (rim_error + fastest * heading) * on_the_way;
        let outward = |wider: f64, from: f64| if wider > from { wider * (1.0 + 1e-12) } else { from };
        NoiseBounds {
            position: outward(position, noise.position),
            heading: outward(heading, noise.heading),
            rim_speed: noise.rim_speed + pulse_error(&self.model.min_speeds, drive, limits, period),
            ..noise
        }
    }
}

/// Largest difference of a rim from the asked speed in one tick \[m/s].
fn pulse_error(min: &MinSpeeds<f64>, drive: &DiffDrive<f64>, limits: &Limits<f64>, period: f64) -> f64 {
    let ticks = min.pulse_ticks(drive, limits, period);
    let off = |speed: f64, ticks: u16| speed * if ticks > 1 { 2.0 } else { 1.0 } * PULSE_MARGIN;
    let turn = off(min.omega * 0.5 * drive.wheel_separation, ticks.omega);
    let twist = off(min.v, ticks.v) + turn;
    // Only minima of v and ω alone let the other speed yield.
    if min.wheel > 0.0 { twist + off(min.wheel, ticks.wheel) } else { 2.0 * twist }
}

#[cfg(test)]
mod tests {
    use surepose::control::{ActuatorModel, ActuatorState, Limits, MinSpeeds};
    use surepose::geometry::{Angle, Body, Map, Pose};
    use surepose::kinematics::{DiffDrive, Integration, Twist};

    use super::{ActuatorErrors, pulse_error};
    use crate::counterexample::Rng;
    use crate::noise::NoiseBounds;

    const DRIVE: DiffDrive<f64> = DiffDrive::new(0.05, 0.6);
    const LIMITS: Limits<f64> = Limits::symmetric(0.3, 1e9);
    const PERIOD: f64 = 0.02;

    #[test]
    fn ideal_base_adds_nothing() {
        let noise = NoiseBounds { position: 0.007, heading: 0.004, rim_speed: 0.001, rim_speed_part: 0.05 };
        assert_eq!(ActuatorErrors::ideal().widen(noise, &DRIVE, &LIMITS, PERIOD), noise);
    }

    #[test]
    fn dead_time_that_is_not_predicted_is_a_pose_error() {
        let late = ActuatorErrors { delay: 0.04, ..ActuatorErrors::ideal() };
        let noise = late.widen(NoiseBounds::default(), &DRIVE, &LIMITS, PERIOD);
        assert!((noise.position - 0.012).abs() < 1e-9 && (noise.heading - 0.04).abs() < 1e-9, "{noise:?}");
    }

    /// Random commands through the shipped actuator stage, and a base whose dead time may be another one.
    #[test]
    fn predicted_pose_stays_within_the_bounds() {
        let mut rng = Rng(7);
        let mut tightest = 0.0_f64;
        for (predicted, delay) in [(0.04, 0.04), (0.05, 0.03), (0.0, 0.02), (0.03, 0.05)] {
            let model = ActuatorModel { delay: predicted, ..ActuatorModel::ideal() };
            let sensed = NoiseBounds { position: 0.007, heading: 0.004, ..NoiseBounds::default() };
            let bound = ActuatorErrors { model, delay }.widen(sensed, &DRIVE, &LIMITS, PERIOD);
            // The base repeats each command in quarters of a period, `delay` later.
            let quarter = PERIOD / 4.0;
            let late = (delay / quarter).round() as usize;
            for _ in 0..2000 {
                let mut state = ActuatorState::new();
                let mut sent = vec![Twist::zero(); late];
                let extreme =
                    |rng: &mut Rng| if rng.part() < 0.5 { rng.either().signum() } else { rng.either() };
                for _ in 0..12 {
                    let (v, turn) = (0.3 * extreme(&mut rng), 1.0 * extreme(&mut rng));
                    let asked = LIMITS.limit_speed(&DRIVE, Twist::new(v, turn));
                    let command = state.execute(&model, &DRIVE, &LIMITS, asked, PERIOD);
                    sent.extend([command; 4]);
                }
                let start: Pose<Map, Body, f64> = Pose::identity();
                let way = |from: usize, to: usize, start: Pose<Map, Body, f64>| {
                    sent[from..to].iter().fold(start, |pose, twist| {
                        pose.integrate(twist.integrate_for(quarter), Integration::Arc)
                    })
                };
                let now = way(0, 48, start);
                let effective = way(48, sent.len(), now);
                let (side, turn) =
                    (std::f64::consts::PI * rng.either(), sensed.heading * rng.either().signum());
                let seen = Pose::new(
                    now.x + sensed.position * side.cos(),
                    now.y + sensed.position * side.sin(),
                    Angle::from_radians(now.heading.radians() + turn),
                );
                let found = state.predict(&model, seen);
                let position = (found.x - effective.x).hypot(found.y - effective.y);
                let heading = (found.heading - effective.heading).radians().abs();
                assert!(
                    position <= bound.position && heading <= bound.heading * (1.0 + 1e-9),
                    "{position} {heading} {bound:?}"
                );
                tightest = tightest.max(position / bound.position);
            }
        }
        assert!(tightest > 0.8, "the bound is far from every drive: {tightest}");
    }

    /// Each tick of the shipped modulator differs from the asked speeds by at most the stated error of a rim.
    #[test]
    fn pulses_stay_within_the_rim_error() {
        let mut rng = Rng(11);
        let none = MinSpeeds::none();
        for min in [
            MinSpeeds { wheel: 0.01, ..none },
            MinSpeeds { v: 0.02, ..none },
            MinSpeeds { omega: 0.1, ..none },
            MinSpeeds { v: 0.02, omega: 0.1, ..none },
            MinSpeeds { wheel: 0.03, v: 0.01, omega: 0.05 },
        ] {
            let model = ActuatorModel { min_speeds: min, ..ActuatorModel::ideal() };
            let bound = pulse_error(&min, &DRIVE, &LIMITS, PERIOD);
            let (mut state, mut largest) = (ActuatorState::new(), 0.0_f64);
            let (mut slow, mut asked) = (1.0, Twist::zero());
            for k in 0..100_000 {
                if k % 7 == 0 {
                    slow = if rng.part() < 0.3 { 1.0 } else { 0.1 };
                }
                if rng.part() < 0.7 {
                    asked = Twist::new(0.3 * slow * rng.either(), slow * rng.either());
                    asked = LIMITS.limit_speed(&DRIVE, asked);
                }
                let sent = state.execute(&model, &DRIVE, &LIMITS, asked, PERIOD);
                let off =
                    DRIVE.wheel_speeds_from_twist(Twist::new(sent.v - asked.v, sent.omega - asked.omega));
                largest = largest.max(off.max_abs());
            }
            assert!(largest <= bound * (1.0 + 1e-9), "{min:?}: {largest} > {bound}");
            assert!(largest > 0.4 * bound, "{min:?}: {largest} is far below {bound}");
        }
    }
}
