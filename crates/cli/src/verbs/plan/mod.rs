//! `plan`: the route of minimum energy over a map, within a bound on the risk.

mod figure;
mod object;
mod scenario;

use std::path::PathBuf;

use grouser_report::number::{parse_finite, shown};
use grouser_terra::Caution;
use grouser_terra::slope::MAX_SLIP;
use grouser_terrain::Headings;
use grouser_terrain::plan::{Plan, PlanMap, PlanSettings, plan};

use crate::error::{Error, Result, shown as shown_path};
use crate::figure_file::ending;
use crate::output::OutputFile;
use crate::progress::Progress;
use crate::session::Session;
use crate::verb_report::Report;

#[derive(clap::Args, Debug)]
#[command(
    about = "The route of minimum energy over a slip map, within a bound on the risk",
    long_about = "The route of minimum energy between two places of a map that `grouser map` made, within a bound on the probability \
        of immobilisation anywhere on the route, on the slip and on the tip-over margin. The robot goes in the map's headings and turns no \
        sharper than its turning radius. The same map and flags give the same route on every machine.\n\nThe bound counts one soil \
        of uncertain strength for the whole map; patches of other soil are not in it. Turning costs --turn-energy-j, nothing unless given.",
    after_help = "Examples:\n  grouser plan map.tif --from 12,8 --to 40,30\n  \
        grouser plan map.tif --from 12,8 --to 40,30 --max-risk 0.01 -o route.csv -o route.svg\n  \
        grouser plan map.tif --from 12,8 --to 40,30 --scenario route.toml --dem dem.tif --robot rover.toml --soil dry-sand"
)]
pub(crate) struct Arguments {
    /// The map (.tif)
    #[arg(value_name = "MAP")]
    map: PathBuf,
    /// Start in the map's coordinates, m
    #[arg(long, value_name = "X,Y", value_parser = parse_place, allow_hyphen_values = true)]
    from: (f64, f64),
    /// Goal in the map's coordinates, m
    #[arg(long, value_name = "X,Y", value_parser = parse_place, allow_hyphen_values = true)]
    to: (f64, f64),
    /// Bound on the probability of immobilisation anywhere on the route
    #[arg(long, value_name = "P", value_parser = parse_finite, default_value = "0.05")]
    max_risk: f64,
    /// Maximum slip, driving or braking, that 95 % of the soil draws may demand
    #[arg(long, value_name = "S", value_parser = parse_finite, default_value_t = MAX_SLIP)]
    max_slip: f64,
    /// Minimum tip-over margin, in degrees
    #[arg(long, value_name = "DEG", value_parser = parse_finite, default_value = "10")]
    min_tip_over_deg: f64,
    /// Wheel speed in m/s, for the time
    #[arg(long, value_name = "V", value_parser = parse_finite, default_value = "0.25")]
    speed_m_per_s: f64,
    /// Energy of a turn by one heading in J, which the map does not know
    #[arg(long, value_name = "J", value_parser = parse_finite, default_value = "0")]
    turn_energy_j: f64,
    /// Minimise the CVaR of the energy over the soil draws, instead of the energy on the soil itself
    #[arg(long)]
    cvar: bool,
    /// Heading at the start in degrees from x towards y, the nearest of the map's; whichever serves best unless given
    #[arg(long, value_name = "DEG", value_parser = parse_finite, allow_hyphen_values = true)]
    start_heading_deg: Option<f64>,
    /// Heading at the goal in degrees, the nearest of the map's
    #[arg(long, value_name = "DEG", value_parser = parse_finite, allow_hyphen_values = true)]
    goal_heading_deg: Option<f64>,
    /// Number of alternative routes
    #[arg(long, value_name = "N", default_value = "2", value_parser = clap::value_parser!(u8).range(0..=20))]
    alternatives: u8,
    /// Write a scenario that `grouser drive` follows; with --dem, --robot and --soil
    #[arg(long, value_name = "FILE.toml", requires_all = ["dem", "robot", "soil"])]
    scenario: Option<PathBuf>,
    /// The elevation model of the map, for the scenario
    #[arg(long, value_name = "DEM", requires = "scenario")]
    dem: Option<PathBuf>,
    /// The robot file, for the scenario
    #[arg(long, value_name = "FILE.toml", requires = "scenario")]
    robot: Option<PathBuf>,
    /// The soil, for the scenario: a key of the catalogue or a soil file
    #[arg(long, value_name = "SOIL", requires = "scenario")]
    soil: Option<String>,
    /// Write the route as a table (.csv) or a figure (.svg); may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
}

/// `12.5,-3`
fn parse_place(text: &str) -> std::result::Result<(f64, f64), String> {
    let place = text
        .split_once(',')
        .map(|(x, y)| Ok::<_, String>((parse_finite(x.trim())?, parse_finite(y.trim())?)));
    place.unwrap_or_else(|| Err("two numbers are needed, such as 12.5,-3".to_owned()))
}

