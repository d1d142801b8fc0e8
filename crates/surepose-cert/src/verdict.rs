//! What comparing two intervals can tell.

use core::ops::Not;

use surepose::Mask;

/// The mask of intervals: for all members, for none, or cannot tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// False for every choice of members.
    No,
    /// Depends on the members, as far as the intervals can tell.
    Maybe,
    /// True for every choice of members.
    Yes,
}

impl Verdict {
    /// Whether it can be true.
    pub fn possible(self) -> bool {
        self != Self::No
    }

    /// Whether it must be true.
    pub fn certain(self) -> bool {
        self == Self::Yes
    }
}

impl Not for Verdict {
    type Output = Self;
    fn not(self) -> Self {
        match self {
            Self::No => Self::Yes,
            Self::Maybe => Self::Maybe,
            Self::Yes => Self::No,
        }
    }
}

impl Mask for Verdict {
    fn splat(value: bool) -> Self {
        if value { Self::Yes } else { Self::No }
    }
    fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::No, _) | (_, Self::No) => Self::No,
            (Self::Yes, Self::Yes) => Self::Yes,
            _ => Self::Maybe,
        }
    }
    fn or(self, other: Self) -> Self {
        !((!self).and(!other))
    }
    fn select(self, other: Self, otherwise: Self) -> Self {
        match self {
            Self::Yes => other,
            Self::No => otherwise,
            Self::Maybe if other == otherwise => other,
            Self::Maybe => Self::Maybe,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Verdict; 3] = [Verdict::No, Verdict::Maybe, Verdict::Yes];

    /// The truths that a verdict leaves open.
    fn truths(v: Verdict) -> Vec<bool> {
        [false, true].into_iter().filter(|t| v == Verdict::Maybe || *t == (v == Verdict::Yes)).collect()
    }

    #[test]
    fn every_truth_a_verdict_leaves_open_is_kept() {
        for a in ALL {
            for b in ALL {
                for c in ALL {
                    for x in truths(a) {
                        for y in truths(b) {
                            assert!(truths(a.and(b)).contains(&(x & y)));
                            assert!(truths(a.or(b)).contains(&(x | y)));
                            assert!(truths(!a).contains(&!x));
                            for z in truths(c) {
                                assert!(truths(a.select(b, c)).contains(&if x { y } else { z }));
                            }
                        }
                    }
                }
            }
        }
    }
}
