//! Wheel travel that a base predicts from the commands, compared with the odometry.

use surepose::kinematics::{DiffDrive, Twist, WheelPair};
use surepose::time::Stamp;
use surepose_sim::{Plant, PlantModel};

use crate::calibrate::recording::{OdometryStep, StampedCommand};

/// Longest odometry interval that is compared \[s].
const MAX_INTERVAL: f64 = 0.5;
/// Longest time for which a command is known to hold \[s]. Later, many bases stop by themselves.
const COMMAND_LIFETIME: f64 = 0.5;
/// Largest residual that counts in full, as a fraction of the fastest travel of an interval.
const MAX_RESIDUAL: f64 = 0.5;

/// Commands and odometry, ordered by time.
pub(super) struct Response {
    drive: DiffDrive<f64>,
    /// Time \[s] and wheel rates \[rad/s].
    commands: Vec<(f64, WheelPair<f64>)>,
    intervals: Vec<Interval>,
    /// Largest rim speed in the odometry \[m/s].
    pub(super) max_speed: f64,
}

/// Odometry interval: times \[s] since the first, and rim travel of each wheel \[m].
struct Interval {
    begin: f64,
    duration: f64,
    travel: WheelPair<f64>,
    is_compared: bool,
}

impl Response {
    pub(super) fn new(commands: &[StampedCommand], steps: &[OdometryStep], drive: &DiffDrive<f64>) -> Self {
        let origin = steps.first().map_or(0.0, |step| step.begin);
        let rates =
            |command: &StampedCommand| (command.time - origin, drive.wheel_rates_from_twist(command.twist));
        let mut commands: Vec<_> = commands.iter().map(rates).collect();
        commands.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut intervals = Vec::with_capacity(steps.len());
        for step in steps {
            let begin = step.begin - origin;
            let newest = commands.partition_point(|(time, _)| *time <= begin);
            let is_known = newest.checked_sub(1).is_some_and(|index| {
                let (time, rates) = commands[index];
                begin - time <= COMMAND_LIFETIME || rates == WheelPair::zero()
            });
            intervals.push(Interval {
                begin,
                duration: step.duration,
                travel: drive.wheel_travel_from_angle(step.turned),
                is_compared: is_known && step.duration <= MAX_INTERVAL,
            });
        }
        let compared = intervals.iter().filter(|interval| interval.is_compared);
        let max_speed = compared.map(|interval| interval.travel.max_abs() / interval.duration);
        let max_speed = max_speed.fold(0.0, f64::max);
        Self { drive: *drive, commands, intervals, max_speed }
    }

    /// Number of intervals that are compared.
    pub(super) fn len(&self) -> usize {
        self.intervals.iter().filter(|interval| interval.is_compared).count()
    }

    /// Commanded twists.
    pub(super) fn twists(&self) -> impl Iterator<Item = Twist<f64>> + '_ {
        let rims = self.commands.iter().map(|(_, rates)| self.drive.wheel_travel_from_angle(*rates));
        rims.map(|rims| self.drive.twist_from_wheel_speeds(rims))
    }

    /// Commanded rim speeds of the two wheels \[m/s].
    pub(super) fn rims(&self) -> impl Iterator<Item = WheelPair<f64>> + '_ {
        self.commands.iter().map(|(_, rates)| self.drive.wheel_travel_from_angle(*rates))
    }

    /// Predicted less measured rim travel \[m] of the compared intervals, two for each, in order of time.
    pub(super) fn residuals(&self, model: &PlantModel) -> Vec<f64> {
        let mut plant = Plant::default();
        for (time, rates) in &self.commands {
            plant.send(model, Stamp::from_seconds(*time), *rates);
        }
        let mut effects = self.commands.iter().map(|(time, _)| time + model.command_delay).peekable();
        let mut residuals = Vec::with_capacity(2 * self.intervals.len());
        for interval in &self.intervals {
            let (mut now, end) = (interval.begin, interval.begin + interval.duration);
            let mut travel = WheelPair::zero();
            while now < end {
                while effects.peek().is_some_and(|effect| *effect <= now) {
                    effects.next();
                }
                let next = effects.peek().map_or(end, |effect| effect.min(end));
                // The plant's clock has nanoseconds: a shorter piece would not advance.
                let piece = (next - now).max(2e-9);
                let turned = plant.advance(model, &self.drive, Stamp::from_seconds(now + 1e-9), piece);
                let turned = WheelPair::new(turned.right.mean, turned.left.mean).scaled(piece);
                let rims = self.drive.wheel_travel_from_angle(turned);
                travel = WheelPair::new(travel.right + rims.right, travel.left + rims.left);
                now += piece;
            }
            if interval.is_compared {
                let limit = MAX_RESIDUAL * self.max_speed * interval.duration;
                let residual = |predicted: f64, measured: f64| (predicted - measured).clamp(-limit, limit);
                residuals.push(residual(travel.right, interval.travel.right));
                residuals.push(residual(travel.left, interval.travel.left));
            }
        }
        residuals
    }

    /// Sum of the squared residuals \[m²].
    pub(super) fn cost(&self, model: &PlantModel) -> f64 {
        self.residuals(model).iter().map(|residual| residual * residual).sum()
    }
}
