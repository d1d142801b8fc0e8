//! An event as standard messages of ROS 2, for plots and viewers; the exact numbers are in the event itself.

use surepose::geometry::{Angle, Body, Map, Pose};
use surepose::kinematics::{DiffDrive, Integration, WheelPair};
use surepose::time::{Stamp, Stamped};

use crate::cdr::CdrWriter;
use crate::definitions::Topic;
use crate::event::{Event, EventInput, RecordedReading, StepOutcome};

/// Frames of the messages.
const MAP_FRAME: &str = "map";
const ODOM_FRAME: &str = "odom";
const BODY_FRAME: &str = "base_link";
const LASER_FRAME: &str = "laser";

/// Converter of events, with the dead-reckoned pose.
#[derive(Clone, Debug)]
pub(crate) struct StandardMessages {
    drive: DiffDrive<f64>,
    odom_from_body: Pose<Map, Body, f64>,
}

impl StandardMessages {
    pub(crate) fn new(drive: DiffDrive<f64>) -> Self {
        Self { drive, odom_from_body: Pose::identity() }
    }

    /// Messages of `event`, each with its topic.
    pub(crate) fn of(&mut self, event: &Event) -> Vec<(Topic, Vec<u8>)> {
        let mut messages = Vec::new();
        match &event.input {
            EventInput::Step { odometry, readings } => {
                if let [right, left, ..] = odometry.as_slice() {
                    let travel = WheelPair::new(*right, *left);
                    let motion = self.drive.motion_from_travel(travel);
                    self.odom_from_body = self.odom_from_body.integrate(motion, Integration::Arc);
                    messages.push((Topic::Odometry, odometry_message(event.stamp, self.odom_from_body)));
                }
                messages.extend(readings.iter().filter_map(|at| Some((Topic::Scan, scan(at)?))));
            }
            EventInput::SetGoal(goal) => {
                let mut cdr = header(event.stamp, MAP_FRAME);
                pose(&mut cdr, goal.x, goal.y, goal.heading);
                messages.push((Topic::Goal, cdr.finished()));
            }
            _ => {}
        }
        if let Some(outcome) = &event.outcome {
            messages.push((Topic::Belief, belief(event.stamp, outcome)));
            if let [v, omega, ..] = outcome.command.as_slice() {
                let mut cdr = header(event.stamp, BODY_FRAME);
                cdr.array(&[*v, 0.0, 0.0, 0.0, 0.0, *omega]);
                messages.push((Topic::Command, cdr.finished()));
            }
            let mut cdr = CdrWriter::new();
            cdr.text(&outcome.decision.join(" "));
            messages.push((Topic::Decision, cdr.finished()));
        }
        messages
    }
}

fn header(stamp: Stamp, frame: &str) -> CdrWriter {
    let mut cdr = CdrWriter::new();
    let nanoseconds = stamp.nanoseconds();
    cdr.u32(nanoseconds.div_euclid(1_000_000_000) as u32);
    cdr.u32(nanoseconds.rem_euclid(1_000_000_000) as u32);
    cdr.text(frame);
    cdr
}

fn pose(cdr: &mut CdrWriter, x: f64, y: f64, heading: Angle<f64>) {
    let (sin, cos) = (0.5 * heading.radians()).sin_cos();
    cdr.array(&[x, y, 0.0, 0.0, 0.0, sin, cos]);
}

fn odometry_message(stamp: Stamp, at: Pose<Map, Body, f64>) -> Vec<u8> {
    let mut cdr = header(stamp, ODOM_FRAME);
    cdr.text(BODY_FRAME);
    pose(&mut cdr, at.x, at.y, at.heading);
    cdr.array(&[0.0; 36 + 6 + 36]);
    cdr.finished()
}

fn belief(stamp: Stamp, outcome: &StepOutcome) -> Vec<u8> {
    let mut cdr = header(stamp, MAP_FRAME);
    let [x, y, heading, ..] = outcome.belief;
    pose(&mut cdr, x, y, Angle::from_radians_unchecked(heading));
    let [xx, xy, xt, yy, yt, tt] = outcome.covariance;
    let mut covariance = [0.0; 36];
    let entries = [(0, xx), (1, xy), (5, xt), (6, xy), (7, yy), (11, yt), (30, xt), (31, yt), (35, tt)];
    for (place, entry) in entries {
        covariance[place] = entry;
    }
    cdr.array(&covariance);
    cdr.finished()
}

fn scan(at: &Stamped<RecordedReading>) -> Option<Vec<u8>> {
    let RecordedReading::Scan { geometry, ranges, .. } = &at.value else { return None };
    let [first, increment, time, limits @ ..] = geometry.as_slice() else { return None };
    let steps = ranges.len().saturating_sub(1) as f64;
    let (near, far) = match limits {
        [_, _, _, near, far] => (*near, *far),
        _ => (0.0, f64::INFINITY),
    };
    let mut cdr = header(at.stamp, LASER_FRAME);
    for number in [*first, first + steps * increment, *increment, *time, time * steps, near, far] {
        cdr.f32(number as f32);
    }
    cdr.singles(ranges.iter().map(|range| *range as f32));
    cdr.singles([].into_iter());
    Some(cdr.finished())
}
