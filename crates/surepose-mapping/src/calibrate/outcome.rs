//! What calibration found: values with standard errors, as JSON and as a configuration.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use nalgebra::DMatrix;
use serde::Serialize;
use surepose::kinematics::WheelPair;
use surepose::param::{self, Kind, Unit};

use super::parameter::{COUNT, CalibrationParameter, Geometry};

/// One parameter, in the unit of the edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ParameterEstimate {
    /// The value; absent where the motion did not excite it.
    pub value: Option<f64>,
    /// Its standard error: ± 1.96 of it is an interval of 95 %.
    pub std_error: Option<f64>,
    /// The unit of both; empty for a number.
    pub unit: &'static str,
    /// What motion it would take, where the recording does not tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_excited: Option<&'static str>,
}

/// What calibration found.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    geometry: Geometry<f64>,
    covariance: DMatrix<f64>,
    nominal: Geometry<f64>,
    delta: f64,
    log_delta_std: f64,
    knows_heading: bool,
    /// Scatter of the walls over that of the laser's beams and of the walls' own: 1 where both are as stated.
    pub wall_scatter: f64,
    /// How many scans were used.
    pub scans: usize,
    /// How many stretches of wall were seen in them.
    pub line_observations: usize,
}

impl Calibration {
    #[allow(clippy::too_many_arguments, reason = "one call, and each is one field")]
    pub(super) fn new(
        geometry: Geometry<f64>,
        covariance: DMatrix<f64>,
        nominal: Geometry<f64>,
        (delta, log_delta_std): (f64, f64),
        knows_heading: bool,
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
            wall_scatter,
            scans,
            line_observations,
        }
    }

    /// A parameter of the geometry.
    pub fn estimate(&self, parameter: CalibrationParameter) -> ParameterEstimate {
        let i = parameter as usize;
        let unit = parameter.unit();
        let std = self.covariance[(i, i)].sqrt();
        let known = parameter != CalibrationParameter::CompassOffset || self.knows_heading;
        if known && parameter.is_excited(std, &self.nominal) {
            estimate(self.geometry.0[i], std, unit)
        } else {
            not_excited(unit, parameter.excitation())
        }
    }

    /// The mean radius of the two wheels.
    pub fn wheel_radius(&self) -> ParameterEstimate {
        let WheelPair { right, left } = self.geometry.drive().radius;
        self.from_radii(0.5 * (right + left), WheelPair::new(0.5, 0.5), Unit::Meter)
    }

    /// The radius of the right wheel over that of the left one: off 1, a robot that takes them for equal drives circles.
    pub fn wheel_radius_ratio(&self) -> ParameterEstimate {
        let WheelPair { right, left } = self.geometry.drive().radius;
        let ratio = right / left;
        self.from_radii(ratio, WheelPair::new(1.0 / left, -ratio / left), Unit::One)
    }

    /// A function of both radii with this `value` and this derivative by each, where both are known.
    fn from_radii(&self, value: f64, slope: WheelPair<f64>, unit: Unit) -> ParameterEstimate {
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

    /// δ of [Tran2012] Eq. (15), for the period of the recording's wheel counters.
    pub fn delta(&self) -> ParameterEstimate {
        if self.log_delta_std <= 1.0 {
            estimate(self.delta, self.delta * self.log_delta_std, Unit::One)
        } else {
            not_excited(Unit::One, "driving in sight of walls")
        }
    }

    /// Every parameter by its name, as the command line's JSON has them.
    pub fn parameters(&self) -> BTreeMap<&'static str, ParameterEstimate> {
        let geometry =
            CalibrationParameter::ALL.iter().map(|parameter| (parameter.name(), self.estimate(*parameter)));
        let more = [
            ("wheel_radius_m", self.wheel_radius()),
            ("wheel_radius_ratio", self.wheel_radius_ratio()),
            ("delta", self.delta()),
        ];
        geometry.chain(more).collect()
    }

    /// What was found, as the lines of a configuration; what was not, as remarks.
    pub fn configuration(&self) -> String {
        let mut found = vec![
            (&param::WHEEL_RADIUS, self.wheel_radius()),
            (&param::WHEEL_RADIUS_RATIO, self.wheel_radius_ratio()),
            (&param::DELTA, self.delta()),
        ];
        let keyed = |parameter: &CalibrationParameter| Some((parameter.key()?, self.estimate(*parameter)));
        found.extend(CalibrationParameter::ALL.iter().filter_map(keyed));
        // In the order of the table, so that each section comes once.
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
        }
        text
    }
}

/// The geometry as it was fitted, excited or not.
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

/// A value to the second digit of its standard error, and that error.
fn rounded(value: f64, std: f64) -> (f64, f64) {
    let digits = if std > 0.0 { (1.0 - std.log10().floor()).clamp(0.0, 12.0) } else { 12.0 };
    let scale = 10.0_f64.powf(digits);
    ((value * scale).round() / scale, (std * scale).round() / scale)
}
