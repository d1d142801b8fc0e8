//! The supervisor at work: it hears of everything, and looks for the robot when that is lost.

use surepose::{
    Belief, Certainty, Chart, Compass, Estimator, Finding, Glance, Health, Hypothesis, Outcome, RangeFinder,
    Refusal, Relocaliser, Scan, SeenLine, Stamp, Stamped, Supervisor, Travel, Verdict, Vigilance, Wall,
    Wheels,
};
use surepose_data::Config;

use super::scenario::Reading;

/// Beams of a scan that are held against the map.
pub(super) const BEAMS: usize = 128;

/// How fast a lost robot turns in place to see more \[rad/s].
pub const SEARCH_RATE: f64 = 0.8;

/// The most hypotheses.
const HYPOTHESES: usize = 24;

/// The supervisor, and the relocaliser for when it is needed.
#[derive(Clone, Debug)]
pub struct Watch {
    supervisor: Supervisor<f64>,
    relocaliser: Box<Relocaliser<f64, HYPOTHESES>>,
    reading: Reading,
    /// Whether the relocaliser is at work.
    searching: bool,
}

/// How well a pose is known at least that lines found in a map of short walls: x, y \[m] and heading \[rad].
const ROUGHLY: [f64; 3] = [0.05, 0.05, 0.02];

/// A scan with what was found in it.
#[derive(Clone, Copy, Debug)]
pub struct Sight<'a> {
    /// When it was taken.
    pub stamp: Stamp,
    /// By what.
    pub laser: &'a RangeFinder<f64>,
    /// The scan.
    pub scan: &'a Scan<'a, f64>,
    /// The lines in it.
    pub lines: &'a [SeenLine<f64>],
    /// The walls of the map.
    pub walls: &'a [Wall<f64>],
    /// How far from them each place is.
    pub chart: Option<Chart<'a, f64>>,
}

impl Watch {
    /// The watch over a robot that starts at `stamp`; `aided` where it has sensors that see where it is.
    pub fn new(config: &Config, aided: bool, reading: Reading, stamp: Stamp) -> Self {
        let usual = Vigilance::default();
        let vigilance = Vigilance { unaided: if aided { usual.unaided } else { f64::INFINITY }, ..usual };
        // A robot that has turned in place has room for its wheels.
        let certainty = Certainty { clearance: 0.5 * config.drive().track, ..Certainty::default() };
        let relocaliser = Relocaliser::new(config.ekf(), certainty, stamp);
        Self {
            supervisor: Supervisor::new(vigilance, stamp),
            relocaliser: Box::new(relocaliser),
            reading,
            searching: false,
        }
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

    /// The robot rolled by `travel` until `stamp`, or by a guess of it where odometry was refused.
    pub fn rolled(&mut self, stamp: Stamp, travel: Travel<f64>, outcome: Result<(), Refusal>) {
        self.supervisor.rolled(stamp, outcome);
        if self.searching {
            self.relocaliser.roll(stamp, travel);
        }
    }

    /// How fast the wheels were told to turn, and how fast they did \[rad/s].
    pub fn followed(&mut self, told: Wheels<f64>, did: Wheels<f64>) {
        self.supervisor.followed(told, did);
    }

    /// A heading, and what became of it.
    pub fn turned(&mut self, heading: Stamped<Compass<f64>>, outcome: Outcome) {
        self.supervisor.measured(heading.stamp, outcome, 1);
        if self.searching {
            self.relocaliser.turn_to(heading);
        }
    }

    /// What became of a line taken for a wall, or of a scan laid on all: a measurement with `rows` rows.
    pub fn matched(&mut self, stamp: Stamp, outcome: Outcome, rows: usize) {
        self.supervisor.measured(stamp, outcome, rows);
    }

    /// A scan, after its lines corrected `estimator`: does the map explain it? If the robot is lost, where is it?
    pub fn looked<const N: usize>(&mut self, estimator: &mut Estimator<f64, N>, sight: &Sight<'_>) {
        if let Some(belief) = estimator.belief_at(sight.stamp)
            && let Ok(glance) = Glance::<f64, BEAMS>::of(sight.laser, sight.scan)
        {
            self.supervisor.looked(&glance.from(belief.pose, &belief.covariance, sight.walls));
        }
        let now = estimator.stamp();
        if self.health(now, &estimator.belief()) == Health::Lost {
            if !self.searching {
                self.search(now);
            }
            self.look_for(estimator, sight);
        }
    }

    fn search(&mut self, now: Stamp) {
        self.searching = true;
        self.relocaliser.forget(now);
    }

    /// The pose that was found, as sure as the map lets it be.
    fn told(&self, found: Belief<f64>) -> Belief<f64> {
        match self.reading {
            Reading::Lines => found,
            // Where lines are laid over steps in the walls, their covariance is not what they are off by.
            Reading::Beams => {
                let std = [0, 1, 2].map(|i| found.covariance.std(i).max(ROUGHLY[i]));
                Belief::new(found.pose, std)
            }
        }
    }

    fn look_for<const N: usize>(&mut self, estimator: &mut Estimator<f64, N>, sight: &Sight<'_>) {
        let Sight { stamp, laser, scan, lines, walls, chart } = *sight;
        if let Finding::Found(belief) =
            self.relocaliser.look(stamp, laser, scan, lines, walls, chart.as_ref())
        {
            estimator.restart(self.relocaliser.stamp(), self.told(belief));
            for (end, travel) in self.relocaliser.since_scan() {
                // What the trail holds was checked when it was taken in.
                let _counted = estimator.roll_by(end, travel);
            }
            self.supervisor.found(estimator.stamp());
            self.searching = false;
        }
    }
}
