//! `drive`: a scenario simulated with estimator and controller in the loop.

mod comparison;
mod log;
mod mcap;
mod object;
pub(crate) mod optimum;
mod report;
mod run;
mod soil;
mod text;

use std::path::PathBuf;
use std::sync::Mutex;

use grouser_page::run::DriveRecorder;
use grouser_rover::drive::{
    Frame, Pilot, Scenario, Simulation, SlipScore, equal_speed_share, read_scenario,
};
use grouser_slip::onboard::SoilTables;
use grouser_terrain::mission;
use rayon::prelude::*;

use self::log::Log;
use self::object::Drives;
use self::run::Run;
use crate::error::{Error, Result};
use crate::progress::Progress;
use crate::report_file::ReportFlag;
use crate::session::Session;
use crate::verb_report::Report;

#[derive(clap::Args, Debug)]
#[command(
    about = "Simulate a drive with estimator and controller in the loop",
    long_about = "Simulate a drive over soft ground: robot, stresses under each wheel, sensors with their noise and \
        faults, the slip estimator and the controller in the loop.\n\nThe controller runs at the slip that the \
        scenario gives, else at the one that the running-slip problem (examples/problems/running-slip.toml) gives for \
        this wheel, load and soil. docs/drive.md says what is simulated and how far it can be trusted.",
    after_help = "Examples:\n  grouser drive examples/scenarios/sandbox.toml --report sandbox.html\n  \
        grouser drive examples/scenarios/soft-patch.toml --compare open-loop,controller\n  \
        grouser drive examples/scenarios/soft-patch.toml --compare open-loop,controller --sweep 50 --json\n  \
        grouser drive examples/scenarios/sandbox.toml -o drive.mcap"
)]
pub(crate) struct Arguments {
    /// The scenario (.toml)
    #[arg(value_name = "SCENARIO.toml")]
    scenario: PathBuf,
    /// Drive the same ground with each of these: `controller`, `open-loop` (constant wheel speed at which the robot has the
    /// mean speed of the controller's own drive), `fixed-chassis` (the controller, with a chassis that does not move)
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "controller"
    )]
    compare: Vec<String>,
    /// The seed of ground and noise, instead of the scenario's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Drive with this many seeds, from the first one on
    #[arg(long, value_name = "N", default_value_t = 1)]
    sweep: u64,
    #[command(flatten)]
    report: ReportFlag,
    /// Write the log of the sensors (.csv, .mcap), which `estimate` reads; of the last named driver and the first seed; may be
    /// given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
}

/// Maximum of the seeds of a sweep.
const MAX_SEEDS: u64 = 10_000;

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let pilots: Vec<Pilot> = arguments
        .compare
        .iter()
        .map(|name| pilot(name))
        .collect::<Result<_>>()?;
    if !(1..=MAX_SEEDS).contains(&arguments.sweep) {
        let limits = ([1.0, MAX_SEEDS as f64], None);
        let said = format_args!("lie in [1, {MAX_SEEDS}]");
        let sweep = arguments.sweep as f64;
        return Err(Error::out_of_range("--sweep", sweep, limits, said));
    }
    let report = arguments.report.begin()?;
    session.used_file(&arguments.scenario)?;
    let path = &arguments.scenario;
    let scenario = read_scenario(path).map_err(|error| Error::from(error).in_file(path))?;
    session.used_file(&scenario.robot_file)?;
    if scenario.plan.is_some() && pilots.iter().any(|pilot| *pilot != Pilot::Controller) {
        return Err(Error::usage(
            "`--compare` names other drivers, but the scenario plans its route",
            "a navigator drives it, with the slip loop of `controller`; leave `--compare` out",
        ));
    }
    let first = arguments.seed.unwrap_or(scenario.seed);
    session.used_seed(first);
    let optimum = scenario.slip_setpoint()?;
    let outputs = arguments.output.iter();
    let logs = outputs
        .map(|path| Log::begin(path, &scenario))
        .collect::<Result<Vec<_>>>()?;
    let jobs = Jobs {
        pilots: &pilots,
        optimum,
        first,
        sweep: arguments.sweep,
    };
    // what the ground or the robot of a scenario lacks shows itself where it is built
    let driven = drive_all(&scenario, &jobs, logs);
    let (runs, logs) = driven.map_err(|error| error.in_file(path))?;
    let mut text = text::text(&scenario, optimum, &runs);
    let object = object::fields().object(Drives {
        scenario: &scenario,
        optimum,
        seed: first,
        runs: &runs,
    });
    for log in logs {
        text.push_str(&log.finish()?);
    }
    if let Some(file) = report {
        let shown = report::report(&scenario, optimum, &runs);
        text.push_str(&file.write(&scenario.title, shown, session)?);
    }
    Ok(Report {
        warnings: run::warnings(&runs),
        ..Report::done(object, text)
    })
}

fn pilot(name: &str) -> Result<Pilot> {
    Pilot::ALL
        .into_iter()
        .find(|pilot| pilot.name() == name)
        .ok_or_else(|| {
            Error::usage(
                format!("`--compare` names `{name}`, which is no driver"),
                "drivers are `open-loop`, `controller` and `fixed-chassis`",
            )
        })
}

/// What is to be driven.
struct Jobs<'a> {
    pilots: &'a [Pilot],
    optimum: f64,
    first: u64,
    sweep: u64,
}

