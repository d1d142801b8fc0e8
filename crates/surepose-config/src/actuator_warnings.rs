//! Warnings about actuators, gains and a period that do not go together.

use surepose::control::MAX_PENDING;
use surepose::param::{self, Parameter};

use super::Config;

/// A minimum speed as the rim speeds at which it matters \[m/s], and the motion of one period at it.
struct MinimumSpeed {
    parameter: &'static Parameter,
    /// Rim speed for driving and for turning; 0 where it does not apply.
    drive: f64,
    turn: f64,
    /// Motion in one pulse \[m], \[rad].
    step: f64,
    step_turn: f64,
}

impl Config {
    /// Warns about minimum speeds that make the base stall, or whose pulses exceed the tolerance.
    pub(super) fn actuator_warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        for minimum in self.minimum_speeds() {
            let MinimumSpeed { parameter, step, step_turn, .. } = minimum;
            let name = format!("{}.{}", parameter.section, parameter.key);
            let position = self.number(&param::POSITION_TOLERANCE);
            let heading = self.number(&param::HEADING_TOLERANCE);
            let remedy = "widen the tolerance, or shorten loop.period_s where a pulse is one period";
            if step > position {
                warnings.push(format!(
                    "{name}: one pulse at this speed moves {:.1} mm, more than goal.position_tolerance_m ({:.1} mm); the robot may not \
                     come to rest at the goal; {remedy}",
                    1e3 * step,
                    1e3 * position
                ));
            }
            if step_turn > heading {
                warnings.push(format!(
                    "{name}: one pulse at this speed turns {:.2}°, more than goal.heading_tolerance_deg ({:.2}°); the robot may not come \
                     to rest at the goal; {remedy}",
                    step_turn.to_degrees(),
                    heading.to_degrees()
                ));
            }
        }
        let (delay, period) = (self.number(&param::COMMAND_DELAY), self.number(&param::PERIOD));
        if delay > MAX_PENDING as f64 * period {
            warnings.push(format!(
                "robot.command_delay_s: longer than {MAX_PENDING} periods (got {delay} s, period {period} s); only the last {MAX_PENDING} \
                 commands are predicted; lengthen loop.period_s"
            ));
        }
        warnings
    }

    /// Warns about minimum speeds at which this robot, which is not configured for them, stalls: of `truth`, the base itself.
    pub fn stall_warnings(&self, truth: &Self) -> Vec<String> {
        let Some(onset) = self.controller().stall_onset() else { return Vec::new() };
        let stalls = |minimum: &MinimumSpeed| {
            let own = self.number(minimum.parameter);
            let knows = own >= truth.number(minimum.parameter);
            !knows && (minimum.drive > onset.drive || minimum.turn > onset.turn)
        };
        let named = truth.minimum_speeds().into_iter().filter(stalls).map(|minimum| {
            let parameter = minimum.parameter;
            format!(
                "{section}.{key}: the base ignores slower commands and the robot is not configured for it; it stalls, because these gains \
                 command {:.1} mm/s on the way to the goal and {:.1} mm/s at a rim to trim the heading; use `--set {section}.{key}=…`",
                1e3 * onset.drive,
                1e3 * onset.turn,
                section = parameter.section,
                key = parameter.key,
            )
        });
        named.collect()
    }

    /// The minimum speeds that are set.
    fn minimum_speeds(&self) -> Vec<MinimumSpeed> {
        let (drive, period) = (self.drive(), self.number(&param::PERIOD));
        let half = 0.5 * drive.wheel_separation;
        let ticks = self.actuator().min_speeds.pulse_ticks(&drive, &self.limits(), period);
        let minimum = |parameter: &'static Parameter, drive: f64, turn: f64, ticks: u16| MinimumSpeed {
            parameter,
            drive,
            turn,
            step: drive * period * f64::from(ticks),
            step_turn: turn / half * period * f64::from(ticks),
        };
        let (wheel, v, omega) = (
            self.number(&param::MIN_WHEEL_SPEED),
            self.number(&param::MIN_SPEED),
            self.number(&param::MIN_TURN_RATE),
        );
        let all = [
            minimum(&param::MIN_WHEEL_SPEED, wheel, wheel, ticks.wheel),
            minimum(&param::MIN_SPEED, v, 0.0, ticks.v),
            minimum(&param::MIN_TURN_RATE, 0.0, omega * half, ticks.omega),
        ];
        all.into_iter().filter(|minimum| minimum.drive > 0.0 || minimum.turn > 0.0).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::Config;

    fn config(options: &[&str]) -> Config {
        options.iter().fold(Config::default(), |config, option| config.with_option(option).unwrap())
    }

    #[test]
    fn a_period_that_cannot_resolve_the_tolerance_is_named() {
        let coarse = config(&["robot.min_speed_m_s=0.03", "loop.period_s=0.5"]).warnings();
        assert!(coarse.iter().any(|said| said.starts_with("robot.min_speed_m_s: one pulse")), "{coarse:?}");
        let turning = config(&["robot.min_turn_rate_deg_s=12", "loop.period_s=0.1"]).warnings();
        assert!(turning.iter().any(|said| said.contains("goal.heading_tolerance_deg")), "{turning:?}");
        assert_eq!(config(&["robot.min_speed_m_s=0.02"]).warnings(), Vec::<String>::new());
    }

    #[test]
    fn a_base_that_stalls_is_named_unless_the_robot_knows() {
        let truth = config(&["robot.min_wheel_speed_m_s=0.03"]);
        assert!(Config::default().stall_warnings(&truth)[0].contains("--set robot.min_wheel_speed_m_s"));
        assert_eq!(truth.stall_warnings(&truth), Vec::<String>::new());
        let slow = config(&["robot.min_wheel_speed_m_s=0.001"]);
        assert_eq!(Config::default().stall_warnings(&slow), Vec::<String>::new());
    }
}
