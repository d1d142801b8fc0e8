//! Lyapunov function W and bounds of its rate along an arc.

use core::f64::consts::{FRAC_PI_2, PI};

use surepose::control::NavigationVariables;
use surepose::geometry::Angle;
use surepose::kinematics::Twist;
use surepose::scalar::Scalar;

use crate::discrete_state::DiscreteState;
use crate::interval::Interval;
use crate::noise::DrivenTwist;

/// Interval that encloses the real number π.
pub(crate) const PI_ENCLOSED: fn() -> Interval = || Interval::new(PI, PI.next_up());

/// W = F(ρ) + ½(a² + h·φ²) with F′ = c/min(ρ, knee).
///
/// a is the bearing of the leading end and φ is its approach angle. a is unwrapped toward the turn direction
/// of the hybrid state. Near the goal F is c·ln ρ, because the angular dynamics do not depend on ρ there. Far
/// away F is linear, because the robot drives at its speed limit there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LyapunovFunction {
    /// Distance weight c.
    pub distance: f64,
    /// Distance at which F changes from logarithmic to linear \[m].
    pub knee: f64,
    /// Approach weight h.
    pub approach: f64,
}

/// True goal geometry for a discrete state: intervals of ρ \[m], a \[rad], and φ \[rad].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub(crate) rho: Interval,
    pub(crate) bearing: Interval,
    pub(crate) approach: Interval,
    /// Whether the robot drives in reverse.
    pub(crate) reverse: bool,
}

/// Range of the unwrapped bearing: π around ±π/2, or around 0 if no turn direction is decided.
pub(crate) fn window(side: i8) -> Interval {
    let middle = Interval::point(f64::from(side)) * Interval::point(FRAC_PI_2);
    middle + Interval::symmetric(PI)
}

impl LyapunovFunction {
    /// Slope F′(ρ).
    fn slope(&self, rho: Interval) -> Interval {
        Interval::point(self.distance) / Scalar::min(rho, Interval::point(self.knee))
    }

    /// F(ρ), to rounding.
    pub(crate) fn distance_term(&self, rho: f64) -> f64 {
        let near = rho.min(self.knee);
        let beyond = if rho > near { (rho - near) / self.knee } else { 0.0 };
        self.distance * (near.ln() + beyond)
    }

    /// Inverse of [`LyapunovFunction::distance_term`], to rounding \[m].
    pub(crate) fn distance_from_term(&self, value: f64) -> f64 {
        let beyond = value / self.distance - self.knee.ln();
        if beyond > 0.0 { self.knee * (1.0 + beyond) } else { (value / self.distance).exp() }
    }

    /// Largest contribution of the angles to W: |a| ≤ 3π/2 and |φ| ≤ π.
    pub(crate) fn max_angle_terms(&self) -> f64 {
        let bearing = 1.5 * PI;
        0.5 * (bearing * bearing + self.approach * PI * PI)
    }

    /// W(ρ, a, φ), to rounding; `rho` in m, angles in rad.
    pub fn value(&self, rho: f64, bearing: f64, approach: f64) -> f64 {
        self.distance_term(rho) + 0.5 * (bearing * bearing + self.approach * approach * approach)
    }

    /// W at the true navigation variables for `discrete_state`, to rounding.
    pub fn at(&self, truth: &NavigationVariables<f64>, discrete_state: DiscreteState) -> f64 {
        let ahead = if discrete_state.reverse { truth.reversed() } else { *truth };
        let mut bearing = ahead.alpha.radians();
        let side = f64::from(discrete_state.turn_direction);
        if bearing * side < -FRAC_PI_2 {
            bearing += side * core::f64::consts::TAU;
        }
        self.value(ahead.rho, bearing, ahead.phi.radians())
    }

