//! Experiments of the project: the paper's figures, the loop world, kidnapped robots.
//!
//! | module | purpose |
//! |---|---|
//! | [`actuators`] | parking trials on bases with delay, lag, dead bands and weak motors |
//! | [`reproduce`] | the experiments behind the paper's figures and the loop world |
//! | [`picture`] | pictures of the paper's figures |
//! | [`kidnapping`] | kidnapped-robot trials: detection and relocalization |

pub mod actuators;
pub mod kidnapping;
pub mod picture;
pub mod reproduce;