/// Every driver with every seed, on all cores; in the order of drivers, then seeds. The logs are of the last
/// driver and the first seed.
///
/// The controller drives first: open loop has the mean speed of that drive, so that times and energies compare.
fn drive_all(scenario: &Scenario, jobs: &Jobs<'_>, logs: Vec<Log>) -> Result<(Vec<Run>, Vec<Log>)> {
    let first = jobs.first;
    let has_open_loop = jobs.pilots.contains(&Pilot::OpenLoop);
    let has_fixed = jobs.pilots.contains(&Pilot::FixedChassis);
    let count = jobs.sweep * (1 + u64::from(has_open_loop) + u64::from(has_fixed));
    let progress = Progress::of_drives(
        scenario.duration * count as f64,
        usize::try_from(count).unwrap_or(usize::MAX),
    );
    let logs = Mutex::new(logs);
    // a drive that plans its way has tables of its own
    let tables = match scenario.plan {
        Some(_) => SoilTables::default(),
        None => Simulation::soil_tables(scenario)?,
    };
    let drive = |pilot: Pilot, pace: f64, seed: u64| {
        let scenario = &scenario.at_pace(pace);
        let is_shown = seed == first && jobs.pilots.contains(&pilot);
        let mut seen = is_shown.then(DriveRecorder::default);
        // one run alone holds the lock, for as long as it drives
        let is_logged = is_shown && jobs.pilots.last() == Some(&pilot);
        let mut logs = is_logged.then(|| logs.lock().ok()).flatten();
        let mut failed = None;
        let mut reported = 0.0;
        let mut see = |frame: &Frame<'_>| {
            if let Some(seen) = &mut seen {
                seen.add(frame);
            }
            for log in logs.as_deref_mut().into_iter().flatten() {
                if let Err(error) = log.add(frame) {
                    failed = Some(log.refused(&error));
                    return false;
                }
            }
            if frame.time - reported >= 1.0 {
                progress.drove(
                    frame.time - reported,
                    frame.speed,
                    frame.wheels.iter().find_map(|w| w.observation.slip),
                );
                reported = frame.time;
            }
            true
        };
        let (result, planned) = if scenario.plan.is_some() {
            let driven = mission::drive(scenario, jobs.optimum, seed, &mut see)?;
            (driven.result.clone(), Some(driven))
        } else {
            let mut drive = Simulation::with_tables(scenario, pilot, jobs.optimum, seed, &tables)?;
            (drive.run(&mut see), None)
        };
        progress.drove(scenario.duration - reported, 0.0, None);
        match failed {
            Some(error) => Err(error),
            None => Ok(Run {
                pilot,
                pace,
                seed,
                result,
                refusal: None,
                own_laws: own_laws(scenario, pilot, (jobs.optimum, &tables), seed)?,
                planned,
                seen,
            }),
        }
    };
    let of_seed = |seed: u64| -> Result<Vec<Run>> {
        let mut runs = vec![drive(Pilot::Controller, 1.0, seed)?];
        if has_open_loop {
            let share = equal_speed_share(&runs[0].result, |share| {
                let slower = scenario.at_pace(share);
                let optimum = jobs.optimum;
                Simulation::with_tables(&slower, Pilot::OpenLoop, optimum, seed, &tables)
                    .map(|mut drive| drive.run(|_| true))
            })?;
            runs.push(drive(Pilot::OpenLoop, share, seed)?);
        }
        if has_fixed {
            runs.push(drive(Pilot::FixedChassis, 1.0, seed)?);
        }
        Ok(runs)
    };
    let runs: Vec<_> = (0..jobs.sweep)
        .into_par_iter()
        .map(|index| {
            let seed = first.wrapping_add(index);
            (seed, of_seed(seed))
        })
        .collect();
    let mut runs = rows(runs, jobs.pilots)?;
    let place = |run: &Run| jobs.pilots.iter().position(|pilot| *pilot == run.pilot);
    runs.retain(|run| place(run).is_some());
    runs.sort_by_key(place);
    Ok((runs, logs.into_inner().unwrap_or_default()))
}

/// The runs of all seeds; a seed on whose ground no drive can begin is a row among others, and the error where no seed
/// has such ground.
fn rows(of_seeds: Vec<(u64, Result<Vec<Run>>)>, pilots: &[Pilot]) -> Result<Vec<Run>> {
    let is_any_driven = of_seeds.iter().any(|(_, runs)| runs.is_ok());
    let mut rows = Vec::new();
    for (seed, runs) in of_seeds {
        match runs {
            Ok(runs) => rows.extend(runs),
            Err(error) if is_any_driven && !error.is_of_file() => {
                rows.extend(
                    pilots
                        .iter()
                        .map(|pilot| Run::refused(*pilot, seed, &error)),
                );
            }
            Err(error) => return Err(error),
        }
    }
    Ok(rows)
}

/// The slips of the same drive on ground that obeys the estimator's own laws, for a scenario with `world_laws`.
fn own_laws(
    scenario: &Scenario,
    pilot: Pilot,
    (optimum, tables): (f64, &SoilTables),
    seed: u64,
) -> Result<Option<SlipScore>> {
    // another world leads to another way: its slips would be those of another drive
    if scenario.ground.world_laws.is_none() || scenario.plan.is_some() {
        return Ok(None);
    }
    let mut own = scenario.clone();
    own.ground.world_laws = None;
    let mut drive = Simulation::with_tables(&own, pilot, optimum, seed, tables)?;
    Ok(Some(drive.run(|_| true).slip))
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    object::fields().schema()
}
