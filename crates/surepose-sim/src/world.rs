//! Simulated world: one robot in an arena, and the clock.

use core::ops::Range;

use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist, WheelPair};
use surepose::time::{Stamp, Stamped};

use crate::arena::Arena;
use crate::compass::CompassModel;
use crate::fault::{Disturbance, Fault, FaultKind, Sensor, disturbance, held_wheels};
use crate::gyroscope::{GyroscopeModel, GyroscopeState};
use crate::laser::{LaserModel, PoseTrack, SimulatedScan};
use crate::motor::{MotorModel, Wheel};
use crate::plant::{Plant, PlantModel};
use crate::random::{Seed, Stream};
use crate::slip::{ContactPoints, Slip, Traction};

/// Largest period of the wheel controllers and of the simulation \[ns].
const MAX_SUBSTEP: i64 = 10_000_000;

/// Measurement period and latency of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Time between measurements \[s]. Each is taken at the next simulation step, within 10 ms.
    pub period: f64,
    /// Time from a measurement to its arrival \[s].
    pub latency: f64,
}

/// Parameters of a world.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldModel {
    /// Walls.
    pub arena: Arena,
    /// Wheel separation and wheel radii.
    pub drive: DiffDrive<f64>,
    /// Base between command and motors.
    pub plant: PlantModel,
    /// Motors with encoders and speed controllers.
    pub motor: MotorModel,
    /// White noise between encoders and true travel.
    pub slip: Slip,
    /// Grip of the wheels on the floor.
    pub traction: Traction,
    /// Gyroscope. `None`: no gyroscope.
    pub gyroscope: Option<GyroscopeModel>,
    /// Compass. `None`: no compass.
    pub compass: Option<(CompassModel, Timing)>,
    /// Laser. `None`: no laser.
    pub laser: Option<(LaserModel, Timing)>,
    /// Faults to inject.
    pub faults: Vec<Fault>,
}

impl WorldModel {
    /// The paper's robot, [Tran2012] Sec. 5.2, in `arena`, without faults.
    ///
    /// # Departure
    /// The paper gives no sensor rates or latencies. Here both sensors measure at its ΔT of 100 ms. The
    /// latency is 40 ms for scans and 10 ms for headings.
    pub fn paper(arena: Arena) -> Self {
        Self {
            arena,
            drive: DiffDrive::new(0.05, 0.60),
            plant: PlantModel::default(),
            motor: MotorModel::default(),
            slip: Slip { delta: 0.0025 },
            traction: Traction::default(),
            gyroscope: None,
            compass: Some((CompassModel::default(), Timing { period: 0.1, latency: 0.01 })),
            laser: Some((LaserModel::half_circle(181), Timing { period: 0.1, latency: 0.04 })),
            faults: Vec::new(),
        }
    }
}

/// Sensor data of one step.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorOutput {
    /// Time at the end of the step.
    pub stamp: Stamp,
    /// Wheel travel since the previous step, measured by the encoders \[m].
    pub rims: WheelPair<f64>,
    /// Mean yaw rate since the previous step, measured by the gyroscope \[rad/s]. `None`: no gyroscope.
    pub yaw_rate: Option<f64>,
    /// Compass headings that arrived during the step.
    pub headings: Vec<Stamped<Angle<f64>>>,
    /// Scans that arrived during the step.
    pub scans: Vec<Stamped<SimulatedScan>>,
}

/// Messages in transit, each with its arrival time.
type UnderWay<T> = Vec<(Stamp, Stamped<T>)>;

/// One robot in an arena, with its clock.
#[derive(Clone, Debug)]
pub struct World {
    model: WorldModel,
    now: Stamp,
    pose: Pose<Map, Body, f64>,
    twist: Twist<f64>,
    plant: Plant,
    wheels: WheelPair<Wheel>,
    counted: WheelPair<f64>,
    contact: ContactPoints,
    /// Turn since the beginning of the step \[rad].
    turned: f64,
    slip: Stream,
    gyroscope: GyroscopeState,
    compass: Stream,
    laser: Stream,
    headings: UnderWay<Angle<f64>>,
    scans: UnderWay<SimulatedScan>,
    /// Last scan before a fault of the laser, or the first one.
    scan_before: Option<SimulatedScan>,
    /// True poses during the last sweep of the laser.
    track: PoseTrack,
}

