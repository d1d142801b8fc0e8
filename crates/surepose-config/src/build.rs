//! Builds the core's types from a configuration, for all commands.

use std::f64::consts::PI;

use surepose::control::{
    ActuatorLimits, ActuatorModel, BrakingProfile, Controller, Deadband, Direction, Gains, HybridLaw, Law,
    Limits, MinSpeeds, Tolerance, Tran2012Law,
};
use surepose::estimation::{Belief, ConsideredParameters, DelayedEkf, Ekf, Gate, Gyroscope};
use surepose::geometry::{Angle, Body, Goal, Laser, Map, Pose};
use surepose::kinematics::{DiffDrive, WheelPair};
use surepose::lidar::ScanTiming;
use surepose::param::{self, BrakingMode, LawName, Parameter};
use surepose::safety::Footprint;
use surepose::time::Stamp;

use super::setting::polygon_from;
use super::{Config, Value, ValueSource};

/// ε_P \[m] and k_θ \[1/s] of the paper's law in a sampled loop. [Tran2012] prints neither.
///
/// ε_P is large enough for noise not to hide the switch. k_θ is small enough for the robot to drive to the middle of the disc before it has
/// turned, because the local law does not correct a lateral error.
const PAPER_CAPTURE_RADIUS: f64 = 0.02;
const PAPER_K_THETA: f64 = 2.0;

/// Offset, noise and latency of the compass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompassParameters {
    /// Standard deviation of the heading \[rad].
    pub std: f64,
    /// Reading at heading 0, along the map's x axis.
    pub offset: Angle<f64>,
    /// Latency of a reading \[s].
    pub latency: f64,
}

/// Extrinsics, noise and latency of the laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserParameters {
    /// Standard deviation of a range \[m].
    pub range_std: f64,
    /// Standard deviation of a beam direction \[rad].
    pub bearing_std: f64,
    /// Pose of the laser on the body.
    pub body_from_laser: Pose<Body, Laser, f64>,
    /// Delay between the time of a scan and its stamp \[s].
    pub latency: f64,
    /// Times of the beams as the driver states them.
    pub timing: ScanTiming,
    /// Number of beams of the simulated laser.
    pub beams: usize,
    /// Field of view of the simulated laser \[rad].
    pub field_of_view: f64,
}

/// Typical standard deviations of model errors, in the units of the keys.
const TYPICAL_MODEL_ERRORS: [(&Parameter, f64); 10] = [
    (&param::WHEEL_RADIUS_STD, 0.005),
    (&param::WHEEL_RADIUS_RATIO_STD, 0.003),
    (&param::WHEEL_SEPARATION_STD, 0.005),
    (&param::COMPASS_BIAS_STD, 1.0),
    (&param::COMPASS_LATENCY_STD, 0.01),
    (&param::LASER_POSITION_STD, 0.002),
    (&param::LASER_HEADING_STD, 0.2),
    (&param::LASER_RANGE_SCALE_STD, 0.0005),
    (&param::LASER_LATENCY_STD, 0.01),
    (&param::WALL_STD, 0.002),
];

/// Preset names of [`Config::fitted`] for gains that are not set.
const FITTED: &str = "fitted";
const PAPER: &str = "paper";
const DERIVED: &str = "derived";

impl ValueSource {
    /// Source of a derived value that is not set; `None` for a value that is set or has a default.
    pub fn follows(&self) -> Option<&'static str> {
        match self {
            Self::Preset(FITTED) => Some("fitted to the period and the wheels"),
            Self::Preset(PAPER) => Some("value of the paper"),
            Self::Preset(DERIVED) => Some("derived from the wheels"),
            _ => None,
        }
    }
}

impl Config {
    /// Wheel geometry; the radii follow from their mean and the ratio right / left.
    pub fn drive(&self) -> DiffDrive<f64> {
        let ratio = self.number(&param::WHEEL_RADIUS_RATIO);
        let left = 2.0 * self.number(&param::WHEEL_RADIUS) / (1.0 + ratio);
        DiffDrive {
            radius: WheelPair::new(ratio * left, left),
            wheel_separation: self.number(&param::WHEEL_SEPARATION),
        }
    }

    /// Fits gains that are not set to law, period and wheels, the capture radius to the law, and other derived values to the
    /// wheels.
    #[must_use]
    pub fn fitted(&self) -> Self {
        let name = match self.choice() {
            LawName::Paper => PAPER,
            LawName::Surepose => FITTED,
        };
        let is_free = |(parameter, _): &(&Parameter, f64)| self.origin(parameter) == ValueSource::Default;
        let free = |values: Vec<_>| values.into_iter().filter(is_free).collect::<Vec<_>>();
        let fitted = self.clone().with_preset(name, &free(self.fitted_values()));
        fitted.with_preset(DERIVED, &free(self.wheel_values()))
    }

    /// Returns the values of the parameters without a default of their own, as if none of them were set.
    pub(super) fn derived_values(&self) -> Vec<(&'static Parameter, f64)> {
        [self.fitted_values(), self.wheel_values()].concat()
    }

