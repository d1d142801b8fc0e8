//! Follows a log from scan to scan with the supervised loop, and judges the estimate.

use std::time::Instant;

use surepose::estimation::{Belief, MeasurementOutcome};
use surepose::geometry::{Body, Map, Pose};
use surepose::kinematics::Motion;
use surepose::map::Wall;
use surepose::safety::Health;
use surepose::time::Stamp;
use surepose_io::recording::{Recording, ScanRecord, StampedPose};
use surepose_sim::ErrorAccumulator;

use super::lag::ScanLag;
use super::wide_search::WideSearch;
use crate::laser_replay::{LaserReplay, LaserReplaySettings, ScanOutcome, beam_ends, scan_view};
use crate::odometry::RecordedOdometry;
use crate::report::ReplayReport;
use crate::track::Track;

/// Scans in succession that contradict the map before the robot counts as lost.
const MAX_CONTRADICTIONS: u32 = 3;
/// Agreeing scans after a search until its pose is trusted.
const CONFIRMATIONS: u32 = 2;
/// Standard deviations of a pose found around a wrong estimate: x \[m], y \[m], θ \[rad].
const FOUND_STD: [f64; 3] = [0.1, 0.1, 0.05];
/// Smallest fraction of explained beams of a scan that agrees with the map, relative to the mean of such scans; that mean
/// at the start, and how far a scan changes it.
const MIN_HIT_RATIO: f64 = 0.72;
const USUAL_HIT_RATIO: f64 = 0.85;
const HIT_RATIO_GAIN: f64 = 0.05;
/// Standard deviation of the heading's displacement \[rad].
const HEADING_STD: f64 = 1.5;
/// Displacement of a robot whose odometry is wrong: at least, per meter driven, and at most \[m].
const MIN_RADIUS: f64 = 0.6;
const DISPLACEMENT: f64 = 2.0;
const MAX_RADIUS: f64 = 2.0;

/// Records around a scan whose motion is before or after it, as the lag may be.
const SCAN_RECORDS: f64 = 1.5;

/// Fraction of the beams that the map explains; 0 without a match.
fn hit_ratio(seen: &ScanOutcome) -> f64 {
    match seen {
        ScanOutcome::Evaluated(_, stats) => stats.hit_ratio(),
        _ => 0.0,
    }
}

/// State of a replay. Its clock counts odometry records: in some logs the stamps are unusable, but the order is right.
pub(super) struct SupervisedReplay {
    odometry: RecordedOdometry,
    lag: ScanLag,
    replay: LaserReplay,
    report: ReplayReport,
    track: Track,
    dead_reckoning: ErrorAccumulator,
    /// Records up to which odometry has been used.
    rolled: f64,
    raw_start: Pose<Map, Body, f64>,
    start: Pose<Map, Body, f64>,
    before: Option<Pose<Map, Body, f64>>,
    /// Whether the last scan agreed with the map; `false` also for a pose that a search has just found.
    is_trusted: bool,
    /// Number of agreeing scans until a pose from a search is trusted.
    unconfirmed: u32,
    /// Mean fraction of explained beams of scans that agree with the map.
    hit_ratio: f64,
    /// Scans in succession that contradicted the map, and length of the path since one agreed \[m].
    contradictions: u32,
    since_agreement: f64,
}

impl SupervisedReplay {
    /// Starts at the first scan.
    pub(super) fn new(
        log: &Recording<StampedPose>,
        odometry: RecordedOdometry,
        lag: ScanLag,
        walls: Vec<Wall<f64>>,
        settings: LaserReplaySettings,
        start: Option<Pose<Map, Body, f64>>,
    ) -> Self {
        let first = log.scans.first().map_or(0, |scan| scan.odometry_before);
        let rolled = odometry.before(first, lag.records);
        let raw_start = odometry.pose_after(rolled).unwrap_or_default();
        let truth = log.reference.first().map(crate::odometry::pose_of);
        let known = start.or(truth);
        let start = known.unwrap_or_default();
        let mut replay = LaserReplay::supervised(walls, settings, Stamp::from_seconds(rolled), start);
        if known.is_none() {
            replay.localizer.mark_lost();
        }
        let mut report = ReplayReport::default();
        for (kind, count) in &log.irregular {
            report.skipped.insert(kind, *count);
        }
        let ends = |wall: &Wall<f64>| wall.ends().map(|end| (end.x, end.y));
        let track = Track { walls: replay.walls().iter().map(ends).collect(), ..Track::default() };
        Self {
            odometry,
            lag,
            replay,
            report,
            track,
            dead_reckoning: ErrorAccumulator::default(),
            rolled,
            raw_start,
            start,
            before: truth,
            is_trusted: true,
            unconfirmed: 0,
            hit_ratio: USUAL_HIT_RATIO,
            contradictions: 0,
            since_agreement: 0.0,
        }
    }

    /// Predicts until `count` records of odometry have been used.
    pub(super) fn roll(&mut self, count: usize) {
        let until = count as f64;
        let taken = self.odometry.before(count, self.lag.records);
        while self.rolled < until {
            let from = self.rolled;
            self.rolled = (libm::floor(from) + 1.0).min(until);
            let [Some(before), Some(after)] =
                [from, self.rolled].map(|count| self.odometry.pose_after(count))
            else {
                continue;
            };
            self.since_agreement += before.origin().distance(after.origin());
            let record = libm::ceil(self.rolled) as usize;
            if self.odometry.is_gap(record) {
                let unseen = self.odometry.unseen_motion(record);
                let motions = Motion::turn_drive_turn(before, after);
                let part = (self.rolled - from) / motions.len() as f64;
                for (k, motion) in motions.into_iter().enumerate() {
                    let stamp = from + (k as f64 + 1.0) * part;
                    self.replay.predict_over_gap(Stamp::from_seconds(stamp), motion, unseen);
                }
            } else {
                let motion = Motion::between(before, after);
                let is_scanned = (self.rolled - taken).abs() <= SCAN_RECORDS;
                let timing_std = if is_scanned { self.lag.std } else { 0.0 };
                self.replay.predict_with_timing(Stamp::from_seconds(self.rolled), motion, timing_std);
            }
            self.report.steps += 1;
        }
    }

