//! What comparing two intervals can tell.

use core::ops::Not;

use surepose::scalar::Mask;

/// The mask of intervals: for all members, for none, or cannot tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tribool {
    /// False for every choice of members.
    False,
    /// Depends on the members, as far as the intervals can tell.
    Unknown,
    /// True for every choice of members.
    True,
}

impl Tribool {
    /// Whether it can be true.
    pub fn possible(self) -> bool {
        self != Self::False
    }

    /// Whether it must be true.
    pub fn certain(self) -> bool {
        self == Self::True
    }
}

impl Not for Tribool {
    type Output = Self;
    fn not(self) -> Self {
        match self {
            Self::False => Self::True,
            Self::Unknown => Self::Unknown,
            Self::True => Self::False,
        }
    }
}

impl Mask for Tribool {
    fn splat(value: bool) -> Self {
        if value { Self::True } else { Self::False }
    }
    fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::False, _) | (_, Self::False) => Self::False,
            (Self::True, Self::True) => Self::True,
            _ => Self::Unknown,
        }
    }
    fn or(self, other: Self) -> Self {
        !((!self).and(!other))
    }
    fn select(self, other: Self, otherwise: Self) -> Self {
        match self {
            Self::True => other,
            Self::False => otherwise,
            Self::Unknown if other == otherwise => other,
            Self::Unknown => Self::Unknown,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Tribool; 3] = [Tribool::False, Tribool::Unknown, Tribool::True];

    /// The truths that a verdict leaves open.
    fn truths(v: Tribool) -> Vec<bool> {
        [false, true].into_iter().filter(|t| v == Tribool::Unknown || *t == (v == Tribool::True)).collect()
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
