//! Tests of the control law, limits, and motion in lanes against one robot in `f64`.
#![allow(clippy::float_cmp, reason = "bits are compared on purpose")]

use std::f64::consts::TAU;

use surepose::control::{
    Direction, Gains, HybridLaw, HybridState, Law, Limits, NavigationVariables, Tran2012Law,
};
use surepose::geometry::{Angle, Body, Goal, Map, Pose};
use surepose::kinematics::{DiffDrive, Integration, Twist};
use surepose::scalar::Scalar;
use surepose_simd::{Element, Kernel, LaneArray, LaneMask, Lanes, dispatch_portable, dispatch_simd};

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
        Which::Fitted(direction) => {
            Law::Hybrid(HybridLaw::fitted(&drive, &limits, S::from_f64(0.02), direction))
        }
        Which::Paper => Law::Tran2012(Tran2012Law {
            gains: Gains {
                k_v: S::from_f64(4.0),
                k_alpha: S::from_f64(8.0),
                h: S::from_f64(0.5),
                k_theta: S::from_f64(2.0),
            },
            capture_radius: S::from_f64(0.03),
            capture_heading: S::from_f64(3.2),
        }),
    }
}

fn robot<S: Scalar>() -> (DiffDrive<S>, Limits<S>) {
    let limits = Limits::symmetric(S::from_f64(0.3), S::from_f64(1e9));
    (DiffDrive::new(S::from_f64(0.05), S::from_f64(0.6)), limits)
}

/// One control period from any pose and hybrid state: next state, limited twist, and next pose.
#[inline(always)]
fn step<S: Scalar>(
    law: &Law<S>,
    pose: Pose<Map, Body, S>,
    memory: HybridState<S>,
) -> (HybridState<S>, Twist<S>, Pose<Map, Body, S>) {
    let (drive, limits) = robot::<S>();
    let goal: Pose<Map, Goal, S> = Pose::identity();
    let output = law.compute(&NavigationVariables::from_poses(pose, goal), memory);
    let limited = limits.limit_speed(&drive, output.twist);
    (output.state, limited, pose.integrate(limited.integrate_for(S::from_f64(0.02)), Integration::Arc))
}

/// Poses and hybrid states of `L` robots.
#[derive(Clone, Debug, PartialEq)]
struct LawBatch<T: Element> {
    pose: [LaneArray<T, L>; 3],
    /// local_mode, reverse, turn_direction, trim_ticks, drive_direction, sidestep, lateral.
    memory: [LaneArray<T, L>; 7],
}

struct Run<T: Element>(LawBatch<T>, Which, usize);

impl<T: Element> Kernel for Run<T> {
    type Output = LawBatch<T>;

    #[inline(always)]
    fn run(self) -> LawBatch<T> {
        let Self(mut batch, which, periods) = self;
        let law = law::<Lanes<T, N>>(which);
        for _ in 0..periods {
            let LawBatch { pose: [x, y, heading], memory } = &mut batch;
            let [local_mode, reverse, turn_direction, trim_ticks, drive_direction, sidestep, lateral] =
                memory;
            for k in LaneArray::<T, L>::rows::<N>() {
                let pose = Pose::new(x.get(k), y.get(k), Angle::from_radians_unchecked(heading.get(k)));
                let memory = HybridState {
                    local_mode: local_mode.mask(k),
                    reverse: reverse.mask(k),
                    turn_direction: turn_direction.get(k),
                    trim_ticks: trim_ticks.get(k),
                    drive_direction: drive_direction.get(k),
                    sidestep: sidestep.get(k),
                    lateral: lateral.get(k),
                };
                let (memory, _, pose) = step(&law, pose, memory);
                x.set(k, pose.x);
                y.set(k, pose.y);
                heading.set(k, pose.heading.radians());
                local_mode.set_mask(k, memory.local_mode);
                reverse.set_mask(k, memory.reverse);
                turn_direction.set(k, memory.turn_direction);
                trim_ticks.set(k, memory.trim_ticks);
                drive_direction.set(k, memory.drive_direction);
                sidestep.set(k, memory.sidestep);
                lateral.set(k, memory.lateral);
            }
        }
        batch
    }
}

const LAWS: [Which; 4] = [
    Which::Fitted(Direction::Auto),
    Which::Fitted(Direction::Forward),
    Which::Fitted(Direction::Reverse),
    Which::Paper,
];

