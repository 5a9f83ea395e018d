//! A drawing to scale, y upwards.

use super::style::{Colour, Style};

/// A panel without axes: shapes in one unit of length, in the order in which they are drawn.
///
/// ```
/// use grouser_figure::{Colour, Dash, Figure, Scene, Shape, Style};
///
/// let wheel = Shape::Circle([0.0, 0.1], 0.1, Style::thin(Colour::INK, Dash::Solid));
/// let scene = Scene::new([-0.2, 0.0], [0.2, 0.2]).shape(wheel).label([0.0, 0.1], "wheel", Colour::INK);
/// assert!(Figure::new("a wheel").panel(scene).svg().contains("aria-label=\"wheel\""));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    pub(super) view: [[f64; 2]; 2],
    pub(super) shapes: Vec<Shape>,
    pub(super) labels: Vec<SceneLabel>,
    pub(super) notes: Vec<String>,
}

/// A label at a point of a scene.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SceneLabel {
    pub(super) at: [f64; 2],
    pub(super) text: String,
    pub(super) colour: Colour,
}

/// One shape of a scene.
///
/// ```
/// use grouser_figure::{Colour, Shape};
///
/// let hub = Shape::Disc([0.0, 0.1], 0.01, Colour::INK);
/// assert_ne!(hub, Shape::Disc([0.0, 0.1], 0.02, Colour::INK));
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A line through points.
    Line(Vec<[f64; 2]>, Style),
    /// A filled outline, in a colour and an opacity.
    Filled(Vec<[f64; 2]>, Colour, f64),
    /// A circle: centre and radius.
    Circle([f64; 2], f64, Style),
    /// A filled disc: centre and radius.
    Disc([f64; 2], f64, Colour),
    /// An arrow from a point to a point.
    Arrow([f64; 2], [f64; 2], Style),
    /// A marked-up line of text, its middle at a point.
    Text([f64; 2], String, Colour),
}

impl Scene {
    /// An empty scene that shows at least the box between two opposite corners.
    #[must_use]
    pub fn new(corner: [f64; 2], opposite: [f64; 2]) -> Self {
        Self {
            view: [corner, opposite],
            shapes: Vec::new(),
            labels: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// One more shape, before the others.
    #[must_use]
    pub fn shape(mut self, shape: Shape) -> Self {
        self.shapes.push(shape);
        self
    }

    /// A marked-up label at a point; it finds a free place beside it.
    #[must_use]
    pub fn label(mut self, at: [f64; 2], text: impl Into<String>, colour: Colour) -> Self {
        self.labels.push(SceneLabel {
            at,
            text: text.into(),
            colour,
        });
        self
    }

    /// One more marked-up line of the text in the upper left corner.
    #[must_use]
    pub fn note(mut self, line: impl Into<String>) -> Self {
        self.notes.push(line.into());
        self
    }
}
