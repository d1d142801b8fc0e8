//! A pose hypothesis: scans correct its pose and add to its evidence.

use surepose::geometry::{Body, Point, Pose};
use surepose_io::grid::Cells;

use super::likelihood_field::{LikelihoodField, LikelihoodTable};
use super::surface_cells::ScanEndpoints;

/// Initial steps of the hill climb \[m], \[rad]; each round halves them.
const FIRST_STEP: (f64, f64) = (0.1, 0.05);
const ROUNDS: i32 = 3;
/// Maximum number of steps per size.
const STEPS: usize = 4;

/// Weight of one beam in the hill climb; errors of neighboring beams are correlated.
const SHARE: f64 = 0.5;

/// Standard deviations of a pose before correction: x and y \[m], heading \[rad].
#[derive(Clone, Copy, Debug)]
pub(super) struct PoseUncertainty {
    pub(super) position: f64,
    pub(super) heading: f64,
}

/// An observation with its likelihood model.
pub(super) struct ScanScorer<'a> {
    pub(super) field: &'a LikelihoodField,
    pub(super) law: &'a LikelihoodTable,
    pub(super) endpoints: &'a ScanEndpoints,
    /// Number of surface cells observed so far, including this observation.
    pub(super) pieces: usize,
}

/// A hypothesis of the robot's pose.
#[derive(Clone, Debug)]
pub(super) struct PoseHypothesis {
    /// Current pose.
    pub(super) pose: Pose<Cells, Body, f64>,
    /// Log likelihood of all observations, each surface cell counted once, and of the odometry corrections.
    pub(super) evidence: f64,
    /// Mean log likelihood of the beams that ended in each surface cell.
    pieces: Vec<f32>,
    /// Pose at each update.
    pub(super) trajectory: Vec<Pose<Cells, Body, f64>>,
}

impl PoseHypothesis {
    /// Creates a hypothesis without evidence.
    pub(super) fn at(pose: Pose<Cells, Body, f64>) -> Self {
        Self { pose, evidence: 0.0, pieces: Vec::new(), trajectory: Vec::new() }
    }

    /// Predicts by `motion`, corrects the pose by hill climbing, and adds the evidence.
    pub(super) fn update(
        &mut self,
        motion: Pose<Body, Body, f64>,
        uncertainty: PoseUncertainty,
        view: &ScanScorer<'_>,
    ) {
        let rolled = self.pose * motion;
        self.pose = view.hill_climb(rolled, uncertainty);
        self.evidence += odometry_log_likelihood(rolled, self.pose, uncertainty);
        self.trajectory.push(self.pose);
        self.pieces.resize(view.pieces, 0.0);
        for (end, piece, count) in view.endpoints.pieces() {
            let likelihood = view.log_likelihood(self.pose, end);
            if let Some(mean) = self.pieces.get_mut(piece) {
                let step = (likelihood - f64::from(*mean)) / f64::from(count);
                *mean += step as f32;
                self.evidence += step;
            }
        }
    }

    /// Returns whether both hypotheses are within the given distance and angle.
    pub(super) fn is_near(&self, other: &Self, (distance, turn): (f64, f64)) -> bool {
        let turned = (self.pose.heading - other.pose.heading).radians().abs();
        self.pose.origin().distance(other.pose.origin()) < distance && turned < turn
    }
}

impl ScanScorer<'_> {
    fn log_likelihood(&self, pose: Pose<Cells, Body, f64>, end: Point<Body, f64>) -> f64 {
        self.field.log_likelihood(self.law, self.field.cell_at(pose * end))
    }

    /// Climbs from `start` to the most likely pose, with decreasing steps.
    fn hill_climb(
        &self,
        start: Pose<Cells, Body, f64>,
        uncertainty: PoseUncertainty,
    ) -> Pose<Cells, Body, f64> {
        let score = |pose: Pose<Cells, Body, f64>| {
            let laser = self.endpoints.laser;
            let stands =
                [pose.origin(), pose * laser].iter().all(|at| self.field.is_open(self.field.cell_at(*at)));
            if !stands {
                return f64::NEG_INFINITY;
            }
            // Sine and cosine are computed once per pose for all beams.
            let (sin, cos) = pose.heading.sin_cos();
            let seen = self.endpoints.ends.iter().step_by(2).map(|end| {
                let at = Point::new(pose.x + cos * end.x - sin * end.y, pose.y + sin * end.x + cos * end.y);
                self.field.log_likelihood(self.law, self.field.cell_at(at))
            });
            SHARE * seen.sum::<f64>() + odometry_log_likelihood(start, pose, uncertainty)
        };
        let mut best = (start, score(start));
        for round in 0..ROUNDS {
            let part = 0.5_f64.powi(round);
            let (step, turn) = (part * FIRST_STEP.0, part * FIRST_STEP.1);
            for _ in 0..STEPS {
                let from = best.0;
                let moves = [(step, 0.0, 0.0), (0.0, step, 0.0), (0.0, 0.0, turn)];
                for (x, y, turn) in moves.into_iter().flat_map(|(x, y, t)| [(x, y, t), (-x, -y, -t)]) {
                    let at = from * Point::<Body, f64>::new(x, y);
                    let next = Pose::new(at.x, at.y, from.heading.rotated_by(turn));
                    let score = score(next);
                    if score > best.1 {
                        best = (next, score);
                    }
                }
                if best.0 == from {
                    break;
                }
            }
        }
        best.0
    }
}

/// Returns the log likelihood of an odometry error from `rolled` to `pose`.
fn odometry_log_likelihood(
    rolled: Pose<Cells, Body, f64>,
    pose: Pose<Cells, Body, f64>,
    uncertainty: PoseUncertainty,
) -> f64 {
    let position = rolled.origin().distance(pose.origin()) / uncertainty.position;
    let heading = (pose.heading - rolled.heading).radians() / uncertainty.heading;
    -0.5 * (position * position + heading * heading)
}
