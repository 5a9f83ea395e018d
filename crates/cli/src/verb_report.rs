//! What a verb hands back: one JSON object, and the same as text.

use grouser_report::Object;

use crate::exit::Outcome;

/// How the text of a result is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Medium {
    /// Lines for people, their first one as a headline.
    Text,
    /// The content of a file: as it is.
    File,
    /// Standard output has the result itself: lines for people on standard error.
    Aside,
}

/// The result of a verb.
#[derive(Debug)]
pub(crate) struct Report {
    /// How the job ended.
    pub(crate) outcome: Outcome,
    /// The keys of the JSON object, `provenance` aside.
    pub(crate) object: Object,
    /// What a person reads.
    pub(crate) text: String,
    pub(crate) medium: Medium,
    /// Why there is no result: printed as an error, after the report.
    pub(crate) failure: Option<String>,
    /// What is uncertain in it: printed on standard error.
    pub(crate) warnings: Vec<String>,
}

impl Report {
    /// A job that is done.
    pub(crate) fn done(object: Object, text: String) -> Self {
        Self {
            outcome: Outcome::Done,
            object,
            text,
            medium: Medium::Text,
            failure: None,
            warnings: Vec::new(),
        }
    }

    /// A text that is printed as it is.
    pub(crate) fn file(object: Object, text: String) -> Self {
        Self {
            medium: Medium::File,
            ..Self::done(object, text)
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
