//! What is wrong with a formula, and at which column.

/// The result of reading a formula.
pub(super) type Result<T> = std::result::Result<T, FormulaError>;

/// Why a text is no formula. Columns are counted in characters, from 1.
///
/// ```
/// use grouser_design::{Formula, VariableNames};
///
/// let error = Formula::parse("radius + widht", &VariableNames::new(["radius", "width"])).unwrap_err();
/// assert!(error.to_string().contains("widht"));
/// assert_eq!(error.hint().unwrap(), "did you mean `width`?");
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormulaError {
    /// Something else than what must follow.
    #[error("column {column}: found {found}, but {expected} must follow")]
    Unexpected {
        /// Where.
        column: usize,
        /// What was found there.
        found: String,
        /// What is expected there.
        expected: &'static str,
    },
    /// A character that no formula contains.
    #[error("column {column}: `{character}` has no meaning in a formula")]
    Character {
        /// Where.
        column: usize,
        /// The character.
        character: char,
    },
    /// A number beyond double precision.
    #[error("column {column}: the number `{text}` is too large")]
    NumberTooLarge {
        /// Where.
        column: usize,
        /// The number as written.
        text: String,
    },
    /// A name without a meaning.
    #[error("column {column}: nothing is called `{name}`")]
    UnknownName {
        /// Where.
        column: usize,
        /// The name.
        name: String,
        /// What was probably meant.
        meant: Option<String>,
    },
    /// A function that does not exist.
    #[error("column {column}: there is no function `{name}`")]
    UnknownFunction {
        /// Where.
        column: usize,
        /// The name.
        name: String,
        /// What was probably meant.
        meant: Option<String>,
    },
    /// A function with too few or too many arguments.
    #[error("column {column}: `{name}` takes {expected} arguments, but has {given}")]
    Arguments {
        /// The place of the function.
        column: usize,
        /// The function.
        name: &'static str,
        /// How many it has.
        given: usize,
        /// How many it takes.
        expected: &'static str,
    },
    /// A parenthesis that is never closed.
    #[error("column {column}: this parenthesis is never closed")]
    Unclosed {
        /// Where it opens.
        column: usize,
    },
    /// Parentheses deeper than the limit.
    #[error("column {column}: parentheses nest deeper than {limit}")]
    TooDeep {
        /// Where the limit is passed.
        column: usize,
        /// The limit.
        limit: usize,
    },
    /// A constraint without exactly one relation.
    #[error(
        "column {column}: a constraint has exactly one of `<=`, `>=` and `=`, this one has {given}"
    )]
    Relations {
        /// The place of the second relation, or the end of the text.
        column: usize,
        /// How many it has.
        given: usize,
    },
}

impl FormulaError {
    /// What to do about it, where that is known.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::UnknownName {
                meant: Some(meant), ..
            }
            | Self::UnknownFunction {
                meant: Some(meant), ..
            } => Some(format!("did you mean `{meant}`?")),
            Self::Character { character, .. } if character.is_ascii_uppercase() => {
                Some("names are written with small letters, digits and `_`".to_owned())
            }
            Self::Character {
                character: '<' | '>',
                ..
            } => Some("write `<=` or `>=`; a strict inequality has no optimum".to_owned()),
            _ => None,
        }
    }
}
