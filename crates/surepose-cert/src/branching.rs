//! Following each way a program can go, where intervals leave open which.
//!
//! A comparison that intervals cannot decide makes `select` answer with the hull of both sides, which is sound and
//! often useless: the hull of "turn left" and "turn right" holds "do not turn". [`explore_branches`] runs the program once
//! for each way instead. Every concrete input follows one of the ways, and on that way the intervals enclose it,
//! so what holds on all ways holds for all inputs.

use std::cell::RefCell;

/// Decisions beyond this depth fall back to the hull, which bounds the work: no law comes near it.
const MAX_DEPTH: usize = 16;

/// One decision: which of how many.
#[derive(Clone, Copy)]
struct Choice {
    taken: u8,
    of: u8,
}

/// The decisions of the present run, replayed up to `position`.
struct Tape {
    choices: Vec<Choice>,
    position: usize,
}

thread_local! {
    static TAPE: RefCell<Option<Tape>> = const { RefCell::new(None) };
}

/// Runs `program` once for each way through its undecided comparisons and hands each result to `visit`.
///
/// False if there are more than `most` ways: then not all of them were visited.
///
/// Inside `program` an undecided comparison answers yes on one way and no on the other. Calls do not nest: an inner
/// call explores with its own decisions, and the outer one then repeats it on each of its ways.
pub fn explore_branches<T>(most: usize, mut program: impl FnMut() -> T, mut visit: impl FnMut(T)) -> bool {
    let outer = TAPE.take();
    let mut choices = Vec::with_capacity(MAX_DEPTH);
    let mut ways = 0;
    let complete = loop {
        if ways == most {
            break false;
        }
        ways += 1;
        TAPE.set(Some(Tape { choices, position: 0 }));
        let result = program();
        choices = TAPE.take().map(|tape| tape.choices).unwrap_or_default();
        visit(result);
        // The next way: the last decision that has another side takes it, all after it are forgotten.
        while choices.last().is_some_and(|last| last.taken + 1 == last.of) {
            choices.pop();
        }
        match choices.last_mut() {
            Some(last) => last.taken += 1,
            None => break true,
        }
    };
    TAPE.set(outer);
    complete
}

/// Which of `of` sides to take here, or nothing outside of [`explore_branches`].
pub(crate) fn choose_branch(of: u8) -> Option<u8> {
    TAPE.with_borrow_mut(|tape| {
        let tape = tape.as_mut()?;
        if let Some(choice) = tape.choices.get(tape.position) {
            tape.position += 1;
            return Some(choice.taken);
        }
        if tape.choices.len() >= MAX_DEPTH {
            return None;
        }
        tape.choices.push(Choice { taken: 0, of });
        tape.position += 1;
        Some(0)
    })
}

#[cfg(test)]
mod tests {
    use surepose::geometry::Angle;
    use surepose::scalar::Scalar;

    use crate::{Interval, Tribool};

    use super::*;

    #[test]
    fn every_branch_is_explored_once() {
        let mut seen = Vec::new();
        explore_branches(64, || (choose_branch(2), choose_branch(3)), |way| seen.push(way));
        assert_eq!(seen.len(), 6);
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 6);
        assert_eq!(choose_branch(2), None, "outside of an exploration nothing is chosen");
    }

    #[test]
    fn an_angle_across_the_branch_stays_narrow_on_each_way() {
        let across = Interval::new(3.0, 3.3);
        assert!(Angle::from_radians(across).radians().width() > 6.0, "the hull is the whole circle");
        let mut pieces = Vec::new();
        explore_branches(64, || Angle::from_radians(across).radians(), |piece| pieces.push(piece));
        assert!(pieces.iter().all(|piece| piece.width() < 0.35), "{pieces:?}");
        for k in 0..=100 {
            let x = 3.0 + 0.003 * f64::from(k);
            let wrapped = Angle::from_radians(x).radians();
            assert!(pieces.iter().any(|piece| piece.contains(wrapped)), "{x}");
        }
    }

    #[test]
    fn outside_of_an_exploration_the_answer_is_maybe() {
        let x = Interval::new(-1.0, 1.0);
        assert_eq!(x.lt(Interval::from_f64(0.0)), Tribool::Unknown);
        explore_branches(
            64,
            || x.lt(Interval::from_f64(0.0)),
            |verdict| assert_ne!(verdict, Tribool::Unknown),
        );
    }
}
