//! `surepose certify --gaussian`: what holds on average, under noise that no bound holds for.

use std::time::Instant;

use serde_json::{Map, Value as Json, json};
use surepose_cert::{Drift, NoiseBounds};
use surepose_config::Config;

use crate::certification;
use crate::error::CliError;
use crate::exit::Exit;
use crate::output::{Output, table, worded};

/// What the figures are not about.
const LEFT_OUT: [&str; 4] = [
    "inside of the radius nothing is claimed: neither that the robot stays there, nor its heading, nor rest",
    "the expected time ends within the radius, or farther out than the certificate goes",
    "noise is white: an estimate that stays off for many ticks, by a bias or a slow drift, is not covered",
    "the wheels are taken to follow their commands at once",
];

/// The keys in words.
const WORDS: [(&str, &str); 6] = [
    ("drift_radius_m", "W falls on average outside of [m]"),
    ("drift_rate_per_s", "at least by [1/s]"),
    ("expected_time_bound_s", "expected time to come there, at most [s]"),
    ("deviations", "noise looked at, in standard deviations"),
    ("exceeded_probability", "chance of more in a tick"),
    ("wall_s", "computing time [s]"),
];

const REASON: &str = "with these standard deviations W was not shown to fall on average at any distance";

pub(super) fn run(config: &Config, noise: NoiseBounds, output: Output) -> Result<Exit, CliError> {
    let clock = Instant::now();
    let found = certification::average(config, noise);
    let json = json_of(found.as_ref(), clock.elapsed().as_secs_f64());
    output.result(&json, || {
        let mut table = table(&[]);
        let mut told = json.clone();
        told.remove("left_out");
        for row in worded(&told, &WORDS) {
            table.add_row(row);
        }
        for (k, words) in LEFT_OUT.iter().filter(|_| found.is_some()).enumerate() {
            table.add_row([if k == 0 { "left out" } else { "" }, words]);
        }
        table
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
