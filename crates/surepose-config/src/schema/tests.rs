//! The schema against the parser of the file.

use std::path::Path;

use serde_json::{Value as Json, json};
use surepose::param::{ALL, Kind};

use super::json_schema;
use crate::{Config, Value};

/// Whether `value` satisfies `schema`, by the rules of draft 2020-12 for the keywords in use.
///
/// Validator crates would double the build time of the tests.
fn accepts(schema: &Json, value: &Json) -> bool {
    schema.as_object().expect("an object").iter().all(|(keyword, rule)| {
        let number = |fits: fn(f64, f64) -> bool| {
            let bound = rule.as_f64().expect("a number");
            value.as_f64().is_none_or(|value| fits(value, bound))
        };
        match keyword.as_str() {
            "$schema" | "$comment" | "title" | "description" | "default" | "x-unit" => true,
            "type" => match rule.as_str() {
                Some("object") => value.is_object(),
                Some("string") => value.is_string(),
                Some("number") => value.is_number(),
                Some("array") => value.is_array(),
                Some("integer") => value.as_f64().is_some_and(|number| number.fract() == 0.0),
                other => panic!("unknown type {other:?}"),
            },
            "enum" => rule.as_array().expect("an array").contains(value),
            "minimum" => number(|value, bound| value >= bound),
            "exclusiveMinimum" => number(|value, bound| value > bound),
            "maximum" => number(|value, bound| value <= bound),
            "minItems" => {
                value.as_array().is_none_or(|items| items.len() as u64 >= rule.as_u64().expect("a size"))
            }
            "maxItems" => {
                value.as_array().is_none_or(|items| items.len() as u64 <= rule.as_u64().expect("a size"))
            }
            "items" => value.as_array().into_iter().flatten().all(|item| accepts(rule, item)),
            "anyOf" => rule.as_array().expect("an array").iter().any(|schema| accepts(schema, value)),
            "properties" => value
                .as_object()
                .into_iter()
                .flatten()
                .all(|(key, value)| rule.get(key).is_none_or(|schema| accepts(schema, value))),
            "additionalProperties" => {
                assert_eq!(rule, false);
                value
                    .as_object()
                    .into_iter()
                    .flatten()
                    .all(|(key, _)| schema["properties"].get(key).is_some())
            }
            other => panic!("unknown keyword {other}"),
        }
    })
}

/// The verdicts of the schema and of the parser on `[section] key = value`; `value` is the same text in JSON and TOML.
fn verdicts(schema: &Json, section: &str, key: &str, value: &str) -> [bool; 2] {
    let json: Json = serde_json::from_str(value).expect("JSON");
    let toml = format!("[{section}]\n{key} = {value}\n");
    let parsed = Config::default().with_text(Path::new("robot.toml"), toml.as_bytes());
    [accepts(schema, &json!({ section: { key: json } })), parsed.is_ok()]
}

#[test]
fn schema_accepts_the_defaults() {
    let (schema, mut all) = (json_schema(), json!({}));
    for setting in Config::default().settings() {
        let value = match &setting.value {
            Value::Number(number) => json!(number),
            Value::Choice(name) => json!(name),
            Value::Polygon(points) => json!(points),
        };
        let property = &schema["properties"][setting.parameter.section]["properties"][setting.parameter.key];
        if let Some(default) = property.get("default") {
            assert_eq!(default.as_f64(), value.as_f64(), "{}", setting.parameter.key);
            assert_eq!(default.as_str(), value.as_str(), "{}", setting.parameter.key);
        }
        all[setting.parameter.section][setting.parameter.key] = value;
    }
    assert!(accepts(&schema, &all));
    assert!(accepts(&schema, &json!({})));
}

/// The schema accepts a value exactly if the parser does: within, at and outside of every bound, and of every type.
#[test]
fn schema_and_parser_agree() {
    let (schema, mut rejected) = (json_schema(), 0);
    let usual = ["true", "\"\"", "\"nothing\"", "[]", "[1.0, 2.0]", "{}", "0", "0.0", "1.5", "-1"];
    for p in ALL {
        let mut values: Vec<String> = usual.map(str::to_owned).into();
        match p.kind {
            Kind::Number { range, .. } | Kind::Integer { range, .. } => {
                for bound in [range.low, range.high] {
                    let step = 1.0_f64.max(bound.abs()) * 1e-6;
                    values.extend([bound - step, bound, bound + step].map(|at| format!("{at:?}")));
                }
            }
            Kind::Polygon { range } => {
                let square = |size: f64| format!("[[{size:?}, 1], [-1, 1], [-1.0, -1.0], [1, -1.5]]");
                values.extend([range.high, range.high + 1e-6, 1.0].map(square));
                values.extend([3, 8, 9].map(|corners| {
                    let corner = |k: usize| (std::f64::consts::TAU * k as f64 / corners as f64).sin_cos();
                    format!("{:?}", (0..corners).map(corner).map(<[f64; 2]>::from).collect::<Vec<_>>())
                }));
                values
                    .extend(["[[1, 0], [0, 1]]", "[[1, 0, 0], [-1, 1, 0], [-1, -1, 0]]"].map(str::to_owned));
                values.extend(["[1, 2, 3]", "[[1, 1], [-1, \"1\"], [-1, -1]]"].map(str::to_owned));
            }
            Kind::Choice { options } => values.extend(options.iter().map(|name| format!("\"{name}\""))),
        }
        for value in values {
            let [by_schema, by_parser] = verdicts(&schema, p.section, p.key, &value);
            assert_eq!(by_schema, by_parser, "{}.{} = {value}", p.section, p.key);
            rejected += usize::from(!by_schema);
        }
        assert_eq!(verdicts(&schema, p.section, &format!("{}x", p.key), "1"), [false; 2]);
    }
    assert!(rejected > 5 * ALL.len(), "{rejected}");
    assert_eq!(verdicts(&schema, "robots", "track_m", "1"), [false; 2]);
}