    /// Bounds the mean of Ẇ over every initial part of the period \[1/s].
    ///
    /// The twist is held for `period` \[s], which is cut into `slices`. ∞: no bound exists. A robot slowed
    /// down by a common factor drives an initial part of the same arc, so the bound holds for it too.
    pub(crate) fn mean_rate(&self, truth: &Truth, twist: &DrivenTwist, period: f64, slices: usize) -> f64 {
        let Some(flow) = truth.flow(twist.all, period) else { return f64::INFINITY };
        let mut sum = Interval::point(0.0);
        let mut worst = f64::NEG_INFINITY;
        for slice in 0..slices {
            let time = Interval::new(0.0, period).piece(slice, slices);
            let there = truth.after(&flow, time);
            // Ẇ is linear in the twist, so a corner has the largest one, also where wheel errors vary within the tick.
            let rates = twist.corners().map(|corner| self.rate(&there, corner));
            sum = sum + rates.reduce(Interval::hull).unwrap_or(Interval::ENTIRE);
            worst = worst.max((sum / Interval::point((slice + 1) as f64)).hi());
        }
        worst
    }

    /// Replaces the bearing by 0: the rates of a turn in place do not depend on the bearing.
    fn facing(truth: &Truth) -> Truth {
        Truth { bearing: Interval::point(0.0), ..*truth }
    }

    /// Ẇ \[1/s]. Ẇ is linear in the twist, so (v, 0) and (0, ω) are evaluated separately; for (v, 0), α̇ =
    /// φ̇.
    fn rate(&self, truth: &Truth, twist: Twist<Interval>) -> Interval {
        let still = Interval::point(0.0);
        let (rho, _, swing) = truth.rates(Twist::new(twist.v, still));
        let facing = Self::facing(truth);
        let (_, turning, _) = facing.rates(Twist::new(still, twist.omega));
        let lever = truth.bearing + Interval::point(self.approach) * truth.approach;
        self.slope(truth.rho) * rho + lever * swing + truth.bearing * turning
    }
}

impl Truth {
    /// ρ̇, ȧ, and φ̇: [Tran2012] Eq. (2).
    fn rates(&self, twist: Twist<Interval>) -> (Interval, Interval, Interval) {
        // Half turns are removed from a, each with a sign change of v, so that the angle is far from its
        // branch cut.
        let half_turns = (self.bearing.mid() / PI).round();
        let local = self.bearing - PI_ENCLOSED() * Interval::point(half_turns);
        let flipped = (half_turns.rem_euclid(2.0) > 0.5) != self.reverse;
        let v = if flipped { -twist.v } else { twist.v };
        let ahead = NavigationVariables {
            rho: self.rho,
            alpha: Angle::from_radians_unchecked(local),
            phi: Angle::zero(),
        };
        ahead.rates(Twist::new(v, twist.omega))
    }

    /// Bounds the rates over `period` \[s]. `None`: the robot may reach the goal within it.
    fn flow(&self, twist: Twist<Interval>, period: f64) -> Option<(Interval, Interval, Interval)> {
        let time = Interval::new(0.0, period);
        let length = time * twist.v.abs();
        let rho = self.rho + length.hull(-length);
        if rho.lo() <= 0.0 {
            return None;
        }
        let swing = twist.v * Interval::symmetric(1.0) / rho;
        let bearing = self.bearing + time * (swing - twist.omega);
        let approach = self.approach + time * swing;
        // Each iteration maps valid bounds to tighter valid bounds.
        let mut on_the_way = Self { rho, bearing, approach, ..*self };
        for _ in 0..2 {
            let flow = on_the_way.rates(twist);
            on_the_way = self.after(&flow, time);
            on_the_way.rho = on_the_way.rho.intersection(rho)?;
        }
        Some(on_the_way.rates(twist))
    }

    /// State after a time in `time`, with rates within `flow`.
    fn after(&self, flow: &(Interval, Interval, Interval), time: Interval) -> Self {
        Self {
            rho: self.rho + time * flow.0,
            bearing: self.bearing + time * flow.1,
            approach: self.approach + time * flow.2,
            ..*self
        }
    }

    /// All states during `period` \[s]. `None`: the robot may reach the goal within it.
    pub(crate) fn swept(&self, twist: Twist<Interval>, period: f64) -> Option<Self> {
        let flow = self.flow(twist, period)?;
        Some(self.after(&flow, Interval::new(0.0, period)))
    }
}
