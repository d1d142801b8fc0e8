//! `surepose ros2`: errors before the node joins a network. Driving is tested in `surepose-ros2`.

mod common;

use std::process::Command;

use common::{file, folder, surepose};

#[test]
fn invalid_options_are_usage_errors_with_a_remedy() {
    let cases: [(&[&str], &str); 12] = [
        (&["ros2", "--start", "0,0,0"], "give --map"),
        (&["ros2", "--remap", "odom"], "write odom:=/base/odom"),
        (&["ros2", "--remap", "odo:=x"], "expected one of odom, scan"),
        (&["ros2", "--namespace", "1 2"], "invalid name"),
        (&["ros2", "--set", "law.k_v=-1"], "k_v"),
        (&["ros2", "--seed", "3"], "--simulate"),
        (&["ros2", "--ros-args", "-r", "odom"], "FROM:=TO"),
        (&["ros2", "--ros-args", "-p", "law.k_v:=-1", "--", "--simulate"], "k_v"),
        (&["ros2", "--ros-args", "-r", "__node:=a/b"], "no slash"),
        (&["ros2", "--map-frame", ""], "expected letters, digits"),
        (&["ros2", "--map-frame", "a b"], "expected letters, digits"),
        (&["ros2", "--map-frame", "/map"], "no / at the beginning"),
    ];
    for (arguments, remedy) in cases {
        let run = surepose(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
        assert!(run.stderr.replace("\n  │ ", " ").contains(remedy), "{arguments:?}: {}", run.stderr);
    }
}

#[test]
fn unreadable_map_exits_with_3_and_its_line() {
    let map = file(&folder("ros2-map"), "walls.toml", b"[[wall]]\nfrom_m = [0, 0]\n");
    for (path, said) in [("nowhere.toml", "nowhere.toml"), (&map, "walls.toml:1")] {
        let run = surepose(&["ros2", "--map", path]);
        assert_eq!(run.code, 3, "{}", run.stderr);
        assert!(run.stderr.contains(said), "{}", run.stderr);
    }
}

#[test]
fn invalid_environment_variable_is_named() {
    for (variable, value) in [("ROS_DOMAIN_ID", "1000"), ("ROS_AUTOMATIC_DISCOVERY_RANGE", "MARS")] {
        let output = Command::new(env!("CARGO_BIN_EXE_surepose"))
            .args(["ros2", "--simulate"])
            .env(variable, value)
            .env("NO_COLOR", "1")
            .output()
            .expect("the program starts");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains(variable) && stderr.contains(value), "{stderr}");
    }
}
