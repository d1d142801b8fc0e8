//! The navigator: from sensor readings to wheel commands, in one step.

use std::path::PathBuf;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use surepose::estimation::Belief;
use surepose::geometry::Point;
use surepose::kinematics::WheelPair;
use surepose::localization::{Odometry, SensorInput};
use surepose::map::Wall;
use surepose::navigator::{GoalResult, StepReport};
use surepose::safety::{Health, SafetyAction};
use surepose::time::Stamp;
use surepose_config::{NavigatorSetup, RobotNavigator, ScanMethod};
use surepose_io::owned_map::OwnedMap;
use surepose_io::wall_map;

use crate::belief::PyBelief;
use crate::checks::{self, PoseArgument};
use crate::readings::readings;
use crate::settings::{PyConfig, config_of};

/// Navigation of one robot: estimate, supervisor, controller, collision check and limits, as on the robot.
///
/// `map` is a wall map (.toml) or an array of walls with rows x0, y0, x1, y1 [m]; `None` is a robot without a laser. `start` is a
/// `Belief`; `None` with a map starts global localization, and without a map it is the origin.
#[pyclass(name = "Navigator", module = "surepose")]
pub(crate) struct PyNavigator {
    navigator: Box<RobotNavigator>,
    map: OwnedMap,
}

#[pymethods]
impl PyNavigator {
    #[new]
    #[pyo3(signature = (config=None, *, map=None, start=None, stamp=None, has_compass=true, hold_goal=false))]
    fn new(
        config: Option<PyRef<'_, PyConfig>>,
        map: Option<&Bound<'_, PyAny>>,
        start: Option<PyRef<'_, PyBelief>>,
        stamp: Option<&Bound<'_, PyAny>>,
        has_compass: bool,
        hold_goal: bool,
    ) -> PyResult<Self> {
        let walls = map.map(walls).transpose()?;
        let stamp = stamp.map_or(Ok(Stamp::default()), |stamp| checks::stamp("stamp", stamp))?;
        let setup = NavigatorSetup {
            scan_method: ScanMethod::Lines,
            map_std: walls.as_deref().map_or(0.0, Wall::position_std_of),
            has_laser: walls.is_some(),
            is_aided: walls.is_some() || has_compass,
            safety_radius: None,
            hold_goal,
        };
        let origin = Belief::new(surepose::geometry::Pose::identity(), [0.0; 3]);
        let belief = start.as_ref().map_or(origin, |start| start.belief);
        let mut navigator = config_of(config.as_deref()).navigator(&setup, stamp, belief);
        if start.is_none() && walls.is_some() {
            navigator.mark_lost();
        }
        Ok(Self { navigator, map: OwnedMap::from_walls(walls.unwrap_or_default()) })
    }

    /// Advances the estimate to `stamp` and computes the command for the next period.
    ///
    /// `wheel_travel` is the travel of the right and the left wheel since the previous step [m]; `None` if odometry is missing.
    /// `readings` are the scans, measurements and yaw rates that arrived since then, in any order.
    #[pyo3(signature = (stamp, wheel_travel, readings=None))]
    fn step(
        &mut self,
        stamp: &Bound<'_, PyAny>,
        wheel_travel: Option<(f64, f64)>,
        readings: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyStepReport> {
        let stamp = checks::stamp("stamp", stamp)?;
        let borrowed = self::readings(readings)?;
        let readings: Vec<_> = borrowed.iter().map(|reading| reading.at(stamp)).collect();
        let odometry = wheel_travel
            .map_or(Odometry::Missing, |(right, left)| Odometry::WheelTravel(WheelPair::new(right, left)));
        let input = SensorInput { stamp, odometry, readings: &readings };
        Ok(PyStepReport { report: self.navigator.step(&self.map.view(), &input) })
    }

    /// Sets a goal (x, y, heading) [m, m, rad]; the previous one is preempted. Raises `ValueError` if the walls rule it out.
    fn set_goal(&mut self, goal: PoseArgument) -> PyResult<()> {
        let goal = checks::pose("goal", goal)?;
        let is_lost = self.navigator.localizer().health() == Health::Lost;
        let here = (!is_lost).then(|| self.navigator.localizer().belief().pose.origin());
        let checked = self.map.check_goal(&self.navigator.config().collision, here, goal);
        checked.map_err(|problem| PyValueError::new_err(format!("goal: {problem}")))?;
        // The navigator repeats the check of the clearance, which has passed.
        let _previous = self.navigator.set_goal(&self.map.view(), goal);
        Ok(())
    }

    /// Cancels the goal; the next steps brake.
    fn cancel_goal(&mut self) {
        self.navigator.cancel_goal();
    }

    /// Declares the pose unknown, so that the robot localizes itself globally.
    fn mark_lost(&mut self) {
        self.navigator.mark_lost();
    }

    /// Newest belief; meaningless while the robot is lost.
    #[getter]
    fn belief(&self) -> PyBelief {
        PyBelief { belief: self.navigator.localizer().belief() }
    }

    /// Counts of accepted and rejected measurements, by reason.
    #[getter]
    fn measurement_stats(&self) -> std::collections::BTreeMap<&'static str, u32> {
        use surepose::estimation::RejectReason;
        let stats = self.navigator.localizer().measurement_stats();
        let rejected = RejectReason::ALL.iter().map(|reason| (reason.name(), stats.rejected(*reason)));
        rejected.chain([("accepted", stats.accepted)]).collect()
    }
}

