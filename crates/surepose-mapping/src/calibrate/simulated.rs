//! Simulated recordings with known true parameters.

use core::f64::consts::{FRAC_PI_4, PI, TAU};

use surepose::control::{GlobalLaw, Limits, NavigationVariables};
use surepose::geometry::{Angle, Body, Goal, Map, Pose};
use surepose::kinematics::{DiffDrive, WheelPair};
use surepose_io::recording::{ScanRecord, SensorPose, StampedTicks};
use surepose_sim::{Arena, CompassModel, LaserModel, Seed, Stream, Timing, World, WorldModel};

use super::parameter::{COUNT, CalibrationParameter, Geometry};
use super::recording::{CalibrationRecording, StampedHeading};

/// Sampling period of the wheel counters \[s].
const PERIOD: f64 = 0.1;
const TICKS_PER_TURN: f64 = 20_000.0;

/// A simulated recording with its true parameters.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// The recording.
    pub recording: CalibrationRecording,
    /// The true parameters.
    pub truth: Geometry<f64>,
    /// The true noise factor of the wheels.
    pub delta: f64,
    /// True heading of the robot at the first record.
    pub start_heading: Angle<f64>,
}

impl Simulated {
    /// Returns the true values, with the names and units of [`super::Calibration::parameters`].
    pub fn truths(&self) -> Vec<(&'static str, f64)> {
        let geometry =
            CalibrationParameter::ALL.iter().map(|p| (p.name(), self.truth.get(*p) / p.unit().to_si()));
        let WheelPair { right, left } = self.truth.drive().radius;
        let more = [
            ("wheel_radius_m", 0.5 * (right + left)),
            ("wheel_radius_ratio", right / left),
            ("delta", self.delta),
        ];
        geometry.chain(more).collect()
    }
}

/// Returns the nominal geometry: [`WorldModel::paper`] with the laser 10 cm ahead.
pub fn nominal() -> Geometry<f64> {
    let paper = WorldModel::paper(Arena::paper());
    let (radius, wheel_separation) = (paper.drive.radius.right, paper.drive.wheel_separation);
    Geometry([radius, radius, wheel_separation, 0.1, 0.0, 0.0, 0.04, 0.0, 0.01])
}

/// Simulates a drive of `duration` \[s] between random goals in the paper's arena, with a perturbed robot.
///
/// Radii and wheel separation are up to 3 % off, the laser up to 3 cm and 3°. Latencies are up to 40 ms
/// (laser) and 10 ms (compass); the compass offset is up to 30°.
pub fn drive(seed: u64, duration: f64) -> Simulated {
    record(Seed(seed), duration, None)
}

/// Simulates the same robot with equal wheel speeds (nearly straight motion).
pub fn straight(seed: u64, duration: f64) -> Simulated {
    record(Seed(seed), duration, Some(WheelPair::new(4.0, 4.0)))
}

/// Records a drive at the constant wheel rates `held`, or between random goals if it is `None`.
fn record(seed: Seed, duration: f64, held: Option<WheelPair<f64>>) -> Simulated {
    let mut draw = seed.stream("calibration truth");
    let spread = [0.0015, 0.0015, 0.018, 0.03, 0.03, 0.052, 0.04, 0.52, 0.01];
    let nominal = nominal();
    let truth: [f64; COUNT] = core::array::from_fn(|i| nominal.0[i] + draw.uniform(-spread[i], spread[i]));
    let truth = Geometry(truth);

    let mut model = WorldModel::paper(Arena::paper());
    let paper = model.drive;
    model.drive = DiffDrive::new(paper.radius.right, truth.get(CalibrationParameter::WheelSeparation));
    let timing = Timing { period: PERIOD, latency: 0.0 };
    let offset = truth.get(CalibrationParameter::CompassOffset);
    model.compass = Some((CompassModel { offset, ..CompassModel::default() }, timing));
    let laser = LaserModel { body_from_laser: truth.body_from_laser(), ..LaserModel::half_circle(181) };
    let beams = (laser.angle_min, laser.angle_increment);
    model.laser = Some((laser, timing));

    let delta = model.slip.delta;
    let heading = if held.is_some() { FRAC_PI_4 } else { draw.uniform(-3.0, 3.0) };
    let start = Pose::new(0.0, 0.0, Angle::from_radians(heading));
    let drive = model.drive;
    let mut world = World::new(model, start, seed);
    let mut goals = RandomGoals {
        draw: seed.stream("goals"),
        goal: Pose::new(start.x, start.y, start.heading),
        speed: 0.3,
    };
    // The simulated wheels share one radius; different radii turn differently for the same travel.
    let radii = WheelPair::new(
        truth.get(CalibrationParameter::RightWheelRadius),
        truth.get(CalibrationParameter::LeftWheelRadius),
    );
    let mut turned = WheelPair::new(0.0, 0.0);
    let ticks = |turned: f64| (turned / TAU * TICKS_PER_TURN).floor() as i64;
    let mut recording = CalibrationRecording {
        ticks_per_turn: TICKS_PER_TURN,
        ticks: vec![StampedTicks { time: 0.0, left: 0, right: 0 }],
        scans: Vec::new(),
        headings: Vec::new(),
        commands: Vec::new(),
    };
    while world.now().seconds() < duration {
        let desired = held.unwrap_or_else(|| goals.rates(&drive, world.pose()));
        let sensed = world.step(desired, PERIOD);
        turned.right += sensed.rims.right / radii.right;
        turned.left += sensed.rims.left / radii.left;
        let time = sensed.stamp.seconds();
        recording.ticks.push(StampedTicks { time, left: ticks(turned.left), right: ticks(turned.right) });
        recording.headings.extend(sensed.headings.iter().map(|read| StampedHeading {
            time: read.stamp.seconds() + truth.get(CalibrationParameter::CompassLatency),
            heading: read.value,
        }));
        let before = recording.ticks.len();
        recording.scans.extend(sensed.scans.into_iter().map(|scan| ScanRecord {
            time: scan.stamp.seconds() + truth.get(CalibrationParameter::LaserLatency),
            angle_min: beams.0,
            angle_increment: beams.1,
            ranges: scan.value.ranges,
            mount: SensorPose::default(),
            odometry: None,
            odometry_before: before,
        }));
    }
    Simulated { recording, truth, delta, start_heading: start.heading }
}

/// Controller that drives to random goals.
struct RandomGoals {
    draw: Stream,
    goal: Pose<Map, Goal, f64>,
    speed: f64,
}

impl RandomGoals {
    /// Returns the wheel rates \[rad/s] towards the goal; draws a new goal once the current one is near.
    fn rates(&mut self, drive: &DiffDrive<f64>, pose: Pose<Map, Body, f64>) -> WheelPair<f64> {
        while (self.goal.x - pose.x).hypot(self.goal.y - pose.y) < 0.3 {
            let heading = Angle::from_radians(self.draw.uniform(-PI, PI));
            self.goal = Pose::new(self.draw.uniform(-0.3, 3.0), self.draw.uniform(-0.5, 3.0), heading);
            self.speed = self.draw.uniform(0.15, 0.45);
        }
        let navigation = NavigationVariables::from_poses(pose, self.goal);
        let twist = GlobalLaw { k_v: 2.0, k_alpha: 4.0, h: 0.5 }.twist(&navigation);
        let limits = Limits::symmetric(self.speed, 10.0);
        drive.wheel_rates_from_twist(limits.limit_speed(drive, twist))
    }
}
