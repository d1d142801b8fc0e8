//! The loop world: a course between known walls, 5 % wheel noise, a compass and a laser.

use surepose::control::{InvalidPath, Path};
use surepose::estimation::{Belief, WheelOdometry};
use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::kinematics::{Integration, Motion, Twist, WheelPair};
use surepose::lidar::ScanTiming;
use surepose::localization::LoopObserver;
use surepose::map::{MapView, Wall};
use surepose::time::{Stamp, Stamped};
use surepose_config::{Config, RobotLocalizer, ScanMethod};
use surepose_sim::robot::{walls_from_segments, with_sensor_input};
use surepose_sim::{Arena, Clutter, CompassModel, LOOP_SPEED, LaserModel, Seed, Slip, Stream, loop_course};

/// Period of a tick \[s].
const PERIOD: f64 = 0.1;
/// Duration of a run \[s].
const DURATION: f64 = 60.0;
/// Standard deviations of the start pose: x, y \[m] and heading \[rad].
const START_STD: [f64; 3] = [0.01, 0.01, 0.5 * core::f64::consts::PI / 180.0];

/// Benchmark world of localization, with its robot.
#[derive(Clone, Debug)]
pub struct LoopWorld {
    arena: Arena,
    course: Path<f64, 8>,
    walls: Vec<Wall<f64>>,
    laser: LaserModel,
    compass: CompassModel,
    robot: Config,
}

impl LoopWorld {
    /// Creates the world with the wheels, compass and laser of `config`, and obstacles that are not on the
    /// map.
    ///
    /// The robot's noise is that of the filter's parameters, so the result shows the accuracy of a correctly
    /// tuned filter. Its models are exact, as in the paper: the filter considers no model error that `config` does not set.
    ///
    /// # Errors
    /// None in practice: the dimensions of the course are valid constants.
    pub fn new(config: &Config, clutter: Clutter) -> Result<Self, InvalidPath> {
        let (arena, laser) = (Arena::loop_world(), config.laser());
        Ok(Self {
            course: loop_course()?,
            walls: walls_from_segments(arena.walls()),
            arena,
            laser: LaserModel {
                body_from_laser: laser.body_from_laser,
                range_std: laser.range_std,
                bearing_std: laser.bearing_std,
                clutter,
                ..LaserModel::half_circle(laser.beams)
            },
            compass: CompassModel { std: config.compass().std, ..CompassModel::default() },
            robot: config.clone(),
        })
    }

    /// The world with a robot whose filter considers typical model errors, which this world does not have.
    #[must_use]
    pub fn with_model_errors(self, config: &Config) -> Self {
        Self { robot: config.clone().with_typical_model_errors(), ..self }
    }

    /// Starts one run on the course.
    pub(super) fn run(&self, seed: Seed) -> Run<'_> {
        Run {
            world: self,
            tick: 0,
            truth: self.at(0),
            slip: seed.stream("slip"),
            compass: seed.stream("compass"),
            laser: seed.stream("laser"),
            start: seed.stream("start"),
        }
    }

    /// Returns the index of the wall that each beam of `scan` hit, by the true pose.
    ///
    /// A beam belongs to the wall that it is aimed at, unless the range is off by six standard deviations. It
    /// then hit something else or passed the wall's edge.
    pub(super) fn seen_walls(
        &self,
        truth: Pose<Map, Body, f64>,
        scan: &surepose_sim::SimulatedScan,
    ) -> Vec<Option<usize>> {
        let exact =
            LaserModel { range_std: 0.0, bearing_std: 0.0, clutter: Clutter::default(), ..self.laser };
        let mut unused = Seed(0).stream("unused");
        let mut aims = vec![(f64::INFINITY, None); self.laser.beams];
        for (number, wall) in self.arena.walls().iter().enumerate() {
            let aimed = exact.scan(std::slice::from_ref(wall), truth, &mut unused);
            for (i, (aim, range)) in aims.iter_mut().zip(&aimed.ranges).enumerate() {
                if *range < aim.0 {
                    let slope = slope(&aimed.ranges, i, aimed.angle_increment);
                    let std = (self.laser.range_std).hypot(self.laser.bearing_std * slope);
                    *aim = (*range, ((scan.ranges[i] - range).abs() < 6.0 * std).then_some(number));
                }
            }
        }
        aims.into_iter().map(|(_, wall)| wall).collect()
    }

    fn at(&self, tick: u32) -> Pose<Map, Body, f64> {
        let place = self.course.at(LOOP_SPEED * PERIOD * f64::from(tick)).map_from_target;
        Pose::new(place.x, place.y, place.heading)
    }
}

