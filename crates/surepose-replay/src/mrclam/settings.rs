//! Settings of the MRCLAM replay from a configuration.

use surepose::param;
use surepose_config::Config;

use super::{Camera, MrclamSettings, Response};

impl MrclamSettings {
    /// Returns the format's preset, which the user's values override.
    pub fn preset() -> Config {
        let values = [(&param::WHEEL_SEPARATION, 0.26), (&param::HISTORY, 0.5)];
        Config::default().with_preset("mrclam", &values)
    }

    /// Reads the settings of a configuration.
    pub fn from_config(config: &Config) -> Self {
        let number = |parameter| config.number(parameter);
        Self {
            response: Response {
                dead_time: number(&param::COMMAND_DEAD_TIME),
                speed_gain: number(&param::COMMAND_SPEED_GAIN),
                turn_gain: number(&param::COMMAND_TURN_GAIN),
                way_lost_per_radian: number(&param::COMMAND_WAY_LOST),
            },
            wheel_separation: number(&param::WHEEL_SEPARATION),
            rim_variance_per_metre: number(&param::RIM_VARIANCE_PER_METER),
            rim_variance_per_radian: number(&param::RIM_VARIANCE_PER_RADIAN),
            camera: Camera {
                latency: number(&param::CAMERA_LATENCY),
                scale: number(&param::CAMERA_SCALE),
                depth_std: number(&param::CAMERA_DEPTH_STD),
                depth_std_per_metre: number(&param::CAMERA_DEPTH_STD_PER_METER),
                bearing_std: number(&param::CAMERA_BEARING_STD),
                correlation_time: number(&param::CAMERA_CORRELATION_TIME),
                frame_period: number(&param::CAMERA_FRAME_PERIOD),
            },
            gate_probability: number(&param::GATE_PROBABILITY),
            history: number(&param::HISTORY),
            start: None,
            start_std: Self::default().start_std,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::MrclamSettings;

    /// The preset's parameters are equal to the settings fitted to the data.
    #[test]
    fn the_preset_has_the_fitted_values() {
        let (preset, fitted) =
            (MrclamSettings::from_config(&MrclamSettings::preset()), MrclamSettings::default());
        assert_eq!(MrclamSettings { camera: fitted.camera, ..preset }, fitted);
        assert!((preset.camera.bearing_std - fitted.camera.bearing_std).abs() < 1e-15);
    }
}
