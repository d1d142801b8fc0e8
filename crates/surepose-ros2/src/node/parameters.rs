//! Read-only ROS parameters of the configuration: `ros2 param get /surepose law.k_v`.

use std::collections::BTreeMap;

use ros2_client::{NodeOptions, ParameterValue};
use surepose_config::{Config, Value};

/// Declares each parameter of the table as `section.key`, with its value in use.
pub(super) fn declared(config: &Config) -> NodeOptions {
    let config = config.fitted();
    let values: BTreeMap<String, ParameterValue> = config
        .settings()
        .iter()
        .map(|setting| {
            let name = format!("{}.{}", setting.parameter.section, setting.parameter.key);
            let value = match &setting.value {
                Value::Number(number) => ParameterValue::Double(*number),
                Value::Choice(choice) => ParameterValue::String((*choice).to_owned()),
                // x and y of each point in turn: ROS has no lists of lists.
                Value::Polygon(points) => ParameterValue::DoubleArray(points.concat()),
            };
            (name, value)
        })
        .collect();
    let options = values.iter().fold(NodeOptions::new().enable_rosout(true), |options, (name, value)| {
        options.declare_parameter(name, value.clone())
    });
    // A certificate holds for fixed parameters, so changes are rejected. Parameters of ROS itself, such as use_sim_time,
    // are not in the table.
    options.parameter_validator(Box::new(move |name, value| match values.get(name) {
        Some(fixed) if fixed != value => Err(format!(
            "{name}: read-only while the node runs; start it with --set {name}=VALUE, or --config FILE"
        )),
        _ => Ok(()),
    }))
}
