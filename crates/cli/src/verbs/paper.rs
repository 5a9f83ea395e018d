//! `paper`: a folder with what can be reproduced of the source paper, and what cannot, said plainly.

use std::fmt::Write as _; // writing to a string cannot fail
use std::fs;
use std::path::{Path, PathBuf};

use grouser_campaign::paper::PRINTED_SLIP;
use serde_json::Value;

use super::paper_figures;
use super::paper_page::{Block, Page};
use super::paper_problem::{self, Solved};
use super::paper_run::SandRun;
use crate::error::{Error, Result, shown as shown_path};
use crate::output::OutputFile;
use crate::report::{Object, Report};
use crate::session::Session;
use grouser_campaign::paper::{STATEMENTS, Verdict};
use grouser_report::Table;
use grouser_report::number::{rounded, shown};

#[derive(clap::Args, Debug)]
#[command(
    about = "Write what can be reproduced of Ani et al. (2012), and what cannot",
    long_about = "Write a folder with figures 8, 9 and 10 of Ani et al. (2012) and their numbers, its figure \
        13 of a simulated run on sand, the paper's optimisation problem under several readings, and a page that says \
        of each equation, table and figure whether it is reproduced, reproduced in part, or not possible and why. The \
        printed optimum slip of 0.1146 is not claimed.",
    after_help = "Example:\n  grouser paper -o paper"
)]
pub(crate) struct Arguments {
    /// The folder; it is made if it does not exist
    #[arg(short, long, value_name = "DIR", default_value = "paper")]
    output: PathBuf,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let folder = &arguments.output;
    fs::create_dir_all(folder).map_err(|error| Error::file("make", folder, &error))?;
    session.used_seed(paper_problem::SEED);
    let mut files = Files {
        folder,
        written: Vec::new(),
    };
    for figure in paper_figures::all() {
        let name = format!("figure-{}", figure.number);
        let about = format!("figure {}: {}", figure.number, figure.about);
        files.write(&format!("{name}.svg"), &figure.draw().svg(), &about)?;
        files.write(
            &format!("{name}.csv"),
            &figure.csv(),
            &format!("the numbers of figure {}", figure.number),
        )?;
    }
    let run = SandRun::drive()?;
    files.write(
        "figure-13.svg",
        &run.draw().svg(),
        "figure 13, simulated: slip against time by the fifth wheel beside the truth",
    )?;
    files.write("figure-13.csv", &run.csv(), "the numbers of figure 13")?;
    let solved = paper_problem::solve()?;
    for (name, content, about) in [
        (
            "problem.svg",
            paper_problem::draw(&solved).svg(),
            "the optimisation problem: solutions beside the curve of the printed slip, and by start",
        ),
        (
            "problem.csv",
            paper_problem::csv(&solved),
            "where every start of every reading ends",
        ),
        (
            "slip-0.1146.csv",
            paper_problem::curve_csv(),
            "the curve on which |S_0| is 0.1146",
        ),
    ] {
        files.write(name, &content, about)?;
    }
    for one in &solved {
        let name = format!("problem-{}.toml", file_name(one.reading.name));
        let text = one.reading.text(one.ends.len(), paper_problem::SEED);
        files.write(
            &name,
            &text,
            &format!("the reading \"{}\"", one.reading.name),
        )?;
    }
    let page = page(&solved, &run, &files.written);
    files.write("paper.md", &page.markdown(), "this page")?;
    files.write("paper.html", &page.html(), "this page")?;
    Ok(Report::done(
        object(folder, &files.written, &solved, &run),
        text(folder, &files.written, &solved, &run),
    ))
}

struct Files<'f> {
    folder: &'f Path,
    /// Name and content in words.
    written: Vec<(String, String)>,
}

impl Files<'_> {
    fn write(&mut self, name: &str, content: &str, about: &str) -> Result<()> {
        OutputFile::create(&self.folder.join(name))?.write_whole(content.as_bytes())?;
        self.written.push((name.to_owned(), about.to_owned()));
        Ok(())
    }
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

