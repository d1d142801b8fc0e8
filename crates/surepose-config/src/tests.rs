use std::path::Path;

use surepose::param::{self, Kind};
use surepose::safety::Footprint;

use super::{Config, ConfigError, Value, ValueSource};

fn read(text: &str) -> Result<Config, ConfigError> {
    Config::default().with_text(Path::new("robot.toml"), text.as_bytes())
}

/// `problem | help` of each problem of the text.
fn complaints(text: &str) -> Vec<String> {
    let error = read(text).expect_err("the text is wrong");
    error.problems.iter().map(|p| format!("{p} | {}", p.help.as_deref().unwrap_or(""))).collect()
}

#[test]
fn every_value_has_its_origin() {
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
fn wheel_radii_match_mean_and_ratio() {
    let radius = |text: &str| read(text).expect("right").drive().radius;
    let apart = radius("[robot]\nwheel_radius_m = 0.06\nwheel_radius_ratio = 1.04\n");
    assert!((0.5 * (apart.right + apart.left) - 0.06).abs() < 1e-15, "{apart:?}");
    assert!((apart.right / apart.left - 1.04).abs() < 1e-15, "{apart:?}");
    assert_eq!(radius("[robot]\nwheel_radius_m = 0.07\n"), surepose::kinematics::WheelPair::new(0.07, 0.07));
}

#[test]
fn wrong_unit_suffix_is_converted() {
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
            "robot.toml:5: unknown key `track` in [robot] | the key is `track_m`, with the value in m",
        ]
    );
}

/// Every derived value of the table has a value in the default configuration.
#[test]
fn derived_defaults_are_within_their_bounds() {
    for setting in Config::default().settings() {
        if let (Kind::Number { default: None, range }, Value::Number(value)) =
            (setting.parameter.kind, &setting.value)
        {
            assert!(range.contains(*value), "{}: {value}", setting.parameter.key);
        }
    }
}

#[test]
fn set_gains_disable_even_braking() {
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
        // With this limit, the gains never exceed what the wheels can do.
        &["robot.wheel_acceleration_limit_m_s2=1000"],
    ] {
        assert!(!brakes(options), "{options:?}");
    }
}

/// The outline is the polygon, else the circle of the configured radius, else a circle around the wheels.
#[test]
fn footprint_is_polygon_radius_or_wheels() {
    let footprint = |text: &str| read(text).expect("right").footprint();
    for (text, radius) in
        [("track_m = 0.36", 0.2), ("footprint_m = []", 0.32), ("footprint_radius_m = 0", 0.0)]
    {
        let Footprint::Circle(found) = footprint(&format!("[robot]\n{text}\n")) else { panic!("{text}") };
        assert!((found - radius).abs() < 1e-12, "{text}: {found}");
    }
    let square = "footprint_m = [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]]";
    for text in [format!("[robot]\n{square}\n"), format!("[robot]\nfootprint_radius_m = 1\n{square}\n")] {
        let Footprint::Polygon(polygon) = footprint(&text) else { panic!("{text}") };
        assert_eq!(polygon.vertices().len(), 4);
    }
    let shell = Config::default().with_option("robot.footprint_m=[[1,1],[-1,1],[0,-1]]").expect("right");
    assert!(matches!(shell.footprint(), Footprint::Polygon(_)));
    for (value, what) in [
        ("[[1, 1], [2, 1], [1, 2]]", "does not contain the middle of the axle"),
        ("[[1, 1], [-1, 1]]", "wrong number of points"),
        ("[[1, 1], [-1, 1], [0, -6]]", "coordinate out of range (got [0, -6])"),
        ("[[1, 1], [-1, 1], [0]]", "expected points of two numbers"),
        ("1", "expected a list of points, got a number"),
    ] {
        let found = complaints(&format!("[robot]\nfootprint_m = {value}\n"));
        assert!(
            found.len() == 1 && found[0].contains(what) && found[0].contains("3 to 8 points"),
            "{found:?}"
        );
    }
}

fn warnings<const N: usize>(options: [&str; N]) -> Vec<String> {
    let put = |config: Config, option: &str| config.with_option(option).expect("valid");
    options.into_iter().fold(Config::default(), put).warnings()
}

#[test]
fn noisy_laser_gives_a_warning() {
    assert_eq!(warnings(["laser.range_std_m=0.1", "laser.bearing_std_deg=1"]), Vec::<String>::new());
    let found = warnings(["laser.range_std_m=0.11", "laser.bearing_std_deg=1.1"]);
    let [range, bearing] = found.as_slice() else { panic!("{found:?}") };
    assert!(range.starts_with("laser.range_std_m: above 0.1 m (got 0.11 m)"), "{range}");
    assert!(bearing.starts_with("laser.bearing_std_deg: above 1 ° (got 1.1 °)"), "{bearing}");
}

