//! Events in CDR, as `surepose_msgs/msg/Event`.

use surepose::geometry::{Angle, Pose};
use surepose::time::{Stamp, Stamped};

use crate::cdr::{CdrReader, CdrWriter};
use crate::event::{Event, EventInput, RecordedReading, StepOutcome, belief_of, numbers_of};

/// Encodes an event.
pub(crate) fn encoded(event: &Event) -> Vec<u8> {
    let mut cdr = CdrWriter::new();
    cdr.u64(event.sequence);
    cdr.i64(event.stamp.nanoseconds());
    cdr.text(event.input.name());
    cdr.sequence(&values_of(&event.input));
    let readings: &[_] = match &event.input {
        EventInput::Step { readings, .. } => readings,
        _ => &[],
    };
    cdr.u32(readings.len() as u32);
    for Stamped { stamp, value } in readings {
        cdr.i64(stamp.nanoseconds());
        cdr.text(value.name());
        let (values, ranges, bearings): (&[f64], &[f64], &[f64]) = match value {
            RecordedReading::YawRate(rate) => (std::slice::from_ref(rate), &[], &[]),
            RecordedReading::Heading(read) => (read, &[], &[]),
            RecordedReading::Scan { geometry, ranges, bearings } => (geometry, ranges, bearings),
            RecordedReading::Other => (&[], &[], &[]),
        };
        for numbers in [values, ranges, bearings] {
            cdr.sequence(numbers);
        }
    }
    let outcome = event.outcome.as_ref();
    let numbers = outcome.map(|o| [&o.belief[..], &o.covariance[..], &o.command[..], &o.navigation[..]]);
    for numbers in numbers.unwrap_or([&[]; 4]) {
        cdr.sequence(numbers);
    }
    let decision = outcome.map_or(&[][..], |outcome| &outcome.decision[..]);
    cdr.u32(decision.len() as u32);
    for text in decision {
        cdr.text(text);
    }
    cdr.finished()
}

/// Decodes an event; `None` where the message is none.
pub(crate) fn decoded(message: &[u8]) -> Option<Event> {
    let mut cdr = CdrReader::new(message)?;
    let (sequence, stamp, name) = (cdr.u64()?, Stamp::from_nanoseconds(cdr.i64()?), cdr.text()?);
    let values = cdr.sequence()?;
    let readings = cdr.list(reading)?;
    let input = input_of(&name, values, readings)?;
    let [belief, covariance, command, navigation] =
        [cdr.sequence()?, cdr.sequence()?, cdr.sequence()?, cdr.sequence()?];
    let decision = cdr.list(CdrReader::text)?;
    let outcome = match (&input, decision.is_empty()) {
        (EventInput::Step { .. }, false) => Some(StepOutcome {
            belief: belief.try_into().ok()?,
            covariance: covariance.try_into().ok()?,
            command,
            navigation,
            decision: decision.try_into().ok()?,
        }),
        (EventInput::Step { .. }, true) | (_, false) => return None,
        (_, true) => None,
    };
    Some(Event { sequence, stamp, input, outcome })
}

/// Numbers of a call: a belief, a goal or the odometry.
fn values_of(input: &EventInput) -> Vec<f64> {
    match input {
        EventInput::Start(belief) => {
            belief.as_ref().map_or_else(Vec::new, |belief| numbers_of(belief).to_vec())
        }
        EventInput::SetBelief(belief) => numbers_of(belief).to_vec(),
        EventInput::SetGoal(goal) => vec![goal.x, goal.y, goal.heading.radians()],
        EventInput::Step { odometry, .. } => odometry.clone(),
        EventInput::MarkLost
        | EventInput::CancelGoal
        | EventInput::AbortGoal
        | EventInput::OdometryTimeout => Vec::new(),
    }
}

fn input_of(name: &str, values: Vec<f64>, readings: Vec<Stamped<RecordedReading>>) -> Option<EventInput> {
    let is_empty = values.is_empty();
    Some(match name {
        "start" if is_empty => EventInput::Start(None),
        "start" => EventInput::Start(Some(belief_of(values.try_into().ok()?))),
        "set_belief" => EventInput::SetBelief(belief_of(values.try_into().ok()?)),
        "mark_lost" => EventInput::MarkLost,
        "set_goal" => {
            let [x, y, heading] = values.try_into().ok()?;
            EventInput::SetGoal(Pose::new(x, y, Angle::from_radians_unchecked(heading)))
        }
        "cancel_goal" => EventInput::CancelGoal,
        "abort_goal" => EventInput::AbortGoal,
        "odometry_timeout" => EventInput::OdometryTimeout,
        "step" if [0, 2, 4].contains(&values.len()) => EventInput::Step { odometry: values, readings },
        _ => return None,
    })
}

fn reading(cdr: &mut CdrReader<'_>) -> Option<Stamped<RecordedReading>> {
    let (stamp, name) = (Stamp::from_nanoseconds(cdr.i64()?), cdr.text()?);
    let (values, ranges, bearings) = (cdr.sequence()?, cdr.sequence()?, cdr.sequence()?);
    let value = match name.as_str() {
        "yaw_rate" => RecordedReading::YawRate(*values.first()?),
        "heading" => RecordedReading::Heading(values.try_into().ok()?),
        "scan" if [3, 8].contains(&values.len()) => {
            RecordedReading::Scan { geometry: values, ranges, bearings }
        }
        "other" => RecordedReading::Other,
        _ => return None,
    };
    Some(Stamped::new(stamp, value))
}
