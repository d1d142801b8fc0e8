//! Colours and strokes, the same in every picture.

use std::fmt;

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
    pub fn from_series(index: usize) -> Self {
        Self::SERIES[index % Self::SERIES.len()]
    }

    pub(crate) const fn rgb(self) -> Rgb {
        Rgb(match self {
            Self::Black => [0x22, 0x22, 0x22],
            Self::Grey => [0x77, 0x77, 0x77],
            Self::Silver => [0xb8, 0xb8, 0xb8],
            Self::Mist => [0xe2, 0xe2, 0xe2],
            Self::Blue => [0x00, 0x72, 0xb2],
            Self::Vermilion => [0xd5, 0x5e, 0x00],
            Self::Green => [0x00, 0x9e, 0x73],
            Self::Orange => [0xe6, 0x9f, 0x00],
            Self::Purple => [0xaa, 0x44, 0x99],
            Self::Sky => [0x56, 0xb4, 0xe9],
        })
    }
}

/// Red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Rgb(pub(crate) [u8; 3]);

impl Rgb {
    /// Frames, ticks and text.
    pub(crate) const INK: Self = Color::Black.rgb();
    /// Grid lines.
    pub(crate) const GRID: Self = Self([221; 3]);
    /// The background.
    pub(crate) const PAPER: Self = Self([255; 3]);

    /// The color at this opacity on paper.
    pub(crate) fn on_paper(self, opacity: f64) -> Self {
        Self(self.0.map(|part| (255.0 - opacity * (255.0 - f64::from(part))).round() as u8))
    }
}

impl fmt::Display for Rgb {
    /// Writes `#rrggbb`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [red, green, blue] = self.0;
        write!(f, "#{red:02x}{green:02x}{blue:02x}")
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
