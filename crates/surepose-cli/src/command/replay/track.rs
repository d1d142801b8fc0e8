//! Writes the trajectory of a replay: TUM form, CSV and pictures.

use std::fmt::Write as _;

use serde::Serialize;
use surepose::geometry::{Body, Map, Pose};
use surepose_figures as picture;
use surepose_replay::Track;

use crate::error::CliError;
use crate::output_dir::OutputDir;

/// Row of `trajectory.csv`; errors and NEES are empty where the estimate is not judged.
#[derive(Serialize)]
struct Row {
    time_s: f64,
    x_m: f64,
    y_m: f64,
    heading_deg: f64,
    x_std_m: f64,
    y_std_m: f64,
    heading_std_deg: f64,
    trusted: bool,
    reference_x_m: Option<f64>,
    reference_y_m: Option<f64>,
    reference_heading_deg: Option<f64>,
    position_error_m: Option<f64>,
    heading_error_deg: Option<f64>,
    nees: Option<f64>,
}

/// Writes `trajectory.tum`, `reference.tum` if there is a reference, `trajectory.csv`, and pictures of map and errors.
pub(super) fn write_track(folder: &OutputDir, track: &Track) -> Result<(), CliError> {
    let estimated = track.points.iter().map(|point| (point.time, point.pose));
    folder.text("trajectory.tum", &tum(estimated))?;
    let reference = || track.points.iter().filter_map(|point| Some((point.time, point.truth?)));
    if reference().next().is_some() {
        folder.text("reference.tum", &tum(reference()))?;
    }
    let rows = track.points.iter().map(|point| {
        let [x_std_m, y_std_m, heading_std] = point.std;
        let judged = point.truth.filter(|_| point.nees.is_some());
        Row {
            time_s: point.time,
            x_m: point.pose.x,
            y_m: point.pose.y,
            heading_deg: point.pose.heading.degrees(),
            x_std_m,
            y_std_m,
            heading_std_deg: heading_std.to_degrees(),
            trusted: point.is_trusted,
            reference_x_m: point.truth.map(|truth| truth.x),
            reference_y_m: point.truth.map(|truth| truth.y),
            reference_heading_deg: point.truth.map(|truth| truth.heading.degrees()),
            position_error_m: judged.map(|truth| point.pose.origin().distance(truth.origin())),
            heading_error_deg: judged.map(|truth| (point.pose.heading - truth.heading).degrees()),
            nees: point.nees,
        }
    });
    folder.table("trajectory.csv", rows)?;
    if !track.points.is_empty() {
        folder.picture("map", &picture::replay_map(track))?;
    }
    picture::replay_errors(track).map_or(Ok(()), |errors| folder.picture("errors", &errors))
}

/// Formats poses as lines `time x y z qx qy qz qw`, as evo reads them.
fn tum(poses: impl Iterator<Item = (f64, Pose<Map, Body, f64>)>) -> String {
    let mut text = String::new();
    for (time, pose) in poses {
        let (sin, cos) = (pose.heading.radians() * 0.5).sin_cos();
        // Writing to a string does not fail.
        let _ = writeln!(text, "{time:.6} {:.6} {:.6} 0 0 0 {sin:.9} {cos:.9}", pose.x, pose.y);
    }
    text
}
