//! Tests of every operation against an arbitrary-precision oracle, with random intervals and special values.

use std::cell::RefCell;

use astro_float::{BigFloat, Consts, RoundingMode};
use proptest::prelude::*;
use surepose::scalar::Scalar;

use super::Interval;

const BITS: usize = 256;
const NEAREST: RoundingMode = RoundingMode::ToEven;

thread_local! {
    static CONSTANTS: RefCell<Consts> = RefCell::new(Consts::new().expect("memory for constants"));
}

fn big(x: f64) -> BigFloat {
    // The oracle misreads subnormal floats, so they are scaled to normal floats first.
    if x != 0.0 && x.abs() < 1e-290 {
        let scale = 2_f64.powi(600);
        return big(x * scale).div(&big(scale), BITS, NEAREST);
    }
    BigFloat::from_f64(x, BITS)
}

/// Whether the exact `value` lies in `interval`; an infinite bound always holds.
fn holds(interval: Interval, value: &BigFloat) -> bool {
    let above = interval.lo() == f64::NEG_INFINITY || big(interval.lo()) <= *value;
    let below = interval.hi() == f64::INFINITY || *value <= big(interval.hi());
    above && below
}

fn with_constants<T>(f: impl FnOnce(&mut Consts) -> T) -> T {
    CONSTANTS.with_borrow_mut(f)
}

fn sine(x: &BigFloat) -> BigFloat {
    with_constants(|c| x.sin(BITS, NEAREST, c))
}

fn cosine(x: &BigFloat) -> BigFloat {
    with_constants(|c| x.cos(BITS, NEAREST, c))
}

fn arc(y: &BigFloat, x: &BigFloat) -> BigFloat {
    let (zero, one) = (big(0.0), big(1.0));
    with_constants(|c| {
        let pi = c.pi(BITS, NEAREST);
        let half = pi.div(&big(2.0), BITS, NEAREST);
        if *x == zero {
            return if *y > zero {
                half
            } else if *y < zero {
                half.neg()
            } else {
                zero
            };
        }
        let base = y.div(x, BITS, NEAREST).mul(&one, BITS, NEAREST).atan(BITS, NEAREST, c);
        match (*x > zero, *y >= zero) {
            (true, _) => base,
            (false, true) => base.add(&pi, BITS, NEAREST),
            (false, false) => base.sub(&pi, BITS, NEAREST),
        }
    })
}

/// Numbers of all magnitudes, with special values at increased frequency.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -10.0..10.0_f64,
        2 => -1e-3..1e-3_f64,
        1 => -1e6..1e6_f64,
        1 => prop::sample::select(vec![
            0.0, -0.0, 1.0, -1.0, 5e-324, -5e-324, 1e-300, 1e300, -1e300, f64::MAX,
            core::f64::consts::PI, -core::f64::consts::PI, core::f64::consts::FRAC_PI_2, 1e-8, 1e-3,
        ]),
        1 => (-40_i32..40, 0_u32..64).prop_map(|(quarter, ulps)| {
            let mut x = f64::from(quarter) * core::f64::consts::FRAC_PI_2;
            for _ in 0..ulps { x = x.next_up(); }
            x
        }),
    ]
}

