use std::path::Path;

use proptest::prelude::*;

use crate::image::Image;

use super::{MapMetadata, MapMode, parse};

const YAML: &str = "\
image: depot.pgm
mode: trinary
resolution: 0.05
origin: [-10.0, 2, 0.5]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.25
";

fn description(text: &str) -> Result<MapMetadata, String> {
    parse(Path::new("map.yaml"), text.as_bytes()).map_err(|error| error.to_string())
}

fn with(from: &str, to: &str) -> Result<MapMetadata, String> {
    assert!(YAML.contains(from));
    description(&YAML.replacen(from, to, 1))
}

/// Returns the occupancy of pixels from black to white, read with `mode` and `negate`.
fn occupancy(mode: MapMode, negate: bool) -> Vec<Option<f32>> {
    let description = MapMetadata { negate, mode, ..description(YAML).unwrap() };
    let pixels = vec![0, 51, 100, 128, 204, 255];
    description.grid(&Image { width: 6, height: 1, white: 255, pixels, alpha: vec![] }).cells
}

#[test]
fn metadata_is_parsed() {
    let description = description(YAML).unwrap();
    assert_eq!(description.image, Path::new("depot.pgm"));
    let origin = description.origin;
    assert_eq!((origin.x, origin.y, origin.heading), (-10.0, 2.0, 0.5));
    assert_eq!((description.occupied_threshold, description.free_threshold), (0.65, 0.25));
    assert_eq!((description.negate, description.mode), (false, MapMode::Trinary));
    assert!(with("negate: 0", "negate: 1").unwrap().negate);
    assert!(with("negate: 0", "negate: true").unwrap().negate);
    assert_eq!(with("mode: trinary", "mode: scale").unwrap().mode, MapMode::Scale);
    assert_eq!(with("mode: trinary\n", "").unwrap().mode, MapMode::Trinary);
}

/// YAML allows several notations, and other tools add keys.
#[test]
fn equivalent_notations_give_the_same_metadata() {
    let other = "\
%YAML 1.2
---
# A map.
'image': \"depot.pgm\"
layers: {floor: [1, {z: 2}], tags: [a, [b]]}
origin:
- -10
- 2.0 # in the east
- +5e-1
resolution: '0.05'
negate: False
occupied_thresh: .65
free_thresh: 0.25
...
";
    assert_eq!(description(other).unwrap(), description(YAML).unwrap());
    assert_eq!(description(&YAML.replace('\n', "\r\n")).unwrap(), description(YAML).unwrap());
    let flow = format!("{{{}}}", YAML.trim_end().replace('\n', ", "));
    assert_eq!(description(&flow).unwrap(), description(YAML).unwrap());
}

#[test]
fn bottom_row_of_the_image_is_at_the_origin() {
    let image = Image { width: 2, height: 2, white: 255, pixels: vec![0, 255, 128, 255], alpha: vec![] };
    let grid = description(YAML).unwrap().grid(&image);
    assert_eq!(grid.cells, [None, Some(0.0), Some(1.0), Some(0.0)]);
}

#[test]
fn modes_and_negation_follow_the_map_server() {
    assert_eq!(occupancy(MapMode::Trinary, false), [Some(1.0), Some(1.0), None, None, Some(0.0), Some(0.0)]);
    assert_eq!(occupancy(MapMode::Trinary, true), [Some(0.0), Some(0.0), None, None, Some(1.0), Some(1.0)]);
    let scale = occupancy(MapMode::Scale, false);
    assert_eq!((scale[0], scale[5]), (Some(1.0), Some(0.0)));
    // 1 − 128/255 lies 0.62 of the way from 0.25 to 0.65.
    assert!((scale[3].unwrap() - 0.620_098).abs() < 1e-6);
    assert_eq!(occupancy(MapMode::Raw, false), [Some(0.0), Some(0.51), Some(1.0), None, None, None]);
}

