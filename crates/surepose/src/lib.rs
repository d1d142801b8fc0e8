//! State estimation and pose stabilization of differential-drive robots.
//!
//! The core of Surepose implements the system of [Tran2012], with its misprints corrected: an extended Kalman filter, a laser
//! that corrects it, a control law that drives to a pose, and the supervision of all three. It is `no_std`, allocates nothing,
//! does no I/O, reads no clock and contains no unsafe code. A robot parks:
//!
//! ```
//! use surepose::control::{Controller, Direction, Limits, Tolerance};
//! use surepose::estimation::{Belief, DelayedEkf, Ekf, Gate};
//! use surepose::geometry::{Angle, Goal, Map, Point, Pose};
//! use surepose::kinematics::{DiffDrive, Integration, Twist, WheelPair};
//! use surepose::lidar::ScanProcessor;
//! use surepose::localization::{Localizer, Odometry, SensorInput};
//! use surepose::map::{MapView, Wall};
//! use surepose::navigator::{GoalResult, Navigator, NavigatorConfig};
//! use surepose::safety::Footprint;
//! use surepose::time::Stamp;
//!
//! // The robot: wheel radius 0.05 m, wheel separation 0.4 m, and the limits of its wheels.
//! let (drive, period) = (DiffDrive::new(0.05, 0.4), 0.02);
//! let limits = Limits::symmetric(0.5, 1.0);
//! let tolerance = Tolerance { position: 0.01, heading: 0.02, dwell: 0.5, hysteresis: 1.5 };
//! let controller = Controller::fitted(drive, limits, period, Direction::Auto, tolerance);
//!
//! // The filter starts at the origin. This robot has no laser and no supervisor.
//! let ekf = Ekf { drive, delta: 0.0025, integration: Integration::Arc };
//! let belief = Belief::new(Pose::identity(), [0.01, 0.01, 0.01]);
//! let filter = DelayedEkf::<f64, 64>::new(ekf, Gate::new(0.999), 1.0, Stamp::from_seconds(0.0), belief);
//! let localizer = Localizer::<f64, 64, 0, 1, 1>::unsupervised(filter, ScanProcessor::disabled());
//! let mut navigator = Navigator::new(NavigatorConfig::new(controller, Footprint::Circle(0.25)), localizer);
//!
//! // A room of 5 m by 4 m, and a goal in it.
//! let corners = [(-1.0, -1.0), (4.0, -1.0), (4.0, 3.0), (-1.0, 3.0)].map(|(x, y)| Point::new(x, y));
//! let walls = [0, 1, 2, 3].map(|k| Wall::between(corners[k], corners[(k + 1) % 4]).unwrap());
//! let map = MapView::from_walls(&walls);
//! let goal = Pose::<Map, Goal, f64>::new(2.0, 1.0, Angle::from_degrees(90.0));
//! navigator.set_goal(&map, goal).unwrap();
//!
//! // 30 s with simulated wheels, which follow every command exactly.
//! let (mut truth, mut travel, mut result) = (belief.pose, WheelPair::zero(), None);
//! for tick in 0..1500 {
//!     let stamp = Stamp::from_seconds(f64::from(tick) * period);
//!     let report = navigator.step(&map, &SensorInput { stamp, odometry: Odometry::WheelTravel(travel), readings: &[] });
//!     let twist = report.command.map_or(Twist::zero(), |command| command.twist);
//!     travel = drive.wheel_speeds_from_twist(twist).scaled(period);
//!     truth = truth.integrate(twist.integrate_for(period), Integration::Arc);
//!     result = result.or(report.result);
//! }
//! assert_eq!(result, Some(GoalResult::Reached));
//! assert!(truth.origin().distance(goal.origin()) < 0.02);
//! ```
//!
//! `examples/park.rs` is this program with a printed trace. `examples/custom_sensor.rs` adds a position sensor,
//! `examples/localize_only.rs` a laser, and `examples/firmware_loop` runs in `f32` on a microcontroller.
//!
//! # Modules, in the order in which data flows
//!
//! | module | contents |
//! |---|---|
//! | [`scalar`] | the numbers that the core computes with: `f32`, `f64`, dual numbers, SIMD lanes, intervals |
//! | [`geometry`] | angles, points, poses and lines, typed by their frames |
//! | [`linalg`] | small matrices, and covariances that stay positive semi-definite |
//! | [`time`] | stamps in nanoseconds; time is always an argument |
//! | [`kinematics`] | wheels ↔ twist ↔ motion: Eq. (1), (7)–(9) |
//! | [`map`] | walls and the distance to them |
//! | [`estimation`] | the extended Kalman filter: Eq. (11)–(18), gates, late measurements |
//! | [`lidar`] | from a scan to measurements of the pose: by lines, by scan matching or by a beam model |
//! | [`localization`] | filter, laser and monitor together; the global search for a lost robot |
//! | [`control`] | from pose and goal to a feasible twist: Eq. (3)–(6), (19)–(29), limits, paths, wheel speed control |
//! | [`safety`] | supervisor and collision check |
//! | [`navigator`] | all of it, one step for each control period |
//! | [`param`] | every parameter with its unit, its range and its default |
//! | [`optimal`] | the least time in which any controller could drive: a bound for comparisons |
//!
//! [`Navigator`](navigator::Navigator) is the usual entry point. [`Localizer`](localization::Localizer) estimates without a
//! controller, and [`Controller`](control::Controller) drives by a pose from elsewhere.
//!
//! # Frames and units
//! [`Map`](geometry::Map), [`Body`](geometry::Body), [`Goal`](geometry::Goal) and [`Laser`](geometry::Laser) are
//! right-handed plane frames: x forward, y left, angles counter-clockwise in (−π, π]. A pose is named by the frames that it
//! joins: `map_from_body` is where the body frame lies in the map frame. The unit of every quantity is SI: meters,
//! seconds, radians and their powers.
//!
//! # Bounds on work and memory
//! Constant parameters of the types bound the memory: events of the filter's history, beams of a scan, hypotheses and
//! keyframes of the global search. They bound the work of a step too: one filter step for odometry, at most `HISTORY` + 2 for
//! each measurement and each wall in a scan, and one pass over each scan. Constructors of maps, paths and footprints
//! return errors. After that, no input makes a step fail or panic: invalid readings are rejected and counted.
//!
//! # What the types do not protect
//! - Two different maps have the same type.
//! - A [`WheelPair`](kinematics::WheelPair) holds turn rates, rim speeds or travels; the name of the function says which.
//! - Stamps have one common origin only if the caller ensures it.
//! - A pose in `f32` has steps of 1 µm at 10 m and of 8 µm at 100 m, to which the motion of each period is rounded. At a period
//!   of 20 ms and from 1 cm/s on, odometry loses less than 1% of its travel within 100 m. At 1 ms it may lose a quarter:
//!   firmware that ticks faster adds up its encoder ticks between two steps.
//!
//! # What is claimed, and what is not
//! - The filter is consistent while the noise is what its parameters say, and small enough to tell walls apart: ranges
//!   to 10 cm.
//! - The local law leaves a sideways error, which the capture radius bounds and which does not vanish.
//! - Proofs for sampled, noisy, saturated loops are the subject of the certificate: `surepose-cert` evaluates this source in
//!   interval arithmetic.
//! - The core plans no path around obstacles: it stops before them. It builds no map.
//! - The laser sees one plane. The collision check does not replace a certified safety scanner.
#![no_std]
#![forbid(unsafe_code)]

pub mod control;
pub mod estimation;
pub mod geometry;
pub mod kinematics;
pub mod lidar;
pub mod linalg;
pub mod localization;
pub mod map;
pub mod navigator;
pub mod optimal;
pub mod param;
pub mod safety;
pub mod scalar;
pub mod time;
