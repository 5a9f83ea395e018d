//! `paper --end-to-end`: the paper's robot from its analytical model to its decisions, by the verbs of this command.

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::Path;

use grouser_campaign::paper::{Block, Page, SandRun, SandWheel, setpoint_problem};
use grouser_report::number::{rounded, shown};
use grouser_report::{Fields, Object, fields};
use serde_json::Value;

use super::run::{sand_run, scenario};
use super::steps::{Step, Steps};
use crate::error::{Result, shown as shown_path};
use crate::output::OutputFile;
use crate::report_file::ReportFile;
use crate::session::Session;
use crate::verb_report::Report;

/// The soil of the run.
const SOIL: &str = "dry-sand";
/// Commands in all.
const STEPS: usize = 6;
/// A patch that no wheel crosses: what the controller does alone.
const PATCH: &str = include_str!("../../../templates/soft-patch.toml");

/// What came of it.
struct EndToEnd<'a> {
    folder: &'a Path,
    steps: &'a [Step],
    optimum: &'a Object,
    run: &'a SandRun,
    drive: &'a Object,
    patch: &'a Object,
    soil: &'a Value,
}

pub(super) fn run(
    folder: &Path,
    report: Option<ReportFile>,
    session: &mut Session,
) -> Result<Report> {
    let mut steps = Steps::new(folder, STEPS);
    let described = scenario(&steps, None)?;
    let Some((index, load)) = described.typical_wheel() else {
        return Ok(Report::done(Object::new(), String::new()));
    };
    let wheel = described.robot.wheels[index].wheel;
    let size = format!(
        "--radius-m {:?} --width-m {:?}",
        wheel.radius(),
        wheel.width()
    );
    // 1: the analytical model, at the sinkage of the robot's wheel at the slip that the paper prints
    let load_n = rounded(load, 4);
    let line = format!("grouser wheel --soil {SOIL} {size} --load-n {load_n} --slip 0.1146");
    let sinkage = steps.run(&line, session)?.report.object["sinkage_m"].as_f64();
    let line = format!(
        "grouser paper slip-model --theta-deg 0:45 --sinkage-m {} --radius-m {:?} -o @model.csv -o @model.svg",
        rounded(sinkage.unwrap_or(f64::NAN), 4),
        wheel.radius()
    );
    steps.run(&line, session)?;
    // 2: the certified optimum
    let problem = setpoint_problem(&wheel, SOIL, load, None);
    crate::files_in_use::clear();
    OutputFile::create(&folder.join("optimum.toml"))?.write_whole(problem.as_bytes())?;
    let line = "grouser optimize @optimum.toml --certify --proof @optimum.jsonl -o @optimum.csv";
    let optimum = steps.run(line, session)?.report.object.clone();
    let setpoint = optimum["x"]["slip"].as_f64();
    // 3 and 4: the drive at that slip, and the estimate of its log
    let described = scenario(&steps, setpoint)?;
    let run = sand_run(&mut steps, &described, session)?;
    // 5: what the controller does alone
    crate::files_in_use::clear();
    OutputFile::create(&folder.join("soft-patch.toml"))?.write_whole(PATCH.as_bytes())?;
    let line = "grouser drive @soft-patch.toml --compare open-loop,controller --sweep 5 --report @soft-patch.html";
    let patch = steps.run(line, session)?.report.object.clone();

    let drive = &steps.done[3].report.object;
    let soil = &steps.done[4].report.object["soil"];
    let whole = EndToEnd {
        folder,
        steps: &steps.done,
        optimum: &optimum,
        run: &run,
        drive,
        patch: &patch,
        soil,
    };
    crate::files_in_use::clear();
    let page = whole.page()?.html();
    let mut text = whole.text();
    for (name, table) in whole.tables() {
        OutputFile::create(&folder.join(name))?.write_whole(table.as_bytes())?;
    }
    OutputFile::create(&folder.join("end-to-end.html"))?.write_whole(page.as_bytes())?;
    if let Some(report) = report {
        text.push_str(&report.write_page(&page)?);
    }
    let _ = writeln!(
        text,
        "wrote {}; begin with end-to-end.html",
        shown_path(folder)
    );
    Ok(Report {
        outcome: steps.outcome(),
        warnings: steps.warnings(),
        ..Report::done(fields().object(&whole), text)
    })
}

