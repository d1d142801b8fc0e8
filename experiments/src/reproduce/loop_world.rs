//! The loop world: a known course between known walls, odometry with 5 % wheel noise, a compass and a laser.

use surepose::control::{InvalidPath, Path};
use surepose::estimation::{Belief, WheelOdometry};
use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::kinematics::{Integration, Motion, Twist, WheelPair};
use surepose::localization::LoopObserver;
use surepose::map::{MapView, Wall};
use surepose::time::{Stamp, Stamped};
use surepose_config::{Config, RobotLocalizer, ScanMethod};
use surepose_sim::robot::{walls_from_segments, with_sensor_input};
use surepose_sim::{Arena, Clutter, CompassModel, LOOP_SPEED, LaserModel, Seed, Slip, Stream, loop_course};

/// One tick's time \[s].
const PERIOD: f64 = 0.1;
/// The length of a run \[s].
const DURATION: f64 = 60.0;
/// How well the start is known: x, y \[m] and heading \[rad].
const START_STD: [f64; 3] = [0.01, 0.01, 0.5 * core::f64::consts::PI / 180.0];

/// The world in which localisation is judged, and its robot.
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
    /// The world with the wheels, the compass and the laser of `config`, and with things in its way that are on no map.
    ///
    /// The robot errs as much as the filter is told: what is compared is how well the filter can do.
    ///
    /// # Errors
    /// Never in truth: the world's measures are constants that make a path.
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
            compass: CompassModel { std: config.compass().std, offset: 0.0 },
            robot: config.clone(),
        })
    }

    /// One run round the course.
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

    /// Which wall each beam of `scan` ended on, by number, as far as the true pose can tell.
    ///
    /// A beam belongs to the wall that it is aimed at, unless it is off it by six standard deviations: then it hit
    /// something else, or passed the wall's edge.
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

/// A run round the course, tick by tick.
pub(super) struct Run<'a> {
    world: &'a LoopWorld,
    tick: u32,
    truth: Pose<Map, Body, f64>,
    slip: Stream,
    compass: Stream,
    laser: Stream,
    start: Stream,
}

/// What a tick brings.
pub(super) struct LoopTick {
    /// Where the robot is.
    pub truth: Pose<Map, Body, f64>,
    /// What its sensors say: one heading and one scan, measured now.
    pub sensed: surepose_sim::SensorOutput,
}

impl Run<'_> {
    /// The robot, told where it starts with the error that it is told to expect.
    pub(super) fn robot(&mut self) -> Box<RobotLocalizer> {
        let [x, y, heading] = START_STD.map(|std| std * self.start.normal());
        let truth = self.truth;
        let initial = Pose::new(truth.x + x, truth.y + y, truth.heading.rotated_by(heading));
        self.world.robot.unsupervised_localizer(ScanMethod::Lines, Belief::new(initial, START_STD))
    }

    /// Where `robot` believes to be after a tick, at which `observer` hears of everything.
    pub(super) fn sense(
        &self,
        robot: &mut RobotLocalizer,
        sensed: &surepose_sim::SensorOutput,
        observer: &mut impl LoopObserver<f64>,
    ) -> Belief<f64> {
        // Nobody tells the wheels anything here, and their encoders are never refused.
        let commanded = WheelOdometry::from_command(WheelPair::zero());
        with_sensor_input(sensed, &self.world.robot.compass(), |sensed| {
            robot.update(sensed, commanded, &MapView::from_walls(&self.world.walls), observer)
        })
    }
}

impl Iterator for Run<'_> {
    type Item = LoopTick;

    /// Holds, for one period, the twist that turns the robot as the course turns there.
    ///
    /// The robot drives what it would be commanded, arcs that begin and end with a period, and so cuts the joints
    /// of the course's legs by less than a millimetre.
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
                rims: Slip { delta: world.robot.ekf().delta }.apply(travel, &mut self.slip),
                headings: vec![Stamped::new(
                    stamp,
                    world.compass.read(self.truth.heading, &mut self.compass),
                )],
                scans: vec![Stamped::new(
                    stamp,
                    world.laser.scan(world.arena.walls(), self.truth, &mut self.laser),
                )],
            },
        })
    }
}

/// How fast the range of a wall changes at beam `i` \[m/rad], by the neighbour that meets the same wall.
fn slope(ranges: &[f64], i: usize, step: f64) -> f64 {
    let neighbours = [i.checked_sub(1), Some(i + 1)].into_iter().flatten();
    let steps = neighbours.filter_map(|k| ranges.get(k)).map(|range| (range - ranges[i]).abs() / step);
    steps.filter(|slope| slope.is_finite()).fold(0.0, f64::max)
}
