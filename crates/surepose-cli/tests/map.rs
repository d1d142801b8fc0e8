//! `surepose map` and `surepose replay carmen`: keys, files, damage.

#![allow(clippy::expect_used, reason = "a test stops where its footing is gone")]

mod common;

use common::{file, folder, surepose};

/// A room of 4 × 3 m as an occupancy grid of 5 cm.
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
fn the_walls_of_a_room_are_found_written_and_read_again() {
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
    assert!(shown["residual_rms_m"].is_null(), "a map alone has no residual: {shown}");
}

/// Two files that were renamed together: the name inside is stale, and whoever did not rename them has the wrong image.
#[test]
fn an_image_of_another_name_is_read_and_named() {
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
    for name in ["hall.pgm: ", "room.pgm is read instead"] {
        assert!(renamed.stderr.contains(name), "{name} in {}", renamed.stderr);
    }
}

/// A file that the user names is whole or as before, and a link to it stays one.
#[cfg(unix)]
#[test]
fn a_map_is_written_whole_and_where_its_name_leads_to() {
    let folder = folder("map-whole");
    let grid = room(&folder);
    let [walls, link, part] = ["walls.toml", "link.toml", "walls.toml.part"].map(|name| folder.join(name));
    std::fs::write(&walls, "before").expect("written");
    std::os::unix::fs::symlink("walls.toml", &link).expect("made");
    let made = || surepose(&["map", "from-grid", &grid, "--out", link.to_str().expect("UTF-8")]).code;
    // Its beginning cannot be written where a folder has that name.
    std::fs::create_dir(&part).expect("made");
    assert_eq!(made(), 2);
    assert_eq!(std::fs::read_to_string(&walls).expect("kept"), "before");
    std::fs::remove_dir(&part).expect("removed");
    assert_eq!(made(), 0);
    assert!(link.is_symlink() && std::fs::read_to_string(&walls).expect("written").contains("[[wall]]"));
}

/// A recording of hours is not lost to a slip of the hand, whatever name it goes by.
#[test]
fn what_is_read_is_not_written_over() {
    let folder = folder("map-over-input");
    let grid = room(&folder);
    let log = file(&folder, "drive.log", b"FLASER 2 1.0 1.0 0 0 0 0 0 0 1 host 1\n");
    let other = folder.join(".").join("..").join("map-over-input");
    let at = |name: &str| other.join(name).to_str().expect("UTF-8").to_owned();
    // A grid that a picture would take the name of.
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
    // With the picture elsewhere there is nothing in the way.
    let run = surepose(&["map", "from-grid", &hall, "--out", &at("hall.toml"), "--picture", &at("pictures")]);
    assert_eq!(run.code, 0, "{}", run.stderr);
}

/// Its picture would take the name away from it.
#[test]
fn a_map_is_not_called_as_its_picture() {
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

/// A map of nothing helps nobody: it is an answer, and a negative one.
#[test]
fn a_grid_without_walls_exits_with_1_and_says_so() {
    let folder = folder("map-empty");
    let image = [b"P5\n20 20\n255\n".to_vec(), vec![254; 400]].concat();
    let grid = room(&folder);
    file(&folder, "room.pgm", &image);
    let out = folder.join("walls.toml");
    let run = surepose(&["map", "from-grid", &grid, "--out", out.to_str().expect("UTF-8")]);
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert!(run.stderr.contains("no wall was found") && !run.stderr.contains("-0.0"), "{}", run.stderr);
}

/// The help fits what was asked for: here a file.
#[test]
fn a_map_is_not_written_over_a_folder() {
    let folder = folder("map-over-folder");
    let grid = room(&folder);
    let run = surepose(&["map", "from-grid", &grid, "--out", folder.to_str().expect("UTF-8")]);
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert!(run.stderr.contains("give --out the name of a file"), "{}", run.stderr);
}

#[test]
fn the_picture_has_the_grid_below_the_walls() {
    let folder = folder("map-picture");
    let grid = room(&folder);
    let at = |name: &str| folder.join(name).to_str().expect("UTF-8").to_owned();
    let (map, pictures, plain) = (at("walls.toml"), at("pictures"), at("plain"));
    let made = surepose(&["map", "from-grid", &grid, "--out", &map, "--picture", &pictures]);
    assert_eq!(made.code, 0, "{}", made.stderr);
    assert!(!folder.join("walls.svg").exists(), "the picture has a folder of its own");
    let svg = |folder: &str| {
        std::fs::read_to_string(std::path::Path::new(folder).join("walls.svg")).expect("written")
    };
    let made = svg(&pictures);
    for label in ["walls", "occupied", "unknown", "x [m]", "y [m]"] {
        assert!(made.contains(label), "no {label}");
    }
    // The room's 276 solid cells are drawn as the four walls that they are.
    assert!(made.len() < 20_000, "{} bytes", made.len());

    let shown = surepose(&["map", "show", &map, "--grid", &grid, "--out", &pictures]);
    assert_eq!(shown.code, 0, "{}", shown.stderr);
    assert_eq!(svg(&pictures), made, "the same map on the same grid");
    surepose(&["map", "show", &map, "--out", &plain]);
    assert!(!svg(&plain).contains("occupied"));
    assert_eq!(surepose(&["map", "show", &map, "--grid", &grid]).code, 2, "a picture needs a place to go");
    assert_eq!(surepose(&["map", "show", &map, "--grid", "no.yaml", "--out", &plain]).code, 3);
}

#[test]
fn damaged_maps_and_logs_exit_with_3() {
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
    assert_eq!(surepose(&["map", "from-grid", &grid]).code, 2, "a map needs a place to go");
}
