//! The bench: the robot, its limits and its noise. All of them are given, so that laws can be compared.

use std::f64::consts::PI;

use surepose::{Angle, Direction, Drive, Float, HybridLaw, Law, Limits, Wheels};
use surepose_sim::Stream;

use super::{Start, Sweep};

/// The robot's geometry.
pub const DRIVE: Drive<f64> = Drive { wheel_radius: 0.05, track: 0.6 };

/// Largest speed of a wheel's rim \[m/s].
const WHEEL_SPEED: f64 = 0.3;

/// Half the side of the square of random starts \[m].
const REACH: f64 = 3.0;

/// What is wrong with what the law sees and with what the wheels do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Standard deviation of the estimated x and y \[m], white.
    pub position: f64,
    /// Standard deviation of the estimated heading \[rad], white.
    pub heading: f64,
    /// Standard deviation of a wheel's speed over that speed, white.
    pub wheels: f64,
}

impl Noise {
    /// None at all.
    pub const NONE: Self = Self { position: 0.0, heading: 0.0, wheels: 0.0 };
    /// The bench's.
    pub const BENCH: Self = Self { position: 0.005, heading: 0.3 * PI / 180.0, wheels: 0.05 };
}

/// What the bench's wheels can do: no acceleration limit.
pub fn limits() -> Limits<f64> {
    Limits { wheel_speed: WHEEL_SPEED, wheel_acceleration: f64::INFINITY }
}

/// The default law for the bench's robot.
pub fn fitted_law(period: f64, direction: Direction) -> Law<f64> {
    Law::Hybrid(HybridLaw::fitted(&DRIVE, &limits(), period, direction))
}

/// A start pose of the bench trial.
pub(super) fn random_start(stream: &mut Stream) -> Start {
    let (x, y) = (stream.uniform(-REACH, REACH), stream.uniform(-REACH, REACH));
    Start::new(x, y, Angle::wrapped(stream.uniform(-PI, PI)))
}

/// The constants of a trial in the loop's own numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bench<S> {
    pub(super) law: Law<S>,
    pub(super) drive: Drive<S>,
    pub(super) limits: Limits<S>,
    pub(super) period: S,
    pub(super) noise: Noise,
}

/// One tick's noise: what the estimate is off by, and each wheel's speed over what was asked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disturbance<S> {
    pub(super) x: S,
    pub(super) y: S,
    pub(super) heading: S,
    pub(super) wheels: Wheels<S>,
}

impl<S: Float> Bench<S> {
    pub(super) fn new(sweep: &Sweep) -> Self {
        Self {
            law: sweep.law.cast(),
            drive: Drive { wheel_radius: S::of(DRIVE.wheel_radius), track: S::of(DRIVE.track) },
            limits: Limits { wheel_speed: S::of(WHEEL_SPEED), wheel_acceleration: S::of(f64::INFINITY) },
            period: S::of(sweep.period),
            noise: sweep.noise,
        }
    }

    /// The next tick's noise. Without noise nothing is drawn.
    pub(super) fn disturbance(&self, stream: &mut Stream) -> Disturbance<S> {
        let mut draw = |std: f64| if std > 0.0 { S::of(std * stream.normal()) } else { S::of(0.0) };
        let Noise { position, heading, wheels } = self.noise;
        let one = S::of(1.0);
        Disturbance {
            x: draw(position),
            y: draw(position),
            heading: draw(heading),
            wheels: Wheels::new(one + draw(wheels), one + draw(wheels)),
        }
    }
}
