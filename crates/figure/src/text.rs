//! Marked-up text set in one line: `*italic*`, `_{subscript}`, `^{superscript}`, `\` before a character
//! that is meant as it stands.

use super::geometry::{Point, Rect};
use super::path::Path;
use super::typeface::{self, Cut};

/// `name` as it stands, whatever characters it holds.
///
/// ```
/// assert_ne!(grouser_figure::plain("run_{2}"), "run_{2}");
/// assert_eq!(grouser_figure::plain("run"), "run");
/// ```
#[must_use]
pub fn plain(name: &str) -> String {
    let mut escaped = String::with_capacity(name.len());
    for letter in name.chars() {
        if matches!(letter, '*' | '_' | '^' | '{' | '}' | '\\') {
            escaped.push('\\');
        }
        // Control characters have no shape.
        escaped.push(if letter.is_control() { ' ' } else { letter });
    }
    escaped
}

/// Where the reference point of a text stands along its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text set at the origin: its baseline is y = 0.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) outline: Path,
    /// The advance, in points.
    pub(super) width: f64,
    /// The words without markup.
    pub(super) words: String,
    /// Around the ink, or around the origin when there is none.
    pub(super) ink: Rect,
}

/// Size of sub- and superscripts and how far they are moved, in parts of the text size.
const SCRIPT_SIZE: f64 = 0.72;
const SUBSCRIPT_DROP: f64 = 0.20;
const SUPERSCRIPT_RISE: f64 = 0.36;

impl Line {
    /// Sets `markup` at `size` points.
    pub(super) fn set(markup: &str, size: f64) -> Self {
        Self::set_in(markup, size, Cut::Regular)
    }

    /// The same in bold.
    pub(super) fn set_bold(markup: &str, size: f64) -> Self {
        Self::set_in(markup, size, Cut::Bold)
    }

    fn set_in(markup: &str, size: f64, upright: Cut) -> Self {
        let mut outline = Path::default();
        let mut words = String::new();
        let mut width = 0.0;
        for run in runs(markup) {
            let cut = if run.italic { Cut::Italic } else { upright };
            let (scale, shift) = match run.level {
                Level::Base => (size, 0.0),
                Level::Sub => (size * SCRIPT_SIZE, size * SUBSCRIPT_DROP),
                Level::Super => (size * SCRIPT_SIZE, -size * SUPERSCRIPT_RISE),
            };
            let (shape, advance) = typeface::outline(&run.text, cut);
            outline.append(&shape.mapped(|[x, y]| [width + scale * x, shift + scale * y]));
            width += scale * advance;
            words.push_str(&run.text);
        }
        let nothing = Rect::at([0.0, 0.0], width, 0.0);
        let ink = outline.bounds().unwrap_or(nothing);
        Self {
            outline,
            width,
            words,
            ink,
        }
    }

    /// The outline with the reference point of its baseline at `point`.
    pub(super) fn placed(&self, point: Point, anchor: Anchor) -> Path {
        self.outline
            .moved([point[0] - self.width * Self::share(anchor), point[1]])
    }

    /// The same, turned a quarter to the left: it reads upwards.
    pub(super) fn placed_upwards(&self, point: Point, anchor: Anchor) -> Path {
        let start = self.width * Self::share(anchor);
        self.outline
            .mapped(|[x, y]| [point[0] + y, point[1] - (x - start)])
    }

    fn share(anchor: Anchor) -> f64 {
        match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Base,
    Sub,
    Super,
}

#[derive(Debug, PartialEq, Eq)]
struct Run {
    text: String,
    italic: bool,
    level: Level,
}

/// Cuts marked-up text into runs of one look. Markup that is left open ends with the text.
fn runs(markup: &str) -> Vec<Run> {
    let mut runs = Vec::new();
    let mut run = Run {
        text: String::new(),
        italic: false,
        level: Level::Base,
    };
    let mut letters = markup.chars().peekable();
    while let Some(letter) = letters.next() {
        let (italic, level) = match letter {
            '\\' => {
                run.text.extend(letters.next());
                continue;
            }
            '*' => (!run.italic, run.level),
            '_' if letters.next_if_eq(&'{').is_some() => (run.italic, Level::Sub),
            '^' if letters.next_if_eq(&'{').is_some() => (run.italic, Level::Super),
            '}' if run.level != Level::Base => (run.italic, Level::Base),
            _ => {
                run.text.push(letter);
                continue;
            }
        };
        let text = std::mem::take(&mut run.text);
        if !text.is_empty() {
            runs.push(Run { text, ..run });
        }
        run = Run {
            text: String::new(),
            italic,
            level,
        };
    }
    if !run.text.is_empty() {
        runs.push(run);
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_is_cut_into_runs() {
        let cut: Vec<_> = runs("Pull *F*_{DP} (N)")
            .into_iter()
            .map(|run| (run.text, run.italic, run.level))
            .collect();
        assert_eq!(
            cut,
            [
                ("Pull ".to_owned(), false, Level::Base),
                ("F".to_owned(), true, Level::Base),
                ("DP".to_owned(), false, Level::Sub),
                (" (N)".to_owned(), false, Level::Base),
            ]
        );
    }

    #[test]
    fn a_users_name_keeps_its_characters() {
        let name = r"left_{front}*2^{x}\";
        assert_eq!(Line::set(&plain(name), 10.0).words, name);
    }
}
