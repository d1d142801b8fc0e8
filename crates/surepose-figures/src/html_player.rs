//! HTML player of a drive: a self-contained page.

use serde::Serialize;
use surepose::param;
use surepose_sim::robot::Scenario;
use surepose_sim::simulation::Sample;

use super::drive::enlargement;

/// The page, and the placeholder that the drive replaces.
const PAGE: &str = include_str!("film.html");
const PLACE: &str = "/*DRIVE*/null";

/// Data of the page.
#[derive(Serialize)]
struct PageData<'a> {
    walls: Vec<[f64; 4]>,
    start: MapPose,
    goal: MapPose,
    track: f64,
    tolerance_m: f64,
    factor: f64,
    samples: &'a [Sample],
}

#[derive(Serialize)]
struct MapPose {
    x_m: f64,
    y_m: f64,
    heading_deg: f64,
}

/// Returns a page that plays the drive: the arena, the last centimeters, and V over time.
///
/// # Errors
/// Serialization errors of JSON: NaN has no representation, and a drive has none.
pub fn html_player(scenario: &Scenario, samples: &[Sample]) -> Result<String, serde_json::Error> {
    let place = |section: [&param::Parameter; 3]| {
        // In the user's own degrees.
        let [x_m, y_m, heading] = section.map(|parameter| scenario.config.number(parameter));
        MapPose { x_m, y_m, heading_deg: rounded(heading.to_degrees()) }
    };
    let walls = scenario.arena.walls().iter();
    let drive = PageData {
        walls: walls.map(|wall| [wall.start.x, wall.start.y, wall.end.x, wall.end.y]).collect(),
        start: place([&param::START_X, &param::START_Y, &param::START_HEADING]),
        goal: place([&param::GOAL_X, &param::GOAL_Y, &param::GOAL_HEADING]),
        track: scenario.config.drive().wheel_separation,
        tolerance_m: scenario.config.number(&param::POSITION_TOLERANCE),
        factor: enlargement(samples),
        samples,
    };
    Ok(PAGE.replace(PLACE, &serde_json::to_string(&drive)?))
}

/// Removes the rounding error of an angle conversion.
fn rounded(degrees: f64) -> f64 {
    (degrees * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use surepose_sim::simulation::simulate;

    use super::*;

    #[test]
    fn the_page_contains_the_drive() {
        let scenario = Scenario::default();
        let (samples, _) = simulate(&scenario, 1);
        let page = html_player(&scenario, &samples).unwrap();
        let line = page.lines().find_map(|line| line.strip_prefix("const drive = ")).unwrap();
        let drive: serde_json::Value = serde_json::from_str(line.trim_end_matches(';')).unwrap();
        assert_eq!(drive["samples"].as_array().unwrap().len(), samples.len());
        assert_eq!(drive["goal"], serde_json::json!({ "x_m": 2.0, "y_m": 2.0, "heading_deg": 30.0 }));
        assert!(drive["samples"][0].get("goal_distance_m").is_some_and(serde_json::Value::is_f64));
    }
}