    /// Returns the values that follow from the wheels.
    fn wheel_values(&self) -> Vec<(&'static Parameter, f64)> {
        let radius = Footprint::from_drive(&self.drive()).circumscribed_radius();
        vec![
            (&param::WHEEL_DECELERATION_LIMIT, self.number(&param::WHEEL_ACCELERATION_LIMIT)),
            (&param::FOOTPRINT_RADIUS, radius),
        ]
    }

    /// Returns the values that follow from the law, the period and the wheels.
    fn fitted_values(&self) -> Vec<(&'static Parameter, f64)> {
        let (gains, radius) = match self.choice() {
            LawName::Paper => {
                (Gains { k_theta: PAPER_K_THETA, ..Gains::tran2012() }, Some(PAPER_CAPTURE_RADIUS))
            }
            LawName::Surepose => (Gains::for_loop(self.number(&param::PERIOD), &self.limits()), None),
        };
        let gains = [
            (&param::K_V, gains.k_v),
            (&param::K_ALPHA, gains.k_alpha),
            (&param::H, gains.h),
            (&param::K_THETA, gains.k_theta),
        ];
        gains.into_iter().chain(radius.map(|radius| (&param::CAPTURE_RADIUS, radius))).collect()
    }

    /// Returns the gains of the control law.
    pub fn gains(&self) -> Gains<f64> {
        let fitted = self.fitted();
        Gains {
            k_v: fitted.number(&param::K_V),
            k_alpha: fitted.number(&param::K_ALPHA),
            h: fitted.number(&param::H),
            k_theta: fitted.number(&param::K_THETA),
        }
    }

    /// Drive direction.
    pub fn direction(&self) -> Direction {
        self.choice()
    }

    /// Returns the control law.
    pub fn law(&self) -> Law<f64> {
        let (gains, capture_radius) = (self.gains(), self.fitted().number(&param::CAPTURE_RADIUS));
        let (noise, period) = (self.number(&param::POSITION_NOISE), self.number(&param::PERIOD));
        match self.choice() {
            LawName::Paper => Law::Tran2012(Tran2012Law { gains, capture_radius, capture_heading: PI }),
            LawName::Surepose => Law::Hybrid(HybridLaw {
                gains,
                capture_radius,
                direction: self.direction(),
                actuator_limits: ActuatorLimits::from_limits(&self.drive(), &self.limits(), period),
                deadband: (noise > 0.0).then(|| Deadband::from_noise(noise, period)),
            }),
        }
    }

    /// Braking profile that reduces the gains to the wheel limits; `None` uses the gains as they are.
    pub fn braking(&self) -> Option<BrakingProfile<f64>> {
        let is_set = |gain| matches!(self.origin(gain), ValueSource::File { .. } | ValueSource::CommandLine);
        let evenly = match (self.choice(), self.choice()) {
            (BrakingMode::Even, _) => true,
            (BrakingMode::Gains, _) | (BrakingMode::Auto, LawName::Paper) => false,
            (BrakingMode::Auto, LawName::Surepose) => !is_set(&param::K_V) && !is_set(&param::K_ALPHA),
        };
        if evenly {
            BrakingProfile::from_limits_if_needed(&self.drive(), &self.limits(), &self.gains())
        } else {
            None
        }
    }

    /// Wheel limits.
    pub fn limits(&self) -> Limits<f64> {
        let wheel_acceleration = self.number(&param::WHEEL_ACCELERATION_LIMIT);
        let wheel_deceleration = match self.origin(&param::WHEEL_DECELERATION_LIMIT) {
            ValueSource::Default => wheel_acceleration,
            _ => self.number(&param::WHEEL_DECELERATION_LIMIT),
        };
        Limits { wheel_speed: self.number(&param::WHEEL_SPEED_LIMIT), wheel_acceleration, wheel_deceleration }
    }

    /// Returns the outline of the robot.
    pub fn footprint(&self) -> Footprint<f64> {
        if let Value::Polygon(points) = self.value(&param::FOOTPRINT)
            && let Ok(polygon) = polygon_from(&points)
        {
            return Footprint::Polygon(polygon);
        }
        match self.origin(&param::FOOTPRINT_RADIUS) {
            ValueSource::Default => Footprint::from_drive(&self.drive()),
            _ => Footprint::Circle(self.number(&param::FOOTPRINT_RADIUS)),
        }
    }

    /// Minimum speeds, dead time and lag of the base.
    pub fn actuator(&self) -> ActuatorModel<f64> {
        ActuatorModel {
            min_speeds: MinSpeeds {
                wheel: self.number(&param::MIN_WHEEL_SPEED),
                v: self.number(&param::MIN_SPEED),
                omega: self.number(&param::MIN_TURN_RATE),
            },
            delay: self.number(&param::COMMAND_DELAY),
            time_constant: self.number(&param::MOTOR_TIME_CONSTANT),
        }
    }

