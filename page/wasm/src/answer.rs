//! From a request to its answer.

use serde_json::{Value, json};

use crate::request::{Problem, Request};

/// Answers a request. A request that cannot be answered gives `{"error": {"field", "message"}}`.
#[must_use]
pub fn answer(request: &str) -> String {
    answer_with(request, Vec::new(), &mut |_| ())
}

/// Answers a request about a file; `take` receives parts of a run before it has ended.
#[must_use]
pub fn answer_with(request: &str, file: Vec<u8>, take: &mut dyn FnMut(Vec<u8>)) -> String {
    let answered = Request::parse(request).and_then(|request| dispatch(&request, file, take));
    answered
        .unwrap_or_else(
            |problem| json!({ "error": { "field": problem.field, "message": problem.message } }),
        )
        .to_string()
}

#[cfg_attr(
    not(all(feature = "log", feature = "optimize")),
    allow(
        unused_variables,
        reason = "only logs are files, and some calls have parts"
    )
)]
fn dispatch(
    request: &Request<'_>,
    file: Vec<u8>,
    take: &mut dyn FnMut(Vec<u8>),
) -> Result<Value, Problem> {
    match request.text("call")? {
        #[cfg(feature = "explore")]
        "catalogue" => Ok(crate::catalogue::soils()),
        #[cfg(feature = "explore")]
        "wheel" => crate::wheel::solve(request),
        #[cfg(feature = "explore")]
        "slip_model" => crate::slip_model::solve(request),
        #[cfg(feature = "explore")]
        "curve" => crate::curve::solve(request),
        #[cfg(feature = "drive")]
        "examples" => Ok(crate::examples::scenarios()),
        #[cfg(feature = "optimize")]
        "problems" => Ok(crate::examples::problems()),
        #[cfg(feature = "optimize")]
        "optimize" => crate::optimize::solve(request, take),
        #[cfg(feature = "figure")]
        "figure" => crate::figure::solve(request),
        #[cfg(feature = "drive")]
        "drive" => crate::drive::solve(request),
        #[cfg(feature = "log")]
        "estimate" => crate::estimate::solve(request, file, take),
        #[cfg(feature = "log")]
        "suggest" => crate::estimate::suggest(request, file),
        other => Err(Problem::new(
            "call",
            format!("`{other}` is not a call of this module"),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_answered_is_an_error_and_no_panic() {
        for request in [
            "",
            "{}",
            "[1]",
            r#"{"call": 3}"#,
            r#"{"call": "fly"}"#,
            "nul\0",
        ] {
            assert!(answer(request).starts_with(r#"{"error":{"#), "{request}");
        }
        let deep = "[".repeat(100_000);
        assert!(answer(&deep).starts_with(r#"{"error":{"#));
    }
}