/// An interval and one of its members.
fn with_member() -> impl Strategy<Value = (Interval, f64)> {
    (number(), number(), 0.0..=1.0_f64, 0_u8..4).prop_map(|(a, b, at, kind)| {
        let b = match kind {
            0 => a,
            1 => a + (b - a) * 1e-6,
            _ => b,
        };
        let set = Interval::new(a, b);
        let member = set.lo() * (1.0 - at) + set.hi() * at;
        (set, if member.is_finite() { member.clamp(set.lo(), set.hi()) } else { set.mid() })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn arithmetic_encloses_the_exact_result((a, x) in with_member(), (b, y) in with_member()) {
        let (p, q) = (big(x), big(y));
        prop_assert!(holds(a + b, &p.add(&q, BITS, NEAREST)) && (a + b).contains(x + y));
        prop_assert!(holds(a - b, &p.sub(&q, BITS, NEAREST)));
        prop_assert!(holds(a * b, &p.mul(&q, BITS, NEAREST)));
        prop_assert!(holds(a.squared(), &p.mul(&p, BITS, NEAREST)));
        if y != 0.0 {
            prop_assert!(holds(a / b, &p.div(&q, BITS, NEAREST)), "{a:?} / {b:?} at {x}, {y}");
        }
        prop_assert!(Scalar::min(a, b).contains(x.min(y)) && Scalar::max(a, b).contains(x.max(y)));
        prop_assert!((-a).contains(-x) && a.abs().contains(x.abs()) && a.round().contains(x.round()));
        prop_assert!(a.round().contains(libm::rint(x)));
        let less = a.lt(b);
        prop_assert!((x < y && less.possible()) || (x >= y && (!less).possible()));
    }

    #[test]
    fn functions_enclose_the_exact_and_the_f64_result((a, x) in with_member(), (b, y) in with_member()) {
        let p = big(x);
        let (sin, cos, sinc) = a.sin_cos_sinc();
        prop_assert!(holds(sin, &sine(&p)), "sin {a:?} at {x}");
        prop_assert!(holds(cos, &cosine(&p)), "cos {a:?} at {x}");
        prop_assert!(sin.contains(x.sin_cos_sinc().0) && cos.contains(x.sin_cos_sinc().1));
        prop_assert!(sinc.contains(Scalar::sinc(x)), "sinc {a:?} at {x}: {sinc:?}");
        if x != 0.0 {
            prop_assert!(holds(sinc, &sine(&p).div(&p, BITS, NEAREST)), "sinc {a:?} at {x}");
            let slope = cosine(&p).sub(&sine(&p).div(&p, BITS, NEAREST), BITS, NEAREST).div(&p, BITS, NEAREST);
            // Below 1e-20, the oracle loses all digits to cancellation.
            prop_assert!(x.abs() < 1e-20 || holds(a.sinc_derivative(cos, sinc), &slope), "slope {a:?} at {x}");
        }
        if x >= 0.0 {
            prop_assert!(holds(a.sqrt(), &p.sqrt(BITS, NEAREST)) && a.sqrt().contains(Scalar::sqrt(x)));
        }
        prop_assert!(holds(a.atan2(b), &arc(&p, &big(y))), "atan2 {a:?} {b:?} at {x}, {y}");
    }

    #[test]
    fn halves_and_pieces_cover_the_interval(a in with_member(), pieces in 1_usize..7) {
        let (set, member) = a;
        let (left, right) = set.halves();
        prop_assert!(left.contains(member) || right.contains(member));
        prop_assert!((0..pieces).any(|i| set.piece(i, pieces).contains(member)));
        prop_assert!(left.hull(right) == set);
    }
}

#[test]
fn narrow_arguments_give_narrow_results() {
    for k in -300..300 {
        let x = f64::from(k) * 0.0317;
        let (sin, cos, sinc) = Interval::point(x).sin_cos_sinc();
        for (set, value) in [(sin, x.sin()), (cos, x.cos()), (sinc, Scalar::sinc(x))] {
            assert!(set.width() < 1e-14 && (set.mid() - value).abs() < 1e-14, "{x}: {set:?}");
        }
        let slope = Interval::point(x * 1e-3).sinc_derivative(cos, sinc);
        assert!(slope.width() < 1e-6, "{x}: {slope:?}");
    }
    let around_zero = Interval::symmetric(0.1).sinc();
    assert!(around_zero.hi() <= 1.0 && around_zero.lo() > 0.9983, "{around_zero:?}");
    let angle = Interval::new(0.9, 1.1).atan2(Interval::new(-0.1, 0.1));
    assert!(angle.lo() > 1.45 && angle.hi() < 1.69, "{angle:?}");
}

#[test]
fn nan_and_undefined_results_are_the_entire_line() {
    let nan = Interval::point(f64::NAN);
    let all = Interval::ENTIRE;
    assert_eq!(nan, all);
    assert_eq!(Interval::new(1.0, f64::NAN), all);
    assert_eq!(Interval::point(1.0) / Interval::new(-1.0, 1.0), all);
    assert_eq!(all / all, all);
    assert_eq!(all - all, all);
    let infinite = Interval::point(f64::INFINITY);
    assert!(infinite.contains(f64::MAX) && infinite.hi() == f64::INFINITY);
    assert!((infinite - infinite) == all && (infinite * Interval::point(0.0)).contains(0.0));
    for set in [all, infinite, Interval::point(-1.0).sqrt(), all.sqrt(), all.round(), all.atan2(all)] {
        assert!(set.lo() <= set.hi(), "{set:?}");
    }
    let (sin, cos, sinc) = all.sin_cos_sinc();
    assert!(sin.encloses(Interval::symmetric(1.0)) && cos == sin && sinc.hi() <= 1.0);
    assert!((Interval::point(f64::MAX) + Interval::point(f64::MAX)).contains(f64::MAX));
}

/// A bound can mean "arbitrarily large"; 0 times such a bound contains every product of members.
#[test]
fn unbounded_intervals_enclose_all_products_and_quotients() {
    let bounds = [f64::NEG_INFINITY, -2.0, 0.0, 3.0, f64::INFINITY];
    let members = [-1e9, -2.0, -1e-9, 0.0, 1e-9, 3.0, 1e9];
    let pairs = || bounds.into_iter().flat_map(move |a| bounds.map(|b| Interval::new(a, b)));
    for (x, y) in pairs().flat_map(|x| pairs().map(move |y| (x, y))) {
        for a in members.into_iter().filter(|member| x.contains(*member)) {
            for b in members.into_iter().filter(|member| y.contains(*member)) {
                assert!((x * y).contains(a * b), "{a}·{b} in {x:?}·{y:?}: {:?}", x * y);
                assert!(b == 0.0 || (x / y).contains(a / b), "{a}/{b} in {x:?}/{y:?}: {:?}", x / y);
            }
        }
    }
}

/// Just below the negative x axis the arc tangent rounds to −π, where the core returns π.
#[test]
fn angle_contains_that_of_the_core_next_to_the_negative_axis() {
    for y in [-1e-300, -1e-17, -2e-16, -3e-16, -1e-15, -0.0, 0.0, 1e-17] {
        let found = Scalar::atan2(y, -1.0_f64);
        let point = Interval::point(y).atan2(Interval::point(-1.0));
        let wide = Interval::new(-0.5, y).atan2(Interval::new(-2.0, -0.5));
        assert!(point.contains(found) && wide.contains(found), "{y}: {found} not in {point:?} and {wide:?}");
    }
    let below = Interval::new(-0.5, -0.1).atan2(Interval::new(-2.0, -0.5));
    assert!(below.hi() < -1.5, "{below:?}");
}
