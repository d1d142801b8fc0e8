//! Replays a recording through the navigator, and compares the outcomes bit by bit.

mod comparison;
mod description;

use std::path::Path;
use std::time::Instant;

use serde::Serialize;
use surepose::estimation::WheelOdometry;
use surepose::estimation::{HeadingMeasurement, Measurement};
use surepose::geometry::{Angle, Pose};
use surepose::kinematics::WheelPair;
use surepose::lidar::{LaserGeometry, Scan};
use surepose::localization::{Odometry, SensorInput, SensorReading};
use surepose::map::MapView;
use surepose::navigator::{AbortReason, StepReport};
use surepose::time::Stamped;
use surepose_config::{Config, RobotNavigator};
use surepose_io::owned_map::OwnedMap;

use crate::event::{Event, EventInput, RecordedReading, StepOutcome};
use crate::reading::{RecordingError, read};
use crate::session::{Session, VERSION, differences};

use comparison::{first_difference, input_difference};
use description::description;

/// Result of a replay.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BitReplay {
    /// Steps replayed.
    pub steps: u64,
    /// Whether every belief, command and decision is the same to the last bit.
    pub bit_identical: bool,
    /// First difference; `None` without one.
    pub first_difference: Option<FirstDifference>,
    /// Settings that differ from those of the recording; also `setup`, `map` and `start` of two recordings.
    pub configuration: Vec<SettingDifference>,
    /// Version of the program that recorded, and of this one.
    pub recorded_version: String,
    /// Version of this program.
    pub version: String,
    /// Whether the recording has its end; a power cut truncates it.
    pub complete: bool,
    /// Duration of the recording \[s].
    pub duration_s: f64,
    /// Computing time \[s].
    pub wall_s: f64,
}

/// First difference of a replay.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FirstDifference {
    /// Number of the step, from 1.
    pub step: u64,
    /// Number of the event, from 0.
    pub event: u64,
    /// Time of the step \[s].
    pub stamp_s: f64,
    /// Field that differs.
    pub field: String,
    /// Its value in the recording.
    pub recorded: String,
    /// Its value in the replay.
    pub replayed: String,
    /// The input of the step.
    pub input: String,
}

/// Setting that differs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SettingDifference {
    /// Name of the parameter.
    pub key: String,
    /// Value in the recording.
    pub recorded: String,
    /// Value of the replay.
    pub replayed: String,
}

/// Replays the recording at `path` with its configuration, changed by `configure`; compares with the recording itself, or with
/// the recording `against`, inputs and outcomes. `Ok(None)` stands for a recording of another program.
///
/// # Errors
/// [`RecordingError`].
pub fn replay(
    path: &Path,
    against: Option<&Path>,
    configure: impl FnOnce(Config) -> Config,
) -> Result<Option<BitReplay>, RecordingError> {
    let begun = Instant::now();
    let other = match against {
        Some(other) => {
            let keep = |kept: &mut (Session, Vec<Event>), event| kept.1.push(event);
            let kept = read(other, |session| (session, Vec::new()), keep)?;
            Some(kept.ok_or(RecordingError::NoSession)?.0)
        }
        None => None,
    };
    let (other_session, other_events) = other.unzip();
    let start = |recorded: Session| {
        let config = configure(recorded.config.clone());
        let session = Session { config, ..recorded.clone() };
        Replayer::new(other_session.as_ref().unwrap_or(&recorded), &session)
    };
    let mut expected = other_events.map(Vec::into_iter);
    let feed = |replayer: &mut Replayer, event: Event| match &mut expected {
        Some(others) => replayer.feed(&event, others.next().as_ref()),
        None => replayer.feed(&event, Some(&event)),
    };
    let Some((replayer, recording)) = read(path, start, feed)? else { return Ok(None) };
    let mut replay = replayer.replay;
    replay.complete = recording.is_complete;
    replay.bit_identical = replay.first_difference.is_none();
    replay.wall_s = begun.elapsed().as_secs_f64();
    Ok(Some(replay))
}

/// Navigator that is fed with events.
struct Replayer {
    navigator: Box<RobotNavigator>,
    map: OwnedMap,
    replay: BitReplay,
    first: Option<f64>,
    next: u64,
}

impl Replayer {
    fn new(recorded: &Session, session: &Session) -> Self {
        let (navigator, map) = session.navigator();
        let differences = differences(recorded, session).into_iter();
        let configuration =
            differences.map(|(key, recorded, replayed)| SettingDifference { key, recorded, replayed });
        let replay = BitReplay {
            steps: 0,
            bit_identical: false,
            first_difference: None,
            configuration: configuration.collect(),
            recorded_version: recorded.version.clone(),
            version: VERSION.to_owned(),
            complete: false,
            duration_s: 0.0,
            wall_s: 0.0,
        };
        Self { navigator, map, replay, first: None, next: 0 }
    }

