//! The closed loop brings the robot to rest at the goal.

use surepose::control::{Controller, ControllerState, Direction, Limits, Tolerance};
use surepose::geometry::{Angle, Body, Goal, Map, Pose};
use surepose::kinematics::{DiffDrive, Integration};

fn controller(direction: Direction) -> Controller<f64> {
    let (drive, period) = (DiffDrive::new(0.05, 0.6), 0.02);
    let limits = Limits::symmetric(0.3, 100.0);
    let tolerance = Tolerance { position: 0.01, heading: 1f64.to_radians(), dwell: 1.0, hysteresis: 1.5 };
    Controller::fitted(drive, limits, period, direction, tolerance)
}

#[test]
fn every_direction_of_approach_parks() {
    let goal: Pose<Map, Goal, f64> = Pose::new(0.0, 0.0, Angle::zero());
    for direction in [Direction::Forward, Direction::Reverse, Direction::Auto] {
        for k in 0..64_u32 {
            let bearing = f64::from(k) * 0.1;
            let heading = Angle::from_radians(f64::from(k) * 2.4);
            let mut pose: Pose<Map, Body, f64> = Pose::new(2.0 * bearing.cos(), 2.0 * bearing.sin(), heading);
            let controller = controller(direction);
            let mut state = ControllerState::new();
            let mut reached = false;
            for _ in 0..6000 {
                let step = controller.step(state, pose, goal);
                assert!(controller.drive.wheel_speeds_from_twist(step.limited).max_abs() <= 0.3 + 1e-12);
                pose = pose.integrate(step.limited.integrate_for(controller.period), Integration::Arc);
                state = step.state;
                reached = state.goal_checker.reached(&controller.tolerance);
                if reached {
                    break;
                }
            }
            assert!(reached, "{direction:?} from start {k} stands at {pose:?}");
        }
    }
}
