//! Frames of reference as types: a pose in one frame cannot be used as a pose in another.

/// Right-handed frame of the plane: x forward or east, y left or north, angles counter-clockwise.
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
    /// Map: fixed frame of walls, landmarks and goals.
    Map,
    /// Robot: origin midway between the drive wheels, x forward.
    Body,
    /// Goal: origin at the goal position, x along the goal heading.
    Goal,
    /// Current target point of a path: origin at the point, x along the path.
    Target,
    /// Laser range finder: origin at its mirror, x along beam angle 0.
    Laser,
}
