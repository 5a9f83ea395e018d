//! What is wrong with a problem file.

use crate::formula::FormulaError;

/// The result of reading or solving a problem.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a problem cannot be solved.
///
/// ```
/// use grouser_files::Document;
///
/// let text = "format = 1\nmethod = \"minimax\"\n[variables]\nx = { start = 1.0 }\n[objectives]\nf = \"y\"\n";
/// let error = grouser_design::parse(&Document::from_text("a.toml", text.into())?).unwrap_err();
/// assert!(error.to_string().starts_with("a.toml:6:"));
/// # Ok::<(), grouser_files::Error>(())
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file itself is wrong: syntax, keys, types, ranges.
    #[error(transparent)]
    File(#[from] grouser_files::Error),
    /// A formula is wrong; its column counts within the formula.
    #[error("{at}: `{name}`, {source}")]
    Formula {
        /// The place of the formula.
        at: grouser_files::Place,
        /// Whose formula it is.
        name: String,
        /// What is wrong, with the column.
        source: FormulaError,
    },
    /// A name that a formula could not contain, or that means something else already.
    #[error("{at}: `{name}` cannot name a {what}: {reason}")]
    Name {
        /// Where.
        at: grouser_files::Place,
        /// The name.
        name: String,
        /// What it should name.
        what: &'static str,
        /// Why it cannot.
        reason: &'static str,
    },
    /// A number that a quantity needs is given nowhere.
    #[error(
        "{at}: `{name}` uses `{quantity}`, which needs `{parameter}`; neither [{section}] nor a variable gives it"
    )]
    MissingParameter {
        /// The place of the formula.
        at: grouser_files::Place,
        /// Whose formula it is.
        name: String,
        /// The quantity or number used.
        quantity: &'static str,
        /// What it needs.
        parameter: &'static str,
        /// Where it would be written.
        section: &'static str,
    },
    /// A soil that is not in the catalogue.
    #[error("{at}: soil `{key}` is not in the catalogue")]
    UnknownSoil {
        /// Where.
        at: grouser_files::Place,
        /// The key.
        key: String,
        /// What was probably meant.
        meant: Option<&'static str>,
    },
    /// Two entries that exclude each other, or one that lacks its partner.
    #[error("{at}: {message}")]
    Contradiction {
        /// Where.
        at: grouser_files::Place,
        /// What is wrong.
        message: String,
    },
    /// Nothing can be proved about the problem.
    #[error("{file}: no certificate: {reason}")]
    NoCertificate {
        /// The file.
        file: String,
        /// Why.
        reason: String,
    },
    /// A number of a mission outside its limits.
    #[error("{0:#}")]
    OutOfRange(grouser_real::OutOfRange<String>),
    /// A mission that contradicts itself or lacks something.
    #[error("{0}")]
    Mission(String),
    /// The laws refuse a wheel of a mission on a soil.
    #[error("{of}: {source}")]
    Law {
        /// Which wheel or soil.
        of: String,
        /// Why.
        source: grouser_terra::Error,
    },
    /// The solver refuses the problem.
    #[error("{file}: {source}")]
    Problem {
        /// The file.
        file: String,
        /// Why.
        source: grouser_opt::Error,
    },
}

impl Error {
    /// What to do about it, where that is known.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::File(error) => error.hint(),
            Self::Formula { source, .. } => source.hint(),
            Self::UnknownSoil {
                meant: Some(meant), ..
            } => Some(format!("did you mean \"{meant}\"?")),
            Self::UnknownSoil { .. } => Some("`grouser soils` lists the catalogue".to_owned()),
            Self::Problem {
                source: grouser_opt::Error::UnboundedVariable { name, .. },
                ..
            } => Some(format!("give `{name}` a lower and an upper bound")),
            _ => None,
        }
    }
}
