//! A drive wheel: its motor with lag, friction and ripple, its encoder, and the PID that holds its speed.

use core::f64::consts::TAU;

use surepose::control::{Pid, PidState};

use crate::random::Stream;

/// How a motor turns its wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorModel {
    /// Turn rate of the unloaded wheel at full supply \[rad/s].
    pub full_rate: f64,
    /// Time constant of the first-order lag \[s].
    pub lag: f64,
    /// Turn rate that dry friction costs \[rad/s]; below it a standing wheel does not break away.
    pub friction: f64,
    /// Standard deviation of the slow change of the motor's gain: supply, temperature, load.
    pub gain_std: f64,
    /// Correlation time of that change \[s].
    pub gain_time: f64,
    /// Amplitude of the gain's change over one turn of the wheel: gears, brushes.
    pub cogging: f64,
    /// Encoder ticks per turn of the wheel.
    pub ticks_per_turn: f64,
    /// The speed controller's gains.
    pub pid: Pid<f64>,
}

impl Default for MotorModel {
    /// A geared motor whose speed wanders by a tenth by itself and that the PID keeps within the paper's ±5 %.
    ///
    /// # Departure
    /// [Tran2012] Sec. 5.2 gives the ±5 % only; lag, friction and ripple are those of ordinary geared motors.
    fn default() -> Self {
        Self {
            full_rate: 10.0,
            lag: 0.08,
            friction: 0.3,
            gain_std: 0.05,
            gain_time: 0.5,
            cogging: 0.05,
            ticks_per_turn: 20_000.0,
            pid: Pid {
                feed_forward: 0.1,
                proportional: 0.15,
                integral: 2.0,
                derivative: 0.0,
                tracking: 20.0,
            },
        }
    }
}

impl MotorModel {
    /// The default motor, geared for a robot whose wheels turn at `max_speed` \[rad/s] at the most, as the default one is for 6.
    ///
    /// At its fastest it keeps within ±5 %. Slower, cogging may come too fast for the controller of a motor that is geared for
    /// much more than the default one: at 12 rad/s of 60 it strays by 6 %.
    #[must_use]
    pub fn for_max_speed(max_speed: f64) -> Self {
        let Self { full_rate, friction, pid, .. } = Self::default();
        let gear = max_speed / 6.0;
        let pid = Pid {
            feed_forward: pid.feed_forward / gear,
            proportional: pid.proportional / gear,
            integral: pid.integral / gear,
            derivative: pid.derivative / gear,
            ..pid
        };
        Self { full_rate: full_rate * gear, friction: friction * gear, pid, ..Self::default() }
    }
}

/// One wheel as it is now.
#[derive(Clone, Debug)]
pub(crate) struct Wheel {
    rate: f64,
    angle: f64,
    gain: f64,
    counted_before: f64,
    control: PidState<f64>,
    noise: Stream,
}

impl Wheel {
    pub(crate) fn at_rest(noise: Stream) -> Self {
        Self { rate: 0.0, angle: 0.0, gain: 0.0, counted_before: 0.0, control: PidState::zero(), noise }
    }

    /// True turn rate \[rad/s].
    pub(crate) fn rate(&self) -> f64 {
        self.rate
    }

    /// What the encoder has counted \[rad].
    pub(crate) fn counted(&self, model: &MotorModel) -> f64 {
        (self.angle * (model.ticks_per_turn / TAU)).floor() * (TAU / model.ticks_per_turn)
    }

    /// Controls the wheel towards the turn rate `desired` for `period` \[s]; returns how far it truly turned \[rad].
    pub(crate) fn turn(&mut self, model: &MotorModel, desired: f64, period: f64) -> f64 {
        let counted = self.counted(model);
        let measured = (counted - self.counted_before) / period;
        self.counted_before = counted;
        let (duty, control) = model.pid.step(self.control, desired, measured, period);
        self.control = control;

        let keep = (-period / model.gain_time).exp();
        self.gain = self.gain * keep + model.gain_std * (1.0 - keep * keep).sqrt() * self.noise.normal();
        let ripple = 1.0 + self.gain + model.cogging * self.angle.sin();
        let turned = self.coast(model, model.full_rate * duty * ripple, period);
        self.angle += turned;
        turned
    }

