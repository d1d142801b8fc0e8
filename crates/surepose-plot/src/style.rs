//! Colours and strokes, the same in every picture.

/// A colour of the palette of Okabe and Ito, which colour-blind readers can tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Color {
    /// What is true.
    Black,
    /// What stands still: walls.
    Grey,
    /// What lies below something else.
    Silver,
    /// What is not known.
    Mist,
    /// The first of several.
    Blue,
    /// The second.
    Vermilion,
    /// The third.
    Green,
    /// The fourth.
    Orange,
    /// The fifth.
    Purple,
    /// The sixth.
    Sky,
}

impl Color {
    /// Colours for things that are compared, in order.
    pub const SERIES: [Self; 6] =
        [Self::Blue, Self::Vermilion, Self::Green, Self::Orange, Self::Purple, Self::Sky];

    /// The colour of the `index`-th of several things.
    pub fn of_series(index: usize) -> Self {
        Self::SERIES[index % Self::SERIES.len()]
    }

    pub(crate) const fn hex(self) -> &'static str {
        match self {
            Self::Black => "#222222",
            Self::Grey => "#777777",
            Self::Silver => "#b8b8b8",
            Self::Mist => "#e2e2e2",
            Self::Blue => "#0072b2",
            Self::Vermilion => "#d55e00",
            Self::Green => "#009e73",
            Self::Orange => "#e69f00",
            Self::Purple => "#aa4499",
            Self::Sky => "#56b4e9",
        }
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub color: Color,
    /// Its width \[px].
    pub width: f64,
}

impl Stroke {
    /// A line of ordinary width.
    pub const fn solid(color: Color) -> Self {
        Self { color, width: 1.8 }
    }

    /// A thin line, for what there is much of, or for what lies on top of a wide one.
    pub const fn thin(color: Color) -> Self {
        Self { color, width: 1.0 }
    }

    /// A wide line, for what lies below others.
    pub const fn wide(color: Color) -> Self {
        Self { color, width: 3.5 }
    }
}
