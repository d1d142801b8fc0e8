//! Drive a differential robot to a pose, and be sure.
//!
//! The control and estimation core of Surepose: the system of [Tran2012], its misprints mended, written once over
//! every [`Scalar`]. No allocation, no I/O, no clock, no unsafe code; once its parts are built, nothing here fails
//! or panics. Read the files in the order in which data flows:
//!
//! | file | what |
//! |---|---|
//! | `scalar`, `angle`, `frame`, `pose`, `line`, `matrix`, `covariance` | the words |
//! | [`drive`](DiffDrive) | wheels ↔ twist ↔ motion: Eq. (1), (7)–(9) |
//! | `estimate` | where am I: Eq. (11)–(18), gates, late measurements |
//! | `laser` | from a scan to walls that are known again, line by line or beam by beam |
//! | [`navigation`](NavigationVariables) | the goal as the robot sees it: Eq. (3)–(6) |
//! | `law` | how should I move: Eq. (19)–(29), hysteresis, arrival |
//! | [`limit`](Limits) | what the wheels can do |
//! | [`pid`](Pid) | how a wheel keeps its speed |
//! | `relocate` | where am I, if I know nothing: several hypotheses until one is left |
//! | `supervisor` | how far that can be trusted: beside the loop |
//! | [`closed_loop`] | all of it, one tick |
//! | [`path`](Path) | what else a robot may follow: the paths of Fig. 6 |
//! | [`param`] | every parameter with its unit, its range and the reason for it |
//!
//! # Frames and units
//! [`Map`], [`Body`], [`Goal`] and [`Laser`] are right-handed, x forward, angles counter-clockwise. A pose is
//! named `to_from_from`. Metres, seconds, radians and their squares throughout; degrees exist at the edge only.
//!
//! # What the types do not protect
//! Two different maps are the same type, and so are a turn rate, a rim speed and a travel of [`WheelPair`]: the
//! function's name says which it takes. Time stamps share one origin because the caller sees to it.
//!
//! A pose in `f32` has steps of 1 µm at 10 m and of 8 µm at 100 m, to which each period's way is rounded. Odometry alone
//! loses less than a hundredth of it from 1 cm/s on, within 100 m, at a period of 20 ms; at 1 ms it may lose a quarter. So
//! firmware that ticks faster adds up its ticks between two calls.
//!
//! # What is claimed
//! The filter is consistent while its noise is what its parameters say, and small enough for walls to be told apart: a laser's
//! ranges to 10 cm. The local law leaves a sideways error that
//! is bounded by the capture radius and does not vanish. What holds for sampled, noisy, saturated loops is the
//! business of the certificate in `surepose-cert`, which evaluates this very source in intervals.
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
pub mod param;
pub mod safety;
pub mod scalar;
pub mod time;
