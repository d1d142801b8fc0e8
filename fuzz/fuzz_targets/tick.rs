//! Whatever sensors, clocks and people say, the pilot's wheels are told something that they can do.

#![no_main]

use libfuzzer_sys::fuzz_target;
use surepose::{Angle, Compass, Measurement, Pose, Stamp, Stamped};
use surepose_lab::rig::Scenario;
use surepose_ros2::{Heard, LaserScan, Pilot, Settings};

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
    let mut pilot = Pilot::new(Settings::in_scenario(&Scenario::default()));
    let mut now = Stamp::from_seconds(1e9);
    while let Some(what) = bytes.byte() {
        match what % 6 {
            0 => {
                let ranges = (0..32).map(|_| bytes.number()).collect();
                let (first_bearing, bearing_step) = (bytes.number(), bytes.number());
                let (nearest, farthest) = (bytes.number(), bytes.number());
                let body_from_laser = Pose::new(bytes.number(), bytes.number(), Angle::wrapped(bytes.number()));
                let scan = LaserScan { first_bearing, bearing_step, ranges, nearest, farthest, body_from_laser };
                pilot.hear(Stamped::new(now.after(bytes.number()), Heard::Scan(scan)));
            }
            1 => {
                let compass = Compass { heading: Angle::wrapped(bytes.number()), std: bytes.number() };
                let heard = Heard::Measurement(Measurement::Compass(compass));
                pilot.hear(Stamped::new(now.after(bytes.number()), heard));
            }
            2 => {
                let goal = Pose::new(bytes.number(), bytes.number(), Angle::wrapped(bytes.number()));
                let _refused = pilot.go(goal);
            }
            3 => pilot.lose(),
            _ => {
                now = now.after(0.1 + 0.01 * bytes.number().clamp(-10.0, 100.0));
                let at = Pose::new(bytes.number(), bytes.number(), Angle::wrapped(bytes.number()));
                let Ok(Some(report)) = pilot.roll(Stamped::new(now, at)) else { continue };
                let limits = &pilot.controller().limits;
                if let Some(twist) = report.command {
                    let rims = pilot.controller().drive.rims_from_twist(twist);
                    assert!(rims.largest() <= limits.wheel_speed * 1.000_001, "{twist:?}");
                }
                let belief = report.belief;
                assert!(belief.pose.x.is_finite() && belief.pose.y.is_finite(), "{belief:?}");
                assert!(belief.covariance.is_valid(), "{belief:?}");
            }
        }
    }
});
