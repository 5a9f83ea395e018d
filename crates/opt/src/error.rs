//! What is wrong with a problem or its settings: the field, its value and the limit.

use grouser_real::OutOfRange;

/// The result of everything that checks an input.
pub type Result<T> = core::result::Result<T, Error>;

/// A bad input. A solve that finds no answer is not one of these: see [`Status`](crate::Status).
///
/// ```
/// use grouser_opt::{Differences, Error, Problem, ProblemParams};
///
/// let model = Differences::new(|_: &[f64], _: &mut [f64]| {});
/// let error = Problem::new(ProblemParams::new(&[f64::NAN], 1, model)).err().unwrap();
/// assert!(matches!(error, Error::NotFinite { .. }));
/// assert_eq!(error.to_string(), "start of `x1` is NaN, but must be a finite number");
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is nothing to vary or nothing to minimise.
    #[error("the problem has no {what}")]
    Empty {
        /// What is missing: `variables`, `objectives`, …
        what: &'static str,
    },
    /// A number is NaN, or infinite where only a finite one makes sense.
    #[error("{field} of `{name}` is {value}, but must be a finite number")]
    NotFinite {
        /// The field: `start`, `lower`, `coefficient`, …
        field: &'static str,
        /// The variable, objective or constraint it belongs to.
        name: String,
        /// What was given.
        value: f64,
    },
    /// No value can satisfy both bounds.
    #[error("the bounds of `{name}` are inconsistent: lower {lower} is greater than upper {upper}")]
    InconsistentBounds {
        /// The variable.
        name: String,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// A search over the whole box needs both ends of it.
    #[error("`{name}` has the bounds [{lower}, {upper}], but {purpose} needs finite ones")]
    UnboundedVariable {
        /// The variable.
        name: String,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
        /// What needs them: `multi-start`, `a Pareto front`, …
        purpose: &'static str,
    },
    /// A list has the wrong number of entries.
    #[error("{what} has {given} entries, but {expected} are needed")]
    WrongLength {
        /// The list.
        what: String,
        /// How many were given.
        given: usize,
        /// How many are needed.
        expected: usize,
    },
    /// A number lies outside its range (NaN always does).
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange<String>),
    /// Two things have the same name, so that a report could not distinguish them.
    #[error("the name `{name}` is used twice")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// The matrix has no Cholesky factor.
    #[error("{what} is not positive definite: pivot {pivot} is {value}")]
    NotPositiveDefinite {
        /// The matrix.
        what: &'static str,
        /// The row at which the factorisation stopped.
        pivot: usize,
        /// What stood there.
        value: f64,
    },
    /// More points were requested than the sequence has dimensions or length for.
    #[error("{what} is {given}, but at most {limit} is supported")]
    TooLarge {
        /// What was requested.
        what: &'static str,
        /// How much.
        given: usize,
        /// The limit.
        limit: usize,
    },
}

impl Error {
    pub(crate) fn check_finite(field: &'static str, name: &str, value: f64) -> Result<()> {
        if value.is_finite() {
            Ok(())
        } else {
            Err(Self::NotFinite {
                field,
                name: name.to_owned(),
                value,
            })
        }
    }

    pub(crate) fn check_range(field: &str, value: f64, low: f64, high: f64) -> Result<()> {
        Ok(OutOfRange::check(field, value, (low, high), "1")?)
    }

    pub(crate) fn check_length(what: &str, given: usize, expected: usize) -> Result<()> {
        if given == expected {
            Ok(())
        } else {
            Err(Self::WrongLength {
                what: what.to_owned(),
                given,
                expected,
            })
        }
    }
}
