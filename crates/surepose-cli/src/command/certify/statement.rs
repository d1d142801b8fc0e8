//! Assumptions of a certificate, and bounds once the goal is reached.

use serde_json::{Map, Value as Json, json};
use surepose::param;
use surepose_cert::NoiseBounds;
use surepose_config::Config;

use crate::certification::BaseDelay;

/// Returns the assumptions of the proof for this configuration, as sentences.
///
/// With `gaussian`, `sensed` are standard deviations.
pub(super) fn assumptions(
    config: &Config,
    sensed: NoiseBounds,
    delay: BaseDelay,
    gaussian: bool,
) -> Vec<String> {
    let within = if gaussian { "one standard deviation is" } else { "the error is at most" };
    let number = |parameter| config.number(parameter);
    let period = number(&param::PERIOD);
    let acceleration = config.limits().wheel_acceleration;
    let mut all = vec![
        format!(
            "period: every tick takes at most {period} s; shorter ticks and ticks of varying length are covered"
        ),
        format!(
            "pose: at every tick {within} {} m and {}°; the filter is not part of the proof",
            sensed.position,
            rounded(sensed.heading.to_degrees())
        ),
        format!(
            "wheels: the robot drives exact arcs, without slip; for each rim {within} {} m/s plus {} % of its command",
            sensed.rim_speed,
            rounded(100.0 * sensed.rim_speed_part)
        ),
        format!(
            "acceleration: the wheels follow their commands at once; with the limit of {acceleration} m/s² the bounds are searched for a \
             drive that leaves them, not proved"
        ),
        delay.described(number(&param::COMMAND_DELAY)),
    ];
    let min = config.actuator().min_speeds;
    if min.wheel > 0.0 || min.v > 0.0 || min.omega > 0.0 {
        all.push(
            "dead band: the base executes the configured minimum speeds and above; each pulse counts as a wheel error".to_owned(),
        );
    }
    if number(&param::MOTOR_TIME_CONSTANT) > 0.0 {
        all.push(format!(
            "lag: the time constant of {} s is not modeled",
            number(&param::MOTOR_TIME_CONSTANT)
        ));
    }
    all.extend(
        [
            "footprint: the way is free; walls, obstacles and the outline of the robot are not part of the proof",
            "memory: the state of the law is kept from the start to the goal; a stop by the supervisor, a new goal or a restart begins \
             a new claim from where the robot is",
        ]
        .map(str::to_owned),
    );
    all
}

/// Adds the bounds of the true error at the moment at which the goal is declared reached.
pub(super) fn add_reached_bounds(json: &mut Map<String, Json>, config: &Config, noise: NoiseBounds) {
    let tolerance = config.controller().tolerance;
    let position = tolerance.position * tolerance.hysteresis + noise.position;
    let heading = tolerance.heading * tolerance.hysteresis + noise.heading;
    json.insert("reached_position_bound_m".to_owned(), json!(position));
    json.insert("reached_heading_bound_deg".to_owned(), json!(heading.to_degrees()));
}

/// Removes the digits that a conversion of units adds.
fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}
