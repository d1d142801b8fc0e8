//! `surepose map` and `surepose replay carmen`: JSON keys, files and malformed input.

#![allow(clippy::expect_used, reason = "a failed precondition fails the test")]

mod common;

use common::{file, folder, surepose};

/// Writes an occupancy grid of a 4 × 3 m room with 5 cm cells.
fn room(folder: &std::path::Path) -> String {
    let (width, height) = (100, 80);
    let wall = |x: usize, y: usize| {
        let (inside_x, inside_y) = ((10..=90).contains(&x), (10..=70).contains(&y));
        inside_x && inside_y && (x == 10 || x == 90 || y == 10 || y == 70)
    };
    let mut image = format!("P5\n{width} {height}\n255\n").into_bytes();
    image.extend((0..height).flat_map(|y| (0..width).map(move |x| if wall(x, y) { 0 } else { 254 })));
    file(folder, "room.pgm", &image);
    let text = "image: room.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n\
                free_thresh: 0.196\n";
    file(folder, "room.yaml", text.as_bytes())
}

#[test]
fn walls_of_a_room_round_trip() {
    let folder = folder("map-room");
    let grid = room(&folder);
    let out = folder.join("walls.toml");
    let out = out.to_str().expect("UTF-8");
    let made = surepose(&["map", "from-grid", &grid, "--out", out, "--json"]);
    assert_eq!(made.code, 0, "{}", made.stderr);
    let json = made.json();
    assert!(json["walls"].as_u64().is_some_and(|walls| walls >= 4), "{json}");
    assert!(json["length_m"].as_f64().is_some_and(|length| length > 13.0), "{json}");
    assert!(json["residual_rms_m"].as_f64().is_some_and(|residual| residual < 0.05), "{json}");
    assert!(folder.join("walls.svg").exists() && folder.join("walls.png").exists());

    let shown = surepose(&["map", "show", out, "--json"]).json();
    assert_eq!(shown["walls"], json["walls"]);
    assert!(shown["residual_rms_m"].is_null(), "a wall map has no residual: {shown}");
}

/// A path of another computer: the image of the same name beside the YAML file is read. If it is nowhere, both are named.
#[test]
fn stale_image_paths_fall_back_to_the_same_directory() {
    let folder = folder("map-stale");
    let grid = room(&folder);
    let out = folder.join("walls.toml");
    let made = || surepose(&["map", "from-grid", &grid, "--out", out.to_str().expect("UTF-8"), "--json"]);
    let whole = made().json();
    let text = std::fs::read_to_string(&grid).expect("there");
    for stale in ["/home/ann/maps/room.pgm", "C:\\maps\\room.pgm", "../maps/room.pgm"] {
        file(&folder, "room.yaml", text.replace("room.pgm", stale).as_bytes());
        let read = made();
        assert_eq!(read.json(), whole, "{stale}");
        assert!(read.stderr.contains(stale) && read.stderr.contains("reading "), "{}", read.stderr);
    }
    file(&folder, "room.yaml", text.replace("room.pgm", "/home/ann/maps/hall.pgm").as_bytes());
    std::fs::remove_file(folder.join("room.pgm")).expect("removed");
    let missing = made();
    assert_eq!(missing.code, 3);
    for part in ["got /home/ann/maps/hall.pgm", "map-stale/hall.pgm", "room.yaml"] {
        assert!(missing.stderr.contains(part), "{part} in {}", missing.stderr);
    }
}

/// Thresholds that fit no pixel, and colors that are swapped, are warned of with the remedy.
#[test]
fn maps_with_little_on_them_are_warned_of() {
    let folder = folder("map-sparse");
    let grid = room(&folder);
    let out = folder.join("walls.toml");
    let text = std::fs::read_to_string(&grid).expect("there");
    for (from, to, warned) in [
        ("negate: 0", "negate: 0", None),
        ("negate: 0", "negate: 1", Some("% of the known cells are occupied")),
        ("free_thresh: 0.196", "free_thresh: 0.001", Some("no cell is free")),
        ("negate: 0", "mode: raw\nnegate: 0", Some("no cell is occupied (")),
    ] {
        assert!(text.contains(from));
        file(&folder, "room.yaml", text.replace(from, to).as_bytes());
        let made = surepose(&["map", "from-grid", &grid, "--out", out.to_str().expect("UTF-8"), "--json"]);
        match warned {
            None => assert!(!made.stderr.contains("warning"), "{}", made.stderr),
            Some(problem) => {
                for part in [problem, "check occupied_thresh, free_thresh, negate and mode"] {
                    assert!(made.stderr.contains(part), "{part} in {}", made.stderr);
                }
            }
        }
    }
}

