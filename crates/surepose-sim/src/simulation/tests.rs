use surepose::geometry::{Angle, Point, Pose};
use surepose::param::{GOAL_HEADING, GOAL_X, GOAL_Y, START_HEADING, START_X, START_Y};
use surepose::safety::SafetyAction;
use surepose_config::Config;

use crate::robot::{Scenario, ScenarioEnd, Sensors, walls_from_segments};
use crate::{Arena, Fault, FaultKind, Seed, Sensor};

use super::{Sample, Simulation, SimulationOutcome, SimulationSummary, simulate};

fn assert_parked(summary: &SimulationSummary, what: &str) {
    assert_eq!(summary.outcome, SimulationOutcome::Reached, "{what}: {summary:?}");
    assert!(summary.final_position_error_m <= 0.01, "{what}: {summary:?}");
    assert!(summary.final_heading_error_deg <= 1.0, "{what}: {summary:?}");
    assert!(summary.final_speed_m_s <= 0.0, "{what}: {summary:?}");
    // The optimal time excludes the dwell time of 1 s.
    assert!(summary.time_s - 1.0 >= summary.optimal_time_s, "{what}: {summary:?}");
    assert!(summary.wheel_speed_max_m_s <= 0.3 + 1e-12, "{what}: {summary:?}");
    assert!(summary.wheel_acceleration_max_m_s2 <= 0.5 + 1e-9, "{what}: {summary:?}");
}

/// The mean NEES of n independent drives varies less than that of n single draws of χ²₃, whose 95 % band is used.
#[test]
fn default_drive_parks_with_consistent_estimate() {
    let runs: Vec<SimulationSummary> = (1..=8).map(|seed| simulate(&Scenario::default(), seed).1).collect();
    for summary in &runs {
        assert_parked(summary, "default");
    }
    let nees = runs.iter().filter_map(|s| s.nees_mean).sum::<f64>() / runs.len() as f64;
    let band = 1.96 * (6.0 / runs.len() as f64).sqrt();
    assert!((nees - 3.0).abs() < band, "{nees}");
    // Considered errors that this world does not have make the filter cautious, and it parks as well.
    let cautious = Scenario::in_arena(Arena::paper(), Config::default().with_typical_model_errors());
    for seed in 1..=8 {
        let summary = simulate(&cautious, seed).1;
        assert_parked(&summary, "typical model errors");
        assert!(summary.nees_mean.is_some_and(|nees| nees < 3.0), "{:?}", summary.nees_mean);
        assert!(summary.final_position_error_m < 0.003, "{}", summary.final_position_error_m);
    }
}

#[test]
fn every_direction_parks_from_random_starts() {
    for direction in ["auto", "forward", "reverse"] {
        let mut starts = Seed(1).stream("starts");
        for seed in 1..=5 {
            let (x, y) = (starts.uniform(-1.5, 4.0), starts.uniform(-1.5, 4.0));
            let start = [(&START_X, x), (&START_Y, y), (&START_HEADING, starts.uniform(-180.0, 180.0))];
            let config = Config::default().with_preset("test", &start);
            let config = config.with_option(&format!("law.direction={direction}")).unwrap();
            let (samples, summary) = simulate(&Scenario::in_arena(Arena::open(), config), seed);
            assert_parked(&summary, &format!("{direction} from {x:.2}, {y:.2}"));
            assert!(samples.iter().all(|s| s.lyapunov.is_finite() && s.nees.is_finite()));
        }
    }
}

/// The simulated wheels differ by 4 %, and so do those of the configuration. Equal radii in the filter would
/// give a heading error of 1.1° per 0.1 s at full speed.
#[test]
fn robot_with_unequal_wheels_parks() {
    let config = Config::default().with_option("robot.wheel_radius_ratio=1.04").unwrap();
    for seed in 1..=3 {
        let summary = simulate(&Scenario::in_arena(Arena::paper(), config.clone()), seed).1;
        assert_parked(&summary, "unequal wheels");
        assert!(summary.nees_mean.unwrap() < 6.0, "{summary:?}");
    }
}

#[test]
fn same_seed_same_bits() {
    let run = |seed| format!("{:?}", simulate(&Scenario::default(), seed));
    assert_eq!(run(3), run(3));
    assert_ne!(run(3), run(4));
}

#[test]
fn odometry_only_has_larger_error_and_reports_it() {
    let blind = Scenario { sensors: Sensors::NONE, ..Scenario::default() };
    let (samples, summary) = simulate(&blind, 1);
    let with_all = simulate(&Scenario::default(), 1).1;
    assert!(summary.position_rmse_m > with_all.position_rmse_m.map(|rmse| 3.0 * rmse));
    let end = samples.last().unwrap();
    assert!(end.variance_x_m2.sqrt() > 0.01 && end.nees < 16.0, "{end:?}");
}

