//! Tests of the error bounds stated at `Element`.
#![allow(clippy::float_cmp, reason = "bits are compared on purpose")]

use std::f64::consts::{FRAC_PI_4, PI};

use surepose::scalar::Scalar;
use surepose_simd::{Element, Lanes};

/// `count` deterministic numbers, uniform in [−`reach`, `reach`].
fn uniform(count: usize, reach: f64) -> impl Iterator<Item = f64> {
    let mut state = 1_u64;
    std::iter::repeat_with(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) * reach
    })
    .take(count)
}

/// Angles of all magnitudes up to `reach`, and the multiples of π/4 with adjacent floats.
fn angles(reach: f64) -> impl Iterator<Item = f64> {
    let spread = [reach, 4.0, 1.0, 1e-3, 1e-12].into_iter().flat_map(|reach| uniform(200_000, reach));
    let corners = (-1200..=1200).map(|k| f64::from(k) * FRAC_PI_4).filter(move |x| x.abs() <= reach);
    spread.chain(corners.flat_map(|x| [x.next_down(), x, x.next_up()])).chain([0.0, -0.0])
}

fn worst(errors: impl Iterator<Item = f64>) -> f64 {
    errors.fold(0.0, |worst, error| if error <= worst { worst } else { error })
}

#[test]
fn sine_and_cosine() {
    let off = |(sin, cos): (f64, f64), (s, c): (f64, f64)| (sin - s).abs().max((cos - c).abs());
    let double = worst(angles(1000.0).map(|x| off(Element::sin_cos(x), libm::sincos(x))));
    assert!(double < 2.3e-16, "{double:e}");
    let single = worst(angles(1000.0).map(|x| {
        let (sin, cos) = Element::sin_cos(x as f32);
        off((f64::from(sin), f64::from(cos)), libm::sincos(f64::from(x as f32)))
    }));
    assert!(single < 1e-7, "{single:e}");
    // Small angles keep their relative precision.
    let relative =
        worst(angles(0.7).filter(|x| *x != 0.0).map(|x| (Element::sin_cos(x).0 / libm::sin(x) - 1.0).abs()));
    assert!(relative < 3.4e-16, "{relative:e}");
}

#[test]
fn sinc_of_small_angles() {
    let exact = |x: f64| if x.abs() < 1e-8 { 1.0 } else { libm::sin(x) / x };
    let double = worst(uniform(1_000_000, FRAC_PI_4).map(|x| (Element::small_sinc(x) - exact(x)).abs()));
    assert!(double < 2.3e-16, "{double:e}");
    let single = worst(
        uniform(1_000_000, 0.785)
            .map(|x| (f64::from((x as f32).small_sinc()) - exact(f64::from(x as f32))).abs()),
    );
    assert!(single < 6e-8, "{single:e}");
}

#[test]
fn cos_sinc_by_half_angles() {
    let reach = 1.25 * PI;
    let exact = |x: f64| (libm::cos(x), if x.abs() < 1e-8 { 1.0 } else { libm::sin(x) / x });
    let off = |(cos, sinc): (f64, f64), (c, s): (f64, f64)| (cos - c).abs().max((sinc - s).abs());
    let double = worst(angles(reach).map(|x| off(Element::cos_sinc_bounded(x), exact(x))));
    assert!(double < 2.5e-15, "{double:e}");
    let single = worst(angles(reach).map(|x| {
        let (cos, sinc) = Element::cos_sinc_bounded(x as f32);
        off((f64::from(cos), f64::from(sinc)), exact(f64::from(x as f32)))
    }));
    assert!(single < 1.2e-6, "{single:e}");
}

#[test]
fn length_and_angle() {
    let points = || {
        let scales = [1.0, 1e-3, 1e3, 1e-12].into_iter();
        let spread = scales.flat_map(|scale| uniform(200_000, scale).zip(uniform(200_003, 1.0).skip(3)));
        let axes = [(0.0, 1.0), (0.0, -1.0), (-0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (1.0, 1.0), (-1.0, -1.0)];
        spread.chain(axes)
    };
    let within = |(length, angle): (f64, f64), (y, x): (f64, f64), part: f64| {
        let exact = (libm::hypot(y, x), libm::atan2(y, x));
        (length - exact.0).abs() <= part * exact.0 && (angle - exact.1).abs() <= part * exact.1.abs()
    };
    for (y, x) in points() {
        assert!(within(Element::polar(y, x), (y, x), 5e-16), "{y:e} {x:e}");
        let (y, x) = (y as f32, x as f32);
        let (length, angle) = Element::polar(y, x);
        let found = (f64::from(length), f64::from(angle));
        assert!(within(found, (f64::from(y), f64::from(x)), 2.3e-7), "{y:e} {x:e} single");
    }
    assert_eq!(Element::polar(0.0_f64, 0.0), (0.0, 0.0));
    assert_eq!(Element::polar(0.0_f64, -1.0), (1.0, PI));
    // −π denotes the same direction as π.
    assert_eq!(Element::polar(-0.0_f64, -1.0), (1.0, -PI.next_down()));
}

#[test]
fn nan_and_infinity_propagate() {
    for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (sin, cos) = Element::sin_cos(broken);
        assert!(sin.is_nan() && cos.is_nan() && !broken.small_sinc().is_finite());
        let single = Element::sin_cos(broken as f32);
        assert!(single.0.is_nan() && single.1.is_nan());
    }
    for (y, x) in [(f64::NAN, 1.0), (1.0, f64::NAN), (f64::NAN, f64::NAN), (f64::INFINITY, f64::INFINITY)] {
        assert!(Element::polar(y, x).1.is_nan(), "{y} {x}");
        assert!(Element::polar(y as f32, x as f32).1.is_nan(), "{y} {x}");
    }
    let wrapped = Scalar::wrap_once(Lanes([f64::NAN, 4.0, -PI, PI]));
    assert!(wrapped.0[0].is_nan());
    assert_eq!(&wrapped.0[1..], [4.0 - 2.0 * PI, PI, PI]);
}

#[test]
fn masks_select_per_lane() {
    let (low, high) = (Lanes([1.0, 5.0, f64::NAN, 2.0]), Lanes::from_f64(3.0));
    let less = low.lt(high);
    assert_eq!(less.0, [true, false, false, true]);
    assert_eq!((!less).0, [false, true, true, false]);
    assert_eq!(Lanes::select(less, low, high).0, [1.0, 3.0, 3.0, 2.0]);
    assert_eq!(Lanes([2.5, -2.5, 0.4, 1e15]).round().0, [2.0, -2.0, 0.0, 1e15]);
}
