//! A batch of trials in lanes: robot states, law states and statistics.

use surepose_simd::{Element, LaneArray, Lanes, Streams};

use super::bench::{Start, is_inside};

/// Number of trials per batch: large enough to amortize loop overhead, small enough for the L1 and L2 caches.
/// It is not a power of two, so that columns do not share the lower bits of their addresses.
pub(super) const LANES: usize = 240;

/// One robot per lane scalar: several interleaved ones exceed the registers, and the processor overlaps
/// iterations anyway.
pub(super) type LaneScalar<T> = Lanes<T, 1>;

/// One number per trial.
pub(super) type BatchArray<T> = LaneArray<T, LANES>;

/// One standard normal deviate per trial, as drawn.
pub(super) type Deviates = LaneArray<f32, LANES>;

/// A batch of `LANES` active trials.
#[derive(Clone, Debug, Default)]
pub(super) struct TrialBatch<T: Element> {
    /// True pose.
    pub(super) x: BatchArray<T>,
    pub(super) y: BatchArray<T>,
    pub(super) heading: BatchArray<T>,
    /// State of the law.
    pub(super) local_mode: BatchArray<T>,
    pub(super) reverse: BatchArray<T>,
    pub(super) turn_direction: BatchArray<T>,
    pub(super) trim_ticks: BatchArray<T>,
    pub(super) drive_direction: BatchArray<T>,
    pub(super) sidestep: BatchArray<T>,
    pub(super) lateral: BatchArray<T>,
    /// Estimated distance, direction and heading error of the goal in this period.
    pub(super) rho: BatchArray<T>,
    pub(super) bearing: BatchArray<T>,
    pub(super) estimated: BatchArray<T>,
    /// Navigation variables for the selected direction of travel.
    pub(super) alpha: BatchArray<T>,
    pub(super) phi: BatchArray<T>,
    /// cos α and sin α/α.
    pub(super) cos: BatchArray<T>,
    pub(super) sinc: BatchArray<T>,
    /// Heading error to correct.
    pub(super) error: BatchArray<T>,
    /// Desired twist of this period.
    pub(super) v: BatchArray<T>,
    pub(super) omega: BatchArray<T>,
    /// Motion of the wheels in this period \[m], \[rad].
    pub(super) length: BatchArray<T>,
    pub(super) turn: BatchArray<T>,
    /// Statistics of the trial so far.
    pub(super) score: TrialAccumulator<T>,
    /// Noise of this period: estimated pose, right and left wheel.
    pub(super) deviates: [Deviates; 5],
    pub(super) streams: Streams<LANES>,
}

/// Statistics of the trials.
#[derive(Clone, Debug, Default)]
pub(super) struct TrialAccumulator<T: Element> {
    /// Number of consecutive instants inside the tolerance.
    pub(super) held: BatchArray<T>,
    /// Path length of the robot's center \[m].
    pub(super) path: BatchArray<T>,
    /// Number of legs between reversals, with the sign of the last; 0 at the start.
    pub(super) legs: BatchArray<T>,
    /// Path length, and reversals, since the last entry into the tolerance.
    pub(super) held_path: BatchArray<T>,
    pub(super) held_turns: BatchArray<T>,
}

impl<T: Element> TrialAccumulator<T> {
    /// Returns the path length of `lane` until the last entry into the tolerance \[m].
    pub(super) fn path(&self, lane: usize) -> f64 {
        self.path.0[lane].to_f64() - self.held_path.0[lane].to_f64()
    }

    /// Returns the number of reversals until then.
    pub(super) fn cusps(&self, lane: usize) -> f64 {
        (self.legs.0[lane].to_f64().abs() - 1.0).max(0.0) - self.held_turns.0[lane].to_f64()
    }
}

impl<T: Element> TrialBatch<T> {
    /// Starts trial `number` in lane `lane` at `start`. A start inside the tolerance is held from the first
    /// instant.
    pub(super) fn begin(&mut self, lane: usize, start: &Start, seed: u64, number: u64) {
        let score = &mut self.score;
        let memory = [
            &mut self.local_mode,
            &mut self.reverse,
            &mut self.turn_direction,
            &mut self.trim_ticks,
            &mut self.drive_direction,
            &mut self.sidestep,
            &mut self.lateral,
        ];
        let zeros = memory.into_iter().chain([
            &mut score.path,
            &mut score.legs,
            &mut score.held_path,
            &mut score.held_turns,
        ]);
        for numbers in zeros {
            numbers.0[lane] = T::default();
        }
        score.held.0[lane] = T::from_f64(if is_inside(start) { 1.0 } else { 0.0 });
        self.x.0[lane] = T::from_f64(start.x);
        self.y.0[lane] = T::from_f64(start.y);
        self.heading.0[lane] = T::from_f64(start.heading.radians());
        self.streams.start(lane, seed, number);
    }

    /// Idles lane `lane`: its pose is NaN, so it is never inside the tolerance.
    pub(super) fn rest(&mut self, lane: usize) {
        for numbers in [&mut self.x, &mut self.y, &mut self.heading] {
            numbers.0[lane] = T::from_f64(f64::NAN);
        }
    }
}
