//! Replay of MRCLAM: commanded velocities predict, landmark observations correct.

mod camera;
mod response;
mod settings;

use std::path::Path;
use std::time::Instant;

use surepose::estimation::{Belief, DelayedEkf, Ekf, Gate, Measurement, WheelOdometry};
use surepose::geometry::{Body, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, Motion, Twist, WheelPair};
use surepose::lidar::ScanProcessor;
use surepose::localization::{Localizer, Odometry, SensorInput, SensorReading};
use surepose::map::MapView;
use surepose::time::{Stamp, Stamped};
use surepose_io::mrclam::{self as data, LandmarkObservation, RobotLog, Target};
use surepose_io::recording::StampedTwist;
use surepose_sim::ErrorAccumulator;

use super::reference::Reference;
use super::report::{ReplayError, ReplayReport};
use super::track::Track;

pub use camera::Camera;
pub use response::Response;

/// Model of robot and camera, the same for all robots of a data set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MrclamSettings {
    /// Response of the base to commands.
    pub response: Response,
    /// Distance between the wheels \[m].
    pub wheel_separation: f64,
    /// Variance of a rim's travel per meter driven \[m²/m]: 1° of heading per second of straight motion.
    pub rim_variance_per_metre: f64,
    /// Variance of a rim's travel per radian turned \[m²/rad].
    ///
    /// 8° of heading per radian, the scatter of the robots over a minute. Most of the error arises at the
    /// start and end of a turn: turns commanded for 0.06 s to 0.33 s all resulted in about 5°.
    pub rim_variance_per_radian: f64,
    /// The camera.
    pub camera: Camera,
    /// Probability with which a consistent observation passes the gate.
    pub gate_probability: f64,
    /// Maximum age of a late observation \[s].
    pub history: f64,
    /// Start pose; `None` for the reference pose.
    pub start: Option<Pose<Map, Body, f64>>,
    /// Standard deviations of the reference pose at the start: x \[m], y \[m], θ \[rad].
    pub start_std: [f64; 3],
}

impl Default for MrclamSettings {
    fn default() -> Self {
        Self {
            response: Response::default(),
            wheel_separation: 0.26,
            rim_variance_per_metre: 1.5e-4,
            rim_variance_per_radian: 7e-4,
            camera: Camera::default(),
            gate_probability: 0.999_999,
            history: 0.5,
            start: None,
            start_std: [0.01, 0.01, 1.0_f64.to_radians()],
        }
    }
}

/// Reads the log of `robot` in the data set at `folder` and replays it.
///
/// # Errors
/// [`ReplayError`], if the data set cannot be read or has no reference pose at the start.
pub fn replay(folder: &Path, robot: u32, settings: &MrclamSettings) -> Result<ReplayReport, ReplayError> {
    let begun = Instant::now();
    let log = data::read(folder, robot)?;
    let mut report = replay_log(&log, settings)?;
    report.wall_s = begun.elapsed().as_secs_f64();
    Ok(report)
}

/// Replays a log from its first command that has a reference pose.
///
/// A command is a filter step at the time when it takes effect; the estimate is evaluated at that time.
///
/// # Errors
/// [`ReplayError::NoStart`].
pub fn replay_log(log: &RobotLog, settings: &MrclamSettings) -> Result<ReplayReport, ReplayError> {
    let begun = Instant::now();
    let reference = Reference::new(&log.reference);
    let dead_time = settings.response.dead_time;
    let starts = |command: &StampedTwist| reference.at(command.time + dead_time).is_some();
    let first = match settings.start {
        Some(_) => 0,
        None => log.odometry.iter().position(starts).ok_or(ReplayError::NoStart)?,
    };
    let commands = log.odometry.get(first..).unwrap_or_default();
    let (Some(begin), Some(end)) = (commands.first(), commands.last()) else {
        return Err(ReplayError::NoStart);
    };

    let mut replay = Replay::start(log, settings, &reference, begin).ok_or(ReplayError::NoStart)?;
    let mut track = Track::default();
    let mut sightings = log.sightings.iter().peekable();
    for command in commands {
        let effective = command.time + dead_time;
        while let Some(sighting) = sightings.next_if(|sighting| sighting.time <= effective) {
            replay.correct(sighting);
        }
        replay.advance(effective);
        replay.command = twist(command);
        track.add(effective, &replay.localizer.estimator().belief(), reference.at(effective), true);
    }
    for sighting in sightings {
        replay.correct(sighting);
    }

    let mut report = replay.report;
    report.steps = commands.len() as u64;
    report.duration_s = end.time - begin.time;
    report.distance_m = if log.reference.is_empty() {
        commands.windows(2).map(|pair| pair[0].speed.abs() * (pair[1].time - pair[0].time)).sum()
    } else {
        reference.distance(begin.time, end.time)
    };
    report.set_track(track, reference.interval());
    report.set_odometry_errors(dead_reckoning(commands, &reference).summary());
    report.count(replay.localizer.estimator().measurement_stats());
    report.wall_s = begun.elapsed().as_secs_f64();
    Ok(report)
}

