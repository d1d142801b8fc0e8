//! Where am I, if I know nothing? From the walls in view to one pose, or to several as long as several explain them.
//!
//! Each scan proposes poses: two seen lines that cross, taken for two walls of the map, fix one; and where there is a
//! [`Chart`] of the map, every pose of a lattice is tried, so that no place is overlooked. What explains the scan beam by
//! beam becomes a hypothesis: a [`Belief`] of its own, which odometry carries and the beams correct,
//! judged by how well the map explains what is seen from there ([`Glance`]), now and in a few scans that are remembered.
//! A place is found when one hypothesis explains them all and every other explains them far worse. Two places that look
//! alike stay two: somebody has to move until they do not, to turn for instance.
//!
//! Memory is fixed: `N` hypotheses, `N` proposals, [`MOST_STRETCHES`] stretches of odometry, `FRAMES` scans. The work of a
//! scan is bounded by [`MOST_PAIRS`] · (2 · walls)² proposals, nearly all refused by a comparison of directions, one
//! [`Glance::from`] for each that is not, up to 2 · `FRAMES` + 2 for each hypothesis and 5 · `FRAMES` + 5 for each new one.
//! The lattice is tried each time a scan is worth remembering: at most 10⁴ look-ups for each of its places.

mod chart;
mod memory;
mod nudge;
mod pool;
mod propose;
mod search;
mod trail;
mod view;

use crate::angle::Angle;
use crate::covariance::Covariance;
use crate::estimate::{Belief, Compass, Ekf, Stamp, Stamped, Travel};
use crate::frame::{Body, Laser, Map};
use crate::laser::{Agreement, Glance, RangeFinder, Scan, SeenLine, Wall};
use crate::pose::Pose;
use crate::scalar::Float;

pub use chart::{Chart, Extent};
pub use nudge::Nudge;
pub use propose::MOST_PAIRS;
pub use trail::MOST_STRETCHES;

use memory::{BEAMS, Memory};
use pool::Pool;
use propose::{Hint, propose};
use search::Fan;
use trail::Trail;
use view::View;

/// Hypotheses nearer than this \[m], \[rad] are one.
const SAME: (f64, f64) = (0.2, 0.1);

/// So many scans in a row that no hypothesis explains together with the remembered ones: these are of somewhere else.
const BAFFLED: u16 = 15;

/// How old a heading may be to be used for a scan \[s], and how far the robot may turn meanwhile \[rad].
const HEADING_AGE: f64 = 0.2;
const HEADING_TURN: f64 = 0.15;

/// What must hold of the pose that is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certainty<S> {
    /// It explains at least this part of the beams.
    pub explained: S,
    /// At most this part of the beams ends beyond the walls seen from it.
    pub beyond: S,
    /// The robot's middle is at least so far from every wall \[m].
    pub clearance: S,
    /// Every other hypothesis has a misfit larger by this much: −2 log of the likelihood of all scans in mind.
    pub margin: S,
    /// And larger by this part of its own: what does not fit may fit elsewhere by chance.
    pub share: S,
    /// All this held for so many scans in a row.
    pub scans: u16,
    /// The robot turned by so much meanwhile \[rad]: what a half-circle of beams does not see may tell places apart.
    pub turned: S,
}

impl<S: Float> Default for Certainty<S> {
    /// Three fifths explained, among clutter that hides a fifth; e¹⁵ times as likely as any other, after a quarter turn.
    fn default() -> Self {
        Self {
            explained: S::of(0.6),
            beyond: S::of(0.08),
            clearance: S::of(0.15),
            margin: S::of(30.0),
            share: S::of(0.05),
            scans: 5,
            turned: S::of(core::f64::consts::FRAC_PI_2),
        }
    }
}

/// A pose that the robot may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hypothesis<S> {
    /// Where, and how well that is known if it is there at all; at the time of the last scan.
    pub belief: Belief<S>,
    /// How the last scan and those in mind agree with the map from there.
    pub agreement: Agreement<S>,
    /// For how many scans it held.
    pub scans: u16,
}

/// What is known of where the robot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding<S> {
    /// No pose explains what is seen, or nothing that tells is seen.
    Nothing,
    /// This many poses may be it, or one that has not held for long enough.
    Several(usize),
    /// There, at the time of the last scan.
    Found(Belief<S>),
}

/// Looks for the pose with up to `N` hypotheses, held against up to `FRAMES` scans that are remembered.
#[derive(Clone, Copy, Debug)]
pub struct Relocaliser<S, const N: usize = 24, const FRAMES: usize = 24> {
    ekf: Ekf<S>,
    certainty: Certainty<S>,
    hypotheses: [Option<Hypothesis<S>>; N],
    memory: Memory<S, FRAMES>,
    baffled: u16,
    /// The hypothesis that is ahead of all others, by number, and for how many scans.
    ahead: (usize, u16),
    trail: Trail<S>,
    heading: Option<Stamped<Compass<S>>>,
}