/// Readings of faulty sensors during 0.5 s are rejected and counted, and the robot parks.
#[test]
fn faulty_readings_are_rejected_and_the_robot_parks() {
    let clean = simulate(&Scenario::default(), 1).1.rejected.total();
    for (sensor, refused) in [(Sensor::Compass, 5), (Sensor::Encoders, 5)] {
        let faults = vec![Fault::between(4.0, 4.5, FaultKind::NotANumber(sensor))];
        let summary = simulate(&Scenario { faults, ..Scenario::default() }, 1).1;
        assert_parked(&summary, &format!("{sensor:?}"));
        assert!(summary.rejected.total() >= clean + refused, "{sensor:?}: {summary:?}");
    }
    let blinded = [
        FaultKind::NotANumber(Sensor::Laser),
        FaultKind::Dropout(Sensor::Laser),
        FaultKind::Offset(Sensor::Laser, 0.5),
    ];
    for kind in blinded {
        let faults = vec![Fault::between(4.0, 4.5, kind)];
        assert_parked(&simulate(&Scenario { faults, ..Scenario::default() }, 1).1, &format!("{kind:?}"));
    }
    let stale = vec![Fault::between(4.0, 4.5, FaultKind::StampOffset(Sensor::Compass, 3.0))];
    let summary = simulate(&Scenario { faults: stale, ..Scenario::default() }, 1).1;
    assert_parked(&summary, "stale compass");
    assert!(summary.rejected.total() >= clean + 5, "{summary:?}");
}

#[test]
fn delayed_measurements_update_the_past_state() {
    let config = Config::default().with_option("laser.latency_s=0.25").unwrap();
    let config = config.with_option("compass.latency_s=0.12").unwrap();
    let late = simulate(&Scenario { config, ..Scenario::default() }, 1).1;
    assert_parked(&late, "late");
    // Without delay compensation a scan of 0.25 s ago has an error of 75 mm at full speed.
    assert!(late.position_rmse_m.unwrap() < 0.01, "{late:?}");
    assert!(late.nees_mean.unwrap() < 6.0, "{late:?}");
}

#[test]
fn supervisor_does_not_intervene_for_a_healthy_robot() {
    for seed in 1..=8 {
        let mut simulation = Simulation::new(&Scenario::default(), seed);
        while simulation.next().is_some() {
            assert_eq!(simulation.action(), SafetyAction::Proceed, "seed {seed}");
        }
    }
}

/// A displaced robot detects the loss, relocalizes and parks.
#[test]
fn kidnapped_robot_relocalizes_and_parks() {
    let faults = vec![Fault::at(4.0, FaultKind::Displaced([1.5, -1.0, 2.0]))];
    for seed in 1..=5 {
        assert_parked(
            &simulate(&Scenario { faults: faults.clone(), ..Scenario::default() }, seed).1,
            "kidnapped",
        );
    }
}

/// A push by 5 cm is within the gate of a single beam and outside the gates of whole walls.
#[test]
fn pushed_robot_parks() {
    for push in [[0.05, 0.0, 0.0], [0.0, -0.05, 0.0], [0.02, 0.0, 0.0]] {
        for (compass, seed) in [(true, 1), (true, 2), (true, 3), (false, 1), (false, 2), (false, 3)] {
            let faults = vec![Fault::at(8.0, FaultKind::Displaced(push))];
            let sensors = Sensors { compass, laser: true };
            let summary = simulate(&Scenario { sensors, faults, ..Scenario::default() }, seed).1;
            assert_parked(&summary, &format!("pushed by {push:?}"));
        }
    }
}

/// A range offset of ±10 cm during 1 s causes no lasting pose error. A filter that considers model errors ends the goal instead.
#[test]
fn temporary_range_offset_causes_no_lasting_error() {
    for off in [0.1, -0.1] {
        let faults = vec![Fault::between(4.0, 5.0, FaultKind::Offset(Sensor::Laser, off))];
        let sensors = Sensors { compass: false, laser: true };
        for seed in 1..=10 {
            let scenario = Scenario { sensors, faults: faults.clone(), ..Scenario::default() };
            let summary = simulate(&scenario, seed).1;
            assert_parked(&summary, &format!("ranges off by {off} m"));
            assert!(summary.heading_rmse_deg < Some(1.0), "{summary:?}");
        }
    }
}

