//! One number for each of many robots.

use core::ops::Range;

use crate::element::Element;
use crate::lanes::Lanes;
use crate::mask::LaneMask;

/// `L` numbers of which [`Lanes`] takes `N` at a time: those at `k`, `k + L/N`, `k + 2·L/N` and so on.
///
/// So consecutive `k` are neighbours in memory for each of the `N`, and the loop over `k` becomes a loop over vectors
/// with `N` of them in flight: while one waits for its last operation, the processor works on another.
///
/// Masks are kept as numbers, −1 for yes and 0 for no: a loop over numbers of one width is what compilers vectorise
/// best.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct LaneArray<T, const L: usize>(pub [T; L]);

impl<T: Element, const L: usize> Default for LaneArray<T, L> {
    fn default() -> Self {
        Self([T::default(); L])
    }
}

impl<T: Element, const L: usize> LaneArray<T, L> {
    /// The `k` that visit every number once, `N` at a time. `L` must be a multiple of `N`: this does not compile else.
    #[inline(always)]
    pub fn rows<const N: usize>() -> Range<usize> {
        const { assert!(L.is_multiple_of(N), "N must divide L") };
        0..L / N
    }

    /// The `N` numbers of row `k`.
    #[inline(always)]
    pub fn get<const N: usize>(&self, k: usize) -> Lanes<T, N> {
        Lanes(core::array::from_fn(|j| self.0[k + j * (L / N)]))
    }

    /// The same as numbers of another type.
    #[inline(always)]
    pub fn get_as<U: Element, const N: usize>(&self, k: usize) -> Lanes<U, N>
    where
        T: Into<f32>,
    {
        Lanes(core::array::from_fn(|j| U::from_single(self.0[k + j * (L / N)].into())))
    }

    /// Sets the `N` numbers of row `k`.
    #[inline(always)]
    pub fn set<const N: usize>(&mut self, k: usize, lanes: Lanes<T, N>) {
        for j in 0..N {
            self.0[k + j * (L / N)] = lanes.0[j];
        }
    }

    /// The `N` answers of row `k`.
    #[inline(always)]
    pub fn mask<const N: usize>(&self, k: usize) -> LaneMask<N> {
        LaneMask(core::array::from_fn(|j| self.0[k + j * (L / N)].is_negative()))
    }

    /// Sets the `N` answers of row `k`.
    #[inline(always)]
    pub fn set_mask<const N: usize>(&mut self, k: usize, mask: LaneMask<N>) {
        for j in 0..N {
            self.0[k + j * (L / N)] = if mask.0[j] { T::from_f64(-1.0) } else { T::from_f64(0.0) };
        }
    }
}
