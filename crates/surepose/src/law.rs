//! How should I move? The control laws of [Tran2012] Sec. 4, each with its Lyapunov function beside it.

mod arrival;
mod follow;
mod global;
mod hybrid;
mod local;

pub use arrival::{Arrival, Phase, Tolerance};
pub use follow::{FollowLaw, Following, Offset};
pub use global::GlobalLaw;
pub use hybrid::{Decision, Direction, Gains, HybridLaw, Memory};
pub use local::LocalLaw;
