//! The simulated world: arenas, motors, encoders, compass, laser; owns the clock and the seeds.