impl EndToEnd<'_> {
    fn certificate(&self) -> &Value {
        &self.optimum["certificate"]
    }

    fn controller(&self) -> Option<&Value> {
        let runs = self.drive["runs"].as_array()?;
        runs.iter().find(|run| run["controller"] == "controller")
    }

    fn decisions(&self) -> &[Value] {
        let decisions = self
            .controller()
            .and_then(|run| run["decisions"].as_array());
        decisions.map_or(&[], Vec::as_slice)
    }

    /// The decision as figure 11 counts them: how often each action was taken, and why.
    fn actions(&self) -> Vec<(String, String, usize)> {
        let patch = self.patch["runs"].as_array().into_iter().flatten();
        let of_patch = patch
            .filter(|run| run["controller"] == "controller")
            .filter_map(|run| run["decisions"].as_array())
            .flatten();
        let mut actions: Vec<(String, String, usize)> = Vec::new();
        for decision in self.decisions().iter().chain(of_patch) {
            let [action, reason] =
                ["action", "reason"].map(|key| decision[key].as_str().unwrap_or_default());
            match actions
                .iter_mut()
                .find(|one| one.0 == action && one.1 == reason)
            {
                Some(one) => one.2 += 1,
                None => actions.push((action.to_owned(), reason.to_owned(), 1)),
            }
        }
        actions
    }

    fn text(&self) -> String {
        let number = |value: &Value| value.as_f64().map_or_else(|| "-".to_owned(), shown);
        let comparison = |object: &Object| {
            let of = &object["comparison"];
            format!(
                "controller arrives in {} of {}, open loop in {}; energy per metre over open loop: {}",
                of["controller_arrives"],
                of["seeds"],
                of["open_loop_arrives"],
                of["energy_gain"].as_str().unwrap_or("not comparable")
            )
        };
        let mut text = format!(
            "slip setpoint {} (certified: {}), slips of {} powered wheels estimated\n",
            number(&self.optimum["x"]["slip"]),
            self.certificate()["status"].as_str().unwrap_or("no"),
            self.run.wheels.len()
        );
        let _ = writeln!(text, "run on sand: {}", comparison(self.drive));
        let _ = writeln!(text, "soft patch: {}\n", comparison(self.patch));
        text.push_str(&self.run.text());
        let _ = writeln!(
            text,
            "\nsoil learnt: strength {} [{}, {}] and stiffness {} [{}, {}] times the known soil's",
            number(&self.soil["strength"]),
            number(&self.soil["strength_low"]),
            number(&self.soil["strength_high"]),
            number(&self.soil["stiffness"]),
            number(&self.soil["stiffness_low"]),
            number(&self.soil["stiffness_high"])
        );
        for step in self.steps {
            let _ = writeln!(text, "  {}", step.line);
        }
        text
    }

    /// The tables of the page that no command has written.
    fn tables(&self) -> [(&'static str, String); 3] {
        let mut decisions = String::from("time_s,action,reason,wheel,value,limit\n");
        for decision in self.decisions() {
            let cell = |key: &str| match &decision[key] {
                Value::Null => String::new(),
                Value::String(text) => text.clone(),
                other => other.to_string(),
            };
            let cells = ["time_s", "action", "reason", "wheel", "value", "limit"].map(cell);
            let _ = writeln!(decisions, "{}", cells.join(","));
        }
        let mut soil = String::from("quantity,value\n");
        for (key, value) in self.soil.as_object().into_iter().flatten() {
            let _ = writeln!(soil, "{key},{value}");
        }
        [
            ("figure-13.csv", self.run.csv()),
            ("decisions.csv", decisions),
            ("soil.csv", soil),
        ]
    }

    #[allow(clippy::too_many_lines, reason = "the page from its top to its end")]
    fn page(&self) -> Result<Page> {
        let drawing = |name: &str, about: &str| -> Result<Block> {
            let path = self.folder.join(name);
            let svg = std::fs::read_to_string(&path)
                .map_err(|error| crate::error::Error::file("read", &path, &error))?;
            Ok(Block::Drawing(svg, about.to_owned()))
        };
        let heading = |words: &str| Block::Heading(2, words.to_owned());
        let command = |index: usize| {
            let step = &self.steps[index];
            Block::Output(format!("$ {}\n\n{}", step.line, step.report.text))
        };
        let certificate = self.certificate();
        let value = |value: &Value| value.as_f64().map_or_else(|| "-".to_owned(), shown);
        let [ours, papers] = self.run.figures().map(|figure| figure.svg());
        let actions = self.actions().into_iter();
        let rows = actions.map(|(action, reason, count)| vec![action, reason, count.to_string()]);
        let files = |names: &[(&str, &str)]| {
            let files = names
                .iter()
                .map(|(name, about)| ((*name).to_owned(), (*about).to_owned()));
            Block::Files(files.collect())
        };
        Ok(Page {
            title: "The robot of Ani et al. (2012), end to end".to_owned(),
            blocks: vec![
                Block::Text(
                    "Six commands take the five-wheeled robot from the analytical model to its decisions. Each is run in \
                     this folder, and prints the same when it is run again. The robot is simulated: the paper's data are \
                     not published."
                        .to_owned(),
                ),
                Block::Output(self.text()),
                heading("1 Analytical model"),
                Block::Text(
                    "The paper's S_0 for the robot's wheel, at the sinkage that its load gives at the slip that the paper \
                     prints. S_0 depends on the angle and on sinkage over radius alone."
                        .to_owned(),
                ),
                drawing("model.svg", "S_0 of the robot's wheel against the angle on the wheel")?,
                command(0),
                heading("2 Certified optimum"),
                Block::Text(format!(
                    "The slip setpoint is the slip of maximum tractive efficiency. Interval arithmetic proves that no \
                     other slip is better by more than {}.",
                    value(&certificate["gap"])
                )),
                command(2),
                heading("3 Drive on sand"),
                command(3),
                heading("4 Slip of the five powered wheels, from the log"),
                Block::Text(
                    "The free wheel's encoder reports the time of each pulse. Every row of the estimate is drawn, with \
                     its 90 % interval."
                        .to_owned(),
                ),
                Block::Drawing(ours, "Figure 13: slip, estimated and true".to_owned()),
                Block::Drawing(papers, "The same in the definition of section 4.1 of the paper".to_owned()),
                command(4),
                heading("5 Soil learnt"),
                Block::Text(
                    "The known soil is the dry sand of the catalogue; the ground scatters about it by 5 % and is compacted \
                     by wheels, so strength and stiffness near 1 are right."
                        .to_owned(),
                ),
                Block::Table(
                    vec!["quantity", "value", "90 % interval"],
                    ["strength", "stiffness", "phi"]
                        .map(|name| {
                            let of = |end: &str| {
                                let unit = if name == "phi" { "_deg" } else { "" };
                                value(&self.soil[format!("{name}{end}{unit}").as_str()])
                            };
                            let shown = if name == "phi" { "friction angle (°)" } else { name };
                            vec![shown.to_owned(), of(""), format!("{} to {}", of("_low"), of("_high"))]
                        })
                        .into(),
                ),
                heading("6 Decisions"),
                Block::Text(
                    "What the controller decides, in the run on sand and on a soft patch that no wheel crosses. On the \
                     patch open loop digs in; the controller goes round."
                        .to_owned(),
                ),
                Block::Table(vec!["action", "reason", "how often"], rows.collect()),
                command(5),
                heading("Files"),
                files(&[
                    ("drive.html", "the drive, to play"),
                    ("estimate.html", "the estimate of its log, to explore"),
                    ("soft-patch.html", "the soft patch, to play"),
                    ("drive.mcap", "the log"),
                    ("slip.csv", "slips of `estimate`"),
                    ("figure-13.csv", "figure 13 in both definitions, with the true slips"),
                    ("decisions.csv", "decisions of the controller"),
                    ("soil.csv", "soil learnt"),
                    ("model.csv", "the analytical model"),
                    ("optimum.jsonl", "the proof of the optimum, which `checker/check.py` replays"),
                ]),
            ],
        })
    }
}

