//! Replays a recording with the driver, and evaluates its estimates against the truth.

use std::path::Path;
use std::time::Instant;

use surepose::estimation::Belief;
use surepose::geometry::{Body, Map, Pose};
use surepose::kinematics::Motion;
use surepose::safety::Health;
use surepose::time::Stamp;
use surepose_config::ScanMethod;
use surepose_io::recording::StampedPose;
use surepose_replay::{Reference, ReplayReport, Track};
use surepose_sim::ErrorAccumulator;

use crate::convert::MessageError;
use crate::driver::{DriverReport, NodeDriver, NodeDriverSettings, Odom};
use crate::names::Names;
use crate::sense;

use super::bag_index::{BagIndex, REFERENCE_STD};
use super::reader::{Bag, BagMessage, Role};
use super::{BagError, Notice};

/// Replays the recording at `path` with the topics of `names`.
///
/// Without a start in `settings`, the start is that of the reference, or else from global localization. `notify` receives each
/// [`Notice`]: laser extrinsics and truncated files.
///
/// # Errors
/// [`BagError`] for an unreadable or damaged recording.
pub fn replay(
    path: &Path,
    settings: &NodeDriverSettings,
    names: &Names,
    mut notify: impl FnMut(Notice),
) -> Result<ReplayReport, BagError> {
    let begun = Instant::now();
    let required = [(Role::Scan, settings.map.is_some()), (Role::Imu, settings.hears_imu())];
    let required: Vec<_> =
        required.into_iter().filter_map(|(role, is_required)| is_required.then_some(role)).collect();
    let bag = Bag::open(path, names, &required)?;
    bag.truncations().iter().cloned().map(Notice::Truncated).for_each(&mut notify);
    let mut report = ReplayReport::default();
    let bag_index = BagIndex::from_bag(&bag, &settings.config, |why| report.skip(Some(why.name())))?;
    let mut settings = settings.clone();
    if settings.start.is_none() {
        settings.start = bag_index.start().map(|start| Belief::new(start, REFERENCE_STD));
    }
    let BagIndex { poses, mut extrinsics, .. } = bag_index;
    let compass = settings.config.compass();
    let (has_map, hears_compass, hears_gyroscope) =
        (settings.map.is_some(), settings.compass, settings.gyroscope);
    // Walls traced from a grid are not where the truth has them.
    let reference_std = match (&settings.map, settings.scan_method) {
        (Some(_), ScanMethod::Beams) => ScanMethod::Beams.map_std(),
        _ => [0.0; 3],
    };
    let mut set_filter_errors = Judge::new(&poses, reference_std);
    let mut driver = NodeDriver::new(settings);
    bag.messages(|said| {
        let refused: Result<(), MessageError> = match said {
            BagMessage::Odometry(odometry) => sense::odometry(&odometry).and_then(|at| {
                set_filter_errors.rolled(at.stamp, at.value, &mut report);
                let ticked = driver.on_odometry(at)?;
                if let Some(ticked) = &ticked {
                    set_filter_errors.ticked(ticked, &mut report);
                }
                Ok(())
            }),
            BagMessage::Scan(_) if !has_map => Ok(()),
            BagMessage::Scan(scan) => {
                let laser_extrinsics = extrinsics.laser(&scan.header.frame_id);
                if let Some(line) = extrinsics.take_source_message() {
                    notify(Notice::LaserMount(line));
                }
                laser_extrinsics.map(|laser_extrinsics| {
                    if let Some(laser_extrinsics) = laser_extrinsics {
                        driver.add_measurement(sense::scan(scan, laser_extrinsics));
                    }
                })
            }
            BagMessage::Imu(imu) if hears_compass || hears_gyroscope => {
                extrinsics.compass(&imu.header.frame_id).map_or(Ok(()), |mounting| {
                    if hears_gyroscope {
                        driver.add_measurement(sense::yaw_rate(&imu, &mounting)?);
                    }
                    if hears_compass {
                        driver.add_measurement(sense::heading(&imu, &mounting, &compass)?);
                    }
                    Ok(())
                })
            }
            BagMessage::Imu(_)
            | BagMessage::Truth(_)
            | BagMessage::StaticTransforms(_)
            | BagMessage::Command(_) => Ok(()),
        };
        report.skip(refused.err().map(|why| why.name()));
    })?;
    set_filter_errors.finish(&mut report);
    report.count(driver.measurement_stats());
    report.wall_s = begun.elapsed().as_secs_f64();
    Ok(report)
}

/// Reference poses of the recording, and the errors of the estimates.
struct Judge<'a> {
    reference: Reference<'a>,
    track: Track,
    dead_reckoning: ErrorAccumulator,
    /// Time of the first odometry, pose of its frame at the first known pose, and newest odometry.
    first: Option<Stamp>,
    map_from_odom: Option<Pose<Map, Odom, f64>>,
    last: Option<(Stamp, Pose<Odom, Body, f64>)>,
    was_lost: bool,
}

impl<'a> Judge<'a> {
    fn new(poses: &'a [StampedPose], reference_std: [f64; 3]) -> Self {
        Self {
            reference: Reference::new(poses),
            track: Track { reference_std, ..Track::default() },
            dead_reckoning: ErrorAccumulator::default(),
            first: None,
            map_from_odom: None,
            last: None,
            was_lost: false,
        }
    }

    fn rolled(&mut self, stamp: Stamp, odometry: Pose<Odom, Body, f64>, report: &mut ReplayReport) {
        report.steps += 1;
        if let Some((_, last)) = self.last {
            report.distance_m += Motion::between(last, odometry).length.abs();
        }
        self.first = self.first.or(Some(stamp));
        self.last = Some((stamp, odometry));
        let truth = self.reference.at(stamp.seconds());
        if let Some(truth) = truth {
            let map_from_odom = *self.map_from_odom.get_or_insert(truth * odometry.inverse());
            let reckoned = Belief::new(map_from_odom * odometry, [0.0; 3]);
            self.dead_reckoning.add(reckoned.error(truth));
        }
    }

    fn ticked(&mut self, ticked: &DriverReport, report: &mut ReplayReport) {
        let is_lost = ticked.health == Health::Lost;
        let truth = self.reference.at(ticked.stamp.seconds());
        self.track.add(ticked.stamp.seconds(), &ticked.belief, truth, !is_lost);
        if is_lost {
            (self.was_lost, report.found_s) = (true, None);
        } else if self.was_lost && report.found_s.is_none() {
            report.found_s = self.first.map(|first| ticked.stamp.since(first));
        }
    }

    fn finish(self, report: &mut ReplayReport) {
        if let (Some(first), Some((last, _))) = (self.first, self.last) {
            report.duration_s = last.since(first);
        }
        report.set_track(self.track, self.reference.interval());
        report.set_odometry_errors(self.dead_reckoning.summary());
    }
}
