//! The supervisor at work: it hears of everything, and looks for the robot when that is lost.

use surepose::closed_loop::{Sight, Witness};
use surepose::{
    Agreement, Belief, Certainty, Drive, Estimator, Finding, Glance, Health, Hypothesis, Measurement, Nudge,
    Outcome, Refusal, Relocaliser, Silence, Stamp, Stamped, Supervisor, Travel, Verdict, Vigilance, Wall,
    Wheels, param,
};
use surepose_data::Config;

use super::scenario::Reading;
use crate::survey::Survey;

/// Beams of a scan that are held against the map.
const BEAMS: usize = 128;

/// How fast a lost robot turns in place to see more \[rad/s].
pub const SEARCH_RATE: f64 = 0.8;

/// The most hypotheses.
const HYPOTHESES: usize = 24;

/// The supervisor, and the relocaliser for when it is needed.
#[derive(Clone, Debug)]
pub struct Watch {
    supervisor: Supervisor<f64>,
    relocaliser: Box<Relocaliser<f64, HYPOTHESES>>,
    survey: Survey,
    nudge: Nudge<f64>,
    /// When the robot was last found to have been pushed a little.
    nudged: Option<Stamp>,
    reading: Reading,
    drive: Drive<f64>,
    period: f64,
    /// Whether the relocaliser is at work.
    searching: bool,
    /// How often what a scan told was used.
    sightings: u32,
}

/// How far off a pose is that was found on a map of short walls, besides what its covariance says: x, y \[m] and
/// heading \[rad].
const ROUGHLY: [f64; 3] = [0.01, 0.01, 0.0035];

/// A push that was found out in less time \[s] after the last one was none: six scans, and a few that agree by chance.
const HELD: f64 = 0.8;

/// How well a map is known where scans are read so, x, y \[m] and heading \[rad]: exactly but for rounding, or to a cell.
fn known_to(reading: Reading) -> [f64; 3] {
    match reading {
        Reading::Lines => [0.002, 0.002, 0.05_f64.to_radians()],
        Reading::Beams => [0.03, 0.03, 0.3_f64.to_radians()],
    }
}

impl Watch {
    /// The watch over a robot that starts at `stamp` among `walls`; `aided` where it has sensors that see where it is.
    pub fn new(config: &Config, aided: bool, reading: Reading, walls: &[Wall<f64>], stamp: Stamp) -> Self {
        let usual = Vigilance::default();
        let vigilance = Vigilance { unaided: if aided { usual.unaided } else { f64::INFINITY }, ..usual };
        // A robot that has turned in place has room for its wheels.
        let certainty = Certainty { clearance: 0.5 * config.drive().track, ..Certainty::default() };
        let relocaliser = Relocaliser::new(config.ekf(), certainty, stamp);
        Self {
            supervisor: Supervisor::new(vigilance, stamp),
            relocaliser: Box::new(relocaliser),
            survey: Survey::of(walls),
            nudge: Nudge::on_map_known_to(known_to(reading)),
            nudged: None,
            reading,
            drive: config.drive(),
            period: config.number(&param::PERIOD),
            searching: false,
            sightings: 0,
        }
    }

    /// How often a wall in a scan, or a whole scan, corrected the estimate.
    pub fn sightings(&self) -> u32 {
        self.sightings
    }

    /// What the wheels may do.
    pub fn verdict(&self, now: Stamp, belief: &Belief<f64>) -> Verdict {
        self.supervisor.verdict(now, belief)
    }

    /// How far the estimate can be trusted.
    pub fn health(&self, now: Stamp, belief: &Belief<f64>) -> Health {
        self.supervisor.health(now, belief)
    }

    /// The poses that the robot may have, while it is lost.
    pub fn hypotheses(&self) -> impl Iterator<Item = &Hypothesis<f64>> {
        self.relocaliser.hypotheses().filter(|_| self.searching)
    }

    /// Nothing is known of the pose from `now` on.
    pub fn lose(&mut self, now: Stamp) {
        self.supervisor.lose();
        self.search(now);
    }

    fn search(&mut self, now: Stamp) {
        self.searching = true;
        self.relocaliser.forget(now);
    }

    /// The pose that was found, as sure as the map lets it be.
    fn told(&self, found: Belief<f64>) -> Belief<f64> {
        match self.reading {
            Reading::Lines => found,
            // Beams given to the wrong one of two steps in a wall are so together.
            Reading::Beams => {
                let std = [0, 1, 2].map(|i| found.covariance.std(i).hypot(ROUGHLY[i]));
                Belief::new(found.pose, std)
            }
        }
    }

    fn look_for<const N: usize>(&mut self, estimator: &mut Estimator<f64, N>, sight: &Sight<'_, f64>) {
        let Sight { stamp, laser, scan, seen, walls } = *sight;
        let (lines, chart) = (seen.extracted.lines, self.survey.chart());
        let found = self.relocaliser.look(stamp, laser, scan, lines, walls, chart.as_ref());
        if let Finding::Found(belief) = found {
            estimator.resume(self.relocaliser.stamp(), self.told(belief));
            self.supervisor.found(estimator.stamp());
            self.searching = false;
        }
    }
}

impl<const N: usize> Witness<f64, N> for Watch {
    fn rolled(&mut self, stamp: Stamp, told: Wheels<f64>, travel: Travel<f64>, outcome: Result<(), Refusal>) {
        self.supervisor.rolled(stamp, outcome);
        let rates = |rims| self.drive.turns_from_rims(rims).scaled(1.0 / self.period);
        self.supervisor.followed(rates(told), rates(travel.rims));
        if self.searching {
            self.relocaliser.roll(stamp, travel);
        }
    }

    fn measured(&mut self, measured: &Stamped<Measurement<f64>>, outcome: Outcome) {
        self.supervisor.measured(measured.stamp, outcome, measured.value.rows());
        if let (Measurement::Wall(_) | Measurement::Pose(_), Outcome::Accepted { .. }) =
            (measured.value, outcome)
        {
            self.sightings = self.sightings.saturating_add(1);
        }
        if let Measurement::Compass(heading) = measured.value
            && self.searching
        {
            self.relocaliser.turn_to(Stamped::new(measured.stamp, heading));
        }
    }

    /// Does the map explain the scan? If the robot is lost, where is it?
    fn looked(&mut self, estimator: &mut Estimator<f64, N>, sight: &Sight<'_, f64>) {
        let Some(then) = estimator.belief_at(sight.stamp) else { return };
        let Ok(glance) = Glance::<f64, BEAMS>::of(sight.laser, sight.scan) else { return };
        let Ok(silence) = Silence::<f64, BEAMS>::of(sight.laser, sight.scan) else { return };
        let (agreement, off) = self.nudge.look(estimator.ekf(), &glance, &then, sight.walls);
        let agreement = Agreement { missing: silence.missing(&then, sight.walls), ..agreement };
        self.supervisor.looked(&agreement, off);
        let now = estimator.stamp();
        if self.health(now, &estimator.belief()) != Health::Lost {
            return;
        }
        let is_pushed = !self.searching
            && !self.supervisor.is_against(&agreement)
            && self.nudged.is_none_or(|last| now.since(last) > HELD);
        if is_pushed && let Some(found) = self.nudge.settle(estimator.ekf(), &glance, &then, sight.walls) {
            estimator.resume(sight.stamp, self.told(found));
            self.supervisor.found(now);
            self.nudged = Some(now);
            return;
        }
        if !self.searching {
            self.search(now);
        }
        self.look_for(estimator, sight);
    }
}