impl<S: Float, const N: usize, const FRAMES: usize> Relocaliser<S, N, FRAMES> {
    /// Knows nothing at `stamp`.
    pub fn new(ekf: Ekf<S>, certainty: Certainty<S>, stamp: Stamp) -> Self {
        const { assert!(N > 0 && FRAMES > 0, "where nothing is held, nothing is found") };
        let trail = Trail::starting(stamp);
        let memory = Memory::empty();
        Self {
            ekf,
            certainty,
            hypotheses: [None; N],
            memory,
            baffled: 0,
            ahead: (0, 0),
            trail,
            heading: None,
        }
    }

    /// Forgets every hypothesis: the robot may be anywhere.
    pub fn forget(&mut self, stamp: Stamp) {
        *self = Self::new(self.ekf, self.certainty, stamp);
    }

    /// The robot rolled until `stamp`.
    pub fn roll(&mut self, stamp: Stamp, travel: Travel<S>) {
        self.trail.push(stamp, travel);
    }

    /// The compass said something.
    pub fn turn_to(&mut self, heading: Stamped<Compass<S>>) {
        if heading.value.heading.radians().is_finite() && heading.value.std > S::of(0.0) {
            self.heading = Some(heading);
        }
    }

    /// When the last scan was, for which the hypotheses and what is found hold.
    pub fn stamp(&self) -> Stamp {
        self.trail.start()
    }

    /// The poses that may be it.
    pub fn hypotheses(&self) -> impl Iterator<Item = &Hypothesis<S>> {
        self.hypotheses.iter().flatten()
    }

    /// A scan was taken at `stamp`, and `lines` were found in it.
    ///
    /// A scan from before the last one, or one that cannot be read, changes nothing.
    pub fn look(
        &mut self,
        stamp: Stamp,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
        lines: &[SeenLine<S>],
        walls: &[Wall<S>],
        chart: Option<&Chart<'_, S>>,
    ) -> Finding<S> {
        let Ok(glance) = Glance::<S, BEAMS>::of(laser, scan) else { return self.finding() };
        if stamp < self.trail.start() {
            return self.finding();
        }
        let hint = self.hint(stamp);
        let travels = self.trail.take_until(stamp);
        for travel in travels.iter() {
            self.memory.roll(&self.ekf, travel);
        }
        let memory = self.memory;
        let view = View { ekf: self.ekf, walls, glance: &glance, memory: &memory };
        for slot in &mut self.hypotheses {
            if let Some(hypothesis) = slot {
                for travel in travels.iter() {
                    hypothesis.belief = self.ekf.predict(hypothesis.belief, *travel);
                }
                let scans = hypothesis.scans.saturating_add(1);
                *hypothesis = view.judged(hypothesis.belief, scans);
                if !hint.admits(hypothesis.belief.pose.heading) {
                    *slot = None;
                }
            }
        }
        self.add(&view, &proposed::<S, N>(&glance, lines, walls, &laser.body_from_laser, &hint));
        let kept = self.memory.keep(&glance);
        if let Some(chart) = chart.filter(|_| kept) {
            let fan = Fan::of(self.memory.ends(), self.memory.ends().count());
            let mut found = Pool::<S, N>::empty();
            let mut rank = S::of(0.0);
            fan.search(chart, &hint, self.certainty.clearance, |pose| {
                found.keep(pose, rank);
                rank = rank + S::of(1.0);
            });
            self.add(&view, &found);
        }
        self.merge();
        self.drop_hopeless(walls);
        self.doubt_memory();
        self.ahead = self.best_by_far().map_or((0, 0), |(number, held)| {
            let scans = if number == self.ahead.0 { self.ahead.1.saturating_add(1) } else { 1 };
            // Another hypothesis may have had this number before.
            (number, scans.min(held))
        });
        self.settle_found(&view);
        self.finding()
    }

    /// Puts the place that is found where all scans in mind fit best: the last ones alone may leave it beside that.
    fn settle_found(&mut self, view: &View<'_, S, FRAMES>) {
        let Finding::Found(belief) = self.finding() else { return };
        if let Some(Some(found)) = self.hypotheses.get_mut(self.ahead.0) {
            found.belief = view.found(belief.pose);
        }
    }

    /// Forgets the remembered scans where nothing explains them together with those of now.
    fn doubt_memory(&mut self) {
        let enough = self.certainty.explained;
        let explained = self.hypotheses().any(|known| known.agreement.explained_share() >= enough);
        self.baffled = if explained { 0 } else { self.baffled + 1 };
        if self.baffled >= BAFFLED {
            self.memory = Memory::empty();
            self.baffled = 0;
        }
    }

    /// What the compass allows at `stamp`.
    fn hint(&self, stamp: Stamp) -> Hint<S> {
        let fresh = self.heading.filter(|heading| stamp.since(heading.stamp).abs() <= HEADING_AGE);
        fresh.map_or(Hint::none(), |heading| {
            let reach = S::of(4.0) * heading.value.std + S::of(HEADING_TURN);
            Hint::within(heading.value.heading, reach)
        })
    }

