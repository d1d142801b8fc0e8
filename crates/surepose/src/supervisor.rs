//! The supervisor: beside the loop, never inside it. It watches, and can only slow the robot down or stop it.
//!
//! It is told what became of odometry, measurements, scans and wheels, and says how far the estimate can be trusted
//! ([`Health`]) and what that means for the wheels ([`Verdict`], with a [`Reason`] that has a name). Being lost is
//! latched: the estimate is trusted again only when somebody found the robot and says so ([`Supervisor::found`]).

mod vigilance;

use crate::drive::Wheels;
use crate::estimate::{Belief, Outcome, Refusal, Stamp};
use crate::laser::Agreement;
use crate::scalar::Float;

pub use vigilance::Vigilance;

/// How far the estimate can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Health {
    /// What is sensed agrees with it.
    Healthy,
    /// Something does not, or has not been asked for long.
    Doubtful,
    /// It is wrong, or there is none.
    Lost,
}

/// What the wheels may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// What the controller grants.
    Go,
    /// The same, slower.
    Slow(Reason),
    /// Nothing.
    Stop(Reason),
}

/// Why the robot was slowed down or stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reason {
    /// The map does not explain what is seen from where the robot thinks it is.
    Lost,
    /// Odometry says nothing, or nothing that can be used.
    OdometrySilent,
    /// Nothing but odometry has been heard for long.
    Unaided,
    /// Measurements disagree with the estimate more than their noise can.
    Inconsistent,
    /// The estimate is too vague.
    Uncertain,
    /// The wheels do not turn as they are told to.
    WheelsNotFollowing,
}

impl Reason {
    /// The name used in reports and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lost => "lost",
            Self::OdometrySilent => "odometry_silent",
            Self::Unaided => "unaided",
            Self::Inconsistent => "inconsistent",
            Self::Uncertain => "uncertain",
            Self::WheelsNotFollowing => "wheels_not_following",
        }
    }
}

impl Verdict {
    /// The factor on the speed of both wheels: the path stays what the law made it.
    pub fn pace<S: Float>(self) -> S {
        S::of(match self {
            Self::Go => 1.0,
            Self::Slow(_) => 0.3,
            Self::Stop(_) => 0.0,
        })
    }
}

/// What a supervisor has seen so far. It holds a few numbers, and no call does more than a few operations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervisor<S> {
    vigilance: Vigilance<S>,
    /// When odometry last said something, and when a measurement was last accepted.
    rolled: Stamp,
    aided: Stamp,
    /// How many more scans, of the last ones, contradicted the map than agreed with it; likewise measurements.
    scans_against: u16,
    measurements_against: u16,
    /// The mean normalised innovation squared per row, of measurements and of whole scans, and the mean following error
    /// \[rad/s], of the recent past.
    innovation: S,
    off: S,
    following: S,
    lost: bool,
}

impl<S: Float> Supervisor<S> {
    /// Nothing is wrong at `stamp`.
    pub fn new(vigilance: Vigilance<S>, stamp: Stamp) -> Self {
        Self {
            vigilance,
            rolled: stamp,
            aided: stamp,
            scans_against: 0,
            measurements_against: 0,
            innovation: S::of(1.0),
            off: S::of(1.0),
            following: S::of(0.0),
            lost: false,
        }
    }

    /// What became of a stretch of odometry that ends at `stamp`: the time that counts from now on, if the clock was set back.
    pub fn rolled(&mut self, stamp: Stamp, outcome: Result<(), Refusal>) {
        if outcome.is_ok() {
            self.rolled = stamp;
            self.aided = self.aided.min(stamp);
        }
    }

    /// What became of a measurement with `rows` rows, taken at `stamp`.
    pub fn measured(&mut self, stamp: Stamp, outcome: Outcome, rows: usize) {
        match outcome {
            Outcome::Accepted { nis } => {
                self.aided = self.aided.max(stamp);
                self.measurements_against = self.measurements_against.saturating_sub(1);
                let per_row = S::of(nis / rows.max(1) as f64);
                self.innovation = mean(self.innovation, per_row);
            }
            Outcome::Refused(Refusal::Outlier) => {
                self.measurements_against = (self.measurements_against + 1).min(self.vigilance.measurements);
            }
            Outcome::Refused(_) => {}
        }
        self.lost = self.lost || self.measurements_against >= self.vigilance.measurements;
    }

