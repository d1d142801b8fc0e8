//! Drive wheel: motor with lag, friction, and ripple; encoder; PID speed controller.

use core::f64::consts::TAU;

use surepose::control::{Pid, PidState};

use crate::plant::WheelResponse;
use crate::random::Stream;

/// Parameters of a motor with its encoder and controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorModel {
    /// Whether a wheel follows its setpoint exactly; then only the encoder's resolution is used.
    pub ideal: bool,
    /// Wheel rate without load at full supply \[rad/s].
    pub full_rate: f64,
    /// Time constant of the first-order lag \[s].
    pub lag: f64,
    /// Wheel rate lost to dry friction \[rad/s]; a stopped wheel starts only above it.
    pub friction: f64,
    /// Standard deviation of the relative gain drift, from supply, temperature, and load.
    pub gain_std: f64,
    /// Correlation time of the gain drift \[s].
    pub gain_time: f64,
    /// Amplitude of the relative gain ripple over one turn of the wheel, from gears and brushes.
    pub cogging: f64,
    /// Encoder ticks per wheel turn.
    pub ticks_per_turn: f64,
    /// Gains of the speed controller.
    pub pid: Pid<f64>,
}

impl Default for MotorModel {
    /// A geared motor with an open-loop speed error of 10 %, which the PID reduces to the paper's ±5 %.
    ///
    /// # Departure
    /// [Tran2012] Sec. 5.2 gives only the ±5 %; lag, friction, and ripple are typical of geared motors.
    fn default() -> Self {
        Self {
            ideal: false,
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
    /// Creates the default motor, geared for wheel rates up to `max_speed` \[rad/s]; the default is geared
    /// for 6.
    ///
    /// At `max_speed` the speed error stays within ±5 %. At lower rates, cogging can be too fast for the
    /// controller of a motor geared much higher than the default: at 12 rad/s of 60 the error is 6 %.
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

/// State of one wheel.
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

    /// Encoder angle \[rad].
    pub(crate) fn counted(&self, model: &MotorModel) -> f64 {
        (self.angle * (model.ticks_per_turn / TAU)).floor() * (TAU / model.ticks_per_turn)
    }

    /// Controls the wheel to the setpoint for `period` \[s]; returns the true turn \[rad].
    pub(crate) fn turn(&mut self, model: &MotorModel, setpoint: WheelResponse, period: f64) -> f64 {
        if model.ideal {
            self.rate = setpoint.end;
            let turned = setpoint.mean * period;
            self.angle += turned;
            return turned;
        }
        let desired = setpoint.mean;
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

    /// Stops the wheel, as a stalled motor or an obstacle does.
    pub(crate) fn hold(&mut self) {
        self.rate = 0.0;
    }

    /// Integrates the rate toward `drive`, its steady state without friction \[rad/s]; returns the turn
    /// \[rad].
    fn coast(&mut self, model: &MotorModel, drive: f64, period: f64) -> f64 {
        // Friction opposes the motion or holds a stopped wheel.
        let direction = if self.rate == 0.0 { drive } else { self.rate };
        if self.rate == 0.0 && drive.abs() <= model.friction {
            return 0.0;
        }
        let settled = drive - model.friction.copysign(direction);
        let part = (-period / model.lag).exp();
        let after = settled + (self.rate - settled) * part;
        let turned = settled * period + (self.rate - settled) * model.lag * (1.0 - part);
        if after * direction < 0.0 && drive.abs() <= model.friction {
            // The wheel stops within the period: the turn ends where the rate crosses 0.
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

    use super::{MotorModel, Wheel, WheelResponse};

    const PERIOD: f64 = 0.01;

    fn at(rate: f64) -> WheelResponse {
        WheelResponse { mean: rate, end: rate }
    }

    /// Largest relative speed deviation from `desired`, over windows of 50 ms after 1 s of settling.
    fn ripple(model: &MotorModel, desired: f64) -> f64 {
        let mut wheel = Wheel::at_rest(Seed(4).stream("right wheel"));
        let mut worst = 0.0_f64;
        for window in 0..1200 {
            let turned: f64 = (0..5).map(|_| wheel.turn(model, at(desired), PERIOD)).sum();
            if window >= 20 {
                worst = worst.max((turned / (5.0 * PERIOD * desired) - 1.0).abs());
            }
        }
        worst
    }

    /// [Tran2012] Sec. 5.2: ±5 % at 0.3 m/s and 0.05 m/s with a wheel radius of 5 cm.
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
    fn geared_motor_reaches_its_maximum_speed() {
        for max_speed in [0.6, 6.0, 60.0] {
            let held = ripple(&MotorModel::for_max_speed(max_speed), max_speed);
            assert!(held < 0.05, "geared for {max_speed} rad/s: {held}");
        }
        let short = ripple(&MotorModel::default(), 20.0);
        assert!(short > 0.4, "default motor with a setpoint of 20 rad/s: {short}");
    }

    #[test]
    fn stopped_wheel_stays_stopped() {
        let model = MotorModel::default();
        let mut wheel = Wheel::at_rest(Seed(4).stream("left wheel"));
        for _ in 0..100 {
            wheel.turn(&model, at(-4.0), PERIOD);
        }
        assert!((wheel.rate() / -4.0 - 1.0).abs() < 0.1, "{}", wheel.rate());
        for _ in 0..100 {
            wheel.turn(&model, at(0.0), PERIOD);
        }
        for _ in 0..100 {
            assert_eq!(wheel.turn(&model, at(0.0), PERIOD).to_bits(), 0.0_f64.to_bits());
        }
    }

    #[test]
    fn motor_saturates_at_its_full_rate() {
        let model = MotorModel { gain_std: 0.0, cogging: 0.0, ..MotorModel::default() };
        let mut wheel = Wheel::at_rest(Seed(4).stream("left wheel"));
        for _ in 0..500 {
            wheel.turn(&model, at(50.0), PERIOD);
        }
        assert!((wheel.rate() - (model.full_rate - model.friction)).abs() < 1e-9, "{}", wheel.rate());
    }
}
