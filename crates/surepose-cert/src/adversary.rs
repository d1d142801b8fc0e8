//! Search for a drive of the shipped controller, with its limit of the wheel acceleration, that leaves the certified bounds.
//!
//! The proof assumes wheels that follow at once. Such a drive shows that the bounds do not hold for a robot whose wheels do not. A
//! search without such a drive proves nothing.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use std::collections::VecDeque;

use surepose::control::{ActuatorState, Controller, ControllerState};
use surepose::geometry::{Angle, Body, Goal, Map, Pose};
use surepose::kinematics::{Integration, Twist};

use crate::actuator_errors::ActuatorErrors;
use crate::counterexample::Rng;
use crate::noise::NoiseBounds;

/// Search for the worst drives of a shipped controller.
#[derive(Clone, Copy, Debug)]
pub struct AdversarySearch<'a> {
    /// Controller with its limits and its goal tolerance.
    pub controller: &'a Controller<f64>,
    /// Actuators of the base; a delay is rounded to whole periods, and a lag is not simulated.
    pub actuators: ActuatorErrors,
    /// Bounds of the pose error, as sensed; wheel errors are not used.
    pub noise: NoiseBounds,
    /// Certified capture radius \[m].
    pub capture_radius: f64,
    /// Certified largest distance after capture \[m]. ∞: none.
    pub final_position_bound: f64,
    /// Certified largest time until capture \[s].
    pub time_bound: f64,
    /// Number of simulated control periods.
    pub ticks: u64,
}

/// Worst drives that a search found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorstDrives {
    /// Largest distance that a robot did not fall below in the second half of a drive \[m].
    pub kept_out: f64,
    /// Largest distance after capture \[m].
    pub farthest: f64,
    /// A drive that leaves the bounds. `None`: none found.
    pub violation: Option<AdversarialDrive>,
}

/// A drive from rest, with the error of the estimate as a function of the robot's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdversarialDrive {
    /// Start: x \[m], y \[m], heading \[rad]. The goal is (0, 0, 0).
    pub start: [f64; 3],
    policy: Policy,
    noise: NoiseBounds,
    actuators: ActuatorErrors,
}

/// One control period of an [`AdversarialDrive`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveSample {
    /// Time since the start \[s].
    pub time: f64,
    /// True pose: x \[m], y \[m], heading \[rad].
    pub pose: [f64; 3],
    /// Estimated pose: x \[m], y \[m], heading \[rad].
    pub estimate: [f64; 3],
    /// True distance to the goal \[m].
    pub distance: f64,
}

/// Duration of a drive \[s].
const DURATION: f64 = 60.0;
/// Drives of one search for a policy: the first are random, the others climb from the best one.
const SEARCH: u64 = 80;
const RANDOM: u64 = 25;
/// Starts lie between this radius \[m] and half of it.
const STARTS: [f64; 2] = [0.2, 0.6];

/// Weights of the motion in the sign of the error.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Policy {
    weights: [f64; 6],
    /// −1 to 1: the error of the position points away from the goal, across, or toward it.
    radial: f64,
}

/// Robot and controller at one tick.
#[derive(Clone, Copy)]
struct Moment {
    pose: Pose<Map, Body, f64>,
    state: ControllerState<f64>,
}

impl AdversarySearch<'_> {
    /// Simulates drives against adversaries that learn, deterministically.
    pub fn run(&self) -> WorstDrives {
        let mut rng = Rng(0xad5e_0e5a_21e5);
        let mut worst = WorstDrives::default();
        let mut ticks = 0;
        let mut search = 0_u64;
        while ticks < self.ticks {
            let near = STARTS[usize::from(search % 4 > 1)];
            let start = random_start(near, &mut rng);
            let (mut policy, mut best) = (Policy::random(&mut rng), f64::NEG_INFINITY);
            for k in 0..SEARCH {
                let next = if k < RANDOM { Policy::random(&mut rng) } else { policy.varied(&mut rng) };
                let drive =
                    AdversarialDrive { start, policy: next, noise: self.noise, actuators: self.actuators };
                let (fate, driven) = self.fate(&drive);
                ticks += driven;
                worst.kept_out = worst.kept_out.max(fate.kept_out);
                if fate.violation.is_some() && (worst.violation.is_none() || fate.farthest > worst.farthest) {
                    worst.violation = fate.violation;
                }
                worst.farthest = worst.farthest.max(fate.farthest);
                // Half of the searches keep the robot out, the others push it away again.
                let score = if search.is_multiple_of(2) { fate.kept_out } else { fate.farthest };
                if score > best {
                    (policy, best) = (next, score);
                }
            }
            search += 1;
        }
        worst
    }

    /// Worst distances of one drive, and its number of ticks. A drive that is not captured continues until the time bound.
    fn fate(&self, drive: &AdversarialDrive) -> (WorstDrives, u64) {
        let mut fate = WorstDrives { kept_out: f64::INFINITY, ..WorstDrives::default() };
        let (mut captured, mut ticks) = (false, 0);
        drive.each(self.controller, self.longest(), |sample| {
            ticks += 1;
            if (0.5 * DURATION..DURATION).contains(&sample.time) {
                fate.kept_out = fate.kept_out.min(sample.distance);
            }
            captured |= sample.distance < self.capture_radius;
            if captured {
                fate.farthest = fate.farthest.max(sample.distance);
            }
            sample.time < DURATION || !captured
        });
        if !captured || fate.farthest > self.final_position_bound {
            fate.violation = Some(*drive);
        }
        (fate, ticks)
    }

    /// Longest duration of a drive \[s].
    fn longest(&self) -> f64 {
        DURATION.max(self.time_bound)
    }
}

