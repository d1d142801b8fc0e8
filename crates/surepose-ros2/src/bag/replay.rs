//! The pilot on a recording, judged by its truth where it has one.

use std::path::Path;
use std::time::Instant;

use surepose::{Belief, Body, Health, Map, Pose, Stamp};
use surepose_data::recording::StampedPose;
use surepose_lab::replay::{Reference, ReplayReport, Score, motion_between};

use super::prologue::{Prologue, REFERENCE_STD};
use super::reader::{Bag, Role, Said};
use super::{BagError, Notice};
use crate::convert::Refused;
use crate::names::Names;
use crate::pilot::{Odom, Pilot, Report, Settings};
use crate::sense;

/// Replays the recording at `path`, of which the topics are called as in `names`. Where `settings` name no start, it is
/// that of the reference; where there is none either, the robot looks for itself on the map. `notify` receives each
/// [`Notice`]: where the laser sits, and which files are cut short.
///
/// # Errors
/// [`BagError`], where it is no recording, or is damaged.
pub fn replay(
    path: &Path,
    settings: &Settings,
    names: &Names,
    mut notify: impl FnMut(Notice),
) -> Result<ReplayReport, BagError> {
    let begun = Instant::now();
    let wanted = [(Role::Scan, settings.map.is_some()), (Role::Imu, settings.compass)];
    let wanted: Vec<_> =
        wanted.into_iter().filter_map(|(role, is_wanted)| is_wanted.then_some(role)).collect();
    let bag = Bag::open(path, names, &wanted)?;
    bag.truncations().iter().cloned().map(Notice::Truncated).for_each(&mut notify);
    let mut report = ReplayReport::default();
    let prologue = Prologue::of(&bag, &settings.config, |why| report.skip(Some(why.name())))?;
    let mut settings = settings.clone();
    if settings.start.is_none() {
        settings.start = prologue.start().map(|start| Belief::new(start, REFERENCE_STD));
    }
    let Prologue { poses, mut mount, .. } = prologue;
    let compass = settings.config.compass();
    let (has_map, hears_compass) = (settings.map.is_some(), settings.compass);
    let mut judge = Judge::new(&poses);
    let mut pilot = Pilot::new(settings);
    bag.messages(|said| {
        let refused: Result<(), Refused> = match said {
            Said::Odometry(odometry) => sense::odometry(&odometry).and_then(|at| {
                judge.rolled(at.stamp, at.value, &mut report);
                let ticked = pilot.roll(at)?;
                if let Some(ticked) = &ticked {
                    judge.ticked(ticked, &mut report);
                }
                Ok(())
            }),
            Said::Scan(_) if !has_map => Ok(()),
            Said::Scan(scan) => {
                let mounting = mount.of(&scan.header.frame_id);
                if let Some(line) = mount.news() {
                    notify(Notice::LaserMount(line));
                }
                mounting.and_then(|mounting| sense::scan(scan, mounting)).map(|heard| pilot.hear(heard))
            }
            Said::Imu(imu) if hears_compass => sense::heading(&imu, &compass).map(|heard| pilot.hear(heard)),
            Said::Imu(_) | Said::Truth(_) | Said::Joints(_) => Ok(()),
        };
        report.skip(refused.err().map(|why| why.name()));
    })?;
    judge.finish(&mut report);
    report.count(pilot.tally());
    report.wall_s = begun.elapsed().as_secs_f64();
    Ok(report)
}

/// What is known of the recording's truth, and how far the estimates were from it.
struct Judge<'a> {
    reference: Reference<'a>,
    score: Score,
    dead_reckoning: Score,
    /// When odometry first came, where its frame was at the first known pose, and what it said last.
    first: Option<Stamp>,
    map_from_odom: Option<Pose<Map, Odom, f64>>,
    last: Option<(Stamp, Pose<Odom, Body, f64>)>,
    was_lost: bool,
}

impl<'a> Judge<'a> {
    fn new(poses: &'a [StampedPose]) -> Self {
        Self {
            reference: Reference::new(poses),
            score: Score::default(),
            dead_reckoning: Score::default(),
            first: None,
            map_from_odom: None,
            last: None,
            was_lost: false,
        }
    }

    fn rolled(&mut self, stamp: Stamp, odometry: Pose<Odom, Body, f64>, report: &mut ReplayReport) {
        report.steps += 1;
        if let Some((_, last)) = self.last {
            report.distance_m += motion_between(last, odometry).length.abs();
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

    fn ticked(&mut self, ticked: &Report, report: &mut ReplayReport) {
        if ticked.health == Health::Lost {
            (self.was_lost, report.found_s) = (true, None);
            return;
        }
        if self.was_lost && report.found_s.is_none() {
            report.found_s = self.first.map(|first| ticked.stamp.since(first));
        }
        if let Some(truth) = self.reference.at(ticked.stamp.seconds()) {
            self.score.add(ticked.belief.error(truth));
            self.score.add_nees(ticked.belief.nees(truth));
        }
    }

    fn finish(self, report: &mut ReplayReport) {
        if let (Some(first), Some((last, _))) = (self.first, self.last) {
            report.duration_s = last.since(first);
        }
        report.judge(self.score.summary());
        report.judge_dead_reckoning(self.dead_reckoning.summary());
    }
}
