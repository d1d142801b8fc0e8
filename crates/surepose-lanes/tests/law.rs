//! The core's law, limits and motion in lanes: what one robot does alone in `f64`, `N` do side by side.
#![allow(clippy::float_cmp, reason = "bits are compared on purpose")]

use std::f64::consts::TAU;

use surepose::{
    Angle, Body, Direction, Drive, Gains, Goal, HybridLaw, Integration, Law, Limits, Map, Memory, Navigation,
    PaperLaw, Pose, Scalar, Twist,
};
use surepose_lanes::{Column, Element, LaneMask, Lanes, Work, on_widest, portably};

const L: usize = 64;
const N: usize = 4;

#[derive(Clone, Copy, Debug)]
enum Which {
    Fitted(Direction),
    Paper,
}

fn law<S: Scalar>(which: Which) -> Law<S> {
    let (drive, limits) = robot::<S>();
    match which {
        Which::Fitted(direction) => Law::Hybrid(HybridLaw::fitted(&drive, &limits, S::of(0.02), direction)),
        Which::Paper => Law::Paper(PaperLaw {
            gains: Gains { k_v: S::of(4.0), k_alpha: S::of(8.0), h: S::of(0.5), k_theta: S::of(2.0) },
            capture_radius: S::of(0.03),
            capture_heading: S::of(3.2),
        }),
    }
}

fn robot<S: Scalar>() -> (Drive<S>, Limits<S>) {
    let limits = Limits { wheel_speed: S::of(0.3), wheel_acceleration: S::of(1e9) };
    (Drive::new(S::of(0.05), S::of(0.6)), limits)
}

/// One period of the law, from any pose and memory: the decision, and the pose it leads to.
#[inline(always)]
fn step<S: Scalar>(
    law: &Law<S>,
    pose: Pose<Map, Body, S>,
    memory: Memory<S>,
) -> (Memory<S>, Twist<S>, Pose<Map, Body, S>) {
    let (drive, limits) = robot::<S>();
    let goal: Pose<Map, Goal, S> = Pose::identity();
    let decision = law.decide(&Navigation::of(pose, goal), memory);
    let granted = limits.within_speed(&drive, decision.twist);
    (decision.memory, granted, pose.moved(granted.over(S::of(0.02)), Integration::Arc))
}

/// `L` robots for a number of periods.
#[derive(Clone, Debug, PartialEq)]
struct Fleet<T: Element> {
    pose: [Column<T, L>; 3],
    /// near, reverse, side, trims, travel.
    memory: [Column<T, L>; 5],
}

struct Run<T: Element>(Fleet<T>, Which, usize);

impl<T: Element> Work for Run<T> {
    type Output = Fleet<T>;

    #[inline(always)]
    fn run(self) -> Fleet<T> {
        let Self(mut fleet, which, periods) = self;
        let law = law::<Lanes<T, N>>(which);
        for _ in 0..periods {
            let ([x, y, heading], [near, reverse, side, trims, travel]) =
                (&mut fleet.pose, &mut fleet.memory);
            for k in Column::<T, L>::rows::<N>() {
                let pose = Pose::new(x.get(k), y.get(k), Angle::from_wrapped(heading.get(k)));
                let memory = Memory {
                    near: near.mask(k),
                    reverse: reverse.mask(k),
                    side: side.get(k),
                    trims: trims.get(k),
                    travel: travel.get(k),
                };
                let (memory, _, pose) = step(&law, pose, memory);
                x.set(k, pose.x);
                y.set(k, pose.y);
                heading.set(k, pose.heading.radians());
                near.set_mask(k, memory.near);
                reverse.set_mask(k, memory.reverse);
                side.set(k, memory.side);
                trims.set(k, memory.trims);
                travel.set(k, memory.travel);
            }
        }
        fleet
    }
}

const LAWS: [Which; 4] = [
    Which::Fitted(Direction::Auto),
    Which::Fitted(Direction::Forward),
    Which::Fitted(Direction::Reverse),
    Which::Paper,
];

