//! Monte Carlo trials of the sampled, noisy, limited loop in SIMD lanes.
//!
//! | module | purpose |
//! |---|---|
//! | [`sweep`] | millions of seeded trials from many start poses, with and without a filter |
//! | [`tune`] | a seeded search for the gains that reach the goal soonest |
//!
//! A trial's time is compared with the time-optimal bound, [`surepose::optimal`].

pub mod sweep;
pub mod tune;
