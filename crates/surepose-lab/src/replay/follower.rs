//! What all replays with a laser share: odometry rolls the estimate on, scans laid on the walls correct it.

use surepose::closed_loop::{Localiser, Sensed, Sight, Signal, Witness};
use surepose::{
    Aligned, Aligner, Alignment, Angle, Belief, Body, Drive, Ekf, Estimator, Eye, Gate, Integration, Laser,
    Map, Measurement, Motion, Outcome, Point, Pose, RangeFinder, Recognition, Refusal, Scan, Stamp, Stamped,
    Travel, Twist, Wall, Wheels, param,
};
use surepose_data::Config;
use surepose_data::recording;
use surepose_data::wall_map::WallMap;

/// The most beams of a scan.
const MOST_BEAMS: usize = 2048;

/// What a replay assumes of odometry and laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowerSettings {
    /// Distance between the rims that scatter so \[m]. Where a recording tells poses instead of wheels, this only says how
    /// the variance of the heading follows from that of the way.
    pub track: f64,
    /// Variance of a rim's travel for each metre driven \[m²/m].
    pub rim_variance_per_metre: f64,
    /// Variance of a rim's travel for each radian turned \[m²/rad].
    pub rim_variance_per_radian: f64,
    /// Standard deviation of a range \[m].
    pub range_std: f64,
    /// Standard deviation of a bearing \[rad].
    pub bearing_std: f64,
    /// A consistent scan passes the gate with this probability.
    pub gate_probability: f64,
    /// How scans are laid on walls.
    pub aligner: Aligner<f64>,
    /// Standard deviations of the pose that the replay starts from: x \[m], y \[m], θ \[rad].
    pub start_std: [f64; 3],
}

impl FollowerSettings {
    /// What fits recordings of robots with a laser better than the defaults, before the user's own values.
    ///
    /// Odometry is trusted for 12 cm and 12° over a metre, several times its usual scatter: logs skip (belgioioso has jumps
    /// of 0.45 m and of 32°), and the laser puts the pose right to centimetres anyway.
    pub fn preset(name: &'static str) -> Config {
        Self::scattering(name, 0.03)
    }

    /// The same for odometry whose rims scatter by this variance over a metre, and over a radian \[m²].
    pub(super) fn scattering(name: &'static str, rim_variance: f64) -> Config {
        let values = [
            (&param::TRACK, 1.2),
            (&param::RIM_VARIANCE_PER_METRE, rim_variance),
            (&param::RIM_VARIANCE_PER_RADIAN, rim_variance),
            (&param::LASER_RANGE_STD, 0.03),
            (&param::LASER_BEARING_STD, 0.3),
        ];
        Config::default().with_preset(name, &values)
    }

    /// The settings of a configuration.
    pub fn of(config: &Config) -> Self {
        let number = |parameter| config.number(parameter);
        Self {
            track: number(&param::TRACK),
            rim_variance_per_metre: number(&param::RIM_VARIANCE_PER_METRE),
            rim_variance_per_radian: number(&param::RIM_VARIANCE_PER_RADIAN),
            range_std: number(&param::LASER_RANGE_STD),
            bearing_std: number(&param::LASER_BEARING_STD),
            gate_probability: number(&param::GATE_PROBABILITY),
            aligner: Aligner {
                gate: Gate::new(0.999),
                farthest_off: 0.7,
                fewest_beams: 5,
                least_share: 0.33,
                wall_offset_std: 0.01,
                wall_direction_std: 0.005,
                scan_std: [0.02, 0.02, 0.3_f64.to_radians()],
            },
            start_std: [0.02, 0.02, 0.5_f64.to_radians()],
        }
    }
}

impl FollowerSettings {
    /// The filter: the variance of each travel is given with it, so δ plays no part.
    pub(super) fn ekf(&self) -> Ekf<f64> {
        let drive = Drive::new(1.0, self.track);
        Ekf { drive, delta: 0.0, integration: Integration::Arc }
    }

    /// What the rims rolled for `motion`, as vague as this odometry is.
    pub(super) fn travel(&self, motion: Motion<f64>) -> Travel<f64> {
        let rims = self.ekf().drive.rims_from_twist(Twist::new(motion.length, motion.turn));
        let variance = self.rim_variance_per_metre * motion.length.abs()
            + self.rim_variance_per_radian * motion.turn.abs();
        Travel { rims, variance: Wheels::new(variance, variance) }
    }

    /// The laser that took a scan.
    pub(super) fn laser(&self, mount: recording::Mount) -> RangeFinder<f64> {
        RangeFinder {
            body_from_laser: mounted(mount),
            range_std: self.range_std,
            bearing_std: self.bearing_std,
            nearest: NEAREST,
            farthest: FARTHEST,
        }
    }
}

/// A recorded scan in the core's form.
pub(super) fn scan_of(scan: &recording::Scan) -> Scan<'_, f64> {
    Scan {
        first_bearing: Angle::wrapped(scan.angle_min),
        bearing_step: scan.angle_increment,
        ranges: &scan.ranges,
    }
}

/// An estimate that follows a robot with a laser among known walls.
#[derive(Debug)]
pub(super) struct Follower {
    pub(super) localiser: Box<Localiser<f64, 64, MOST_BEAMS>>,
    settings: FollowerSettings,
    walls: Vec<Wall<f64>>,
}

