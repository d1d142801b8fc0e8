//! Global localization: from visible walls to one pose, or to several poses that explain them equally well.
//!
//! Each scan proposes poses. Two crossing lines, associated with two walls of the map, fix one pose. With a
//! [`DistanceField`] of the map, every pose of a lattice is tried as well. A proposal that explains the scan beam by
//! beam becomes a hypothesis with its own [`Belief`]. Odometry predicts it and the beams correct it. Its score is the
//! agreement of the map with the present scan and with a few keyframes ([`BeamSubset`]).
//! The robot is localized when one hypothesis explains all of them and every other explains them far worse. Poses at
//! places that look alike remain ambiguous until the robot moves, for example turns, to where they differ.
//!
//! Memory is fixed: `N` hypotheses, `N` proposals, [`MAX_ODOMETRY_INCREMENTS`] odometry increments, `FRAMES` keyframes.
//! A scan makes at most [`MAX_LINE_PAIRS`] · (2 · walls)² proposals; a comparison of directions rejects nearly all.
//! [`BeamSubset::evaluate`] runs once for each of the others, up to 2 · `FRAMES` + 2 times for each hypothesis, and 5 ·
//! `FRAMES` + 5 times for each new one. The lattice is searched for each new keyframe: at most 10⁴ look-ups for each of
//! its positions.

mod correlative_search;
mod hypothesis_evaluator;
mod keyframes;
mod line_pairs;
mod odometry_buffer;
mod top_candidates;

use crate::estimation::{Belief, Ekf, HeadingMeasurement, WheelOdometry};
use crate::geometry::{Body, Laser, Map, Pose};
use crate::lidar::{BeamSubset, ExtractedLine, RangeFinder, Scan};
use crate::linalg::Covariance;
use crate::map::{DistanceField, Wall};
use crate::scalar::Float;
use crate::time::{Stamp, Stamped};
pub use hypothesis_evaluator::Hypothesis;
pub use line_pairs::MAX_LINE_PAIRS;
pub use odometry_buffer::MAX_ODOMETRY_INCREMENTS;

use correlative_search::ScanTemplate;
use hypothesis_evaluator::HypothesisEvaluator;
use keyframes::{BEAMS, KeyframeBuffer};
use line_pairs::{HeadingPrior, for_each_line_pair_pose};
use odometry_buffer::OdometryBuffer;
use top_candidates::{MERGE_TOLERANCE, TopCandidates, is_near};

/// Maximum consecutive scans that no hypothesis explains together with the keyframes; then the keyframes are dropped.
const MAX_UNEXPLAINED_SCANS: u16 = 15;

/// Maximum age of a heading measurement for a scan \[s], and maximum turn of the robot in that time \[rad].
const HEADING_AGE: f64 = 0.2;
const HEADING_TURN: f64 = 0.15;

/// Acceptance criteria for the pose of the global search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AcceptanceCriteria<S> {
    /// Minimum fraction of explained beams, 0 to 1.
    pub min_hit_ratio: S,
    /// Maximum fraction of beams that end behind the walls, 0 to 1.
    pub max_behind_wall_ratio: S,
    /// Minimum distance of the robot center from every wall \[m].
    pub min_clearance: S,
    /// Minimum excess of −2 log likelihood over all keyframes, of every other hypothesis.
    pub min_margin: S,
    /// Additional excess as a fraction of the −2 log likelihood of the best hypothesis: a misfit may fit elsewhere by
    /// chance.
    pub min_relative_margin: S,
    /// Minimum number of consecutive scans that meet the criteria.
    pub min_scans: u16,
    /// Minimum turn of the robot since the first keyframe \[rad]. Places may differ only outside a field of view of
    /// 180°.
    pub min_rotation: S,
}

impl<S: Float> Default for AcceptanceCriteria<S> {
    /// 0.6 explained beams, amid clutter that hides 0.2; e¹⁵ times as likely as any other pose; a quarter turn.
    fn default() -> Self {
        Self {
            min_hit_ratio: S::from_f64(0.6),
            max_behind_wall_ratio: S::from_f64(0.08),
            min_clearance: S::from_f64(0.15),
            min_margin: S::from_f64(30.0),
            min_relative_margin: S::from_f64(0.05),
            min_scans: 5,
            min_rotation: S::from_f64(core::f64::consts::FRAC_PI_2),
        }
    }
}

