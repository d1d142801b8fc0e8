//! Describes the input of an event in one line.

use crate::event::{Event, EventInput, RecordedReading};

/// The call and its inputs, for example `step: travel 0.0021, 0.0019 m; heading 0.31 rad at 2.4 s`.
pub(super) fn description(event: &Event) -> String {
    let call = event.input.name();
    match &event.input {
        EventInput::Step { odometry, readings } => {
            let odometry = match odometry.as_slice() {
                [right, left, ..] => format!("travel {right}, {left} m"),
                _ => "no odometry".to_owned(),
            };
            let readings = readings.iter().map(|at| {
                let time = at.stamp.seconds();
                match &at.value {
                    RecordedReading::YawRate(rate) => format!("; yaw rate {rate} rad/s at {time} s"),
                    RecordedReading::Heading([heading, _]) => format!("; heading {heading} rad at {time} s"),
                    RecordedReading::Scan { ranges, .. } => {
                        format!("; scan of {} beams at {time} s", ranges.len())
                    }
                    RecordedReading::Other => format!("; measurement that is not recorded at {time} s"),
                }
            });
            format!("{call}: {odometry}{}", readings.collect::<String>())
        }
        EventInput::SetGoal(goal) => {
            format!("{call}: {} m, {} m, {} rad", goal.x, goal.y, goal.heading.radians())
        }
        _ => call.to_owned(),
    }
}