/// Begins the output files; which of them are tables.
fn begin(paths: &[PathBuf]) -> Result<Vec<(OutputFile, bool)>> {
    paths
        .iter()
        .map(|path| match ending(path).as_deref() {
            Some("csv") => Ok((OutputFile::create(path)?, true)),
            Some("svg") => Ok((OutputFile::create(path)?, false)),
            _ => Err(Error::usage(
                format!("{} does not end in `.csv` or `.svg`", shown_path(path)),
                "the ending of the output's name chooses its format",
            )),
        })
        .collect()
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let outputs = begin(&arguments.output)?;
    let scenario = arguments
        .scenario
        .as_deref()
        .map(OutputFile::create)
        .transpose()?;
    let map = PlanMap::read(&arguments.map)?;
    session.used_file(&arguments.map)?;
    let names = match (&arguments.dem, &arguments.robot, &arguments.soil) {
        (Some(dem), Some(robot), Some(soil)) => Some(scenario::Names { dem, robot, soil }),
        _ => None,
    };
    if let Some(names) = &names {
        scenario::check(&map, names)?;
    }
    let headings = map.layout.headings;
    let heading = |angle: Option<f64>| angle.map(|angle| headings.nearest(angle.to_radians()));
    let settings = PlanSettings {
        max_risk: arguments.max_risk,
        max_slip: arguments.max_slip,
        min_tip_over_deg: arguments.min_tip_over_deg,
        rim_speed: arguments.speed_m_per_s,
        turn_energy: arguments.turn_energy_j,
        by_cvar: arguments.cvar,
        start_heading: heading(arguments.start_heading_deg),
        goal_heading: heading(arguments.goal_heading_deg),
    };
    let from = map.cell_at("the start", arguments.from)?;
    let to = map.cell_at("the goal", arguments.to)?;
    let progress = Progress::of_work("searching for routes");
    let found = plan(&map, (from, to), &settings, arguments.alternatives.into())?;
    drop(progress);
    let planned = object::Planned {
        map: &map,
        plan: &found,
        max_risk: arguments.max_risk,
    };
    let object = object::fields().object(&planned);
    let (route, alternatives) = match &found {
        Plan::Found {
            route,
            alternatives,
        } => (route, alternatives),
        Plan::NoWay { least_risk } => return Ok(no_way(object, *least_risk, arguments)),
        _ => return Err(Error::usage_without_hint("a plan of another kind")),
    };
    let mut text = planned.text(route, alternatives);
    for (file, is_table) in outputs {
        let content = if is_table {
            object::csv(&map, route)
        } else {
            figure::draw(&map, route, alternatives)?
        };
        text.push_str(&file.write_whole(content.as_bytes())?);
    }
    if let (Some(file), Some(names)) = (scenario, names) {
        let content = scenario::toml(&map, route, &names, arguments.speed_m_per_s, &file)?;
        text.push_str(&file.write_whole(content.as_bytes())?);
    }
    let mut warnings: Vec<String> = [
        ("--start-heading-deg", arguments.start_heading_deg),
        ("--goal-heading-deg", arguments.goal_heading_deg),
    ]
    .into_iter()
    .filter_map(|(flag, angle)| other_heading(flag, angle?, map.layout.headings))
    .collect();
    if route.deep_share > 0.0 {
        warnings.push(format!(
            "caution at {} % of the cells of the route: {}",
            shown(100.0 * route.deep_share),
            Caution::DeepSinkage
        ));
    }
    if route.turns > 0 {
        warnings.push(
            "a map knows steady straight driving: turns, drift on side slopes and ruts can immobilise a robot where the \
             risk is 0; simulate the route first (`--scenario`)"
                .to_owned(),
        );
    }
    if map.layout.draws == 0 {
        warnings.push(
            "the map treats its soil as exactly known: its risks are 0 or 1, and the bound does not cover the soil"
                .to_owned(),
        );
    }
    Ok(Report {
        warnings,
        ..Report::done(object, text)
    })
}

/// A heading that is none of the map's counts as the nearest one; a degree is less than a turn that a plan could mean.
const SAME_HEADING_DEG: f64 = 1.0;

fn other_heading(flag: &str, angle: f64, headings: Headings) -> Option<String> {
    let nearest = headings
        .angle(headings.nearest(angle.to_radians()))
        .to_degrees();
    let off = (angle - nearest + 180.0).rem_euclid(360.0) - 180.0;
    (off.abs() > SAME_HEADING_DEG).then(|| {
        format!(
            "{flag} {} counts as {}, the nearest of the map's {} headings",
            shown(angle),
            shown(nearest),
            headings.count()
        )
    })
}

fn no_way(object: grouser_report::Object, least: Option<f64>, arguments: &Arguments) -> Report {
    let bound = shown(arguments.max_risk);
    let text = match least {
        Some(least) => format!(
            "no route keeps the risk within {bound}; the minimum bound that a route keeps is {}\n",
            shown(least)
        ),
        None => format!(
            "no route leads to the goal at any risk (slip at most {}, tip-over margin at least {} deg)\n",
            shown(arguments.max_slip),
            shown(arguments.min_tip_over_deg)
        ),
    };
    Report::done(object, String::new()).failing(Some(text.trim_end().to_owned()))
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    object::fields().schema()
}
