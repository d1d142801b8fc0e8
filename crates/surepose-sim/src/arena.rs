//! Arenas: flat walls and plates as segments in the map frame.

use surepose::control::{InvalidPath, Path};
use surepose::geometry::{Angle, Map, Point, Pose};
use surepose::map::Wall;
use surepose::param::{ArenaName, Choice};
use surepose_io::wall_map::{MapWall, WallMap};

/// A flat wall segment, visible from both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSegment {
    /// First end point \[m].
    pub start: Point<Map, f64>,
    /// Second end point \[m].
    pub end: Point<Map, f64>,
}

impl WallSegment {
    /// Creates the segment between two points (x, y) \[m].
    pub fn between(start: (f64, f64), end: (f64, f64)) -> Self {
        Self { start: Point::new(start.0, start.1), end: Point::new(end.0, end.1) }
    }

    /// Distance from `point` to the segment \[m].
    pub fn distance_to(&self, point: Point<Map, f64>) -> f64 {
        let (ex, ey) = (self.end.x - self.start.x, self.end.y - self.start.y);
        let (px, py) = (point.x - self.start.x, point.y - self.start.y);
        let squared = ex * ex + ey * ey;
        let part = if squared > 0.0 { ((px * ex + py * ey) / squared).clamp(0.0, 1.0) } else { 0.0 };
        (px - part * ex).hypot(py - part * ey)
    }

    /// Whether the straight path between the points meets the segment; touching counts.
    ///
    /// A path along the line of the segment is not detected. The distance of its end points detects such a
    /// contact.
    pub fn is_crossed_by(&self, from: Point<Map, f64>, to: Point<Map, f64>) -> bool {
        let side = |a: Point<Map, f64>, b: Point<Map, f64>, p: Point<Map, f64>| {
            (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)
        };
        let opposite = |one: f64, other: f64| (one <= 0.0) != (other <= 0.0) || one == 0.0 || other == 0.0;
        let [start, end] = [self.start, self.end].map(|at| side(from, to, at));
        let [here, there] = [from, to].map(|at| side(self.start, self.end, at));
        (start != 0.0 || end != 0.0) && opposite(start, end) && opposite(here, there)
    }
}

/// An environment with walls.
#[derive(Clone, Debug, PartialEq)]
pub struct Arena {
    name: &'static str,
    /// Corners (x, y) of the surrounding rectangle \[m].
    corners: [(f64, f64); 2],
    walls: Vec<WallSegment>,
}

impl Arena {
    /// The paper's arena: a rectangle of flat walls around wooden plates, [Tran2012] Sec. 5.2.
    ///
    /// # Departure
    /// The paper gives no dimensions. Here the walls are (−2, −2)–(4.5, 4.5), so the paper's start (0, 0, 0)
    /// and goal (2, 2) are at least 2 m away from them. Four plates stand beside the path.
    pub fn paper() -> Self {
        let plates = [
            WallSegment::between((-1.0, 0.8), (-1.0, 2.0)),
            WallSegment::between((0.6, -1.2), (1.8, -1.2)),
            WallSegment::between((3.6, 0.4), (3.6, 1.6)),
            WallSegment::between((0.4, 3.6), (1.4, 3.6)),
        ];
        Self::rectangle(ArenaName::Paper.name(), (-2.0, -2.0), (4.5, 4.5), &plates)
    }

    /// The paper's arena without plates.
    pub fn open() -> Self {
        Self::rectangle(ArenaName::Open.name(), (-2.0, -2.0), (4.5, 4.5), &[])
    }

    /// Reference environment for localization: the rectangle (0, 0)–(6, 4) with two plates.
    pub fn loop_world() -> Self {
        let plates =
            [WallSegment::between((2.5, 2.0), (3.5, 2.0)), WallSegment::between((5.2, 0.6), (5.2, 1.6))];
        Self::rectangle(ArenaName::Loop.name(), (0.0, 0.0), (6.0, 4.0), &plates)
    }

