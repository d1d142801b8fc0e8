//! Base between command and motors: delay, dead bands, limits, first-order lag.

use std::collections::VecDeque;

use surepose::kinematics::{DiffDrive, Twist, WheelPair};
use surepose::time::Stamp;

/// Rim speed below which friction stops a wheel without a command \[m/s].
const REST_SPEED: f64 = 1e-5;

/// Factor on a dead band's edge: a command at the edge moves the robot, whatever its rounding.
const EDGE: f64 = 1.0 - 1e-9;

/// Parameters of a base between the commanded wheel rates and the motors.
///
/// The stages act in this order: command delay, dead band of the base, dead band of each wheel, speed limit,
/// acceleration limit, lag. [`PlantModel::default`] passes commands through unchanged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantModel {
    /// Time from a command to its effect \[s].
    pub command_delay: f64,
    /// Slower speeds are executed as 0 \[m/s]; the turn rate is unaffected. 0 disables it.
    pub min_speed: f64,
    /// Slower turn rates are executed as 0 \[rad/s]; the speed is unaffected. 0 disables it.
    pub min_turn_rate: f64,
    /// A wheel does not turn at a slower commanded rim speed \[m/s]. 0 disables it.
    pub min_wheel_speed: f64,
    /// Rim speed that starts a stopped wheel, at least `min_wheel_speed` \[m/s]. 0 means `min_wheel_speed`.
    pub breakaway_speed: f64,
    /// Maximum rim speed of a wheel \[m/s]; each wheel is limited separately. ∞ disables it.
    pub wheel_speed: f64,
    /// Maximum increase of a wheel's rim speed \[m/s²]. ∞ disables it.
    pub wheel_acceleration: f64,
    /// Maximum decrease of a wheel's rim speed \[m/s²]. ∞ disables it.
    pub wheel_deceleration: f64,
    /// Time constant of the first-order lag of the wheel speeds \[s]. 0 disables it.
    pub lag: f64,
}

impl Default for PlantModel {
    /// Passes commands through unchanged.
    fn default() -> Self {
        Self {
            command_delay: 0.0,
            min_speed: 0.0,
            min_turn_rate: 0.0,
            min_wheel_speed: 0.0,
            breakaway_speed: 0.0,
            wheel_speed: f64::INFINITY,
            wheel_acceleration: f64::INFINITY,
            wheel_deceleration: f64::INFINITY,
            lag: 0.0,
        }
    }
}

impl PlantModel {
    /// Whether commands take effect unchanged, though perhaps late.
    fn is_exact(&self) -> bool {
        Self { command_delay: 0.0, ..*self } == Self::default()
    }

    /// Executes twists in the dead band of the base as 0, speed and turn rate separately.
    fn base_dead_band(&self, twist: Twist<f64>) -> Twist<f64> {
        let executed = |value: f64, least: f64| if value.abs() < least * EDGE { 0.0 } else { value };
        Twist::new(executed(twist.v, self.min_speed), executed(twist.omega, self.min_turn_rate))
    }

    /// Rim speed that a wheel's controller follows, after one of `previous` \[m/s].
    fn target(&self, command: f64, previous: f64) -> f64 {
        let turns_on = previous * command > 0.0;
        let least =
            if turns_on { self.min_wheel_speed } else { self.min_wheel_speed.max(self.breakaway_speed) };
        if command.abs() < least * EDGE {
            return 0.0;
        }
        command.clamp(-self.wheel_speed, self.wheel_speed)
    }
}

/// Wheel rate over one period.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelResponse {
    /// Mean rate \[rad/s]: the turn over the period.
    pub mean: f64,
    /// Rate at the end of the period \[rad/s].
    pub end: f64,
}

/// State of a base: commands in transit and wheel speeds.
#[derive(Clone, Debug, Default)]
pub struct Plant {
    in_transit: VecDeque<(Stamp, WheelPair<f64>)>,
    command: WheelPair<f64>,
    right: WheelFollower,
    left: WheelFollower,
}

impl Plant {
    /// Sends the commanded wheel rates \[rad/s] at time `now`; a repeated command is not stored.
    pub fn send(&mut self, model: &PlantModel, now: Stamp, rates: WheelPair<f64>) {
        let newest = self.in_transit.back().map_or(self.command, |(_, newest)| *newest);
        if newest != rates {
            self.in_transit.push_back((now.after(model.command_delay.max(0.0)), rates));
        }
    }