#[test]
fn latency_beyond_the_history_gives_a_warning() {
    assert_eq!(warnings(["laser.latency_s=0.9", "filter.history_s=1"]), Vec::<String>::new());
    let found = warnings(["laser.latency_s=1.1", "filter.history_s=1"]);
    assert!(
        found.len() == 1 && found[0].contains("laser.latency_s: longer than filter.history_s (got 1.1 s"),
        "{found:?}"
    );
}

#[test]
fn law_of_the_paper_has_its_own_default_capture_radius() {
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
        (&["law.name=paper"], 0.02),
        (&["law.name=paper", "law.capture_radius_m=0.033"], 0.033),
        (&["law.capture_radius_m=0.05"], 0.05),
    ] {
        assert!((radius(options) - expected).abs() < 1e-15, "{options:?}: {}", radius(options));
    }
}

#[test]
fn typos_are_recognized() {
    let found = complaints(
        "[robott]\n[law]\nk_alfa = 3\ntrack_m = 1\nname = \"papper\"\nxyz = 1\n[loop]\nperiod_s = \"0.1\"",
    );
    assert_eq!(
        found,
        [
            "robot.toml:1: unknown section [robott] | did you mean [robot]?",
            "robot.toml:3: unknown key `k_alfa` in [law] | did you mean `k_alpha`?",
            "robot.toml:4: unknown key `track_m` in [law] | `track_m` belongs to [robot]",
            "robot.toml:5: `name`: unknown option \"papper\" | did you mean \"paper\"? The options are \"surepose\", \"paper\"",
            "robot.toml:6: unknown key `xyz` in [law] | the keys of [law] are name, k_v, k_alpha, h, k_theta, braking, \
             capture_radius_m, position_noise_m, direction",
            "robot.toml:8: `period_s`: expected a number, got text; leave out the quotes | write a number in \
             [0.001, 1] s",
        ]
    );
}

#[test]
fn invalid_values_are_rejected_with_the_reason() {
    let found = complaints(
        "[robot]\ntrack_m = 0\n[compass]\nstd_deg = -0.1\n[law]\nk_v = nan\nh = inf\nk_theta = 1e400\n\
         [laser]\nbeams = 180.5\nrange_std_m = true",
    );
    let expected = [
        ("robot.toml:2: `track_m`: out of range (got 0 m)", "a wheel separation below 1 cm"),
        ("robot.toml:4: `std_deg`: negative value (got -0.1 °)", "a standard deviation is positive"),
        ("robot.toml:6: `k_v`: not a number", "positive gains"),
        ("robot.toml:7: `h`: not finite (got inf)", "positive gains"),
        ("robot.toml:8: `k_theta`: not finite (got inf)", "positive gains"),
        ("robot.toml:10: `beams`: expected an integer, got 180.5", "[2, 4096]"),
        ("robot.toml:11: `range_std_m`: expected a number, got a Boolean", "write a number in (0, 10] m"),
    ];
    assert_eq!(found.len(), expected.len(), "{found:#?}");
    for (found, (what, help)) in found.iter().zip(expected) {
        assert!(found.starts_with(what) && found.contains(help), "{found}");
    }
}

#[test]
fn malformed_text_is_an_error_with_its_line() {
    let not_toml = read("[robot]\ntrack_m = = 2\n").expect_err("not TOML");
    assert_eq!(not_toml.problems.len(), 1, "{not_toml:?}");
    assert!(not_toml.problems[0].to_string().starts_with("robot.toml:2: invalid TOML:"), "{not_toml:?}");
    let bytes = b"[robot]\n# caf\xe9\n";
    let not_text = Config::default().with_text(Path::new("x"), bytes).expect_err("not UTF-8");
    assert_eq!(not_text.problems[0].to_string(), "x:2: not UTF-8 text");
    let absent = Config::default().with_file(Path::new("no/such/file.toml")).expect_err("absent");
    assert!(absent.problems[0].to_string().starts_with("no/such/file.toml: cannot be read:"));
    for option in ["", "=", "law.k_v", "law.k_v=", "law.k_v=1\nlaw.h=2", "k_v=-1", "🦀=1", "[robot]"] {
        assert!(Config::default().with_option(option).is_err(), "{option:?}");
    }
}

#[test]
fn bare_decimal_point_gives_one_problem_with_its_remedy() {
    for (written, remedy) in [(".5", "0.5"), ("-.5", "-0.5"), ("5.", "5"), (".5e-1", "0.05")] {
        let found = complaints(&format!("[law]\nh = 1\nk_v = {written} # fast\n"));
        let [found] = found.as_slice() else { panic!("{written}: {found:#?}") };
        assert!(found.starts_with("robot.toml:3: invalid TOML: "), "{found}");
        assert!(
            found.ends_with(&format!("a decimal point needs digits on both sides: write {remedy}")),
            "{found}"
        );
    }
    let shell = Config::default().with_option("law.k_v=.5").expect("options accept .5");
    assert!((shell.number(&param::K_V) - 0.5).abs() < 1e-15);
}

#[test]
fn deep_or_huge_text_is_rejected() {
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
