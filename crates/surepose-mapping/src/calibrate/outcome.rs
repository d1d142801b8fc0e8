//! Result of a calibration: values with standard errors, as JSON and as a configuration.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use nalgebra::DMatrix;
use serde::Serialize;
use surepose::kinematics::WheelPair;
use surepose::lidar::StampedBeam;
use surepose::param::{self, Choice, Kind, Parameter, Unit};

use super::parameter::{COUNT, CalibrationParameter, Geometry};

/// One parameter, in display units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ParameterEstimate {
    /// The value; `None` if the motion did not excite it.
    pub value: Option<f64>,
    /// Standard error; the value ± 1.96 standard errors is a 95 % interval.
    pub std_error: Option<f64>,
    /// Unit of both; empty for dimensionless parameters.
    pub unit: &'static str,
    /// Motion that would excite the parameter; `None` if it is excited.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_excited: Option<&'static str>,
}

/// Parameters of the base, with their keys in the configuration.
pub(super) type ActuatorEstimates = Vec<(&'static Parameter, ParameterEstimate)>;

/// Result of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    geometry: Geometry<f64>,
    covariance: DMatrix<f64>,
    nominal: Geometry<f64>,
    delta: f64,
    log_delta_std: f64,
    knows_heading: bool,
    /// Duration of the sweep \[s]; `None` where the latency of the laser is relative to its middle beam.
    sweep: Option<f64>,
    /// Variance of the walls over the variance expected from beams and walls: 1 if both noise levels are as
    /// stated.
    pub wall_scatter: f64,
    /// Parameters of the base; empty without commands.
    actuator: ActuatorEstimates,
    /// Number of scans used.
    pub scans: usize,
    /// Number of line observations.
    pub line_observations: usize,
}

impl Calibration {
    #[allow(clippy::too_many_arguments, reason = "called once; each argument is one field")]
    pub(super) fn new(
        geometry: Geometry<f64>,
        covariance: DMatrix<f64>,
        nominal: Geometry<f64>,
        (delta, log_delta_std): (f64, f64),
        knows_heading: bool,
        sweep: Option<f64>,
        wall_scatter: f64,
        (scans, line_observations): (usize, usize),
    ) -> Self {
        Self {
            geometry,
            covariance,
            nominal,
            delta,
            log_delta_std,
            knows_heading,
            sweep,
            wall_scatter,
            actuator: ActuatorEstimates::new(),
            scans,
            line_observations,
        }
    }

    pub(super) fn with_actuator(self, actuator: ActuatorEstimates) -> Self {
        Self { actuator, ..self }
    }

    /// Returns the estimate of a geometry parameter.
    pub fn estimate(&self, parameter: CalibrationParameter) -> ParameterEstimate {
        let i = parameter as usize;
        let unit = parameter.unit();
        let std = self.covariance[(i, i)].sqrt();
        let known = parameter != CalibrationParameter::CompassOffset || self.knows_heading;
        if known && parameter.is_excited(std, &self.nominal) {
            estimate(self.geometry.0[i] - self.stamp_offset(parameter), std, unit)
        } else {
            not_excited(unit, parameter.excitation())
        }
    }

