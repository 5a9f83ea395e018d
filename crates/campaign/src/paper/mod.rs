//! Ani et al. (2012), J. Cent. South Univ. 19: what can be reproduced of it.

mod decisions;
mod figures;
mod file;
mod optima;
mod page;
mod problem;
mod robot_drawings;
mod sand_run;
mod solved;
mod statements;

use std::fmt::Write as _; // writing to a string cannot fail

use grouser_report::number::{rounded, shown};
use grouser_report::{Fields, Table, fields};
use grouser_rover::drive::Scenario;
use grouser_terra::{Kinematics, Settings, Slip, WheelOnSoil};

use crate::error::Result;
pub use file::{Content, PaperFile};
pub use optima::{SlipOptimum, setpoint_problem};
pub use page::{Block, Page};
pub use problem::{INTERPRETATIONS, Interpretation, PRINTED_SLIP, sinkage_ratio_of_slip};
pub use sand_run::{SandRun, SandWheel, SlipMoment, slip_as_worded};
pub use solved::SEED;
use solved::Solved;
pub use statements::{STATEMENTS, Statement, Verdict};

/// What can be reproduced of the paper: figures, their numbers, and a page about them.
pub struct Paper {
    files: Vec<PaperFile>,
    solved: Vec<Solved>,
    optima: Vec<SlipOptimum>,
    run: SandRun,
}

impl Paper {
    /// Computes everything. `run` is the estimate of the log of `scenario`.
    ///
    /// # Errors
    /// What the solves refuse.
    pub fn compute(scenario: &Scenario, run: SandRun) -> Result<Self> {
        let solved = solved::solve()?;
        let optima = optima::optima(scenario)?;
        let mut files = robot_drawings::files(&run.robot);
        files.extend(stress_figure(scenario, &optima)?);
        for figure in figures::all() {
            let (number, about) = (figure.number, figure.about);
            let name = format!("figure-{number}");
            files.push(PaperFile::text(
                format!("{name}.csv"),
                figure.csv(),
                format!("the numbers of figure {number}"),
            ));
            let about = format!("figure {number}: {about}");
            files.push(PaperFile::figure(name, figure.draw(), about));
        }
        let [ours, papers] = run.figures();
        files.extend([
            PaperFile::figure(
                "figure-11",
                decisions::figure(),
                "figure 11: from slip to decision",
            ),
            PaperFile::figure(
                "figure-13",
                ours,
                "figure 13, simulated: slip against time, estimated and true",
            ),
            PaperFile::figure(
                "figure-13-paper",
                papers,
                "the same in the paper's definition of slip",
            ),
            PaperFile::text("figure-13.csv", run.csv(), "the numbers of figure 13"),
            PaperFile::figure(
                "problem",
                solved::draw(&solved),
                "the optimisation problem: solutions with the curve of the printed slip, and by start",
            ),
            PaperFile::text(
                "problem.csv",
                solved::csv(&solved),
                "where every start of every reading ends",
            ),
            PaperFile::text(
                "slip-0.1146.csv",
                solved::curve_csv(),
                "the curve on which |S_0| is 0.1146",
            ),
        ]);
        for one in &solved {
            let name = one.reading.name;
            files.push(PaperFile::text(
                format!("problem-{}.toml", file_name(name)),
                one.reading.text(one.ends.len(), SEED),
                format!("the reading \"{name}\""),
            ));
        }
        let page = page(&solved, &optima, &run, &files);
        for (name, content) in [("paper.md", page.markdown()), ("paper.html", page.html())] {
            files.push(PaperFile::text(name, content, "this page"));
        }
        Ok(Self {
            files,
            solved,
            optima,
            run,
        })
    }

    /// Its files, the pages last.
    #[must_use]
    pub fn files(&self) -> &[PaperFile] {
        &self.files
    }

