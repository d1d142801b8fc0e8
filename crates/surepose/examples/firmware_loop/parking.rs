//! A robot parks: the navigator between simulated sensors and simulated wheels, in single precision.
//!
//! The world is as plain as it can be, and uses the core's own motion and lines. The drive shows that the same source gives the
//! same bits on the host and on the microcontroller, and what a step costs.

use core::fmt::{Display, Formatter};

use surepose::control::{Controller, Direction, Limits, Tolerance};
use surepose::estimation::{Belief, DelayedEkf, Ekf, Gate, HeadingMeasurement, LineMeasurement, Measurement};
use surepose::geometry::{Angle, Body, Line, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist, WheelPair};
use surepose::lidar::ScanProcessor;
use surepose::localization::{Localizer, MonitorConfig, Odometry, SensorInput, SensorReading};
use surepose::map::{MapView, Wall};
use surepose::navigator::{GoalResult, Navigator, NavigatorConfig};
use surepose::safety::Footprint;
use surepose::time::{Stamp, Stamped};

/// Time between ticks \[ms].
const PERIOD: u16 = 20;
/// Ticks after which the robot is given up.
const MAX_TICKS: u32 = 3000;
/// Standard deviations of what the compass \[rad] and the laser \[m], \[rad] say.
const COMPASS: f32 = 0.002;
const WALL: [f32; 2] = [0.01, 0.004];
/// Standard deviation of the part by which a wheel rolls farther than its encoder says.
const SLIP: f32 = 0.05;

/// Result of the drive.
pub(crate) struct Parked {
    pub(crate) ticks: u32,
    pub(crate) reached: bool,
    truth: Pose<Map, Body, f32>,
    belief: Belief<f32>,
    refused: u32,
    /// Of the bits of every tick's belief and twist.
    hash: u64,
}

impl Parked {
    /// A drive that did not begin.
    fn nowhere(truth: Pose<Map, Body, f32>, belief: Belief<f32>) -> Self {
        Self { ticks: 0, reached: false, truth, belief, refused: 0, hash: 0 }
    }
}

impl Display for Parked {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        let Self { ticks, reached, truth, belief, refused, hash } = self;
        let pose = |name: &str, pose: &Pose<Map, Body, f32>, f: &mut Formatter<'_>| {
            writeln!(f, "{name} {} m, {} m, {} rad", pose.x, pose.y, pose.heading.radians())
        };
        writeln!(f, "reached {reached} after {ticks} ticks, {refused} measurements refused")?;
        pose("truth", truth, f)?;
        pose("belief", &belief.pose, f)?;
        write!(f, "bits {hash:016x}")
    }
}

/// Drives from (1, 1, 0°) to (4, 2.5, 90°) in a room of 6 m × 4 m. `clock` is read before and after every tick, for those
/// who want to know what a tick costs.
pub(crate) fn park(mut clock: impl FnMut()) -> Parked {
    let drive = DiffDrive::new(0.05, 0.6);
    let limits = Limits::symmetric(0.3, 0.5);
    let period = f32::from(PERIOD) * 1e-3;
    let tolerance = Tolerance { position: 0.01, heading: 0.0175, dwell: 0.5, hysteresis: 1.5 };
    let controller = Controller::fitted(drive, limits, period, Direction::Auto, tolerance);
    let ekf = Ekf { drive, delta: 0.0025, integration: Integration::Arc };
    let mut truth = Pose::new(1.0, 1.0, Angle::from_radians(0.0));
    let goal = Pose::new(4.0, 2.5, Angle::from_degrees(90.0));
    let belief = Belief::new(truth, [0.01, 0.01, 0.01]);
    let start = Stamp::from_nanoseconds(0);
    let estimator = DelayedEkf::new(ekf, Gate::new(0.999_999), 1.0, start, belief);
    // No laser: no beams, and no hypotheses of a global search.
    let localizer =
        Localizer::<f32, 8, 0, 1, 1>::new(estimator, ScanProcessor::disabled(), MonitorConfig::default());
    let mut navigator = Navigator::new(NavigatorConfig::new(controller, Footprint::Circle(0.35)), localizer);
    let corners = [(6.0, 0.0), (6.0, 4.0), (0.0, 4.0), (0.0, 0.0), (6.0, 0.0)].map(|(x, y)| Point::new(x, y));
    let room = [0, 1, 2, 3].map(|k| Wall::between(corners[k], corners[k + 1]));
    let [Ok(east), Ok(north), Ok(west), Ok(south)] = room else { return Parked::nowhere(truth, belief) };
    let room = [east, north, west, south];
    let map = MapView::from_walls(&room);
    let walls = room.map(|wall| *wall.line());
    if navigator.set_goal(&map, goal).is_err() {
        return Parked::nowhere(truth, belief);
    }

    let (mut noise, mut hash) = (Noise(1), Hash::new());
    let mut rolled = WheelPair::zero();
    let (mut ticks, mut reached) = (0, false);
    while ticks < MAX_TICKS && !reached {
        ticks += 1;
        let stamp = Stamp::from_nanoseconds(i64::from(ticks) * i64::from(PERIOD) * 1_000_000);
        let heading = truth.heading.rotated_by_small(COMPASS * noise.draw());
        let compass = Measurement::Heading(HeadingMeasurement { heading, std: COMPASS });
        let seen = truth.inverse() * walls[ticks as usize % 4];
        let sighting = Measurement::Line(LineMeasurement {
            wall: walls[ticks as usize % 4],
            seen: Line::new(
                seen.distance + WALL[0] * noise.draw(),
                seen.direction.rotated_by_small(WALL[1] * noise.draw()),
            ),
            distance_variance: WALL[0] * WALL[0],
            direction_variance: WALL[1] * WALL[1],
            covariance: 0.0,
            wall_variance: 0.0,
        });
        let readings = [compass, sighting]
            .map(|measurement| Stamped::new(stamp, SensorReading::Measurement(measurement)));
        let input = SensorInput { stamp, odometry: Odometry::WheelTravel(rolled), readings: &readings };

        clock();
        let report = navigator.step(&map, &input);
        clock();

        let twist = report.command.map_or(Twist::zero(), |command| command.twist);
        rolled = drive.wheel_speeds_from_twist(twist).scaled(period);
        let slipping = WheelPair::new(
            rolled.right * (1.0 + SLIP * noise.draw()),
            rolled.left * (1.0 + SLIP * noise.draw()),
        );
        truth = truth.integrate(drive.motion_from_travel(slipping), Integration::Arc);
        reached = report.result == Some(GoalResult::Reached);
        let pose = report.belief.pose;
        for number in [pose.x, pose.y, pose.heading.radians(), twist.v, twist.omega] {
            hash.add(number);
        }
    }
    let localizer = navigator.localizer();
    let (belief, refused) = (localizer.belief(), localizer.measurement_stats().rejected_total());
    Parked { ticks, reached, truth, belief, refused, hash: hash.0 }
}

/// Noise of unit variance, uniform: [Marsaglia2003].
struct Noise(u32);

impl Noise {
    fn draw(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        (self.0 >> 8) as f32 * (3.464_101_6 / 16_777_216.0) - 1.732_050_8
    }
}

/// FNV-1a of the bits of numbers.
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, number: f32) {
        for byte in number.to_bits().to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}
