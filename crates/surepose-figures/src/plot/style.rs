//! Colors and line styles of all pictures.

use std::fmt;

/// Color-blind safe colors by Okabe and Ito, and grays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Color {
    /// Ground truth.
    Black,
    /// Walls.
    Grey,
    /// Background layers.
    Silver,
    /// Unknown areas.
    Mist,
    /// First series.
    Blue,
    /// Second series.
    Vermilion,
    /// Third series.
    Green,
    /// Fourth series.
    Orange,
    /// Fifth series.
    Purple,
    /// Sixth series.
    Sky,
}

impl Color {
    /// Colors of compared series, in order.
    pub const SERIES: [Self; 6] =
        [Self::Blue, Self::Vermilion, Self::Green, Self::Orange, Self::Purple, Self::Sky];

    /// Color of series `index`; repeats after six series.
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

/// Red, green, and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Rgb(pub(crate) [u8; 3]);

impl Rgb {
    /// Frames, ticks, and text.
    pub(crate) const INK: Self = Color::Black.rgb();
    /// Grid lines.
    pub(crate) const GRID: Self = Self([221; 3]);
    /// Background.
    pub(crate) const PAPER: Self = Self([255; 3]);

    /// Blends the color with the background at the given opacity.
    pub(crate) fn on_paper(self, opacity: f64) -> Self {
        Self(self.0.map(|part| (255.0 - opacity * (255.0 - f64::from(part))).round() as u8))
    }
}

impl fmt::Display for Rgb {
    /// Formats as `#rrggbb`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [red, green, blue] = self.0;
        write!(f, "#{red:02x}{green:02x}{blue:02x}")
    }
}

/// Color and width of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Color.
    pub color: Color,
    /// Width \[px].
    pub width: f64,
}

impl Stroke {
    /// Line of standard width.
    pub const fn solid(color: Color) -> Self {
        Self { color, width: 1.8 }
    }

    /// Thin line, for dense data or on top of a wide line.
    pub const fn thin(color: Color) -> Self {
        Self { color, width: 1.0 }
    }

    /// Wide line, below other lines.
    pub const fn wide(color: Color) -> Self {
        Self { color, width: 3.5 }
    }
}