/// What became of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Seen {
    /// It lies on walls; what the filter made of that.
    Tried(Outcome, Aligned<f64>),
    /// Too few of its beams lie on walls of the map.
    Unconvincing,
    /// No wall of the map was in sight.
    NoWall,
    /// The time at which it was taken is not remembered: the estimator counted that.
    OutOfTime,
    /// It cannot be read.
    Unusable,
}

impl Seen {
    /// The name under which a report counts a scan that the filter never saw.
    pub(super) fn skipped_as(&self) -> Option<&'static str> {
        match self {
            Self::Tried(..) | Self::OutOfTime => None,
            Self::Unconvincing => Some("unconvincing_scan"),
            Self::NoWall => Some("no_wall_in_sight"),
            Self::Unusable => Some("unusable_scan"),
        }
    }
}

/// How much of what came back to the laser lies on walls.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shares {
    sum: f64,
    scans: f64,
}

impl Shares {
    /// Adds a scan; one that lies on no wall adds nothing to the sum.
    pub(super) fn add(&mut self, seen: &Seen) {
        self.scans += 1.0;
        if let Seen::Tried(_, aligned) = seen {
            self.sum += f64::from(aligned.beams) / f64::from(aligned.returned.max(1));
        }
    }

    /// The mean over scans.
    pub(super) fn mean(self) -> Option<f64> {
        (self.scans > 0.0).then(|| self.sum / self.scans)
    }
}

impl Follower {
    /// Starts at `pose` at `stamp`.
    pub(super) fn new(
        walls: Vec<Wall<f64>>,
        settings: FollowerSettings,
        stamp: Stamp,
        pose: Pose<Map, Body, f64>,
    ) -> Self {
        let gate = Gate::new(settings.gate_probability);
        let belief = Belief::new(pose, settings.start_std);
        // The history is as long as its memory: some replays count records, where others count seconds.
        let estimator = Estimator::new(settings.ekf(), gate, f64::INFINITY, stamp, belief);
        // Where its laser is, each scan says.
        let laser = settings.laser(recording::Mount::default());
        let eye = Eye::new(laser, Recognition::Beams(settings.aligner));
        Self { localiser: Box::new(Localiser { estimator, eye }), settings, walls }
    }

    /// Takes other walls for the map.
    pub(super) fn know(&mut self, walls: Vec<Wall<f64>>) {
        self.walls = walls;
    }

    /// Rolls on by `motion` until `stamp`.
    pub(super) fn roll(&mut self, stamp: Stamp, motion: Motion<f64>) {
        // A refusal is in the estimator's tally, and so in the report.
        let travel = self.settings.travel(motion);
        self.localiser.sense(&Sensed { stamp, travel, signals: &[] }, travel, &[], &mut ());
    }

    /// Corrects the belief by a scan that was taken at `stamp`.
    pub(super) fn see(&mut self, stamp: Stamp, scan: &recording::Scan) -> Seen {
        let is_remembered = self.localiser.estimator.belief_at(stamp).is_some();
        self.localiser.eye.laser.body_from_laser = mounted(scan.mount);
        let mut note = Note::default();
        self.localiser.hear(&Stamped::new(stamp, Signal::Scan(scan_of(scan))), &self.walls, &mut note);
        match (note.alignment, note.outcome) {
            (None, _) if !is_remembered => Seen::OutOfTime,
            (None, _) => Seen::Unusable,
            (Some(Alignment::Nowhere), _) => Seen::NoWall,
            (Some(Alignment::Found(aligned)), Some(outcome)) => Seen::Tried(outcome, aligned),
            (Some(_), _) => Seen::Unconvincing,
        }
    }
}

/// What became of the scan that was heard last.
#[derive(Default)]
struct Note {
    outcome: Option<Outcome>,
    alignment: Option<Alignment<f64>>,
}

impl<const N: usize> Witness<f64, N> for Note {
    fn rolled(&mut self, _: Stamp, _: Wheels<f64>, _: Travel<f64>, _: Result<(), Refusal>) {}

    fn measured(&mut self, _: &Stamped<Measurement<f64>>, outcome: Outcome) {
        self.outcome = Some(outcome);
    }

    fn looked(&mut self, _: &mut Estimator<f64, N>, sight: &Sight<'_, f64>) {
        self.alignment = sight.seen.alignment;
    }
}

/// Returns from nearer than this are the robot's own \[m].
pub(super) const NEAREST: f64 = 0.02;

/// Returns from farther away are not used \[m]: there, a degree of heading moves a beam across half a room.
pub(super) const FARTHEST: f64 = 30.0;

/// Where the laser is, in the core's form.
pub(crate) fn mounted(mount: recording::Mount) -> Pose<Body, Laser, f64> {
    Pose::new(mount.x, mount.y, Angle::wrapped(mount.heading))
}

/// The walls of a map in the core's form, each as well known as the file says; a wall that is none is left out.
pub fn walls_of(map: &WallMap) -> Vec<Wall<f64>> {
    let walls = map.walls.iter().filter_map(|wall| {
        let [from, to] = [wall.from, wall.to].map(|[x, y]| Point::new(x, y));
        let known = Wall::between(from, to).ok()?;
        Some(wall.covariance.map_or(known, |c| known.known_to([c.r_r, c.r_psi, c.psi_psi])))
    });
    walls.collect()
}
