//! What the robot makes of a commanded velocity: MRCLAM records commands, not wheel ticks.

use surepose::kinematics::Twist;

/// The base's response to commands: nothing for a dead time, then a steady twist.
///
/// The defaults are the means of five least-squares fits to reference poses, one for each robot of data set 7; each
/// robot is followed as well with the mean of the other four's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// A command shows no effect for this long \[s]. The robots' fits: 0.16 to 0.20 s.
    pub dead_time: f64,
    /// Speed over commanded speed, straight on. The robots' fits: 1.04 to 1.06.
    pub speed_gain: f64,
    /// Turn rate over commanded turn rate. The robots' fits: 0.93 to 0.99.
    pub turn_gain: f64,
    /// Way lost for each radian turned while driving \[m]. The robots' fits: 0.090 to 0.108 m.
    ///
    /// Commanded (0.086 m/s, ±0.40 rad/s), all five robots settle at (0.050 m/s, ±0.39 rad/s): the inner wheel stands
    /// still, and nothing in the command says so.
    pub way_lost_per_radian: f64,
}

impl Default for Response {
    fn default() -> Self {
        Self { dead_time: 0.18, speed_gain: 1.05, turn_gain: 0.955, way_lost_per_radian: 0.096 }
    }
}

impl Response {
    /// The twist that a command ends up as.
    pub(super) fn twist(&self, command: Twist<f64>) -> Twist<f64> {
        let straight = self.speed_gain * command.v;
        let lost = self.way_lost_per_radian * command.omega.abs();
        // A turn slows the base down; it neither turns it round nor moves it where it stands.
        let speed = (straight.abs() - lost).max(0.0);
        Twist::new(speed.copysign(straight), self.turn_gain * command.omega)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The steady twists that the motion capture saw, mean of all robots.
    #[test]
    fn a_turn_costs_speed() {
        let response = Response::default();
        let straight = response.twist(Twist::new(0.067, 0.0));
        assert!((straight.v - 0.070).abs() < 0.002 && straight.omega.abs() < 1e-15, "{straight:?}");
        let turning = response.twist(Twist::new(0.086, -0.398));
        assert!((turning.v - 0.050).abs() < 0.003 && (turning.omega + 0.394).abs() < 0.015, "{turning:?}");
    }

    #[test]
    fn a_turn_on_the_spot_stays_there_and_reverse_mirrors_forward() {
        let response = Response::default();
        assert!(response.twist(Twist::new(0.0, 0.57)).v.abs() < 1e-15);
        assert!(response.twist(Twist::new(0.001, 0.57)).v.abs() < 1e-15);
        let (forward, back) = (Twist::new(0.086, 0.4), Twist::new(-0.086, 0.4));
        assert!((response.twist(forward).v + response.twist(back).v).abs() < 1e-15);
    }
}
