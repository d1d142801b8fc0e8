//! Detects a laser that sends scans and sees nothing.
//!
//! | a scan counts as blind if | until it counts |
//! |---|---|
//! | its angles, its sweep or the geometry of its laser are invalid, or it has no or too many beams | `blind_timeout` |
//! | fewer than `min_valid_beams` of its beams are valid: NaN, −∞, and ranges up to the minimum are not | `blind_timeout` |
//! | the map has walls within reach, and fewer than `min_valid_beams` of the beams there return | `blind_timeout` |
//! | it is bit-identical to the scans before, and odometry moved by more than three noise widths since | at once |
//!
//! A beam without a return, +∞ or 0 or beyond the maximum range, is valid: in open space no beam returns. A scan without
//! returns is blind only where the map has walls within reach, so that the monitor needs a map. Identical scans are
//! normal at rest, and a scan with hardly any returns may stay identical while the robot moves.

use crate::estimation::Belief;
use crate::kinematics::Motion;
use crate::lidar::{MissedReturns, RangeFinder, Scan};
use crate::map::Wall;
use crate::scalar::Float;
use crate::time::Stamp;

/// Maximum number of beams that are compared with the map.
const BEAMS: usize = 128;

/// Minimum number of beams without a return at walls of the map, of which it is concluded that the laser sees nothing.
const MIN_MISSED: u16 = 8;

/// Minimum number of returns of a scan that can be frozen.
const MIN_RETURNS: usize = 5;

/// Maximum distance of a wall that must return a beam, as a fraction of the longest return: farther walls may be too dark.
const REACH_FRACTION: f64 = 0.8;

/// Maximum distance of a wall that must return a beam \[m]: before the first return of the laser, and after it.
const MAX_REACH: [f64; 2] = [5.0, 10.0];

/// Motion that changes the scan of any laser: in noise widths, and at least \[m] and \[rad].
const NOISE_WIDTHS: f64 = 3.0;
const MIN_LENGTH: f64 = 0.05;
const MIN_TURN: f64 = 0.03;

/// Fraction of that motion after which an identical scan is no longer used for localization.
const STUCK_FRACTION: f64 = 0.1;

/// Minimum number of consecutive blind scans.
const MIN_SCANS: u16 = 2;

/// Constants of the laser monitor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserMonitorConfig<S> {
    /// Time for which the laser sends scans that show nothing, after which it counts as blind \[s].
    pub blind_timeout: f64,
    /// Time without a scan after which the laser counts as missing, not as blind \[s].
    pub scan_timeout: f64,
    /// Minimum fraction of the beams that are valid, and of those at walls of the map that return, 0 to 1.
    pub min_valid_beams: S,
}

/// State of the laser by its recent scans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserMonitor<S> {
    config: LaserMonitorConfig<S>,
    /// Longest range that the laser returned so far \[m]; 0 before the first return.
    longest: S,
    /// Fingerprint of the last scan that can be frozen, and the motion since the first scan with it.
    fingerprint: Option<u64>,
    is_repeated: bool,
    moved: Motion<S>,
    /// Consecutive blind scans, and when the first one of them arrived.
    blind_scans: u16,
    blind_since: Option<Stamp>,
    /// Whether the laser is blind; if so, since when its scans are good again.
    is_blind: bool,
    good_since: Option<Stamp>,
    last_scan: Option<Stamp>,
}

impl<S: Float> LaserMonitor<S> {
    /// Monitor that has seen no scan.
    pub fn new(config: LaserMonitorConfig<S>) -> Self {
        let zero = S::from_f64(0.0);
        Self {
            config,
            longest: zero,
            fingerprint: None,
            is_repeated: false,
            moved: Motion { length: zero, turn: zero },
            blind_scans: 0,
            blind_since: None,
            is_blind: false,
            good_since: None,
            last_scan: None,
        }
    }

    /// Takes in the motion since the last call, by odometry.
    pub fn on_motion(&mut self, motion: Motion<S>) {
        let moved = Motion { length: self.moved.length + motion.length, turn: self.moved.turn + motion.turn };
        if moved.length.is_finite() && moved.turn.is_finite() {
            self.moved = moved;
        }
    }