    /// Takes in what was proposed, the best in place of the worst.
    fn add(&mut self, view: &View<'_, S, FRAMES>, pool: &Pool<S, N>) {
        for pose in pool.poses() {
            let known = self.hypotheses().find(|known| is_same(known.belief.pose, pose));
            // One that went astray does not stand in the way of a better one.
            if known.is_some_and(|known| known.agreement.explained_share() >= self.certainty.explained) {
                continue;
            }
            let fresh = view.judged(view.settled(pose), 1);
            if !fresh.agreement.misfit.is_finite() {
                continue;
            }
            let slot = match self.hypotheses.iter_mut().find(|slot| slot.is_none()) {
                Some(free) => Some(free),
                None => self
                    .hypotheses
                    .iter_mut()
                    .max_by(|a, b| misfit(a.as_ref()).total_cmp(&misfit(b.as_ref()))),
            };
            let is_worse = |slot: &&mut Option<Hypothesis<S>>| {
                slot.is_none_or(|worst| fresh.agreement.misfit < worst.agreement.misfit)
            };
            if let Some(slot) = slot.filter(is_worse) {
                *slot = Some(fresh);
            }
        }
    }

    /// Of two hypotheses that came together the elder stays, which has counted more scans, unless the younger fits far
    /// better; that takes its number over.
    fn merge(&mut self) {
        for i in 0..N {
            for j in 0..i {
                let (Some(a), Some(b)) = (self.hypotheses[i], self.hypotheses[j]) else { continue };
                if is_same(a.belief.pose, b.belief.pose) {
                    let is_elder = a.scans > b.scans;
                    let (elder, younger) = if is_elder { (a, b) } else { (b, a) };
                    let stays = younger.agreement.misfit + self.certainty.margin > elder.agreement.misfit;
                    let (kept, left) = if is_elder { (i, j) } else { (j, i) };
                    let better = if stays { elder } else { younger };
                    self.hypotheses[kept] = Some(Hypothesis { scans: elder.scans, ..better });
                    self.hypotheses[left] = None;
                }
            }
        }
    }

    /// Drops what explains next to nothing, and what stands in a wall.
    fn drop_hopeless(&mut self, walls: &[Wall<S>]) {
        let clearance = self.certainty.clearance;
        let is_hopeless = |known: Hypothesis<S>| {
            let place = known.belief.pose.origin();
            known.agreement.explained_share() < S::of(0.35)
                || walls.iter().any(|wall| wall.distance(place) < clearance)
        };
        for slot in &mut self.hypotheses {
            if slot.is_some_and(is_hopeless) {
                *slot = None;
            }
        }
    }

    /// What is known now.
    pub fn finding(&self) -> Finding<S> {
        let (number, scans) = self.ahead;
        let looked_around =
            scans >= self.certainty.scans.max(1) && self.memory.turned() >= self.certainty.turned;
        match (self.hypotheses().count(), self.hypotheses.get(number).copied().flatten()) {
            (0, _) => Finding::Nothing,
            (_, Some(best)) if looked_around => Finding::Found(best.belief),
            (count, _) => Finding::Several(count),
        }
    }

    /// The number of the hypothesis that explains all that is in mind far better than every other, and for how many scans it held.
    fn best_by_far(&self) -> Option<(usize, u16)> {
        let certainty = &self.certainty;
        let misfits = || self.hypotheses.iter().map(|slot| misfit(slot.as_ref())).enumerate();
        let (number, least) = misfits().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let Hypothesis { agreement: best, scans, .. } = self.hypotheses.get(number).copied().flatten()?;
        let explains =
            best.explained_share() >= certainty.explained && best.beyond_share() <= certainty.beyond;
        let enough = least + (certainty.margin + certainty.share * best.misfit).to_f64();
        let alone = misfits().all(|(other, misfit)| other == number || misfit > enough);
        (explains && alone).then_some((number, scans))
    }
}

/// The poses from which two lines of the scan lie on walls, and most of the beams do.
fn proposed<S: Float, const N: usize>(
    glance: &Glance<S, BEAMS>,
    lines: &[SeenLine<S>],
    walls: &[Wall<S>],
    body_from_laser: &Pose<Body, Laser, S>,
    hint: &Hint<S>,
) -> Pool<S, N> {
    let quick = glance.halved();
    let vague = Covariance::from_std([S::of(0.05), S::of(0.05), S::of(0.02)]);
    let mut pool = Pool::empty();
    propose(lines, walls, body_from_laser, hint, |pose| {
        let seen = quick.from(pose, &vague, walls);
        if seen.explained_share() > S::of(0.4) {
            pool.keep(pose, seen.misfit);
        }
    });
    pool
}

/// A free slot is worse than any hypothesis.
fn misfit<S: Float>(slot: Option<&Hypothesis<S>>) -> f64 {
    slot.map_or(f64::INFINITY, |known| known.agreement.misfit.to_f64())
}

fn is_same<S: Float>(a: Pose<Map, Body, S>, b: Pose<Map, Body, S>) -> bool {
    is_near(a, b, SAME)
}

fn is_near<S: Float>(a: Pose<Map, Body, S>, b: Pose<Map, Body, S>, (far, turn): (f64, f64)) -> bool {
    let turned: Angle<S> = a.heading - b.heading;
    a.origin().distance(b.origin()) < S::of(far) && turned.radians().abs() < S::of(turn)
}
