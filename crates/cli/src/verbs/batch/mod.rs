//! `batch`: a table of operating points.

mod columns;
mod lanes;
mod sink;
mod stream;

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use grouser_terra::{
    Angle, BatchKernel, Kinematics, RigidWheel, Settings, Slip, Soil, WheelOnSoil,
};
use rayon::prelude::*;

use self::columns::{Columns, Row};
use self::sink::TableSink;
use crate::error::{Error, Result, shown};
use crate::exit::Outcome;
use crate::input::{Input, STANDARD};
use crate::law_error::Names;
use crate::lines::{Line, Lines};
use crate::operation::{self, Answer, Status};
use crate::progress::Progress;
use crate::session::Session;
use crate::soil_choice::{self, Overrides};
use crate::verb_report::Report;
use crate::wheel_choice::lugs;
use grouser_report::number::exact;
use grouser_report::{Fields, fields};

/// Soils kept at a time: a table may name any number of files.
const SOILS: usize = 256;

#[derive(clap::Args, Debug)]
#[command(
    about = "Solve a table of operating points",
    long_about = "Solve a table of operating points, one per line of a CSV file with commas.\n\n\
        Columns: soil, radius_m, width_m, slip, slip_angle_deg (optional), rebound (optional), and sinkage_m or \
        load_n or both, of which exactly one is filled in each row. Every column of the input is kept; sinkage_m \
        is filled in place, and vertical_force_n, drawbar_pull_n, torque_nm, side_force_n (beside slip_angle_deg) \
        and status are added. A column that looks like another quantity is refused. A row that cannot be solved gets a \
        status and never stops the others. The table is streamed: it may be larger than memory.",
    after_help = "Examples:\n  grouser batch points.csv -o solved.csv\n  grouser batch - -o - < points.csv | head"
)]
pub(crate) struct Arguments {
    /// The table, or `-` for standard input
    #[arg(value_name = "IN.csv")]
    input: PathBuf,
    /// Where the completed table goes, or `-` for standard output; the report then goes to standard error
    #[arg(short, long, value_name = "OUT.csv")]
    output: PathBuf,
    #[command(flatten)]
    overrides: Overrides,
}

/// How many rows ended how.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    rows: u64,
    ok: u64,
    no_solution: u64,
    not_converged: u64,
    bad_input: u64,
}

/// The table and what became of its rows.
#[derive(Clone, Copy)]
struct Solved<'a> {
    counts: &'a Counts,
    soils: &'a BTreeMap<String, String>,
    output: &'a Path,
}

fn fields<'a>() -> Fields<'a, Solved<'a>> {
    fields! { |solved: Solved<'a>|
        "rows" "rows" = solved.counts.rows;
        "ok" "rows that were solved" = solved.counts.ok;
        "no_solution" "rows whose load no sinkage carries" = solved.counts.no_solution;
        "not_converged" "rows whose search did not converge" = solved.counts.not_converged;
        "bad_input" "rows with a bad value" = solved.counts.bad_input;
        "soils" "the soils and their sources" values = Some(solved.soils.clone());
        "output" "the table that was written" = solved.output.display().to_string();
    }
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    fields().schema()
}

/// The soils met so far: each soil and its source.
type Soils = BTreeMap<String, (Soil, String)>;

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    if session.is_json() && arguments.output == Path::new(STANDARD) {
        return Err(Error::usage(
            "`--output -` and `--json` both need standard output",
            "write the table into a file",
        ));
    }
    let input = Input::open_table(&arguments.input)?;
    let progress = Progress::of_bytes(input.length());
    let mut lines = Lines::of(input);
    let columns = Columns::read(lines.next()?, &arguments.input)?;
    let mut output = TableSink::create(&arguments.output)?;
    let path = output.path().to_owned();

    output.line(&columns.header())?;
    let mut counts = Counts::default();
    let mut soils = Soils::new();
    let mut used: BTreeMap<String, String> = BTreeMap::new();
    let solve = |chunk: Vec<Line>, bytes: u64| {
        let rows: Vec<Row> = chunk.par_iter().map(|line| columns.row(line)).collect();
        for row in rows.iter().filter_map(|row| row.point.as_ref().ok()) {
            add_soil(&mut soils, &row.soil, &arguments.overrides, session);
        }
        for (name, (_, source)) in &soils {
            if used.len() < SOILS && !used.contains_key(name) {
                used.insert(name.clone(), source.clone());
            }
        }
        let kernel_of = |name: &str| soils.get(name).map(|(soil, _)| BatchKernel::new(*soil));
        let lanes = lanes::solve(&rows, kernel_of);
        let solved: Vec<(String, Ending)> = rows
            .par_iter()
            .zip(&lanes)
            .map_init(Cache::default, |cache, (row, lane)| match lane {
                Some(forces) => (
                    solved_line(&columns, row, forces),
                    Ending::Solved(Status::Ok),
                ),
                None => complete(&columns, row, &soils, arguments, cache),
            })
            .collect();
        progress.advance(bytes);
        solved
            .into_iter()
            .map(|(line, ending)| {
                counts.add(ending);
                line
            })
            .collect()
    };
    let lines = stream::solve_lines(lines, solve, |line| output.line(line))?;
    if counts.rows == 0 {
        return Err(Error::content(
            &arguments.input,
            "line 2: there is a header but no row",
            None,
        ));
    }
    session.used_input(lines.into_input());
    output.finish()?;
    drop(progress);

    let solved = Solved {
        counts: &counts,
        soils: &used,
        output: &path,
    };
    let text = format!("wrote {}: {}\n", shown(&path), counts.words());
    let mut report = Report::done(fields().object(solved), text);
    report.is_aside = arguments.output == Path::new(STANDARD);
    report.warnings = columns.warnings();
    if counts.ok == 0 {
        report.outcome = Outcome::NoResult;
        report.failure = Some("no row could be solved; `status` says why".to_owned());
    } else if counts.ok < counts.rows {
        report.outcome = Outcome::Doubtful;
    }
    Ok(report)
}