/// Outcome of one step of the navigator.
#[pyclass(name = "StepReport", module = "surepose", frozen)]
pub(crate) struct PyStepReport {
    report: StepReport<f64>,
}

#[pymethods]
impl PyStepReport {
    /// Estimate; meaningless while `health` is "lost".
    #[getter]
    fn belief(&self) -> PyBelief {
        PyBelief { belief: self.report.belief }
    }

    /// "healthy", "degraded" or "lost".
    #[getter]
    fn health(&self) -> &'static str {
        match self.report.health {
            Health::Healthy => "healthy",
            Health::Degraded => "degraded",
            Health::Lost => "lost",
        }
    }

    /// Reason for which the supervisor slows the robot down or stops it; `None` if it does not.
    #[getter]
    fn fault(&self) -> Option<&'static str> {
        match self.report.action {
            SafetyAction::Proceed => None,
            SafetyAction::Slowdown(reason) | SafetyAction::Stop(reason) => Some(reason.name()),
        }
    }

    /// Commanded speed [m/s] and turn rate [rad/s]; `None` without a goal: the wheels are free.
    #[getter]
    fn command(&self) -> Option<(f64, f64)> {
        self.report.command.map(|command| (command.twist.v, command.twist.omega))
    }

    /// Commanded turn rates of the right and the left wheel [rad/s]; `None` without a goal.
    #[getter]
    fn wheel_rates(&self) -> Option<(f64, f64)> {
        self.report.command.map(|command| (command.wheels.right, command.wheels.left))
    }

    /// Distance [m], bearing [rad] and direction of approach [rad] of the goal; `None` without a goal.
    #[getter]
    fn navigation(&self) -> Option<(f64, f64, f64)> {
        let navigation = self.report.control?.navigation;
        Some((navigation.rho, navigation.alpha.radians(), navigation.phi.radians()))
    }

    /// Reason of a stop for a wall, an obstacle or the laser; `None` if the path is free.
    #[getter]
    fn blocked_by(&self) -> Option<&'static str> {
        self.report.blocked_by.map(surepose::safety::BlockReason::name)
    }

    /// "reached", "preempted", "canceled" or the reason of an aborted goal, in the step in which it ended; else `None`.
    #[getter]
    fn result(&self) -> Option<&'static str> {
        self.report.result.map(|result| match result {
            GoalResult::Reached => "reached",
            GoalResult::Preempted => "preempted",
            GoalResult::Canceled => "canceled",
            GoalResult::Aborted(reason) => reason.name(),
            // The enum may grow.
            _ => "ended",
        })
    }
}

/// Walls of a map file, or of an array with rows x0, y0, x1, y1.
fn walls(map: &Bound<'_, PyAny>) -> PyResult<Vec<Wall<f64>>> {
    if let Ok(path) = map.extract::<PathBuf>() {
        let map = wall_map::read(&path).map_err(|error| PyValueError::new_err(format!("map: {error}")))?;
        return Ok(wall_map::walls_from_map(&map));
    }
    let mut walls = Vec::new();
    for (index, row) in checks::rows("map", map, 4)?.iter().enumerate() {
        let [x0, y0, x1, y1] = [row[0], row[1], row[2], row[3]];
        let wall = Wall::between(Point::new(x0, y0), Point::new(x1, y1));
        walls.push(wall.map_err(|_| {
            PyValueError::new_err(format!(
                "map[{index}]: not a wall (got {x0}, {y0}, {x1}, {y1}; expected two different finite points)"
            ))
        })?);
    }
    Ok(walls)
}
