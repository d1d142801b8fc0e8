//! Many trials side by side: where each robot is, what it remembers, and what it is judged by.

use surepose_simd::{Element, LaneArray, Lanes, Streams};

use super::bench::{Start, is_inside};

/// How many trials run side by side: enough that a loop over them is worth beginning, few enough for the nearest caches, and not
/// a power of two, so that columns do not share the lower bits of their addresses.
pub(super) const LANES: usize = 240;

/// One robot at a time: several interleaved leave too few registers, and the processor works on many turns of a loop anyway.
pub(super) type LaneScalar<T> = Lanes<T, 1>;

/// One number for each trial.
pub(super) type BatchArray<T> = LaneArray<T, LANES>;

/// A standard normal deviate for each trial, as it was drawn.
pub(super) type Deviates = LaneArray<f32, LANES>;

/// `LANES` trials under way.
#[derive(Clone, Debug, Default)]
pub(super) struct TrialBatch<T: Element> {
    /// The true pose.
    pub(super) x: BatchArray<T>,
    pub(super) y: BatchArray<T>,
    pub(super) heading: BatchArray<T>,
    /// What the law remembers.
    pub(super) local_mode: BatchArray<T>,
    pub(super) reverse: BatchArray<T>,
    pub(super) turn_direction: BatchArray<T>,
    pub(super) trim_ticks: BatchArray<T>,
    pub(super) drive_direction: BatchArray<T>,
    /// How far the goal seems this period, in which direction, and where the robot seems to head.
    pub(super) rho: BatchArray<T>,
    pub(super) bearing: BatchArray<T>,
    pub(super) estimated: BatchArray<T>,
    /// The goal as the end that goes first sees it.
    pub(super) alpha: BatchArray<T>,
    pub(super) phi: BatchArray<T>,
    /// cos α and sin α/α.
    pub(super) cos: BatchArray<T>,
    pub(super) sinc: BatchArray<T>,
    /// How far the robot is to turn.
    pub(super) error: BatchArray<T>,
    /// The twist that is wanted this period.
    pub(super) v: BatchArray<T>,
    pub(super) omega: BatchArray<T>,
    /// How the wheels carry the robot this period \[m], \[rad].
    pub(super) length: BatchArray<T>,
    pub(super) turn: BatchArray<T>,
    /// What came of the trial so far.
    pub(super) score: TrialAccumulator<T>,
    /// The noise of this period: of the estimated pose, and of the right and the left wheel.
    pub(super) deviates: [Deviates; 5],
    pub(super) streams: Streams<LANES>,
}

/// What the trials are judged by.
#[derive(Clone, Debug, Default)]
pub(super) struct TrialAccumulator<T: Element> {
    /// At how many instants in a row the pose was inside the tolerance.
    pub(super) held: BatchArray<T>,
    /// Way of the robot's middle \[m].
    pub(super) path: BatchArray<T>,
    /// How many legs it drove, each to where its travel turned round, with the sign of the last; 0 at first.
    pub(super) legs: BatchArray<T>,
    /// The part of the way, and of the turns from leg to leg, since the robot came inside the tolerance.
    pub(super) held_path: BatchArray<T>,
    pub(super) held_turns: BatchArray<T>,
}

impl<T: Element> TrialAccumulator<T> {
    /// How far the robot of `lane` drove until it came inside the tolerance \[m].
    pub(super) fn path(&self, lane: usize) -> f64 {
        self.path.0[lane].to_f64() - self.held_path.0[lane].to_f64()
    }

    /// How often its travel turned round until then.
    pub(super) fn cusps(&self, lane: usize) -> f64 {
        (self.legs.0[lane].to_f64().abs() - 1.0).max(0.0) - self.held_turns.0[lane].to_f64()
    }
}

impl<T: Element> TrialBatch<T> {
    /// Lane `lane` begins trial `number` at `start`. A start inside the tolerance is held from the first instant on.
    pub(super) fn begin(&mut self, lane: usize, start: &Start, seed: u64, number: u64) {
        let score = &mut self.score;
        let memory = [
            &mut self.local_mode,
            &mut self.reverse,
            &mut self.turn_direction,
            &mut self.trim_ticks,
            &mut self.drive_direction,
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

    /// Lane `lane` has nothing to do: nowhere is never inside.
    pub(super) fn rest(&mut self, lane: usize) {
        for numbers in [&mut self.x, &mut self.y, &mut self.heading] {
            numbers.0[lane] = T::from_f64(f64::NAN);
        }
    }
}
