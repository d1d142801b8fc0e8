//! Branch-free functions of `f32`. The coefficients are minimax fits (Remez) with the stated errors.

use core::f32::consts::{FRAC_2_PI, FRAC_PI_2, PI, TAU};

use surepose::scalar::single::{COSINE, SINE};

use super::{Element, element, polynomial};

/// Adding and subtracting 1.5·2^(digits − 1) rounds to an integer; the low bits of the sum are those of the
/// integer.
const SHIFT: f32 = 12_582_912.0;
/// π/2 minus its `f32` value.
const QUARTER_LOW: f32 = -4.371_139e-8;

/// sin(√z/2)/√z for z ≤ (5π/4)², error 2⁻²⁵·⁶.
const HALF_SINE: [f32; 5] = [0.499_999_97, -0.020_833_27, 0.000_260_383_8, -1.544_080_4e-6, 4.929_714e-9];
/// cos(√z/2) for z ≤ (5π/4)², error 2⁻²¹.
const HALF_COSINE: [f32; 5] = [0.999_999_6, -0.124_998_63, 0.002_603_451_5, -2.157_031_3e-5, 8.699_871e-8];
/// (atan(√z)/√z − 1)/z for z ≤ tan²(π/8), relative error of the arc tangent 2⁻²⁵·⁶.
const ARC_TANGENT: [f32; 4] = [-0.333_329_56, 0.199_779_2, -0.138_797_8, 0.080_600_66];

element!(f32, u32);
