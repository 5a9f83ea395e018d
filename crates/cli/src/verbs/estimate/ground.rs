//! `estimate --learn-ground` and `--known-ground`: slip by the motors on grounds whose slip was measured before.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::Write as _;
use std::path::Path;

use grouser_log::Log;
use grouser_replay::{
    Coverage, EffortUnit, GroundSlip, GroundSlips, KnownGround, KnownGrounds,
    known_grounds_to_toml, learn_grounds, read_known_grounds, slips_by_known_grounds,
};
use grouser_report::{Fields, fields};

use super::calibration::{Files, read_runs};
use super::request::Request;
use crate::error::{Error, Result, shown};
use crate::exit::Outcome;
use crate::output::OutputFile;
use crate::session::Session;
use crate::verb_report::Report;

/// Below this probability of a known ground an interval rests on the rollers alone, or on nothing.
const MIN_KNOWN_SHARE: f64 = 0.5;
/// Intervals that held less often in runs left out are doubtful: 95 % were promised.
const MIN_COVERAGE: f64 = 0.85;

/// Writes what runs with a reference show of their grounds.
pub(super) fn learn(files: &Files<'_>, request: &Request, session: &mut Session) -> Result<Report> {
    let mut output = OutputFile::create(files.target)?;
    let logs = read_runs(files, request, session)?;
    let names = files.logs.iter().map(|path| run_name(path));
    let logs: Vec<(String, Log)> = names.zip(logs).collect();
    let (known, coverages) = learn_grounds(&logs, &request.robot, &request.options)?;
    let written = output.write_all(known_grounds_to_toml(&known).as_bytes());
    written.map_err(|error| Error::file("write", files.target, &error))?;
    output.finish()?;
    let mut text = format!(
        "{} stretches of {} runs\n\n{}\n{}",
        known.grounds.len(),
        logs.len(),
        Fields::new()
            .remark("run", |ground: &KnownGround| ground.run.as_str())
            .join(learnt_ground(), |ground| ground)
            .table(&known.grounds),
        held_back(&known)
    );
    let _ = writeln!(text, "wrote {}", shown(files.target));
    Ok(Report::done(
        learnt().object((&known, &coverages, files.target)),
        text,
    ))
}

/// The name of a run: of its file, without what names its format.
fn run_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    name.split('.').next().unwrap_or_default().to_owned()
}

/// How well intervals held in runs left out.
fn held_back(known: &KnownGrounds) -> String {
    match known.coverage.zip(known.half_width) {
        Some((coverage, half_width)) => format!(
            "in runs left out {:.1} % of the seconds lay in their interval of 95 %, median half-width {half_width:.3}\n",
            100.0 * coverage
        ),
        None => "too few runs to say how well the intervals hold\n".to_owned(),
    }
}

/// The slips of one log by a file of known grounds.
pub(super) fn by_known(
    log: &Log,
    file: &Path,
    request: &Request,
    session: &mut Session,
) -> Result<Report> {
    let known = read_known_grounds(file)?;
    session.used_file(file)?;
    let found = slips_by_known_grounds(log, &request.robot, &request.options, &known)?;
    for file in log.files() {
        session.used_file(file)?;
    }
    let doubts = doubts(&known, &found);
    let of = Found {
        known: &known,
        slips: &found,
        doubts: &doubts,
    };
    let is_empty = found.stretches.is_empty();
    Ok(Report {
        outcome: match (is_empty, doubts.is_empty()) {
            (true, _) => Outcome::NoResult,
            (false, true) => Outcome::Done,
            (false, false) => Outcome::Doubtful,
        },
        failure: is_empty.then(|| {
            "no stretch with a slip: nowhere does one command hold for 4 s of straight drive in which every motor's current \
             or torque is logged"
                .to_owned()
        }),
        warnings: doubts.clone(),
        ..Report::done(fields().object(of), text(request, of))
    })
}

/// What an interval comes from.
fn source(known: &KnownGrounds, slip: &GroundSlip) -> &'static str {
    match (known.unit, slip.stretch.roller.is_some()) {
        (EffortUnit::Ampere, true) => "currents, rollers",
        (EffortUnit::Ampere, false) => "currents",
        (EffortUnit::NewtonMetre, true) => "torques, rollers",
        (EffortUnit::NewtonMetre, false) => "torques",
    }
}

/// The run whose ground it resembles most.
fn nearest<'a>(known: &'a KnownGrounds, slip: &GroundSlip) -> &'a str {
    let ground = known.grounds.get(slip.range.nearest);
    ground.map_or("", |ground| ground.run.as_str())
}

/// Why intervals say little.
fn doubts(known: &KnownGrounds, found: &GroundSlips) -> Vec<String> {
    let mut out = Vec::new();
    match known.coverage {
        Some(coverage) if coverage < MIN_COVERAGE => out.push(format!(
            "the intervals of 95 % held only {:.1} % of the seconds in runs left out",
            100.0 * coverage
        )),
        Some(_) => {}
        None => out
            .push("how well the intervals hold is not known: too few runs were learnt".to_owned()),
    }
    for slip in &found.stretches {
        if slip.range.known_share < MIN_KNOWN_SHARE {
            out.push(format!(
                "from {:.1} s on the motors draw {:.2} {}: the ground is none of the known ones",
                slip.stretch.from_s,
                slip.stretch.effort,
                known.unit.symbol()
            ));
        }
    }
    out
}