    /// Returns the beam that the driver stamps: the nearest one, if the sweep and the latency are known.
    ///
    /// The latency of the laser is relative to this beam, and thus at most a quarter of the sweep, unless the stamp is
    /// earlier than the first beam or later than the last.
    pub fn laser_stamp(&self) -> Option<StampedBeam> {
        let latency = CalibrationParameter::LaserLatency;
        let std = self.covariance[(latency as usize, latency as usize)].sqrt();
        let sweep = self.sweep.filter(|_| latency.is_excited(std, &self.nominal))?;
        let late = self.geometry.get(latency);
        let off = |beam: &StampedBeam| (late - (beam.fraction() - 0.5) * sweep).abs();
        StampedBeam::ALL.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// Returns the time from the middle beam to the stamped one \[s], for the latency of the laser; 0 for other parameters.
    fn stamp_offset(&self, parameter: CalibrationParameter) -> f64 {
        let stamped = self.laser_stamp().filter(|_| parameter == CalibrationParameter::LaserLatency);
        stamped.zip(self.sweep).map_or(0.0, |(beam, sweep)| (beam.fraction() - 0.5) * sweep)
    }

    /// Returns the mean radius of the two wheels.
    pub fn wheel_radius(&self) -> ParameterEstimate {
        let WheelPair { right, left } = self.geometry.drive().radius;
        self.radius_function(0.5 * (right + left), WheelPair::new(0.5, 0.5), Unit::Meter)
    }

    /// Returns the ratio of right to left wheel radius; not 1 if equal wheel speeds drive a circle.
    pub fn wheel_radius_ratio(&self) -> ParameterEstimate {
        let WheelPair { right, left } = self.geometry.drive().radius;
        let ratio = right / left;
        self.radius_function(ratio, WheelPair::new(1.0 / left, -ratio / left), Unit::One)
    }

    /// Estimates a function of both radii from its `value` and its derivative by each; not excited if a
    /// radius is not.
    fn radius_function(&self, value: f64, slope: WheelPair<f64>, unit: Unit) -> ParameterEstimate {
        let (l, r) = (CalibrationParameter::LeftWheelRadius, CalibrationParameter::RightWheelRadius);
        if self.estimate(l).value.is_none() || self.estimate(r).value.is_none() {
            return not_excited(unit, l.excitation());
        }
        let (i, j) = (l as usize, r as usize);
        let c = &self.covariance;
        let own = slope.left * slope.left * c[(i, i)] + slope.right * slope.right * c[(j, j)];
        let variance = own + 2.0 * slope.left * slope.right * c[(i, j)];
        estimate(value, variance.max(0.0).sqrt(), unit)
    }

    /// Returns δ of [Tran2012] Eq. (15), for the sampling period of the wheel counters.
    pub fn delta(&self) -> ParameterEstimate {
        if self.log_delta_std <= 1.0 {
            estimate(self.delta, self.delta * self.log_delta_std, Unit::One)
        } else {
            not_excited(Unit::One, "driving in sight of walls")
        }
    }

    /// Returns every parameter by its name in the command line's JSON.
    pub fn parameters(&self) -> BTreeMap<&'static str, ParameterEstimate> {
        let geometry =
            CalibrationParameter::ALL.iter().map(|parameter| (parameter.name(), self.estimate(*parameter)));
        let more = [
            ("wheel_radius_m", self.wheel_radius()),
            ("wheel_radius_ratio", self.wheel_radius_ratio()),
            ("delta", self.delta()),
        ];
        let actuator = self.actuator.iter().map(|(parameter, estimate)| (parameter.key, *estimate));
        geometry.chain(more).chain(actuator).collect()
    }

    /// Formats the estimates as a configuration; parameters that are not excited become comments.
    pub fn configuration(&self) -> String {
        let mut found = vec![
            (&param::WHEEL_RADIUS, self.wheel_radius()),
            (&param::WHEEL_RADIUS_RATIO, self.wheel_radius_ratio()),
            (&param::DELTA, self.delta()),
        ];
        let keyed = |parameter: &CalibrationParameter| Some((parameter.key()?, self.estimate(*parameter)));
        found.extend(self.actuator.iter().copied());
        found.extend(CalibrationParameter::ALL.iter().filter_map(keyed));
        // In the order of the parameter table, so that each section appears once.
        found.sort_by_key(|(key, _)| param::ALL.iter().position(|other| other == *key));
        let mut text = String::new();
        let mut section = "";
        for (key, estimate) in found {
            if key.section != section {
                let gap = if section.is_empty() { "" } else { "\n" };
                section = key.section;
                let _ = writeln!(text, "{gap}[{section}]");
            }
            if let (Some(value), Some(std), Kind::Number { range, .. }) =
                (estimate.value, estimate.std_error, key.kind)
            {
                let (value, std) = rounded(value, std);
                let remark = if range.contains(value) { "" } else { "# out of range: " };
                let _ = writeln!(text, "{remark}{} = {value} # ± {std}", key.key);
            } else {
                let what = estimate.not_excited.unwrap_or("unknown");
                let _ = writeln!(text, "# {}: not excited; it takes {what}", key.key);
            }
            if let (Some(stamped), true) = (self.laser_stamp(), key == &param::LASER_LATENCY) {
                let _ = writeln!(text, "{} = \"{}\"", param::LASER_STAMP.key, stamped.name());
            }
        }
        text
    }
}

/// The fitted geometry, including parameters that are not excited.
impl AsRef<[f64; COUNT]> for Calibration {
    fn as_ref(&self) -> &[f64; COUNT] {
        &self.geometry.0
    }
}

fn estimate(value: f64, std: f64, unit: Unit) -> ParameterEstimate {
    let per = 1.0 / unit.to_si();
    ParameterEstimate {
        value: Some(value * per),
        std_error: Some(std * per),
        unit: unit.symbol(),
        not_excited: None,
    }
}

fn not_excited(unit: Unit, excitation: &'static str) -> ParameterEstimate {
    ParameterEstimate { value: None, std_error: None, unit: unit.symbol(), not_excited: Some(excitation) }
}

/// Rounds a value to the second digit of its standard error, and returns both.
fn rounded(value: f64, std: f64) -> (f64, f64) {
    let digits = if std > 0.0 { (1.0 - std.log10().floor()).clamp(0.0, 12.0) } else { 12.0 };
    let scale = 10.0_f64.powf(digits);
    ((value * scale).round() / scale, (std * scale).round() / scale)
}
