//! Which of the two laws is in charge, and of what error: what a twist is made from.

use crate::scalar::Scalar;

use super::hysteresis::HybridState;

/// The law in charge of this tick, with the angle that it takes away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveMode<S: Scalar> {
    /// α where the global law is in charge, −θ_e where the local law is: how far the robot is to turn \[rad]. The hybrid
    /// law continues it beyond ±π.
    pub error: S,
    /// What to remember, from which law it is (`local_mode`) to how long it has been trimming. Only `drive_direction` is still the last tick's.
    pub state: HybridState<S>,
}
