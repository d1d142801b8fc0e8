//! One tick of one concrete situation, in floats: what a counterexample is and what confirms it.

use surepose::{Angle, Body, Drive, Goal, Integration, Map, Navigation, Point, Pose, Twist, Wheels};

use crate::mind::Mind;
use crate::subject::Subject;
use crate::weight::Weight;

/// Where the robot is, what the noise does to it in one tick, and what the law remembers. The goal is (0, 0, 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Situation {
    /// True x \[m].
    pub x: f64,
    /// True y \[m].
    pub y: f64,
    /// True heading \[rad].
    pub heading: f64,
    /// What the law remembers.
    pub mind: Mind,
    /// For how many ticks it has trimmed its heading.
    pub trims: f64,
    /// Estimated minus true x \[m].
    pub noise_x: f64,
    /// Estimated minus true y \[m].
    pub noise_y: f64,
    /// Estimated minus true heading \[rad].
    pub noise_heading: f64,
    /// Error of the right rim's speed \[m/s].
    pub noise_right: f64,
    /// Error of the left rim's speed \[m/s].
    pub noise_left: f64,
}

/// What one tick makes of a [`Situation`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Consequence {
    /// The true goal before the tick.
    pub before: Navigation<f64>,
    /// The true goal after it.
    pub after: Navigation<f64>,
    /// The law's mind after it.
    pub mind: Mind,
    /// For how many ticks the law has trimmed its heading then.
    pub trims: f64,
    /// What the robot was told to drive.
    pub told: Twist<f64>,
    /// W before the tick.
    pub weight_before: f64,
    /// W after it; more than before where the certificate is violated.
    pub weight_after: f64,
}

impl Situation {
    /// Simulates one tick with the core's own motion.
    pub fn simulate<L: Subject>(
        &self,
        subject: &L,
        drive: &Drive<f64>,
        period: f64,
        weight: &Weight,
        limited: bool,
    ) -> Consequence {
        let goal: Pose<Map, Goal, f64> = Pose::identity();
        let pose: Pose<Map, Body, f64> = Pose::new(self.x, self.y, Angle::wrapped(self.heading));
        let estimate: Pose<Map, Body, f64> = Pose::new(
            self.x + self.noise_x,
            self.y + self.noise_y,
            Angle::wrapped(self.heading + self.noise_heading),
        );
        let decision = subject.decide(&Navigation::of(estimate, goal), self.mind.memory(self.trims));
        let told = if limited { subject.grant(decision.twist) } else { decision.twist };
        let rims = drive.rims_from_twist(told);
        let rims = Wheels::new(rims.right + self.noise_right, rims.left + self.noise_left);
        let moved = pose.moved(drive.twist_from_rims(rims).over(period), Integration::Arc);

        let (before, after) = (Navigation::of(pose, goal), Navigation::of(moved, goal));
        let mind = Mind::of_float(&decision.memory);
        // A law that has decided nothing yet has no W before its first decision.
        let held = if self.mind.side == 0 { mind } else { self.mind };
        Consequence {
            before,
            after,
            mind,
            trims: decision.memory.trims,
            told,
            weight_before: weight.of(&before, held),
            weight_after: weight.of(&after, mind),
        }
    }

    /// The situation at true polar coordinates \[m, rad], without noise.
    pub fn polar(rho: f64, alpha: f64, phi: f64, mind: Mind) -> Self {
        let at: Point<Map, f64> = Point::new(-rho * phi.cos(), -rho * phi.sin());
        Self {
            x: at.x,
            y: at.y,
            heading: phi - alpha,
            mind,
            trims: 0.0,
            noise_x: 0.0,
            noise_y: 0.0,
            noise_heading: 0.0,
            noise_right: 0.0,
            noise_left: 0.0,
        }
    }
}