    /// Adds the way to the next reference pose.
    pub(super) fn drive_to(&mut self, truth: Option<Pose<Map, Body, f64>>) {
        if let (Some(before), Some(truth)) = (self.before, truth) {
            self.report.distance_m += before.origin().distance(truth.origin());
        }
        self.before = truth.or(self.before);
    }

    /// Corrects by `scan`, and judges the estimate against `truth`.
    pub(super) fn see(&mut self, scan: &ScanRecord, truth: Option<Pose<Map, Body, f64>>) {
        let at = self.odometry.before(scan.odometry_before, self.lag.records);
        let stamp = Stamp::from_seconds(at);
        let believed = self.replay.localizer.estimator().belief_at(stamp);
        let mut seen = self.replay.correct(stamp, scan);
        let was_lost = self.replay.localizer.health() == Health::Lost;
        let mut is_new = false;
        // People in front of the laser explain one contradicting scan better than a wrong pose does.
        let is_contradicted = self.contradictions > 0 && !self.agrees(&seen);
        if let Some(believed) = believed
            && (was_lost || is_contradicted)
            && let Some(found) = self.search(scan, believed.pose)
        {
            self.replay.localizer.reset_at(stamp, Belief::new(found.pose, FOUND_STD));
            seen = self.replay.correct(stamp, scan);
            is_new = true;
            self.report.relocalizations = Some(self.report.relocalizations.unwrap_or(0) + 1);
        }
        self.replay.adapt_odometry_noise(&seen);
        if self.agrees(&seen) {
            self.hit_ratio += (hit_ratio(&seen) - self.hit_ratio) * HIT_RATIO_GAIN;
            // The next scans, from other places, confirm a pose that was searched.
            self.unconfirmed = if is_new { CONFIRMATIONS } else { self.unconfirmed.saturating_sub(1) };
            self.is_trusted = self.unconfirmed == 0;
            (self.contradictions, self.since_agreement) = (0, 0.0);
        } else {
            self.is_trusted = false;
            self.unconfirmed = self.unconfirmed.max(1);
            self.contradictions += 1;
            if self.contradictions == MAX_CONTRADICTIONS {
                self.replay.localizer.mark_lost();
            }
        }
        self.report.skip(seen.skip_reason());
        let is_lost = self.replay.localizer.health() == Health::Lost;
        let is_trusted = self.is_trusted && !is_lost;
        if !is_trusted {
            self.report.skip(Some(if is_lost { "lost" } else { "contradicts_map" }));
        }
        if let Some(belief) = self.replay.localizer.estimator().belief_at(stamp) {
            let time = if self.odometry.period > 0.0 { scan.time } else { at };
            self.track.add(time, &belief, truth, is_trusted);
            if is_trusted {
                self.track.beam_ends.extend(beam_ends(scan, belief.pose));
            }
        }
        let Some(truth) = truth else { return };
        if let Some(now) = self.odometry.pose_after(at) {
            let dead = self.start * (self.raw_start.inverse() * now);
            let heading = (dead.heading - truth.heading).radians();
            self.dead_reckoning.add([dead.x - truth.x, dead.y - truth.y, heading]);
        }
    }

    /// Whether the filter accepted the scan, and the map explains as much of it as usual.
    fn agrees(&self, seen: &ScanOutcome) -> bool {
        let is_accepted = matches!(seen, ScanOutcome::Evaluated(MeasurementOutcome::Accepted { .. }, _));
        is_accepted && hit_ratio(seen) >= MIN_HIT_RATIO * self.hit_ratio
    }

    /// Searches around `pose`, as far as odometry may be wrong since a scan agreed with the map.
    fn search(&self, scan: &ScanRecord, pose: Pose<Map, Body, f64>) -> Option<Belief<f64>> {
        let estimator = self.replay.localizer.estimator();
        let view = scan_view(scan);
        let laser = self.replay.localizer.scan_processor().laser_of(&view);
        let search = WideSearch {
            matcher: self.replay.beam_model(),
            ekf: estimator.ekf(),
            laser: &laser,
            walls: self.replay.walls(),
            min_hit_ratio: MIN_HIT_RATIO * self.hit_ratio,
            heading_std: HEADING_STD,
            radius: (MIN_RADIUS + DISPLACEMENT * self.since_agreement).min(MAX_RADIUS),
        };
        search.find(&view, pose)
    }

    /// Returns the report.
    pub(super) fn finish(mut self, log: &Recording<StampedPose>, begun: Instant) -> ReplayReport {
        self.report.duration_s = log.duration();
        self.report.scan_lag_records = Some(self.lag.records);
        self.report.scan_lag_std_records = Some(self.lag.std);
        self.report.set_track(self.track, (!log.reference.is_empty()).then_some(0.0));
        self.report.set_odometry_errors(self.dead_reckoning.summary());
        self.report.count(self.replay.localizer.estimator().measurement_stats());
        self.report.wall_s = begun.elapsed().as_secs_f64();
        self.report
    }
}
