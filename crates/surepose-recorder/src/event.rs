//! Events of a recording: the calls of the navigator, and the outcome of each step.

use surepose::estimation::{Belief, Measurement};
use surepose::geometry::{Goal, Map, Pose};
use surepose::kinematics::WheelPair;
use surepose::linalg::Covariance;
use surepose::localization::{Odometry, SensorInput, SensorReading};
use surepose::navigator::StepReport;
use surepose::safety::SafetyAction;
use surepose::time::{Stamp, Stamped};

/// A call of the navigator.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Number of the event, from 0; a gap stands for events that were dropped.
    pub sequence: u64,
    /// Time of the event, by the stamps of the inputs.
    pub stamp: Stamp,
    /// The call with its inputs.
    pub input: EventInput,
    /// Outcome of a step; `None` for other calls.
    pub outcome: Option<StepOutcome>,
}

/// A call of the navigator with its inputs.
#[derive(Clone, Debug, PartialEq)]
pub enum EventInput {
    /// [`Navigator::start`](surepose::navigator::Navigator::start).
    Start(Option<Belief<f64>>),
    /// [`Navigator::set_belief`](surepose::navigator::Navigator::set_belief), with the stamp of the event.
    SetBelief(Belief<f64>),
    /// [`Navigator::mark_lost`](surepose::navigator::Navigator::mark_lost).
    MarkLost,
    /// [`Navigator::set_goal`](surepose::navigator::Navigator::set_goal).
    SetGoal(Pose<Map, Goal, f64>),
    /// [`Navigator::cancel_goal`](surepose::navigator::Navigator::cancel_goal).
    CancelGoal,
    /// [`Navigator::abort_goal`](surepose::navigator::Navigator::abort_goal); its reason is reported, but has no other effect.
    AbortGoal,
    /// [`Navigator::on_odometry_timeout`](surepose::navigator::Navigator::on_odometry_timeout).
    OdometryTimeout,
    /// [`Navigator::step`](surepose::navigator::Navigator::step), with the stamp of the event.
    Step {
        /// Travel of the right and left wheel \[m], and their variances \[m²] where they are known; empty without odometry.
        odometry: Vec<f64>,
        /// Readings of the sensors.
        readings: Vec<Stamped<RecordedReading>>,
    },
}

/// Reading of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordedReading {
    /// Yaw rate \[rad/s].
    YawRate(f64),
    /// Heading and its standard deviation \[rad].
    Heading([f64; 2]),
    /// Scan.
    Scan {
        /// First angle and increment \[rad], time increment \[s]; then, where the scan gives them: mounting x, y \[m],
        /// heading \[rad], smallest and largest range \[m].
        geometry: Vec<f64>,
        /// Ranges \[m].
        ranges: Vec<f64>,
        /// Directions of the beams \[rad]; empty for even steps.
        bearings: Vec<f64>,
    },
    /// Measurement of a kind that is not recorded: neither `run` nor `ros2` has one.
    Other,
}

/// Outcome of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepOutcome {
    /// The belief: x, y \[m], heading \[rad], and the factors of the covariance: u01, u02, u12, d0, d1, d2.
    pub belief: [f64; 9],
    /// Entries of the covariance: xx, xy, xθ, yy, yθ, θθ.
    pub covariance: [f64; 6],
    /// The command: v \[m/s], ω \[rad/s], turn rates of the right and left wheel \[rad/s]; empty without one.
    pub command: Vec<f64>,
    /// ρ \[m], α, φ \[rad]; empty without a goal.
    pub navigation: Vec<f64>,
    /// Health, action, disagreement, reason of a block, result of the goal; `-` where there is none.
    pub decision: [String; 5],
}

impl EventInput {
    /// The step with `input`.
    pub fn of_step(input: &SensorInput<'_, f64>) -> Self {
        let pair = |pair: WheelPair<f64>| [pair.right, pair.left];
        let odometry = match input.odometry {
            Odometry::WheelTravel(travel) => pair(travel).to_vec(),
            Odometry::WithVariance(odometry) => [pair(odometry.travel), pair(odometry.variance)].concat(),
            Odometry::Missing => Vec::new(),
        };
        let readings = input.readings.iter().map(|at| Stamped::new(at.stamp, RecordedReading::of(&at.value)));
        Self::Step { odometry, readings: readings.collect() }
    }