/// A pose between `near` \[m] and half of it from the goal.
fn random_start(near: f64, rng: &mut Rng) -> [f64; 3] {
    let (direction, rho) = (PI * rng.either(), near * (0.5 + 0.5 * rng.part()));
    [rho * direction.cos(), rho * direction.sin(), PI * rng.either()]
}

impl AdversarialDrive {
    /// Simulates the first minute of the drive with the shipped step of `controller`.
    pub fn samples(&self, controller: &Controller<f64>) -> Vec<DriveSample> {
        let mut samples = Vec::new();
        self.each(controller, DURATION, |sample| {
            samples.push(sample);
            true
        });
        samples
    }

    /// Simulates the drive for `duration` \[s], or until `visit` returns `false`.
    fn each(&self, controller: &Controller<f64>, duration: f64, mut visit: impl FnMut(DriveSample) -> bool) {
        let [x, y, heading] = self.start;
        let pose = Pose::new(x, y, Angle::from_radians(heading));
        let mut now = Moment { pose, state: ControllerState::new() };
        let goal: Pose<Map, Goal, f64> = Pose::identity();
        let ActuatorErrors { model, delay } = self.actuators;
        let mut stage = ActuatorState::new();
        // Commands that have not taken effect, the oldest first.
        let late = (delay / controller.period).round() as usize;
        let mut sent: VecDeque<_> = core::iter::repeat_n(Twist::zero(), late).collect();
        for tick in 0..(duration / controller.period) as u32 {
            let estimate = self.policy.estimate(&now, &self.noise);
            let parts = |pose: Pose<Map, Body, f64>| [pose.x, pose.y, pose.heading.radians()];
            let goes_on = visit(DriveSample {
                time: f64::from(tick) * controller.period,
                pose: parts(now.pose),
                estimate: parts(estimate),
                distance: now.pose.x.hypot(now.pose.y),
            });
            if !goes_on {
                return;
            }
            let step = controller.step(now.state, stage.predict(&model, estimate), goal);
            let period = controller.period;
            sent.push_back(stage.execute(
                &model,
                &controller.drive,
                &controller.limits,
                step.limited,
                period,
            ));
            let moved = sent.pop_front().unwrap_or(step.limited).integrate_for(period);
            now = Moment { pose: now.pose.integrate(moved, Integration::Arc), state: step.state };
        }
    }
}

impl Policy {
    fn random(rng: &mut Rng) -> Self {
        Self { weights: core::array::from_fn(|_| rng.either()), radial: rng.either() }
    }

    fn varied(&self, rng: &mut Rng) -> Self {
        const SIZE: f64 = 0.3;
        let radial = (self.radial + SIZE * rng.either()).clamp(-1.0, 1.0);
        Self { weights: self.weights.map(|weight| weight + SIZE * rng.either()), radial }
    }

    /// The estimate: the errors of position and heading have the sign of a linear function of bearing, approach and motion.
    fn estimate(&self, now: &Moment, bounds: &NoiseBounds) -> Pose<Map, Body, f64> {
        let heading = now.pose.heading.radians();
        let toward = (-now.pose.y).atan2(-now.pose.x);
        let (sin, cos) = (toward - heading).sin_cos();
        let twist = now.state.limited;
        let motion =
            [sin, 2.0 * sin * cos, twist.omega, cos * twist.omega, toward.sin(), 10.0 * twist.v * sin];
        let sum: f64 = motion.iter().zip(self.weights).map(|(value, weight)| value * weight).sum();
        let side = if sum < 0.0 { -1.0 } else { 1.0 };
        // Within the bound in spite of rounding.
        let reach = bounds.position * (1.0 - 1e-9);
        let direction = (toward + side * FRAC_PI_2 * (1.0 + self.radial)).rem_euclid(TAU);
        Pose::new(
            now.pose.x + reach * direction.cos(),
            now.pose.y + reach * direction.sin(),
            Angle::from_radians(heading + bounds.heading * (1.0 - 1e-9) * side),
        )
    }
}
