use std::path::Path;

use surepose::param;

use super::{Config, ConfigError, ValueSource};

fn read(text: &str) -> Result<Config, ConfigError> {
    Config::default().with_text(Path::new("robot.toml"), text.as_bytes())
}

/// `problem | help` of each problem of the text.
fn complaints(text: &str) -> Vec<String> {
    let error = read(text).expect_err("the text is wrong");
    error.problems.iter().map(|p| format!("{p} | {}", p.help.as_deref().unwrap_or(""))).collect()
}

#[test]
fn every_value_knows_where_it_came_from() {
    let text =
        "[robot]\ntrack_m = 0.5\n\n[goal]\nheading_tolerance_deg = 2\n[law]\ndirection = \"reverse\"\n";
    let config = read(text).expect("right").with_option("law.k_v=3.5").expect("right");
    assert!((config.controller().drive.wheel_separation - 0.5).abs() < 1e-15);
    assert!((config.controller().tolerance.heading - 2f64.to_radians()).abs() < 1e-15);
    assert_eq!(config.direction(), surepose::control::Direction::Reverse);
    let line = |line| ValueSource::File { path: "robot.toml".into(), line };
    assert_eq!(config.origin(&param::WHEEL_SEPARATION), line(2));
    assert_eq!(config.origin(&param::HEADING_TOLERANCE), line(5));
    assert_eq!(config.origin(&param::K_V), ValueSource::CommandLine);
    assert_eq!(config.origin(&param::WHEEL_RADIUS), ValueSource::Default);
}

#[test]
fn radii_have_the_mean_and_the_ratio_that_were_set() {
    let radius = |text: &str| read(text).expect("right").drive().radius;
    let apart = radius("[robot]\nwheel_radius_m = 0.06\nwheel_radius_ratio = 1.04\n");
    assert!((0.5 * (apart.right + apart.left) - 0.06).abs() < 1e-15, "{apart:?}");
    assert!((apart.right / apart.left - 1.04).abs() < 1e-15, "{apart:?}");
    assert_eq!(radius("[robot]\nwheel_radius_m = 0.07\n"), surepose::kinematics::WheelPair::new(0.07, 0.07));
}

#[test]
fn a_wrong_unit_is_converted_for_the_user() {
    let found = complaints("[robot]\nwheel_radius_mm = 50\n");
    assert_eq!(
        found,
        [
            "robot.toml:2: unknown key `wheel_radius_mm` in [robot] | the key is `wheel_radius_m`; 50 mm is 0.05"
        ]
    );
    let found = complaints("[compass]\nstd_rad = 0.01\n[robot]\nwheel_speed_limit_km_h = 3.6\ntrack = 0.6");
    assert_eq!(
        found,
        [
            "robot.toml:2: unknown key `std_rad` in [compass] | the key is `std_deg`; 0.01 rad is 0.572957795",
            "robot.toml:4: unknown key `wheel_speed_limit_km_h` in [robot] | the key is \
             `wheel_speed_limit_m_s`; 3.6 km/h is 1",
            "robot.toml:5: unknown key `track` in [robot] | the key is `track_m`, its value in m",
        ]
    );
}

/// Gains that are not set are fitted; the defaults of the table must equal them.
#[test]
fn default_gains_equal_the_fitted_gains() {
    let (default, fitted) = (Config::default(), Config::default().fitted());
    for gain in [&param::K_V, &param::K_ALPHA, &param::H, &param::K_THETA] {
        let (default, fitted) = (default.number(gain), fitted.number(gain));
        assert!((default - fitted).abs() < 1e-12, "{}: {default} and {fitted}", gain.key);
    }
}

#[test]
fn gains_that_are_set_are_meant_and_others_brake_evenly() {
    let brakes = |options: &[&str]| {
        let put = |config: Config, option: &&str| config.with_option(option).expect("valid");
        options.iter().fold(Config::default(), put).braking().is_some()
    };
    for options in [&[][..], &["law.h=1"], &["law.k_v=3", "law.braking=even"], &["law.k_theta=3"]] {
        assert!(brakes(options), "{options:?}");
    }
    for options in [
        &["law.k_v=3"][..],
        &["law.k_alpha=3"],
        &["law.braking=gains"],
        &["law.name=paper"],
        // Even the gains alone ask for less than these wheels can do.
        &["robot.wheel_acceleration_limit_m_s2=1000"],
    ] {
        assert!(!brakes(options), "{options:?}");
    }
}

fn warnings<const N: usize>(options: [&str; N]) -> Vec<String> {
    let put = |config: Config, option: &str| config.with_option(option).expect("valid");
    options.into_iter().fold(Config::default(), put).warnings()
}

#[test]
fn a_laser_that_is_too_noisy_for_walls_is_warned_of() {
    assert_eq!(warnings(["laser.range_std_m=0.1", "laser.bearing_std_deg=1"]), Vec::<String>::new());
    let found = warnings(["laser.range_std_m=0.11", "laser.bearing_std_deg=1.1"]);
    let [range, bearing] = found.as_slice() else { panic!("{found:?}") };
    assert!(range.starts_with("laser.range_std_m is 0.11 m: beyond 0.1 m"), "{range}");
    assert!(bearing.starts_with("laser.bearing_std_deg is 1.1 °: beyond 1 °"), "{bearing}");
}

#[test]
fn a_latency_that_the_history_does_not_reach_is_warned_of() {
    assert_eq!(warnings(["laser.latency_s=0.9", "filter.history_s=1"]), Vec::<String>::new());
    let found = warnings(["laser.latency_s=1.1", "filter.history_s=1"]);
    assert!(found.len() == 1 && found[0].contains("laser.latency_s is 1.1 s"), "{found:?}");
}

