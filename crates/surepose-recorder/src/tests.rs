//! Tests with recordings of the simulated robot: complete, cut, and changed.

use std::path::PathBuf;

use surepose::geometry::{Angle, Pose};
use surepose::time::Stamp;
use surepose_config::Config;
use surepose_io::mcap::{McapCompression, McapWriter};
use surepose_sim::robot::{Scenario, wall_map_from_arena};
use surepose_sim::simulation::Simulation;

use crate::definitions::Topic;
use crate::event::RecordedReading;
use crate::replay::{BitReplay, replay};
use crate::{Event, EventInput, FlightRecorder, Session, event_cdr, read, session_cdr};

/// Folder of a test, removed at its end.
struct TestFolder(PathBuf);

impl TestFolder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("surepose-recorder-{name}-{}", std::process::id()));
        drop(std::fs::remove_dir_all(&path));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// Writes a recording of these events with a chunk per `per_chunk` events; returns it with the end of each chunk.
    fn write(
        &self,
        name: &str,
        session: &Session,
        events: &[Event],
        per_chunk: usize,
    ) -> (PathBuf, Vec<usize>) {
        let mut writer = McapWriter::new(McapCompression::Lz4);
        for topic in Topic::ALL {
            let schema = writer.add_schema(topic.kind(), &topic.definition());
            writer.add_channel(schema, topic.name());
        }
        writer.write(Topic::Session as u16, 0, &session_cdr::encoded(session));
        writer.end_chunk();
        let (mut bytes, mut ends) = (writer.take(), Vec::new());
        for chunk in events.chunks(per_chunk) {
            for event in chunk {
                writer.write(Topic::Event as u16, 0, &event_cdr::encoded(event));
            }
            writer.end_chunk();
            bytes.extend(writer.take());
            ends.push(bytes.len());
        }
        bytes.extend(writer.finished());
        let path = self.0.join(name);
        std::fs::write(&path, bytes).unwrap();
        (path, ends)
    }
}

impl Drop for TestFolder {
    fn drop(&mut self) {
        drop(std::fs::remove_dir_all(&self.0));
    }
}

/// Session and events of a drive in the paper's arena, through the recorder's files.
fn drive(folder: &TestFolder) -> (Session, Vec<Event>) {
    let scenario = Scenario::default();
    let mut simulation = Simulation::new(&scenario, 1);
    let session = Session::new(
        scenario.config.clone(),
        scenario.navigator_setup(),
        Some(wall_map_from_arena(&scenario.arena)),
        Stamp::default(),
        simulation.navigator().localizer().belief(),
    );
    let path = folder.0.join("drive");
    let recorder = FlightRecorder::create(&path, &session).unwrap();
    let handle = recorder.handle();
    handle.log(Stamp::default(), EventInput::SetGoal(scenario.goal()));
    while simulation.next_watched(|input, report| handle.log_simulated_step(input, report)).is_some() {}
    let summary = recorder.finish().unwrap();
    let keep = |kept: &mut (Session, Vec<Event>), event| kept.1.push(event);
    let (kept, recording) = read(&path, |session| (session, Vec::new()), keep).unwrap().unwrap();
    assert!(recording.is_complete && summary.dropped == 0);
    assert_eq!((summary.events, recording.events), (kept.1.len() as u64, kept.1.len() as u64));
    assert_eq!(kept.0.config, session.config);
    kept
}

fn same(config: Config) -> Config {
    config
}

#[test]
fn drive_replays_to_the_bit() {
    let folder = TestFolder::new("bit");
    let (_, events) = drive(&folder);
    let replayed = replay(&folder.0.join("drive"), None, same).unwrap().unwrap();
    assert!(replayed.bit_identical && replayed.complete, "{replayed:?}");
    // All events but the goal are steps; the robot drove.
    assert_eq!(replayed.steps + 1, events.len() as u64);
    assert!(
        replayed.steps > 100 && events.iter().any(|e| e.outcome.as_ref().is_some_and(|o| o.command[0] > 0.1))
    );
}

