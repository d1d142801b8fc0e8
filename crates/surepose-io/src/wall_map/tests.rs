use std::path::Path;

use proptest::prelude::*;

use crate::error::DataError;

use super::{MapWall, WallCovariance, WallMap, parse};

const MAP: &str = r#"name = "arena"

[[wall]]
name = "south"
from_m = [0.0, 0]
to_m = [6.0, 0.0]

[[wall]]
from_m = [6.0, 0.0]
to_m = [6.0, 4.0]
covariance = { r_r_m2 = 1e-6, r_psi_m_rad = -1e-8, psi_psi_rad2 = 1e-8 }
"#;

fn map(text: &str) -> Result<WallMap, DataError> {
    parse(Path::new("map.toml"), text.as_bytes())
}

fn message(from: &str, to: &str) -> String {
    assert!(MAP.contains(from));
    map(&MAP.replacen(from, to, 1)).unwrap_err().to_string()
}

#[test]
fn map_is_parsed() {
    let map = map(MAP).unwrap();
    assert_eq!(map.name.as_deref(), Some("arena"));
    let south = MapWall { name: Some("south".into()), from: [0.0; 2], to: [6.0, 0.0], covariance: None };
    assert_eq!(map.walls[0], south);
    let covariance = WallCovariance { r_r: 1e-6, r_psi: -1e-8, psi_psi: 1e-8 };
    assert_eq!(map.walls[1].covariance, Some(covariance));
    assert!((map.walls[1].length() - 4.0).abs() < 1e-15);
}

#[test]
fn map_is_written_as_readable_toml() {
    let wall = |name: &str, to| MapWall { name: Some(name.into()), from: [0.0; 2], to, covariance: None };
    let map = WallMap { name: None, walls: vec![wall("a \"b\"", [1.0, 0.0])] };
    let text = map.to_toml(Path::new("map.toml")).unwrap();
    assert_eq!(text, "[[wall]]\nname = 'a \"b\"'\nfrom_m = [0.0, 0.0]\nto_m = [1.0, 0.0]\n");
}

#[test]
fn malformed_maps_name_line_and_problem() {
    assert!(message("from_m = [0.0, 0]", "from_m = [0.0]").starts_with("map.toml:5: "));
    assert!(
        message("from_m = [0.0, 0]", "from_m = [nan, 0]")
            .starts_with("map.toml:5: from_m: out of range (got [NaN, 0],")
    );
    assert!(
        message("from_m = [0.0, 0]", "from_m = [inf, 0]")
            .starts_with("map.toml:5: from_m: out of range (got [inf, 0],")
    );
    assert!(
        message("from_m = [0.0, 0]", "from_m = [1e300, 0]")
            .starts_with("map.toml:5: from_m: out of range (got [1e300, 0],")
    );
    assert!(
        message("from_m = [0.0, 0]", "from_m = [\n0.0,\n-1e9\n]")
            .starts_with("map.toml:7: from_m: out of range (got [0, -1000000000],")
    );
    assert!(message("to_m = [6.0, 0.0]", "to_m = [0, 0]").starts_with("map.toml:3: wall: shorter than"));
    assert!(message("to_m = [6.0, 0.0]\n", "").contains("missing field `to_m`"));
    assert!(message("from_m = [0.0, 0]", "from = [0.0, 0]").starts_with("map.toml:5: unknown field `from`"));
    assert!(message("[[wall]]\nfrom", "[[wal]]\nfrom").starts_with("map.toml:8: unknown field `wal`"));
    assert!(message("1e-6", "-1e-6").starts_with("map.toml:11: covariance: negative variance"));
    assert!(message("-1e-8", "1e-6").starts_with("map.toml:11: covariance: not positive semi-definite"));
    assert!(message("1e-6", "nan").starts_with("map.toml:11: covariance: out of range (got [NaN"));
    assert!(message("arena\"", "arena").starts_with("map.toml:1: "));
    assert!(map("name = 'empty'\n").unwrap_err().to_string().starts_with("map.toml: no [[wall]] found"));
    assert!(map(&format!("a = {}", "[".repeat(100_000))).is_err());
}

#[test]
fn unreadable_map_is_not_written() {
    let point = MapWall { name: None, from: [1.0; 2], to: [1.0; 2], covariance: None };
    let error = WallMap { name: None, walls: vec![point] }.to_toml(Path::new("out.toml")).unwrap_err();
    assert!(error.to_string().starts_with("out.toml: wall 1: wall: shorter"), "{error}");
}

fn any_wall() -> impl Strategy<Value = MapWall> {
    let covariance = (0.0..1.0_f64, 0.0..1.0_f64, -0.99..0.99_f64).prop_map(|(r, psi, correlation)| {
        WallCovariance { r_r: r * r, r_psi: correlation * r * psi, psi_psi: psi * psi }
    });
    let name = prop::option::of("\\PC{0,12}");
    let (from, step) = (prop::array::uniform2(-1e4..1e4), prop::array::uniform2(0.01..1e3));
    (name, from, step, prop::option::of(covariance)).prop_map(|(name, from, step, covariance)| MapWall {
        name,
        from,
        to: [from[0] + step[0], from[1] + step[1]],
        covariance,
    })
}

proptest! {
    #[test]
    fn written_maps_round_trip(name in prop::option::of("\\PC{0,12}"), walls in prop::collection::vec(any_wall(), 1..6)) {
        let written = WallMap { name, walls };
        let text = written.to_toml(Path::new("map.toml")).unwrap();
        prop_assert_eq!(map(&text).unwrap(), written);
    }

    #[test]
    fn any_bytes_give_a_map_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..128)) {
        let _ = parse(Path::new("map.toml"), &bytes);
        let _ = parse(Path::new("map.toml"), &[MAP.as_bytes(), &bytes].concat());
    }
}
