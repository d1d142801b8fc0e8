//! Mutation tests: every faulty control law and every wrong gain is refused.

mod common;

use common::{deployed, hybrid, noise, request};
use surepose::control::{ControlOutput, HybridState, NavigationVariables};
use surepose::geometry::Angle;
use surepose::kinematics::Twist;
use surepose::scalar::{Mask, Scalar};
use surepose_cert::{DeployedController, SampledController, certify};

/// Faults inserted into the control law.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    DrivesAway,
    TurnsAway,
    NeverDrives,
    NeverTurns,
    TurnsLeftOnly,
    DrivesNoseFirstOnly,
    DrivesWhateverTheBearing,
    SineForCosine,
    BearingMirrored,
    BearingBiased,
    BearingNotWrapped,
    ApproachForBearing,
    GoalBehind,
    TailNotMirrored,
    MemoryForgotten,
    DirectionConfused,
    SideConfused,
    NoSpeedLimit,
    LimitsTurnOnly,
    LimitsDriveOnly,
    DistanceNotSeen,
    LocalDrivesAway,
    LocalTurnsAway,
    LocalNeverTurns,
    LocalNeverInCharge,
}

struct Mutant {
    law: DeployedController,
    fault: Fault,
}

impl SampledController for Mutant {
    fn compute<S: Scalar>(&self, seen: &NavigationVariables<S>, before: HybridState<S>) -> ControlOutput<S> {
        let (mut seen, mut before) = (*seen, before);
        match self.fault {
            Fault::BearingMirrored => seen.alpha = -seen.alpha,
            Fault::BearingBiased => seen.alpha = seen.alpha.rotated_by(S::from_f64(0.6)),
            Fault::ApproachForBearing => seen.alpha = seen.phi,
            Fault::GoalBehind => seen.alpha = seen.alpha + Angle::half_turn(),
            Fault::MemoryForgotten => before = HybridState::new(),
            Fault::DirectionConfused => before.reverse = !before.reverse,
            Fault::SideConfused => before.turn_direction = -before.turn_direction,
            Fault::DistanceNotSeen => seen.rho = S::from_f64(0.0),
            _ => {}
        }
        let output = self.law.compute(&seen, before);
        let Twist { v, omega } = output.twist;
        let (near, zero) = (output.state.local_mode, S::from_f64(0.0));
        let local = |there: Twist<S>| Twist::select(near, there, output.twist);
        let (sin, cos) = seen.alpha.sin_cos();
        let twist = match self.fault {
            Fault::DrivesAway => Twist::new(-v, omega),
            Fault::TurnsAway => Twist::new(v, -omega),
            Fault::NeverDrives => Twist::new(zero, omega),
            Fault::NeverTurns => Twist::new(v, zero),
            Fault::TurnsLeftOnly => Twist::new(v, omega.abs()),
            Fault::DrivesNoseFirstOnly => Twist::new(v.abs(), omega),
            Fault::DrivesWhateverTheBearing => Twist::new(S::from_f64(0.3), omega),
            Fault::SineForCosine => Twist::new(seen.rho.min(S::from_f64(0.3)) * sin, omega),
            Fault::BearingNotWrapped => {
                let turn = S::select(seen.alpha.radians().lt(zero), S::from_f64(75.0), zero);
                Twist::new(v, omega + turn)
            }
            Fault::TailNotMirrored => {
                Twist::select(output.state.reverse, Twist::new(-v, omega), output.twist)
            }
            Fault::LocalDrivesAway => local(Twist::new(-v, omega)),
            Fault::LocalTurnsAway => local(Twist::new(v, -omega)),
            Fault::LocalNeverTurns => local(Twist::new(v + zero * cos, zero)),
            _ => output.twist,
        };
        let mut memory = output.state;
        if self.fault == Fault::LocalNeverInCharge {
            memory.local_mode = S::Mask::splat(false);
        }
        ControlOutput { twist, state: memory }
    }

    fn limit<S: Scalar>(&self, desired: Twist<S>) -> Twist<S> {
        let limited = self.law.limit(desired);
        match self.fault {
            Fault::NoSpeedLimit => desired,
            Fault::LimitsTurnOnly => Twist::new(desired.v, limited.omega),
            Fault::LimitsDriveOnly => Twist::new(limited.v, desired.omega),
            _ => limited,
        }
    }
}

const FAULTS: [Fault; 25] = [
    Fault::DrivesAway,
    Fault::TurnsAway,
    Fault::NeverDrives,
    Fault::NeverTurns,
    Fault::TurnsLeftOnly,
    Fault::DrivesNoseFirstOnly,
    Fault::DrivesWhateverTheBearing,
    Fault::SineForCosine,
    Fault::BearingMirrored,
    Fault::BearingBiased,
    Fault::BearingNotWrapped,
    Fault::ApproachForBearing,
    Fault::GoalBehind,
    Fault::TailNotMirrored,
    Fault::MemoryForgotten,
    Fault::DirectionConfused,
    Fault::SideConfused,
    Fault::NoSpeedLimit,
    Fault::LimitsTurnOnly,
    Fault::LimitsDriveOnly,
    Fault::DistanceNotSeen,
    Fault::LocalDrivesAway,
    Fault::LocalTurnsAway,
    Fault::LocalNeverTurns,
    Fault::LocalNeverInCharge,
];

#[test]
fn every_fault_is_refused() {
    let law = hybrid(0.02);
    let mut passed = Vec::new();
    for fault in FAULTS {
        let mutant = Mutant { law: deployed(law), fault };
        let certificate = certify(&request(&mutant, law.gains.h, 0.02, noise(0.007, 0.25)));
        println!(
            "{fault:?}: {:?}, counterexample {}",
            certificate.reason,
            certificate.counterexample.is_some()
        );
        if certificate.certified || certificate.counterexample.is_none() {
            passed.push(fault);
        }
    }
    assert!(passed.is_empty(), "certified, or refused without a counterexample: {passed:?}");
}

#[test]
fn wrong_gains_are_refused() {
    let good = hybrid(0.02);
    let wrong = |change: fn(&mut surepose::control::HybridLaw<f64>)| {
        let mut law = good;
        change(&mut law);
        law
    };
    for (name, law) in [
        ("k_α·ΔT above 2", wrong(|law| law.gains.k_alpha *= 12.0)),
        ("k_α negative", wrong(|law| law.gains.k_alpha *= -1.0)),
        ("k_v negative", wrong(|law| law.gains.k_v *= -1.0)),
        ("h of wrong sign and magnitude", wrong(|law| law.gains.h = -6.0)),
        ("k_θ negative", wrong(|law| law.gains.k_theta *= -1.0)),
        ("k_α near zero", wrong(|law| law.gains.k_alpha *= 1e-3)),
    ] {
        let controller = deployed(law);
        let certificate = certify(&request(&controller, good.gains.h, 0.02, noise(0.007, 0.25)));
        println!("{name}: {:?}", certificate.reason);
        assert!(!certificate.certified, "{name}");
    }
}
