//! Reads calibration data from a recording: wheel travel by odometry, scans and headings.

use core::f64::consts::TAU;
use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::UnitQuaternion;
use surepose::control::Controller;
use surepose::estimation::{HeadingMeasurement, Measurement};
use surepose::geometry::Angle;
use surepose::kinematics::{Twist, WheelPair};
use surepose::lidar::ScanTiming;
use surepose::time::{Stamp, Stamped};
use surepose_config::{CompassParameters, Config};
use surepose_io::recording::{ScanRecord, SensorPose, StampedTicks};
use surepose_mapping::calibrate::{
    CalibrationParameter, CalibrationRecording, Options, StampedCommand, StampedHeading,
};

use crate::convert::MessageError;
use crate::driver::{OdometryAccumulator, SensorMessage};
use crate::extrinsics::ExtrinsicsResolver;
use crate::message::{LaserScan, Odometry, Vector3};
use crate::names::Names;
use crate::sense;

use super::bag_index::{BagIndex, REFERENCE_STD};
use super::reader::{Bag, BagMessage, RecordedCommand, Role};
use super::{BagError, Truncation};

/// Resolution of the encoder counts that are derived from odometry poses.
const TICKS_PER_TURN: f64 = 1e5;

/// Longest time before the first odometry of a command that may still be in effect \[s].
const MAX_COMMAND_AGE: f64 = 1.0;

/// Standard deviation of a wall's distance \[m] and direction \[rad] beyond the usual laser noise.
const WALL_STD: (f64, f64) = (0.01, 0.5 * TAU / 360.0);

/// Calibration data of a recording, with the initial values.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// Input of the calibration. Encoder counts have the control period, for which δ is estimated.
    pub recording: CalibrationRecording,
    /// Initial values: the robot of the configuration, range limit and sweep time of the laser from the scans, and the
    /// initial heading from the truth, if there is one.
    pub options: Options,
    /// Counts of unused messages, by reason.
    pub skipped: BTreeMap<&'static str, u64>,
    /// Initial laser extrinsics and their source; `None` without a scan.
    pub mounted: Option<String>,
    /// Truncated files.
    pub truncations: Vec<Truncation>,
}

/// Reads the recording at `path` with the topics of `names`, for calibration.
///
/// The wheel parameters of `config` convert odometry back to wheel travel. `compass`: whether headings are used.
///
/// # Errors
/// [`BagError`] for an unreadable or damaged recording.
pub fn recorded(path: &Path, config: &Config, names: &Names, compass: bool) -> Result<Recorded, BagError> {
    let required: &[Role] = if compass { &[Role::Scan, Role::Imu] } else { &[Role::Scan] };
    let bag = Bag::open(path, names, required)?;
    let mut options = Options::from_config(config);
    (options.wall_distance_std, options.wall_direction_std) = WALL_STD;
    let mut skipped = BTreeMap::new();
    let bag_index = BagIndex::from_bag(&bag, config, |why| *skipped.entry(why.name()).or_default() += 1)?;
    let start = bag_index.start();
    options.start_heading =
        start.map(|start| HeadingMeasurement { heading: start.heading, std: REFERENCE_STD[2] });
    let mut gathering = Gathering::new(config, options, bag_index.extrinsics, skipped);
    // The compass offset is estimated; it includes the mounting, as the configured offset does.
    let compass_parameters = CompassParameters { offset: Angle::zero(), ..config.compass() };
    bag.messages(|said| {
        let refused = match said {
            BagMessage::Odometry(odometry) => gathering.roll(&odometry),
            BagMessage::Scan(scan) => gathering.see(scan),
            BagMessage::Imu(imu) if compass => {
                let identity = UnitQuaternion::identity();
                sense::heading(&imu, &identity, &compass_parameters).map(|message| gathering.turn(&message))
            }
            BagMessage::Command(command) => gathering.command(&command),
            BagMessage::Imu(_) | BagMessage::Truth(_) | BagMessage::StaticTransforms(_) => Ok(()),
        };
        if let Err(why) = refused {
            gathering.skip(why.name());
        }
    })?;
    gathering.recorded.truncations = bag.truncations().to_vec();
    Ok(gathering.finished())
}

/// Calibration data while the recording is read.
struct Gathering {
    recorded: Recorded,
    extrinsics: ExtrinsicsResolver,
    controller: Controller<f64>,
    timing: ScanTiming,
    odometry_accumulator: Option<OdometryAccumulator>,
    /// Wheel angles since the first odometry \[rad].
    turned: WheelPair<f64>,
}

impl Gathering {
    fn new(
        config: &Config,
        options: Options,
        extrinsics: ExtrinsicsResolver,
        skipped: BTreeMap<&'static str, u64>,
    ) -> Self {
        let recording = CalibrationRecording {
            ticks_per_turn: TICKS_PER_TURN,
            ticks: Vec::new(),
            scans: Vec::new(),
            headings: Vec::new(),
            commands: Vec::new(),
        };
        Self {
            recorded: Recorded { recording, options, skipped, mounted: None, truncations: Vec::new() },
            extrinsics,
            controller: config.controller(),
            timing: config.laser().timing,
            odometry_accumulator: None,
            turned: WheelPair::zero(),
        }
    }

