//! Parks a simulated robot at a pose: the smallest complete use of [`Navigator`].
//!
//! The robot has wheel encoders, a map of its room, and no laser. The simulated wheels follow every
//! command exactly, so that the estimate by odometry is exact too.
//!
//! ```text
//! cargo run --release -p surepose --example park
//! ```

use std::error::Error;
use std::process::ExitCode;

use surepose::control::{Controller, Direction, Limits, Tolerance};
use surepose::estimation::{Belief, DelayedEkf, Ekf, Gate};
use surepose::geometry::{Angle, Body, Goal, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist, WheelPair};
use surepose::lidar::ScanProcessor;
use surepose::localization::{Localizer, Odometry, SensorInput};
use surepose::map::{MapView, Wall};
use surepose::navigator::{GoalResult, Navigator, NavigatorConfig};
use surepose::safety::Footprint;
use surepose::time::Stamp;

/// Time between two steps \[s].
const PERIOD: f64 = 0.02;
/// Time after which the drive counts as failed \[s].
const MAX_TIME: f64 = 60.0;

pub(crate) fn main() -> Result<ExitCode, Box<dyn Error>> {
    // The robot: wheel radius 5 cm, wheel separation 0.4 m, and what its motors can do.
    let drive = DiffDrive::new(0.05, 0.4);
    let limits = Limits::symmetric(0.5, 1.0);

    // The controller, with gains that follow from the robot, and the tolerance of the goal.
    let tolerance = Tolerance { position: 0.01, heading: 0.02, dwell: 0.5, hysteresis: 1.5 };
    let controller = Controller::fitted(drive, limits, PERIOD, Direction::Auto, tolerance);

    // The filter, with a history of 1 s and the belief that the robot starts at the origin.
    let ekf = Ekf { drive, delta: 0.0025, integration: Integration::Arc };
    let belief = Belief::new(Pose::identity(), [0.01, 0.01, 0.01]);
    let start = Stamp::from_seconds(0.0);
    let filter = DelayedEkf::<f64, 64>::new(ekf, Gate::new(0.999), 1.0, start, belief);

    // No laser, and no supervision: nothing but odometry would be a fault.
    let localizer = Localizer::<f64, 64, 0, 1, 1>::unsupervised(filter, ScanProcessor::disabled());
    let mut navigator = Navigator::new(NavigatorConfig::new(controller, Footprint::Circle(0.25)), localizer);

    // The map: a room of 5 m by 4 m around the start. A goal outside the rectangle around all walls is rejected.
    let corners = [(-1.0, -1.0), (4.0, -1.0), (4.0, 3.0), (-1.0, 3.0), (-1.0, -1.0)];
    let corners = corners.map(|(x, y)| Point::new(x, y));
    let walls =
        corners.windows(2).map(|ends| Wall::between(ends[0], ends[1])).collect::<Result<Vec<_>, _>>()?;
    let map = MapView::from_walls(&walls);
    let goal: Pose<Map, Goal, f64> = Pose::new(2.0, 1.0, Angle::from_degrees(90.0));
    navigator.set_goal(&map, goal).map_err(|blocked| format!("goal too close to a wall: {blocked:?}"))?;

    let mut truth: Pose<Map, Body, f64> = Pose::identity();
    let mut travel = WheelPair::zero();
    for tick in 0_u32.. {
        let time = f64::from(tick) * PERIOD;
        let stamp = Stamp::from_seconds(time);
        let input = SensorInput { stamp, odometry: Odometry::WheelTravel(travel), readings: &[] };
        let report = navigator.step(&map, &input);
        if tick % 50 == 0 || report.result.is_some() {
            println!(
                "{time:5.1} s  x {:6.3} m  y {:6.3} m  heading {:6.1}°  {:?}",
                truth.x,
                truth.y,
                truth.heading.radians().to_degrees(),
                report.result,
            );
        }
        if report.result.is_some() || time > MAX_TIME {
            let reached = report.result == Some(GoalResult::Reached);
            let is_near = truth.origin().distance(goal.origin()) < 2.0 * tolerance.position;
            return Ok(if reached && is_near { ExitCode::SUCCESS } else { ExitCode::FAILURE });
        }

        // The simulated wheels: the robot moves with the commanded twist for one period.
        let twist = report.command.map_or(Twist::zero(), |command| command.twist);
        travel = drive.wheel_speeds_from_twist(twist).scaled(PERIOD);
        truth = truth.integrate(twist.integrate_for(PERIOD), Integration::Arc);
    }
    Ok(ExitCode::FAILURE)
}