/// Start poses around the goal at various distances and headings.
fn starts<T: Element>() -> LawBatch<T> {
    let at = |f: fn(f64) -> f64| LaneArray(std::array::from_fn(|k| T::from_f64(f(k as f64))));
    let radius = |k: f64| 0.01 + 3.0 * (k * 0.618).fract();
    assert!(radius(5.0) > 0.0);
    LawBatch {
        pose: [
            at(|k| (0.01 + 3.0 * (k * 0.618).fract()) * (k * 2.4).cos()),
            at(|k| (0.01 + 3.0 * (k * 0.618).fract()) * (k * 2.4).sin()),
            at(|k| ((k * 0.37).fract() - 0.5) * TAU),
        ],
        memory: [LaneArray::default(); 7],
    }
}

#[test]
fn lanes_match_the_scalar_control_step() {
    for which in LAWS {
        let (alone, side_by_side) = (law::<f64>(which), law::<Lanes<f64, N>>(which));
        let (mut worst, mut decisions) = (0.0_f64, 0);
        for k in 0..200_000_u32 {
            let k = f64::from(k);
            let radius = 10_f64.powf(-3.0 + 4.0 * (k * 0.618_034).fract());
            let (x, y) = (radius * (k * 2.4).cos(), radius * (k * 2.4).sin());
            let heading = ((k * 0.754_877).fract() - 0.5) * TAU;
            let (local_mode, reverse) = ((k * 0.569_84).fract() < 0.5, (k * 0.31).fract() < 0.5);
            let turn_direction = [-1.0, 0.0, 1.0][(k % 3.0) as usize];

            let one = step(
                &alone,
                Pose::new(x, y, Angle::from_radians(heading)),
                HybridState { local_mode, reverse, turn_direction, ..HybridState::new() },
            );
            let num = |value: f64| Lanes::<f64, N>::from_f64(value);
            let memory = HybridState {
                local_mode: LaneMask([local_mode; N]),
                reverse: LaneMask([reverse; N]),
                turn_direction: num(turn_direction),
                ..HybridState::new()
            };
            let many =
                step(&side_by_side, Pose::new(num(x), num(y), Angle::from_radians(num(heading))), memory);

            let same = many.0.local_mode.0[1] == one.0.local_mode && many.0.reverse.0[1] == one.0.reverse;
            assert!(
                same && many.0.turn_direction.0[1] == one.0.turn_direction,
                "{which:?} at {x} {y} {heading}"
            );
            decisions += usize::from(one.0.local_mode) + usize::from(one.0.reverse);
            let off =
                [(many.1.v, one.1.v), (many.1.omega, one.1.omega), (many.2.x, one.2.x), (many.2.y, one.2.y)];
            worst = off.iter().fold(worst, |worst, (many, one)| worst.max((many.0[1] - one).abs()));
        }
        // A few ulps of the angles, times the largest gain relative to wheel speed.
        assert!(worst < 2e-13, "{which:?}: {worst:e}");
        assert!(decisions > 1000, "{which:?}: no mode decisions");
    }
}

#[test]
fn batch_matches_a_single_robot() {
    for which in LAWS {
        let batch = dispatch_simd(Run(starts::<f64>(), which, 1000));
        let (from, alone) = (starts::<f64>(), law::<f64>(which));
        for k in 0..L {
            let mut pose =
                Pose::new(from.pose[0].0[k], from.pose[1].0[k], Angle::from_radians(from.pose[2].0[k]));
            let mut memory = HybridState::new();
            for _ in 0..1000 {
                let next = step(&alone, pose, memory);
                (memory, pose) = (next.0, next.2);
            }
            let off = (batch.pose[0].0[k] - pose.x).abs().max((batch.pose[1].0[k] - pose.y).abs());
            assert!(off < 1e-9, "{which:?}, robot {k}: distance {off:e} m");
        }
    }
}

#[test]
fn all_instruction_sets_give_the_same_bits() {
    for which in LAWS {
        assert_eq!(
            dispatch_simd(Run(starts::<f64>(), which, 300)),
            dispatch_portable(Run(starts::<f64>(), which, 300)),
            "{which:?}"
        );
        assert_eq!(
            dispatch_simd(Run(starts::<f32>(), which, 300)),
            dispatch_portable(Run(starts::<f32>(), which, 300)),
            "{which:?}"
        );
    }
}

#[test]
fn nan_in_one_lane_does_not_affect_other_lanes() {
    let mut broken = starts::<f64>();
    broken.pose[0].0[5] = f64::NAN;
    broken.pose[1].0[9] = f64::INFINITY;
    for which in LAWS {
        let (with, without) =
            (dispatch_simd(Run(broken.clone(), which, 100)), dispatch_simd(Run(starts::<f64>(), which, 100)));
        for k in (0..L).filter(|k| ![5, 9].contains(k)) {
            assert_eq!(with.pose[0].0[k].to_bits(), without.pose[0].0[k].to_bits());
        }
        assert!(!with.pose[0].0[5].is_finite());
    }
}
