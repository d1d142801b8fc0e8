//! One drive to be watched: a page that needs nothing but a browser.

use serde::Serialize;
use surepose::param;
use surepose_sim::robot::Scenario;
use surepose_sim::simulation::Sample;

use super::drive::enlargement;

/// The page, and the place in it where the drive goes.
const PAGE: &str = include_str!("film.html");
const PLACE: &str = "/*DRIVE*/null";

/// What the page is told.
#[derive(Serialize)]
struct Drive<'a> {
    walls: Vec<[f64; 4]>,
    start: Place,
    goal: Place,
    track: f64,
    tolerance_m: f64,
    factor: f64,
    samples: &'a [Sample],
}

#[derive(Serialize)]
struct Place {
    x_m: f64,
    y_m: f64,
    heading_deg: f64,
}

/// The drive as a page that plays it: the arena from above, the last centimetres, and V over time.
///
/// # Errors
/// Those of JSON, which has no NaN: a drive has none either.
pub fn html_player(scenario: &Scenario, samples: &[Sample]) -> Result<String, serde_json::Error> {
    let place = |section: [&param::Parameter; 3]| {
        // In the user's own degrees.
        let [x_m, y_m, heading] = section.map(|parameter| scenario.config.number(parameter));
        Place { x_m, y_m, heading_deg: rounded(heading.to_degrees()) }
    };
    let walls = scenario.arena.walls().iter();
    let drive = Drive {
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

/// Without what rounding leaves of a conversion.
fn rounded(degrees: f64) -> f64 {
    (degrees * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use surepose_sim::simulation::simulate;

    use super::*;

    #[test]
    fn the_page_holds_the_drive() {
        let scenario = Scenario::default();
        let (samples, _) = simulate(&scenario, 1);
        let page = html_player(&scenario, &samples).unwrap();
        let line = page.lines().find_map(|line| line.strip_prefix("const drive = ")).unwrap();
        let told: serde_json::Value = serde_json::from_str(line.trim_end_matches(';')).unwrap();
        assert_eq!(told["samples"].as_array().unwrap().len(), samples.len());
        assert_eq!(told["goal"], serde_json::json!({ "x_m": 2.0, "y_m": 2.0, "heading_deg": 30.0 }));
        assert!(told["samples"][0].get("goal_distance_m").is_some_and(serde_json::Value::is_f64));
    }
}
