//! `batch`: a table of operating points.

mod columns;
mod lanes;
mod sink;
mod soils;
mod stream;

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use grouser_terra::{
    Angle, Caution, Cautions, Kinematics, LoadSolution, OpenSoil, OperatingPoint, RigidWheel,
    Settings, Slip, Soil, SolveStatus, WheelOnSoil,
};

use self::columns::{Columns, Numbers, Point, Row, SOIL_NUMBERS, SoilNumbers};
use self::sink::TableSink;
use self::soils::{Met, Soils};
use self::stream::{Blocks, Text};
use crate::error::{Error, Result, shown};
use crate::exit::Outcome;
use crate::input::{Input, STANDARD};
use crate::law_error::Names;
use crate::progress::Progress;
use crate::session::Session;
use crate::soil_choice::{self, Overrides};
use crate::verb_report::{Medium, Report};
use crate::wheel_choice::lugs;
use grouser_log::csv::quoted;
use grouser_report::{Fields, fields};

#[derive(clap::Args, Debug)]
#[command(
    about = "Solve a table of operating points",
    long_about = "Solve a table of operating points, one per line of a CSV file with commas.\n\n\
        Columns: soil, radius_m, width_m, slip, slip_angle_deg, rebound, grouser_height_m, grouser_count, \
        grouser_thickness_m (these five optional), and sinkage_m or \
        load_n or both, of which exactly one is filled in each row. Numbers of the soil may differ from row to row: \
        k_c_kn_per_m_n1, k_phi_kn_per_m_n2, n, cohesion_kpa, phi_deg, k_shear_m, c_1 and c_2, as in soil files; \
        an empty field means the soil's own number. Every column of the input is kept; sinkage_m \
        is filled in place, and vertical_force_n, drawbar_pull_n, torque_nm, side_force_n (with slip_angle_deg), \
        pull_fluctuation_n and torque_fluctuation_nm (with lugs), status and cautions (their keys, with spaces between) are \
        added. A column that looks like another \
        quantity is refused; remarks begin with note_ or measured_. A row that cannot be solved gets a \
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
#[derive(Clone, Debug, Default)]
struct Counts {
    rows: u64,
    /// By the code of their status.
    by_status: [u64; SolveStatus::ALL.len()],
    /// Solved rows with a caution.
    cautioned: u64,
    /// Solved rows by caution.
    cautions: BTreeMap<Caution, u64>,
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
        "ok" "rows that were solved" = solved.counts.ended(SolveStatus::Solved);
        "no_solution" "rows whose load no sinkage carries" = solved.counts.ended(SolveStatus::NoSolution);
        "not_converged" "rows whose search did not converge" = solved.counts.ended(SolveStatus::NotConverged);
        "bad_input" "rows with a bad value" = solved.counts.ended(SolveStatus::BadInput);
        "below_resolution" "solved rows whose load is smaller than the solver resolves: their vertical force differs from it" =
            solved.counts.with(Caution::LoadBelowResolution);
        "outside_fit" "solved rows whose slip, slip angle, width or load lies outside the tests that their soil was fitted on" =
            solved.counts.with(Caution::OutsideFit);
        "with_cautions" "solved rows with a caution" = solved.counts.cautioned;
        "cautions" "solved rows by caution" values = Some(solved.counts.cautions.iter().map(|(caution, count)| (caution.key(), *count)));
        "soils" "the soils and their sources" values = Some(solved.soils.clone());
        "output" "the table that was written" = solved.output.display().to_string();
    }
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    fields().schema()
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    if session.is_json() && arguments.output == Path::new(STANDARD) {
        return Err(Error::usage(
            "`--output -` and `--json` both need standard output",
            "write the table into a file",
        ));
    }
    let input = Input::open_table(&arguments.input, session.is_json())?;
    let progress = Progress::of_bytes(input.length());
    let mut blocks = Blocks::new(input);
    let header = blocks.header()?;
    let columns = Columns::read(header.lines().next(), &arguments.input)?;
    let mut output = TableSink::create(&arguments.output)?;
    let path = output.path().to_owned();

    output.lines(&columns.header())?;
    let mut counts = Counts::default();
    let met = Met::new(&arguments.overrides, session);
    let solve = |chunk: Text| {
        let mut fields = Vec::new();
        let mut rows: Vec<Row<'_>> = Vec::with_capacity(chunk.max_lines());
        rows.extend(chunk.rows().map(|line| columns.row(line, &mut fields)));
        let soils = Soils::new(&rows, &met);
        let found = lanes::solve(&rows, &soils, columns.has_soil_numbers());
        let mut cache = Cache::default();
        let mut solved = Chunk {
            text: String::with_capacity(160 * rows.len()),
            counts: Counts::default(),
        };
        for (place, row) in rows.iter().enumerate() {
            let soil = soils.of_row(place).map(|(_, known)| &known.soil);
            let status = match found.of_row(place) {
                (status @ (SolveStatus::Solved | SolveStatus::NoSolution), mut numbers) => {
                    if let (Some(numbers), Ok(point), Some(soil)) = (&mut numbers, &row.point, soil)
                        && lanes::may_be_several(point, soil)
                    {
                        let answer =
                            solve_point(point, Some(soil), &arguments.overrides, &mut cache);
                        let general = answer.ok().and_then(|answer| answer.point());
                        let several = Caution::SeveralSinkages;
                        let is_known =
                            general.is_some_and(|point| point.cautions.contains(several));
                        numbers.cautions.insert_if(is_known, several);
                    }
                    solved.push(&columns, row, numbers, status)
                }
                // by the general solver and in its words
                _ => complete(&mut solved, (&columns, row), soil, arguments, &mut cache),
            };
            solved.counts.add(status);
        }
        solved
    };
    let write = |solved: Chunk, bytes| {
        counts.merge(&solved.counts);
        progress.advance(bytes);
        output.lines(&solved.text)
    };
    let blocks = stream::solve_lines(blocks, solve, write)?;
    let (sources, session) = met.into_sources();
    if counts.rows == 0 {
        return Err(Error::content(
            &arguments.input,
            "line 2: there is a header but no row",
            None,
        ));
    }
    session.used_input(blocks.into_input());
    output.finish()?;
    drop(progress);

    let solved = Solved {
        counts: &counts,
        soils: &sources,
        output: &path,
    };
    let text = format!("wrote {}: {}\n", shown(&path), counts.words());
    let mut report = Report::done(fields().object(solved), text);
    if arguments.output == Path::new(STANDARD) {
        report.medium = Medium::Aside;
    }
    report.warnings = columns.warnings();
    let caution = |(caution, count): (&Caution, &u64)| {
        let rows = if *count == 1 { "row" } else { "rows" };
        format!("caution at {count} {rows}: {caution}")
    };
    report.warnings.extend(counts.cautions.iter().map(caution));
    let solved = counts.ended(SolveStatus::Solved);
    if solved == 0 {
        report.outcome = Outcome::NoResult;
        report.failure = Some("no row could be solved; `status` says why".to_owned());
    } else if solved < counts.rows {
        report.outcome = Outcome::Doubtful;
    }
    Ok(report)
}

