//! Many trials side by side: where each robot is, what it remembers, and what it is judged by.

use surepose::Angle;
use surepose_lanes::{Column, Element, Streams};

use super::Start;
use super::bench::is_inside;

/// How many trials run side by side: enough to fill vectors, few enough for the nearest cache.
pub(super) const LANES: usize = 256;

/// How many vectors are in flight at once.
pub(super) const VECTORS: usize = 4;

/// One number for each trial.
pub(super) type Numbers<T> = Column<T, LANES>;

/// `LANES` trials under way.
#[derive(Clone, Debug, Default)]
pub(super) struct Fleet<T: Element> {
    /// The true pose.
    pub(super) x: Numbers<T>,
    pub(super) y: Numbers<T>,
    pub(super) heading: Numbers<T>,
    /// What the law remembers.
    pub(super) near: Numbers<T>,
    pub(super) reverse: Numbers<T>,
    pub(super) side: Numbers<T>,
    pub(super) trims: Numbers<T>,
    pub(super) travel: Numbers<T>,
    /// The goal as it is seen this period.
    pub(super) rho: Numbers<T>,
    pub(super) alpha: Numbers<T>,
    pub(super) phi: Numbers<T>,
    /// What the end that goes first sees of α.
    pub(super) sin: Numbers<T>,
    pub(super) cos: Numbers<T>,
    pub(super) sinc: Numbers<T>,
    /// The twist that is wanted this period.
    pub(super) v: Numbers<T>,
    pub(super) omega: Numbers<T>,
    /// How far the robot drove this period \[m].
    pub(super) length: Numbers<T>,
    /// What came of the trial so far.
    pub(super) score: Score<T>,
    /// The noise of this period.
    pub(super) deviates: [Numbers<T>; 6],
    pub(super) drawn: Drawn,
    pub(super) streams: Streams<LANES>,
}

/// What the trials are judged by.
#[derive(Clone, Debug, Default)]
pub(super) struct Score<T: Element> {
    /// At how many instants in a row the pose was inside the tolerance.
    pub(super) held: Numbers<T>,
    /// Way of the robot's middle \[m].
    pub(super) path: Numbers<T>,
    /// Reversals of its travel.
    pub(super) cusps: Numbers<T>,
    /// Way and reversals when the robot came inside the tolerance, in which it has been since.
    pub(super) path_entered: Numbers<T>,
    pub(super) cusps_entered: Numbers<T>,
    /// Which way it last travelled: ±1, 0 at first.
    pub(super) travel: Numbers<T>,
}

/// Deviates as they are drawn.
#[derive(Clone, Debug)]
pub(super) struct Drawn(pub(super) [[[f32; LANES]; 2]; 3]);

impl Default for Drawn {
    fn default() -> Self {
        Self([[[0.0; LANES]; 2]; 3])
    }
}

impl<T: Element> Fleet<T> {
    /// Lane `lane` begins trial `number` at `start`. A start inside the tolerance is held from the first instant on.
    pub(super) fn begin(&mut self, lane: usize, start: &Start, seed: u64, number: u64) {
        let score = &mut self.score;
        let memory = [&mut self.near, &mut self.reverse, &mut self.side, &mut self.trims, &mut self.travel];
        let zeros = memory.into_iter().chain([
            &mut score.path,
            &mut score.cusps,
            &mut score.path_entered,
            &mut score.cusps_entered,
            &mut score.travel,
        ]);
        for numbers in zeros {
            numbers.0[lane] = T::default();
        }
        score.held.0[lane] = T::of(if is_inside(start) { 1.0 } else { 0.0 });
        self.x.0[lane] = T::of(start.x);
        self.y.0[lane] = T::of(start.y);
        self.heading.0[lane] = T::of(start.heading.radians());
        self.streams.start(lane, seed, number);
    }

    /// Lane `lane` has nothing to do: nowhere is never inside.
    pub(super) fn rest(&mut self, lane: usize) {
        for numbers in [&mut self.x, &mut self.y, &mut self.heading] {
            numbers.0[lane] = T::of(f64::NAN);
        }
    }

    /// The noise of the right and of the left wheel in this period.
    pub(super) fn wheel_deviates(&mut self) -> &mut [Numbers<T>] {
        &mut self.deviates[3..5]
    }

    /// How far lane `lane` is from the goal \[m], and how far turned.
    pub(super) fn error(&self, lane: usize) -> (f64, Angle<f64>) {
        let (x, y) = (self.x.0[lane].to_f64(), self.y.0[lane].to_f64());
        (x.hypot(y), Angle::wrapped(self.heading.0[lane].to_f64()))
    }
}