    fn roll(&mut self, odometry: &Odometry) -> Result<(), MessageError> {
        let at = sense::odometry(odometry)?;
        let Some(odometry_accumulator) = &mut self.odometry_accumulator else {
            self.odometry_accumulator = Some(OdometryAccumulator::new(at));
            self.count(at.stamp);
            return Ok(());
        };
        let Some(rims) = odometry_accumulator.add(&self.controller, at)? else { return Ok(()) };
        // Wheel travel over an odometry reset is unknown; the walls constrain the motion.
        if (rims.right + rims.left).is_finite() {
            let turns = self.controller.drive.wheel_angle_from_travel(rims);
            self.turned = WheelPair::new(self.turned.right + turns.right, self.turned.left + turns.left);
        } else {
            self.skip("odometry_jump");
        }
        self.count(at.stamp);
        Ok(())
    }

    fn count(&mut self, stamp: Stamp) {
        let ticks = |turned: f64| (turned / TAU * TICKS_PER_TURN).round() as i64;
        let (left, right) = (ticks(self.turned.left), ticks(self.turned.right));
        self.recorded.recording.ticks.push(StampedTicks { time: stamp.seconds(), left, right });
    }

    fn see(&mut self, message: LaserScan) -> Result<(), MessageError> {
        let Some(laser_extrinsics) = self.extrinsics.laser(&message.header.frame_id)? else { return Ok(()) };
        let stamped = sense::scan(message, laser_extrinsics);
        let Stamped { stamp, value: SensorMessage::Scan(scan) } = stamped else { return Ok(()) };
        if !scan.angle_min.is_finite() || !scan.angle_increment.is_finite() {
            return Err(MessageError::NotFinite);
        }
        let time = stamp.seconds();
        let Recorded { recording, options, .. } = &mut self.recorded;
        if recording.scans.is_empty() {
            (options.range_min, options.range_max) = (scan.range_min.max(options.range_min), scan.range_max);
            options.nominal = options.nominal.with_laser(scan.body_from_laser);
            let steps = scan.ranges.len().saturating_sub(1) as f64;
            let sweep = self.timing.sweep.unwrap_or(scan.time_increment * steps);
            // Beams of a clockwise scan are reversed below.
            options.sweep = sweep.copysign(scan.angle_increment);
            options.finds_stamp = sweep > 0.0;
            // The fit starts at the latency of the middle beam.
            let latency = options.nominal.get(CalibrationParameter::LaserLatency);
            let middle = latency + (self.timing.stamped.fraction() - 0.5) * sweep;
            options.nominal.0[CalibrationParameter::LaserLatency as usize] = middle;
        }
        let reach = scan.range_min..scan.range_max;
        let returned = |range: f64| if reach.contains(&range) { range } else { f64::INFINITY };
        let mut ranges: Vec<f64> = scan.ranges.into_iter().map(returned).collect();
        let (mut angle_min, mut angle_increment) = (scan.angle_min, scan.angle_increment);
        // Some lasers scan clockwise.
        if angle_increment < 0.0 {
            ranges.reverse();
            angle_min += angle_increment * ranges.len().saturating_sub(1) as f64;
            angle_increment = -angle_increment;
        }
        let odometry_before = recording.ticks.len();
        let mount = SensorPose::default();
        let odometry = None;
        recording.scans.push(ScanRecord {
            time,
            angle_min,
            angle_increment,
            ranges,
            mount,
            odometry,
            odometry_before,
        });
        Ok(())
    }

    fn turn(&mut self, message: &Stamped<SensorMessage>) {
        if let SensorMessage::Measurement(Measurement::Heading(HeadingMeasurement { heading, .. })) =
            message.value
        {
            let time = message.stamp.seconds();
            self.recorded.recording.headings.push(StampedHeading { time, heading });
        }
    }

    /// Takes a command at its own stamp, or, without one, at the time at which it was recorded.
    fn command(&mut self, command: &RecordedCommand) -> Result<(), MessageError> {
        let Vector3 { x: v, .. } = command.twist.linear;
        let Vector3 { z: omega, .. } = command.twist.angular;
        if !v.is_finite() || !omega.is_finite() {
            return Err(MessageError::NotFinite);
        }
        // Some drivers leave the stamp 0.
        let own = command.stamp.filter(|stamp| stamp.nanoseconds() > 0);
        let time = own.unwrap_or(command.received).seconds();
        self.recorded.recording.commands.push(StampedCommand { time, twist: Twist::new(v, omega) });
        Ok(())
    }

    fn skip(&mut self, why: &'static str) {
        *self.recorded.skipped.entry(why).or_default() += 1;
    }

    /// Sorts the data by time, and drops measurements before the first odometry, including those with an unset stamp.
    fn finished(mut self) -> Recorded {
        let Recorded { mut recording, options, mut skipped, truncations, .. } = self.recorded;
        let CalibrationRecording { ticks, scans, headings, commands, .. } = &mut recording;
        let first = ticks.first().map_or(f64::INFINITY, |ticks| ticks.time);
        let last = ticks.last().map_or(f64::NEG_INFINITY, |ticks| ticks.time);
        let before = scans.len() + headings.len();
        scans.retain(|scan| (first..=last).contains(&scan.time));
        headings.retain(|read| (first..=last).contains(&read.time));
        let without = before - scans.len() - headings.len();
        if without > 0 {
            skipped.insert("without_odometry", without as u64);
        }
        // Commands of another clock say nothing.
        let sent = commands.len();
        commands.retain(|command| (first - MAX_COMMAND_AGE..=last).contains(&command.time));
        if commands.len() < sent {
            skipped.insert("command_without_odometry", (sent - commands.len()) as u64);
        }
        commands.sort_by(|a, b| a.time.total_cmp(&b.time));
        scans.sort_by(|a, b| a.time.total_cmp(&b.time));
        headings.sort_by(|a, b| a.time.total_cmp(&b.time));
        Recorded { recording, options, skipped, mounted: self.extrinsics.take_source_message(), truncations }
    }
}
