//! Explains a parameter: name, meaning, unit, default, bounds and their reason.

use serde_json::{Map, Value as Json, json};
use surepose::param::{Kind, Parameter};
use surepose::safety::MAX_VERTICES;
use surepose_config::{ParameterSet, Setting, Value};

/// Returns `section.key`.
pub(crate) fn name(parameter: &Parameter) -> String {
    format!("{}.{}", parameter.section, parameter.key)
}

/// Returns a value as JSON.
pub(crate) fn json_of(value: &Value) -> Json {
    match value {
        Value::Number(number) => json!(number),
        Value::Choice(choice) => json!(choice),
        Value::Polygon(points) => json!(points),
    }
}

/// Returns settings as a JSON object, name to value.
pub(crate) fn settings_as_json(settings: &[Setting]) -> Json {
    let entry = |setting: &Setting| (name(setting.parameter), json_of(&setting.value));
    Json::Object(settings.iter().map(entry).collect())
}

/// Explains every parameter of a simulated world, as JSON or as text.
pub(crate) fn world_help(parameters: &ParameterSet, json: bool) -> String {
    if json {
        let all: Map<_, _> = parameters.iter().map(|p| (name(p), as_json(p))).collect();
        return format!("{}\n", Json::Object(all));
    }
    let all = parameters.iter().map(as_text).collect::<String>();
    format!(
        "Properties of the world, for --world SECTION.KEY=VALUE. Those that the configuration has, too, default to \
         the robot's configuration. `map=FILE` sets the walls of the world: a wall map, or an occupancy grid.\n\n{all}"
    )
}

/// Returns the value of a setting with its unit.
pub(crate) fn shown(setting: &Setting) -> String {
    let unit = setting.parameter.unit.symbol();
    if unit.is_empty() { setting.value.to_string() } else { format!("{} {unit}", setting.value) }
}

/// Explains `parameter` as JSON.
pub(crate) fn as_json(parameter: &Parameter) -> Json {
    let (range, reason) = bounds(parameter);
    json!({
        "name": name(parameter), "unit": parameter.unit.symbol(), "default": default(parameter), "range": range,
        "reason": reason, "meaning": parameter.meaning.trim(),
    })
}

/// Explains `parameter` in four lines.
pub(crate) fn as_text(parameter: &Parameter) -> String {
    let (range, reason) = bounds(parameter);
    let default = match default(parameter) {
        Json::String(option) => option,
        Json::Null => "derived".to_owned(),
        number => format!("{number} {}", parameter.unit.symbol()).trim_end().to_owned(),
    };
    format!(
        "{}\n  {}\n  default: {default}\n  allowed: {range}\n  reason: {reason}\n",
        name(parameter),
        parameter.meaning.trim()
    )
}

fn default(parameter: &Parameter) -> Json {
    match parameter.kind {
        Kind::Number { default, .. } => json!(default),
        Kind::Integer { default, .. } => json!(default),
        Kind::Choice { options } => json!(options.first()),
        Kind::Polygon { .. } => json!([]),
    }
}

fn bounds(parameter: &Parameter) -> (String, &'static str) {
    match parameter.kind {
        Kind::Number { range, .. } | Kind::Integer { range, .. } => {
            (format!("{range} {}", parameter.unit.symbol()).trim_end().to_owned(), range.reason)
        }
        Kind::Polygon { range } => {
            (format!("3 to {MAX_VERTICES} points, coordinates in {range} m"), range.reason)
        }
        Kind::Choice { options } => (options.join(", "), "these are the available options"),
    }
}