    /// Follows the commands for `period` \[s] from `now`.
    ///
    /// A command takes effect at the first call at or after its time, as a wheel controller reads its setpoint
    /// once per tick.
    pub fn advance(
        &mut self,
        model: &PlantModel,
        drive: &DiffDrive<f64>,
        now: Stamp,
        period: f64,
    ) -> WheelPair<WheelResponse> {
        while let Some((_, rates)) = self.in_transit.front().filter(|(at, _)| *at <= now) {
            self.command = *rates;
            self.in_transit.pop_front();
        }
        if model.is_exact() {
            let exact = |rate| WheelResponse { mean: rate, end: rate };
            return WheelPair { right: exact(self.command.right), left: exact(self.command.left) };
        }
        let mut rims = drive.wheel_travel_from_angle(self.command);
        if model.min_speed > 0.0 || model.min_turn_rate > 0.0 {
            let twist = drive.twist_from_wheel_speeds(rims);
            rims = drive.wheel_speeds_from_twist(model.base_dead_band(twist));
        }
        WheelPair {
            right: self.right.follow(model, rims.right, period).per_radius(drive.radius.right),
            left: self.left.follow(model, rims.left, period).per_radius(drive.radius.left),
        }
    }
}

impl WheelResponse {
    /// Converts rim speeds \[m/s] to wheel rates \[rad/s].
    fn per_radius(self, radius: f64) -> Self {
        Self { mean: self.mean / radius, end: self.end / radius }
    }
}

/// Rim speeds of one wheel \[m/s]: after the dead band, after the acceleration limit, after the lag.
#[derive(Clone, Copy, Debug, Default)]
struct WheelFollower {
    target: f64,
    ramp: f64,
    speed: f64,
}

impl WheelFollower {
    /// Follows the rim speed `command` \[m/s] for `period` \[s]; the response is in rim speeds \[m/s].
    fn follow(&mut self, model: &PlantModel, command: f64, period: f64) -> WheelResponse {
        self.target = model.target(command, self.target);
        let (mut remaining, mut travel) = (period, 0.0);
        while remaining > 0.0 {
            let (next, time) = self.next_corner(model, remaining);
            travel += self.lag_behind(model.lag, next, time);
            self.ramp = next;
            remaining -= time;
        }
        if self.target == 0.0 && self.ramp == 0.0 && self.speed.abs() < REST_SPEED {
            self.speed = 0.0;
        }
        WheelResponse { mean: travel / period, end: self.speed }
    }

    /// End of the next straight piece of the ramp toward the target, and its duration, at most `remaining` \[s].
    fn next_corner(&self, model: &PlantModel, remaining: f64) -> (f64, f64) {
        let change = self.target - self.ramp;
        if change == 0.0 {
            return (self.ramp, remaining);
        }
        let brakes = self.ramp * change < 0.0;
        let corner = if brakes && self.ramp * self.target < 0.0 { 0.0 } else { self.target };
        let rate = if brakes { model.wheel_deceleration } else { model.wheel_acceleration };
        let time = (corner - self.ramp).abs() / rate;
        if time <= remaining {
            (corner, time)
        } else {
            (self.ramp + rate.copysign(change) * remaining, remaining)
        }
    }

    /// Lags behind the ramp that reaches `end` after `time` \[s], by the closed form; returns the travel \[m].
    fn lag_behind(&mut self, lag: f64, end: f64, time: f64) -> f64 {
        if time <= 0.0 {
            // Without a limit the ramp jumps; a wheel without lag jumps with it.
            self.speed = if lag > 0.0 { self.speed } else { end };
            return 0.0;
        }
        if lag <= 0.0 {
            let travel = 0.5 * (self.ramp + end) * time;
            self.speed = end;
            return travel;
        }
        // u = a + b·t gives y = u − b·τ + c·exp(−t/τ) with c = y(0) − a + b·τ.
        let slope = (end - self.ramp) / time;
        let decay = (-time / lag).exp();
        let offset = self.speed - self.ramp + slope * lag;
        self.speed = end - slope * lag + offset * decay;
        (0.5 * (self.ramp + end) - slope * lag) * time + offset * lag * (1.0 - decay)
    }
}

#[cfg(test)]
mod tests;