impl World {
    /// Creates a world with the robot at `start` and the time 0.
    pub fn new(model: WorldModel, start: Pose<Map, Body, f64>, seed: Seed) -> Self {
        let mut track = PoseTrack::default();
        track.record(Stamp::default(), start, 0.0);
        Self {
            model,
            track,
            now: Stamp::default(),
            pose: start,
            twist: Twist::zero(),
            plant: Plant::default(),
            wheels: WheelPair {
                right: Wheel::at_rest(seed.stream("right wheel")),
                left: Wheel::at_rest(seed.stream("left wheel")),
            },
            counted: WheelPair::new(0.0, 0.0),
            contact: ContactPoints::default(),
            turned: 0.0,
            slip: seed.stream("slip"),
            gyroscope: GyroscopeState::new(seed.stream("gyroscope")),
            compass: seed.stream("compass"),
            laser: seed.stream("laser"),
            headings: Vec::new(),
            scans: Vec::new(),
            scan_before: None,
        }
    }

    /// Parameters of the world.
    pub fn model(&self) -> &WorldModel {
        &self.model
    }

    /// Current time.
    pub fn now(&self) -> Stamp {
        self.now
    }

    /// True pose.
    pub fn pose(&self) -> Pose<Map, Body, f64> {
        self.pose
    }

    /// True twist.
    pub fn twist(&self) -> Twist<f64> {
        self.twist
    }

    /// True wheel speeds before slip \[m/s].
    pub fn rim_speeds(&self) -> WheelPair<f64> {
        let rates = WheelPair::new(self.wheels.right.rate(), self.wheels.left.rate());
        self.model.drive.wheel_travel_from_angle(rates)
    }

    /// Runs the wheel controllers with the setpoints `desired` \[rad/s] for `period` \[s].
    ///
    /// The controllers run every 10 ms, or slightly faster so that they divide the period. One step is one
    /// odometry period, with one slip factor per wheel.
    pub fn step(&mut self, desired: WheelPair<f64>, period: f64) -> SensorOutput {
        let slip = self.model.slip.factors(&mut self.slip);
        self.plant.send(&self.model.plant, self.now, desired);
        self.turned = 0.0;
        let (start, period) = (self.now.nanoseconds(), nanoseconds(period));
        let substeps = (period + MAX_SUBSTEP - 1) / MAX_SUBSTEP;
        for substep in 1..=substeps {
            let (before, now) = (self.now, Stamp::from_nanoseconds(start + period * substep / substeps));
            self.push(before..now);
            self.roll(slip, now);
            self.measure(before);
        }
        SensorOutput {
            stamp: self.now,
            rims: self.rims(),
            yaw_rate: self.yaw_rate(period as f64 / 1e9),
            headings: arrived(&mut self.headings, self.now),
            scans: arrived(&mut self.scans, self.now),
        }
    }

    /// Simulates the motion until `end`.
    fn roll(&mut self, slip: WheelPair<f64>, end: Stamp) {
        let WorldModel { drive, motor, plant, traction, faults, .. } = &self.model;
        let time = (end.nanoseconds() - self.now.nanoseconds()) as f64 / 1e9;
        let setpoints = self.plant.advance(plant, drive, self.now, time);
        let held = held_wheels(faults, self.now);
        let turn = |wheel: &mut Wheel, setpoint, held| {
            if held {
                wheel.hold();
                return 0.0;
            }
            wheel.turn(motor, setpoint, time)
        };
        let right = turn(&mut self.wheels.right, setpoints.right, held.0) * slip.right;
        let left = turn(&mut self.wheels.left, setpoints.left, held.1) * slip.left;
        let travel = drive.wheel_travel_from_angle(WheelPair::new(right, left));
        let motion = drive.motion_from_travel(self.contact.travel(traction, travel, time));
        self.pose = self.pose.integrate(motion, Integration::Arc);
        self.turned += motion.turn;
        self.twist = Twist::new(motion.length / time, motion.turn / time);
        self.now = end;
        let sweep = self.model.laser.as_ref().map_or(0.0, |(laser, _)| laser.sweep.duration);
        self.track.record(end, self.pose, sweep);
    }