/// A chunk of the table with its answers.
struct Chunk {
    text: String,
    counts: Counts,
}

impl Chunk {
    /// Appends a row that was computed, as a line.
    fn push(
        &mut self,
        columns: &Columns,
        row: &Row<'_>,
        numbers: Option<Numbers>,
        status: SolveStatus,
    ) -> SolveStatus {
        if let Some(numbers) = numbers {
            self.counts.note(numbers.cautions);
        }
        columns.push_line(&mut self.text, row, numbers, status.key());
        status
    }
}

/// The wheel on its soil that the last row of this thread had.
#[derive(Default)]
struct Cache(Option<(CacheKey, WheelOnSoil)>);

/// The soil's name, and the bits of the numbers.
type CacheKey = (String, Bits);
type Bits = (
    [u64; 2],
    Option<[u64; 3]>,
    Option<u64>,
    [Option<u64>; SOIL_NUMBERS.len()],
);

/// Appends a row with its answer by the general solver, as a line.
fn complete(
    solved: &mut Chunk,
    (columns, row): (&Columns, &Row<'_>),
    soil: Option<&Soil>,
    arguments: &Arguments,
    cache: &mut Cache,
) -> SolveStatus {
    let answer = match &row.point {
        Ok(point) => solve_point(point, soil, &arguments.overrides, cache),
        Err(message) => Err(message.clone()),
    };
    match answer {
        Ok(answer) => {
            let passage = |point: &OperatingPoint| cache.0.as_ref()?.1.lug_passage(point);
            let numbers = answer.point().map(|point| Numbers {
                sinkage: point.sinkage,
                forces: [
                    point.forces.vertical_force,
                    point.forces.drawbar_pull,
                    point.forces.torque,
                ],
                side: point.side_force,
                fluctuation: passage(&point).map(|lugs| [lugs.pull, lugs.torque]),
                cautions: point.cautions,
            });
            solved.push(columns, row, numbers, answer.outcome.status())
        }
        Err(message) => {
            let status = format!("bad-input: {message}");
            columns.push_line(&mut solved.text, row, None, &quoted(&status));
            SolveStatus::BadInput
        }
    }
}

fn solve_point(
    point: &Point<'_>,
    soil: Option<&Soil>,
    overrides: &Overrides,
    cache: &mut Cache,
) -> Result<LoadSolution, String> {
    let refuse = |error| Names::Columns.message(&error);
    let wheel = (point.radius_m, point.width_m);
    let bits = (
        [wheel.0.to_bits(), wheel.1.to_bits()],
        point.grousers.map(|sizes| sizes.map(f64::to_bits)),
        point.rebound.map(f64::to_bits),
        point.soil_numbers.map(|number| number.map(f64::to_bits)),
    );
    let pair = match &cache.0 {
        Some(((soil, last), pair)) if *soil == point.soil && *last == bits => pair.clone(),
        _ => {
            let soil = match soil {
                Some(soil) => *soil,
                None => soil_choice::choose(OsStr::new(&*point.soil), overrides)
                    .map(|chosen| chosen.soil)
                    .map_err(|error| error.to_string())?,
            };
            let soil = with_numbers(&soil, &point.soil_numbers)?;
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
            cache.0 = Some(((point.soil.to_string(), bits), pair.clone()));
            pair
        }
    };
    let slip = Slip::new(point.slip).map_err(refuse)?;
    let kinematics = motion(point, slip).map_err(refuse)?;
    pair.solve(point.prescribed, &kinematics).map_err(refuse)
}

/// A soil with the numbers that a row has of its own.
fn with_numbers(soil: &Soil, numbers: &SoilNumbers) -> Result<Soil, String> {
    if *numbers == [None; SOIL_NUMBERS.len()] {
        return Ok(*soil);
    }
    let mut open = OpenSoil::from(*soil.params());
    for (number, value) in SOIL_NUMBERS.into_iter().zip(numbers) {
        if let Some(value) = *value {
            number.put(&mut open, value);
        }
    }
    open.soil().map_err(|error| Names::Columns.message(&error))
}

fn motion(point: &Point<'_>, slip: Slip) -> grouser_terra::Result<Kinematics> {
    if point.slip_angle_deg == 0.0 {
        return Ok(Kinematics::straight(slip));
    }
    Kinematics::with_slip_angle(slip, Angle::from_deg(point.slip_angle_deg))
}

impl Counts {
    /// Counts the cautions of a solved row.
    fn note(&mut self, cautions: Cautions) {
        if cautions.is_empty() {
            return;
        }
        self.cautioned += 1;
        for caution in cautions.iter() {
            *self.cautions.entry(caution).or_default() += 1;
        }
    }

    /// How many rows have a caution.
    fn with(&self, caution: Caution) -> u64 {
        self.cautions.get(&caution).copied().unwrap_or_default()
    }

    fn add(&mut self, status: SolveStatus) {
        self.rows += 1;
        self.by_status[usize::from(status.code())] += 1;
    }

    /// How many rows ended so.
    fn ended(&self, status: SolveStatus) -> u64 {
        self.by_status[usize::from(status.code())]
    }

    fn merge(&mut self, other: &Self) {
        self.rows += other.rows;
        for (own, other) in self.by_status.iter_mut().zip(other.by_status) {
            *own += other;
        }
        self.cautioned += other.cautioned;
        for (caution, count) in &other.cautions {
            *self.cautions.entry(*caution).or_default() += count;
        }
    }

    fn words(&self) -> String {
        use std::fmt::Write as _;
        let solved = self.ended(SolveStatus::Solved);
        let mut words = format!("{} rows, {solved} solved", self.rows);
        let unsolved = SolveStatus::ALL.iter().filter_map(|status| {
            let what = match status {
                SolveStatus::Solved => return None,
                SolveStatus::NoSolution => "without a solution",
                SolveStatus::NotConverged => "not converged",
                SolveStatus::BadInput => "bad (see their status)",
            };
            Some((self.ended(*status), what))
        });
        for (count, what) in unsolved.chain([(self.cautioned, "with cautions")]) {
            if count > 0 {
                let _ = write!(words, ", {count} {what}"); // to a string: it cannot fail
            }
        }
        words
    }
}
