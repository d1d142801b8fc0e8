//! Corrects wheel odometry by a position sensor: ultra-wideband beacons, GNSS or an overhead camera.
//!
//! Any sensor whose reading is a heading, a line, a landmark, a position or a pose enters the filter as a
//! [`Measurement`]. The caller states its noise; the filter gates it and puts it where it belongs in time. Here the
//! position arrives 0.2 s late at 5 Hz, and every tenth reading is a reflection that is 3 m off.
//!
//! ```text
//! cargo run --release -p surepose --example custom_sensor
//! ```

use std::process::ExitCode;

use surepose::estimation::{
    Belief, DelayedEkf, Ekf, Gate, Measurement, PositionMeasurement, RejectReason, WheelOdometry,
};
use surepose::geometry::{Body, Map, Point, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist, WheelPair};
use surepose::lidar::ScanProcessor;
use surepose::localization::{Localizer, Odometry, SensorInput, SensorReading};
use surepose::map::MapView;
use surepose::time::{Stamp, Stamped};

/// Time between two steps \[s].
const PERIOD: f64 = 0.02;
/// Steps of the drive: two circles.
const STEPS: usize = 3000;
/// Steps between two positions, and steps by which a position is late.
const INTERVAL: usize = 10;
const DELAY: usize = 10;
/// Standard deviation of the position in x and in y \[m].
const POSITION_STD: f64 = 0.05;
/// The encoder of the right wheel reports this part of the travel: its tire is worn.
const WORN_TIRE: f64 = 0.99;

pub(crate) fn main() -> ExitCode {
    let drive = DiffDrive::new(0.05, 0.4);
    let mut with_sensor = localizer(drive);
    let mut by_odometry = localizer(drive);

    let twist = Twist::new(0.3, 0.21);
    let rolled = drive.wheel_speeds_from_twist(twist).scaled(PERIOD);
    let reported = WheelPair::new(rolled.right * WORN_TIRE, rolled.left);
    let mut truth = vec![Pose::<Map, Body, f64>::identity()];
    let mut noise = Noise(1);

    for step in 1..=STEPS {
        let stamp = stamp_of(step);
        truth.push(truth[step - 1].integrate(twist.integrate_for(PERIOD), Integration::Arc));

        // A position that was measured `DELAY` steps ago arrives now, with the stamp of its measurement.
        let arrived = (step > DELAY && step % INTERVAL == 0).then(|| {
            let measured_at = step - DELAY;
            let reflection = if step % (10 * INTERVAL) == 0 { 3.0 } else { 0.0 };
            let position = Point::new(
                truth[measured_at].x + POSITION_STD * noise.draw() + reflection,
                truth[measured_at].y + POSITION_STD * noise.draw(),
            );
            let variance = POSITION_STD * POSITION_STD;
            let measurement =
                PositionMeasurement { position, x_variance: variance, y_variance: variance, covariance: 0.0 };
            let reading = SensorReading::Measurement(Measurement::Position(measurement));
            Stamped::new(stamp_of(measured_at), reading)
        });

        // The command replaces odometry that is missing. Here none is missing.
        let commanded = WheelOdometry::from_command(rolled);
        let odometry = Odometry::WheelTravel(reported);
        let readings = arrived.as_slice();
        let input = SensorInput { stamp, odometry, readings };
        with_sensor.update(&input, commanded, &MapView::empty(), &mut ());
        by_odometry.update(&SensorInput { readings: &[], ..input }, commanded, &MapView::empty(), &mut ());

        if step % 500 == 0 {
            println!(
                "{:4.0} s  error with the sensor {:.3} m, by odometry alone {:.3} m",
                stamp.seconds(),
                distance(&with_sensor.belief(), truth[step]),
                distance(&by_odometry.belief(), truth[step]),
            );
        }
    }

    let statistics = with_sensor.measurement_stats();
    let outliers = statistics.rejected(RejectReason::Outlier);
    println!("{} positions accepted, {outliers} rejected as outliers", statistics.accepted);
    let end = truth[STEPS];
    let is_good = distance(&with_sensor.belief(), end) < 0.15 && distance(&by_odometry.belief(), end) > 0.3;
    if is_good && outliers >= 25 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Localizer without a laser and without supervision, at the origin.
fn localizer(drive: DiffDrive<f64>) -> Localizer<f64, 64, 0, 1, 1> {
    let ekf = Ekf { drive, delta: 0.0025, integration: Integration::Arc };
    let belief = Belief::new(Pose::identity(), [0.02, 0.02, 0.02]);
    // The history of 1 s covers the delay of the sensor.
    let filter = DelayedEkf::new(ekf, Gate::new(0.999), 1.0, stamp_of(0), belief);
    Localizer::unsupervised(filter, ScanProcessor::disabled())
}

fn stamp_of(step: usize) -> Stamp {
    Stamp::from_seconds(step as f64 * PERIOD)
}

fn distance(belief: &Belief<f64>, truth: Pose<Map, Body, f64>) -> f64 {
    belief.pose.origin().distance(truth.origin())
}

/// Uniform noise of mean 0 and variance 1: [Marsaglia2003].
struct Noise(u32);

impl Noise {
    fn draw(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        (f64::from(self.0) / f64::from(u32::MAX) - 0.5) * 12_f64.sqrt()
    }
}
