//! Compares events and outcomes to the last bit.

use surepose::time::Stamped;

use crate::event::{Event, EventInput, RecordedReading, StepOutcome, numbers_of};

/// Field that differs, and its value in the recording and in the replay.
pub(super) type FieldDifference = (String, String, String);

/// Components of a belief.
const BELIEF: [&str; 9] = ["x", "y", "heading", "u01", "u02", "u12", "d0", "d1", "d2"];
const COVARIANCE: [&str; 6] = ["xx", "xy", "xt", "yy", "yt", "tt"];
const COMMAND: [&str; 4] = ["v", "omega", "wheel_right", "wheel_left"];
const NAVIGATION: [&str; 3] = ["rho", "alpha", "phi"];
const DECISION: [&str; 5] = ["health", "action", "disagreement", "blocked_by", "result"];

/// First field of the outcome that differs.
pub(super) fn first_difference(recorded: &StepOutcome, replayed: &StepOutcome) -> Option<FieldDifference> {
    numbers("belief", &BELIEF, &recorded.belief, &replayed.belief)
        .or_else(|| numbers("covariance", &COVARIANCE, &recorded.covariance, &replayed.covariance))
        .or_else(|| numbers("command", &COMMAND, &recorded.command, &replayed.command))
        .or_else(|| numbers("navigation", &NAVIGATION, &recorded.navigation, &replayed.navigation))
        .or_else(|| {
            let pairs = recorded.decision.iter().zip(&replayed.decision).zip(DECISION);
            let ((a, b), name) = pairs.into_iter().find(|((a, b), _)| a != b)?;
            Some((format!("decision.{name}"), a.clone(), b.clone()))
        })
}

/// First field of the input that differs.
pub(super) fn input_difference(recorded: &Event, replayed: &Event) -> Option<FieldDifference> {
    let text = |field: &str, a: String, b: String| (a != b).then(|| (format!("input.{field}"), a, b));
    let nanoseconds = |event: &Event| format!("{} ns", event.stamp.nanoseconds());
    text("call", recorded.input.name().to_owned(), replayed.input.name().to_owned())
        .or_else(|| text("stamp", nanoseconds(recorded), nanoseconds(replayed)))
        .or_else(|| {
            let (a, b) = (numbers_in(&recorded.input), numbers_in(&replayed.input));
            numbers("input.values", &[], &a, &b)
        })
        .or_else(|| {
            let (a, b) = (readings_in(&recorded.input), readings_in(&replayed.input));
            let count = |of: &[_]| of.len().to_string();
            let first = a.iter().zip(b).find_map(|(a, b)| reading_difference(a, b));
            first.or_else(|| text("readings", count(a), count(b)))
        })
}

fn reading_difference(
    recorded: &Stamped<RecordedReading>,
    replayed: &Stamped<RecordedReading>,
) -> Option<FieldDifference> {
    let (a, b) = (&recorded.value, &replayed.value);
    let name = format!("input.{}", a.name());
    if a.name() != b.name() {
        return Some(("input.sensor".to_owned(), a.name().to_owned(), b.name().to_owned()));
    }
    if recorded.stamp != replayed.stamp {
        let [a, b] = [recorded.stamp, replayed.stamp].map(|stamp| format!("{} ns", stamp.nanoseconds()));
        return Some((format!("{name}.stamp"), a, b));
    }
    match (a, b) {
        (RecordedReading::YawRate(a), RecordedReading::YawRate(b)) => numbers(&name, &[], &[*a], &[*b]),
        (RecordedReading::Heading(a), RecordedReading::Heading(b)) => {
            numbers(&name, &["heading", "std"], a, b)
        }
        (
            RecordedReading::Scan { geometry: a, ranges: ra, bearings: ba },
            RecordedReading::Scan { geometry: b, ranges: rb, bearings: bb },
        ) => numbers(&format!("{name}.geometry"), &[], a, b)
            .or_else(|| numbers(&format!("{name}.range"), &[], ra, rb))
            .or_else(|| numbers(&format!("{name}.bearing"), &[], ba, bb)),
        _ => None,
    }
}

fn numbers_in(input: &EventInput) -> Vec<f64> {
    match input {
        EventInput::Start(Some(belief)) | EventInput::SetBelief(belief) => numbers_of(belief).to_vec(),
        EventInput::SetGoal(goal) => vec![goal.x, goal.y, goal.heading.radians()],
        EventInput::Step { odometry, .. } => odometry.clone(),
        _ => Vec::new(),
    }
}

fn readings_in(input: &EventInput) -> &[Stamped<RecordedReading>] {
    match input {
        EventInput::Step { readings, .. } => readings,
        _ => &[],
    }
}

/// First number that differs by a bit. A NaN equals a NaN of the same bits.
fn numbers(field: &str, names: &[&str], recorded: &[f64], replayed: &[f64]) -> Option<FieldDifference> {
    if recorded.len() != replayed.len() {
        let said = |of: &[f64]| if of.is_empty() { "none".to_owned() } else { format!("{of:?}") };
        return Some((field.to_owned(), said(recorded), said(replayed)));
    }
    let place = recorded.iter().zip(replayed).position(|(a, b)| a.to_bits() != b.to_bits())?;
    let name = names.get(place).map_or_else(|| format!("{field}[{place}]"), |name| format!("{field}.{name}"));
    let said = |number: f64| format!("{number:?} ({:016x})", number.to_bits());
    Some((name, said(recorded[place]), said(replayed[place])))
}
