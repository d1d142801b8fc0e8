//! Experiments of the project itself: the paper's figures, the loop world, kidnapped robots.
//!
//! | module | purpose |
//! |---|---|
//! | [`reproduce`] | the experiments behind the paper's figures and the loop world |
//! | [`picture`] | the paper's figures, drawn |
//! | [`kidnapping`] | trials in which the robot is displaced and has to find itself again |

pub mod kidnapping;
pub mod picture;
pub mod reproduce;
