//! Describes an aborted goal, for all programs: the reason and the parameter to look at.

use surepose::estimation::DisagreeingSensor;
use surepose::navigator::AbortReason;
use surepose::safety::{MotionChannel, MotionFault};

/// Describes `reason` with its name, what happened, and the parameters that probably do not describe the robot.
pub fn describe_abort(reason: AbortReason) -> String {
    let what = match reason {
        AbortReason::Motion(MotionFault::Stalled(channel)) => {
            format!(": the base does not execute the commanded {}", describe_channel(channel))
        }
        AbortReason::Motion(MotionFault::Blocked(channel)) => {
            format!(
                ": the base does not execute the commanded {}, although it is large enough; something holds the base",
                describe_channel(channel)
            )
        }
        AbortReason::Disagreement(DisagreeingSensor::Compass) => {
            ": the compass disagrees with odometry and the other sensors".to_owned()
        }
        AbortReason::Disagreement(DisagreeingSensor::Laser) => {
            ": the laser disagrees with odometry, as with a wrong mounting or stamp".to_owned()
        }
        AbortReason::Disagreement(DisagreeingSensor::Map) => {
            ": walls that the laser measures disagree with the map".to_owned()
        }
        AbortReason::NoProgress => ": the robot drives but does not get closer to the goal".to_owned(),
        _ => String::new(),
    };
    let keys: Vec<_> = reason.suspects().iter().map(|key| format!("{}.{}", key.section, key.key)).collect();
    let remedy = match &keys[..] {
        [] => String::new(),
        keys => format!("; check {} (or measure with `surepose calibrate mcap`)", keys.join(", ")),
    };
    format!("{}{what}{remedy}", reason.name())
}

fn describe_channel(channel: MotionChannel) -> &'static str {
    match channel {
        MotionChannel::Turn => "turn rate",
        MotionChannel::Forward => "forward speed",
        MotionChannel::RightWheel => "speed of the right wheel",
        MotionChannel::LeftWheel => "speed of the left wheel",
    }
}

#[cfg(test)]
mod tests {
    use super::describe_abort;
    use surepose::navigator::AbortReason;
    use surepose::safety::{MotionChannel, MotionFault};

    #[test]
    fn a_stall_names_the_parameter() {
        let stalled = describe_abort(AbortReason::Motion(MotionFault::Stalled(MotionChannel::Turn)));
        assert!(stalled.starts_with("stalled: "), "{stalled}");
        assert!(stalled.contains("robot.min_turn_rate_deg_s"), "{stalled}");
        assert_eq!(describe_abort(AbortReason::ClockSetBack), "clock_set_back");
    }
}
