//! What is on the page: the list that both writers draw.

use super::geometry::{Point, Rect};
use super::path::Path;
use super::style::{Colour, Style};

/// The page and all that is on it, back to front.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Page {
    /// In points.
    pub(super) width: f64,
    pub(super) height: f64,
    /// What the figure shows, in words.
    pub(super) description: String,
    pub(super) items: Vec<Item>,
}

/// One thing on the page.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Item {
    /// A filled outline; seen through by 1 − `opacity`.
    Fill {
        path: Path,
        colour: Colour,
        opacity: f64,
        clip: Option<Rect>,
    },
    /// A line along an outline.
    Stroke {
        path: Path,
        colour: Colour,
        width: f64,
        dash: Vec<f64>,
        clip: Option<Rect>,
    },
    /// Letters, and what they say.
    Text {
        path: Path,
        colour: Colour,
        words: String,
    },
}

impl Page {
    pub(super) fn fill(&mut self, path: Path, colour: Colour, opacity: f64, clip: Option<Rect>) {
        self.items.push(Item::Fill {
            path,
            colour,
            opacity,
            clip,
        });
    }

    /// A line whose dash is given in widths of the line.
    pub(super) fn stroke(&mut self, path: Path, style: Style, clip: Option<Rect>) {
        let dash = style
            .dash
            .pattern()
            .iter()
            .map(|part| part * style.width)
            .collect();
        let Style { colour, width, .. } = style;
        self.items.push(Item::Stroke {
            path,
            colour,
            width,
            dash,
            clip,
        });
    }

    pub(super) fn text(&mut self, path: Path, colour: Colour, words: &str) {
        self.items.push(Item::Text {
            path,
            colour,
            words: words.to_owned(),
        });
    }

    /// Puts all that is on `part` on this page, moved by `by`.
    pub(super) fn put(&mut self, part: Self, by: Point) {
        self.items
            .extend(part.items.into_iter().map(|item| item.moved(by)));
    }
}

impl Item {
    fn moved(self, by: Point) -> Self {
        let moved = |clip: Option<Rect>| {
            clip.map(|clip| {
                Rect::at(
                    [clip.left + by[0], clip.top + by[1]],
                    clip.width(),
                    clip.height(),
                )
            })
        };
        match self {
            Self::Fill {
                path,
                colour,
                opacity,
                clip,
            } => Self::Fill {
                path: path.moved(by),
                colour,
                opacity,
                clip: moved(clip),
            },
            Self::Stroke {
                path,
                colour,
                width,
                dash,
                clip,
            } => Self::Stroke {
                path: path.moved(by),
                colour,
                width,
                dash,
                clip: moved(clip),
            },
            Self::Text {
                path,
                colour,
                words,
            } => Self::Text {
                path: path.moved(by),
                colour,
                words,
            },
        }
    }
}
