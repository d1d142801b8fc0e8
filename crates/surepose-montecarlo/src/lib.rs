//! Monte Carlo trials of the sampled, noisy, limited loop in SIMD lanes.
//!
//! | module | purpose |
//! |---|---|
//! | [`sweep`] | seeded trials from many start poses, with and without a filter |
//! | [`tune`] | seeded search for the gains with the shortest trial time |
//!
//! A trial's time is compared with the time-optimal bound, [`surepose::optimal`].

pub mod sweep;
pub mod tune;
