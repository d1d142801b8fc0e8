//! Array of numbers, one per robot.

use core::ops::Range;

use crate::element::Element;
use crate::lanes::Lanes;
use crate::mask::LaneMask;

/// `L` numbers, accessed in rows of `N` as [`Lanes`]: row `k` holds the indices `k`, `k + L/N`, `k + 2·L/N`,
/// ….
///
/// Consecutive `k` are adjacent in memory for each of the `N` numbers, so the loop over `k` becomes a loop
/// over vectors. `N` vectors are in flight, which hides the latency of dependent operations.
///
/// Masks are stored as numbers, −1 for true and 0 for false: compilers vectorize loops over one number width
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
    /// Row indices that visit every number once. A compile error results unless `L` is a multiple of `N`.
    #[inline(always)]
    pub fn rows<const N: usize>() -> Range<usize> {
        const { assert!(L.is_multiple_of(N), "N must divide L") };
        0..L / N
    }

    /// Reads the `N` numbers of row `k`.
    #[inline(always)]
    pub fn get<const N: usize>(&self, k: usize) -> Lanes<T, N> {
        Lanes(core::array::from_fn(|j| self.0[k + j * (L / N)]))
    }

    /// Reads the `N` numbers of row `k`, converted to another type.
    #[inline(always)]
    pub fn get_as<U: Element, const N: usize>(&self, k: usize) -> Lanes<U, N>
    where
        T: Into<f32>,
    {
        Lanes(core::array::from_fn(|j| U::from_single(self.0[k + j * (L / N)].into())))
    }

    /// Writes the `N` numbers of row `k`.
    #[inline(always)]
    pub fn set<const N: usize>(&mut self, k: usize, lanes: Lanes<T, N>) {
        for j in 0..N {
            self.0[k + j * (L / N)] = lanes.0[j];
        }
    }

    /// Reads the mask of row `k`.
    #[inline(always)]
    pub fn mask<const N: usize>(&self, k: usize) -> LaneMask<N> {
        LaneMask(core::array::from_fn(|j| self.0[k + j * (L / N)].is_negative()))
    }

    /// Writes the mask of row `k`.
    #[inline(always)]
    pub fn set_mask<const N: usize>(&mut self, k: usize, mask: LaneMask<N>) {
        for j in 0..N {
            self.0[k + j * (L / N)] = if mask.0[j] { T::from_f64(-1.0) } else { T::from_f64(0.0) };
        }
    }
}