/// Status of the global search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GlobalStatus<S> {
    /// No pose explains the scans, or the scans contain too little information.
    NoHypothesis,
    /// Several hypotheses, or one that does not meet all criteria yet; their number.
    Ambiguous(usize),
    /// Belief of the accepted hypothesis, at the time of the last scan.
    Localized(Belief<S>),
}

/// Global localizer with up to `N` hypotheses, evaluated with up to `FRAMES` keyframes.
#[derive(Clone, Copy, Debug)]
///
/// ```no_run
/// # use surepose::{estimation::{Belief, WheelOdometry}, lidar::{ExtractedLine, RangeFinder, Scan}};
/// # use surepose::{localization::{GlobalLocalizer, GlobalStatus}, map::Wall, time::Stamp};
/// # fn locate(localizer: &mut GlobalLocalizer<f64>, laser: &RangeFinder<f64>, walls: &[Wall<f64>], stamp: Stamp,
/// #     odometry: WheelOdometry<f64>, scan: &Scan<'_, f64>, lines: &[ExtractedLine<f64>]) -> Option<Belief<f64>> {
/// localizer.on_odometry(stamp, odometry);
/// match localizer.update(stamp, laser, scan, lines, walls, None) {
///     GlobalStatus::Localized(belief) => Some(belief),
///     GlobalStatus::NoHypothesis | GlobalStatus::Ambiguous(_) => None,
/// }
/// # }
/// ```
pub struct GlobalLocalizer<S, const N: usize = 24, const FRAMES: usize = 24> {
    ekf: Ekf<S>,
    criteria: AcceptanceCriteria<S>,
    hypotheses: [Option<Hypothesis<S>>; N],
    keyframes: KeyframeBuffer<S, FRAMES>,
    unexplained_scans: u16,
    /// Index of the leading hypothesis, and the number of scans that it has led.
    leader: (usize, u16),
    odometry: OdometryBuffer<S>,
    heading: Option<Stamped<HeadingMeasurement<S>>>,
}

impl<S: Float, const N: usize, const FRAMES: usize> GlobalLocalizer<S, N, FRAMES> {
    /// Localizer without hypotheses at `stamp`.
    pub fn new(ekf: Ekf<S>, criteria: AcceptanceCriteria<S>, stamp: Stamp) -> Self {
        const { assert!(N > 0 && FRAMES > 0, "`N` and `FRAMES`: capacity is 0, expected at least 1") };
        let odometry = OdometryBuffer::new(stamp);
        let keyframes = KeyframeBuffer::new();
        Self {
            ekf,
            criteria,
            hypotheses: [None; N],
            keyframes,
            unexplained_scans: 0,
            leader: (0, 0),
            odometry,
            heading: None,
        }
    }

    /// Deletes every hypothesis: the robot may be anywhere.
    pub fn reset(&mut self, stamp: Stamp) {
        *self = Self::new(self.ekf, self.criteria, stamp);
    }

    /// Adds the odometry up to `stamp`.
    pub fn on_odometry(&mut self, stamp: Stamp, travel: WheelOdometry<S>) {
        self.odometry.push(stamp, travel);
    }

    /// Sets the latest heading measurement.
    pub fn set_heading(&mut self, heading: Stamped<HeadingMeasurement<S>>) {
        if heading.value.heading.radians().is_finite() && heading.value.std > S::from_f64(0.0) {
            self.heading = Some(heading);
        }
    }

    /// Time of the last scan, for which the hypotheses and the status hold.
    pub fn stamp(&self) -> Stamp {
        self.odometry.start()
    }

    /// Candidate poses.
    pub fn hypotheses(&self) -> impl Iterator<Item = &Hypothesis<S>> {
        self.hypotheses.iter().flatten()
    }