/// If the YAML file names an absent image, the image with the name of the YAML file is read, with a warning.
#[test]
fn renamed_image_is_read_with_a_warning() {
    let folder = folder("map-renamed");
    let grid = room(&folder);
    let out = folder.join("walls.toml");
    let made = || surepose(&["map", "from-grid", &grid, "--out", out.to_str().expect("UTF-8"), "--json"]);
    let whole = made();
    assert!(whole.code == 0 && !whole.stderr.contains("warning"), "{}", whole.stderr);
    let text = std::fs::read_to_string(&grid).expect("there");
    file(&folder, "room.yaml", text.replace("room.pgm", "hall.pgm").as_bytes());
    let renamed = made();
    assert_eq!(renamed.json(), whole.json());
    for name in ["hall.pgm)", "room.pgm instead"] {
        assert!(renamed.stderr.contains(name), "{name} in {}", renamed.stderr);
    }
}

/// The map is written completely or not at all, and a link remains a link.
#[cfg(unix)]
#[test]
fn map_is_written_completely_through_a_link() {
    let folder = folder("map-whole");
    let grid = room(&folder);
    let [walls, link, part] = ["walls.toml", "link.toml", "walls.toml.part"].map(|name| folder.join(name));
    std::fs::write(&walls, "before").expect("written");
    std::os::unix::fs::symlink("walls.toml", &link).expect("made");
    let made = || surepose(&["map", "from-grid", &grid, "--out", link.to_str().expect("UTF-8")]).code;
    // A directory blocks the temporary name.
    std::fs::create_dir(&part).expect("made");
    assert_eq!(made(), 2);
    assert_eq!(std::fs::read_to_string(&walls).expect("kept"), "before");
    std::fs::remove_dir(&part).expect("removed");
    assert_eq!(made(), 0);
    assert!(link.is_symlink() && std::fs::read_to_string(&walls).expect("written").contains("[[wall]]"));
}

/// An input file is never overwritten, under whatever path.
#[test]
fn inputs_are_not_overwritten() {
    let folder = folder("map-over-input");
    let grid = room(&folder);
    let log = file(&folder, "drive.log", b"FLASER 2 1.0 1.0 0 0 0 0 0 0 1 host 1\n");
    let other = folder.join(".").join("..").join("map-over-input");
    let at = |name: &str| other.join(name).to_str().expect("UTF-8").to_owned();
    // A grid whose image has the name of the plot.
    let image = std::fs::read(folder.join("room.pgm")).expect("there");
    file(&folder, "hall.png", &image);
    let text = std::fs::read_to_string(&grid).expect("there").replace("room.pgm", "hall.png");
    let hall = file(&folder, "rooms.yaml", text.as_bytes());
    for (arguments, input) in [
        (["map", "from-log", "carmen", &log, "--out", &at("drive.log")].as_slice(), "drive.log"),
        (&["map", "from-grid", &grid, "--out", &at("room.yaml")], "room.yaml"),
        (&["map", "from-grid", &grid, "--out", &at("room.pgm")], "room.pgm"),
        (&["map", "from-grid", &hall, "--out", &at("hall.toml")], "hall.png"),
    ] {
        let before = std::fs::read(folder.join(input)).expect("there");
        let run = surepose(arguments);
        assert_eq!(run.code, 2, "{arguments:?}: {}", run.stderr);
        let said = run.stderr.replace("\n  │ ", " ");
        assert!(said.contains("would be overwritten") && said.contains("give --out another name"), "{said}");
        assert_eq!(std::fs::read(folder.join(input)).expect("there"), before, "{arguments:?}");
    }
    // With the plot in another directory there is no conflict.
    let run = surepose(&["map", "from-grid", &hall, "--out", &at("hall.toml"), "--picture", &at("pictures")]);
    assert_eq!(run.code, 0, "{}", run.stderr);
}