    /// Controller.
    pub fn controller(&self) -> Controller<f64> {
        Controller {
            drive: self.drive(),
            law: self.law(),
            braking: self.braking(),
            limits: self.limits(),
            tolerance: Tolerance {
                position: self.number(&param::POSITION_TOLERANCE),
                heading: self.number(&param::HEADING_TOLERANCE),
                dwell: self.number(&param::HOLD),
                hysteresis: self.number(&param::TOLERANCE_RELEASE),
            },
            period: self.number(&param::PERIOD),
        }
    }

    /// Constants of the filter.
    pub fn ekf(&self) -> Ekf<f64> {
        Ekf { drive: self.drive(), delta: self.number(&param::DELTA), integration: self.choice() }
    }

    /// Returns the χ² gate.
    pub fn gate(&self) -> Gate<f64> {
        Gate::new(self.number(&param::GATE_PROBABILITY))
    }

    /// Delayed-state filter, starting at `stamp` with `belief`.
    pub fn estimator<const N: usize>(&self, stamp: Stamp, belief: Belief<f64>) -> DelayedEkf<f64, N> {
        let history = self.number(&param::HISTORY);
        DelayedEkf::new(self.ekf(), self.gate(), history, stamp, belief)
            .with_gyroscope(self.gyroscope())
            .with_considered(&self.considered())
    }

    /// Returns the standard deviations of the constant model errors that the filter considers.
    pub fn considered(&self) -> ConsideredParameters<f64> {
        ConsideredParameters {
            compass_bias: self.number(&param::COMPASS_BIAS_STD),
            compass_delay: self.number(&param::COMPASS_LATENCY_STD),
            laser_position: self.number(&param::LASER_POSITION_STD),
            laser_heading: self.number(&param::LASER_HEADING_STD),
            range_scale: self.number(&param::LASER_RANGE_SCALE_STD),
            laser_delay: self.number(&param::LASER_LATENCY_STD),
            radius_scale: self.number(&param::WHEEL_RADIUS_STD),
            radius_difference: self.number(&param::WHEEL_RADIUS_RATIO_STD),
            separation_scale: self.number(&param::WHEEL_SEPARATION_STD),
            wall: self.number(&param::WALL_STD),
        }
    }

    /// Returns the configuration with typical deviations of the model errors that the filter considers, unless they are set.
    #[must_use]
    pub fn with_typical_model_errors(self) -> Self {
        let unset: Vec<_> = TYPICAL_MODEL_ERRORS
            .into_iter()
            .filter(|(parameter, _)| self.origin(parameter) == ValueSource::Default)
            .collect();
        self.with_preset("typical model errors", &unset)
    }

    /// Noise of the gyroscope.
    pub fn gyroscope(&self) -> Gyroscope<f64> {
        Gyroscope {
            std: self.number(&param::GYROSCOPE_STD),
            bias_std: self.number(&param::GYROSCOPE_BIAS_STD),
            bias_walk: self.number(&param::GYROSCOPE_BIAS_WALK),
        }
    }

    /// Returns the parameters of the compass.
    pub fn compass(&self) -> CompassParameters {
        CompassParameters {
            std: self.number(&param::COMPASS_STD),
            offset: Angle::from_radians(self.number(&param::COMPASS_OFFSET)),
            latency: self.number(&param::COMPASS_LATENCY),
        }
    }

    /// Returns the parameters of the laser.
    pub fn laser(&self) -> LaserParameters {
        let heading = Angle::from_radians(self.number(&param::LASER_HEADING));
        LaserParameters {
            range_std: self.number(&param::LASER_RANGE_STD),
            bearing_std: self.number(&param::LASER_BEARING_STD),
            body_from_laser: Pose::new(self.number(&param::LASER_X), self.number(&param::LASER_Y), heading),
            latency: self.number(&param::LASER_LATENCY),
            timing: self.scan_timing(),
            field_of_view: self.number(&param::LASER_FIELD_OF_VIEW),
            beams: self.number(&param::LASER_BEAMS) as usize,
        }
    }

    /// Times of the beams as the driver of the laser states them.
    fn scan_timing(&self) -> ScanTiming {
        let is_set = self.origin(&param::LASER_SWEEP) != ValueSource::Default;
        ScanTiming { sweep: is_set.then(|| self.number(&param::LASER_SWEEP)), stamped: self.choice() }
    }

    /// Start pose.
    pub fn start(&self) -> Pose<Map, Body, f64> {
        let heading = Angle::from_radians(self.number(&param::START_HEADING));
        Pose::new(self.number(&param::START_X), self.number(&param::START_Y), heading)
    }

    /// Goal pose.
    pub fn goal(&self) -> Pose<Map, Goal, f64> {
        let heading = Angle::from_radians(self.number(&param::GOAL_HEADING));
        Pose::new(self.number(&param::GOAL_X), self.number(&param::GOAL_Y), heading)
    }
}