    /// Returns the arena with all coordinates times `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let point = |at: Point<Map, f64>| Point::new(at.x * factor, at.y * factor);
        let wall = |wall: &WallSegment| WallSegment { start: point(wall.start), end: point(wall.end) };
        Self {
            name: self.name,
            corners: self.corners.map(|(x, y)| (x * factor, y * factor)),
            walls: self.walls.iter().map(wall).collect(),
        }
    }

    /// Looks up an arena by name. `None`: unknown name.
    pub fn named(name: &str) -> Option<Self> {
        ArenaName::from_name(name).map(Self::from_name)
    }

    /// Creates the arena of the configuration's choice.
    pub fn from_name(name: ArenaName) -> Self {
        match name {
            ArenaName::Paper => Self::paper(),
            ArenaName::Open => Self::open(),
            ArenaName::Loop => Self::loop_world(),
        }
    }

    /// Creates a rectangle of walls between two opposite corners, with `plates` inside.
    pub fn rectangle(name: &'static str, low: (f64, f64), high: (f64, f64), plates: &[WallSegment]) -> Self {
        let (a, b, c, d) = (low, (high.0, low.1), high, (low.0, high.1));
        let mut walls = vec![
            WallSegment::between(a, b),
            WallSegment::between(b, c),
            WallSegment::between(c, d),
            WallSegment::between(d, a),
        ];
        walls.extend_from_slice(plates);
        Self { name, corners: [low, high], walls }
    }

    /// Creates an arena from `walls`; its extent is their bounding rectangle.
    pub fn from_walls(name: &'static str, walls: Vec<WallSegment>) -> Self {
        let ends = || walls.iter().flat_map(|wall| [wall.start, wall.end]);
        let low =
            ends().fold((f64::INFINITY, f64::INFINITY), |low, end| (low.0.min(end.x), low.1.min(end.y)));
        let high = ends()
            .fold((f64::NEG_INFINITY, f64::NEG_INFINITY), |high, end| (high.0.max(end.x), high.1.max(end.y)));
        Self { name, corners: [low, high], walls }
    }

    /// Creates the arena `map` from the walls of a map.
    pub fn from_wall_map(map: &WallMap) -> Self {
        let segment = |wall: &MapWall| WallSegment::between(wall.from.into(), wall.to.into());
        Self::from_walls("map", map.walls.iter().map(segment).collect())
    }

    /// Name of the arena.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// All walls and plates.
    pub fn walls(&self) -> &[WallSegment] {
        &self.walls
    }

    /// Corners of the bounding rectangle, lowest and highest (x, y) \[m].
    pub fn corners(&self) -> [(f64, f64); 2] {
        self.corners
    }

    /// Distance from `point` to the nearest wall \[m]; negative outside of the bounding rectangle.
    ///
    /// Both sides of a plate count as inside. [`first_wall_crossed`](Self::first_wall_crossed) detects a path
    /// through a plate.
    pub fn clearance(&self, point: Point<Map, f64>) -> f64 {
        let nearest = self.nearest_wall(point).map_or(f64::INFINITY, |wall| wall.distance_to(point));
        let [low, high] = self.corners;
        let inside = point.x > low.0 && point.x < high.0 && point.y > low.1 && point.y < high.1;
        // Subtraction from 0 avoids a negative zero on a wall.
        if inside { nearest } else { 0.0 - nearest }
    }

    /// Wall or plate nearest to `point`. `None`: no walls.
    pub fn nearest_wall(&self, point: Point<Map, f64>) -> Option<&WallSegment> {
        let distance = |wall: &&WallSegment| wall.distance_to(point);
        self.walls.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// First wall or plate, in list order, that the straight path meets. `None`: no contact.
    pub fn first_wall_crossed(&self, from: Point<Map, f64>, to: Point<Map, f64>) -> Option<&WallSegment> {
        self.walls.iter().find(|wall| wall.is_crossed_by(from, to))
    }
}

/// The walls of a map; one without length is left out.
pub fn walls_from_segments(segments: &[WallSegment]) -> Vec<Wall<f64>> {
    segments.iter().filter_map(|wall| Wall::between(wall.start, wall.end).ok()).collect()
}

/// Speed on the course of the loop world \[m/s].
pub const LOOP_SPEED: f64 = 0.3;

/// Course of the loop world: 3 m × 2 m rectangle, corner radius 0.5 m, center (3, 2), start (2, 1, 0°).
///
/// # Errors
/// Never: its dimensions are constants of a valid path.
pub fn loop_course() -> Result<Path<f64, 8>, InvalidPath> {
    Path::rounded_rectangle(Pose::new(2.0, 1.0, Angle::zero()), 3.0, 2.0, 0.5)
}

#[cfg(test)]
mod tests {
    use surepose::geometry::Point;

    use super::{Arena, ArenaName, Choice, WallSegment, loop_course};

    #[test]
    fn clearance_is_the_signed_distance_to_the_nearest_wall() {
        let arena = Arena::loop_world();
        for (x, y, clearance) in
            [(3.0, 1.0, 1.0), (3.0, 1.75, 0.25), (5.0, 1.0, 0.2), (2.2, 2.4, 0.5), (-1.0, 2.0, -1.0)]
        {
            assert!((arena.clearance(Point::new(x, y)) - clearance).abs() < 1e-12, "at {x}, {y}");
        }
        let on_a_corner = arena.clearance(Point::new(0.0, 0.0));
        assert_eq!(format!("{on_a_corner:.2}"), "0.00");
    }

    #[test]
    fn first_wall_crossed_detects_contacts_only() {
        let arena = Arena::loop_world();
        let met = |from: (f64, f64), to: (f64, f64)| {
            arena.first_wall_crossed(Point::new(from.0, from.1), Point::new(to.0, to.1)).copied()
        };
        let plate = Some(WallSegment::between((5.2, 0.6), (5.2, 1.6)));
        assert_eq!(met((5.0, 1.0), (5.4, 1.1)), plate);
        assert_eq!(met((5.4, 1.1), (5.0, 1.0)), plate);
        assert_eq!(met((5.0, 1.0), (5.2, 1.0)), plate, "a path that ends on a plate");
        assert_eq!(met((5.0, 1.6), (5.4, 1.6)), plate, "a path through the end point of a plate");
        assert_eq!(met((5.0, 1.7), (5.4, 1.7)), None, "past the end of a plate");
        assert_eq!(met((4.0, 1.0), (5.19, 1.0)), None, "a path that ends before a plate");
        assert_eq!(met((5.5, 1.0), (6.1, 1.0)), Some(WallSegment::between((6.0, 0.0), (6.0, 4.0))));
    }

    #[test]
    fn loop_course_keeps_clear_of_the_walls() {
        let (arena, course) = (Arena::loop_world(), loop_course().unwrap());
        for k in 0..1000 {
            let place = course.at(f64::from(k) * 0.01).map_from_target;
            assert!(arena.clearance(place.origin()) > 0.4, "at {place:?}");
        }
    }

    #[test]
    fn arenas_are_found_by_name() {
        for name in ArenaName::NAMES {
            assert_eq!(Arena::named(name).map(|arena| arena.name()), Some(*name));
        }
        assert_eq!(Arena::named("lop"), None);
    }
}