/// Opacity is a fourth channel in the mode `trinary`; in the mode `scale` what is not opaque is unknown.
#[test]
fn transparency_follows_the_map_server() {
    let cells = |mode| {
        let description = MapMetadata { mode, ..description(YAML).unwrap() };
        let (pixels, alpha) = (vec![0, 0, 255, 255], vec![255, 0, 255, 0]);
        description.grid(&Image { width: 4, height: 1, white: 255, pixels, alpha }).cells
    };
    assert_eq!(cells(MapMode::Trinary), [Some(1.0), Some(1.0), Some(0.0), None]);
    assert_eq!(cells(MapMode::Scale), [Some(1.0), None, Some(0.0), None]);
}

#[test]
fn malformed_metadata_names_line_and_problem() {
    let message = |from, to| with(from, to).unwrap_err();
    assert_eq!(
        message("resolution: 0.05", "resolution: -0.05"),
        "map.yaml:3: resolution: out of range (got -0.05, expected 1e-6 to 1e3 m)"
    );
    assert!(
        message("resolution: 0.05", "resolution: .nan")
            .starts_with("map.yaml:3: resolution: out of range (got NaN,")
    );
    assert!(message("resolution: 0.05", "resolution: 1e400").starts_with("map.yaml:3: "));
    assert!(
        message("-10.0, 2, 0.5", "-10.0, .inf, 0.5")
            .starts_with("map.yaml:4: origin y: out of range (got inf,")
    );
    assert!(message("-10.0, 2, 0.5", "-10.0, 2").starts_with("map.yaml:4: "));
    assert!(message("0.65", "1.65").starts_with("map.yaml:6: occupied_thresh: out of range (got 1.65,"));
    assert_eq!(message("0.25", "0.75"), "map.yaml:7: free_thresh: must be below occupied_thresh");
    assert!(
        message("resolution: 0.05", "resolution: 1e300")
            .starts_with("map.yaml:3: resolution: out of range (got 1e300,")
    );
    assert_eq!(
        message("negate: 0", "resolution: 0.1"),
        "map.yaml:5: resolution: duplicate key; keep one of the two lines"
    );
    assert!(message("mode: trinary", "mode: foggy").contains("map.yaml:2: "));
    assert!(message("image: depot.pgm\n", "").contains("image"));
    assert!(message("negate: 0", "negate: maybe").starts_with("map.yaml:5: "));
    assert!(message("resolution: 0.05", "resolution: wide").starts_with("map.yaml:3: "));
    assert_eq!(
        message("mode: trinary", "mode: foggy"),
        "map.yaml:2: mode: invalid (got 'foggy', expected trinary, scale or raw)"
    );
    assert_eq!(
        message("-10.0, 2, 0.5", "-10.0, 2"),
        "map.yaml:4: origin: wrong length (got 2, expected a list of 3 numbers)"
    );
    assert_eq!(
        message("resolution: 0.05", "resolution: inf"),
        "map.yaml:3: resolution: invalid (got 'inf', expected a number)"
    );
    assert_eq!(message("image: depot.pgm", "image:"), "map.yaml:1: image: expected a single value");
    assert_eq!(
        message("free_thresh: 0.25\n", ""),
        "map.yaml: free_thresh: missing key; add a line `free_thresh: …`"
    );
    assert!(message("mode: trinary", "mode: 'trinary").starts_with("map.yaml:"));
    assert!(message("0.25\n", "0.25\n---\nmode: raw\n").starts_with("map.yaml:8: second document"));
    assert!(description("").is_err());
    let keys: Vec<String> = (0..1001).map(|key| format!("key_{key}: 1\n")).collect();
    let keys = keys.concat();
    assert_eq!(description(&keys), Err("map.yaml:1001: too many keys (expected at most 1000)".to_owned()));
    assert!(description(&"[".repeat(100_000)).is_err());
    let binary = parse(Path::new("map.yaml"), b"image: a\n\xff\xfe").unwrap_err();
    assert_eq!(binary.to_string(), "map.yaml:2: not UTF-8 text; check that this is the right file");
}

proptest! {
    #[test]
    fn any_bytes_give_metadata_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..128)) {
        let _ = parse(Path::new("map.yaml"), &bytes);
        let _ = parse(Path::new("map.yaml"), &[YAML.as_bytes(), &bytes].concat());
    }
}
