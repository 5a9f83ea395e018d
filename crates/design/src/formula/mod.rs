//! Formulas in problem files: read once, computed over any kind of number.
//!
//! ```
//! use grouser_design::{Formula, VariableNames};
//! use grouser_real::Dual;
//!
//! let names = VariableNames::new(["x1", "x2"]);
//! let formula = Formula::parse("2*x1^2 + x2^2 - 48*x1 - 40*x2 + 304", &names)?;
//! assert_eq!(formula.evaluate(&[4.0, 4.0]), 0.0);
//! let at = formula.evaluate(&[Dual::<1>::variable(4.0, 0), Dual::constant(4.0)]);
//! assert_eq!(at.gradient, [-32.0]);
//! # Ok::<(), grouser_design::FormulaError>(())
//! ```

mod affine;
mod error;
mod parse;
mod program;
mod token;

pub use error::FormulaError;
pub use parse::{DEPTH_LIMIT, Names};
pub use program::Formula;
pub use token::Relation;

pub(crate) use parse::constraint;

impl Formula {
    /// Reads a formula.
    ///
    /// Grammar: `+ - * / ^`, parentheses, numbers like `1e-8`; `^` associates to the right and binds
    /// tighter than a sign; `exp ln log10 sqrt abs sin cos tan asin acos atan sinh cosh tanh min max atan2
    /// pow`; `pi`; names of small letters, digits and `_`.
    ///
    /// # Errors
    /// [`FormulaError`] with the column.
    pub fn parse(text: &str, names: &impl Names) -> Result<Self, FormulaError> {
        parse::formula(text, names)
    }
}

/// Is `name` a name that a formula can contain and that means nothing yet?
pub(crate) fn is_free_name(name: &str) -> bool {
    let mut letters = name.bytes();
    let begins = letters
        .next()
        .is_some_and(|b| b.is_ascii_lowercase() || b == b'_');
    begins
        && letters.all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
        && name != "pi"
        && program::Function::ALL
            .iter()
            .all(|(known, _)| *known != name)
}

/// A plain list of variables.
///
/// ```
/// use grouser_design::{Names, VariableNames};
///
/// let names = VariableNames::new(["radius", "width"]);
/// assert_eq!(names.variable("width"), Some(1));
/// assert_eq!(names.meant("widht").as_deref(), Some("width"));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VariableNames {
    names: Vec<String>,
}

impl VariableNames {
    /// Variables numbered in this order.
    pub fn new(names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self {
            names: names.into_iter().map(Into::into).collect(),
        }
    }
}

impl Names for VariableNames {
    fn variable(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }

    fn meant(&self, name: &str) -> Option<String> {
        grouser_files::nearest(name, self.names.iter().map(String::as_str)).map(str::to_owned)
    }
}
