//! Axes and the data in them.

use super::style::{Colour, Dash, Marker, Style};

/// A panel with axes.
///
/// ```
/// use grouser_figure::{Area, Axis, Chart, Curve, Figure};
///
/// let chart = Chart::new(Axis::new("Slip *s*"), Axis::new("Pull (N)"))
///     .curve(Curve::new([[0.0, 0.0], [0.5, 12.0]]))
///     .area(Area::columns(0.1, 0.2));
/// assert!(Figure::new("pull").panel(chart).svg().contains("Pull (N)"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) areas: Vec<Area>,
    pub(super) rules: Vec<Rule>,
    pub(super) curves: Vec<Curve>,
    pub(super) points: Vec<Points>,
    pub(super) marks: Vec<Mark>,
}

impl Chart {
    /// An empty chart.
    #[must_use]
    pub fn new(x: Axis, y: Axis) -> Self {
        Self {
            x,
            y,
            areas: Vec::new(),
            rules: Vec::new(),
            curves: Vec::new(),
            points: Vec::new(),
            marks: Vec::new(),
        }
    }

    /// One more curve.
    #[must_use]
    pub fn curve(mut self, curve: Curve) -> Self {
        self.curves.push(curve);
        self
    }

    /// One more filled area, behind the curves.
    #[must_use]
    pub fn area(mut self, area: Area) -> Self {
        self.areas.push(area);
        self
    }

    /// One more set of measured points, before the curves.
    #[must_use]
    pub fn points(mut self, points: Points) -> Self {
        self.points.push(points);
        self
    }

    /// One more marked point.
    #[must_use]
    pub fn mark(mut self, mark: Mark) -> Self {
        self.marks.push(mark);
        self
    }

    /// One more straight line across the frame.
    #[must_use]
    pub fn rule(mut self, rule: Rule) -> Self {
        self.rules.push(rule);
        self
    }
}

/// One axis.
///
/// ```
/// use grouser_figure::Axis;
///
/// let slip = Axis::new("Slip *s*").range(0.0, 1.0);
/// assert_ne!(slip, Axis::new("Slip *s*"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    pub(super) title: String,
    pub(super) range: Option<[f64; 2]>,
}

impl Axis {
    /// An axis whose range follows the data; the title is marked up and ends with the unit in brackets.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            range: None,
        }
    }

    /// With a range of its own; data outside is cut off at the frame.
    #[must_use]
    pub fn range(mut self, low: f64, high: f64) -> Self {
        self.range = Some([low, high]);
        self
    }
}

/// A line through points. NaN and infinity break it.
///
/// ```
/// use grouser_figure::{Curve, Style};
///
/// let curve = Curve::new([[0.0, 0.0], [1.0, f64::NAN], [2.0, 1.0]]).style(Style::numbered(1)).label("*W* = 40 N");
/// assert_ne!(curve, Curve::new([]));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    pub(super) points: Vec<[f64; 2]>,
    pub(super) style: Style,
    pub(super) label: Option<String>,
}

impl Curve {
    /// The line through `points`.
    #[must_use]
    pub fn new(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self {
            points: points.into_iter().collect(),
            style: Style::default(),
            label: None,
        }
    }

    /// With another look.
    #[must_use]
    pub fn style(mut self, style: Style) -> Self {
        self.style = style;
        self
    }

    /// With a marked-up label beside it.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = Some(label.into());
        self
    }
}

/// A filled area.
///
/// ```
/// use grouser_figure::{Area, Colour};
///
/// let band = Area::between([[0.0, -1.0], [1.0, -1.0]], [[0.0, 1.0], [1.0, 1.0]]).colour(Colour::GREEN, 0.2);
/// assert_ne!(band, Area::columns(0.0, 1.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    pub(super) shape: AreaShape,
    pub(super) colour: Colour,
    pub(super) opacity: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum AreaShape {
    Polygon(Vec<[f64; 2]>),
    /// From one x to another, as high as the frame.
    Columns([f64; 2]),
}

impl Area {
    /// Between a line and y = 0.
    #[must_use]
    pub fn under(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let mut outline: Vec<[f64; 2]> = finite(points).collect();
        if let (Some(first), Some(last)) = (outline.first().copied(), outline.last().copied()) {
            outline.push([last[0], 0.0]);
            outline.push([first[0], 0.0]);
        }
        Self::new(AreaShape::Polygon(outline))
    }

    /// Between two lines, such as a confidence band.
    #[must_use]
    pub fn between(
        lower: impl IntoIterator<Item = [f64; 2]>,
        upper: impl IntoIterator<Item = [f64; 2]>,
    ) -> Self {
        let mut outline: Vec<[f64; 2]> = finite(lower).collect();
        let upper: Vec<[f64; 2]> = finite(upper).collect();
        outline.extend(upper.into_iter().rev());
        Self::new(AreaShape::Polygon(outline))
    }

