//! Response of the base to commanded velocities; MRCLAM records commands, not wheel ticks.

use surepose::kinematics::Twist;

/// Response of the base to commands: a dead time, then a steady twist.
///
/// The defaults are the means of five least-squares fits to reference poses, one for each robot of data set
/// 7. Replacing a robot's fit by the mean of the other four does not increase its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Time before a command takes effect \[s]. Fits of the robots: 0.16 to 0.20 s.
    pub dead_time: f64,
    /// Speed over commanded speed in straight motion. Fits of the robots: 1.04 to 1.06.
    pub speed_gain: f64,
    /// Turn rate over commanded turn rate. Fits of the robots: 0.93 to 0.99.
    pub turn_gain: f64,
    /// Distance lost per radian turned while driving \[m]. Fits of the robots: 0.090 to 0.108 m.
    ///
    /// Commanded (0.086 m/s, ±0.40 rad/s), all five robots settle at (0.050 m/s, ±0.39 rad/s): the inner
    /// wheel stands still, which the command does not indicate.
    pub way_lost_per_radian: f64,
}

impl Default for Response {
    fn default() -> Self {
        Self { dead_time: 0.18, speed_gain: 1.05, turn_gain: 0.955, way_lost_per_radian: 0.096 }
    }
}

impl Response {
    /// Returns the steady twist that a command results in.
    pub(super) fn twist(&self, command: Twist<f64>) -> Twist<f64> {
        let straight = self.speed_gain * command.v;
        let lost = self.way_lost_per_radian * command.omega.abs();
        // A turn reduces the speed; it never reverses it and never moves a robot that turns in place.
        let speed = (straight.abs() - lost).max(0.0);
        Twist::new(speed.copysign(straight), self.turn_gain * command.omega)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steady twists from motion capture, mean of all robots.
    #[test]
    fn turning_reduces_the_speed() {
        let response = Response::default();
        let straight = response.twist(Twist::new(0.067, 0.0));
        assert!((straight.v - 0.070).abs() < 0.002 && straight.omega.abs() < 1e-15, "{straight:?}");
        let turning = response.twist(Twist::new(0.086, -0.398));
        assert!((turning.v - 0.050).abs() < 0.003 && (turning.omega + 0.394).abs() < 0.015, "{turning:?}");
    }

    #[test]
    fn turns_in_place_do_not_translate_and_reverse_mirrors_forward() {
        let response = Response::default();
        assert!(response.twist(Twist::new(0.0, 0.57)).v.abs() < 1e-15);
        assert!(response.twist(Twist::new(0.001, 0.57)).v.abs() < 1e-15);
        let (forward, back) = (Twist::new(0.086, 0.4), Twist::new(-0.086, 0.4));
        assert!((response.twist(forward).v + response.twist(back).v).abs() < 1e-15);
    }
}
