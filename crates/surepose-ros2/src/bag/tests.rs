//! Tests with recordings of the simulated robot, and with invalid files.

mod recorder;

use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use recorder::{File, Recorder, Robot, recorded_by, round, winding, with_gap};
use surepose::geometry::Pose;
use surepose::kinematics::{DiffDrive, Twist};
use surepose::param::{self, Choice};
use surepose::time::Stamp;
use surepose_config::Config;
use surepose_mapping::calibrate::calibrate;
use surepose_replay::ReplayReport;
use surepose_sim::robot::Scenario;
use surepose_sim::{CancelToken, SimulatedScan};

use crate::driver::NodeDriverSettings;
use crate::message::Quaternion;
use crate::names::Names;
use crate::robot::messages;

use super::*;

/// Settings of a robot whose start is from the truth.
fn settings() -> NodeDriverSettings {
    NodeDriverSettings { start: None, ..NodeDriverSettings::in_scenario(&Scenario::default()) }
}

fn replay(path: &Path, settings: &NodeDriverSettings, names: &Names) -> Result<ReplayReport, BagError> {
    super::replay(path, settings, names, |_| ())
}

#[test]
fn replay_is_evaluated_against_the_truth() {
    let file = File::new("round", &round(30.0, "/base/odom").finished());
    let names = Names::default();
    let report = replay(&file.0, &settings(), &names).unwrap();
    assert_eq!(report.steps, 600);
    assert!((report.duration_s - 29.95).abs() < 1e-6 && report.distance_m > 5.0);
    assert!(report.position_rmse_m.unwrap() < 0.005, "{report:?}");
    assert!(report.heading_rmse_deg.unwrap() < 0.1, "{report:?}");
    assert!((2.0..4.5).contains(&report.nees_mean.unwrap()), "{report:?}");
    assert!(report.dead_reckoning_position_rmse_m.unwrap() > 0.01, "{report:?}");
    assert!(report.accepted > 500 && report.skipped.is_empty(), "{report:?}");

    assert_eq!(report.found_s, None, "the robot was never lost");

    // Without a map and a compass the driver uses odometry alone.
    let blind = NodeDriverSettings { map: None, compass: false, ..settings() };
    let report = replay(&file.0, &blind, &names).unwrap();
    assert_eq!(report.accepted, 0);
    let (estimated, reckoned) = (report.position_rmse_m, report.dead_reckoning_position_rmse_m);
    assert!((estimated.unwrap() - reckoned.unwrap()).abs() < 0.01, "{report:?}");
}

#[test]
fn ambiguous_topics_are_errors() {
    let mut recorder = round(1.0, "/base/odom");
    let now = Stamp::from_seconds(1.7e9 + 1.0);
    let other = messages::odometry(now, Pose::identity(), Twist::zero());
    recorder.write("/visual/odom", "nav_msgs/msg/Odometry", now, &other);
    let file = File::new("two", &recorder.finished());
    let said = replay(&file.0, &settings(), &Names::default()).unwrap_err().to_string();
    assert!(said.contains("/base/odom, /visual/odom") && said.contains("--remap odom:=/base/odom"), "{said}");
    let names = Names::new("", &["odom:=/base/odom".to_owned()]).unwrap();
    assert_eq!(replay(&file.0, &settings(), &names).unwrap().steps, 20);
    let names = Names::new("", &["odom:=/nowhere".to_owned()]).unwrap();
    let said = replay(&file.0, &settings(), &names).unwrap_err().to_string();
    assert!(said.contains("no topic /nowhere") && said.contains("/visual/odom (nav_msgs"), "{said}");
}

