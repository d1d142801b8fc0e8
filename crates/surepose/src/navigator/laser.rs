//! Supervision of the laser in a step: whether its scans can be trusted to show obstacles.

use crate::kinematics::{Motion, WheelPair};
use crate::localization::{Odometry, SensorInput, SensorReading};
use crate::map::MapView;
use crate::safety::{BlockReason, Health};
use crate::scalar::Float;
use crate::time::Stamp;

use super::Navigator;

/// Yaw rate above which a gyroscope certainly turns, whatever remains of its bias \[rad/s].
const MIN_YAW_RATE: f64 = 0.1;

/// Longest time over which one reading holds \[s].
const MAX_TURN_INTERVAL: f64 = 0.5;

impl<S: Float, const HISTORY: usize, const BEAMS: usize, const HYPOTHESES: usize, const KEYFRAMES: usize>
    Navigator<S, HISTORY, BEAMS, HYPOTHESES, KEYFRAMES>
{
    /// Passes all scans to the monitor of the laser, also those that the localizer cannot use, and withholds frozen scans
    /// from the localizer: they would hold the estimate back until it counts as lost.
    pub(super) fn watch_laser(&mut self, map: &MapView<'_, S>, input: &SensorInput<'_, S>) {
        if BEAMS == 0 {
            return;
        }
        let travel = match input.odometry {
            Odometry::WheelTravel(travel) => travel,
            Odometry::WithVariance(odometry) => odometry.travel,
            Odometry::Missing => WheelPair::zero(),
        };
        let by_wheels = self.config.controller.drive.motion_from_travel(travel);
        let turn = self.gyroscope_turn(input).unwrap_or(by_wheels.turn);
        let monitor = self.obstacles.laser_mut();
        monitor.on_motion(Motion { turn, ..by_wheels });
        for reading in input.readings {
            let SensorReading::Scan(scan) = &reading.value else { continue };
            let laser = self.localizer.scan_processor().laser_of(scan);
            let belief = self.localizer.belief();
            let known = (self.localizer.health() != Health::Lost).then_some(&belief);
            monitor.on_scan(input.stamp, &laser, scan, known, map.walls);
        }
        self.localizer.set_scans_ignored(monitor.is_stuck());
    }

    /// Turn since the last step by the last reading of the gyroscope \[rad]; `None` where it is not certainly turning.
    fn gyroscope_turn(&self, input: &SensorInput<'_, S>) -> Option<S> {
        let estimator = self.localizer.estimator();
        let bias = estimator.gyroscope_bias()?.value;
        let rate = input.readings.iter().rev().find_map(|reading| match reading.value {
            SensorReading::YawRate(rate) => Some(rate - bias),
            _ => None,
        })?;
        let elapsed = S::from_f64(input.stamp.since(estimator.stamp()).clamp(0.0, MAX_TURN_INTERVAL));
        (rate.abs() > S::from_f64(MIN_YAW_RATE) && rate.is_finite()).then(|| rate * elapsed)
    }

    /// Reason for which the laser cannot detect obstacles at `now`; `None` if it can. Always `None` without a map, because
    /// obstacles are beams that the map does not explain.
    pub(super) fn laser_fault(&self, map: &MapView<'_, S>, now: Stamp) -> Option<BlockReason> {
        if !map.is_known() {
            return None;
        }
        if self.obstacles.is_laser_blind(now) {
            return Some(BlockReason::LaserBlind);
        }
        self.obstacles.is_timed_out(now).then_some(BlockReason::LaserTimeout)
    }
}
