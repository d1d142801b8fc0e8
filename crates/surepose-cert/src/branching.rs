//! Exploration of all branches of a program whose comparisons intervals cannot decide.
//!
//! For an undecided comparison, `select` returns the hull of both results. The hull is sound but often
//! useless: the hull of "turn left" and "turn right" contains "do not turn". [`explore_branches`] runs the
//! program once per branch instead. Every concrete input follows one branch, and on that branch the intervals
//! enclose it. A property that holds on all branches therefore holds for all inputs.

use std::cell::RefCell;

/// Maximum number of decisions per branch; deeper comparisons return the hull. No control law comes near it.
const MAX_DEPTH: usize = 16;

/// One decision: index taken, and number of alternatives.
#[derive(Clone, Copy)]
struct Choice {
    taken: u8,
    of: u8,
}

/// Decisions of the current run, replayed up to `position`.
struct Tape {
    choices: Vec<Choice>,
    position: usize,
}

thread_local! {
    static TAPE: RefCell<Option<Tape>> = const { RefCell::new(None) };
}

/// Runs `program` once per branch of its undecided comparisons and passes each result to `visit`.
///
/// Returns `false` if there are more than `most` branches; some were then not visited.
///
/// Inside `program`, an undecided comparison is true on one branch and false on the other. Calls do not nest:
/// an inner call explores its own decisions, and the outer call repeats it on each of its branches.
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
        // Next branch: advance the last decision with an alternative left, and drop all decisions after it.
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

/// Returns the alternative to take, below `of`. `None`: outside of [`explore_branches`], or too deep.
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
        assert_eq!(choose_branch(2), None, "no exploration is active");
    }

    #[test]
    fn angle_across_pi_stays_narrow_on_each_branch() {
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
    fn comparison_is_unknown_outside_of_an_exploration() {
        let x = Interval::new(-1.0, 1.0);
        assert_eq!(x.lt(Interval::from_f64(0.0)), Tribool::Unknown);
        explore_branches(64, || x.lt(Interval::from_f64(0.0)), |result| assert_ne!(result, Tribool::Unknown));
    }
}
