//! Vector of fixed capacity, without allocation.

use core::ops::{Deref, DerefMut};

/// Up to `N` items, in order.
#[derive(Clone, Copy, Debug)]
pub(super) struct FixedVec<T, const N: usize> {
    items: [T; N],
    len: usize,
}

impl<T: Copy + Default, const N: usize> FixedVec<T, N> {
    pub(super) fn new() -> Self {
        Self { items: [T::default(); N], len: 0 }
    }

    pub(super) fn is_full(&self) -> bool {
        self.len == N
    }

    /// Inserts `item` before the item at `index`; a full vector is unchanged.
    pub(super) fn insert(&mut self, index: usize, item: T) {
        if self.is_full() || index > self.len {
            return;
        }
        self.items.copy_within(index..self.len, index + 1);
        self.items[index] = item;
        self.len += 1;
    }

    /// Appends `item`; a full vector is unchanged.
    pub(super) fn push(&mut self, item: T) {
        self.insert(self.len, item);
    }

    /// Removes the last item.
    pub(super) fn pop(&mut self) {
        self.len = self.len.saturating_sub(1);
    }

    /// Keeps the items for which `predicate` is true.
    pub(super) fn retain(&mut self, predicate: impl Fn(&T) -> bool) {
        let mut kept = 0;
        for i in 0..self.len {
            if predicate(&self.items[i]) {
                self.items[kept] = self.items[i];
                kept += 1;
            }
        }
        self.len = kept;
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }
}

impl<T, const N: usize> Deref for FixedVec<T, N> {
    type Target = [T];
    fn deref(&self) -> &[T] {
        &self.items[..self.len]
    }
}

impl<T, const N: usize> DerefMut for FixedVec<T, N> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.items[..self.len]
    }
}
