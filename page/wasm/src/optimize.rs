//! A problem file through the optimiser, as `grouser optimize` solves it.

use std::ops::ControlFlow;

use grouser_design::parse;
use grouser_files::Document;
use grouser_opt::Stage;
use serde_json::{Value, json};

use crate::request::{Problem, Request};

/// Solves the problem file in `problem`. `take` receives how far it is: an object with `stage`, and `done` `of` all of it.
pub(crate) fn solve(
    request: &Request<'_>,
    take: &mut dyn FnMut(Vec<u8>),
) -> Result<Value, Problem> {
    let document = Document::from_text("problem.toml", request.text("problem")?.to_owned())
        .map_err(Problem::from_error)?;
    let design = parse(&document).map_err(Problem::from_error)?;
    let mut reported = None;
    let callback = &mut |progress: &grouser_opt::Progress<'_>| {
        let now = match progress.stage {
            Stage::Starts { done, of } => ("starts", done, Some(of)),
            Stage::Generations { done, of } => ("generations", done, Some(of)),
            Stage::Polishing { done, of } => ("points made exact", done, Some(of)),
            _ => ("iterations", progress.iteration, None),
        };
        if reported != Some(now) {
            reported = Some(now);
            let (stage, done, of) = now;
            let part = json!({ "stage": stage, "done": done, "of": of });
            take(part.to_string().into_bytes());
        }
        ControlFlow::Continue(())
    };
    let answer = design.solve_with(callback).map_err(Problem::from_error)?;
    grouser_page::answer::object(&design, &answer)
        .ok_or_else(|| Problem::from_error("the answer is of a kind that the page does not know"))
}