    /// The same for programs.
    #[must_use]
    pub fn fields<'a>() -> Fields<'a, &'a Self> {
        fields! { |paper: &'a Self|
            "files" "files that were written" =
                paper.files.iter().flat_map(PaperFile::names).collect::<Vec<_>>();
            "statements" "equations, tables and figures of the paper" rows(statement()) = STATEMENTS;
            "optima" "slips that are called optimal" rows(SlipOptimum::fields()) = &paper.optima;
            "sand_run" "the run on sand" group(SandRun::fields()) = &paper.run;
            "printed_slip" "optimum slip that the paper prints" = PRINTED_SLIP;
            "printed_slip_claimed" "whether it is reproduced" = false;
            "readings" "readings of the optimisation problem" rows(Solved::fields()) = &paper.solved;
        }
    }

    /// What a person reads first.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!(
            "{} items of the paper are reproduced, {} in part, {} not possible\n\n",
            count(Verdict::Reproduced),
            count(Verdict::InPart),
            count(Verdict::NotPossible)
        );
        let mut table = Table::new()
            .text("reading of the optimisation problem")
            .number("starts")
            .number("equally good")
            .text("|S_0| of those");
        for one in &self.solved {
            table.row([
                one.reading.name,
                &one.ends.len().to_string(),
                &one.equally_good().count().to_string(),
                &slips(one),
            ]);
        }
        text.push_str(&table.render());
        let _ = writeln!(
            text,
            "the printed optimum, |S_0| = {}, is not claimed: its bounds, start, scaling and utility are not printed",
            shown(PRINTED_SLIP)
        );
        text.push('\n');
        let mut table = Table::new()
            .text("optimal slip")
            .number("slip")
            .text("what it optimises");
        for optimum in &self.optima {
            let [name, slip, optimises, ..] = &optimum.row()[..] else {
                continue;
            };
            table.row([name.as_str(), slip, optimises]);
        }
        text.push_str(&table.render());
        text.push('\n');
        text.push_str(&self.run.text());
        text
    }
}

/// Figures 5 to 7: the stress under the scenario's typical wheel at its slip setpoint.
fn stress_figure(scenario: &Scenario, optima: &[SlipOptimum]) -> Result<Option<PaperFile>> {
    let setpoint = optima.get(1).and_then(|optimum| optimum.slip);
    let (Some((index, load)), Some(slip)) = (scenario.typical_wheel(), setpoint) else {
        return Ok(None);
    };
    let ground = &scenario.ground.soils[0];
    let wheel = scenario.robot.wheels[index].wheel;
    let pair = WheelOnSoil::new(wheel, ground.soil, Settings::default())?;
    let solved = pair.under_load(load, &Kinematics::straight(Slip::new(slip)?))?;
    let Some(point) = solved.point() else {
        return Ok(None);
    };
    let figure = crate::stress::draw(&pair, &point, &ground.name);
    let about = "figures 5 to 7: the stress under a wheel of the robot";
    Ok(Some(PaperFile::figure("figure-5", figure, about)))
}

fn file_name(words: &str) -> String {
    let mut name = String::new();
    for letter in words.chars() {
        match letter {
            'a'..='z' | 'A'..='Z' | '0'..='9' | '.' => name.push(letter.to_ascii_lowercase()),
            _ if !name.ends_with('-') => name.push('-'),
            _ => {}
        }
    }
    name.trim_matches('-').to_owned()
}

/// |S_0| of the solutions that are equally good, in words.
fn slips(solved: &Solved) -> String {
    let (low, high) = Solved::range(solved.equally_good());
    if high - low < 1e-4 {
        rounded(low, 4)
    } else {
        format!("{} to {}", rounded(low, 4), rounded(high, 4))
    }
}

fn readings(solved: &[Solved]) -> Vec<Vec<String>> {
    solved
        .iter()
        .map(|one| {
            vec![
                one.reading.name.to_owned(),
                one.reading.assumes.to_owned(),
                format!("{} of {}", one.solved().count(), one.ends.len()),
                one.equally_good().count().to_string(),
                slips(one),
            ]
        })
        .collect()
}

