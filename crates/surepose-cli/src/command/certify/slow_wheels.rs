//! Drives of the shipped controller with its limit of the acceleration, which the proof does not cover.

use serde::Serialize;
use serde_json::{Map, Value as Json, json};
use surepose_cert::{
    ActuatorErrors, AdversarialDrive, AdversarySearch, Certificate, NoiseBounds, WorstDrives,
};
use surepose_config::Config;

use crate::error::CliError;
use crate::output_dir::OutputDir;

/// Number of control periods simulated, about 2 s of computation.
const TICKS: u64 = 3_000_000;

const REASON: &str = "acceleration: a drive of the shipped controller leaves the bounds that hold for wheels that follow at once; raise \
                      robot.wheel_acceleration_limit_m_s2 where the robot allows it, or reduce the noise bounds";

/// Keys of the figures that hold for wheels that follow at once only.
const BOUNDS: [&str; 11] = [
    "capture_radius_m",
    "decrease_rate_per_s",
    "time_bound_s",
    "max_period_s",
    "final_heading_bound_deg",
    "heading_length_m",
    "final_position_bound_m",
    "reached_position_bound_m",
    "reached_heading_bound_deg",
    "switch_keeps_its_mind",
    "switch_dwell_ticks",
];

/// Searched drives, and the certificate that they are compared with.
pub(super) struct SlowWheels<'a> {
    config: &'a Config,
    certificate: &'a Certificate,
    worst: WorstDrives,
}

impl<'a> SlowWheels<'a> {
    /// Searches a drive that leaves the bounds.
    ///
    /// `None`: refused anyway, the wheels reverse within one period, or the base has a lag or a delay that is no multiple of the period.
    pub(super) fn search(
        config: &'a Config,
        sensed: NoiseBounds,
        actuators: ActuatorErrors,
        certificate: &'a Certificate,
    ) -> Option<Self> {
        let controller = config.controller();
        let limits = controller.limits;
        let weaker = limits.wheel_acceleration.min(limits.wheel_deceleration);
        if weaker * controller.period >= 2.0 * limits.wheel_speed {
            return None;
        }
        let late = actuators.delay / controller.period;
        if actuators.model.time_constant > 0.0 || (late - late.round()).abs() > 1e-6 {
            return None;
        }
        let search = AdversarySearch {
            controller: &controller,
            actuators,
            noise: sensed,
            capture_radius: certificate.capture_radius?,
            final_position_bound: certificate.final_position_bound.unwrap_or(f64::INFINITY),
            time_bound: certificate.time_bound?,
            ticks: TICKS,
        };
        Some(Self { config, certificate, worst: search.run() })
    }

    /// Whether no drive was found that leaves the bounds.
    pub(super) fn is_kept(&self) -> bool {
        self.worst.violation.is_none()
    }

    /// Adds the worst distances; a drive that leaves the bounds turns the verdict, and replaces them.
    pub(super) fn add_to(&self, json: &mut Map<String, Json>) {
        if let Some(drive) = &self.worst.violation {
            for key in BOUNDS {
                json.shift_remove(key);
            }
            json.insert("certified".to_owned(), json!(false));
            json.insert("reason".to_owned(), json!(REASON));
            json.insert("counterexample_drive".to_owned(), json!(self.farthest(drive)));
        }
        json.insert("searched_kept_out_m".to_owned(), json!(self.worst.kept_out));
        json.insert("searched_final_position_m".to_owned(), json!(self.worst.farthest));
    }

    /// Writes the drive that leaves the bounds, one row per period.
    pub(super) fn write(&self, folder: &OutputDir) -> Result<(), CliError> {
        let Some(drive) = &self.worst.violation else { return Ok(()) };
        let rows = drive.samples(&self.config.controller()).into_iter().map(|sample| Row {
            time_s: sample.time,
            x_m: sample.pose[0],
            y_m: sample.pose[1],
            heading_deg: sample.pose[2].to_degrees(),
            estimated_x_m: sample.estimate[0],
            estimated_y_m: sample.estimate[1],
            estimated_heading_deg: sample.estimate[2].to_degrees(),
            distance_m: sample.distance,
        });
        folder.table("counterexample_drive.csv", rows)
    }

    /// Start of the drive, and the time and distance after the capture at which it is farthest from the goal; both are `None` without
    /// a capture.
    fn farthest(&self, drive: &AdversarialDrive) -> DriveSummary {
        let radius = self.certificate.capture_radius.unwrap_or(0.0);
        let samples = drive.samples(&self.config.controller());
        let after = samples.iter().skip_while(|sample| sample.distance >= radius);
        let far = after.max_by(|one, other| one.distance.total_cmp(&other.distance));
        let [x, y, heading] = drive.start;
        DriveSummary {
            start_x_m: x,
            start_y_m: y,
            start_heading_deg: heading.to_degrees(),
            time_s: far.map(|sample| sample.time),
            distance_m: far.map(|sample| sample.distance),
            bound_m: self.certificate.final_position_bound,
        }
    }
}

/// Describes the value of `counterexample_drive` in a sentence.
pub(super) fn described(drive: &Json) -> String {
    let number = |key: &str| drive[key].as_f64().unwrap_or(0.0);
    let [x, y, heading] = ["start_x_m", "start_y_m", "start_heading_deg"].map(number);
    let fate = match drive["distance_m"].as_f64() {
        Some(distance) => format!("{distance:.4} m from the goal after {:.1} s", number("time_s")),
        None => "outside of the capture radius at the time bound".to_owned(),
    };
    format!("from {x:.3} m, {y:.3} m, {heading:.1}°: {fate}; its first minute is in --out")
}

#[derive(Serialize)]
struct DriveSummary {
    start_x_m: f64,
    start_y_m: f64,
    start_heading_deg: f64,
    time_s: Option<f64>,
    distance_m: Option<f64>,
    bound_m: Option<f64>,
}

#[derive(Serialize)]
struct Row {
    time_s: f64,
    x_m: f64,
    y_m: f64,
    heading_deg: f64,
    estimated_x_m: f64,
    estimated_y_m: f64,
    estimated_heading_deg: f64,
    distance_m: f64,
}
