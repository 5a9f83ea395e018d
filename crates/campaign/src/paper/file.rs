//! A file that the campaign writes.

use grouser_figure::Figure;

/// A file of the paper's folder.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PaperFile {
    /// Its name; of a figure without the ending.
    pub name: String,
    /// What it holds.
    pub content: Content,
    /// What that is, in words.
    pub about: String,
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Content {
    /// Text as it is written.
    Text(String),
    /// A figure, written as SVG and as PNG.
    Figure(Figure),
}

impl PaperFile {
    pub(super) fn text(name: impl Into<String>, text: String, about: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            content: Content::Text(text),
            about: about.into(),
        }
    }

    pub(super) fn figure(
        name: impl Into<String>,
        figure: Figure,
        about: impl Into<String>,
    ) -> Self {
        Self {
            name: name.into(),
            content: Content::Figure(figure),
            about: about.into(),
        }
    }

    /// The names that are written: a figure's with both endings.
    ///
    /// ```
    /// use grouser_campaign::paper::{Paper, SandRun};
    ///
    /// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/scenarios/sandbox.toml");
    /// let scenario = grouser_rover::drive::read_scenario(file.as_ref())?;
    /// let run = SandRun { wheels: Vec::new(), seed: scenario.seed, robot: scenario.robot.clone() };
    /// let paper = Paper::compute(&scenario, run)?;
    /// assert!(paper.files().iter().flat_map(|file| file.names()).any(|name| name == "figure-8.png"));
    /// # Ok::<(), grouser_campaign::Error>(())
    /// ```
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        match self.content {
            Content::Text(_) => vec![self.name.clone()],
            Content::Figure(_) => ["svg", "png"]
                .map(|end| format!("{}.{end}", self.name))
                .into(),
        }
    }
}