    /// Takes in a scan of `laser` that arrived at `now`, valid or not. `belief` is the pose; `None` where it is unknown.
    ///
    /// The work is one pass over the beams, and for a scan with hardly any returns 128 beams times the walls within reach.
    pub fn on_scan(
        &mut self,
        now: Stamp,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
        belief: Option<&Belief<S>>,
        walls: &[Wall<S>],
    ) {
        self.last_scan = Some(now);
        let is_frozen = self.is_frozen(laser, scan);
        if !is_frozen && !self.sees_nothing(laser, scan, belief, walls) {
            (self.blind_scans, self.blind_since) = (0, None);
            let since = *self.good_since.get_or_insert(now);
            self.is_blind &= now.since(since).abs() < self.config.blind_timeout;
            return;
        }
        self.good_since = None;
        self.blind_scans = self.blind_scans.saturating_add(1);
        let since = *self.blind_since.get_or_insert(now);
        self.is_blind |= is_frozen || self.is_confirmed(since, now);
    }

    /// Whether the laser sends scans at `now` and sees nothing. A laser that sends none is not blind, but missing.
    pub fn is_blind(&self, now: Stamp) -> bool {
        let sends = self.last_scan.is_some_and(|last| now.since(last).abs() <= self.config.scan_timeout);
        let is_confirmed = self.blind_since.is_some_and(|since| self.is_confirmed(since, now));
        sends && (self.is_blind || is_confirmed)
    }

    /// Whether the last scan equals the one before bit by bit, though the robot moved a little: it is no new measurement.
    pub fn is_stuck(&self) -> bool {
        self.is_repeated && self.has_moved(MIN_LENGTH * STUCK_FRACTION, MIN_TURN * STUCK_FRACTION)
    }

    fn has_moved(&self, length: f64, turn: f64) -> bool {
        self.moved.length.abs() > S::from_f64(length) || self.moved.turn.abs() > S::from_f64(turn)
    }

    fn is_confirmed(&self, since: Stamp, now: Stamp) -> bool {
        self.blind_scans >= MIN_SCANS && now.since(since) >= self.config.blind_timeout
    }

    /// Whether the scan equals the one before bit by bit, though the robot moved.
    fn is_frozen(&mut self, laser: &RangeFinder<S>, scan: &Scan<'_, S>) -> bool {
        let returns = scan.ranges.iter().filter(|range| laser.is_return(**range)).count();
        let fingerprint = (returns >= MIN_RETURNS).then(|| fingerprint(scan));
        self.is_repeated = fingerprint.is_some() && fingerprint == self.fingerprint;
        if !self.is_repeated {
            self.fingerprint = fingerprint;
            self.moved = Motion { length: S::from_f64(0.0), turn: S::from_f64(0.0) };
            return false;
        }
        let width = |std: S, min: f64| (std.to_f64() * NOISE_WIDTHS).max(min);
        self.has_moved(width(laser.range_std, MIN_LENGTH), width(laser.bearing_std, MIN_TURN))
    }

    /// Whether a scan shows nothing, although it should.
    fn sees_nothing(
        &mut self,
        laser: &RangeFinder<S>,
        scan: &Scan<'_, S>,
        belief: Option<&Belief<S>>,
        walls: &[Wall<S>],
    ) -> bool {
        let Ok(missed) = MissedReturns::<S, BEAMS>::without_return(laser, scan) else { return true };
        let all = scan.ranges.len();
        let zero = S::from_f64(0.0);
        let (mut returns, mut misses) = (0_usize, 0_usize);
        for range in scan.ranges {
            if laser.is_return(*range) {
                returns += 1;
                self.longest = self.longest.max(*range);
            } else if *range > laser.range_max || *range == zero {
                misses += 1;
            }
        }
        let least = |count: usize| self.config.min_valid_beams * S::from_f64(count as f64);
        let is_below = |count: usize, least: S| S::from_f64(count as f64) < least;
        if all == 0 || is_below(returns + misses, least(all)) {
            return true;
        }
        let Some(belief) = belief.filter(|_| is_below(returns, least(all))) else { return false };
        let [unproved, proved] = MAX_REACH.map(S::from_f64);
        let fraction = S::from_f64(REACH_FRACTION);
        let reach = if self.longest > zero {
            (fraction * self.longest.min(laser.range_max)).min(proved)
        } else {
            (fraction * laser.range_max).min(unproved)
        };
        let expected = missed.count_within(reach, belief, walls);
        let sampled = all.div_ceil(all.div_ceil(BEAMS).max(1));
        let returns = returns * sampled / all;
        expected >= MIN_MISSED.min(all as u16) && is_below(returns, least(returns + usize::from(expected)))
    }
}

/// Hash of the ranges of a scan and of its first angle: FNV-1a over 64-bit words.
fn fingerprint<S: Float>(scan: &Scan<'_, S>) -> u64 {
    let words = scan.ranges.iter().copied().chain([scan.angle_min.radians()]);
    words.fold(0xcbf2_9ce4_8422_2325, |hash, word| {
        (hash ^ word.to_f64().to_bits()).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(17)
    })
}
