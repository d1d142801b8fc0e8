//! Fig. 6 of the paper: path following with and without the filter.

use serde::Serialize;
use surepose::control::{InvalidPath, Path, PathController, PathError, PathFollowingLaw, PathProgress};
use surepose::geometry::{Angle, Map, Point, Pose, Target};
use surepose::kinematics::WheelPair;
use surepose::param;
use surepose_config::Config;
use surepose_sim::robot::{Scenario, Sensors, SimulatedRobot};
use surepose_sim::{Arena, loop_course};

/// Number of laps of each path.
const ROUNDS: f64 = 2.0;

/// Step of the search for the nearest point on a path \[m].
const SEARCH_STEP: f64 = 0.01;

/// Target speed \[m/s], [Tran2012] Sec. 5.2; the wheel speed limit reduces it in corners.
const SPEED: f64 = 0.3;

/// Figures of both paths, named as in the command line's JSON.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PathFigures {
    /// The rounded rectangle.
    pub rounded_rectangle: ShapeFigures,
    /// The rounded triangle.
    pub rounded_triangle: ShapeFigures,
}

/// Figures of one path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ShapeFigures {
    /// Controlled with the filter's estimate from laser and compass.
    pub with_ekf: PathAccuracy,
    /// Controlled with dead reckoning.
    pub without_ekf: PathAccuracy,
}

/// Accuracy of path following.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PathAccuracy {
    /// Root mean square of the true distance from the path over all runs.
    pub path_rmse_m: f64,
}

/// Desired and driven path, for the figure.
#[derive(Clone, Debug, PartialEq)]
pub struct PathRuns {
    /// The path, densely sampled.
    pub path: Vec<Point<Map, f64>>,
    /// True positions in the first run, with the filter.
    pub with_ekf: Vec<Point<Map, f64>>,
    /// True positions in the first run, without the filter.
    pub without_ekf: Vec<Point<Map, f64>>,
}

/// Result of the experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct PathFollowing {
    /// Figures.
    pub figures: PathFigures,
    /// The rounded rectangle.
    pub rounded_rectangle: PathRuns,
    /// The rounded triangle.
    pub rounded_triangle: PathRuns,
}

/// Follows both paths in the loop world for two laps, in `runs` runs with seeds from `first_seed`.
///
/// # Errors
/// None in practice: the dimensions of both paths are valid constants.
pub fn following(config: &Config, first_seed: u64, runs: u64) -> Result<PathFollowing, InvalidPath> {
    // The triangle surrounds the same plate as the rectangle, with a minimum distance of 0.44 m.
    let corner = 3.0_f64.sqrt() * 0.5;
    let base = Pose::new(1.3 + corner, 0.8, Angle::zero());
    let triangle = Path::rounded_triangle(base, 3.4, 0.5)?;
    let (rectangle_figures, rounded_rectangle) = shape(config, &loop_course()?, first_seed, runs);
    let (triangle_figures, rounded_triangle) = shape(config, &triangle, first_seed, runs);
    let figures = PathFigures { rounded_rectangle: rectangle_figures, rounded_triangle: triangle_figures };
    Ok(PathFollowing { figures, rounded_rectangle, rounded_triangle })
}

/// Follows one path with and without the filter.
fn shape<const N: usize>(
    config: &Config,
    path: &Path<f64, N>,
    first_seed: u64,
    runs: u64,
) -> (ShapeFigures, PathRuns) {
    let outline = Outline::from_path(path);
    let seeds = first_seed..first_seed + runs.max(1);
    let drive = |sensors| {
        let tracks: Vec<_> = seeds.clone().map(|seed| follow(config, path, sensors, seed)).collect();
        let figures = PathAccuracy { path_rmse_m: outline.rmse(tracks.iter().flatten()) };
        (figures, tracks.into_iter().next().unwrap_or_default())
    };
    let (with_ekf, with_track) = drive(Sensors::ALL);
    let (without_ekf, without_track) = drive(Sensors::NONE);
    let path = outline.places.iter().map(|place| place.origin()).collect();
    let shape = PathRuns { path, with_ekf: with_track, without_ekf: without_track };
    (ShapeFigures { with_ekf, without_ekf }, shape)
}

