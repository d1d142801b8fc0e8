//! V̇ of both laws, [Tran2012] Eq. (2), (19)–(29), against differences along the exact motion.

use proptest::prelude::*;
use surepose::control::{GlobalLaw, LocalLaw, NavigationNoise, NavigationVariables};
use surepose::geometry::{Angle, Body, Goal, Map, Pose};
use surepose::kinematics::{Integration, Twist};

const GLOBAL: GlobalLaw<f64> = GlobalLaw { k_v: 1.5, k_alpha: 4.0, h: 0.7 };
const LOCAL: LocalLaw<f64> = LocalLaw { k_v: 1.5, k_theta: 2.0 };

fn goal() -> Pose<Map, Goal, f64> {
    Pose::new(0.4, -0.3, Angle::from_degrees(50.0))
}

fn start() -> impl Strategy<Value = Pose<Map, Body, f64>> {
    (-3.0..3.0, -3.0..3.0, -3.1..3.1).prop_map(|(x, y, t)| Pose::new(x, y, Angle::from_radians(t)))
}

/// Computes dV/dt of `value` along the arc of `twist` by central differences.
fn rate(
    pose: Pose<Map, Body, f64>,
    twist: Twist<f64>,
    value: impl Fn(&NavigationVariables<f64>) -> f64,
) -> f64 {
    let step = 1e-6;
    let at = |t: f64| {
        value(&NavigationVariables::from_poses(
            pose.integrate(twist.integrate_for(t), Integration::Arc),
            goal(),
        ))
    };
    (at(step) - at(-step)) / (2.0 * step)
}

/// Excludes the discontinuities of α, φ and θ_e, and the goal, where V has no derivative.
fn smooth(n: &NavigationVariables<f64>) -> bool {
    n.rho > 0.1 && [n.alpha, n.phi, n.heading_error()].iter().all(|a| a.radians().abs() < 3.1)
}

proptest! {
    /// Eq. (2): the rates equal the time derivatives of the navigation variables.
    #[test]
    fn navigation_rates(pose in start(), v in -1.0..1.0, omega in -2.0..2.0) {
        let (twist, n) = (Twist::new(v, omega), NavigationVariables::from_poses(pose, goal()));
        prop_assume!(smooth(&n));
        let (rho, alpha, phi) = n.rates(twist);
        prop_assert!((rate(pose, twist, |n| n.rho) - rho).abs() < 1e-6);
        prop_assert!((rate(pose, twist, |n| n.alpha.radians()) - alpha).abs() < 1e-5);
        prop_assert!((rate(pose, twist, |n| n.phi.radians()) - phi).abs() < 1e-5);
    }

    /// (19)–(23): V̇_g = −k_v ρ² cos²α − k_α α².
    #[test]
    fn the_global_law_descends(pose in start()) {
        let n = NavigationVariables::from_poses(pose, goal());
        prop_assume!(smooth(&n));
        let twist = GLOBAL.twist(&n);
        let (alpha, rho) = (n.alpha.radians(), n.rho);
        let claimed = -GLOBAL.k_v * (rho * alpha.cos()).powi(2) - GLOBAL.k_alpha * alpha.powi(2);
        prop_assert!((GLOBAL.lyapunov_rate(&n, twist) - claimed).abs() < 1e-9 * (1.0 + claimed.abs()));
        prop_assert!((rate(pose, twist, |n| GLOBAL.lyapunov(n)) - claimed).abs() < 1e-5 * (1.0 + claimed.abs()));
    }

    /// (26)–(29) with corrected signs: V̇_l = −k_v ρ² cos²α − k_θ θ_e².
    #[test]
    fn the_local_law_descends(pose in start()) {
        let n = NavigationVariables::from_poses(pose, goal());
        prop_assume!(smooth(&n));
        let twist = LOCAL.twist(&n);
        let error = n.heading_error().radians();
        let claimed = -LOCAL.k_v * (n.rho * n.alpha.radians().cos()).powi(2) - LOCAL.k_theta * error.powi(2);
        prop_assert!((LOCAL.lyapunov_rate(&n, twist) - claimed).abs() < 1e-9 * (1.0 + claimed.abs()));
        prop_assert!((rate(pose, twist, |n| LOCAL.lyapunov(n)) - claimed).abs() < 1e-5 * (1.0 + claimed.abs()));
    }

    /// A positive factor on the twist keeps the sign of both V̇, as the limits require.
    #[test]
    fn scaling_scales_the_descent(pose in start(), factor in 0.01..5.0) {
        let n = NavigationVariables::from_poses(pose, goal());
        let (global, local) = (GLOBAL.twist(&n), LOCAL.twist(&n));
        let whole = GLOBAL.lyapunov_rate(&n, global);
        prop_assert!((GLOBAL.lyapunov_rate(&n, global.scaled(factor)) - whole * factor).abs() < 1e-9 * (1.0 + whole.abs() * factor));
        let whole = LOCAL.lyapunov_rate(&n, local);
        prop_assert!((LOCAL.lyapunov_rate(&n, local.scaled(factor)) - whole * factor).abs() < 1e-9 * (1.0 + whole.abs() * factor));
    }

    /// (3): φ − α is the heading error for every pose.
    #[test]
    fn heading_error_is_phi_minus_alpha(pose in start()) {
        let n = NavigationVariables::from_poses(pose, goal());
        let difference = n.heading_error() - (pose.heading - goal().heading);
        prop_assert!(difference.radians().abs() < 1e-12);
    }

    /// (4) with the corrected ε_φ: ε_α = ε_φ − ε_θ.
    #[test]
    fn noise_of_alpha_is_that_of_phi_less_that_of_theta(pose in start(), ex in -0.1..0.1, ey in -0.1..0.1, et in -0.3..0.3) {
        let estimate = Pose::new(pose.x + ex, pose.y + ey, pose.heading.rotated_by(et));
        let noise = NavigationNoise::between(NavigationVariables::from_poses(estimate, goal()), NavigationVariables::from_poses(pose, goal()));
        let left = noise.phi - Angle::from_radians(et) - noise.alpha;
        prop_assert!(left.radians().abs() < 1e-12);
        prop_assert!(noise.rho.abs() <= f64::hypot(ex, ey) + 1e-12);
    }
}

/// Eq. (28) as printed diverges: V̇_l = +k_v ρ² cos²α − k_θ θ_e².
#[test]
fn the_printed_local_law_leaves_the_goal() {
    let printed = LOCAL.as_printed();
    let mut pose: Pose<Map, Body, f64> = goal() * Pose::<Goal, Body, f64>::new(-0.01, 0.0, Angle::zero());
    let before = NavigationVariables::from_poses(pose, goal()).rho;
    for _ in 0..200 {
        let twist = printed.twist(&NavigationVariables::from_poses(pose, goal()));
        pose = pose.integrate(twist.integrate_for(0.01), Integration::Arc);
    }
    let after = NavigationVariables::from_poses(pose, goal()).rho;
    // ρ̇ = k_v ρ along the axis: the distance grows by e³ ≈ 20 in 2 s.
    assert!((after / before - 3f64.exp()).abs() < 0.5, "from {before} m to {after} m");
}

#[test]
fn the_laws_are_finite_on_the_goal() {
    let on_goal = NavigationVariables::from_poses(
        goal() * Pose::<Goal, Body, f64>::new(0.0, 0.0, Angle::half_turn()),
        goal(),
    );
    assert!(on_goal.rho < 1e-15);
    for twist in [GLOBAL.twist(&on_goal), LOCAL.twist(&on_goal)] {
        assert!(twist.v.is_finite() && twist.omega.is_finite());
    }
}
