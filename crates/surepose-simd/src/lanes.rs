//! Scalar of `N` numbers that follow the same operations.

use core::array::from_fn;
use core::ops::{Add, Div, Mul, Neg, Sub};

use surepose::scalar::Scalar;

use crate::element::Element;
use crate::mask::LaneMask;

/// Scalar of `N` numbers, computed by branch-free operations.
///
/// # Domain
/// As for the functions of [`Element`]. [`Scalar::sinc`] requires |x| ≤ π/4; the half turn of one period must
/// stay within this limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes<T, const N: usize>(pub [T; N]);

impl<T: Element, const N: usize> Lanes<T, N> {
    #[inline(always)]
    fn map(self, f: impl Fn(T) -> T) -> Self {
        Self(from_fn(|k| f(self.0[k])))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        Self(from_fn(|k| f(self.0[k], other.0[k])))
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $op:tt) => {
        impl<T: Element, const N: usize> $trait for Lanes<T, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $op b)
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl<T: Element, const N: usize> Neg for Lanes<T, N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl<T: Element, const N: usize> Scalar for Lanes<T, N> {
    type Mask = LaneMask<N>;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self([T::from_f64(value); N])
    }
    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask<N> {
        LaneMask(from_fn(|k| self.0[k] < other.0[k]))
    }
    #[inline(always)]
    fn select(mask: LaneMask<N>, yes: Self, no: Self) -> Self {
        Self(from_fn(|k| if mask.0[k] { yes.0[k] } else { no.0[k] }))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.map(T::abs)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, T::min)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, T::max)
    }
    #[inline(always)]
    fn round(self) -> Self {
        self.map(T::round)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(T::sqrt)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (mut sin, mut cos) = (self.0, self.0);
        for k in 0..N {
            (sin[k], cos[k]) = self.0[k].sin_cos();
        }
        (Self(sin), Self(cos))
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        self.polar(x).1
    }
    #[inline(always)]
    fn polar(self, x: Self) -> (Self, Self) {
        let (mut length, mut angle) = (self.0, self.0);
        for k in 0..N {
            (length[k], angle[k]) = self.0[k].polar(x.0[k]);
        }
        (Self(length), Self(angle))
    }
    #[inline(always)]
    fn sin_cos_sinc(self) -> (Self, Self, Self) {
        let (sin, cos) = self.sin_cos();
        // sin x/x is correctly rounded down to the smallest angles; only 0/0 is replaced.
        let sinc =
            from_fn(|k| if self.0[k] == T::default() { T::from_f64(1.0) } else { sin.0[k] / self.0[k] });
        (sin, cos, Self(sinc))
    }
    #[inline(always)]
    fn sin_cos_bounded(self) -> (Self, Self) {
        let (cos, sinc) = self.cos_sinc_bounded();
        (self * sinc, cos)
    }
    #[inline(always)]
    fn cos_sinc_bounded(self) -> (Self, Self) {
        let (mut cos, mut sinc) = (self.0, self.0);
        for k in 0..N {
            (cos[k], sinc[k]) = self.0[k].cos_sinc_bounded();
        }
        (Self(cos), Self(sinc))
    }
    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        self.zip(other, T::copysign)
    }
    #[inline(always)]
    fn sinc(self) -> Self {
        self.map(T::small_sinc)
    }
    #[inline(always)]
    fn wrap_once(self) -> Self {
        self.map(T::wrap_once)
    }
}
