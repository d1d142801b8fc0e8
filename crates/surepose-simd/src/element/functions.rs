//! Elementary functions for both float types; each module that invokes [`element`] supplies the constants.

/// Implements [`Element`] for `$float` with the constants of the invoking module; `$bits` is its bit pattern
/// type.
macro_rules! element {
    ($float:ident, $bits:ident) => {
        const SIGN: $bits = 1 << ($bits::BITS - 1);

        impl Element for $float {
            const EPSILON: Self = $float::EPSILON;

            #[inline(always)]
            #[allow(clippy::cast_lossless, reason = "lossless for f64 only; one macro serves both")]
            fn from_f64(value: f64) -> Self {
                value as $float
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn from_single(value: f32) -> Self {
                Self::from(value)
            }
            #[inline(always)]
            fn times_plus(self, factor: Self, addend: Self) -> Self {
                self.mul_add(factor, addend)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $float::abs(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }
            #[inline(always)]
            fn round(self) -> Self {
                (self + SHIFT) - SHIFT
            }
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                // x = q·π/2 + r with |r| ≤ π/4. π/2 is split in two parts to keep the digits of r: products
                // by small q are exact.
                let shifted = self.mul_add(FRAC_2_PI, SHIFT);
                let quadrant = shifted.to_bits();
                let quarters = shifted - SHIFT;
                let r = (-quarters).mul_add(QUARTER_LOW, (-quarters).mul_add(FRAC_PI_2, self));
                let z = r * r;
                let sin = (r * z).mul_add(polynomial(z, SINE), r);
                let cos = (z * z).mul_add(polynomial(z, COSINE), z.mul_add(-0.5, 1.0));

                let odd = quadrant & 1 != 0;
                let (sin, cos) = (if odd { cos } else { sin }, if odd { sin } else { cos });
                let flip_sin = (quadrant & 2) << ($bits::BITS - 2);
                let flip_cos = (quadrant.wrapping_add(1) & 2) << ($bits::BITS - 2);
                (Self::from_bits(sin.to_bits() ^ flip_sin), Self::from_bits(cos.to_bits() ^ flip_cos))
            }
            #[inline(always)]
            fn small_sinc(self) -> Self {
                let z = self * self;
                z.mul_add(polynomial(z, SINE), 1.0)
            }
            #[inline(always)]
            fn half_sine(square: Self) -> Self {
                polynomial(square, HALF_SINE)
            }
            #[inline(always)]
            fn half_cosine(square: Self) -> Self {
                polynomial(square, HALF_COSINE)
            }
            #[inline(always)]
            fn is_negative(self) -> bool {
                self.to_bits() & SIGN != 0
            }
            #[inline(always)]
            fn copysign(self, other: Self) -> Self {
                Self::from_bits((self.to_bits() & !SIGN) | (other.to_bits() & SIGN))
            }
            #[inline(always)]
            fn polar(self, x: Self) -> (Self, Self) {
                let length = Element::sqrt(x.mul_add(x, self * self));
                // Angle within the octant, from the tangent of its half, at most tan(π/8).
                let (across, up) = (x.abs(), self.abs());
                let (low, high) = (Element::min(up, across), Element::max(across, up));
                let tangent = low / (length + (high + Self::MIN_POSITIVE));
                let (twice, z) = (tangent + tangent, tangent * tangent);
                let octant = (twice * z).mul_add(polynomial(z, ARC_TANGENT), twice);

                // Compared as bit patterns, which order nonnegative floats. With a second float comparison,
                // the compiler would duplicate this code, once per outcome.
                let quarter = if up.to_bits() > across.to_bits() { FRAC_PI_2 - octant } else { octant };
                let half = Element::min(if x < 0.0 { PI - quarter } else { quarter }, straight(self));
                (length, half.copysign(self))
            }
            #[inline(always)]
            fn wrap_once(self) -> Self {
                if self.abs() > straight(self) { self - TAU.copysign(self) } else { self }
            }
        }

        /// Largest angle in the half plane of `number`: π, or the next smaller float for negative numbers.
        ///
        /// −π denotes the same direction as π, which represents both.
        #[inline(always)]
        fn straight(number: $float) -> $float {
            $float::from_bits(PI.to_bits() - (number.to_bits() >> ($bits::BITS - 1)))
        }
    };
}
pub(super) use element;
