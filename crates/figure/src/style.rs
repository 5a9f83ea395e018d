//! Colours, dashes and markers. Every curve is distinguished by its dash as well as by its colour.

use std::fmt;

/// An opaque colour, red, green and blue.
///
/// ```
/// use grouser_figure::Colour;
///
/// assert_ne!(Colour::INK, Colour(255, 255, 255));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// Text and axes.
    pub const INK: Self = Self(0x1a, 0x1a, 0x1e);
    /// What stays in the background: zero lines, leaders.
    pub const GREY: Self = Self(0x74, 0x74, 0x7a);
    /// Soil.
    pub const SAND: Self = Self(0xec, 0xdf, 0xc6);
    /// The first curve.
    pub const BLUE: Self = Self(0x25, 0x6a, 0x8f);
    /// The second.
    pub const RED: Self = Self(0xc4, 0x4e, 0x34);
    /// The third.
    pub const OCHRE: Self = Self(0xa8, 0x78, 0x14);
    /// The fourth.
    pub const GREEN: Self = Self(0x3f, 0x7d, 0x55);
    /// The fifth.
    pub const PURPLE: Self = Self(0x7a, 0x4e, 0x91);
    /// The sixth.
    pub const SLATE: Self = Self(0x4e, 0x58, 0x66);
    /// The seventh.
    pub const ROSE: Self = Self(0xb3, 0x4a, 0x7d);
}

impl fmt::Display for Colour {
    /// As in SVG and CSS: `#rrggbb`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(red, green, blue) = self;
        write!(f, "#{red:02x}{green:02x}{blue:02x}")
    }
}

/// How a line is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Dash {
    /// Not at all.
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// A dash and a dot in turn.
    DashDot,
    /// Long dashes.
    Long,
    /// A dash and two dots in turn.
    DashDotDot,
    /// Short dashes.
    Short,
}

impl Dash {
    /// Strokes and gaps in turn, in widths of the line; empty for a solid one.
    pub(super) fn pattern(self) -> &'static [f64] {
        match self {
            Self::Solid => &[],
            Self::Dashed => &[4.6, 2.0],
            Self::Dotted => &[1.1, 1.3],
            Self::DashDot => &[5.6, 1.7, 1.1, 1.7],
            Self::Long => &[9.0, 2.4],
            Self::DashDotDot => &[5.6, 1.6, 1.1, 1.6, 1.1, 1.6],
            Self::Short => &[2.4, 1.6],
        }
    }
}

/// How a measured point looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Marker {
    /// A filled disc.
    Disc,
    /// An open circle.
    Circle,
    /// An open square.
    Square,
    /// An open triangle.
    Triangle,
    /// An open diamond.
    Diamond,
}

/// Colour, dash and width of a line.
///
/// ```
/// use grouser_figure::Style;
///
/// assert_ne!(Style::numbered(0), Style::numbered(1)); // curves of one chart differ
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Its colour, and that of its label.
    pub colour: Colour,
    /// How it is broken.
    pub dash: Dash,
    /// Its width in points.
    pub width: f64,
}

impl Style {
    /// The look of curve number `index`, from 0. Seven differ in colour and dash; then the pairs change.
    #[must_use]
    pub fn numbered(index: usize) -> Self {
        const COLOURS: [Colour; 7] = [
            Colour::BLUE,
            Colour::RED,
            Colour::OCHRE,
            Colour::GREEN,
            Colour::PURPLE,
            Colour::SLATE,
            Colour::ROSE,
        ];
        const DASHES: [Dash; 7] = [
            Dash::Solid,
            Dash::Dashed,
            Dash::Dotted,
            Dash::DashDot,
            Dash::Long,
            Dash::DashDotDot,
            Dash::Short,
        ];
        let round = index / COLOURS.len();
        Self {
            colour: COLOURS[index % COLOURS.len()],
            dash: DASHES[(index + round) % DASHES.len()],
            width: 1.2,
        }
    }

    /// A thin line behind the data.
    #[must_use]
    pub fn thin(colour: Colour, dash: Dash) -> Self {
        Self {
            colour,
            dash,
            width: 0.6,
        }
    }
}

impl Default for Style {
    fn default() -> Self {
        Self::numbered(0)
    }
}