/// Keeps a soil that can be had; what cannot is told in its rows.
fn add_soil(soils: &mut Soils, name: &str, overrides: &Overrides, session: &mut Session) {
    if soils.contains_key(name) {
        return;
    }
    if let Ok(chosen) = soil_choice::choose(OsStr::new(name), overrides) {
        if soils.len() >= SOILS {
            soils.pop_first();
        }
        if let Some(document) = &chosen.document {
            session.used_document(document);
        }
        soils.insert(name.to_owned(), (chosen.soil, chosen.source));
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Ending {
    Solved(Status),
    BadInput,
}

/// The wheel on its soil that the last row of this thread had.
#[derive(Default)]
struct Cache(Option<(CacheKey, WheelOnSoil)>);

type CacheKey = (String, [u64; 2], Option<[u64; 3]>, Option<u64>);

/// A row that the lanes have solved, as a line.
fn solved_line(columns: &Columns, row: &Row, solved: &lanes::Solved) -> String {
    // lanes have no slip angle
    let [vertical_force, drawbar_pull, torque] = solved.forces.map(exact);
    let results = [vertical_force, drawbar_pull, torque, exact(0.0)];
    columns.line(row, &exact(solved.sinkage), &results, Status::Ok.key())
}

/// A row with its answer, as a line.
fn complete(
    columns: &Columns,
    row: &Row,
    soils: &Soils,
    arguments: &Arguments,
    cache: &mut Cache,
) -> (String, Ending) {
    let answer = match &row.point {
        Ok(point) => solve(point, soils, &arguments.overrides, cache),
        Err(message) => Err(message.clone()),
    };
    match answer {
        Ok(answer) => {
            let point = answer.point.as_ref();
            let number = |value: Option<f64>| value.map_or_else(String::new, exact);
            let results = [
                number(point.map(|point| point.forces.vertical_force)),
                number(point.map(|point| point.forces.drawbar_pull)),
                number(point.map(|point| point.forces.torque)),
                number(point.map(|point| point.side_force)),
            ];
            let sinkage = number(point.map(|point| point.sinkage));
            let line = columns.line(row, &sinkage, &results, answer.status.key());
            (line, Ending::Solved(answer.status))
        }
        Err(message) => {
            let status = format!("bad-input: {message}");
            let line = columns.line(row, "", &Default::default(), &status);
            (line, Ending::BadInput)
        }
    }
}

fn solve(
    point: &self::columns::Point,
    soils: &Soils,
    overrides: &Overrides,
    cache: &mut Cache,
) -> Result<Answer, String> {
    let refuse = |error| Names::Columns.message(&error);
    let wheel = (point.radius_m, point.width_m);
    let key = (
        point.soil.clone(),
        [wheel.0.to_bits(), wheel.1.to_bits()],
        point.grousers.map(|sizes| sizes.map(f64::to_bits)),
        point.rebound.map(f64::to_bits),
    );
    let pair = match &cache.0 {
        Some((last, pair)) if *last == key => pair.clone(),
        _ => {
            let soil = match soils.get(&point.soil) {
                Some((soil, _)) => *soil,
                None => soil_choice::choose(OsStr::new(&point.soil), overrides)
                    .map(|chosen| chosen.soil)
                    .map_err(|error| error.to_string())?,
            };
            let soil = match point.rebound {
                Some(rebound) => soil.with_rebound(rebound).map_err(refuse)?,
                None => soil,
            };
            let mut wheel = RigidWheel::new(wheel.0, wheel.1).map_err(refuse)?;
            if let Some([height, count, thickness]) = point.grousers {
                wheel = wheel
                    .with_grousers(lugs(height, count, thickness))
                    .map_err(refuse)?;
            }
            let pair = WheelOnSoil::new(wheel, soil, Settings::default()).map_err(refuse)?;
            cache.0 = Some((key, pair.clone()));
            pair
        }
    };
    let slip = Slip::new(point.slip).map_err(refuse)?;
    let kinematics = if point.slip_angle_deg == 0.0 {
        Kinematics::straight(slip)
    } else {
        let angle = Angle::from_deg(point.slip_angle_deg);
        Kinematics::with_slip_angle(slip, angle).map_err(refuse)?
    };
    operation::solve(&pair, point.asked, &kinematics).map_err(refuse)
}

impl Counts {
    fn add(&mut self, ending: Ending) {
        self.rows += 1;
        *match ending {
            Ending::Solved(Status::Ok) => &mut self.ok,
            Ending::Solved(Status::NoSolution(_)) => &mut self.no_solution,
            Ending::Solved(Status::NotConverged) => &mut self.not_converged,
            Ending::BadInput => &mut self.bad_input,
        } += 1;
    }

    fn words(&self) -> String {
        use std::fmt::Write as _;
        let mut words = format!("{} rows, {} solved", self.rows, self.ok);
        for (count, what) in [
            (self.no_solution, "without a solution"),
            (self.not_converged, "not converged"),
            (self.bad_input, "bad (see their status)"),
        ] {
            if count > 0 {
                let _ = write!(words, ", {count} {what}"); // to a string: it cannot fail
            }
        }
        words
    }
}
