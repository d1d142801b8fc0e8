//! One closed-loop drive of the simulated robot: sensors, estimate, law, motors, until it rests at the goal.
//!
//! Every tick is [`surepose::closed_loop::tick`], the one that a real robot runs; what the supervisor leaves of it turns
//! the wheels of a robot of `surepose-sim`.

mod guard;
mod lookout;
mod sample;
mod summary;
#[cfg(test)]
mod tests;

use surepose::closed_loop::{Controller, Progress, Tick};
use surepose::{Goal, Map, Navigation, Phase, Pose, Reason, Twist, Verdict, Wheels, param};

use crate::optimal::fastest;
use crate::replay::Score;
use crate::rig::{Rig, Scenario};

pub use guard::{Guard, PATIENCE, told};
pub use lookout::way_to_rest;
pub use sample::{Mode, Sample};
pub use summary::{Outcome, Summary};

/// Drives `scenario` to its end.
pub fn drive(scenario: &Scenario, seed: u64) -> (Vec<Sample>, Summary) {
    let mut drive = Drive::new(scenario, seed);
    let samples = drive.by_ref().collect();
    (samples, drive.summary())
}

/// A drive under way: an iterator over its ticks, which ends where the drive does.
#[derive(Clone, Debug)]
pub struct Drive {
    rig: Rig,
    controller: Controller<f64>,
    progress: Progress<f64>,
    goal: Pose<Map, Goal, f64>,
    wheels: Wheels<f64>,
    guard: Guard,
    can_look: bool,
    timeout: f64,
    optimal_time: f64,
    outcome: Option<Outcome>,
    score: Score,
    path_length: f64,
    closest_wall: f64,
    fastest_rim: f64,
    hardest_rim: f64,
    seed: u64,
}

impl Drive {
    /// The drive of `scenario` with everything random drawn from `seed`.
    pub fn new(scenario: &Scenario, seed: u64) -> Self {
        let controller = scenario.config.controller();
        let goal_from_start = scenario.goal().inverse() * scenario.start();
        let fastest = fastest(goal_from_start, &controller.drive, controller.limits.wheel_speed);
        Self {
            rig: Rig::new(scenario, seed),
            controller,
            progress: Progress::fresh(),
            goal: scenario.goal(),
            wheels: Wheels::new(0.0, 0.0),
            guard: Guard::default(),
            can_look: scenario.sensors.laser,
            timeout: scenario.config.number(&param::TIMEOUT),
            optimal_time: fastest.time,
            outcome: None,
            score: Score::default(),
            path_length: 0.0,
            closest_wall: f64::INFINITY,
            fastest_rim: 0.0,
            hardest_rim: 0.0,
            seed,
        }
    }

    /// How much of the time that it may take is over, in [0, 1].
    pub fn elapsed(&self) -> f64 {
        (self.rig.world().now().seconds() / self.timeout).clamp(0.0, 1.0)
    }

    /// Goes on for another tick, also after the end: to see whether the robot stays there.
    pub fn tick(&mut self) -> Sample {
        let before = self.rig.world().pose();
        let Tick { belief, step, .. } =
            self.rig.tick(&self.controller, self.progress, self.wheels, self.goal);
        let now = self.rig.world().now().seconds();
        let last = self.progress.granted;
        let step = self.guard.allow(self.rig.verdict(), &self.controller, step, last, now, self.can_look);
        let world = self.rig.world();
        let step =
            self.guard.keep_off_walls(&world.model().arena, world.pose(), &self.controller, step, last);
        self.progress = step.progress;
        self.wheels = step.wheels;

        let world = self.rig.world();
        let truth = world.pose();
        self.path_length += before.origin().distance(truth.origin());
        self.closest_wall = self.closest_wall.min(world.model().arena.clearance(truth.origin()));
        let drive = &self.controller.drive;
        let (rims, change) =
            (drive.rims_from_twist(step.granted), drive.rims_from_twist(step.granted - last));
        self.fastest_rim = self.fastest_rim.max(rims.largest());
        self.hardest_rim = self.hardest_rim.max(change.largest() / self.controller.period);
        self.score.add(belief.error(truth));
        self.score.add_nees(belief.nees(truth));
        Sample::of(world, &belief, &self.controller, &step, self.goal)
    }

    /// What the supervisor says.
    pub fn verdict(&self) -> Verdict {
        self.rig.verdict()
    }

    /// Why the robot was stopped, where it was.
    fn stop_reason(&self) -> Option<&'static str> {
        let gave_up = self.guard.gave_up(self.rig.world().now().seconds());
        let by_wall = self.guard.is_walled() || self.closest_wall < 0.0;
        if by_wall { Some("wall") } else { gave_up.map(Reason::name) }
    }

    /// The figures up to now; a drive that has not ended counts as stopped.
    pub fn summary(&self) -> Summary {
        let world = self.rig.world();
        let error = Navigation::of(world.pose(), self.goal);
        let judged = self.score.clone().summary();
        let tally = self.rig.tally();
        Summary {
            outcome: self.outcome.unwrap_or(Outcome::Stopped),
            stop_reason: self.stop_reason(),
            time_s: world.now().seconds(),
            final_position_error_m: error.rho,
            final_heading_error_deg: error.heading_error().degrees().abs(),
            final_speed_m_s: world.twist().v.abs(),
            final_turn_rate_deg_s: world.twist().omega.to_degrees().abs(),
            position_rmse_m: judged.map(|judged| judged.position_rmse),
            heading_rmse_deg: judged.map(|judged| judged.heading_rmse.to_degrees()),
            nees_mean: judged.and_then(|judged| judged.nees_mean),
            path_length_m: self.path_length,
            optimal_time_s: self.optimal_time,
            closest_wall_m: self.closest_wall,
            wheel_speed_max_m_s: self.fastest_rim,
            wheel_acceleration_max_m_s2: self.hardest_rim,
            accepted: tally.accepted,
            walls: self.rig.sightings(),
            rejected: tally.refused_in_all(),
            seed: self.seed,
        }
    }

    /// Whether the robot is within the goal's tolerance in truth, whatever it believes.
    fn is_at_goal(&self) -> bool {
        let error = Navigation::of(self.rig.world().pose(), self.goal);
        let tolerance = &self.controller.tolerance;
        error.rho <= tolerance.position && error.heading_error().radians().abs() <= tolerance.heading
    }

    /// Whether, and how, the drive is over: at the goal the motors must stand, too.
    fn ended(&self) -> Option<Outcome> {
        let world = self.rig.world();
        let stands = world.rim_speeds() == Wheels::new(0.0, 0.0) && world.twist() == Twist::rest();
        let phase = self.progress.arrival.phase(&self.controller.tolerance);
        if phase == Phase::Reached && stands {
            Some(if self.is_at_goal() { Outcome::Reached } else { Outcome::Missed })
        } else if self.stop_reason().is_some() && (stands || !self.guard.is_walled()) {
            Some(Outcome::Stopped)
        } else {
            (world.now().seconds() >= self.timeout).then_some(Outcome::Timeout)
        }
    }
}

impl Iterator for Drive {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        if self.outcome.is_some() {
            return None;
        }
        let sample = self.tick();
        self.outcome = self.ended();
        Some(sample)
    }
}