    /// Takes the measurements that became due after `before`.
    fn measure(&mut self, before: Stamp) {
        if let Some((compass, timing)) = &self.model.compass
            && let Some(disturbance) = self.due(Sensor::Compass, timing, before)
        {
            let time = self.now.seconds();
            let read =
                compass.read(self.pose.heading, time, &mut self.compass).rotated_by(disturbance.offset);
            send(&mut self.headings, read, self.now, timing, &disturbance);
        }
        if let Some((laser, timing)) = &self.model.laser
            && let Some(disturbance) = self.due(Sensor::Laser, timing, before)
        {
            let walls = self.model.arena.walls();
            let mut scan = if laser.sweep.duration > 0.0 {
                laser.sweep(walls, &self.track, self.now, &mut self.laser)
            } else {
                laser.scan(walls, self.pose, &mut self.laser)
            };
            let stamp_offset = disturbance.stamp_offset + laser.sweep.stamp_age();
            let disturbance = Disturbance { stamp_offset, ..disturbance };
            for range in &mut scan.ranges {
                *range += disturbance.offset;
            }
            if disturbance.scan.is_none() || self.scan_before.is_none() {
                self.scan_before = Some(scan.clone());
            }
            if let (Some(fault), Some(before)) = (disturbance.scan, &self.scan_before) {
                fault.apply(&mut scan, before);
            }
            send(&mut self.scans, scan, self.now, timing, &disturbance);
        }
    }

    /// Disturbance of `sensor` if it measures now. `None`: not due since `before`, or dropout.
    fn due(&self, sensor: Sensor, timing: &Timing, before: Stamp) -> Option<Disturbance> {
        let count = |at: Stamp| at.nanoseconds() / nanoseconds(timing.period);
        (count(self.now) > count(before))
            .then(|| disturbance(&self.model.faults, sensor, self.now))
            .filter(|disturbance| !disturbance.dropout)
    }

    /// Wheel travel since the previous call, measured by the encoders \[m].
    fn rims(&mut self) -> WheelPair<f64> {
        let motor = &self.model.motor;
        let counted = WheelPair::new(self.wheels.right.counted(motor), self.wheels.left.counted(motor));
        let turned = WheelPair::new(counted.right - self.counted.right, counted.left - self.counted.left);
        self.counted = counted;
        let disturbance = disturbance(&self.model.faults, Sensor::Encoders, self.now);
        let factor = if disturbance.dropout { 0.0 } else { 1.0 + disturbance.offset };
        self.model.drive.wheel_travel_from_angle(turned).scaled(factor)
    }

    /// Mean yaw rate \[rad/s] over the step of `period` \[s], measured by the gyroscope.
    fn yaw_rate(&mut self, period: f64) -> Option<f64> {
        let model = self.model.gyroscope.as_ref()?;
        Some(self.gyroscope.read(model, self.turned, period))
    }

    /// Applies the displacements that begin in this time interval.
    fn push(&mut self, time: Range<Stamp>) {
        for fault in &self.model.faults {
            if let FaultKind::Displaced([x, y, turn]) = fault.kind
                && time.contains(&fault.during.start)
            {
                let heading = self.pose.heading.rotated_by(turn);
                self.pose = Pose::new(self.pose.x + x, self.pose.y + y, heading);
            }
        }
    }
}

/// Converts to nanoseconds, at least 1.
fn nanoseconds(seconds: f64) -> i64 {
    Stamp::from_seconds(seconds).nanoseconds().max(1)
}

fn send<T>(under_way: &mut UnderWay<T>, value: T, now: Stamp, timing: &Timing, disturbance: &Disturbance) {
    let arrival = now.after(timing.latency.max(0.0));
    under_way.push((arrival, Stamped::new(now.after(-disturbance.stamp_offset), value)));
}

fn arrived<T>(under_way: &mut UnderWay<T>, now: Stamp) -> Vec<Stamped<T>> {
    under_way.extract_if(.., |(arrival, _)| *arrival <= now).map(|(_, message)| message).collect()
}

#[cfg(test)]
mod tests;
