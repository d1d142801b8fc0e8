//! The configuration as ROS parameters: to be read, `ros2 param get /surepose law.k_v`, and not to be changed under way.

use std::collections::BTreeMap;

use ros2_client::{NodeOptions, ParameterValue};
use surepose_config::{Config, Value};

/// Every parameter of the table under `section.key`, with the value in use.
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
            };
            (name, value)
        })
        .collect();
    let options = values.iter().fold(NodeOptions::new().enable_rosout(true), |options, (name, value)| {
        options.declare_parameter(name, value.clone())
    });
    // What was certified is what drives: a gain that changes under way would be another robot. Parameters of ROS itself,
    // use_sim_time for one, are not the table's.
    options.parameter_validator(Box::new(move |name, value| match values.get(name) {
        Some(fixed) if fixed != value => Err(format!(
            "{name} is fixed while the node runs: start it with --set {name}=VALUE, or --config FILE"
        )),
        _ => Ok(()),
    }))
}