    /// Updates the hypotheses by a scan at `stamp` and the `lines` extracted from it.
    ///
    /// A scan older than the last one, or an invalid one, changes nothing.
    pub fn update(
        &mut self,
        stamp: Stamp,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
        lines: &[ExtractedLine<S>],
        walls: &[Wall<S>],
        field: Option<&DistanceField<'_, S>>,
    ) -> GlobalStatus<S> {
        let Ok(beams) = BeamSubset::<S, BEAMS>::from_scan(laser, scan) else { return self.status() };
        if stamp < self.odometry.start() {
            return self.status();
        }
        let heading_prior = self.heading_prior(stamp);
        let travels = self.odometry.take_until(stamp);
        for travel in travels.iter() {
            self.keyframes.on_odometry(&self.ekf, travel);
        }
        let keyframes = self.keyframes;
        let evaluator = HypothesisEvaluator { ekf: self.ekf, walls, beams: &beams, keyframes: &keyframes };
        for slot in &mut self.hypotheses {
            if let Some(hypothesis) = slot {
                for travel in travels.iter() {
                    hypothesis.belief = self.ekf.predict(hypothesis.belief, *travel);
                }
                let scans = hypothesis.scans.saturating_add(1);
                *hypothesis = evaluator.evaluate(hypothesis.belief, scans);
                if !heading_prior.contains(hypothesis.belief.pose.heading) {
                    *slot = None;
                }
            }
        }
        self.add(
            &evaluator,
            &line_pair_candidates::<S, N>(&beams, lines, walls, &laser.body_from_laser, &heading_prior),
        );
        let kept = self.keyframes.insert_if_new(&beams);
        if let Some(field) = field.filter(|_| kept) {
            let template =
                ScanTemplate::from_points(self.keyframes.endpoints(), self.keyframes.endpoints().count());
            let mut found = TopCandidates::<S, N>::new();
            let mut rank = S::from_f64(0.0);
            template.correlative_search(field, &heading_prior, self.criteria.min_clearance, |pose| {
                found.insert(pose, rank);
                rank = rank + S::from_f64(1.0);
            });
            self.add(&evaluator, &found);
        }
        self.merge();
        self.drop_rejected(walls);
        self.reset_stale_keyframes();
        self.leader = self.leading_hypothesis().map_or((0, 0), |(number, held)| {
            let scans = if number == self.leader.0 { self.leader.1.saturating_add(1) } else { 1 };
            // The slot may have held another hypothesis before.
            (number, scans.min(held))
        });
        self.refine_leader(&evaluator);
        self.status()
    }

    /// Refines the leading pose with all keyframes; the last scans alone may leave a small error.
    fn refine_leader(&mut self, evaluator: &HypothesisEvaluator<'_, S, FRAMES>) {
        let GlobalStatus::Localized(belief) = self.status() else { return };
        if let Some(Some(found)) = self.hypotheses.get_mut(self.leader.0) {
            found.belief = evaluator.refine_accepted(belief.pose);
        }
    }

    /// Drops the keyframes where no hypothesis explains them together with the present scans.
    fn reset_stale_keyframes(&mut self) {
        let enough = self.criteria.min_hit_ratio;
        let explained = self.hypotheses().any(|known| known.stats.hit_ratio() >= enough);
        self.unexplained_scans = if explained { 0 } else { self.unexplained_scans + 1 };
        if self.unexplained_scans >= MAX_UNEXPLAINED_SCANS {
            self.keyframes = KeyframeBuffer::new();
            self.unexplained_scans = 0;
        }
    }

    /// Range of headings at `stamp` from the last heading measurement.
    fn heading_prior(&self, stamp: Stamp) -> HeadingPrior<S> {
        let new_hypothesis = self.heading.filter(|heading| stamp.since(heading.stamp).abs() <= HEADING_AGE);
        new_hypothesis.map_or(HeadingPrior::unconstrained(), |heading| {
            let reach = S::from_f64(4.0) * heading.value.std + S::from_f64(HEADING_TURN);
            HeadingPrior::from_heading(heading.value.heading, reach)
        })
    }

    /// Adds the candidates as hypotheses; a better one replaces the worst.
    fn add(&mut self, evaluator: &HypothesisEvaluator<'_, S, FRAMES>, candidates: &TopCandidates<S, N>) {
        for pose in candidates.poses() {
            let known = self.hypotheses().find(|known| is_same(known.belief.pose, pose));
            // A hypothesis with a poor fit does not block a better one nearby.
            if known.is_some_and(|known| known.stats.hit_ratio() >= self.criteria.min_hit_ratio) {
                continue;
            }
            let new_hypothesis = evaluator.evaluate(evaluator.refine(pose), 1);
            if !new_hypothesis.stats.neg2_log_likelihood.is_finite() {
                continue;
            }
            let slot = match self.hypotheses.iter_mut().find(|slot| slot.is_none()) {
                Some(free) => Some(free),
                None => self.hypotheses.iter_mut().max_by(|a, b| {
                    neg2_log_likelihood(a.as_ref()).total_cmp(&neg2_log_likelihood(b.as_ref()))
                }),
            };
            let is_worse = |slot: &&mut Option<Hypothesis<S>>| {
                slot.is_none_or(|worst| {
                    new_hypothesis.stats.neg2_log_likelihood < worst.stats.neg2_log_likelihood
                })
            };
            if let Some(slot) = slot.filter(is_worse) {
                *slot = Some(new_hypothesis);
            }
        }
    }

