//! A job done, and its result judged: are its numbers plausible, and if not, which mistake in units explains them?

use crate::error::{Error, Result};
use crate::identification::{Identification, fitted};
use crate::job::Job;
use crate::readings::Readings;
use crate::unit_mistake;

/// Does a job.
///
/// # Errors
/// What a test's file lacks; [`Error::Missing`] for a number that a later stage needs and nothing gives.
pub fn identify(job: &Job) -> Result<Identification> {
    let readings = Readings::read(job)?;
    let mut out = fitted(job, &readings).map_err(|error| match error {
        Error::TooFewReadings { message } => {
            let likely = unit_mistake::explaining(job, &readings, 0.0);
            let likely = likely
                .first()
                .map(|likely| format!(". Is it that {likely}?"));
            let message = message + &likely.unwrap_or_default();
            Error::TooFewReadings { message }
        }
        other => other,
    })?;
    out.implausible = out.plausibilities(&readings);
    out.implausible
        .retain(|number| number.decades_outside() > 0.0);
    out.unit_mistakes = unit_mistake::likely(job, &readings, &out);
    Ok(out)
}
