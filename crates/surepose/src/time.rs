//! Time stamps. Time is always an argument, never read from a clock.

/// Time in nanoseconds since an origin that the caller defines.
///
/// The integer keeps full resolution over days, in `f32` builds as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Stamp(i64);

impl Stamp {
    /// Time `nanoseconds` after the origin.
    #[inline]
    pub const fn from_nanoseconds(nanoseconds: i64) -> Self {
        Self(nanoseconds)
    }

    /// Time `seconds` after the origin, rounded to a nanosecond; NaN gives the origin.
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

    /// Seconds from `earlier` to this stamp; negative where `earlier` is later.
    #[inline]
    pub fn since(self, earlier: Self) -> f64 {
        self.0.saturating_sub(earlier.0) as f64 * 1e-9
    }

    /// Time `seconds` after this stamp.
    #[must_use]
    #[inline]
    pub fn after(self, seconds: f64) -> Self {
        Self(self.0.saturating_add(Self::from_seconds(seconds).0))
    }
}

/// A value and the time of its measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamped<T> {
    /// Time of measurement, not of arrival.
    pub stamp: Stamp,
    /// Measured value.
    pub value: T,
}

impl<T> Stamped<T> {
    /// `value`, measured at `stamp`.
    #[inline]
    pub fn new(stamp: Stamp, value: T) -> Self {
        Self { stamp, value }
    }
}
