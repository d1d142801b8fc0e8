//! Which of the two laws is in charge, and of what error: what a twist is made from.

use super::commitment::Memory;
use crate::scalar::Scalar;

/// The law in charge of this tick, with the angle that it takes away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Engaged<S: Scalar> {
    /// α where the global law is in charge, −θ_e where the local law is: how far the robot is to turn \[rad]. The hybrid
    /// law continues it beyond ±π.
    pub error: S,
    /// What to remember, from which law it is (`near`) to how long it has been trimming. Only `travel` is still the last tick's.
    pub memory: Memory<S>,
}
