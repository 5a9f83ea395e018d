//! What a verb hands back: one JSON object, and the same as text.

use grouser_report::Object;

use crate::exit::Outcome;

/// The result of a verb.
#[derive(Debug)]
pub(crate) struct Report {
    /// How the job ended.
    pub(crate) outcome: Outcome,
    /// The keys of the JSON object, `provenance` aside.
    pub(crate) object: Object,
    /// What a person reads.
    pub(crate) text: String,
    /// Whether standard output holds the result itself, so that the text goes to standard error.
    pub(crate) is_aside: bool,
    /// Why there is no result: said as an error, although the report is printed.
    pub(crate) failure: Option<String>,
    /// What is doubtful in it: said on standard error.
    pub(crate) warnings: Vec<String>,
}

impl Report {
    /// A job that is done.
    pub(crate) fn done(object: Object, text: String) -> Self {
        Self {
            outcome: Outcome::Done,
            object,
            text,
            is_aside: false,
            failure: None,
            warnings: Vec::new(),
        }
    }

    /// Where something failed there is no result.
    pub(crate) fn failing(self, failure: Option<String>) -> Self {
        let outcome = match failure {
            Some(_) => Outcome::NoResult,
            None => self.outcome,
        };
        Self {
            outcome,
            failure,
            ..self
        }
    }
}
