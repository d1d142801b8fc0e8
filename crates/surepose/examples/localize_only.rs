//! Localizes a robot with a laser in a known room, without a controller: [`Localizer`] alone.
//!
//! The robot turns on the spot. After 5 s it is carried to another place without odometry, and declared lost. The
//! global search then finds it by its scans.
//!
//! ```text
//! cargo run --release -p surepose --example localize_only
//! ```

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::process::ExitCode;

use surepose::estimation::{Belief, DelayedEkf, Ekf, Gate, WheelOdometry};
use surepose::geometry::{Angle, Body, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist};
use surepose::lidar::{LineAssociator, RangeFinder, Scan, ScanModel, ScanProcessor};
use surepose::localization::{Localizer, MonitorConfig, Odometry, SensorInput, SensorReading};
use surepose::map::{MapView, Wall};
use surepose::safety::Health;
use surepose::time::{Stamp, Stamped};

/// Beams of one turn of the laser.
const BEAMS: usize = 240;
const BEAM_STEP: f64 = TAU / BEAMS as f64;
/// Time between two scans \[s].
const PERIOD: f64 = 0.1;
/// Standard deviation of the ranges \[m].
const RANGE_STD: f64 = 0.01;
/// Corners of the room \[m]: no turn maps it onto itself.
const CORNERS: [(f64, f64); 6] = [(0.0, 0.0), (6.0, 0.0), (6.0, 2.5), (4.0, 2.5), (4.0, 4.0), (0.0, 4.0)];

pub(crate) fn main() -> Result<ExitCode, Box<dyn Error>> {
    let corner = |k: usize| Point::new(CORNERS[k % 6].0, CORNERS[k % 6].1);
    let walls = (0..6).map(|k| Wall::between(corner(k), corner(k + 1))).collect::<Result<Vec<_>, _>>()?;
    // A distance field would let the search start from every cell of the map. Two visible lines are enough here.
    let map = MapView::from_walls(&walls);

    let laser = RangeFinder {
        body_from_laser: Pose::identity(),
        range_std: RANGE_STD,
        bearing_std: 0.001,
        range_min: 0.05,
        range_max: 20.0,
    };
    let drive = DiffDrive::new(0.05, 0.4);
    let ekf = Ekf { drive, delta: 0.0025, integration: Integration::Arc };
    let mut truth = Pose::new(1.5, 1.0, Angle::zero());
    let start = Stamp::from_seconds(0.0);
    let filter = DelayedEkf::new(ekf, Gate::new(0.999), 1.0, start, Belief::new(truth, [0.05, 0.05, 0.02]));
    let scan_processor = ScanProcessor::new(laser, ScanModel::Lines(LineAssociator::default()));
    let mut localizer = Localizer::<f64, 64, BEAMS>::new(filter, scan_processor, MonitorConfig::default());

    let twist = Twist::new(0.0, 0.6);
    let travel = drive.wheel_speeds_from_twist(twist).scaled(PERIOD);
    let mut noise = Noise(1);
    let (mut was_lost, mut was_found) = (false, false);
    for step in 1_u32..=200 {
        let stamp = Stamp::from_seconds(f64::from(step) * PERIOD);
        truth = truth.integrate(twist.integrate_for(PERIOD), Integration::Arc);
        if step == 50 {
            truth = Pose::new(4.8, 1.6, Angle::from_degrees(-120.0));
            localizer.mark_lost();
            was_lost = true;
        }

        let ranges: Vec<f64> =
            (0..BEAMS).map(|beam| range(&walls, truth, beam) + RANGE_STD * noise.draw()).collect();
        let scan = SensorReading::Scan(Scan::new(Angle::from_radians(-PI), BEAM_STEP, &ranges));
        let readings = [Stamped::new(stamp, scan)];
        let input = SensorInput { stamp, odometry: Odometry::WheelTravel(travel), readings: &readings };
        let belief = localizer.update(&input, WheelOdometry::from_command(travel), &map, &mut ());

        let health = localizer.health();
        let found_now = was_lost && !was_found && health != Health::Lost;
        was_found |= found_now;
        if step % 20 == 0 || step == 50 || found_now {
            let pose = belief.pose;
            println!(
                "{:4.1} s  {health:?}: x {:.3} m, y {:.3} m, heading {:.1}°, error {:.3} m",
                stamp.seconds(),
                pose.x,
                pose.y,
                pose.heading.radians().to_degrees(),
                pose.origin().distance(truth.origin()),
            );
        }
    }
    let error = localizer.belief().error(truth);
    let is_right = error.iter().all(|component| component.abs() < 0.02);
    let success = was_found && is_right && localizer.health() == Health::Healthy;
    Ok(if success { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Distance along one beam to the first wall \[m].
fn range(walls: &[Wall<f64>], map_from_laser: Pose<Map, Body, f64>, beam: usize) -> f64 {
    let bearing = map_from_laser.heading.rotated_by(BEAM_STEP * beam as f64 - PI);
    let (sin, cos) = bearing.sin_cos();
    let ranges = walls.iter().filter_map(|wall| {
        let [a, b] = wall.ends().map(|end| (end.x - map_from_laser.x, end.y - map_from_laser.y));
        // Distances of both ends to the left of the beam, and how far along the beam they are.
        let (left_a, left_b) = (cos * a.1 - sin * a.0, cos * b.1 - sin * b.0);
        let (ahead_a, ahead_b) = (cos * a.0 + sin * a.1, cos * b.0 + sin * b.1);
        let fraction = left_a / (left_a - left_b);
        let range = ahead_a + fraction * (ahead_b - ahead_a);
        ((0.0..=1.0).contains(&fraction) && range > 0.0).then_some(range)
    });
    ranges.fold(f64::INFINITY, f64::min)
}

/// Uniform noise of mean 0 and variance 1: [Marsaglia2003].
struct Noise(u32);

impl Noise {
    fn draw(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        (f64::from(self.0) / f64::from(u32::MAX) - 0.5) * 12_f64.sqrt()
    }
}
