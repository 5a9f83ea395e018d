//! The strokes that the paper's drawings share.

use grouser_figure::{Colour, Dash, Scene, Shape, Style};

/// A solid line of `width`.
pub(super) fn stroke(colour: Colour, width: f64) -> Style {
    Style {
        width,
        ..Style::thin(colour, Dash::Solid)
    }
}

/// The closed outline of a box about its centre; `half` is half its size.
pub(super) fn corners([x, y]: [f64; 2], half: [f64; 2]) -> Vec<[f64; 2]> {
    let [a, b] = half;
    [[-a, -b], [a, -b], [a, b], [-a, b], [-a, -b]]
        .map(|[i, j]| [x + i, y + j])
        .into()
}

/// The frame of a box.
pub(super) fn framed(scene: Scene, centre: [f64; 2], half: [f64; 2], colour: Colour) -> Scene {
    scene.shape(Shape::Line(corners(centre, half), stroke(colour, 1.0)))
}
