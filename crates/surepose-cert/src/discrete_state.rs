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
}

impl DiscreteState {
    /// Initial state of the control law: nothing is decided.
    pub(crate) const INITIAL: Self =
        Self { local_mode: false, reverse: false, turn_direction: 0, drive_direction: 0 };

    /// Iterates over all 36 values.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let signs = || [-1, 0, 1].into_iter();
        signs().flat_map(move |drive_direction| {
            signs().flat_map(move |turn_direction| {
                (0..4).map(move |k| Self {
                    local_mode: k & 1 == 1,
                    reverse: k & 2 == 2,
                    turn_direction,
                    drive_direction,
                })
            })
        })
    }

    /// Index in the order of [`DiscreteState::all`].
    pub(crate) fn index(self) -> usize {
        usize::from(self.local_mode)
            + 2 * usize::from(self.reverse)
            + 4 * usize::from((self.turn_direction + 1).unsigned_abs())
            + 12 * usize::from((self.drive_direction + 1).unsigned_abs())
    }

    /// Converts to a hybrid state with the given trim tick count.
    pub fn memory<S: Scalar>(self, trim_ticks: S) -> HybridState<S> {
        HybridState {
            local_mode: S::Mask::splat(self.local_mode),
            reverse: S::Mask::splat(self.reverse),
            turn_direction: S::from_f64(f64::from(self.turn_direction)),
            trim_ticks,
            drive_direction: S::from_f64(f64::from(self.drive_direction)),
        }
    }

    /// Converts to the set of hybrid states with any trim tick count.
    pub(crate) fn as_memory_set(self) -> HybridState<Interval> {
        self.memory(Interval::new(0.0, f64::MAX))
    }

    /// Extracts the discrete state. `None`: the intervals do not determine it.
    pub(crate) fn from_memory(memory: &HybridState<Interval>) -> Option<Self> {
        let is_known = |mask: Tribool| mask.certain() != (!mask).certain();
        let sign = |x: Interval| {
            let is_one = x.lo().total_cmp(&x.hi()).is_eq() && [-1.0, 0.0, 1.0].contains(&x.lo());
            is_one.then(|| x.lo() as i8)
        };
        let (local_mode, reverse) = (memory.local_mode, memory.reverse);
        let (turn_direction, drive_direction) = (sign(memory.turn_direction)?, sign(memory.drive_direction)?);
        (is_known(local_mode) && is_known(reverse)).then(|| Self {
            local_mode: local_mode.certain(),
            reverse: reverse.certain(),
            turn_direction,
            drive_direction,
        })
    }

    /// Whether W is the same function in both states; W depends on the leading end and the turn direction.
    pub(crate) fn has_same_lyapunov(self, other: Self) -> bool {
        self.reverse == other.reverse && self.turn_direction == other.turn_direction
    }

    /// Iterates over the discrete states compatible with interval values. An unknown turn direction counts as
    /// decided.
    pub(crate) fn possible(memory: &HybridState<Interval>) -> impl Iterator<Item = Self> + use<> {
        let HybridState { local_mode, reverse, turn_direction, drive_direction, .. } = *memory;
        let is_zero = |x: Interval| x.lo() >= 0.0 && x.hi() <= 0.0;
        let undecided = is_zero(turn_direction);
        Self::all().filter(move |discrete_state| {
            let may = |is: bool, mask: Tribool| if is { mask.possible() } else { (!mask).possible() };
            may(discrete_state.local_mode, local_mode)
                && may(discrete_state.reverse, reverse)
                && turn_direction.contains(f64::from(discrete_state.turn_direction))
                && (discrete_state.turn_direction != 0 || undecided)
                && drive_direction.contains(f64::from(discrete_state.drive_direction))
        })
    }

    /// Extracts the discrete state from floating-point values.
    pub(crate) fn from_memory_f64(memory: &HybridState<f64>) -> Self {
        let sign = |x: f64| Scalar::clamp(x, -1.0, 1.0) as i8;
        let (turn_direction, drive_direction) = (sign(memory.turn_direction), sign(memory.drive_direction));
        Self { local_mode: memory.local_mode, reverse: memory.reverse, turn_direction, drive_direction }
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