/// What was found by known grounds.
#[derive(Clone, Copy)]
struct Found<'a> {
    known: &'a KnownGrounds,
    slips: &'a GroundSlips,
    doubts: &'a [String],
}

const NOT_OBSERVABLE: &str = "bounds, not measurements: each slip is an interval of 95 % for any second of its stretch, if slope and load are \
                              those of the known grounds; not observable: a slip that changes while the motors draw the same, and braking";

fn text(request: &Request, of: Found<'_>) -> String {
    let mut text = format!(
        "{}: slip of {:.1} s by the motors, from {} stretches of known slip\n\n",
        request.robot.robot.name(),
        of.slips.duration_s,
        of.known.grounds.len(),
    );
    for doubt in of.doubts {
        let _ = writeln!(text, "DOUBTFUL: {doubt}");
    }
    let _ = writeln!(text, "{NOT_OBSERVABLE}\n{}", held_back(of.known));
    let rows: Vec<_> = of
        .slips
        .stretches
        .iter()
        .map(|slip| (of.known, slip))
        .collect();
    let table = Fields::new()
        .join(stretch(), |of| of)
        .remark("by", |of: (&KnownGrounds, &GroundSlip)| source(of.0, of.1))
        .remark("resembles", |of: (&KnownGrounds, &GroundSlip)| {
            nearest(of.0, of.1)
        });
    text.push_str(&table.table(rows));
    for time_s in &of.slips.ground_changes_s {
        let _ = writeln!(text, "another ground from {time_s:.1} s on, by the motors");
    }
    text
}

fn fields<'a>() -> Fields<'a, Found<'a>> {
    fields! { |of: Found<'a>|
        "duration_s" "length of the log" = of.slips.duration_s;
        "stretches" "each stretch of one command on one ground" rows(stretch()) =
            of.slips.stretches.iter().map(move |slip| (of.known, slip));
        "ground_changes_s" "when torques or motor currents showed another ground" = of.slips.ground_changes_s.clone();
        "coverage" "share of the seconds in runs left out that lay in their interval; null of too few runs" = of.known.coverage;
        "half_width" "median half-width of those intervals" = of.known.half_width;
        "not_observable" "what the motors cannot show" = NOT_OBSERVABLE;
        "doubts" "why the intervals say little" = of.doubts.to_vec();
    }
}

fn stretch<'a>() -> Fields<'a, (&'a KnownGrounds, &'a GroundSlip)> {
    fields! { |of: (&'a KnownGrounds, &'a GroundSlip)|
        "from_s" "from" .shown("s").decimals(1) = of.1.stretch.from_s;
        "to_s" "to" .shown("s").decimals(1) = of.1.stretch.to_s;
        "slip" "median slip" .shown("").decimals(2) = of.1.range.median;
        "slip_low" "2.5 %" .shown("").decimals(2) = of.1.range.low;
        "slip_high" "97.5 %" .shown("").decimals(2) = of.1.range.high;
        "source" "what shows it" = source(of.0, of.1);
        "nearest" "the run that it resembles most" = nearest(of.0, of.1);
        "known_share" "known ground" .shown("").decimals(2) = of.1.range.known_share;
        "slip_by_reference" "by reference" .shown("").decimals(3) = of.1.by_reference;
        "effort" "sum of the motors' currents in A, or torques in N m" = of.1.stretch.effort;
        "speed_m_per_s" "speed by the wheels" = of.1.stretch.speed;
        "ripple_hz" "ripple of the rollers; null without" = of.1.stretch.roller.map(|roller| roller.ripple);
    }
}

type Learnt<'a> = (&'a KnownGrounds, &'a Vec<Coverage>, &'a Path);

fn learnt<'a>() -> Fields<'a, Learnt<'a>> {
    fn coverage<'a>() -> Fields<'a, &'a Coverage> {
        fields! { |of: &'a Coverage|
            "run" "the run" = of.run.as_str();
            "contained" "seconds whose slip lies in the interval by the other runs" = of.contained;
            "seconds" "all seconds" = of.seconds;
        }
    }
    fields! { |of: Learnt<'a>|
        "grounds" "stretches of known slip" rows(learnt_ground()) = of.0.grounds.iter();
        "coverage" "share of the seconds in runs left out that lay in their interval; null of too few runs" = of.0.coverage;
        "half_width" "median half-width of those intervals" = of.0.half_width;
        "coverages" "the same of each run" rows(coverage()) = of.1.iter();
        "output" "the file that was written" = of.2.display().to_string();
    }
}

fn learnt_ground<'a>() -> Fields<'a, &'a KnownGround> {
    fields! { |of: &'a KnownGround|
        "run" "the run" = of.run.as_str();
        "from_s" "from" .shown("s").decimals(1) = of.stretch.from_s;
        "to_s" "to" .shown("s").decimals(1) = of.stretch.to_s;
        "effort" "effort" .shown("").decimals(2) = of.stretch.effort;
        "ripple_hz" "ripple" .shown("Hz").decimals(2) = of.stretch.roller.map(|roller| roller.ripple);
        "slip" "slip" .shown("").decimals(3) = of.slip;
        "slip_scatter" "scatter" .shown("").decimals(3) = of.scatter;
    }
}

/// The JSON schemas of both.
pub(super) fn schemas() -> [serde_json::Value; 2] {
    [learnt().schema(), fields().schema()]
}