/// Poses all round the goal, near and far, in every heading.
fn starts<T: Element>() -> Fleet<T> {
    let at = |f: fn(f64) -> f64| Column(std::array::from_fn(|k| T::of(f(k as f64))));
    let radius = |k: f64| 0.01 + 3.0 * (k * 0.618).fract();
    assert!(radius(5.0) > 0.0);
    Fleet {
        pose: [
            at(|k| (0.01 + 3.0 * (k * 0.618).fract()) * (k * 2.4).cos()),
            at(|k| (0.01 + 3.0 * (k * 0.618).fract()) * (k * 2.4).sin()),
            at(|k| ((k * 0.37).fract() - 0.5) * TAU),
        ],
        memory: [Column::default(); 5],
    }
}

#[test]
fn lanes_decide_as_one_robot_does() {
    for which in LAWS {
        let (alone, side_by_side) = (law::<f64>(which), law::<Lanes<f64, N>>(which));
        let (mut worst, mut decisions) = (0.0_f64, 0);
        for k in 0..200_000_u32 {
            let k = f64::from(k);
            let radius = 10_f64.powf(-3.0 + 4.0 * (k * 0.618_034).fract());
            let (x, y) = (radius * (k * 2.4).cos(), radius * (k * 2.4).sin());
            let heading = ((k * 0.754_877).fract() - 0.5) * TAU;
            let (near, reverse) = ((k * 0.569_84).fract() < 0.5, (k * 0.31).fract() < 0.5);
            let side = [-1.0, 0.0, 1.0][(k % 3.0) as usize];

            let one = step(
                &alone,
                Pose::new(x, y, Angle::wrapped(heading)),
                Memory { near, reverse, side, ..Memory::fresh() },
            );
            let of = |value: f64| Lanes::<f64, N>::of(value);
            let memory = Memory {
                near: LaneMask([near; N]),
                reverse: LaneMask([reverse; N]),
                side: of(side),
                ..Memory::fresh()
            };
            let many = step(&side_by_side, Pose::new(of(x), of(y), Angle::wrapped(of(heading))), memory);

            let same = many.0.near.0[1] == one.0.near && many.0.reverse.0[1] == one.0.reverse;
            assert!(same && many.0.side.0[1] == one.0.side, "{which:?} at {x} {y} {heading}");
            decisions += usize::from(one.0.near) + usize::from(one.0.reverse);
            let off =
                [(many.1.v, one.1.v), (many.1.omega, one.1.omega), (many.2.x, one.2.x), (many.2.y, one.2.y)];
            worst = off.iter().fold(worst, |worst, (many, one)| worst.max((many.0[1] - one).abs()));
        }
        // Some ulps of the angles, times the largest gain over wheel speed.
        assert!(worst < 2e-13, "{which:?}: {worst:e}");
        assert!(decisions > 1000, "{which:?} decided nothing");
    }
}

#[test]
fn a_fleet_ends_where_one_robot_does() {
    for which in LAWS {
        let fleet = on_widest(Run(starts::<f64>(), which, 1000));
        let (from, alone) = (starts::<f64>(), law::<f64>(which));
        for k in 0..L {
            let mut pose = Pose::new(from.pose[0].0[k], from.pose[1].0[k], Angle::wrapped(from.pose[2].0[k]));
            let mut memory = Memory::fresh();
            for _ in 0..1000 {
                let next = step(&alone, pose, memory);
                (memory, pose) = (next.0, next.2);
            }
            let off = (fleet.pose[0].0[k] - pose.x).abs().max((fleet.pose[1].0[k] - pose.y).abs());
            assert!(off < 1e-9, "{which:?}, robot {k} ends {off:e} m apart");
        }
    }
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    for which in LAWS {
        assert_eq!(
            on_widest(Run(starts::<f64>(), which, 300)),
            portably(Run(starts::<f64>(), which, 300)),
            "{which:?}"
        );
        assert_eq!(
            on_widest(Run(starts::<f32>(), which, 300)),
            portably(Run(starts::<f32>(), which, 300)),
            "{which:?}"
        );
    }
}

#[test]
fn a_broken_robot_does_not_touch_its_neighbours() {
    let mut broken = starts::<f64>();
    broken.pose[0].0[5] = f64::NAN;
    broken.pose[1].0[9] = f64::INFINITY;
    for which in LAWS {
        let (with, without) =
            (on_widest(Run(broken.clone(), which, 100)), on_widest(Run(starts::<f64>(), which, 100)));
        for k in (0..L).filter(|k| ![5, 9].contains(k)) {
            assert_eq!(with.pose[0].0[k].to_bits(), without.pose[0].0[k].to_bits());
        }
        assert!(!with.pose[0].0[5].is_finite());
    }
}
