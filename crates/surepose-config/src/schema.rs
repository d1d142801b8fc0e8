//! JSON Schema of the configuration file, made from the parameter table.

use serde_json::{Map, Value as Json, json};
use surepose::param::{ALL, Kind, Parameter, Range, SECTIONS};
use surepose::safety::MAX_VERTICES;

/// Returns the JSON Schema (draft 2020-12) of the configuration file, for editors and other programs.
///
/// The schema accepts what the parser of the file accepts, seen as JSON: a table is an object. One condition it cannot express: a
/// polygon must contain the origin.
///
/// | keyword | content |
/// |---|---|
/// | `description` | meaning |
/// | `default` | default; absent for a value that is derived from others |
/// | `minimum` or `exclusiveMinimum`, `maximum` | bounds |
/// | `enum` | options |
/// | `x-unit` | symbol of the unit; absent for dimensionless values |
/// | `$comment` | reason for the bounds |
pub fn json_schema() -> Json {
    let sections = SECTIONS.iter().map(|(name, meaning)| ((*name).to_owned(), section(name, meaning)));
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Configuration of Surepose",
        "description": "Every section and every key is optional.",
        "type": "object",
        "properties": sections.collect::<Map<_, _>>(),
        "additionalProperties": false,
    })
}

fn section(name: &str, meaning: &str) -> Json {
    let keys = ALL.iter().filter(|parameter| parameter.section == name);
    json!({
        "description": meaning,
        "type": "object",
        "properties": keys.map(|p| (p.key.to_owned(), property(p))).collect::<Map<_, _>>(),
        "additionalProperties": false,
    })
}

fn property(parameter: &Parameter) -> Json {
    let mut schema = Map::new();
    let mut put = |keyword: &str, value: Json| schema.insert(keyword.to_owned(), value);
    put("description", json!(parameter.meaning.trim()));
    match parameter.kind {
        Kind::Number { default, range } => {
            put("type", json!("number"));
            if let Some(default) = default {
                put("default", json!(default));
            }
            put_range(&mut schema, &range);
        }
        Kind::Integer { default, range } => {
            put("type", json!("integer"));
            put("default", json!(default));
            put_range(&mut schema, &range);
        }
        Kind::Choice { options } => {
            put("type", json!("string"));
            put("default", json!(options.first()));
            put("enum", json!(options));
        }
        Kind::Polygon { range } => {
            let mut coordinate = Map::from_iter([("type".to_owned(), json!("number"))]);
            put_range(&mut coordinate, &range);
            let point = json!({ "type": "array", "items": coordinate, "minItems": 2, "maxItems": 2 });
            put("type", json!("array"));
            put("default", json!([]));
            put("items", point);
            put("maxItems", json!(MAX_VERTICES));
            put("anyOf", json!([{ "minItems": 3 }, { "maxItems": 0 }]));
        }
    }
    let unit = parameter.unit.symbol();
    if !unit.is_empty() {
        schema.insert("x-unit".to_owned(), json!(unit));
    }
    Json::Object(schema)
}

fn put_range(schema: &mut Map<String, Json>, range: &Range) {
    let minimum = if range.low_inclusive { "minimum" } else { "exclusiveMinimum" };
    schema.insert(minimum.to_owned(), json!(range.low));
    schema.insert("maximum".to_owned(), json!(range.high));
    schema.insert("$comment".to_owned(), json!(range.reason));
}

#[cfg(test)]
mod tests;
