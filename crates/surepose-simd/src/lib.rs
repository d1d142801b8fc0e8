//! SIMD scalar type for simulations of millions of trials.
//!
//! [`Lanes`] is a [`Scalar`](surepose::scalar::Scalar) of `N` numbers; [`LaneArray`] stores one number per robot. The
//! generic control law, limits, and motion model of `surepose` run on `N` robots at a time, without branches
//! or calls. The compiler turns such a loop into vector instructions. [`dispatch_simd`] compiles it for
//! AVX-512, AVX2, and the baseline processor, and selects one at run time.
//!
//! ```
//! use surepose::control::NavigationVariables;
//! use surepose::geometry::{Angle, Body, Goal, Map, Pose};
//! use surepose_simd::{LaneArray, Lanes, Kernel, dispatch_simd};
//!
//! /// Goal distances of 64 robots \[m].
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
//! # Bit-identical results Sine, cosine, and arc tangent are polynomials of correctly rounded IEEE 754
//! operations, fused multiply–add included. The bits of a result depend neither on the instruction set, nor
//! on `N`, nor on neighboring lanes. They differ from the results of `f64` and `f32` by the errors stated at
//! [`Element`]. Without hardware fused multiply–add (x86 before 2013), the C library's slow function is used.
//!
//! # Measured Bench of `surepose-montecarlo/examples/floor.rs` with the law of the paper, one thread, against a C++ program of the same
//! computation (GCC 12, libmvec, `-O3 -ffast-math`, and `-march=x86-64-v3` or `-v4`): quotient of the steps per second, median of seven
//! alternating pairs on an Intel Xeon. The C++ program draws two deviates a period, the bench five. `SUREPOSE_SIMD=avx2` or `portable`
//! selects a narrower instruction set.
//!
//! | instruction set | `f64`, no noise | `f64`, bench noise | `f32`, no noise | `f32`, bench noise |
//! |---|---|---|---|---|
//! | AVX2 | 1.37 | 1.37 | 1.50 | 1.14 |
//! | AVX-512 | 1.54 | 1.64 | 1.74 | 1.23 |
//!
//! # Limitations Outside of the domains of [`Element`], results are meaningless or NaN. No function panics.

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