    /// Lets the rate follow `drive`, where it would settle without friction; returns the angle turned.
    fn coast(&mut self, model: &MotorModel, drive: f64, period: f64) -> f64 {
        // Friction works against the motion, or holds a standing wheel.
        let direction = if self.rate == 0.0 { drive } else { self.rate };
        if self.rate == 0.0 && drive.abs() <= model.friction {
            return 0.0;
        }
        let settled = drive - model.friction.copysign(direction);
        let part = (-period / model.lag).exp();
        let after = settled + (self.rate - settled) * part;
        let turned = settled * period + (self.rate - settled) * model.lag * (1.0 - part);
        if after * direction < 0.0 && drive.abs() <= model.friction {
            // It comes to rest on the way: how far it still turns is where the rate passes 0.
            let moving = model.lag * ((self.rate - settled) / -settled).ln();
            let turned = settled * moving + self.rate * model.lag;
            self.rate = 0.0;
            return turned;
        }
        self.rate = after;
        turned
    }
}

#[cfg(test)]
mod tests {
    use surepose::control::Pid;

    use crate::random::Seed;

    use super::{MotorModel, Wheel};

    const PERIOD: f64 = 0.01;

    /// The largest relative deviation of the speed from `desired`, measured over 50 ms after 1 s of settling.
    fn ripple(model: &MotorModel, desired: f64) -> f64 {
        let mut wheel = Wheel::at_rest(Seed(4).stream("right wheel"));
        let mut worst = 0.0_f64;
        for window in 0..1200 {
            let turned: f64 = (0..5).map(|_| wheel.turn(model, desired, PERIOD)).sum();
            if window >= 20 {
                worst = worst.max((turned / (5.0 * PERIOD * desired) - 1.0).abs());
            }
        }
        worst
    }

    /// [Tran2012] Sec. 5.2: ±5 %, at its speeds of 0.3 m/s and 0.05 m/s on a wheel of 5 cm radius.
    #[test]
    fn pid_keeps_the_speed_within_five_percent_and_open_loop_does_not() {
        let model = MotorModel::default();
        let open_loop = Pid { proportional: 0.0, integral: 0.0, ..model.pid };
        for desired in [6.0, 1.0] {
            let held = ripple(&model, desired);
            let wild = ripple(&MotorModel { pid: open_loop, ..model }, desired);
            assert!(held < 0.05, "{desired} rad/s: {held}");
            assert!(wild > 0.10, "{desired} rad/s: {wild}");
        }
    }

    #[test]
    fn a_geared_motor_reaches_what_it_is_geared_for() {
        for max_speed in [0.6, 6.0, 60.0] {
            let held = ripple(&MotorModel::for_max_speed(max_speed), max_speed);
            assert!(held < 0.05, "geared for {max_speed} rad/s: {held}");
        }
        let short = ripple(&MotorModel::default(), 20.0);
        assert!(short > 0.4, "the default motor, told to turn at 20 rad/s: {short}");
    }

    #[test]
    fn stopped_wheel_stands_still_for_good() {
        let model = MotorModel::default();
        let mut wheel = Wheel::at_rest(Seed(4).stream("left wheel"));
        for _ in 0..100 {
            wheel.turn(&model, -4.0, PERIOD);
        }
        assert!((wheel.rate() / -4.0 - 1.0).abs() < 0.1, "{}", wheel.rate());
        for _ in 0..100 {
            wheel.turn(&model, 0.0, PERIOD);
        }
        for _ in 0..100 {
            assert_eq!(wheel.turn(&model, 0.0, PERIOD).to_bits(), 0.0_f64.to_bits());
        }
    }

    #[test]
    fn motor_saturates_at_its_full_rate() {
        let model = MotorModel { gain_std: 0.0, cogging: 0.0, ..MotorModel::default() };
        let mut wheel = Wheel::at_rest(Seed(4).stream("left wheel"));
        for _ in 0..500 {
            wheel.turn(&model, 50.0, PERIOD);
        }
        assert!((wheel.rate() - (model.full_rate - model.friction)).abs() < 1e-9, "{}", wheel.rate());
    }
}