    /// Name of the call.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Start(_) => "start",
            Self::SetBelief(_) => "set_belief",
            Self::MarkLost => "mark_lost",
            Self::SetGoal(_) => "set_goal",
            Self::CancelGoal => "cancel_goal",
            Self::AbortGoal => "abort_goal",
            Self::OdometryTimeout => "odometry_timeout",
            Self::Step { .. } => "step",
        }
    }
}

impl RecordedReading {
    fn of(reading: &SensorReading<'_, f64>) -> Self {
        match reading {
            SensorReading::YawRate(rate) => Self::YawRate(*rate),
            SensorReading::Measurement(Measurement::Heading(read)) => {
                Self::Heading([read.heading.radians(), read.std])
            }
            SensorReading::Measurement(_) => Self::Other,
            SensorReading::Scan(scan) => {
                let mut geometry = vec![scan.angle_min.radians(), scan.angle_increment, scan.time_increment];
                if let Some(laser) = scan.geometry {
                    let mount = laser.body_from_laser;
                    let limits = [laser.range_min, laser.range_max];
                    geometry.extend([mount.x, mount.y, mount.heading.radians()].into_iter().chain(limits));
                }
                let bearings = scan.bearings.unwrap_or(&[]).iter().map(|angle| angle.radians()).collect();
                Self::Scan { geometry, ranges: scan.ranges.to_vec(), bearings }
            }
        }
    }

    /// Name of the sensor.
    pub fn name(&self) -> &'static str {
        match self {
            Self::YawRate(_) => "yaw_rate",
            Self::Heading(_) => "heading",
            Self::Scan { .. } => "scan",
            Self::Other => "other",
        }
    }
}

impl StepOutcome {
    /// Outcome in a report.
    pub fn of(report: &StepReport<f64>) -> Self {
        let entry = |(row, column)| report.belief.covariance.entry(row, column);
        let command = report.command.map(|command| {
            vec![command.twist.v, command.twist.omega, command.wheels.right, command.wheels.left]
        });
        let navigation = report.control.map(|control| {
            let at = control.navigation;
            vec![at.rho, at.alpha.radians(), at.phi.radians()]
        });
        let none = || "-".to_owned();
        let action = match report.action {
            SafetyAction::Proceed => "proceed".to_owned(),
            SafetyAction::Slowdown(reason) => format!("slowdown:{}", reason.name()),
            SafetyAction::Stop(reason) => format!("stop:{}", reason.name()),
        };
        Self {
            belief: numbers_of(&report.belief),
            covariance: [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(entry),
            command: command.unwrap_or_default(),
            navigation: navigation.unwrap_or_default(),
            decision: [
                format!("{:?}", report.health).to_lowercase(),
                action,
                report.disagreement.map_or_else(none, |sensor| sensor.name().to_owned()),
                report.blocked_by.map_or_else(none, |reason| reason.name().to_owned()),
                report.result.map_or_else(none, |result| format!("{result:?}")),
            ],
        }
    }
}

/// Pose and factors of the covariance, without a loss.
pub(crate) fn numbers_of(belief: &Belief<f64>) -> [f64; 9] {
    let (pose, (u, d)) = (belief.pose, belief.covariance.factors());
    [pose.x, pose.y, pose.heading.radians(), u[0][1], u[0][2], u[1][2], d[0], d[1], d[2]]
}

/// The belief of [`numbers_of`].
pub(crate) fn belief_of(numbers: [f64; 9]) -> Belief<f64> {
    let [x, y, heading, u01, u02, u12, d0, d1, d2] = numbers;
    let upper = [[0.0, u01, u02], [0.0, 0.0, u12], [0.0; 3]];
    Belief {
        pose: Pose::new(x, y, surepose::geometry::Angle::from_radians_unchecked(heading)),
        covariance: Covariance::from_factors(upper, [d0, d1, d2]),
    }
}