/// Standard deviations of a start pose from the user: x \[m], y \[m], θ \[rad].
const PICKED_START_STD: [f64; 3] = [0.1, 0.1, 0.1];

/// State of a replay.
struct Replay<'a> {
    log: &'a RobotLog,
    settings: &'a MrclamSettings,
    /// Command in effect.
    command: Twist<f64>,
    localizer: Localizer<f64, 64, 0>,
    report: ReplayReport,
}

impl<'a> Replay<'a> {
    /// Starts at the reference pose when `begin` takes effect; `None` if there is none.
    fn start(
        log: &'a RobotLog,
        settings: &'a MrclamSettings,
        reference: &Reference<'_>,
        begin: &StampedTwist,
    ) -> Option<Self> {
        let time = begin.time + settings.response.dead_time;
        let belief = match settings.start {
            Some(start) => Belief::new(start, PICKED_START_STD),
            None => Belief::new(reference.at(time)?, settings.start_std),
        };
        // Rim travel is derived from commands, so neither the wheel radius nor δ has an effect.
        let drive = DiffDrive::new(1.0, settings.wheel_separation);
        let ekf = Ekf { drive, delta: 0.0, integration: Integration::Arc };
        let gate = Gate::new(settings.gate_probability);
        Some(Self {
            log,
            settings,
            command: twist(begin),
            localizer: Localizer::unsupervised(
                DelayedEkf::new(ekf, gate, settings.history, Stamp::from_seconds(time), belief),
                ScanProcessor::disabled(),
            ),
            report: ReplayReport::default(),
        })
    }

    /// Predicts up to `time` \[s] under the current command; past states are unchanged.
    fn advance(&mut self, time: f64) {
        let stamp = Stamp::from_seconds(time);
        let period = stamp.since(self.localizer.estimator().stamp());
        if period > 0.0 {
            let travel =
                self.wheel_odometry(self.settings.response.twist(self.command).integrate_for(period));
            // The report includes rejections from the estimator's statistics.
            let input = SensorInput { stamp, odometry: Odometry::WithVariance(travel), readings: &[] };
            self.localizer.update(&input, travel, &MapView::empty(), &mut ());
        }
    }

    /// Returns the rim travel of `motion` with its variance.
    fn wheel_odometry(&self, motion: Motion<f64>) -> WheelOdometry<f64> {
        let rims = self
            .localizer
            .estimator()
            .ekf()
            .drive
            .wheel_speeds_from_twist(Twist::new(motion.length, motion.turn));
        let variance = self.settings.rim_variance_per_metre * motion.length.abs()
            + self.settings.rim_variance_per_radian * motion.turn.abs();
        WheelOdometry { travel: rims, variance: WheelPair::new(variance, variance) }
    }

    /// Corrects by an observation of a mapped landmark.
    fn correct(&mut self, sighting: &LandmarkObservation) {
        self.advance(sighting.time);
        let landmark = match sighting.target {
            Target::Landmark(subject) => self.log.landmark(subject),
            Target::Robot(_) => return self.skip("other_robot"),
            Target::Unknown { .. } => return self.skip("unknown_barcode"),
        };
        let Some(landmark) = landmark else { return self.skip("unknown_landmark") };
        let camera = &self.settings.camera;
        let at = Point::new(landmark.x, landmark.y);
        let seen = camera.sighting(at, sighting.range, sighting.bearing);
        let stamp = Stamp::from_seconds(sighting.time - camera.latency);
        let signal = Stamped::new(stamp, SensorReading::Measurement(Measurement::RangeBearing(seen)));
        self.localizer.process(&signal, &MapView::empty(), &mut ());
    }

    fn skip(&mut self, kind: &'static str) {
        *self.report.skipped.entry(kind).or_default() += 1;
    }
}

/// Returns the errors of the recorded commands, each held until the next, from the reference pose of the
/// first.
fn dead_reckoning(commands: &[StampedTwist], reference: &Reference<'_>) -> ErrorAccumulator {
    let mut score = ErrorAccumulator::default();
    let Some(begin) = commands.first() else { return score };
    let Some(mut pose) = reference.at(begin.time) else { return score };
    for pair in commands.windows(2) {
        pose = pose.integrate(twist(&pair[0]).integrate_for(pair[1].time - pair[0].time), Integration::Arc);
        if let Some(truth) = reference.at(pair[1].time) {
            let heading = (pose.heading - truth.heading).radians();
            score.add([pose.x - truth.x, pose.y - truth.y, heading]);
        }
    }
    score
}

fn twist(command: &StampedTwist) -> Twist<f64> {
    Twist::new(command.speed, command.turn_rate)
}
