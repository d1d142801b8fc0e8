//! Calibration of the base between commands and wheels: delay, lag, limits and minimum speeds.
//!
//! The wheels' travel is predicted from the commands by the base of the simulator, [`Plant`](surepose_sim::Plant), and compared with the odometry. The
//! parameters minimize a bounded sum of squares, one after another: the sum is not smooth in the minimum speeds, which is why each
//! of them is searched on a grid. A parameter is reported only if the recording cannot be explained without it.

mod fit;
mod response;
mod significance;

use surepose::kinematics::DiffDrive;
use surepose::param;

use super::outcome::ActuatorEstimates;
use super::recording::CalibrationRecording;
use response::Response;
use significance::{judged, not_excited};

/// Fewest intervals of odometry with a known command.
const MIN_INTERVALS: usize = 100;

/// Estimates the parameters of the base from the commands and the odometry of `recording`; empty without commands.
///
/// `drive` converts wheel angles to travel. It is that with which the base computes its odometry.
pub(super) fn calibrate_actuator(
    recording: &CalibrationRecording,
    drive: &DiffDrive<f64>,
) -> ActuatorEstimates {
    if recording.commands.is_empty() {
        return Vec::new();
    }
    let response = Response::new(&recording.commands, &recording.steps(), drive);
    if response.len() < MIN_INTERVALS || response.max_speed <= 0.0 {
        let motion = "a minute of driving by commands on cmd_vel, by the clock of the odometry";
        return vec![(&param::COMMAND_DELAY, not_excited(&param::COMMAND_DELAY, motion))];
    }
    let (best, minima) = fit::fit(&response);
    judged(&response, best, minima)
}

#[cfg(test)]
mod tests;