/// Settings with a compass or a map require their topics.
#[test]
fn required_topics_must_exist() {
    let mut recorder = Recorder::new();
    let now = Stamp::from_seconds(1.7e9);
    recorder.write(
        "/odom",
        "nav_msgs/msg/Odometry",
        now,
        &messages::odometry(now, Pose::identity(), Twist::zero()),
    );
    let file = File::new("odometry-only", &recorder.finished());
    let (names, blind) = (Names::default(), NodeDriverSettings { map: None, compass: false, ..settings() });
    assert_eq!(replay(&file.0, &blind, &names).unwrap().steps, 1);
    let said = |settings: &NodeDriverSettings| replay(&file.0, settings, &names).unwrap_err().to_string();
    let compass = said(&NodeDriverSettings { compass: true, ..blind.clone() });
    assert!(compass.contains("no topic imu of type sensor_msgs/msg/Imu"), "{compass}");
    let map = said(&NodeDriverSettings { map: settings().map, ..blind });
    assert!(map.contains("no topic scan") && map.contains("/odom (nav_msgs"), "{map}");
    let calibration = recorded(&file.0, &settings().config, &names, false).unwrap_err().to_string();
    assert!(calibration.contains("no topic scan"), "{calibration}");
}

#[test]
fn compressed_files_are_read() {
    let bytes = round(16.0, "/odom").finished();
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(&bytes).unwrap();
    let packed = packed.finish().unwrap();
    let replayed = |name, bytes: &[u8]| replay(&File::new(name, bytes).0, &settings(), &Names::default());
    assert_eq!(replayed("gzip", &packed).unwrap().steps, 320);
    let zstd = ruzstd::encoding::compress_to_vec(&bytes[..], ruzstd::encoding::CompressionLevel::Fastest);
    assert_eq!(replayed("zstd", &zstd).unwrap().steps, 320);
    let steps = replayed("half-gzip", &packed[..packed.len() / 2]).unwrap().steps;
    assert!((1..320).contains(&steps), "{steps}");
    let none = replayed("text", b"not a recording at all").unwrap_err();
    assert!(matches!(none, BagError::NoMcap), "{none}");
}

/// A simulator publishes the truth as odometry as well; a topic may also have channels of another type.
#[test]
fn truth_of_type_odometry_is_not_used_as_odometry() {
    let true_start = messages::odometry(Stamp::from_seconds(1.7e9 + 0.5), Pose::identity(), Twist::zero());
    let mut recorder = Recorder::new();
    recorder.write("/truth", "nav_msgs/msg/Odometry", Stamp::from_seconds(1.7e9), &true_start);
    let file = File::new("truth-only", &recorder.finished());
    let said = replay(&file.0, &settings(), &Names::default()).unwrap_err().to_string();
    assert!(said.contains("no topic odom") && said.contains("/truth (nav_msgs"), "{said}");

    let mut recorder = round(1.0, "/base/odom");
    let now = Stamp::from_seconds(1.7e9 + 1.0);
    recorder.write("/ground", "nav_msgs/msg/Odometry", now, &true_start);
    let schema = recorder.writer.add_schema("std_msgs/msg/String", "string data");
    let other = recorder.writer.add_channel(schema, "/base/odom");
    recorder.channels.insert("another channel of it".to_owned(), other);
    recorder.write_bytes("another channel of it", "", now, &[0, 1, 0, 0, 1, 0, 0, 0, 0]);
    let file = File::new("truth-beside", &recorder.finished());
    let names = Names::new("", &["truth:=/ground".to_owned()]).unwrap();
    assert_eq!(replay(&file.0, &settings(), &names).unwrap().steps, 20);
}

#[test]
fn invalid_recordings_are_errors_without_panic() {
    let bytes = round(1.0, "/odom").finished();
    let mut broken = vec![Vec::new(), b"not a recording".to_vec()];
    broken.extend([8, 40].map(|length| bytes[..length].to_vec()));
    for (number, bytes) in broken.iter().enumerate() {
        let file = File::new(&format!("broken-{number}"), bytes);
        assert!(replay(&file.0, &settings(), &Names::default()).is_err(), "{} bytes", bytes.len());
    }
    // A wrong byte gives an error or another recording, without a panic.
    for place in (0..bytes.len()).step_by(bytes.len() / 300) {
        let mut bytes = bytes.clone();
        bytes[place] ^= 0xff;
        let file = File::new("flipped", &bytes);
        let _judged = replay(&file.0, &settings(), &Names::default());
        let read = recorded(&file.0, &settings().config, &Names::default(), true);
        let _fitted = read.map(|read| calibrate(&read.recording, &read.options, &CancelToken::default()));
    }
    let absent = replay(Path::new("/nowhere.mcap"), &settings(), &Names::default());
    assert!(matches!(absent, Err(BagError::Unreadable { .. })));
}

