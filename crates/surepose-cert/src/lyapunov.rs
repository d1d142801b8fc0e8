//! The function W that falls at every tick, and how fast it falls along an arc.

use core::f64::consts::{FRAC_PI_2, PI};

use surepose::control::NavigationVariables;
use surepose::geometry::Angle;
use surepose::kinematics::Twist;
use surepose::scalar::Scalar;

use crate::discrete_state::DiscreteState;
use crate::interval::Interval;

/// The real number π, which no float is.
pub(crate) const PI_ENCLOSED: fn() -> Interval = || Interval::new(PI, PI.next_up());

/// W = F(ρ) + ½(a² + h·φ²) with F′ = c/min(ρ, knee).
///
/// a and φ are the bearing and the direction of approach of the end that goes first, a continued to the side that the
/// law remembers. Near the goal F is c·ln ρ, because there the loop of the angles does not depend on ρ; far away it
/// is linear, because there the robot drives at its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LyapunovFunction {
    /// c.
    pub distance: f64,
    /// Where F turns from logarithm to line \[m].
    pub knee: f64,
    /// h.
    pub approach: f64,
}

/// The goal as it truly lies, for a discrete state: intervals of ρ \[m], of a and of φ \[rad].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub(crate) rho: Interval,
    pub(crate) bearing: Interval,
    pub(crate) approach: Interval,
    /// The tail goes first.
    pub(crate) reverse: bool,
}

/// The bearings that `side` continues to: half a turn either way of ±π/2, or of 0 where no side is remembered.
pub(crate) fn window(side: i8) -> Interval {
    let middle = Interval::point(f64::from(side)) * Interval::point(FRAC_PI_2);
    middle + Interval::symmetric(PI)
}

impl LyapunovFunction {
    /// F′.
    fn slope(&self, rho: Interval) -> Interval {
        Interval::point(self.distance) / Scalar::min(rho, Interval::point(self.knee))
    }

    /// F, to rounding.
    pub(crate) fn distance_term(&self, rho: f64) -> f64 {
        let near = rho.min(self.knee);
        let beyond = if rho > near { (rho - near) / self.knee } else { 0.0 };
        self.distance * (near.ln() + beyond)
    }

    /// The distance at which F has this value: the inverse of [`LyapunovFunction::distance_term`], to rounding.
    pub(crate) fn distance_from_term(&self, value: f64) -> f64 {
        let beyond = value / self.distance - self.knee.ln();
        if beyond > 0.0 { self.knee * (1.0 + beyond) } else { (value / self.distance).exp() }
    }

    /// The most that the angles can contribute to W: both half a turn, the bearing continued and disturbed.
    pub(crate) fn max_angle_terms(&self) -> f64 {
        let bearing = 1.5 * PI;
        0.5 * (bearing * bearing + self.approach * PI * PI)
    }

    /// W, to rounding.
    pub fn value(&self, rho: f64, bearing: f64, approach: f64) -> f64 {
        self.distance_term(rho) + 0.5 * (bearing * bearing + self.approach * approach * approach)
    }

    /// W of the goal as it truly lies for `discrete_state`, to rounding.
    pub fn at(&self, truth: &NavigationVariables<f64>, discrete_state: DiscreteState) -> f64 {
        let ahead = if discrete_state.reverse { truth.reversed() } else { *truth };
        let mut bearing = ahead.alpha.radians();
        let side = f64::from(discrete_state.turn_direction);
        if bearing * side < -FRAC_PI_2 {
            bearing += side * core::f64::consts::TAU;
        }
        self.value(ahead.rho, bearing, ahead.phi.radians())
    }

    /// Upper bound of the mean of Ẇ over `period` and over every beginning of it, holding `twist`, by `slices` of time;
    /// infinite where there is none.
    ///
    /// The robot that is slowed down by a common factor drives a beginning of the same arc, so the bound is its too.
    pub(crate) fn mean_rate(&self, truth: &Truth, twist: Twist<Interval>, period: f64, slices: usize) -> f64 {
        let Some(flow) = truth.flow(twist, period) else { return f64::INFINITY };
        let mut sum = Interval::point(0.0);
        let mut worst = f64::NEG_INFINITY;
        for slice in 0..slices {
            let time = Interval::new(0.0, period).piece(slice, slices);
            sum = sum + self.rate(&truth.after(&flow, time), twist);
            worst = worst.max((sum / Interval::point((slice + 1) as f64)).hi());
        }
        worst
    }

    /// The same goal straight ahead: the rates of a turn on the spot do not depend on where it lies.
    fn facing(truth: &Truth) -> Truth {
        Truth { bearing: Interval::point(0.0), ..*truth }
    }

    /// Ẇ. Linear in the twist, so (v, 0) and (0, ω) are taken one by one: α̇ = φ̇ for the first.
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
    /// ρ̇, ȧ and φ̇: [Tran2012] Eq. (2).
    fn rates(&self, twist: Twist<Interval>) -> (Interval, Interval, Interval) {
        // Half turns are taken off a, and v changes its sign with each, so that the angle is far from its branch.
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

    /// Bounds of the rates over `period`, if the robot cannot reach the goal in it.
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
        // Each round starts from bounds that hold and gives bounds that hold, tighter ones.
        let mut on_the_way = Self { rho, bearing, approach, ..*self };
        for _ in 0..2 {
            let flow = on_the_way.rates(twist);
            on_the_way = self.after(&flow, time);
            on_the_way.rho = on_the_way.rho.intersection(rho)?;
        }
        Some(on_the_way.rates(twist))
    }

    /// After a time that lies in `time`, at rates within `flow`.
    fn after(&self, flow: &(Interval, Interval, Interval), time: Interval) -> Self {
        Self {
            rho: self.rho + time * flow.0,
            bearing: self.bearing + time * flow.1,
            approach: self.approach + time * flow.2,
            ..*self
        }
    }

    /// All that is met during `period`, if the robot cannot reach the goal in it.
    pub(crate) fn swept(&self, twist: Twist<Interval>, period: f64) -> Option<Self> {
        let flow = self.flow(twist, period)?;
        Some(self.after(&flow, Interval::new(0.0, period)))
    }
}
