//! Surepose in SIMD lanes: the scalar for millions of trials.
//!
//! [`Lanes`] is a [`Scalar`](surepose::Scalar) of `N` numbers and [`LaneArray`] holds one such number for each of many
//! robots. A loop along columns that drives `N` robots at a time with the core's law, limits and motion, which are
//! written once, has neither branches nor calls in it: the compiler makes vector instructions of it. [`dispatch_simd`]
//! compiles such a loop for AVX-512, for AVX2 and for any processor, and chooses when it runs.
//!
//! ```
//! use surepose::{Angle, Body, Goal, Map, NavigationVariables, Pose};
//! use surepose_simd::{LaneArray, Lanes, Kernel, dispatch_simd};
//!
//! /// The distance of each of 64 robots from its goal.
//! struct Distances<'a>(&'a LaneArray<f64, 64>, &'a LaneArray<f64, 64>, &'a mut LaneArray<f64, 64>);
//!
//! impl Kernel for Distances<'_> {
//!     type Output = ();
//!
//!     #[inline(always)]
//!     fn run(self) {
//!         let goal: Pose<Map, Goal, Lanes<f64, 4>> = Pose::identity();
//!         for k in LaneArray::<f64, 64>::rows::<4>() {
//!             let robot: Pose<Map, Body, _> = Pose::new(self.0.get(k), self.1.get(k), Angle::zero());
//!             self.2.set(k, NavigationVariables::from_poses(robot, goal).rho);
//!         }
//!     }
//! }
//!
//! let (x, y, mut distance) = (LaneArray([3.0; 64]), LaneArray([4.0; 64]), LaneArray([0.0; 64]));
//! dispatch_simd(Distances(&x, &y, &mut distance));
//! assert_eq!(distance.0, [5.0; 64]);
//! ```
//!
//! # The same bits everywhere
//! Sine, cosine and arc tangent are polynomials of this crate, made of operations that IEEE 754 rounds correctly, the
//! fused multiply–add among them. So a result's bits depend neither on the instruction set, nor on `N`, nor on the
//! neighbouring lanes. They differ from those of `f64` and `f32` by the errors stated at [`Element`]. Without fused
//! multiply–add in hardware (x86 before 2013) it is the C library's, which is slow.
//!
//! # What is not promised
//! Beyond the domains of [`Element`] a function answers with nonsense or NaN. It never panics.

mod dispatch;
mod element;
mod lane_array;
mod lanes;
mod mask;
mod normal;
mod streams;

pub use dispatch::{Kernel, dispatch_portable, dispatch_simd, instruction_set};
pub use element::Element;
pub use lane_array::LaneArray;
pub use lanes::Lanes;
pub use mask::LaneMask;
pub use streams::{Streams, uniform};
