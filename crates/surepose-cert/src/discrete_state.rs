//! Discrete part of the control law's hybrid state; the certificate enumerates all values.

use surepose::control::HybridState;
use surepose::scalar::{Mask, Scalar};

use crate::interval::Interval;
use crate::tribool::Tribool;

/// One value of the discrete part of a [`HybridState`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DiscreteState {
    /// Whether the local mode is active.
    pub local_mode: bool,
    /// Whether the robot drives in reverse.
    pub reverse: bool,
    /// Turn direction: −1, 1, or 0 if undecided.
    pub turn_direction: i8,
    /// Last drive direction: −1, 1, or 0 before the first motion.
    pub drive_direction: i8,
    /// Leg of a sidestep: ±2 out, 1 back, 0 none.
    pub sidestep: i8,
}

impl DiscreteState {
    /// Initial state of the control law: nothing is decided.
    pub(crate) const INITIAL: Self =
        Self { local_mode: false, reverse: false, turn_direction: 0, drive_direction: 0, sidestep: 0 };

    /// Values of [`DiscreteState::sidestep`].
    const LEGS: [i8; 4] = [-2, 0, 1, 2];

    /// Iterates over all 90 values; a sidestep exists in local mode only.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let signs = || [-1, 0, 1].into_iter();
        let values = Self::LEGS.into_iter().flat_map(move |sidestep| {
            signs().flat_map(move |drive_direction| {
                signs().flat_map(move |turn_direction| {
                    (0..4).map(move |k| Self {
                        local_mode: k & 1 == 1,
                        reverse: k & 2 == 2,
                        turn_direction,
                        drive_direction,
                        sidestep,
                    })
                })
            })
        });
        values.filter(|value| value.local_mode || value.sidestep == 0)
    }

    /// Index for sorting.
    pub(crate) fn index(self) -> usize {
        usize::from(self.local_mode)
            + 2 * usize::from(self.reverse)
            + 4 * usize::from((self.turn_direction + 1).unsigned_abs())
            + 12 * usize::from((self.drive_direction + 1).unsigned_abs())
            + 36 * usize::from((self.sidestep + 2).unsigned_abs())
    }

    /// Converts to a hybrid state with the given trim tick count and mean lateral distance \[m].
    pub fn memory<S: Scalar>(self, trim_ticks: S, lateral: S) -> HybridState<S> {
        HybridState {
            local_mode: S::Mask::splat(self.local_mode),
            reverse: S::Mask::splat(self.reverse),
            turn_direction: S::from_f64(f64::from(self.turn_direction)),
            trim_ticks,
            drive_direction: S::from_f64(f64::from(self.drive_direction)),
            sidestep: S::from_f64(0.5 * f64::from(self.sidestep)),
            lateral,
        }
    }

    /// Converts to the set of hybrid states with any mean lateral distance, and in local mode any trim tick count.
    ///
    /// Outside of the local mode the count is 0; [`DiscreteState::from_memory`] verifies it.
    pub(crate) fn as_memory_set(self) -> HybridState<Interval> {
        let most = if self.local_mode { f64::MAX } else { 0.0 };
        self.memory(Interval::new(0.0, most), Self::ANY_LATERAL())
    }

    /// All mean lateral distances \[m].
    pub(crate) const ANY_LATERAL: fn() -> Interval = || Interval::symmetric(f64::MAX);

    /// Extracts the discrete state. `None`: the intervals do not determine it, or it trims or sidesteps outside of the local mode.
    pub(crate) fn from_memory(memory: &HybridState<Interval>) -> Option<Self> {
        let is_known = |mask: Tribool| mask.certain() != (!mask).certain();
        let one_of = |x: Interval, values: &[i8], unit: f64| {
            let is_point = x.lo().total_cmp(&x.hi()).is_eq();
            values.iter().copied().find(|value| is_point && x.contains(unit * f64::from(*value)))
        };
        let (local_mode, reverse) = (memory.local_mode, memory.reverse);
        let turn_direction = one_of(memory.turn_direction, &[-1, 0, 1], 1.0)?;
        let drive_direction = one_of(memory.drive_direction, &[-1, 0, 1], 1.0)?;
        let sidestep = one_of(memory.sidestep, &Self::LEGS, 0.5)?;
        let is_idle = memory.trim_ticks.magnitude() <= 0.0 && sidestep == 0;
        let is_known = is_known(local_mode) && is_known(reverse) && (local_mode.certain() || is_idle);
        is_known.then(|| Self {
            local_mode: local_mode.certain(),
            reverse: reverse.certain(),
            turn_direction,
            drive_direction,
            sidestep,
        })
    }

    /// Whether the heading error is to decrease: in local mode, except on the out leg of a sidestep.
    pub fn claims_heading(self) -> bool {
        self.local_mode && self.sidestep.abs() < 2
    }

    /// Whether W is the same function in both states; W depends on the leading end and the turn direction.
    pub(crate) fn has_same_lyapunov(self, other: Self) -> bool {
        self.reverse == other.reverse && self.turn_direction == other.turn_direction
    }

    /// Iterates over the discrete states compatible with interval values. An unknown turn direction counts as
    /// decided.
    pub(crate) fn possible(memory: &HybridState<Interval>) -> impl Iterator<Item = Self> + use<> {
        let HybridState { local_mode, reverse, turn_direction, drive_direction, sidestep, .. } = *memory;
        let is_zero = |x: Interval| x.lo() >= 0.0 && x.hi() <= 0.0;
        let undecided = is_zero(turn_direction);
        Self::all().filter(move |discrete_state| {
            let may = |is: bool, mask: Tribool| if is { mask.possible() } else { (!mask).possible() };
            may(discrete_state.local_mode, local_mode)
                && may(discrete_state.reverse, reverse)
                && turn_direction.contains(f64::from(discrete_state.turn_direction))
                && (discrete_state.turn_direction != 0 || undecided)
                && drive_direction.contains(f64::from(discrete_state.drive_direction))
                && sidestep.contains(0.5 * f64::from(discrete_state.sidestep))
        })
    }

    /// Extracts the discrete state from floating-point values.
    pub(crate) fn from_memory_f64(memory: &HybridState<f64>) -> Self {
        let sign = |x: f64| Scalar::clamp(x, -1.0, 1.0) as i8;
        let (turn_direction, drive_direction) = (sign(memory.turn_direction), sign(memory.drive_direction));
        let sidestep = (2.0 * Scalar::clamp(memory.sidestep, -1.0, 1.0)) as i8;
        let (local_mode, reverse) = (memory.local_mode, memory.reverse);
        Self { local_mode, reverse, turn_direction, drive_direction, sidestep }
    }
}

/// Whether `shown` holds for all of `discrete_states`, of which one for which it does not moves to the front: in the halves of
/// the same region it most likely is the one again, and the others need not be looked at.
///
/// `shown` is given a place to note what it has seen for the discrete states before.
pub(crate) fn first_shown<K>(
    discrete_states: &mut [DiscreteState],
    mut shown: impl FnMut(DiscreteState, &mut Vec<K>) -> bool,
) -> bool {
    let mut known = Vec::new();
    let failed = discrete_states.iter().position(|discrete_state| !shown(*discrete_state, &mut known));
    if let Some(failed) = failed {
        discrete_states[..=failed].rotate_right(1);
    }
    failed.is_none()
}
