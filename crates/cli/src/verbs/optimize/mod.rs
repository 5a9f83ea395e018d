//! `optimize`: the best compromise of a problem file, or its whole front.

mod certificate;
mod csv;
mod figure;
mod object;
mod text;

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::PathBuf;

use grouser_design::{Answer, Design, Optimum, Trade, parse};
use grouser_files::Document;
use grouser_opt::{Limit, Stage, Status};
use grouser_terra::Caution;

use self::certificate::Certification;
use self::object::Solved;
use crate::error::Result;
use crate::exit::Outcome;
use crate::interrupt::Search;
use crate::output_choice::Output;
use crate::progress::Progress;
use crate::report_file::ReportFlag;
use crate::session::Session;
use crate::verb_report::{Medium, Report};
use grouser_report::Object;
use grouser_report::number::{in_message, shown};

#[derive(clap::Args, Debug)]
#[command(
    about = "Solve a problem file: minimax, goal attainment, utility or Pareto",
    long_about = "Solve a problem file: minimax, goal attainment, a weighted or Chebyshev utility, or the Pareto \
        front.\n\nThe file names variables, objectives and constraints; both are formulas over the variables and over \
        quantities of a wheel on soil, such as drawbar_pull_n or slip_demand. Derivatives are exact. The answer \
        comes with what holds it there: the multipliers of objectives and constraints.",
    after_help = "Examples:\n  grouser optimize examples/problems/dry-sand-wheel.toml\n  \
        grouser optimize examples/problems/paper.toml --json\n  \
        grouser optimize examples/problems/paper.toml --certify 1e-6 --proof proof.jsonl\n  \
        grouser optimize examples/problems/pull-against-torque.toml -o front.csv -o front.svg\n  \
        grouser optimize examples/problems/lug-height.toml --certify 0.2"
)]
pub(crate) struct Arguments {
    /// The problem file
    #[arg(value_name = "PROBLEM.toml")]
    problem: PathBuf,
    /// Write a table (.csv: the front, or every start) or a figure (.svg, .png); may be given again
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    #[command(flatten)]
    report: ReportFlag,
    #[command(flatten)]
    certification: Certification,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let document = Document::read(&arguments.problem)?;
    session.used_document(&document);
    let design = parse(&document)?;
    let outputs = Output::begin(&arguments.output)?;
    let report = arguments.report.begin()?;
    if design.draws() {
        session.used_seed(design.seed);
    }
    if let Some(key) = &design.soil {
        session.used_catalogue_soil(key);
    }
    let search = Search::begin();
    let mut stage = ShownStage::default();
    let mut answer = design.solve_with(&mut |progress| {
        stage.reach(progress);
        if search.is_interrupted() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })?;
    drop(stage);
    let is_search_interrupted = search.is_interrupted();
    drop(search);
    let mut certified = if is_search_interrupted {
        None
    } else {
        arguments
            .certification
            .run(&design, document.text(), &answer)?
    };
    if let Some(better) = certified.as_mut().and_then(|c| c.better.take()) {
        answer = better;
    }
    let is_proved = certified
        .as_ref()
        .is_some_and(|certified| certified.proves(&design, &answer));
    let failure = match &answer {
        Answer::Optimum(optimum) if optimum.status == Status::Stopped || is_proved => None,
        Answer::Optimum(optimum) => complaint(&design, optimum),
        Answer::Trade(trade) => no_front(trade),
        _ => None,
    };
    let mut text = text::text(&design, &answer);
    if let Some(certified) = &certified {
        text.push_str(&certified.text(&design));
    }
    text.push_str(&Output::write_all(
        outputs,
        || csv::csv(&design, &answer),
        || {
            let front = certified.as_ref().and_then(certificate::Certified::front);
            Ok(figure::draw(&design, &answer, front))
        },
    )?);
    if let (Some(file), Some(shown)) = (report, grouser_page::answer::object(&design, &answer)) {
        let shown = Object::from_iter([
            ("answer".to_owned(), shown),
            ("problem".to_owned(), document.text().into()),
            (
                "proof".to_owned(),
                certified.as_ref().map(|one| one.text(&design)).into(),
            ),
        ]);
        let title = design.title.as_deref().unwrap_or("Answer");
        text.push_str(&file.write(title, shown, session)?);
    }
    let mut warnings = match &answer {
        Answer::Optimum(optimum) => warnings(optimum),
        _ => Vec::new(),
    };
    warnings.extend(cautions(&design, &answer));
    warnings.extend(certified.as_ref().and_then(certificate::Certified::caution));
    if is_search_interrupted {
        warnings
            .push("interrupted: this is the best that was found so far, not an optimum".to_owned());
    }
    let is_interrupted = is_search_interrupted
        || certified
            .as_ref()
            .is_some_and(certificate::Certified::is_interrupted);
    let doubt = certified.as_ref().and_then(certificate::Certified::doubt);
    warnings.extend(doubt.clone());
    Ok(Report {
        outcome: match (&failure, &doubt) {
            _ if is_interrupted => Outcome::Interrupted,
            (Some(_), _) => Outcome::NoResult,
            (None, Some(_)) => Outcome::Doubtful,
            (None, None) => Outcome::Done,
        },
        object: object::fields().object(Solved {
            design: &design,
            answer: &answer,
            certified: certified.as_ref(),
        }),
        text,
        medium: Medium::Text,
        failure,
        warnings,
    })
}