fn fields<'a>() -> Fields<'a, &'a EndToEnd<'a>> {
    let step = fields! { |step: &'a Step|
        "command" "command, in the folder" = step.line.as_str();
        "exit_code" "its exit code" = step.report.outcome.exit_code();
    };
    fields! { |whole: &'a EndToEnd<'a>|
        "folder" "the folder" = whole.folder.display().to_string();
        "steps" "commands that were run" rows(step) = whole.steps.iter();
        "slip_setpoint" "certified slip of maximum tractive efficiency" = whole.optimum["x"]["slip"].as_f64();
        "certificate" "how the proof of the setpoint ended" = whole.certificate()["status"].as_str();
        "certificate_gap" "no slip is better by more than this, in tractive efficiency" = whole.certificate()["gap"].as_f64();
        "wheels" "powered wheels" rows(SandWheel::fields()) = &whole.run.wheels;
        "soil_learnt" "soil learnt, as of `estimate`" values = whole.soil.as_object().cloned();
        "run_on_sand" "controller and open loop on sand, as of `drive`" values = whole.drive["comparison"].as_object().cloned();
        "soft_patch" "the same on soft patches" values = whole.patch["comparison"].as_object().cloned();
        "decisions" "decisions in the run on sand" = whole.decisions().len();
    }
}

/// The JSON schema.
pub(super) fn schema() -> Value {
    fields().schema()
}
