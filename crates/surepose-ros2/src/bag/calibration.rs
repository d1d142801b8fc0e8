//! What a recording has to calibrate from: how far the wheels turned by the base's own odometry, scans, and headings.

use core::f64::consts::TAU;
use std::collections::BTreeMap;
use std::path::Path;

use surepose::closed_loop::Controller;
use surepose::{Angle, Compass, Measurement, Stamp, Stamped, Wheels};
use surepose_data::Config;
use surepose_data::config::CompassMounting;
use surepose_data::recording::{Mount, Scan, StampedTicks};
use surepose_lab::calibrate::{Options, Recording, StampedHeading};

use super::prologue::{Prologue, REFERENCE_STD};
use super::reader::{Bag, Role, Said};
use super::{BagError, Truncation};
use crate::convert::Refused;
use crate::message::{LaserScan, Odometry};
use crate::mounting::LaserMount;
use crate::names::Names;
use crate::pilot::{Heard, Odometer};
use crate::sense;

/// The wheels' counters, which odometry's poses do not have, are made up so fine.
const TICKS_PER_TURN: f64 = 1e5;

/// How a wall's distance \[m] and direction \[rad] scatter beyond what a usual laser's noise explains.
const WALL_STD: (f64, f64) = (0.01, 0.5 * TAU / 360.0);

/// No mirror takes longer for a turn \[s].
const LONGEST_SWEEP: f64 = 1.0;

/// A recording made ready, and what is known beforehand.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// What calibration reads. The counters come once in a period of the loop, for which δ is wanted.
    pub recording: Recording,
    /// Where it begins: the configuration's robot, with the laser's reach and the time of its sweep from the scans, and the
    /// heading at the start from the truth, where there is one.
    pub options: Options,
    /// What was not used, by name and count.
    pub skipped: BTreeMap<&'static str, u64>,
    /// Where the laser is taken to sit at first, and who says so; nothing, without a scan.
    pub mounted: Option<String>,
    /// The files that are cut short.
    pub truncations: Vec<Truncation>,
}

/// Reads the recording at `path`, of which the topics are called as in `names`, of a base that takes its wheels for those
/// of `config`: by these its odometry is turned back into how far they turned. `compass`: whether its headings count.
///
/// # Errors
/// [`BagError`], where it is no recording, or is damaged.
pub fn recorded(path: &Path, config: &Config, names: &Names, compass: bool) -> Result<Recorded, BagError> {
    let wanted: &[Role] = if compass { &[Role::Scan, Role::Imu] } else { &[Role::Scan] };
    let bag = Bag::open(path, names, wanted)?;
    let mut options = Options::of(config);
    (options.wall_distance_std, options.wall_direction_std) = WALL_STD;
    let mut skipped = BTreeMap::new();
    let prologue = Prologue::of(&bag, config, |why| *skipped.entry(why.name()).or_default() += 1)?;
    let start = prologue.start();
    options.start_heading = start.map(|start| Compass { heading: start.heading, std: REFERENCE_STD[2] });
    let mut gathering = Gathering::new(config, options, prologue.mount, skipped);
    // Where the compass' zero is, is to be found.
    let mounting = CompassMounting { offset: Angle::zero(), ..config.compass() };
    bag.messages(|said| {
        let refused = match said {
            Said::Odometry(odometry) => gathering.roll(&odometry),
            Said::Scan(scan) => gathering.see(scan),
            Said::Imu(imu) if compass => sense::heading(&imu, &mounting).map(|heard| gathering.turn(&heard)),
            Said::Imu(_) | Said::Truth(_) | Said::Joints(_) => Ok(()),
        };
        if let Err(why) = refused {
            gathering.skip(why.name());
        }
    })?;
    gathering.recorded.truncations = bag.truncations().to_vec();
    Ok(gathering.finished())
}

/// A recording while it is read.
struct Gathering {
    recorded: Recorded,
    mount: LaserMount,
    controller: Controller<f64>,
    odometer: Option<Odometer>,
    /// How far the wheels turned since the first odometry \[rad].
    turned: Wheels<f64>,
}

impl Gathering {
    fn new(
        config: &Config,
        options: Options,
        mount: LaserMount,
        skipped: BTreeMap<&'static str, u64>,
    ) -> Self {
        let recording = Recording {
            ticks_per_turn: TICKS_PER_TURN,
            ticks: Vec::new(),
            scans: Vec::new(),
            headings: Vec::new(),
        };
        Self {
            recorded: Recorded { recording, options, skipped, mounted: None, truncations: Vec::new() },
            mount,
            controller: config.controller(),
            odometer: None,
            turned: Wheels::rest(),
        }
    }

