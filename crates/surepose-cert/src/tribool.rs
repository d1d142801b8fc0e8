//! Three-valued truth: the result of comparing two intervals.

use core::ops::Not;

use surepose::scalar::Mask;

/// Mask type of intervals: true or false for all members, or unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tribool {
    /// False for all members.
    False,
    /// True for some members and false for others, as far as the intervals show.
    Unknown,
    /// True for all members.
    True,
}

impl Tribool {
    /// Whether the value is not `False`.
    pub fn possible(self) -> bool {
        self != Self::False
    }

    /// Whether the value is `True`.
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

    /// Boolean values compatible with `v`.
    fn truths(v: Tribool) -> Vec<bool> {
        [false, true].into_iter().filter(|t| v == Tribool::Unknown || *t == (v == Tribool::True)).collect()
    }

    #[test]
    fn tribool_logic_encloses_boolean_logic() {
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