#[test]
fn existing_recording_is_not_overwritten() {
    let folder = TestFolder::new("twice");
    let (session, _) = drive(&folder);
    let path = folder.0.join("drive");
    let before = std::fs::metadata(path.join("surepose_0.mcap")).unwrap().len();
    assert!(FlightRecorder::create(&path, &session).is_err());
    assert_eq!(std::fs::metadata(path.join("surepose_0.mcap")).unwrap().len(), before);
}

#[test]
fn cut_recording_replays_every_complete_chunk() {
    let folder = TestFolder::new("cut");
    let (session, events) = drive(&folder);
    let (path, ends) = folder.write("whole.mcap", &session, &events, 7);
    let bytes = std::fs::read(&path).unwrap();
    let cut = folder.0.join("cut.mcap");
    let first = ends[0] as u64;
    let mut state = 23_u64;
    for _ in 0..50 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let at = (first + (state >> 33) % (*ends.last().unwrap() as u64 - first)) as usize;
        std::fs::write(&cut, &bytes[..at]).unwrap();
        let replayed = replay(&cut, None, same).unwrap().unwrap();
        let chunks = ends.iter().filter(|end| **end <= at).count();
        // The first event is the goal.
        let steps = (7 * chunks).min(events.len()) as u64 - 1;
        assert!(replayed.steps >= steps, "cut at {at}: {} steps, {steps} in complete chunks", replayed.steps);
        assert!(replayed.bit_identical && !replayed.complete, "cut at {at}: {replayed:?}");
    }
}

/// Replay of the drive against a recording with a change.
fn against(
    folder: &TestFolder,
    session: &Session,
    events: &[Event],
    change: impl FnOnce(&mut [Event]),
) -> BitReplay {
    let mut changed = events.to_vec();
    change(&mut changed);
    let (other, _) = folder.write("other.mcap", session, &changed, 50);
    replay(&folder.0.join("drive"), Some(&other), same).unwrap().unwrap()
}

fn readings(event: &mut Event) -> &mut Vec<surepose::time::Stamped<RecordedReading>> {
    match &mut event.input {
        EventInput::Step { readings, .. } => readings,
        other => panic!("not a step: {other:?}"),
    }
}

fn flipped(value: f64, bit: u32) -> f64 {
    f64::from_bits(value.to_bits() ^ (1 << bit))
}

#[test]
fn changed_recordings_are_named_at_the_first_step_that_differs() {
    let folder = TestFolder::new("against");
    let (session, events) = drive(&folder);
    let expect = |replayed: BitReplay, event: usize, field: &str| {
        let first = replayed.first_difference.expect("a difference");
        assert_eq!((first.event, first.step), (event as u64, event as u64), "{first:?}");
        assert!(first.field.starts_with(field), "expected {field}: {first:?}");
        assert!(!replayed.bit_identical && first.input.starts_with("step: travel"), "{first:?}");
    };
    for event in [1, 17, 60, 140] {
        // A stamp by a nanosecond.
        let stamp = |e: &mut Event| e.stamp = Stamp::from_nanoseconds(e.stamp.nanoseconds() + 1);
        expect(against(&folder, &session, &events, |all| stamp(&mut all[event])), event, "input.stamp");
        // The lowest bit of the odometry, of a heading and of a range.
        let travel = |e: &mut Event| match &mut e.input {
            EventInput::Step { odometry, .. } => odometry[1] = flipped(odometry[1], 0),
            other => panic!("not a step: {other:?}"),
        };
        expect(against(&folder, &session, &events, |all| travel(&mut all[event])), event, "input.values[1]");
        let heading = |e: &mut Event| match &mut readings(e)[0].value {
            RecordedReading::Heading([heading, _]) => *heading = flipped(*heading, 0),
            other => panic!("not a heading: {other:?}"),
        };
        expect(against(&folder, &session, &events, |all| heading(&mut all[event])), event, "input.heading");
        let range = |e: &mut Event| match &mut readings(e)[1].value {
            RecordedReading::Scan { ranges, .. } => ranges[90] = flipped(ranges[90], 0),
            other => panic!("not a scan: {other:?}"),
        };
        expect(
            against(&folder, &session, &events, |all| range(&mut all[event])),
            event,
            "input.scan.range[90]",
        );
        // A rounding of the outcome, as another version may have.
        let rounding = |e: &mut Event| {
            let outcome = e.outcome.as_mut().unwrap();
            outcome.belief[2] = flipped(outcome.belief[2], 0);
        };
        expect(against(&folder, &session, &events, |all| rounding(&mut all[event])), event, "belief.heading");
    }
}

