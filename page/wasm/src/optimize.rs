//! A problem file through the optimiser, as `grouser optimize` solves it.

use grouser_design::parse;
use grouser_files::Document;
use serde_json::Value;

use crate::request::{Problem, Request};

/// Solves the problem file in `problem`.
pub(crate) fn solve(request: &Request<'_>) -> Result<Value, Problem> {
    let document = Document::from_text("problem.toml", request.text("problem")?.to_owned())
        .map_err(Problem::of)?;
    let design = parse(&document).map_err(Problem::of)?;
    let answer = design.solve().map_err(Problem::of)?;
    grouser_page::answer::object(&design, &answer)
        .ok_or_else(|| Problem::of("the answer is of a kind that the page does not know"))
}