/// An interrupted recorder writes no footer.
#[test]
fn truncated_recording_is_used_up_to_the_cut() {
    let bytes = round(4.0, "/odom").finished();
    let file = File::new("cut", &bytes[..bytes.len() / 2]);
    let mut notices = Vec::new();
    let report =
        super::replay(&file.0, &settings(), &Names::default(), |notice| notices.push(notice)).unwrap();
    assert!((20..80).contains(&report.steps), "{report:?}");
    let [Notice::Truncated(truncation), Notice::LaserMount(_)] = &notices[..] else { panic!("{notices:?}") };
    assert!(truncation.file == file.0 && (100..bytes.len() as u64 / 2).contains(&truncation.offset));
    let Recorded { recording, truncations, .. } =
        recorded(&file.0, &settings().config, &Names::default(), true).unwrap();
    assert!(recording.ticks.len() > 10 && truncations == [truncation.clone()]);
}

#[test]
fn undecodable_message_is_named() {
    let mut recorder = round(1.0, "/odom");
    let now = Stamp::from_seconds(1.7e9 + 1.0);
    recorder.write_bytes("/odom", "nav_msgs/msg/Odometry", now, &[0, 1, 0, 0, 7]);
    let file = File::new("short", &recorder.finished());
    let said = replay(&file.0, &settings(), &Names::default()).unwrap_err().to_string();
    assert!(said.starts_with("message 21 of /odom: not a nav_msgs/msg/Odometry"), "{said}");
}