    /// Merges hypotheses that converged. The one with more scans remains, unless the other fits far better; that one
    /// then takes over its slot.
    fn merge(&mut self) {
        for i in 0..N {
            for j in 0..i {
                let (Some(a), Some(b)) = (self.hypotheses[i], self.hypotheses[j]) else { continue };
                if is_same(a.belief.pose, b.belief.pose) {
                    let is_elder = a.scans > b.scans;
                    let (elder, younger) = if is_elder { (a, b) } else { (b, a) };
                    let stays = younger.stats.neg2_log_likelihood + self.criteria.min_margin
                        > elder.stats.neg2_log_likelihood;
                    let (kept, left) = if is_elder { (i, j) } else { (j, i) };
                    let better = if stays { elder } else { younger };
                    self.hypotheses[kept] = Some(Hypothesis { scans: elder.scans, ..better });
                    self.hypotheses[left] = None;
                }
            }
        }
    }

    /// Drops hypotheses that explain too few beams, or that lie too close to a wall.
    fn drop_rejected(&mut self, walls: &[Wall<S>]) {
        let clearance = self.criteria.min_clearance;
        let is_rejected = |known: Hypothesis<S>| {
            let place = known.belief.pose.origin();
            known.stats.hit_ratio() < S::from_f64(0.35)
                || walls.iter().any(|wall| wall.distance(place) < clearance)
        };
        for slot in &mut self.hypotheses {
            if slot.is_some_and(is_rejected) {
                *slot = None;
            }
        }
    }

    /// Present status.
    pub fn status(&self) -> GlobalStatus<S> {
        let (number, scans) = self.leader;
        let is_held = scans >= self.criteria.min_scans.max(1)
            && self.keyframes.rotation() >= self.criteria.min_rotation;
        match (self.hypotheses().count(), self.hypotheses.get(number).copied().flatten()) {
            (0, _) => GlobalStatus::NoHypothesis,
            (_, Some(best)) if is_held => GlobalStatus::Localized(best.belief),
            (count, _) => GlobalStatus::Ambiguous(count),
        }
    }

    /// Index of the hypothesis that explains all scans far better than every other, and its number of scans.
    fn leading_hypothesis(&self) -> Option<(usize, u16)> {
        let criteria = &self.criteria;
        let costs = || self.hypotheses.iter().map(|slot| neg2_log_likelihood(slot.as_ref())).enumerate();
        let (number, least) = costs().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let Hypothesis { stats: best, scans, .. } = self.hypotheses.get(number).copied().flatten()?;
        let explains = best.hit_ratio() >= criteria.min_hit_ratio
            && best.behind_wall_ratio() <= criteria.max_behind_wall_ratio;
        let enough =
            least + (criteria.min_margin + criteria.min_relative_margin * best.neg2_log_likelihood).to_f64();
        let alone = costs().all(|(other, cost)| other == number || cost > enough);
        (explains && alone).then_some((number, scans))
    }
}

/// Candidate poses from which two lines of the scan lie on walls and most beams are explained.
fn line_pair_candidates<S: Float, const N: usize>(
    beams: &BeamSubset<S, BEAMS>,
    lines: &[ExtractedLine<S>],
    walls: &[Wall<S>],
    body_from_laser: &Pose<Body, Laser, S>,
    heading_prior: &HeadingPrior<S>,
) -> TopCandidates<S, N> {
    let quick = beams.decimated();
    let uncertain = Covariance::from_std([S::from_f64(0.05), S::from_f64(0.05), S::from_f64(0.02)]);
    let mut candidates = TopCandidates::new();
    for_each_line_pair_pose(lines, walls, body_from_laser, heading_prior, |pose| {
        let seen = quick.evaluate(pose, &uncertain, walls);
        if seen.hit_ratio() > S::from_f64(0.4) {
            candidates.insert(pose, seen.neg2_log_likelihood);
        }
    });
    candidates
}

/// Cost of a slot; a free slot is worse than any hypothesis.
fn neg2_log_likelihood<S: Float>(slot: Option<&Hypothesis<S>>) -> f64 {
    slot.map_or(f64::INFINITY, |known| known.stats.neg2_log_likelihood.to_f64())
}

fn is_same<S: Float>(a: Pose<Map, Body, S>, b: Pose<Map, Body, S>) -> bool {
    is_near(a, b, MERGE_TOLERANCE)
}
