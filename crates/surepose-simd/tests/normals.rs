//! Tests of the normal distribution of the deviates and of the independence of the streams.
#![allow(clippy::float_cmp, reason = "bits are compared on purpose")]

use surepose_simd::{Kernel, LaneArray, Streams, dispatch_portable, dispatch_simd};

const L: usize = 64;

fn deviates(seed: u64, first: u64, rounds: usize) -> Vec<[f32; L]> {
    let mut streams = Streams::<L>::default();
    for lane in 0..L {
        streams.start(lane, seed, first + lane as u64);
    }
    let mut all = Vec::new();
    for _ in 0..rounds {
        let mut drawn = [LaneArray([0.0; L]); 5];
        streams.normals(&mut drawn);
        all.extend(drawn.map(|deviates| deviates.0));
    }
    all
}

/// Φ(x), the normal distribution function, with an error of 10⁻⁷.
fn below(x: f64) -> f64 {
    0.5 * libm::erfc(-x / core::f64::consts::SQRT_2)
}

#[test]
fn moments_and_tails_are_normal() {
    let sample: Vec<f64> = deviates(7, 0, 20_000).into_iter().flatten().map(f64::from).collect();
    let count = sample.len() as f64;
    let moment = |power: i32| sample.iter().map(|x| x.powi(power)).sum::<f64>() / count;
    // Each moment lies within five of its standard deviations √(E x²ᵖ − (E xᵖ)²)/√n.
    for (power, expected, deviation) in [
        (1, 0.0, 1.0),
        (2, 1.0, 2.0_f64.sqrt()),
        (3, 0.0, 15_f64.sqrt()),
        (4, 3.0, 96_f64.sqrt()),
        (6, 15.0, 10170_f64.sqrt()),
    ] {
        let off = (moment(power) - expected).abs() / (deviation / count.sqrt());
        assert!(off < 5.0, "moment {power} is off by {off} σ");
    }
    for bound in [-4.5, -4.0, -3.0, -2.0, -1.0, -0.25, 0.0, 0.5, 1.5, 2.5, 3.5, 4.25, 5.0] {
        let (seen, part) = (sample.iter().filter(|x| **x < bound).count() as f64, below(bound));
        let off = (seen - part * count).abs() / (count * part * (1.0 - part)).sqrt().max(1.0);
        assert!(off < 5.0, "below {bound}: {seen} of {count}, off by {off} σ");
    }
    assert!(sample.iter().all(|x| x.abs() < 6.8));
}

#[test]
fn streams_are_independent() {
    let (rows, n) = (deviates(7, 0, 4000), 12_000.0_f64);
    let correlation = |a: &dyn Fn(usize) -> f32, b: &dyn Fn(usize) -> f32| {
        (0..rows.len() - 6).map(|k| f64::from(a(k)) * f64::from(b(k))).sum::<f64>() / n / 2.0
    };
    // The mean of 24 000 products has the standard deviation 1/√24000; none of 10⁴ such means exceeds five of
    // them.
    let bound = 5.0 / (2.0 * n).sqrt();
    for lane in 0..L {
        for other in 0..lane {
            let together = correlation(&|k| rows[k][lane], &|k| rows[k][other]);
            assert!(together.abs() < bound, "lanes {lane} and {other}: {together}");
        }
        for lag in 1..=6 {
            let again = correlation(&|k| rows[k][lane], &|k| rows[k + lag][lane]);
            let squares =
                correlation(&|k| rows[k][lane].powi(2) - 1.0, &|k| rows[k + lag][lane].powi(2) - 1.0);
            assert!(
                again.abs() < bound && squares.abs() < 3.0 * bound,
                "lane {lane}, lag {lag}: {again} {squares}"
            );
        }
    }
}

#[test]
fn stream_is_independent_of_its_lane() {
    let (here, there) = (deviates(3, 0, 10), deviates(3, 40, 10));
    for (a, b) in here.iter().zip(&there) {
        assert_eq!(a[45], b[5]);
        assert_ne!(a[44], b[5]);
    }
    assert_ne!(deviates(4, 0, 1), deviates(3, 0, 1));
    let mut streams = Streams::<4>::default();
    streams.start(1, 3, 9);
    streams.copy(1, 2);
    let mut drawn = [LaneArray([0.0; 4]); 5];
    streams.normals(&mut drawn);
    let [[first, .., last], ..] = drawn.map(|deviates| deviates.0);
    assert_eq!(drawn[0].0, [first, here[0][9], here[0][9], last]);
}

/// Draws deviates under [`dispatch_simd`] or [`dispatch_portable`].
struct Draw(Streams<L>);

impl Kernel for Draw {
    type Output = [LaneArray<f32, L>; 5];

    #[inline(always)]
    fn run(mut self) -> Self::Output {
        let mut drawn = [LaneArray([0.0; L]); 5];
        self.0.normals(&mut drawn);
        drawn
    }
}

#[test]
fn all_instruction_sets_draw_the_same_deviates() {
    let mut streams = Streams::default();
    for lane in 0..L {
        streams.start(lane, 11, lane as u64);
    }
    assert_eq!(dispatch_simd(Draw(streams)), dispatch_portable(Draw(streams)));
}
