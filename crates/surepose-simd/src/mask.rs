//! Boolean mask of lanes.

use core::array::from_fn;
use core::ops::Not;

use surepose::scalar::Mask;

/// One boolean per lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneMask<const N: usize>(pub [bool; N]);

impl<const N: usize> Not for LaneMask<N> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(from_fn(|k| !self.0[k]))
    }
}

impl<const N: usize> Mask for LaneMask<N> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([value; N])
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self(from_fn(|k| self.0[k] & other.0[k]))
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self(from_fn(|k| self.0[k] | other.0[k]))
    }
}
