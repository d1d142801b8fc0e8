//! Records a drive of ten minutes between two poses and replays it: prints the cost of both.
//!
//! `cargo run --release -p surepose-recorder --example ten_minutes`

use std::error::Error;
use std::time::{Duration, Instant};

use surepose::geometry::{Angle, Pose};
use surepose::kinematics::WheelPair;
use surepose::navigator::GoalResult;
use surepose::time::Stamp;
use surepose_recorder::{EventInput, FlightRecorder, RecorderHandle, Session, replay::replay};
use surepose_sim::robot::{Scenario, Sensors, SimulatedRobot, wall_map_from_arena};

const STEPS: usize = 6000;
const PERIOD: f64 = 0.1;
/// Pause after each step of the drive that measures the longest time of a log.
const PAUSE: Duration = Duration::from_millis(1);

fn main() -> Result<(), Box<dyn Error>> {
    for laser in [false, true] {
        let sensors = Sensors { laser, ..Sensors::ALL };
        let scenario = Scenario { sensors, ..Scenario::default() };
        let folder = std::env::temp_dir().join(format!("surepose-ten-minutes-{}", std::process::id()));
        let (alone, _) = drive(&scenario, STEPS, None, None);
        let robot = SimulatedRobot::new(&scenario, 1);
        let session = Session::new(
            scenario.config.clone(),
            scenario.navigator_setup(),
            Some(wall_map_from_arena(&scenario.arena)),
            Stamp::default(),
            robot.navigator().localizer().belief(),
        );
        let begun = Instant::now();
        let recorder = FlightRecorder::create(&folder, &session)?;
        drive(&scenario, STEPS, Some(&recorder.handle()), None);
        let summary = recorder.finish()?;
        let cost = begun.elapsed().saturating_sub(alone).as_secs_f64() / 600.0;
        let replayed = replay(&folder, None, |config| config)?.ok_or("no session")?;
        std::fs::remove_dir_all(&folder)?;
        let recorder = FlightRecorder::create(&folder, &session)?;
        let (_, longest) = drive(&scenario, STEPS, Some(&recorder.handle()), Some(PAUSE));
        let paced = recorder.finish()?;
        std::fs::remove_dir_all(&folder)?;
        println!(
            "laser {laser}: {} steps, identical {}, {:.0} × real time; {:.2} MB/min, {} dropped; {:.2} % of a core, longest log {} µs",
            replayed.steps,
            replayed.bit_identical,
            replayed.duration_s / replayed.wall_s,
            summary.bytes as f64 / 1e6 / 10.0,
            summary.dropped + paced.dropped,
            100.0 * cost,
            longest.as_micros(),
        );
    }
    Ok(())
}

/// Drives to and fro; returns the time that it took, and the longest time that logging a step took.
///
/// With a `pause` after each step the loop logs as on a robot: it never waits for the recorder.
fn drive(
    scenario: &Scenario,
    steps: usize,
    recorder: Option<&RecorderHandle>,
    pause: Option<Duration>,
) -> (Duration, Duration) {
    let begun = Instant::now();
    let mut robot = SimulatedRobot::new(scenario, 1);
    let goals = [scenario.goal(), Pose::new(0.5, 0.5, Angle::from_degrees(-90.0))];
    let (mut wheels, mut trip, mut longest) = (WheelPair::zero(), 0, Duration::ZERO);
    let mut send = true;
    for _ in 0..steps {
        if std::mem::take(&mut send) {
            let (goal, stamp) = (goals[trip % 2], robot.navigator().localizer().stamp());
            if robot.set_goal(goal).is_ok()
                && let Some(recorder) = recorder
            {
                recorder.log(stamp, EventInput::SetGoal(goal));
            }
            trip += 1;
        }
        let report = robot.advance_watched(wheels, PERIOD, |input, report| {
            if let Some(recorder) = recorder {
                let begun = Instant::now();
                match pause {
                    Some(_) => recorder.log_step(input, report),
                    None => recorder.log_simulated_step(input, report),
                }
                longest = longest.max(begun.elapsed());
            }
        });
        send = report.result == Some(GoalResult::Reached);
        if let Some(pause) = pause {
            std::thread::sleep(pause);
        }
        wheels = report.command.map_or(WheelPair::zero(), |command| command.wheels);
    }
    (begun.elapsed(), longest)
}