/// Without a laser the robot cannot relocalize: it detects the loss, stops and reports the reason.
#[test]
fn lost_robot_without_laser_stops() {
    let faults = vec![Fault::at(4.0, FaultKind::Displaced([1.5, -1.0, 2.0]))];
    let sensors = Sensors { compass: true, laser: false };
    let summary = simulate(&Scenario { sensors, faults, ..Scenario::default() }, 1).1;
    assert_eq!((summary.outcome, summary.stop_reason), (SimulationOutcome::Stopped, Some("lost")));
    assert!(summary.final_speed_m_s <= 0.0, "{summary:?}");
}

/// Scenario from `start` to `goal` in the paper's arena, without a clearance check.
fn between(start: [f64; 3], goal: [f64; 3], options: &[&str]) -> Scenario {
    let keys = [&START_X, &START_Y, &START_HEADING, &GOAL_X, &GOAL_Y, &GOAL_HEADING];
    let values: Vec<_> = keys.into_iter().zip(start.into_iter().chain(goal)).collect();
    let config = Config::default().with_preset("test", &values);
    let config = options.iter().fold(config, |config, option| config.with_option(option).unwrap());
    Scenario { config, ..Scenario::default() }
}

/// Plates and walls, head-on and oblique, with several brakes and periods, forward and in reverse.
#[test]
fn robot_center_stops_before_walls_and_plates() {
    let fast = ["robot.wheel_speed_limit_m_s=1.5", "robot.wheel_acceleration_limit_m_s2=2"];
    let slow_brakes = ["robot.wheel_acceleration_limit_m_s2=0.1"];
    let long_period = ["loop.period_s=0.3"];
    let tail_first = ["law.direction=reverse"];
    for options in [&[][..], &fast, &slow_brakes, &long_period, &tail_first] {
        for (start, goal) in [
            ([0.0, 0.0, 0.0], [4.1, 1.0, 0.0]),
            ([2.5, 0.0, 0.0], [4.0, 1.6, 90.0]),
            ([0.0, 1.2, 180.0], [-1.5, 1.4, 180.0]),
            ([1.2, 0.0, -90.0], [1.2, -1.6, -90.0]),
            ([1.0, 0.2, 30.0], [4.1, 1.6, 0.0]),
        ] {
            let scenario = between(start, goal, options);
            for seed in 1..=3 {
                let (samples, summary) = simulate(&scenario, seed);
                let what = format!("{start:?} to {goal:?} with {options:?}: {summary:?}");
                assert_eq!(
                    (summary.outcome, summary.stop_reason),
                    (SimulationOutcome::Stopped, Some("wall")),
                    "{what}"
                );
                assert!(summary.closest_wall_m > 0.0 && summary.final_speed_m_s <= 0.0, "{what}");
                let places: Vec<_> = samples.iter().map(|s| Point::new(s.x_m, s.y_m)).collect();
                let met = places.windows(2).find_map(|way| scenario.arena.first_wall_crossed(way[0], way[1]));
                assert_eq!(met, None, "{what}");
                let limit = scenario.config.limits().wheel_acceleration;
                assert!(summary.wheel_acceleration_max_m_s2 <= limit + 1e-9, "{what}");
            }
        }
    }
}

/// A wall beside the path, or behind a goal with the required clearance, does not stop the robot.
#[test]
fn goals_with_required_clearance_are_reached() {
    for (start, goal) in [
        ([0.0, 0.0, 0.0], [3.21, 1.0, 0.0]),
        ([0.0, 0.0, 0.0], [4.11, 4.11, 45.0]),
        ([-1.67, -1.67, -135.0], [1.0, 1.0, 0.0]),
        ([0.2, -1.6, 0.0], [3.0, -1.6, 0.0]),
    ] {
        let scenario = between(start, goal, &[]);
        assert_eq!(scenario.check_clearance(), Ok(()));
        for seed in 1..=3 {
            assert_parked(&simulate(&scenario, seed).1, &format!("{start:?} to {goal:?}"));
        }
    }
}