    /// Feeds an event, and compares it with `expected`: `None` is beyond the end of the other recording.
    fn feed(&mut self, event: &Event, expected: Option<&Event>) {
        let replayed = self.apply(event);
        let seconds = event.stamp.seconds();
        if replayed.is_some() {
            self.replay.steps += 1;
            let first = *self.first.get_or_insert(seconds);
            self.replay.duration_s = seconds - first;
        }
        let dropped = event.sequence - self.next.min(event.sequence);
        self.next = event.sequence.saturating_add(1);
        if self.replay.first_difference.is_some() {
            return;
        }
        let difference = if dropped > 0 {
            let gap = format!("{dropped} events before event {} were dropped", event.sequence);
            Some(("dropped events".to_owned(), gap, "-".to_owned()))
        } else if let Some(expected) = expected {
            input_difference(expected, event)
                .or_else(|| first_difference(expected.outcome.as_ref()?, replayed.as_ref()?))
        } else {
            Some(("end of the recording".to_owned(), "ended".to_owned(), event.input.name().to_owned()))
        };
        self.replay.first_difference = difference.map(|(field, recorded, replayed)| FirstDifference {
            step: self.replay.steps,
            event: event.sequence,
            stamp_s: seconds,
            field,
            recorded,
            replayed,
            input: description(event),
        });
    }

    /// Calls the navigator as the event says; returns the outcome of a step.
    fn apply(&mut self, event: &Event) -> Option<StepOutcome> {
        let Self { navigator, map, .. } = self;
        match &event.input {
            EventInput::Start(belief) => navigator.start(event.stamp, *belief),
            EventInput::SetBelief(belief) => navigator.set_belief(Stamped::new(event.stamp, *belief)),
            EventInput::MarkLost => navigator.mark_lost(),
            // The refusal of a goal and the results of goals are repeated, too.
            EventInput::SetGoal(goal) => drop(navigator.set_goal(&map.view(), *goal)),
            EventInput::CancelGoal => drop(navigator.cancel_goal()),
            EventInput::AbortGoal => drop(navigator.abort_goal(AbortReason::NoProgress)),
            EventInput::OdometryTimeout => drop(navigator.on_odometry_timeout()),
            EventInput::Step { odometry, readings } => {
                let report = stepped(navigator, &map.view(), event, odometry, readings);
                return Some(StepOutcome::of(&report));
            }
        }
        None
    }
}

fn stepped(
    navigator: &mut RobotNavigator,
    map: &MapView<'_, f64>,
    event: &Event,
    odometry: &[f64],
    readings: &[Stamped<RecordedReading>],
) -> StepReport<f64> {
    let pair = |right: &f64, left: &f64| WheelPair::new(*right, *left);
    let odometry = match odometry {
        [right, left] => Odometry::WheelTravel(pair(right, left)),
        [right, left, vr, vl] => {
            Odometry::WithVariance(WheelOdometry { travel: pair(right, left), variance: pair(vr, vl) })
        }
        _ => Odometry::Missing,
    };
    let angle = Angle::from_radians_unchecked;
    let bearings: Vec<Vec<_>> = readings
        .iter()
        .map(|at| match &at.value {
            RecordedReading::Scan { bearings, .. } => bearings.iter().map(|b| angle(*b)).collect(),
            _ => Vec::new(),
        })
        .collect();
    let readings: Vec<_> = readings
        .iter()
        .zip(&bearings)
        .filter_map(|(at, bearings)| {
            let value = match &at.value {
                RecordedReading::YawRate(rate) => SensorReading::YawRate(*rate),
                RecordedReading::Heading([heading, std]) => {
                    let read = HeadingMeasurement { heading: angle(*heading), std: *std };
                    SensorReading::Measurement(Measurement::Heading(read))
                }
                RecordedReading::Scan { geometry, ranges, .. } => {
                    let [first, increment, time, laser @ ..] = geometry.as_slice() else { return None };
                    let mut scan = Scan::new(angle(*first), *increment, ranges).with_time_increment(*time);
                    scan.bearings = (!bearings.is_empty()).then_some(bearings);
                    if let [x, y, heading, range_min, range_max] = *laser {
                        let body_from_laser = Pose::new(x, y, angle(heading));
                        scan = scan.with_geometry(LaserGeometry { body_from_laser, range_min, range_max });
                    }
                    SensorReading::Scan(scan)
                }
                RecordedReading::Other => return None,
            };
            Some(Stamped::new(at.stamp, value))
        })
        .collect();
    navigator.step(map, &SensorInput { stamp: event.stamp, odometry, readings: &readings })
}