fn page(solved: &[Solved], run: &SandRun, written: &[(String, String)]) -> Page {
    let mut blocks = vec![
        Block::Text(
            "Ani, Xu, Xue, Liu & Zhang, \"Analytical modeling and multi-objective optimization of slippage for \
             wheeled mobile robot in rough terrain\", J. Cent. South Univ. 19 (2012) 2458-2467. This page was \
             computed; every number in it comes from the files beside it."
                .to_owned(),
        ),
        Block::Heading(2, "What is reproduced".to_owned()),
        Block::Table(
            vec!["item", "about", "verdict", "how, or why not"],
            STATEMENTS
                .iter()
                .map(|s| {
                    [s.item, s.about, s.verdict.key(), s.why]
                        .map(str::to_owned)
                        .into()
                })
                .collect(),
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
    for figure in paper_figures::all() {
        blocks.push(Block::Picture(
            format!("figure-{}.svg", figure.number),
            format!("Figure {}: {}", figure.number, figure.about),
        ));
    }
    blocks.extend([
        Block::Heading(2, "Figure 13, simulated".to_owned()),
        Block::Text(run.about()),
        Block::Picture(
            "figure-13.svg".to_owned(),
            "Figure 13, simulated: slip of a powered wheel by the fifth wheel beside the truth (a), and where it brakes \
             (b)"
                .to_owned(),
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
        Block::Picture(
            "problem.svg".to_owned(),
            "Solutions of the five readings beside the curve of the printed slip (a), and the slip that each start \
             ends at (b)"
                .to_owned(),
        ),
        Block::Text(
            "In pascals the two stresses are ten thousand times the slip: they alone decide, and the slip is whatever \
             the start leaves it at. Where the strengths and the slip are brought to one scale, the answer follows the \
             scale. |S_0| = 0.1146 is a curve in (θ, z/r), from z/r = 0.3019 at θ = 0° to 0.1028 at θ = θ_1 = 26.2°; \
             a solution can lie anywhere on it, and no soil parameter moves it."
                .to_owned(),
        ),
        Block::Heading(2, "Files".to_owned()),
        Block::Files(written.to_vec()),
    ]);
    Page {
        title: "What can be reproduced of Ani et al. (2012)".to_owned(),
        blocks,
    }
}

fn count(verdict: Verdict) -> usize {
    STATEMENTS.iter().filter(|s| s.verdict == verdict).count()
}

fn object(folder: &Path, written: &[(String, String)], solved: &[Solved], run: &SandRun) -> Object {
    let statements = STATEMENTS.iter().map(|s| {
        Value::from(Object::from_iter([
            ("item".to_owned(), Value::from(s.item)),
            ("about".to_owned(), Value::from(s.about)),
            ("verdict".to_owned(), Value::from(s.verdict.key())),
            ("why".to_owned(), Value::from(s.why)),
        ]))
    });
    Object::from_iter([
        (
            "folder".to_owned(),
            Value::from(folder.display().to_string()),
        ),
        (
            "files".to_owned(),
            written.iter().map(|(name, _)| name.as_str()).collect(),
        ),
        ("statements".to_owned(), statements.collect()),
        ("sand_run".to_owned(), Value::Object(run.object())),
        ("printed_slip".to_owned(), Value::from(PRINTED_SLIP)),
        ("printed_slip_claimed".to_owned(), Value::from(false)),
        (
            "readings".to_owned(),
            solved.iter().map(|s| Value::Object(s.object())).collect(),
        ),
    ])
}

fn text(folder: &Path, written: &[(String, String)], solved: &[Solved], run: &SandRun) -> String {
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
    for one in solved {
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
    let _ = writeln!(
        text,
        "figure 13, simulated: slip by the fifth wheel is within {} (RMS) of the true one",
        run.error()
            .map_or_else(|| "—".to_owned(), |error| rounded(error, 3))
    );
    let _ = writeln!(
        text,
        "wrote {} files into {}; begin with paper.html",
        written.len(),
        shown_path(folder)
    );
    text
}