#[allow(clippy::too_many_lines, reason = "the page from its top to its end")]
fn page(solved: &[Solved], optima: &[SlipOptimum], run: &SandRun, written: &[PaperFile]) -> Page {
    let mut blocks = vec![
        Block::Text(
            "Ani, Xu, Xue, Liu & Zhang, \"Analytical modeling and multi-objective optimization of slippage for \
             wheeled mobile robot in rough terrain\", J. Cent. South Univ. 19 (2012) 2458-2467. This page was \
             computed; every number in it comes from the files next to it."
                .to_owned(),
        ),
        Block::Heading(2, "What is reproduced".to_owned()),
        Block::Table(
            vec!["item", "about", "verdict", "command", "how, or why not"],
            STATEMENTS
                .iter()
                .map(|s| {
                    let command = match s.command {
                        "" => "-".to_owned(),
                        command => format!("`{command}`"),
                    };
                    let [item, about, verdict, why] =
                        [s.item, s.about, s.verdict.key(), s.why].map(str::to_owned);
                    vec![item, about, verdict, command, why]
                })
                .collect(),
        ),
        Block::Heading(2, "Figures 1 to 3".to_owned()),
        Block::Text(
            "The paper's photographs print no numbers. These are drawn from the shipped robot file."
                .to_owned(),
        ),
        picture("figure-1", "Figure 1: the robot from its left side"),
        picture("figure-2", "Figure 2: the chassis from above"),
        picture("figure-3", "Figure 3: the fifth wheel, a powered and a free wheel on one arm"),
        Block::Heading(2, "Figures 5 to 7".to_owned()),
        picture(
            "figure-5",
            "Figures 5 to 7: a wheel of the robot in dry sand at its slip setpoint, with the stresses of the model",
        ),
        Block::Heading(2, "Figures 8 to 10".to_owned()),
        Block::Text(
            "S_0 is the slip at which the shear displacement returns to zero at the angle θ. It equals 1 − sec ξ with \
             an angle ξ between θ and θ_1, so it is never positive; the paper apparently prints magnitudes, and both \
             are drawn. It depends on θ and z/r alone. Lines are thin where θ lies outside the contact, |θ| > θ_1; a \
             circle marks θ = θ_1, where S_0 = −z/(r − z)."
                .to_owned(),
        ),
    ];
    for figure in figures::all() {
        blocks.push(picture(
            &format!("figure-{}", figure.number),
            &format!("Figure {}: {}", figure.number, figure.about),
        ));
    }
    blocks.extend([
        Block::Heading(2, "Figure 11".to_owned()),
        picture("figure-11", "Figure 11: from the slip of each wheel to the decision, tested from top to bottom"),
        Block::Heading(2, "Figure 13, simulated".to_owned()),
        Block::Text(run.about()),
        picture("figure-13", "Figure 13, simulated: slip of each powered wheel, estimated with its 90 % interval, and true"),
        picture("figure-13-paper", "The same in the definition of section 4.1 of the paper"),
        Block::Table(SandRun::HEADER.to_vec(), run.rows()),
        Block::Heading(2, "Four optimal slips".to_owned()),
        Block::Text(
            "Four slips are called optimal. They optimise different quantities; only the second is the setpoint of the \
             controller."
                .to_owned(),
        ),
        Block::Table(
            SlipOptimum::HEADER.to_vec(),
            optima.iter().map(SlipOptimum::row).collect(),
        ),
        Block::Heading(2, "The optimisation problem".to_owned()),
        Block::Text(format!(
            "The paper names nine variables, three objectives (P2, P7, P19), bounds and constraints, and prints an \
             optimum slip of {PRINTED_SLIP}. It does not print the bounds, the start, the scaling, the sense of each \
             objective or the utility that joins them. Below are five readings of it, each solved by minimax from \
             the same starts. The printed optimum is not claimed to be reproduced by any of them."
        )),
        Block::Table(
            vec![
                "reading",
                "assumes",
                "starts solved",
                "equally good",
                "|S_0| of those",
            ],
            readings(solved),
        ),
        picture(
            "problem",
            "Solutions of the five readings with the curve of the printed slip (a), and the slip that each start \
             ends at (b)",
        ),
        Block::Text(
            "In pascals the two stresses are ten thousand times the slip: they alone decide, and the slip is whatever \
             the start leaves it at. Where the strengths and the slip are brought to one scale, the answer follows the \
             scale. |S_0| = 0.1146 is a curve in (θ, z/r), from z/r = 0.3019 at θ = 0° to 0.1028 at θ = θ_1 = 26.2°; \
             a solution can lie anywhere on it, and no soil parameter moves it."
                .to_owned(),
        ),
        Block::Heading(2, "Files".to_owned()),
        Block::Files(
            written
                .iter()
                .flat_map(|file| file.names().into_iter().map(|name| (name, file.about.clone())))
                .collect(),
        ),
    ]);
    Page {
        title: "What can be reproduced of Ani et al. (2012)".to_owned(),
        blocks,
    }
}

fn picture(name: &str, about: &str) -> Block {
    Block::Picture(format!("{name}.svg"), about.to_owned())
}

fn count(verdict: Verdict) -> usize {
    STATEMENTS.iter().filter(|s| s.verdict == verdict).count()
}

fn statement<'a>() -> Fields<'a, &'a Statement> {
    fields! { |statement: &'a Statement|
        "item" "equation, table or figure" = statement.item;
        "about" "what it is about" = statement.about;
        "verdict" "reproduced, in part, or not possible" = statement.verdict.key();
        "command" "command that does it; empty where none can" = statement.command;
        "why" "why" = statement.why;
    }
}
