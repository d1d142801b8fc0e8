//! The loop world: a known course between known walls, odometry with 5 % wheel noise, a compass and a laser.

use surepose::{
    Angle, Belief, Body, Compass, Ekf, Integration, Map, Motion, NotAPath, NotAWall, Path, Pose, RangeFinder,
    Scan, Wall, Wheels,
};
use surepose_data::Config;
use surepose_sim::{Arena, Clutter, CompassModel, LOOP_SPEED, LaserModel, Seed, Slip, Stream, loop_course};

/// One tick's time \[s].
pub(super) const PERIOD: f64 = 0.1;
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
    ekf: Ekf<f64>,
}

impl LoopWorld {
    /// The world with the wheels, the compass and the laser of `config`, and with things in its way that are on no map.
    ///
    /// The robot errs as much as the filter is told: what is compared is how well the filter can do.
    ///
    /// # Errors
    /// Never in truth: the world's measures are constants that make a path and walls.
    pub fn new(config: &Config, clutter: Clutter) -> Result<Self, LoopWorldError> {
        let arena = Arena::loop_world();
        let walls = arena.walls().iter().map(|wall| Wall::between(wall.start, wall.end));
        let laser = config.laser();
        Ok(Self {
            course: loop_course()?,
            walls: walls.collect::<Result<_, _>>()?,
            arena,
            laser: LaserModel {
                body_from_laser: laser.body_from_laser,
                range_std: laser.range_std,
                bearing_std: laser.bearing_std,
                clutter,
                ..LaserModel::half_circle(laser.beams)
            },
            compass: CompassModel { std: config.compass().std, offset: 0.0 },
            ekf: config.ekf(),
        })
    }

    /// The walls as the robot's map has them.
    pub fn map(&self) -> &[Wall<f64>] {
        &self.walls
    }

    /// The laser as the robot knows it.
    pub fn range_finder(&self) -> RangeFinder<f64> {
        RangeFinder {
            body_from_laser: self.laser.body_from_laser,
            range_std: self.laser.range_std,
            bearing_std: self.laser.bearing_std,
            nearest: 0.0,
            farthest: self.laser.max_range,
        }
    }

    /// The filter with the constants of this robot.
    pub fn ekf(&self) -> Ekf<f64> {
        self.ekf
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
        scan: &surepose_sim::Scan,
    ) -> Vec<Option<usize>> {
        let exact =
            LaserModel { range_std: 0.0, bearing_std: 0.0, clutter: Clutter::default(), ..self.laser };
        let mut unused = Seed(0).stream("unused");
        let mut aims = vec![(f64::INFINITY, None); self.laser.beams];
        for (number, wall) in self.arena.walls().iter().enumerate() {
            let aimed = exact.scan(std::slice::from_ref(wall), truth, &mut unused);
            for (i, (aim, range)) in aims.iter_mut().zip(&aimed.ranges).enumerate() {
                if *range < aim.0 {
                    let slope = slope(&aimed.ranges, i, aimed.bearing_step);
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

/// The loop world could not be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LoopWorldError {
    /// Its course is none.
    #[error("the loop world's course: {0}")]
    Course(#[from] NotAPath),
    /// One of its walls is none.
    #[error("the loop world's walls: {0}")]
    Wall(#[from] NotAWall),
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
pub(super) struct Tick {
    /// Since the start \[s].
    pub time: f64,
    pub truth: Pose<Map, Body, f64>,
    /// How far the rims rolled, by the encoders \[m].
    pub rims: Wheels<f64>,
    pub compass: Compass<f64>,
    pub scan: surepose_sim::Scan,
}

impl Run<'_> {
    /// What the robot believes at the start: the truth with the errors that it is told to expect.
    pub(super) fn first_belief(&mut self) -> Belief<f64> {
        let [x, y, heading] = START_STD.map(|std| std * self.start.normal());
        let truth = self.truth;
        Belief::new(Pose::new(truth.x + x, truth.y + y, truth.heading.turned(heading)), START_STD)
    }
}

impl Iterator for Run<'_> {
    type Item = Tick;

    /// Holds, for one period, the twist that turns the robot as the course turns there.
    ///
    /// The robot drives what it would be commanded, arcs that begin and end with a period, and so cuts the joints
    /// of the course's legs by less than a millimetre.
    fn next(&mut self) -> Option<Tick> {
        if f64::from(self.tick) * PERIOD >= DURATION - PERIOD / 2.0 {
            return None;
        }
        self.tick += 1;
        let world = self.world;
        let turn: Angle<f64> = world.at(self.tick).heading - self.truth.heading;
        let motion = Motion { length: LOOP_SPEED * PERIOD, turn: turn.radians() };
        self.truth = self.truth.moved(motion, Integration::Arc);
        let swing = motion.turn * world.ekf.drive.track / 2.0;
        let travel = Wheels::new(motion.length + swing, motion.length - swing);
        Some(Tick {
            time: f64::from(self.tick) * PERIOD,
            truth: self.truth,
            rims: Slip { delta: world.ekf.delta }.apply(travel, &mut self.slip),
            compass: Compass {
                heading: world.compass.read(self.truth.heading, &mut self.compass),
                std: world.compass.std,
            },
            scan: world.laser.scan(world.arena.walls(), self.truth, &mut self.laser),
        })
    }
}

/// The core's view of a simulated scan.
pub(super) fn as_scan(scan: &surepose_sim::Scan) -> Scan<'_, f64> {
    Scan {
        first_bearing: Angle::wrapped(scan.first_bearing),
        bearing_step: scan.bearing_step,
        ranges: &scan.ranges,
    }
}

/// How fast the range of a wall changes at beam `i` \[m/rad], by the neighbour that meets the same wall.
fn slope(ranges: &[f64], i: usize, step: f64) -> f64 {
    let neighbours = [i.checked_sub(1), Some(i + 1)].into_iter().flatten();
    let steps = neighbours.filter_map(|k| ranges.get(k)).map(|range| (range - ranges[i]).abs() / step);
    steps.filter(|slope| slope.is_finite()).fold(0.0, f64::max)
}
