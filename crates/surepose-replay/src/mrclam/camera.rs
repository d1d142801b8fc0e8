//! Camera model: depth along the optical axis and bearing, with correlated errors.

use surepose::estimation::RangeBearingMeasurement;
use surepose::geometry::{Angle, Map, Point};

/// Camera that reads the barcodes.
///
/// The recorded "range" is the *depth* along the optical axis, range·cos(bearing), times a constant. The
/// height of a barcode in a pinhole image gives depth, [Hartley2004] Sec. 6.1. Interpreted as a range, it is
/// 13 % too short at the edge of the image and 4 % too long in its center. This explains the 0.06–0.24 m of
/// range noise that the data set is known for. Interpreted as a depth, it scatters by 0.8 % to 1.6 % per
/// robot.
///
/// The defaults are rounded from the residuals of all five robots of data set 7 against their reference poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Age of an observation at its stamp \[s]. Fits of the robots: 0.02 to 0.04 s.
    pub latency: f64,
    /// Recorded depth over true depth. Fits of the robots: 1.027 to 1.053.
    pub scale: f64,
    /// Standard deviation of a single depth near the camera \[m].
    pub depth_std: f64,
    /// Increase of that standard deviation per meter of depth.
    pub depth_std_per_metre: f64,
    /// Standard deviation of a single bearing \[rad]. Measured: 0.5° to 0.6°, and 1.5° for robot 1.
    pub bearing_std: f64,
    /// Correlation time of the errors \[s].
    ///
    /// The integrals of the autocorrelation are 2.6 s to 7.0 s for depth and 0.5 s to 6.0 s for bearing;
    /// their mean is 3.8 s.
    pub correlation_time: f64,
    /// Interval between images \[s].
    pub frame_period: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            latency: 0.03,
            scale: 1.04,
            depth_std: 0.02,
            depth_std_per_metre: 0.012,
            bearing_std: 0.6_f64.to_radians(),
            correlation_time: 4.0,
            frame_period: 0.23,
        }
    }
}

impl Camera {
    /// Converts a record with `depth` \[m] and `bearing` \[rad] to an observation of `landmark`.
    ///
    /// The bearing error affects both range and bearing. The filter receives both variances but not their
    /// correlation.
    pub(super) fn sighting(
        &self,
        landmark: Point<Map, f64>,
        depth: f64,
        bearing: f64,
    ) -> RangeBearingMeasurement<f64> {
        let bearing = Angle::from_radians(bearing);
        let (sin, cos) = bearing.sin_cos();
        // Bearings sideways or backward are outside the image: the range is NaN, and the filter rejects it by
        // name.
        let per_depth = if cos > 0.0 { 1.0 / (self.scale * cos) } else { f64::NAN };
        let range = depth * per_depth;
        let by_depth = libm::hypot(self.depth_std, self.depth_std_per_metre * depth) * per_depth;
        let by_bearing = range * (sin / cos) * self.bearing_std;
        let widening = libm::sqrt(self.repeats());
        RangeBearingMeasurement {
            landmark,
            range,
            bearing,
            range_std: libm::hypot(by_depth, by_bearing) * widening,
            bearing_std: self.bearing_std * widening,
        }
    }

    /// Returns the number of observations with the information of one with independent errors.
    ///
    /// Of `N` samples with period Δt whose errors have an exponential correlation of time τ, only N / (1 +
    /// 2τ/Δt) are effective, for Δt well below τ: [Bayley1946]. A filter that assumes independent
    /// observations receives the variance of each, times this number.
    fn repeats(&self) -> f64 {
        1.0 + 2.0 * self.correlation_time / self.frame_period
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_becomes_range_along_the_bearing() {
        let camera = Camera { scale: 1.0, correlation_time: 0.0, ..Camera::default() };
        let seen = camera.sighting(Point::new(3.0, 4.0), 3.0, 4.0_f64.atan2(3.0));
        assert!((seen.range - 5.0).abs() < 1e-12);
        assert!((seen.bearing_std - camera.bearing_std).abs() < 1e-15);
    }

    /// Compares the standard deviation of range with finite differences by depth and bearing.
    #[test]
    fn range_noise_is_propagated_from_depth_and_bearing() {
        let camera = Camera { correlation_time: 0.0, ..Camera::default() };
        let (depth, bearing, step) = (4.0, 0.5, 1e-6);
        let range = |depth, bearing| camera.sighting(Point::new(0.0, 0.0), depth, bearing).range;
        let slope = |up: f64, down: f64| (up - down) / (2.0 * step);
        let by_depth = slope(range(depth + step, bearing), range(depth - step, bearing));
        let by_bearing = slope(range(depth, bearing + step), range(depth, bearing - step));
        let depth_std = camera.depth_std.hypot(camera.depth_std_per_metre * depth);
        let expected = (by_depth * depth_std).hypot(by_bearing * camera.bearing_std);
        let seen = camera.sighting(Point::new(0.0, 0.0), depth, bearing);
        assert!((seen.range_std - expected).abs() < 1e-8, "got {}, expected {expected}", seen.range_std);
    }

    #[test]
    fn bearings_behind_the_image_give_nan() {
        let camera = Camera::default();
        assert!(camera.sighting(Point::new(0.0, 0.0), 1.0, 2.0).range.is_nan());
    }
}
