//! Steps the core's navigator with arbitrary sensor input, and checks its commands and its belief.

#![no_main]

use libfuzzer_sys::fuzz_target;
use surepose::estimation::{Belief, HeadingMeasurement, Measurement};
use surepose::geometry::{Angle, Pose};
use surepose::kinematics::WheelPair;
use surepose::lidar::{LaserGeometry, Scan};
use surepose::localization::{Odometry, SensorInput, SensorReading};
use surepose::time::{Stamp, Stamped};
use surepose_config::{Config, NavigatorSetup, ScanMethod};
use surepose_io::owned_map::OwnedMap;
use surepose_sim::Arena;
use surepose_sim::robot::wall_map_from_arena;

/// Number of beams of a scan.
const BEAMS: usize = 32;

/// Readings that one step takes at most.
const MAX_READINGS: usize = 16;

/// Decodes numbers from bytes; NaN and infinity are among them.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    /// Next number; 0.5 after the last byte.
    fn number(&mut self) -> f64 {
        let Some((first, rest)) = self.0.split_first_chunk() else { return 0.5 };
        self.0 = rest;
        f64::from(f32::from_le_bytes(*first))
    }

    fn angle(&mut self) -> Angle<f64> {
        Angle::from_radians(self.number())
    }
}

/// Reading that owns its ranges.
enum OwnedReading {
    Heading(HeadingMeasurement<f64>),
    Scan {
        angle_min: Angle<f64>,
        angle_increment: f64,
        time_increment: f64,
        ranges: Vec<f64>,
        geometry: LaserGeometry<f64>,
    },
}

impl OwnedReading {
    fn heading(bytes: &mut Bytes<'_>) -> Self {
        Self::Heading(HeadingMeasurement { heading: bytes.angle(), std: bytes.number() })
    }

    fn scan(bytes: &mut Bytes<'_>) -> Self {
        let ranges = (0..BEAMS).map(|_| bytes.number()).collect();
        let (angle_min, angle_increment) = (bytes.angle(), bytes.number());
        let time_increment = bytes.number();
        let (range_min, range_max) = (bytes.number(), bytes.number());
        let body_from_laser = Pose::new(bytes.number(), bytes.number(), bytes.angle());
        let geometry = LaserGeometry { body_from_laser, range_min, range_max };
        Self::Scan { angle_min, angle_increment, time_increment, ranges, geometry }
    }

    fn reading(&self) -> SensorReading<'_, f64> {
        match self {
            Self::Heading(heading) => SensorReading::Measurement(Measurement::Heading(*heading)),
            Self::Scan { angle_min, angle_increment, time_increment, ranges, geometry } => {
                let scan = Scan::new(*angle_min, *angle_increment, ranges).with_time_increment(*time_increment);
                SensorReading::Scan(scan.with_geometry(*geometry))
            }
        }
    }
}

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes(bytes);
    let setup = NavigatorSetup {
        scan_method: ScanMethod::Lines,
        map_std: 0.0,
        has_laser: true,
        is_aided: true,
        safety_radius: None,
        hold_goal: false,
    };
    let mut now = Stamp::from_seconds(1e9);
    let start = Belief::new(Pose::identity(), [0.01, 0.01, 0.01]);
    let mut navigator = Config::default().navigator(&setup, now, start);
    let controller = navigator.config().controller;
    let map = OwnedMap::from_wall_map(&wall_map_from_arena(&Arena::paper()));
    let mut readings: Vec<Stamped<OwnedReading>> = Vec::new();
    while let Some(event) = bytes.byte() {
        match event % 6 {
            0 | 1 if readings.len() >= MAX_READINGS => {}
            0 => {
                let scan = OwnedReading::scan(&mut bytes);
                readings.push(Stamped::new(now.after(bytes.number()), scan));
            }
            1 => {
                let heading = OwnedReading::heading(&mut bytes);
                readings.push(Stamped::new(now.after(bytes.number()), heading));
            }
            2 => {
                let goal = Pose::new(bytes.number(), bytes.number(), bytes.angle());
                let _rejected = navigator.set_goal(&map.view(), goal);
            }
            3 => navigator.mark_lost(),
            kind => {
                now = now.after(controller.period + 0.01 * bytes.number().clamp(-10.0, 100.0));
                let odometry = match kind {
                    4 => Odometry::WheelTravel(WheelPair::new(bytes.number(), bytes.number())),
                    _ => Odometry::Missing,
                };
                let taken = std::mem::take(&mut readings);
                let borrowed: Vec<_> =
                    taken.iter().map(|at| Stamped::new(at.stamp, at.value.reading())).collect();
                let input = SensorInput { stamp: now, odometry, readings: &borrowed };
                let report = navigator.step(&map.view(), &input);
                if let Some(command) = report.command {
                    let speeds = controller.drive.wheel_speeds_from_twist(command.twist);
                    let limit = controller.limits.wheel_speed * 1.000_001;
                    assert!(speeds.max_abs() <= limit, "{command:?}");
                }
                let belief = report.belief;
                assert!(belief.pose.x.is_finite() && belief.pose.y.is_finite(), "{belief:?}");
                assert!(belief.pose.heading.radians().is_finite(), "{belief:?}");
                assert!(belief.covariance.is_valid(), "{belief:?}");
            }
        }
    }
});