    fn roll(&mut self, odometry: &Odometry) -> Result<(), Refused> {
        let at = sense::odometry(odometry)?;
        let Some(odometer) = &mut self.odometer else {
            self.odometer = Some(Odometer::starting(at));
            self.count(at.stamp);
            return Ok(());
        };
        let Some(rims) = odometer.roll(&self.controller, at)? else { return Ok(()) };
        // Where odometry was reset the wheels turned as nobody knows; the walls tell how far the robot came meanwhile.
        if (rims.right + rims.left).is_finite() {
            let turns = self.controller.drive.turns_from_rims(rims);
            self.turned = Wheels::new(self.turned.right + turns.right, self.turned.left + turns.left);
        } else {
            self.skip("odometry_jump");
        }
        self.count(at.stamp);
        Ok(())
    }

    fn count(&mut self, stamp: Stamp) {
        let ticks = |turned: f64| (turned / TAU * TICKS_PER_TURN).round() as i64;
        let (left, right) = (ticks(self.turned.left), ticks(self.turned.right));
        self.recorded.recording.ticks.push(StampedTicks { time: stamp.seconds(), left, right });
    }

    fn see(&mut self, message: LaserScan) -> Result<(), Refused> {
        let sweep = f64::from(message.time_increment) * message.ranges.len() as f64;
        let mounting = self.mount.of(&message.header.frame_id)?;
        let heard = sense::scan(message, mounting)?;
        let Stamped { stamp, value: Heard::Scan(scan) } = heard else { return Ok(()) };
        let time = stamp.seconds();
        let Recorded { recording, options, .. } = &mut self.recorded;
        if recording.scans.is_empty() {
            (options.nearest, options.farthest) = (scan.nearest.max(options.nearest), scan.farthest);
            options.nominal = options.nominal.with_laser(scan.body_from_laser);
            options.sweep_period =
                Some(sweep).filter(|sweep| (0.0..LONGEST_SWEEP).contains(sweep)).unwrap_or(0.0);
        }
        let reach = scan.nearest..scan.farthest;
        let returned = |range: f64| if reach.contains(&range) { range } else { f64::INFINITY };
        let mut ranges: Vec<f64> = scan.ranges.into_iter().map(returned).collect();
        let (mut angle_min, mut angle_increment) = (scan.first_bearing, scan.bearing_step);
        // Some lasers turn clockwise.
        if angle_increment < 0.0 {
            ranges.reverse();
            angle_min += angle_increment * ranges.len().saturating_sub(1) as f64;
            angle_increment = -angle_increment;
        }
        let odometry_before = recording.ticks.len();
        let mount = Mount::default();
        let odometry = None;
        recording.scans.push(Scan {
            time,
            angle_min,
            angle_increment,
            ranges,
            mount,
            odometry,
            odometry_before,
        });
        Ok(())
    }

    fn turn(&mut self, heard: &Stamped<Heard>) {
        if let Heard::Measurement(Measurement::Compass(Compass { heading, .. })) = heard.value {
            let time = heard.stamp.seconds();
            self.recorded.recording.headings.push(StampedHeading { time, heading });
        }
    }

    fn skip(&mut self, why: &'static str) {
        *self.recorded.skipped.entry(why).or_default() += 1;
    }

    /// In the order of time, for messages are recorded as they arrive; and only what odometry was there for, which a stamp
    /// that nobody filled in is not.
    fn finished(mut self) -> Recorded {
        let Recorded { mut recording, options, mut skipped, truncations, .. } = self.recorded;
        let Recording { ticks, scans, headings, .. } = &mut recording;
        let first = ticks.first().map_or(f64::INFINITY, |ticks| ticks.time);
        let last = ticks.last().map_or(f64::NEG_INFINITY, |ticks| ticks.time);
        let before = scans.len() + headings.len();
        scans.retain(|scan| (first..=last).contains(&scan.time));
        headings.retain(|read| (first..=last).contains(&read.time));
        let without = before - scans.len() - headings.len();
        if without > 0 {
            skipped.insert("without_odometry", without as u64);
        }
        scans.sort_by(|a, b| a.time.total_cmp(&b.time));
        headings.sort_by(|a, b| a.time.total_cmp(&b.time));
        Recorded { recording, options, skipped, mounted: self.mount.news(), truncations }
    }
}