/// How far a search is, as a bar for each stage that has an end.
#[derive(Default)]
struct ShownStage(Option<(&'static str, Progress)>);

impl ShownStage {
    fn reach(&mut self, progress: &grouser_opt::Progress<'_>) {
        let (name, done, of) = match progress.stage {
            Stage::Starts { done, of } => ("starts", done, of),
            Stage::Generations { done, of } => ("generations", done, of),
            Stage::Polishing { done, of } => ("points refined", done, of),
            _ => return,
        };
        if self.0.as_ref().is_none_or(|(shown, _)| *shown != name) {
            self.0 = None; // the bar before ends first
            self.0 = Some((name, Progress::of_items(of as u64, name)));
        }
        if let Some((_, bar)) = &self.0 {
            bar.reach(done as u64);
        }
    }
}

/// Why there is no solution; `None` where there is one.
fn complaint(design: &Design, optimum: &Optimum) -> Option<String> {
    match &optimum.status {
        status if status.is_solved() => None,
        Status::NoFeasiblePoint(violations) => {
            let list: Vec<String> = violations
                .iter()
                .map(|v| format!("`{}` by {}", v.name, shown(v.amount)))
                .collect();
            Some(format!(
                "no point meets all constraints; the closest one found violates {}",
                list.join(", ")
            ))
        }
        Status::NotFinite { function, reason } => Some(match reason {
            Some(reason) => format!("`{function}` has no value where the search must go: {reason}"),
            None => {
                format!("`{function}` or its derivative is not finite where the search must go")
            }
        }),
        Status::Limit(Limit::Iterations) => Some(format!(
            "no convergence within {} iterations (`max_iterations` in [settings])",
            in_message(design.settings.max_iterations as f64)
        )),
        Status::Limit(_) => Some(format!(
            "no convergence within {} evaluations (`max_values` in [settings])",
            in_message(design.settings.max_values as f64)
        )),
        Status::Unbounded => {
            Some("the objective falls without limit; a bound or a constraint is missing".to_owned())
        }
        Status::Stalled => Some(
            "no step improves on the point, which is not known to be an optimum: a function has a kink there"
                .to_owned(),
        ),
        _ => Some("the solve was stopped".to_owned()),
    }
}

fn no_front(trade: &Trade) -> Option<String> {
    trade.points.is_empty().then(|| {
        format!(
            "no point that meets all constraints was found; the nearest violates them by {}",
            shown(trade.violation)
        )
    })
}

fn warnings(optimum: &Optimum) -> Vec<String> {
    let mut list = Vec::new();
    if optimum.is_ambiguous {
        list.push("several different points are equally good: the answer is not unique".to_owned());
    }
    let unsolved = optimum
        .starts
        .iter()
        .filter(|start| !start.status.is_solved())
        .count();
    if unsolved > 0 && optimum.starts.len() > 1 {
        list.push(format!(
            "{unsolved} of {} starts led to no solution",
            optimum.starts.len()
        ));
    }
    list
}

/// What to keep in mind about the wheels that were found.
fn cautions(design: &Design, answer: &Answer) -> Vec<String> {
    let points: Vec<&[f64]> = match answer {
        Answer::Trade(trade) => trade.points.iter().map(|point| &point.x[..]).collect(),
        Answer::Optimum(optimum) => vec![&optimum.x],
        _ => Vec::new(),
    };
    let mut counts = BTreeMap::<Caution, usize>::new();
    for caution in points.iter().flat_map(|x| design.cautions(x).iter()) {
        *counts.entry(caution).or_default() += 1;
    }
    let said = |(caution, count)| match answer {
        Answer::Trade(_) => format!("caution at {count} of {} points: {caution}", points.len()),
        _ => format!("caution: {caution}"),
    };
    counts.into_iter().map(said).collect()
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    object::fields().schema()
}
