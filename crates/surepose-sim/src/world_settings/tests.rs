use surepose::param;
use surepose_config::Config;

use crate::fault::{Fault, FaultKind, ScanFault};
use crate::plant::PlantModel;
use crate::robot::Scenario;
use crate::world_parameters::{self as table, world_parameters};

use super::WorldSettings;

fn given(options: &[&str]) -> WorldSettings {
    WorldSettings::from_options(options.iter().copied()).unwrap()
}

fn refused(options: &[&str]) -> (String, String) {
    let error = WorldSettings::from_options(options.iter().copied()).unwrap_err();
    (error.to_string(), error.problems[0].help.clone().unwrap_or_default())
}

/// Every key of the robot's table but these sections describes the world, or is in this list with the reason.
#[test]
fn every_parameter_of_robot_and_sensors_describes_the_world() {
    let known = world_parameters();
    for parameter in param::ALL {
        let expected = match parameter.section {
            // What only the controller, the filter or a recording has.
            "law" | "goal" | "safety" | "loop" | "camera" | "commands" => false,
            // What the filter considers of its own models.
            _ if parameter.meaning.contains("consider") => false,
            // The noise of the wheels is of the world, the other keys of the filter are not.
            "filter" => parameter == &param::DELTA,
            // The simulated robot is a point to its walls.
            "robot" => ![&param::FOOTPRINT_RADIUS, &param::FOOTPRINT].contains(&parameter),
            // What the ROS 2 node knows of its sensors.
            "compass" | "laser" if parameter.key == "mounting" => false,
            "scenario" => parameter == &param::ARENA || parameter.key.starts_with("start_"),
            _ => true,
        };
        let (section, key) = (parameter.section, parameter.key);
        assert_eq!(known.find(section, key).is_some(), expected, "{section}.{key}");
    }
    for own in table::ALL {
        assert!(param::find(own.section, own.key).is_none(), "{}.{} exists twice", own.section, own.key);
        assert!(own.key.ends_with(own.unit.suffix()) && own.meaning.trim().ends_with('.'), "{}", own.key);
    }
}

#[test]
fn wrong_keys_are_named_with_the_nearest_one() {
    for (options, named, help) in [
        (&["robot.track=0.6"][..], "unknown key `track` in [robot]", "`track_m`, with the value in m"),
        (&["robot.trak_m=0.6"], "unknown key `trak_m` in [robot]", "did you mean `track_m`?"),
        (&["moter.model=pid"], "unknown section [moter]", "did you mean [motor]?"),
        (&["robot.command_delay_ms=300"], "unknown key `command_delay_ms` in [robot]", "300 ms is 0.3"),
        (&["law.k_v=3"], "`law.k_v`: not a property of the simulated world", "--set law.k_v"),
        (&["loop.period_s=0.1"], "`loop.period_s`: not a property of the simulated world", "--world help"),
        (&["robot.track_m=9"], "out of range", "[0.01, 5] m"),
        (&["fault.laser=frozn"], "unknown option", "did you mean \"frozen\"?"),
        (&["motor.model"], "expected SECTION.KEY=VALUE", "--world robot.wheel_radius_m=0.05"),
        (
            &["robot.track_m=0.5", "robot.track_m=0.7"],
            "`robot.track_m`: two values (got 0.5 and 0.7)",
            "leave out",
        ),
        (
            &["fault.held_from_s=3"],
            "without effect, because `fault.held_wheels` is none",
            "--world fault.held_wheels",
        ),
    ] {
        let (what, remedy) = refused(options);
        assert!(what.starts_with("--world") && what.contains(named), "{options:?}: {what}");
        assert!(remedy.contains(help), "{options:?}: {remedy}");
    }
    assert_eq!(given(&["robot.track_m=0.5", "robot.track_m=0.50"]).settings().len(), 1);
}

/// A dead band that the robot knows is the world's, too; one that only the world has is not the robot's.
#[test]
fn actuators_of_the_world_follow_the_configuration() {
    let options = ["robot.min_speed_m_s=0.02", "robot.command_delay_s=0.1", "robot.min_turn_rate_deg_s=3"];
    let config = options.iter().fold(Config::default(), |config, option| config.with_option(option).unwrap());
    let both = Scenario { config, ..Scenario::default() };
    let world_only = Scenario { world_settings: given(&options), ..Scenario::default() };
    assert_eq!(both.world(), world_only.world());
    let min_turn_rate = 3f64.to_radians();
    let expected = PlantModel { min_speed: 0.02, command_delay: 0.1, min_turn_rate, ..PlantModel::default() };
    assert_eq!(both.world().plant, expected);
    assert_eq!(world_only.config.actuator(), Config::default().actuator());
}

/// A difference of the world changes the world alone; a setting of the robot changes both.
#[test]
fn world_differs_only_where_told() {
    let told = |option: &str| Config::default().with_option(option).unwrap();
    let usual = Scenario::default();
    let different = Scenario { world_settings: given(&["robot.track_m=0.5"]), ..usual.clone() };
    assert_eq!(different.config, usual.config);
    let mut expected = usual.world();
    expected.drive.wheel_separation = 0.5;
    assert_eq!(different.world(), expected);
    let both = Scenario { config: told("robot.track_m=0.5"), ..usual };
    assert_eq!((both.config.drive(), both.world()), (expected.drive, expected));
}

#[test]
fn limits_of_the_world_are_its_own() {
    let usual = Scenario::default();
    let plant = |options: &[&str]| Scenario { world_settings: given(options), ..usual.clone() }.world().plant;
    assert!(plant(&[]).wheel_acceleration.is_infinite());
    let weak = plant(&["robot.wheel_acceleration_limit_m_s2=0.1", "robot.motor_time_constant_s=0.3"]);
    let expected =
        PlantModel { wheel_acceleration: 0.1, wheel_deceleration: 0.1, lag: 0.3, ..PlantModel::default() };
    assert_eq!(weak, expected);
}

#[test]
fn faults_last_to_the_end_unless_told() {
    let faults = given(&[
        "fault.held_wheels=left",
        "fault.held_from_s=4",
        "fault.laser=frozen",
        "fault.laser_from_s=2",
        "fault.laser_duration_s=1.5",
    ])
    .faults();
    let held = Fault::from(4.0, FaultKind::WheelsHeld { right: false, left: true });
    assert_eq!(faults, [held, Fault::between(2.0, 3.5, FaultKind::Scan(ScanFault::Frozen))]);
}

#[test]
fn true_start_differs_from_the_believed_one() {
    let scenario = Scenario { world_settings: given(&["scenario.start_x_m=0.2"]), ..Scenario::default() };
    assert!((scenario.true_start().x - 0.2).abs() < 1e-15 && scenario.start().x.abs() < 1e-15);
}