#[test]
fn input_bit_of_the_recording_itself_is_named_where_it_takes_effect() {
    let folder = TestFolder::new("input");
    let (session, mut events) = drive(&folder);
    let EventInput::Step { odometry, .. } = &mut events[30].input else { panic!("not a step") };
    odometry[0] = flipped(odometry[0], 40);
    let (path, _) = folder.write("changed.mcap", &session, &events, 50);
    let first = replay(&path, None, same).unwrap().unwrap().first_difference.expect("a difference");
    assert_eq!((first.event, first.field.as_str()), (30, "belief.x"), "{first:?}");
}

#[test]
fn changed_settings_and_versions_are_named() {
    let folder = TestFolder::new("settings");
    let (mut session, mut events) = drive(&folder);
    let path = folder.0.join("drive");
    for option in ["law.k_v=2.5", "filter.delta=0.002"] {
        let configure = |config: Config| config.with_option(option).unwrap();
        let replayed = replay(&path, None, configure).unwrap().unwrap();
        let [setting] = replayed.configuration.as_slice() else { panic!("{replayed:?}") };
        assert_eq!(format!("{}={}", setting.key, setting.replayed), option);
        let first = replayed.first_difference.expect("a difference");
        assert!(first.step >= 1 && first.step < 10, "{first:?}");
    }
    session.version = "0.0.1".to_owned();
    let outcome = events[12].outcome.as_mut().unwrap();
    outcome.command[0] = flipped(outcome.command[0], 0);
    let (other, _) = folder.write("version.mcap", &session, &events, 50);
    let replayed = replay(&other, None, same).unwrap().unwrap();
    assert_eq!(replayed.recorded_version, "0.0.1");
    let first = replayed.first_difference.expect("a difference");
    assert_eq!((first.step, first.field.as_str()), (12, "command.v"), "{first:?}");
}

#[test]
fn dropped_events_are_named() {
    let folder = TestFolder::new("dropped");
    let (session, mut events) = drive(&folder);
    events.drain(20..23);
    let (path, _) = folder.write("dropped.mcap", &session, &events, 50);
    let first = replay(&path, None, same).unwrap().unwrap().first_difference.expect("a difference");
    assert_eq!((first.event, first.field.as_str()), (23, "dropped events"), "{first:?}");
    assert!(first.recorded.starts_with("3 events"), "{first:?}");
}

#[test]
fn calls_other_than_steps_are_written_and_read() {
    let belief =
        surepose::estimation::Belief::new(Pose::new(1.0, -2.0, Angle::from_radians(0.5)), [0.1, 0.2, 0.3]);
    let inputs = [
        EventInput::Start(None),
        EventInput::Start(Some(belief)),
        EventInput::SetBelief(belief),
        EventInput::MarkLost,
        EventInput::SetGoal(Pose::new(0.1, 0.2, Angle::from_radians(-3.0))),
        EventInput::CancelGoal,
        EventInput::AbortGoal,
        EventInput::OdometryTimeout,
    ];
    for (sequence, input) in inputs.into_iter().enumerate() {
        let event =
            Event { sequence: sequence as u64, stamp: Stamp::from_nanoseconds(-7), input, outcome: None };
        let bytes = event_cdr::encoded(&event);
        assert_eq!(event_cdr::decoded(&bytes), Some(event));
        for length in 0..bytes.len() {
            assert_eq!(event_cdr::decoded(&bytes[..length]), None);
        }
    }
}
