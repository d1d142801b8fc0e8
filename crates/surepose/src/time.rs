//! Stamps: time is an argument, never read from a clock.

/// A moment, in nanoseconds since an origin of the caller's choice.
///
/// Integer, so that a stamp late in the day is as sharp as an early one, in `f32` builds too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Stamp(i64);

impl Stamp {
    /// The moment `nanoseconds` after the origin.
    #[inline]
    pub const fn from_nanoseconds(nanoseconds: i64) -> Self {
        Self(nanoseconds)
    }

    /// The moment `seconds` after the origin, to the nearest nanosecond; NaN is the origin.
    #[inline]
    pub fn from_seconds(seconds: f64) -> Self {
        Self(libm::round(seconds * 1e9) as i64)
    }

    /// Nanoseconds since the origin.
    #[inline]
    pub const fn nanoseconds(self) -> i64 {
        self.0
    }

    /// Seconds since the origin.
    #[inline]
    pub fn seconds(self) -> f64 {
        self.0 as f64 * 1e-9
    }

    /// Seconds from `earlier` to here; negative where it is later.
    #[inline]
    pub fn since(self, earlier: Self) -> f64 {
        self.0.saturating_sub(earlier.0) as f64 * 1e-9
    }

    /// The moment `seconds` later.
    #[must_use]
    #[inline]
    pub fn after(self, seconds: f64) -> Self {
        Self(self.0.saturating_add(Self::from_seconds(seconds).0))
    }
}

/// A value, and when it was true.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamped<T> {
    /// When the value was measured, not when it arrived.
    pub stamp: Stamp,
    /// What was measured.
    pub value: T,
}

impl<T> Stamped<T> {
    /// `value`, measured at `stamp`.
    #[inline]
    pub fn new(stamp: Stamp, value: T) -> Self {
        Self { stamp, value }
    }
}