/// Follows the path; returns the true position at every tick.
fn follow<const N: usize>(
    config: &Config,
    path: &Path<f64, N>,
    sensors: Sensors,
    seed: u64,
) -> Vec<Point<Map, f64>> {
    let start = path.at(0.0).map_from_target;
    let values = [
        (&param::START_X, start.x),
        (&param::START_Y, start.y),
        (&param::START_HEADING, start.heading.degrees()),
    ];
    let config = config.clone().with_preset("fig6", &values);
    let controller = config.controller();
    let controller = PathController {
        drive: controller.drive,
        path: *path,
        law: law(controller.period),
        limits: controller.limits,
        period: controller.period,
    };
    let scenario = Scenario { sensors, ..Scenario::in_arena(Arena::loop_world(), config) };
    let mut simulated_robot = SimulatedRobot::new(&scenario, seed);
    let (mut progress, mut wheels) = (PathProgress::new(), WheelPair::new(0.0, 0.0));
    let mut track = Vec::new();
    // Twice the time of all laps at half the target speed, so that a stuck robot ends, too.
    let most = (4.0 * ROUNDS * path.length() / (SPEED * controller.period)) as usize;
    while progress.laps < ROUNDS && track.len() < most {
        let belief = simulated_robot.advance(wheels, controller.period).belief;
        (wheels, progress) = controller.step(progress, belief.pose);
        track.push(simulated_robot.world().pose().origin());
    }
    track
}

/// Returns gains with a critically damped lateral error, settling in 1 s or ten periods, whichever is longer.
fn law(period: f64) -> PathFollowingLaw<f64> {
    let rate = 1.0 / (10.0 * period).max(1.0);
    PathFollowingLaw {
        speed: SPEED,
        k_along: rate,
        k_across: (rate / SPEED) * (rate / SPEED),
        k_heading: 2.0 * rate,
    }
}

/// Samples along a path for distance measurement.
struct Outline {
    places: Vec<Pose<Map, Target, f64>>,
}

impl Outline {
    fn from_path<const N: usize>(path: &Path<f64, N>) -> Self {
        let count = (path.length() / SEARCH_STEP).ceil() as usize;
        let place = |k: usize| path.at(path.length() * k as f64 / count as f64).map_from_target;
        Self { places: (0..=count).map(place).collect() }
    }

    /// Returns the distance from the nearest sample, perpendicular to the path \[m].
    fn distance(&self, point: Point<Map, f64>) -> f64 {
        let nearest = |a: &&Pose<Map, Target, f64>, b: &&Pose<Map, Target, f64>| {
            a.origin().distance(point).total_cmp(&b.origin().distance(point))
        };
        self.places.iter().min_by(nearest).map_or(f64::INFINITY, |place| {
            PathError::from_poses(Pose::new(point.x, point.y, place.heading), *place).cross_track.abs()
        })
    }

    fn rmse<'a>(&self, points: impl Iterator<Item = &'a Point<Map, f64>>) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for point in points {
            sum += self.distance(*point).powi(2);
            count += 1.0;
        }
        libm::sqrt(sum / f64::max(count, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use surepose::geometry::Point;
    use surepose_config::Config;
    use surepose_sim::loop_course;

    use super::{Outline, following};

    #[test]
    fn filter_reduces_the_path_error_fivefold_on_both_paths() {
        let figures = following(&Config::default(), 1, 3).unwrap().figures;
        for shape in [figures.rounded_rectangle, figures.rounded_triangle] {
            assert!(shape.with_ekf.path_rmse_m < 0.0065, "{shape:?}");
            assert!(shape.without_ekf.path_rmse_m > 5.0 * shape.with_ekf.path_rmse_m, "{shape:?}");
        }
    }

    #[test]
    fn distance_from_the_path_is_perpendicular() {
        let outline = Outline::from_path(&loop_course().unwrap());
        let diagonal = 0.5_f64.sqrt() * 0.6;
        for (x, y, distance) in [(3.003, 1.02, 0.02), (3.0, 0.9, 0.1), (4.0 + diagonal, 1.5 - diagonal, 0.1)]
        {
            let found = outline.distance(Point::new(x, y));
            assert!((found - distance).abs() < 1e-4, "at {x}, {y}: {found}");
        }
    }
}
