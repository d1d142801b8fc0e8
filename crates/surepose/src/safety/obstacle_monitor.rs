//! Obstacles: what the laser sees and the map does not contain.
//!
//! The monitor sees the plane of the laser and nothing else. It is no substitute for a safety scanner.

use crate::geometry::{Map, Point};
use crate::lidar::ScanEvent;
use crate::param;
use crate::scalar::Float;
use crate::time::Stamp;

use super::laser_monitor::{LaserMonitor, LaserMonitorConfig};

/// Constants of the obstacle monitor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleConfig<S> {
    /// Whether obstacles and a missing laser stop the robot.
    pub enabled: bool,
    /// A return closer than this to a wall of the map \[m] may be that wall.
    pub wall_distance: S,
    /// Returns farther than this from the laser \[m] are not considered.
    pub range: S,
    /// Time after which a point that no scan showed again is dropped \[s].
    pub memory: f64,
    /// Time without a scan after which the laser counts as failed \[s].
    pub scan_timeout: f64,
    /// Time for which the laser sends scans that show nothing, after which it counts as blind \[s].
    pub blind_timeout: f64,
    /// Minimum fraction of the beams that are valid, and of those at walls of the map that return, 0 to 1.
    pub min_valid_beams: S,
}

impl<S: Float> Default for ObstacleConfig<S> {
    /// For a laser at 10 Hz: five scans of memory, ten of patience.
    fn default() -> Self {
        Self {
            enabled: true,
            wall_distance: S::from_f64(0.15),
            range: S::from_f64(3.0),
            memory: 0.5,
            scan_timeout: param::SCAN_TIMEOUT.default_si(),
            blind_timeout: param::LASER_BLIND_TIMEOUT.default_si(),
            min_valid_beams: S::from_f64(param::MIN_VALID_BEAMS.default_si()),
        }
    }
}

/// Points of the last scan that lie on no wall of the map; at most `BEAMS`.
#[derive(Clone, Debug)]
pub struct ObstacleMonitor<S, const BEAMS: usize> {
    config: ObstacleConfig<S>,
    points: [Point<Map, S>; BEAMS],
    len: usize,
    /// Time of the last scan; `None` before the first one.
    scanned: Option<Stamp>,
    laser: LaserMonitor<S>,
}

impl<S: Float, const BEAMS: usize> ObstacleMonitor<S, BEAMS> {
    /// Monitor that has seen no scan.
    pub fn new(config: ObstacleConfig<S>) -> Self {
        // Without beams there is no laser to wait for.
        let enabled = config.enabled && BEAMS > 0;
        let config = ObstacleConfig { enabled, ..config };
        let laser = LaserMonitor::new(LaserMonitorConfig {
            blind_timeout: config.blind_timeout,
            scan_timeout: config.scan_timeout,
            min_valid_beams: config.min_valid_beams,
        });
        Self { config, points: [Point::default(); BEAMS], len: 0, scanned: None, laser }
    }

    /// Points of the map frame on which obstacles were seen.
    pub fn points(&self) -> &[Point<Map, S>] {
        self.points.get(..self.len).unwrap_or(&[])
    }

    /// The monitor of the laser, which takes in all scans.
    pub fn laser_mut(&mut self) -> &mut LaserMonitor<S> {
        &mut self.laser
    }

    /// Whether obstacles stop the robot and the laser sends scans at `now` that show nothing.
    pub fn is_laser_blind(&self, now: Stamp) -> bool {
        self.config.enabled && self.laser.is_blind(now)
    }

    /// Time of the last scan; `None` before the first one.
    pub fn last_scan(&self) -> Option<Stamp> {
        self.scanned
    }

    /// Drops points that are too old at `now`, or that carry a stamp of a clock that was set back since.
    pub fn expire(&mut self, now: Stamp) {
        if self.scanned.is_none_or(|scanned| now.since(scanned).abs() > self.config.memory) {
            self.len = 0;
        }
    }

    /// Whether obstacles stop the robot and no scan arrived within the time-out before `now`.
    pub fn is_timed_out(&self, now: Stamp) -> bool {
        let recent = |scanned| now.since(scanned).abs() <= self.config.scan_timeout;
        self.config.enabled && !self.scanned.is_some_and(recent)
    }

    /// Takes in a scan, placed by the belief at its time.
    pub fn on_scan(&mut self, event: &ScanEvent<'_, S>) {
        self.scanned = Some(event.stamp);
        self.len = 0;
        if !self.config.enabled || event.map.walls.is_empty() {
            return;
        }
        let map_from_laser = event.belief.pose * event.laser.body_from_laser;
        let range_max = event.laser.range_max.min(self.config.range);
        for (index, range) in event.scan.ranges.iter().enumerate() {
            if !(*range > event.laser.range_min && *range < range_max) {
                continue;
            }
            let (sin, cos) = event.scan.angle(index).sin_cos();
            let end = map_from_laser * Point::new(*range * cos, *range * sin);
            let is_wall = event.map.walls.iter().any(|wall| wall.distance(end) <= self.config.wall_distance);
            if is_wall {
                continue;
            }
            if let Some(slot) = self.points.get_mut(self.len) {
                *slot = end;
                self.len += 1;
            }
        }
    }
}