/// rosbag2 splits long recordings, each part with its own channels.
#[test]
fn folder_with_one_recording_is_read() {
    let folder = std::env::temp_dir().join(format!("surepose-{}-folder", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let replayed = || replay(&folder, &settings(), &Names::default());
    assert!(matches!(replayed(), Err(BagError::NotOneRecording { count: 0 })));
    let robot = || {
        let scenario = Scenario::default();
        let base = scenario.world().drive;
        Robot { scenario, base, hangs: false, pause: 0.0 }
    };
    // Parts of one recording in the order of time; the tenth follows the ninth.
    let whole = recorded_by(&robot(), 6.0, "/odom", |_| Twist::new(0.2, 0.2));
    let begin = 1.7e9;
    for (part, from, to) in [(8, 0.0, 2.0), (9, 2.0, 4.0), (10, 4.0, 7.0)] {
        let mut recorder = Recorder::new();
        // Another order of the channels.
        if part == 9 {
            let now = Stamp::from_seconds(begin);
            recorder.write("/other", "std_msgs/msg/String", now, &"nothing");
        }
        for (topic, kind, time, data) in &whole.messages {
            if (from..to).contains(&(time.seconds() - begin)) {
                recorder.write_bytes(topic, kind, *time, data);
            }
        }
        std::fs::write(folder.join(format!("drive_{part}.mcap")), recorder.finished()).unwrap();
    }
    let parts = replayed().unwrap();
    let one = replay(&File::new("whole", &whole.finished()).0, &settings(), &Names::default()).unwrap();
    assert_eq!(
        (parts.steps, parts.accepted, parts.position_rmse_m),
        (one.steps, one.accepted, one.position_rmse_m)
    );
    assert!(parts.steps == 120 && parts.skipped.is_empty(), "{parts:?}");

    std::fs::write(folder.join("drive_9.mcap"), b"no part of it").unwrap();
    let said = replayed().unwrap_err().to_string();
    assert!(said.starts_with("in drive_9.mcap: not an MCAP recording"), "{said}");
    std::fs::write(folder.join("other_0.mcap"), b"").unwrap();
    assert!(matches!(replayed(), Err(BagError::NotOneRecording { count: 4 })));
    std::fs::remove_dir_all(&folder).unwrap();
}

/// The base's odometry assumes a wheel separation 5 % and radii 3 % too large.
#[test]
fn base_with_wrong_wheel_parameters_is_calibrated() {
    let scenario = Scenario::default();
    let truth = scenario.world().drive;
    let base = DiffDrive::new(1.03 * truth.radius.right, 1.05 * truth.wheel_separation);
    let robot = Robot { scenario: scenario.clone(), base, hangs: false, pause: 0.0 };
    let mut recorder = recorded_by(&robot, 120.0, "/odom", winding);
    // Scans without a stamp are skipped.
    let unstamped =
        SimulatedScan { angle_min: -1.5, angle_increment: 0.05, ranges: vec![1.0; 61], time_increment: 0.0 };
    for _ in 0..50 {
        let scan = messages::scan(Stamp::default(), &unstamped);
        recorder.write("/scan", "sensor_msgs/msg/LaserScan", Stamp::from_seconds(1.7e9 + 120.0), &scan);
    }
    let file = File::new("calibrate", &recorder.finished());
    let preset =
        [(&param::WHEEL_RADIUS, base.radius.right), (&param::WHEEL_SEPARATION, base.wheel_separation)];
    let config = scenario.config.with_preset("base", &preset);
    let Recorded { recording, options, skipped, .. } =
        recorded(&file.0, &config, &Names::default(), true).unwrap();
    // Measurements before the first odometry, at 0.05 s, are skipped as well.
    let count = skipped["without_odometry"];
    assert!((50..60).contains(&count) && skipped.len() == 1, "{skipped:?}");
    let found = calibrate(&recording, &options, &CancelToken::default()).unwrap().parameters();
    for (name, truth, nearer_than) in [
        ("wheel_radius_m", truth.radius.right, 0.005 * truth.radius.right),
        ("track_m", truth.wheel_separation, 0.005 * truth.wheel_separation),
        ("wheel_radius_ratio", 1.0, 0.005),
        ("laser_heading_deg", 0.0, 0.1),
        ("laser_latency_s", 0.0, 0.02),
        ("compass_offset_deg", 0.0, 0.2),
        ("compass_latency_s", 0.0, 0.02),
    ] {
        let estimate = found[name];
        let (value, std) = (estimate.value.unwrap(), estimate.std_error.unwrap());
        let off = (value - truth).abs();
        assert!(off < nearer_than && off < 3.0 * std, "{name}: {value} ± {std}, truth {truth}");
    }
}

/// A driver that states the sweep and stamps another beam than the first.
#[test]
fn the_stamped_beam_is_found() {
    for stamped in ["middle", "last"] {
        let options = ["laser.sweep_s=0.1", &format!("laser.stamp={stamped}")];
        let add = |config: Config, option: &&str| config.with_option(option).unwrap();
        let scenario = Scenario::configured(options.iter().fold(Config::default(), add));
        let robot =
            Robot { scenario: scenario.clone(), base: scenario.world().drive, hangs: false, pause: 0.0 };
        let file = File::new(stamped, &recorded_by(&robot, 120.0, "/odom", winding).finished());
        let Recorded { recording, options, .. } =
            recorded(&file.0, &Config::default(), &Names::default(), true).unwrap();
        let found = calibrate(&recording, &options, &CancelToken::default()).unwrap();
        assert_eq!(found.laser_stamp().map(Choice::name), Some(stamped));
        let latency = found.parameters()["laser_latency_s"].value.unwrap();
        assert!(latency.abs() < 0.02, "{stamped}: {latency} s");
        assert!(found.configuration().contains(&format!("stamp = \"{stamped}\"")));
    }
}

/// The configuration has no laser pose; the laser is mounted off-center and upside down.
#[test]
fn laser_extrinsics_are_read_from_tf_static() {
    let options = ["laser.x_m=0.2", "laser.y_m=-0.1", "laser.heading_deg=-60"];
    let config =
        options.iter().fold(Scenario::default().config, |config, option| config.with_option(option).unwrap());
    let sits = config.laser().body_from_laser;
    let scenario = Scenario::configured(config);
    let base = scenario.world().drive;
    let robot = Robot { scenario, base, hangs: true, pause: 0.0 };
    let record = || recorded_by(&robot, 60.0, "/odom", winding);
    let without = File::new("untold", &record().finished());
    let mut told = messages::mounted(sits);
    // Rotation by 180° about its x axis.
    let Quaternion { z, w, .. } = told.transforms[0].transform.rotation;
    told.transforms[0].transform.rotation = Quaternion { x: w, y: z, z: 0.0, w: 0.0 };
    let mut recorder = record();
    recorder.write("/tf_static", "tf2_msgs/msg/TFMessage", Stamp::from_seconds(1.7e9 + 1.0), &told);
    let with = File::new("told", &recorder.finished());

    let (settings, names) = (settings(), Names::default());
    let judged = |file: &File| replay(&file.0, &settings, &names).unwrap();
    let (untold, told) = (judged(&without), judged(&with));
    assert!(untold.accepted < told.accepted / 2, "a wrong laser pose matches few walls: {untold:?}");
    assert!(told.position_rmse_m.unwrap() < 0.005 && told.heading_rmse_deg.unwrap() < 0.1, "{told:?}");
    assert!((2.0..4.5).contains(&told.nees_mean.unwrap()), "{told:?}");

    let Recorded { recording, options, mounted, .. } =
        recorded(&with.0, &settings.config, &names, true).unwrap();
    assert!(mounted.unwrap().ends_with("upside down, by /tf_static"));
    let begins = options.nominal.body_from_laser();
    assert!((begins.x - sits.x).hypot(begins.y - sits.y) < 1e-9, "{begins:?}");
    let found = calibrate(&recording, &options, &CancelToken::default()).unwrap().parameters();
    for (name, truth, nearer_than) in
        [("laser_x_m", 0.2, 0.01), ("laser_y_m", -0.1, 0.01), ("laser_heading_deg", -60.0, 0.1)]
    {
        let value = found[name].value.unwrap();
        assert!((value - truth).abs() < nearer_than, "{name}: {value}, truth {truth}");
    }
}

/// Odometry that pauses while the robot turns, as a busy network makes it. The whole increment counts.
#[test]
fn gap_in_odometry_keeps_its_whole_increment() {
    for seconds in [0.3, 1.0, 4.0, 10.0] {
        let file = File::new("gap", &with_gap(seconds).finished());
        // Odometry alone shows an increment that is lost.
        let blind = NodeDriverSettings { map: None, compass: false, ..settings() };
        let report = replay(&file.0, &blind, &Names::default()).unwrap();
        println!("gap of {seconds} s: {:?} {:?}", report.position_rmse_m, report.nees_mean);
        let reckoned = report.dead_reckoning_position_rmse_m.unwrap();
        assert!((report.position_rmse_m.unwrap() - reckoned).abs() < 0.01, "{seconds} s: {report:?}");
        assert!(report.nees_mean.unwrap() <= 10.0, "{seconds} s: {report:?}");
        let within = |at: &surepose_replay::TrackPoint| {
            let [x, y, _] = at.std;
            at.truth.is_none_or(|truth| at.pose.origin().distance(truth.origin()) <= 3.0 * x.hypot(y))
        };
        let inside = report.track.points.iter().filter(|at| within(at)).count();
        assert!(inside as f64 >= 0.95 * report.track.points.len() as f64, "{seconds} s");
    }
}