#[test]
fn the_papers_law_has_a_capture_radius_of_its_own_unless_one_is_set() {
    let radius = |options: &[&str]| {
        let config = options
            .iter()
            .fold(Config::default(), |config, option| config.with_option(option).expect("valid"));
        let (surepose::control::Law::Hybrid(surepose::control::HybridLaw { capture_radius, .. })
        | surepose::control::Law::Tran2012(surepose::control::Tran2012Law { capture_radius, .. })) =
            config.law();
        assert!((config.fitted().number(&param::CAPTURE_RADIUS) - capture_radius).abs() < 1e-15);
        capture_radius
    };
    for (options, expected) in [
        (&[][..], 0.033),
        (&["law.name=paper"], 0.01),
        (&["law.name=paper", "law.capture_radius_m=0.033"], 0.033),
        (&["law.capture_radius_m=0.05"], 0.05),
    ] {
        assert!((radius(options) - expected).abs() < 1e-15, "{options:?}: {}", radius(options));
    }
}

#[test]
fn slips_are_recognised() {
    let found = complaints(
        "[robott]\n[law]\nk_alfa = 3\ntrack_m = 1\nname = \"papper\"\nxyz = 1\n[loop]\nperiod_s = \"0.1\"",
    );
    assert_eq!(
        found,
        [
            "robot.toml:1: unknown section [robott] | did you mean [robot]?",
            "robot.toml:3: unknown key `k_alfa` in [law] | did you mean `k_alpha`?",
            "robot.toml:4: unknown key `track_m` in [law] | `track_m` belongs under [robot]",
            "robot.toml:5: `name` cannot be \"papper\" | did you mean \"paper\"? The choice is \"surepose\", \"paper\"",
            "robot.toml:6: unknown key `xyz` in [law] | [law] has name, k_v, k_alpha, h, k_theta, braking, \
             capture_radius_m, position_noise_m, direction",
            "robot.toml:8: `period_s` is a number, and this is text; leave out the quotes | write a number in \
             [0.001, 1] s",
        ]
    );
}

#[test]
fn impossible_values_are_refused_with_the_reason() {
    let found = complaints(
        "[robot]\ntrack_m = 0\n[compass]\nstd_deg = -0.1\n[law]\nk_v = nan\nh = inf\nk_theta = 1e400\n\
         [laser]\nbeams = 180.5\nrange_std_m = true",
    );
    let expected = [
        ("robot.toml:2: `track_m` is out of range: 0 m", "wheels less than a centimetre apart"),
        ("robot.toml:4: `std_deg` is negative: -0.1 °", "a standard deviation is positive"),
        ("robot.toml:6: `k_v` is not a number", "positive gains"),
        ("robot.toml:7: `h` is inf, and must be finite", "positive gains"),
        ("robot.toml:8: `k_theta` is inf, and must be finite", "positive gains"),
        ("robot.toml:10: `beams` is a whole number, and this is 180.5", "[2, 4096]"),
        (
            "robot.toml:11: `range_std_m` is a number, and this is true or false",
            "write a number in (0, 10] m",
        ),
    ];
    assert_eq!(found.len(), expected.len(), "{found:#?}");
    for (found, (what, help)) in found.iter().zip(expected) {
        assert!(found.starts_with(what) && found.contains(help), "{found}");
    }
}

#[test]
fn damaged_text_is_an_error_with_its_line() {
    let not_toml = read("[robot]\ntrack_m = = 2\n").expect_err("not TOML");
    assert_eq!(not_toml.problems.len(), 1, "{not_toml:?}");
    assert!(not_toml.problems[0].to_string().starts_with("robot.toml:2: not TOML:"), "{not_toml:?}");
    let bytes = b"[robot]\n# caf\xe9\n";
    let not_text = Config::default().with_text(Path::new("x"), bytes).expect_err("not UTF-8");
    assert_eq!(not_text.problems[0].to_string(), "x:2: is not text in UTF-8");
    let absent = Config::default().with_file(Path::new("no/such/file.toml")).expect_err("absent");
    assert!(absent.problems[0].to_string().starts_with("no/such/file.toml: cannot be read:"));
    for option in ["", "=", "law.k_v", "law.k_v=", "law.k_v=1\nlaw.h=2", "k_v=-1", "🦀=1", "[robot]"] {
        assert!(Config::default().with_option(option).is_err(), "{option:?}");
    }
}

#[test]
fn a_number_without_a_digit_at_its_point_is_one_problem_with_its_cure() {
    for (written, cure) in [(".5", "0.5"), ("-.5", "-0.5"), ("5.", "5"), (".5e-1", "0.05")] {
        let found = complaints(&format!("[law]\nh = 1\nk_v = {written} # fast\n"));
        let [found] = found.as_slice() else { panic!("{written}: {found:#?}") };
        assert!(found.starts_with("robot.toml:3: not TOML: "), "{found}");
        assert!(found.ends_with(&format!("a point stands between two digits: write {cure}")), "{found}");
    }
    let shell = Config::default().with_option("law.k_v=.5").expect("nothing but 0.5 can be meant");
    assert!((shell.number(&param::K_V) - 0.5).abs() < 1e-15);
}

#[test]
fn deep_and_huge_text_is_refused() {
    let deep = format!("[law]\nk_v = {}", "[".repeat(100_000));
    assert!(read(&deep).is_err());
    let huge = vec![b'#'; super::file::MAX_BYTES + 1];
    assert!(Config::default().with_text(Path::new("x"), &huge).is_err());
}

proptest::proptest! {
    #[test]
    fn no_text_panics(text in "([\\[\\]a-z_=.\"0-9\n -]|\\[robot\\]\n|track_m = ){0,60}") {
        let _ = read(&text);
    }
}