    /// All that lies between two values of x.
    #[must_use]
    pub fn columns(from: f64, to: f64) -> Self {
        Self::new(AreaShape::Columns([from, to]))
    }

    /// In another colour; `opacity` from 0 (nothing to be seen) to 1.
    #[must_use]
    pub fn colour(mut self, colour: Colour, opacity: f64) -> Self {
        self.colour = colour;
        self.opacity = opacity;
        self
    }

    fn new(shape: AreaShape) -> Self {
        Self {
            shape,
            colour: Colour::BLUE,
            opacity: 0.12,
        }
    }
}

fn finite(points: impl IntoIterator<Item = [f64; 2]>) -> impl Iterator<Item = [f64; 2]> {
    points
        .into_iter()
        .filter(|[x, y]| x.is_finite() && y.is_finite())
}

/// A measured point with its errors.
///
/// ```
/// use grouser_figure::Measured;
///
/// let point = Measured { y_error: [0.5, 0.5], ..Measured::from([0.2, 14.0]) };
/// assert_eq!(point.at, [0.2, 14.0]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// Where it lies.
    pub at: [f64; 2],
    /// How far the error bar reaches to the left and to the right; 0 for none.
    pub x_error: [f64; 2],
    /// How far it reaches down and up; 0 for none.
    pub y_error: [f64; 2],
}

impl From<[f64; 2]> for Measured {
    fn from(at: [f64; 2]) -> Self {
        Self {
            at,
            ..Self::default()
        }
    }
}

/// A set of measured points.
///
/// ```
/// use grouser_figure::{Colour, Marker, Points};
///
/// let points = Points::new([[0.1, 8.0], [0.2, 14.0]]).look(Marker::Square, Colour::RED).label("measured");
/// assert_ne!(points, Points::new([[0.1, 8.0]]));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    pub(super) measured: Vec<Measured>,
    pub(super) marker: Marker,
    pub(super) colour: Colour,
    pub(super) label: Option<String>,
}

impl Points {
    /// Points with or without errors.
    #[must_use]
    pub fn new(measured: impl IntoIterator<Item = impl Into<Measured>>) -> Self {
        Self {
            measured: measured.into_iter().map(Into::into).collect(),
            marker: Marker::Circle,
            colour: Colour::INK,
            label: None,
        }
    }

    /// With another look.
    #[must_use]
    pub fn look(mut self, marker: Marker, colour: Colour) -> Self {
        self.marker = marker;
        self.colour = colour;
        self
    }

    /// With a marked-up label beside them.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = Some(label.into());
        self
    }
}

/// One marked point, such as an optimum.
///
/// ```
/// use grouser_figure::Mark;
///
/// let optimum = Mark::new([0.18, 15.0]).label("best slip");
/// assert_ne!(optimum, Mark::new([0.0, 0.0]));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    pub(super) at: [f64; 2],
    pub(super) marker: Marker,
    pub(super) colour: Colour,
    pub(super) label: Option<String>,
}

impl Mark {
    /// A disc at `at`.
    #[must_use]
    pub fn new(at: [f64; 2]) -> Self {
        Self {
            at,
            marker: Marker::Disc,
            colour: Colour::INK,
            label: None,
        }
    }

    /// With another look.
    #[must_use]
    pub fn look(mut self, marker: Marker, colour: Colour) -> Self {
        self.marker = marker;
        self.colour = colour;
        self
    }

    /// With a marked-up label beside it.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = Some(label.into());
        self
    }
}

/// A straight line across the frame.
///
/// ```
/// use grouser_figure::Rule;
///
/// let limit = Rule::at_y(20.0).label("limit");
/// assert_ne!(limit, Rule::at_x(20.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Does it stand at a value of x? Otherwise it lies at a value of y.
    pub(super) vertical: bool,
    pub(super) at: f64,
    pub(super) style: Style,
    pub(super) label: Option<String>,
}

impl Rule {
    /// Standing at `x`.
    #[must_use]
    pub fn at_x(x: f64) -> Self {
        Self {
            vertical: true,
            at: x,
            style: Style::thin(Colour::GREY, Dash::Dashed),
            label: None,
        }
    }

    /// Lying at `y`.
    #[must_use]
    pub fn at_y(y: f64) -> Self {
        Self {
            vertical: false,
            ..Self::at_x(y)
        }
    }

    /// With another look.
    #[must_use]
    pub fn style(mut self, style: Style) -> Self {
        self.style = style;
        self
    }

    /// With a marked-up label beside it.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = Some(label.into());
        self
    }
}