/// The plot would overwrite a map with its file extension.
#[test]
fn map_must_not_have_the_extension_of_its_plot() {
    let folder = folder("map-as-picture");
    let grid = room(&folder);
    for name in ["walls.png", "walls.SVG"] {
        let out = folder.join(name);
        let run = surepose(&["map", "from-grid", &grid, "--out", out.to_str().expect("UTF-8")]);
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(run.stderr.contains("a name that ends in .toml"), "{}", run.stderr);
        assert!(!out.exists());
    }
}

/// A map without walls is a negative outcome.
#[test]
fn grid_without_walls_exits_with_1() {
    let folder = folder("map-empty");
    let image = [b"P5\n20 20\n255\n".to_vec(), vec![254; 400]].concat();
    let grid = room(&folder);
    file(&folder, "room.pgm", &image);
    let out = folder.join("walls.toml");
    let run = surepose(&["map", "from-grid", &grid, "--out", out.to_str().expect("UTF-8")]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("no wall was found") && !run.stderr.contains("-0.0"), "{}", run.stderr);
}

/// The remedy names a file, not a directory.
#[test]
fn map_is_not_written_to_a_directory() {
    let folder = folder("map-over-folder");
    let grid = room(&folder);
    let run = surepose(&["map", "from-grid", &grid, "--out", folder.to_str().expect("UTF-8")]);
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert!(run.stderr.contains("give --out the name of a file"), "{}", run.stderr);
}

#[test]
fn plot_shows_the_grid_beneath_the_walls() {
    let folder = folder("map-picture");
    let grid = room(&folder);
    let at = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    let (map, pictures, plain) = (at("walls.toml"), at("pictures"), at("plain"));
    let made = surepose(&["map", "from-grid", &grid, "--out", &map, "--picture", &pictures]);
    assert_eq!(made.code, 0, "{}", made.stderr);
    assert!(!folder.join("walls.svg").exists(), "the plot goes to --picture");
    let svg = |folder: &str| {
        std::fs::read_to_string(std::path::Path::new(folder).join("walls.svg")).expect("written")
    };
    let made = svg(&pictures);
    for label in ["walls", "occupied", "unknown", "x [m]", "y [m]"] {
        assert!(made.contains(label), "no {label}");
    }
    // The 276 occupied cells are drawn as four walls.
    assert!(made.len() < 20_000, "{} bytes", made.len());

    let shown = surepose(&["map", "show", &map, "--grid", &grid, "--out", &pictures]);
    assert_eq!(shown.code, 0, "{}", shown.stderr);
    assert_eq!(svg(&pictures), made, "the same map on the same grid");
    surepose(&["map", "show", &map, "--out", &plain]);
    assert!(!svg(&plain).contains("occupied"));
    assert_eq!(surepose(&["map", "show", &map, "--grid", &grid]).code, 2, "--grid requires --out");
    assert_eq!(surepose(&["map", "show", &map, "--grid", "no.yaml", "--out", &plain]).code, 3);
}

#[test]
fn malformed_maps_and_logs_exit_with_3() {
    let folder = folder("map-damage");
    let grid = room(&folder);
    let cut = file(&folder, "cut.yaml", b"image: room.pgm\nresolution: -1\n");
    let walls = file(&folder, "walls.toml", b"[[wall]]\nfrom = [0, 0]\nto = [nan, 1]\n");
    let log = file(&folder, "damaged.log", b"FLASER 2 1.0\n");
    let out = folder.join("out.toml");
    let out = out.to_str().expect("UTF-8");
    for arguments in [
        &["map", "from-grid", &cut, "--out", out][..],
        &["map", "from-grid", "no/such/grid.yaml", "--out", out],
        &["map", "from-log", "carmen", &log, "--out", out],
        &["map", "show", &walls],
        &["replay", "carmen", &log],
        &["replay", "carmen", "no/such.log"],
    ] {
        let run = surepose(arguments);
        assert_eq!(run.code, 3, "{arguments:?}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{arguments:?}");
    }
    assert!(surepose(&["replay", "carmen", &log]).stderr.contains(&format!("{log}:1")));
    assert_eq!(surepose(&["replay", "mrclam", ".", "--map", &walls]).code, 2);
    assert_eq!(surepose(&["map", "from-grid", &grid]).code, 2, "--out is required");
}