#[test]
fn start_and_goal_clearance_and_blocking_walls_are_checked() {
    let origin = [0.0; 3];
    let (invalid_start, invalid_goal) = (Some(ScenarioEnd::Start), Some(ScenarioEnd::Goal));
    // The circle around the wheels has a radius of 0.32 m.
    for (start, goal, invalid) in [
        (origin, [2.0, 2.0, 30.0], None),
        (origin, [3.6, 1.0, 0.0], invalid_goal),
        (origin, [3.24, 1.0, 0.0], invalid_goal),
        (origin, [3.22, 1.0, 0.0], None),
        (origin, [-3.0, 0.0, 0.0], invalid_goal),
        ([3.6, 1.0, 0.0], origin, invalid_start),
        ([-1.0, 1.0, 0.0], origin, invalid_start),
        ([-1.69, 0.0, 0.0], origin, invalid_start),
        ([-1.67, 0.0, 0.0], origin, None),
    ] {
        let found = between(start, goal, &[]).check_clearance().err().map(|problem| problem.end);
        assert_eq!(found, invalid, "{start:?} to {goal:?}");
    }
    let point = ["robot.footprint_radius_m=0"];
    assert_eq!(between(origin, [3.54, 1.0, 0.0], &point).check_clearance(), Ok(()));
    assert!(between(origin, [3.56, 1.0, 0.0], &point).check_clearance().is_err());
    assert!(between(origin, [4.1, 1.0, 0.0], &[]).wall_on_straight_path().is_some());
    assert!(Scenario::default().wall_on_straight_path().is_none());
    let in_the_loop = Config::default().with_option("scenario.arena=loop").unwrap();
    assert_eq!(Scenario::configured(in_the_loop).check_clearance(), Ok(()));
}

/// Distance from a polygonal footprint at the true pose to the nearest wall \[m].
fn least_clearance(scenario: &Scenario, samples: &[Sample]) -> f64 {
    let (collision, walls) = (scenario.config.collision(None), walls_from_segments(scenario.arena.walls()));
    let at = |sample: &Sample| {
        let pose = Pose::new(sample.x_m, sample.y_m, Angle::from_degrees(sample.heading_deg));
        collision.distance_to_walls(pose, &walls).unwrap()
    };
    samples.iter().map(at).fold(f64::INFINITY, f64::min)
}

/// A long robot beside a wall never touches it: it stops, or arrives where it has room to turn.
#[test]
fn long_robot_beside_a_wall_never_touches_it() {
    let long = "robot.footprint_m=[[0.7, 0.32], [-0.1, 0.32], [-0.1, -0.32], [0.7, -0.32]]";
    for (start, goal, outcome) in [
        // Along the wall y = −2, then with a turn of the front into it, then in free space.
        ([0.2, -1.6, 0.0], [2.2, -1.6, 0.0], SimulationOutcome::Reached),
        ([-0.5, -1.5, -8.0], [-1.2, -1.5, 180.0], SimulationOutcome::Stopped),
        ([0.0, 0.0, 0.0], [2.0, 2.0, 30.0], SimulationOutcome::Reached),
    ] {
        let scenario = between(start, goal, &[long, "law.direction=forward"]);
        assert_eq!(scenario.check_clearance(), Ok(()), "{start:?} to {goal:?}");
        for seed in 1..=3 {
            let (samples, summary) = simulate(&scenario, seed);
            let clearance = least_clearance(&scenario, &samples);
            assert!(clearance > 0.0, "{start:?} to {goal:?}: {clearance} m");
            assert_eq!(summary.outcome, outcome, "{start:?} to {goal:?}: {summary:?}");
        }
    }
}

/// The outcome depends on the true pose, not on the belief.
#[test]
fn goal_reached_only_by_belief_is_missed() {
    let blind = Scenario { sensors: Sensors::NONE, ..Scenario::default() };
    let ends: Vec<SimulationSummary> = (1..=20).map(|seed| simulate(&blind, seed).1).collect();
    for end in &ends {
        let there = end.final_position_error_m <= 0.01 && end.final_heading_error_deg <= 1.0;
        let expected = if there { SimulationOutcome::Reached } else { SimulationOutcome::Missed };
        assert_eq!(end.outcome, expected, "{end:?}");
    }
    assert!(ends.iter().any(|end| end.outcome == SimulationOutcome::Missed));
}

#[test]
fn timeout_is_reported() {
    let config = Config::default().with_option("scenario.timeout_s=2").unwrap();
    let summary = simulate(&Scenario { config, ..Scenario::default() }, 1).1;
    assert_eq!(summary.outcome, SimulationOutcome::Timeout);
}

/// Scripts use these keys.
#[test]
fn json_has_the_documented_keys() {
    let json = serde_json::to_value(simulate(&Scenario::default(), 1).1).unwrap();
    for key in [
        "outcome",
        "time_s",
        "final_position_error_m",
        "final_heading_error_deg",
        "final_speed_m_s",
        "position_rmse_m",
        "heading_rmse_deg",
        "nees_mean",
        "path_length_m",
        "optimal_time_s",
        "seed",
    ] {
        assert!(json.get(key).is_some(), "{key}");
    }
    assert_eq!(json["outcome"], "reached");
}
