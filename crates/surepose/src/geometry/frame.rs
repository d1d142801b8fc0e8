//! The frames of reference, as types: a pose in one cannot be used as a pose in another.

/// A right-handed plane frame: x forward or east, y left or north, angles counter-clockwise.
pub trait Frame: Copy + 'static {}

macro_rules! frames {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $name;
        impl Frame for $name {}
    )*};
}

frames! {
    /// The fixed world in which walls, landmarks and goals are given.
    Map,
    /// The robot: origin midway between the drive wheels, x forward.
    Body,
    /// The pose to come to rest at: origin there, x along the commanded heading.
    Goal,
    /// The point of a path to be at now: origin there, x along the path.
    Target,
    /// The laser range finder: origin at its mirror, x along its zero bearing.
    Laser,
}
