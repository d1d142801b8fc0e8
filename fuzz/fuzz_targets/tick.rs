//! Whatever sensors, clocks and people say, the driver's wheels are told something that they can do.

#![no_main]

use libfuzzer_sys::fuzz_target;
use surepose::estimation::{HeadingMeasurement, Measurement};
use surepose::geometry::{Angle, Pose};
use surepose::time::{Stamp, Stamped};
use surepose_ros2::{LaserScan, NodeDriver, NodeDriverSettings, SensorMessage};
use surepose_sim::robot::Scenario;

/// Takes numbers from bytes: any bits make a number, and NaN and infinity are among them.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    fn number(&mut self) -> f64 {
        let Some((first, rest)) = self.0.split_first_chunk() else { return 0.5 };
        self.0 = rest;
        f64::from(f32::from_le_bytes(*first))
    }
}

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes(bytes);
    let mut driver = NodeDriver::new(NodeDriverSettings::in_scenario(&Scenario::default()));
    let mut now = Stamp::from_seconds(1e9);
    while let Some(what) = bytes.byte() {
        match what % 6 {
            0 => {
                let ranges = (0..32).map(|_| bytes.number()).collect();
                let (angle_min, angle_increment) = (bytes.number(), bytes.number());
                let (range_min, range_max) = (bytes.number(), bytes.number());
                let body_from_laser =
                    Pose::new(bytes.number(), bytes.number(), Angle::from_radians(bytes.number()));
                let scan =
                    LaserScan { angle_min, angle_increment, ranges, range_min, range_max, body_from_laser };
                driver.add_measurement(Stamped::new(now.after(bytes.number()), SensorMessage::Scan(scan)));
            }
            1 => {
                let compass =
                    HeadingMeasurement { heading: Angle::from_radians(bytes.number()), std: bytes.number() };
                let heard = SensorMessage::Measurement(Measurement::Heading(compass));
                driver.add_measurement(Stamped::new(now.after(bytes.number()), heard));
            }
            2 => {
                let goal = Pose::new(bytes.number(), bytes.number(), Angle::from_radians(bytes.number()));
                let _refused = driver.set_goal(goal);
            }
            3 => driver.start_global_localization(),
            _ => {
                now = now.after(0.1 + 0.01 * bytes.number().clamp(-10.0, 100.0));
                let at = Pose::new(bytes.number(), bytes.number(), Angle::from_radians(bytes.number()));
                let Ok(Some(report)) = driver.on_odometry(Stamped::new(now, at)) else { continue };
                let limits = &driver.controller().limits;
                if let Some(twist) = report.command {
                    let rims = driver.controller().drive.wheel_speeds_from_twist(twist);
                    assert!(rims.max_abs() <= limits.wheel_speed * 1.000_001, "{twist:?}");
                }
                let belief = report.belief;
                assert!(belief.pose.x.is_finite() && belief.pose.y.is_finite(), "{belief:?}");
                assert!(belief.covariance.is_valid(), "{belief:?}");
            }
        }
    }
});
