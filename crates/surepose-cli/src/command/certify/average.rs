//! `surepose certify --gaussian`: expected decrease under unbounded Gaussian noise.

use std::time::Instant;

use serde_json::{Map, Value as Json, json};
use surepose_cert::{Drift, NoiseBounds};
use surepose_config::Config;

use crate::certification;
use crate::error::CliError;
use crate::exit::Exit;
use crate::output::{Output, table, worded, wrapped};

/// The cases that the statement does not cover.
const LEFT_OUT: [&str; 3] = [
    "within the radius nothing is proven: not that the robot stays there, nor its heading, nor that it comes to rest",
    "the expected time ends within the radius, or beyond the distance that the certificate covers",
    "the noise is white: a bias or a slow drift of the estimate is not covered",
];

/// Table labels of the keys.
const WORDS: [(&str, &str); 6] = [
    ("drift_radius_m", "W decreases in expectation beyond [m]"),
    ("drift_rate_per_s", "expected decrease rate, minimum [1/s]"),
    ("expected_time_bound_s", "expected time to that radius, bound [s]"),
    ("deviations", "noise range evaluated [standard deviations]"),
    ("exceeded_probability", "probability of more noise, per tick"),
    ("wall_s", "computing time [s]"),
];

const REASON: &str = "no expected decrease of W was proven at any distance for these standard deviations";

pub(super) fn run(
    config: &Config,
    noise: NoiseBounds,
    assumptions: &[String],
    output: Output,
) -> Result<Exit, CliError> {
    let clock = Instant::now();
    let found = certification::average(config, noise);
    let mut json = json_of(found.as_ref(), clock.elapsed().as_secs_f64());
    json.insert("assumptions".to_owned(), json!(assumptions));
    output.result(&json, || {
        let mut table = table(&[]);
        let mut shown = json.clone();
        shown.remove("left_out");
        shown.remove("assumptions");
        for row in worded(&shown, &WORDS) {
            table.add_row(row);
        }
        for (k, words) in LEFT_OUT.iter().filter(|_| found.is_some()).enumerate() {
            table.add_row([if k == 0 { "not covered" } else { "" }, words]);
        }
        for (k, words) in assumptions.iter().enumerate() {
            table.add_row([if k == 0 { "assumed" } else { "" }, words]);
        }
        wrapped(table)
    })?;
    Ok(if found.is_some() { Exit::Done } else { Exit::Negative })
}

fn json_of(found: Option<&Drift>, wall: f64) -> Map<String, Json> {
    let mut json = Map::new();
    json.insert("certified".to_owned(), json!(found.is_some()));
    json.insert("noise".to_owned(), json!("gaussian"));
    match found {
        Some(drift) => {
            let numbers = [
                ("drift_radius_m", drift.radius),
                ("drift_rate_per_s", drift.rate),
                ("expected_time_bound_s", drift.expected_time),
                ("deviations", drift.deviations),
                ("exceeded_probability", drift.exceeded),
            ];
            json.extend(numbers.map(|(key, value)| (key.to_owned(), json!(value))));
            json.insert("left_out".to_owned(), json!(LEFT_OUT));
        }
        None => {
            json.insert("reason".to_owned(), json!(REASON));
        }
    }
    json.insert("wall_s".to_owned(), json!(wall));
    json
}
