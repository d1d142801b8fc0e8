//! Boxes of the state space: true distance, distance error, and estimated angles.

use core::f64::consts::{FRAC_PI_2, PI};

use surepose::control::NavigationVariables;
use surepose::geometry::{Angle, Body, Point, Pose};
use surepose::kinematics::{Integration, Twist};
use surepose::scalar::{Dual, Scalar};

use crate::discrete_state::DiscreteState;
use crate::interval::Interval;
use crate::lyapunov::PI_ENCLOSED;
use crate::noise::NoiseBounds;

/// A box of the state space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Region {
    /// True distance ρ \[m].
    pub(crate) rho: Interval,
    /// Estimated minus true distance \[m].
    pub(crate) drift: Interval,
    /// Estimated bearing α̂ \[rad], within one quadrant.
    pub(crate) alpha: Interval,
    /// Estimated approach angle φ̂ \[rad], within one quadrant.
    pub(crate) phi: Interval,
}

impl Region {
    /// Iterates over boxes that cover all states at distances `rho`, by quadrants of both angles.
    pub(crate) fn around(rho: Interval, noise: &NoiseBounds) -> impl Iterator<Item = Self> + use<> {
        let drift = Interval::symmetric(noise.position);
        Self::quadrants().flat_map(move |alpha| {
            Self::quadrants()
                .flat_map(move |phi| (0..4).map(move |i| Self { rho, drift, alpha: alpha.piece(i, 4), phi }))
        })
    }

    /// The four quadrants of an estimated angle, which is a float in (−π, π].
    pub(crate) fn quadrants() -> impl Iterator<Item = Interval> + use<> {
        let at = |k: i32| (f64::from(k) * FRAC_PI_2).clamp((-PI).next_up(), PI);
        (-2..2).map(move |k| Interval::new(at(k), at(k + 1)))
    }

    /// One box with all angles, for results that depend little on them.
    pub(crate) fn anywhere(rho: Interval, drift: Interval) -> Self {
        let angles = Interval::new((-PI).next_up(), PI);
        Self { rho, drift, alpha: angles, phi: angles }
    }

    /// Estimated distance, at least 0 \[m].
    pub(crate) fn seen_rho(&self) -> Interval {
        Scalar::max(self.rho + self.drift, Interval::point(0.0))
    }

    /// Estimated navigation variables.
    pub(crate) fn seen(&self) -> NavigationVariables<Interval> {
        NavigationVariables {
            rho: self.seen_rho(),
            alpha: Angle::from_radians_unchecked(self.alpha),
            phi: Angle::from_radians_unchecked(self.phi),
        }
    }

    /// Largest angle between the estimated and the true goal direction \[rad].
    ///
    /// With ρ̂ − ρ = D and the angle e between the directions, D² + 4ρρ̂·sin²(e/2) ≤ ε².
    pub(crate) fn turn(&self, noise: &NoiseBounds) -> f64 {
        let seen = self.seen_rho();
        let rest = Interval::point(noise.position).squared() - self.drift.squared();
        let product = (self.rho * seen * Interval::point(4.0)).lo();
        if product <= 0.0 {
            return PI;
        }
        // Rounded up before the arc sine, which is steep at 1.
        let half_sine = (rest / Interval::point(product)).hi().max(0.0).sqrt().next_up();
        let farther = self.rho.lo().max(seen.lo());
        let sine = (noise.position / farther).next_up();
        let up = 1.0 + 1e-12; // far above the rounding of the arc sine
        let by_chord = if half_sine < 1.0 { 2.0 * libm::asin(half_sine) * up } else { PI };
        let by_tangent = if sine < 1.0 { libm::asin(sine) * up } else { PI };
        by_chord.min(by_tangent)
    }

    /// Numbers of half turns to add to the estimated angles (α̂, φ̂).
    ///
    /// The results are the angles of the leading end, unwrapped toward the turn direction of
    /// `discrete_state`.
    pub(crate) fn lift(&self, discrete_state: DiscreteState) -> (i8, i8) {
        let opposite = |angle: Interval| {
            if !discrete_state.reverse {
                0
            } else if angle.mid() > 0.0 {
                -1
            } else {
                1
            }
        };
        let alpha = opposite(self.alpha);
        let bearing = self.alpha.mid() + f64::from(alpha) * PI;
        let beyond = bearing * f64::from(discrete_state.turn_direction) < -FRAC_PI_2;
        (if beyond { alpha + 2 * discrete_state.turn_direction } else { alpha }, opposite(self.phi))
    }

    /// Bisects the widest side, with each side weighted by its influence on W.
    pub(crate) fn halves(&self) -> (Self, Self) {
        let per_rho = 1.0 / self.rho.lo().max(1e-9);
        let widths = [
            self.alpha.width(),
            0.12 * self.phi.width(),
            0.6 * self.rho.width() * per_rho,
            0.5 * self.drift.width() * per_rho,
        ];
        let widest = (1..4).fold(0, |best, k| if widths[k] > widths[best] { k } else { best });
        let (mut low, mut high) = (*self, *self);
        match widest {
            0 => (low.alpha, high.alpha) = self.alpha.halves(),
            1 => (low.phi, high.phi) = self.phi.halves(),
            2 => (low.rho, high.rho) = self.rho.halves(),
            _ => (low.drift, high.drift) = self.drift.halves(),
        }
        (low, high)
    }

    /// Largest weighted angular side \[rad].
    pub(crate) fn size(&self) -> f64 {
        self.alpha.width().max(0.12 * self.phi.width())
    }
}

/// `count` half turns \[rad].
pub(crate) fn half_turns(count: i8) -> Interval {
    PI_ENCLOSED() * Interval::point(f64::from(count))
}

/// The goal's x in the body, and its rate, while the robot drives `twist`: the core's motion, differentiated by time.
pub(crate) fn seen_moving(
    ahead: Interval,
    aside: Interval,
    twist: Twist<Interval>,
    time: Interval,
) -> (Interval, Interval) {
    type Moving = Dual<Interval, 1>;
    let time = Moving::parameter(time, 0);
    let twist = Twist::new(Moving::constant(twist.v), Moving::constant(twist.omega));
    let start: Pose<Body, Body, Moving> = Pose::identity();
    let moved = start.integrate(twist.integrate_for(time), Integration::Arc);
    let goal: Point<Body, Moving> = Point::new(Moving::constant(ahead), Moving::constant(aside));
    let seen = moved.inverse() * goal;
    (seen.x.value, seen.x.slope[0])
}
