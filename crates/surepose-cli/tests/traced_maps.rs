//! Drives with maps that were traced from grids: the estimate knows how wrong such a map is.

#![allow(clippy::expect_used, reason = "a failed precondition fails the test")]

mod common;

use std::fmt::Write as _;
use std::path::Path;

use common::{file, folder, surepose};

/// Half the room \[m], which is around the origin of a map of 9 m × 9 m.
const HALF: (f64, f64) = (3.0, 2.0);
const SIDE: f64 = 9.0;

/// A room, tilted in its map.
struct Room {
    tilt: f64,
}

impl Room {
    /// Rotates a point of the room into the map.
    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let (sin, cos) = self.tilt.to_radians().sin_cos();
        (x * cos - y * sin, x * sin + y * cos)
    }

    /// A pose of the room as an argument.
    fn pose(&self, x: f64, y: f64, heading: f64) -> String {
        let (x, y) = self.place((x, y));
        format!("{x},{y},{}", heading + self.tilt)
    }

    /// Corners, clockwise: free space is to the right of each wall.
    fn walls(&self) -> [[(f64, f64); 2]; 4] {
        let (a, b) = HALF;
        let corners = [(a, b), (a, -b), (-a, -b), (-a, b)].map(|corner| self.place(corner));
        [0, 1, 2, 3].map(|k| [corners[k], corners[(k + 1) % 4]])
    }

    /// The true walls as a wall map.
    fn truth(&self, folder: &Path) -> String {
        let mut text = String::new();
        for [from, to] in self.walls() {
            let _ =
                writeln!(text, "[[wall]]\nfrom_m = [{}, {}]\nto_m = [{}, {}]", from.0, from.1, to.0, to.1);
        }
        file(folder, "truth.toml", text.as_bytes())
    }

    /// The room as a mapper leaves it: cells that contain the surface of a wall are occupied.
    fn grid(&self, folder: &Path, resolution: f64, shift: (f64, f64)) -> String {
        let count = (SIDE / resolution) as usize;
        let origin = (-0.5 * SIDE + shift.0 * resolution, -0.5 * SIDE + shift.1 * resolution);
        let (sin, cos) = self.tilt.to_radians().sin_cos();
        let mut cells = vec![205; count * count];
        for (k, cell) in cells.iter_mut().enumerate() {
            let x = ((k % count) as f64 + 0.5) * resolution + origin.0;
            let y = ((count - 1 - k / count) as f64 + 0.5) * resolution + origin.1;
            if (cos * x + sin * y).abs() < HALF.0 && (cos * y - sin * x).abs() < HALF.1 {
                *cell = 254;
            }
        }
        for [from, to] in self.walls() {
            for part in (0..=4000).map(|k| f64::from(k) / 4000.0) {
                let at = |from: f64, to: f64, origin: f64| (from + part * (to - from) - origin) / resolution;
                let (column, row) = (at(from.0, to.0, origin.0), at(from.1, to.1, origin.1));
                cells[(count - 1 - row as usize) * count + column as usize] = 0;
            }
        }
        let mut image = format!("P5\n{count} {count}\n255\n").into_bytes();
        image.extend(cells);
        file(folder, "room.pgm", &image);
        let text = format!(
            "image: room.pgm\nresolution: {resolution}\norigin: [{}, {}, 0]\nnegate: 0\noccupied_thresh: 0.65\n\
             free_thresh: 0.196\n",
            origin.0, origin.1
        );
        file(folder, "room.yaml", text.as_bytes())
    }
}

/// Before walls were considered with their covariance, the NEES was 20 to 2300 with the walls of these grids.
#[test]
fn estimate_on_a_traced_map_is_consistent() {
    let folder = folder("traced-maps");
    let walls = folder.join("walls.toml");
    let walls = walls.to_str().expect("UTF-8");
    for (tilt, resolution, shift) in
        [(0.5, 0.1, (0.3, 0.7)), (0.5, 0.05, (0.3, 0.7)), (3.0, 0.05, (0.1, 0.6)), (45.0, 0.1, (0.3, 0.7))]
    {
        let room = Room { tilt };
        let (truth, grid) = (room.truth(&folder), room.grid(&folder, resolution, shift));
        let traced = surepose(&["map", "from-grid", &grid, "--out", walls, "--json"]);
        assert!(traced.json()["walls"].as_u64().is_some_and(|count| count <= 6), "{}", traced.stdout);
        for map in [walls, &grid] {
            let mut sum = 0.0;
            for seed in ["1", "2", "3"] {
                let (world, start, goal) =
                    (format!("map={truth}"), room.pose(-1.5, -1.0, 0.0), room.pose(1.2, -1.2, 30.0));
                let (start, goal) = (format!("--start={start}"), format!("--goal={goal}"));
                let run = surepose(&[
                    "run", "--map", map, "--world", &world, &start, &goal, "--seed", seed, "--json",
                ]);
                let json = run.json();
                let case = format!("{tilt}°, {resolution} m, {map}, seed {seed}: {json}");
                // At rest where the estimate has the goal; the map may be wrong by more than the tolerance.
                assert!(json["outcome"] == "reached" || json["outcome"] == "missed", "{case}");
                assert!(json["heading_rmse_deg"].as_f64().is_some_and(|heading| heading <= 0.2), "{case}");
                sum += json["nees_mean"].as_f64().expect("a NEES");
            }
            assert!((0.5..=9.0).contains(&(sum / 3.0)), "{tilt}°, {resolution} m, {map}: {}", sum / 3.0);
        }
    }
}