/// A run on the course, tick by tick.
pub(super) struct Run<'a> {
    world: &'a LoopWorld,
    tick: u32,
    truth: Pose<Map, Body, f64>,
    slip: Stream,
    compass: Stream,
    laser: Stream,
    start: Stream,
}

/// Output of one tick.
pub(super) struct LoopTick {
    /// True pose of the robot.
    pub truth: Pose<Map, Body, f64>,
    /// Sensor output: one heading and one scan, measured now.
    pub sensed: surepose_sim::SensorOutput,
}

impl Run<'_> {
    /// Creates the robot with the erroneous start pose of this run.
    pub(super) fn robot(&mut self) -> Box<RobotLocalizer> {
        let [x, y, heading] = START_STD.map(|std| std * self.start.normal());
        let truth = self.truth;
        let initial = Pose::new(truth.x + x, truth.y + y, truth.heading.rotated_by(heading));
        self.world.robot.unsupervised_localizer(ScanMethod::Lines, Belief::new(initial, START_STD))
    }

    /// Processes a tick and returns the belief; `observer` receives all events.
    pub(super) fn sense(
        &self,
        robot: &mut RobotLocalizer,
        sensed: &surepose_sim::SensorOutput,
        observer: &mut impl LoopObserver<f64>,
    ) -> Belief<f64> {
        // There is no command here, and the encoders are never rejected.
        let commanded = WheelOdometry::from_command(WheelPair::zero());
        with_sensor_input(sensed, &self.world.robot.compass(), &ScanTiming::default(), |sensed| {
            robot.update(sensed, commanded, &MapView::from_walls(&self.world.walls), observer)
        })
    }
}

impl Iterator for Run<'_> {
    type Item = LoopTick;

    /// Holds, for one period, the twist that turns the robot as the course turns there.
    ///
    /// The robot drives arcs that start and end with a period, so it cuts the joints of the course's segments
    /// by less than 1 mm.
    fn next(&mut self) -> Option<LoopTick> {
        if f64::from(self.tick) * PERIOD >= DURATION - PERIOD / 2.0 {
            return None;
        }
        self.tick += 1;
        let world = self.world;
        let turn: Angle<f64> = world.at(self.tick).heading - self.truth.heading;
        let motion = Motion { length: LOOP_SPEED * PERIOD, turn: turn.radians() };
        self.truth = self.truth.integrate(motion, Integration::Arc);
        let travel = world.robot.drive().wheel_speeds_from_twist(Twist::new(motion.length, motion.turn));
        let stamp = Stamp::from_seconds(f64::from(self.tick) * PERIOD);
        Some(LoopTick {
            truth: self.truth,
            sensed: surepose_sim::SensorOutput {
                stamp,
                yaw_rate: None,
                rims: Slip { delta: world.robot.ekf().delta }.apply(travel, &mut self.slip),
                headings: vec![Stamped::new(
                    stamp,
                    world.compass.read(self.truth.heading, 0.0, &mut self.compass),
                )],
                scans: vec![Stamped::new(
                    stamp,
                    world.laser.scan(world.arena.walls(), self.truth, &mut self.laser),
                )],
            },
        })
    }
}

/// Returns the derivative of the range of a wall at beam `i` \[m/rad], from the neighbor on the same wall.
fn slope(ranges: &[f64], i: usize, step: f64) -> f64 {
    let neighbors = [i.checked_sub(1), Some(i + 1)].into_iter().flatten();
    let steps = neighbors.filter_map(|k| ranges.get(k)).map(|range| (range - ranges[i]).abs() / step);
    steps.filter(|slope| slope.is_finite()).fold(0.0, f64::max)
}