    /// Whether a scan that agrees so with the map is against it.
    pub fn is_against(&self, agreement: &Agreement<S>) -> bool {
        let vigilance = &self.vigilance;
        // Beams that are missing are as good as any that end beyond the walls.
        let all = S::of(f64::from(agreement.beams.saturating_add(agreement.missing)));
        let explained = S::of(f64::from(agreement.explained));
        explained < vigilance.explained * all || agreement.beyond_share() > vigilance.beyond
    }

    /// How a scan agrees with the map at the pose that was believed when it was taken, and how far off it puts the robot:
    /// the normalised innovation squared of what its beams together ask for, per row.
    pub fn looked(&mut self, agreement: &Agreement<S>, off: S) {
        let vigilance = &self.vigilance;
        if agreement.beams.saturating_add(agreement.missing) < vigilance.fewest_beams {
            return;
        }
        // One scan may be broken, and weighs no more than one that is just outside a gate. A NaN compares false.
        if off >= S::of(0.0) {
            let weight = S::of(1.0 / f64::from(vigilance.scans.max(1)));
            self.off = self.off + (off.min(S::of(MOST_OFF)) - self.off) * weight;
        }
        let against = self.off > vigilance.innovation || self.is_against(agreement);
        self.scans_against = if against {
            (self.scans_against + 1).min(vigilance.scans)
        } else {
            self.scans_against.saturating_sub(1)
        };
        self.lost = self.lost || self.scans_against >= vigilance.scans;
    }

    /// How fast the wheels were told to turn, and how fast they did \[rad/s].
    pub fn followed(&mut self, told: Wheels<S>, did: Wheels<S>) {
        let off = Wheels::new(did.right - told.right, did.left - told.left).largest();
        if off.is_finite() {
            self.following = mean(self.following, off);
        }
    }

    /// The robot was found and the estimator restarted, at `stamp`.
    pub fn found(&mut self, stamp: Stamp) {
        let (rolled, following) = (self.rolled.max(stamp), self.following);
        *self = Self { rolled, following, ..Self::new(self.vigilance, stamp) };
    }

    /// Somebody says that the robot was moved, or it starts without a pose.
    pub fn lose(&mut self) {
        self.lost = true;
    }

    /// How far the estimate can be trusted at `now`.
    pub fn health(&self, now: Stamp, belief: &Belief<S>) -> Health {
        match self.finding(now, belief) {
            Some(Reason::Lost) => Health::Lost,
            Some(Reason::WheelsNotFollowing) | None if self.scans_against == 0 => Health::Healthy,
            _ => Health::Doubtful,
        }
    }

    /// What the wheels may do at `now`.
    pub fn verdict(&self, now: Stamp, belief: &Belief<S>) -> Verdict {
        match self.finding(now, belief) {
            None => Verdict::Go,
            Some(reason @ (Reason::Lost | Reason::OdometrySilent)) => Verdict::Stop(reason),
            Some(reason @ Reason::Uncertain) if !is_within(belief, self.vigilance.hopeless) => {
                Verdict::Stop(reason)
            }
            Some(reason) => Verdict::Slow(reason),
        }
    }

    /// What is wrong, the worst first.
    fn finding(&self, now: Stamp, belief: &Belief<S>) -> Option<Reason> {
        let vigilance = &self.vigilance;
        // Odometry of the future is of a clock that was set back since, and says nothing of now.
        let is_heard = (0.0..=vigilance.odometry_age).contains(&now.since(self.rolled));
        let wrong = [
            (self.lost, Reason::Lost),
            (!is_heard, Reason::OdometrySilent),
            (!is_within(belief, vigilance.vague), Reason::Uncertain),
            (self.innovation > vigilance.innovation, Reason::Inconsistent),
            (self.scans_against >= vigilance.scans.div_ceil(2), Reason::Inconsistent),
            (now.since(self.aided) > vigilance.unaided, Reason::Unaided),
            (self.following > vigilance.following, Reason::WheelsNotFollowing),
        ];
        wrong.into_iter().find_map(|(is_wrong, reason)| is_wrong.then_some(reason))
    }
}

/// The most that one scan counts, per row: a consistent one of 10⁶ is farther off, the quantile of χ² with 3 rows.
const MOST_OFF: f64 = 30.7 / 3.0;

/// Whether the position is known to `std` \[m]; a NaN is not.
fn is_within<S: Float>(belief: &Belief<S>, std: S) -> bool {
    (belief.covariance.entry(0, 0) + belief.covariance.entry(1, 1)).sqrt() <= std
}

/// The mean over the last twenty values or so.
fn mean<S: Float>(before: S, now: S) -> S {
    before + (now - before) * S::of(0.05)
}

#[cfg(test)]
mod tests;
