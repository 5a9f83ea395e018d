//! The verbs: one folder each, or one file where that is enough.
//!
//! To add one: its file or folder with `Arguments` (clap) and `run`, and three lines here.

mod batch;
mod climb;
mod design;
mod drive;
mod estimate;
mod fmu;
mod help;
mod identify;
mod init;
mod live;
mod log;
mod map;
mod optimize;
mod paper;
mod plan;
mod robot;
mod soils;
mod validate;
mod view;
mod wheel;

use serde_json::Value;

use crate::error::Result;
use crate::session::{self, Session};
use crate::thread_pool;
use crate::verb_report::Report;

/// Verbs of before, and what does their job now.
pub(crate) const FORMER: [(&str, &str); 3] = [
    ("curve", "wheel --slip FROM:TO"),
    ("slip-model", "paper slip-model"),
    ("completions", "help --completions SHELL"),
];

/// What the command can do.
#[derive(clap::Subcommand, Debug)]
pub(crate) enum Verb {
    Soils(soils::Arguments),
    Wheel(wheel::Arguments),
    Batch(batch::Arguments),
    Climb(climb::Arguments),
    Fmu(fmu::Arguments),
    Estimate(estimate::Arguments),
    Drive(drive::Arguments),
    Map(map::Arguments),
    Plan(plan::Arguments),
    Optimize(optimize::Arguments),
    Design(design::Arguments),
    Paper(paper::Arguments),
    Robot(robot::Arguments),
    Identify(identify::Arguments),
    Validate(validate::Arguments),
    Log(log::Arguments),
    Live(live::Arguments),
    View(view::Arguments),
    Init(init::Arguments),
    Help(help::Arguments),
}

impl Verb {
    /// May it compute in loops over all processors?
    fn has_loops(&self) -> bool {
        match self {
            Self::Wheel(arguments) => arguments.is_range(),
            Self::Climb(_)
            | Self::Estimate(_)
            | Self::Drive(_)
            | Self::Map(_)
            | Self::Plan(_)
            | Self::Optimize(_)
            | Self::Paper(_)
            | Self::Identify(_)
            | Self::Validate(_) => true,
            Self::Soils(_)
            | Self::Batch(_)
            | Self::Fmu(_)
            | Self::Design(_)
            | Self::Robot(_)
            | Self::Log(_)
            | Self::Live(_)
            | Self::View(_)
            | Self::Init(_)
            | Self::Help(_) => false,
        }
    }
}

/// Runs the verb; `command` is the whole command line, for those that explain it.
pub(crate) fn run(verb: Verb, command: clap::Command, session: &mut Session) -> Result<Report> {
    if verb.has_loops() {
        thread_pool::start();
    }
    match verb {
        Verb::Soils(arguments) => soils::run(&arguments, session),
        Verb::Wheel(arguments) => wheel::run(&arguments, session),
        Verb::Batch(arguments) => batch::run(&arguments, session),
        Verb::Climb(arguments) => climb::run(&arguments, session),
        Verb::Fmu(arguments) => fmu::run(&arguments, session),
        Verb::Estimate(arguments) => estimate::run(&arguments, session),
        Verb::Drive(arguments) => drive::run(&arguments, session),
        Verb::Map(arguments) => map::run(&arguments, session),
        Verb::Plan(arguments) => plan::run(&arguments, session),
        Verb::Optimize(arguments) => optimize::run(&arguments, session),
        Verb::Design(arguments) => design::run(&arguments, session),
        Verb::Paper(arguments) => paper::run(&arguments, session),
        Verb::Robot(arguments) => robot::run(&arguments, session),
        Verb::Identify(arguments) => identify::run(&arguments, session),
        Verb::Validate(arguments) => validate::run(&arguments, session),
        Verb::Log(arguments) => log::run(&arguments, session),
        Verb::Live(arguments) => live::run(&arguments),
        Verb::View(arguments) => view::run(&arguments),
        Verb::Init(arguments) => init::run(&arguments),
        Verb::Help(arguments) => help::run(&arguments, command, &schemas()),
    }
}

/// The JSON schema of what each verb prints under `--json`.
fn schemas() -> Vec<(&'static str, Value)> {
    let mut list = vec![
        ("soils", soils::schema()),
        ("wheel", wheel::schema()),
        ("batch", batch::schema()),
        ("climb", climb::schema()),
        ("fmu", fmu::schema()),
        ("estimate", estimate::schema()),
        ("drive", drive::schema()),
        ("map", map::schema()),
        ("plan", plan::schema()),
        ("optimize", optimize::schema()),
        ("design", design::schema()),
        ("robot", robot::schema()),
        ("identify", identify::schema()),
        ("validate", validate::schema()),
        ("view", view::schema()),
        ("init", init::schema()),
    ];
    list.extend(log::schemas());
    list.extend(paper::schemas());
    for (name, schema) in &mut list {
        // an index would put a null where there is none
        let several = schema.get_mut("anyOf").and_then(Value::as_array_mut);
        match several {
            Some(several) => several.iter_mut().for_each(add_provenance),
            None => add_provenance(schema),
        }
        schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
        schema["title"] = format!("grouser {name} --json").into();
    }
    list
}

/// Each object says what it was computed from.
fn add_provenance(schema: &mut Value) {
    schema["properties"]["provenance"] = session::fields().schema();
    if let Some(required) = schema.get_mut("required").and_then(Value::as_array_mut) {
        required.push("provenance".into());
    }
}
