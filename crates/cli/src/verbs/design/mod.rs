//! `design`: the wheel of a robot for a mission of slopes and soils.

mod carrier;
mod check;
mod figure;
mod object;
mod page;
mod problem;
mod request;
mod text;

use std::ops::ControlFlow;
use std::path::PathBuf;

use grouser_design::mission::{Choice, FrontSettings, MissionFront, MissionParams, MissionProfile};
use grouser_report::number::{parse_finite, shown};

use crate::error::Result;
use crate::exit::Outcome;
use crate::interrupt::Search;
use crate::output::OutputFile;
use crate::output_choice::Output;
use crate::progress::Progress;
use crate::report_file::ReportFlag;
use crate::session::Session;
use crate::soil_choice::Overrides;
use crate::verb_report::{Medium, Report};
use crate::wheel_choice::GravityArgument;

use carrier::Carrier;
use check::{Checked, MAX_DIFFERENCE};
use object::Designed;
use request::{Bounds, ChoiceName, MeasureName, Request, Shared};

#[derive(clap::Args, Debug)]
#[command(
    about = "The wheel of a robot for a mission of slopes and soils: energy per metre against wheel mass",
    long_about = "The wheels of minimum energy per metre for their mass that hold every slope on every soil with a pull margin, and \
        one of them chosen: radius, width, lugs, where the chassis' mass lies, and the slip at which it runs.\n\nAll powered wheels share one slip. Loads follow \
        the slope, the radius and the mass of the new wheel. Each design is checked by the solver of `grouser climb`, which shares \
        no search with it. The model does not decide strength, wear and life of a wheel, obstacles, turning and ruts.",
    after_help = "Examples:\n  grouser design rover.toml --soil dry-sand=0.7,sandy-loam=0.3 --slope-deg 0=0.8,8=0.2\n  \
        grouser design rover.toml --soil lunar --slope-deg 0=0.9,10=0.1 --gravity-m-per-s2 moon --write-robot new.toml -o front.svg\n  \
        grouser design rover.toml --mission mission.toml --max-wheel-mass-kg 1.2 --json\n  \
        grouser design rover.toml --soil dry-sand --slope-deg 5 --report wheel.html"
)]
pub(crate) struct Arguments {
    /// The robot file, with masses and widths
    #[arg(value_name = "ROBOT.toml")]
    robot: PathBuf,
    /// A mission file (`grouser init mission`); flags precede it
    #[arg(long, value_name = "FILE.toml")]
    mission: Option<PathBuf>,
    /// Soils with their shares of the distance: keys of the catalogue, or files when they contain `/` or `.`
    #[arg(long, value_name = "KEY|FILE[=SHARE]", value_delimiter = ',', value_parser = request::parse_soil)]
    soil: Vec<Shared<String>>,
    #[command(flatten)]
    overrides: Overrides,
    /// Slopes in degrees with their shares of the distance
    #[arg(long, value_name = "DEG[=SHARE]", value_delimiter = ',', value_parser = request::parse_slope, allow_hyphen_values = true)]
    slope_deg: Vec<Shared<f64>>,
    #[command(flatten)]
    gravity: GravityArgument,
    /// Bounds of the wheel's radius in m, or one number [default: 0.6 to 1.5 times the present one]
    #[arg(long, value_name = "FROM:TO", allow_hyphen_values = true)]
    radius_m: Option<Bounds>,
    /// Bounds of the wheel's width in m, or one number [default: 0.5 to 2 times the present one]
    #[arg(long, value_name = "FROM:TO", allow_hyphen_values = true)]
    width_m: Option<Bounds>,
    /// Bounds of the height of the lugs in m, or one number [default: the present one]
    #[arg(long, value_name = "FROM:TO", allow_hyphen_values = true)]
    grouser_height_m: Option<Bounds>,
    /// Bounds of the number of lugs, or one number; 0 for a smooth wheel [default: the present one]
    #[arg(long, value_name = "FROM:TO", allow_hyphen_values = true)]
    grouser_count: Option<Bounds>,
    /// Thickness of a lug along the circumference in m [default: the present one, or 0.002]
    #[arg(long, value_name = "M", value_parser = parse_finite)]
    grouser_thickness_m: Option<f64>,
    /// Bounds of the shift of the chassis' mass forwards in m, which distributes the load between the axles [default: 0]
    #[arg(long, value_name = "FROM:TO", allow_hyphen_values = true)]
    mass_shift_m: Option<Bounds>,
    /// Mass of one wheel in kg, a formula over `radius_m`, `width_m`, `grouser_height_m`, `grouser_count` and
    /// `grouser_thickness_m` [default: a wheel of aluminium sheet of 2 mm]
    #[arg(long, value_name = "FORMULA")]
    wheel_mass_kg: Option<String>,
    /// How the energies of several soils become one number: of the worst soil, or their mean by the shares [default: worst]
    #[arg(long, value_name = "MEASURE")]
    soil_measure: Option<MeasureName>,
    /// Minimum pull margin on every slope and soil, share of the weight [default: 0.05]
    #[arg(long, value_name = "X", value_parser = parse_finite)]
    min_reserve: Option<f64>,
    /// Maximum slip at which a slope counts as held [default: 0.6]
    #[arg(long, value_name = "S", value_parser = parse_finite)]
    max_slip: Option<f64>,
    /// Which wheel of the front is chosen [default: knee]
    #[arg(long, value_name = "CHOICE", conflicts_with = "max_wheel_mass_kg")]
    choice: Option<ChoiceName>,
    /// Choose the wheel of minimum energy up to this mass of one wheel in kg
    #[arg(long, value_name = "KG", value_parser = parse_finite)]
    max_wheel_mass_kg: Option<f64>,
    /// Points of the front [default: 12]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(2..=200))]
    points: Option<u8>,
    /// Seed of the starts [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Write the mission that flags and mission file give together
    #[arg(long, value_name = "FILE.toml")]
    write_mission: Option<PathBuf>,
    /// Write the robot with the chosen wheel
    #[arg(long, value_name = "FILE.toml")]
    write_robot: Option<PathBuf>,
    /// Write one wheel on the deciding soil and slope as a problem for `grouser optimize`
    #[arg(long, value_name = "FILE.toml")]
    problem: Option<PathBuf>,
    /// Write the front as a table (.csv) or a figure (.svg, .png); may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    #[command(flatten)]
    report: ReportFlag,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let outputs = Output::begin(&arguments.output)?;
    let page = arguments.report.begin()?;
    let create = |path: &Option<PathBuf>| path.as_deref().map(OutputFile::create).transpose();
    let (robot_output, problem_output) =
        (create(&arguments.write_robot)?, create(&arguments.problem)?);
    let mission_output = create(&arguments.write_mission)?;
    let request = request::read(arguments, session)?;
    let mission_text = mission_output
        .as_ref()
        .map(|file| request.toml(&arguments.overrides, file))
        .transpose()?;
    let carrier = Carrier::new(&arguments.robot, request.file.gravity)?;
    session.used_file(&arguments.robot)?;
    let ranges = request.ranges(&carrier)?;
    let mut params = MissionParams::new(
        carrier.wheels(),
        request.soils.clone(),
        request.slopes.clone(),
        ranges,
    );
    request.complete(&mut params);
    params.also_radius = Some(carrier.present.radius);
    let stand = |radius, mass, shift| carrier.standing((radius, mass, shift), &request.slopes);
    let present = of_file(params.clone(), &carrier);
    let mission = MissionProfile::new(params, stand)?;
    let present = MissionProfile::new(present, stand)?.evaluate(&carrier.present)?;
    let mut settings = FrontSettings::default();
    request.settings(&mut settings);
    session.used_seed(settings.seed);
    let search = Search::begin();
    let bar = Progress::of_items(settings.points as u64 + 1, "solves");
    let front = mission.front(&settings, &mut |progress| {
        bar.reach(progress.done as u64);
        if search.is_interrupted() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })?;
    drop(bar);
    drop(search);
    let checked = Checked::new(&carrier, &mission, &front)?;
    let designed = Designed {
        mission: &mission,
        carrier: &carrier,
        sources: &request.sources,
        front: &front,
        present: &present,
        checked: &checked,
    };
    let mut text = designed.text();
    if let Some(file) = page {
        let shown = page::shown(&designed, &text)?;
        let title = format!("The wheel of {}", carrier.name());
        text.push_str(&file.write(&title, shown, session)?);
    }
    text.push_str(&Output::write_all(
        outputs,
        || designed.csv(),
        || Ok(figure::draw(&designed)),
    )?);
    let mut warnings = designed.warnings(Request::touching_radius(&carrier, &ranges));
    if let (Some(file), Some(mission)) = (mission_output, mission_text) {
        text.push_str(&file.write_whole(mission.as_bytes())?);
    }
    if let Some(chosen) = designed.chosen() {
        if let Some(file) = robot_output {
            let robot = carrier.robot(&chosen.wheel, chosen.wheel_mass)?;
            text.push_str(&file.write_whole(robot.as_bytes())?);
        }
        if let Some(file) = problem_output {
            let problem = problem::toml(&mission, chosen, carrier.wheel_count())?;
            text.push_str(&file.write_whole(problem.as_bytes())?);
        }
    }
    let failure = match designed.chosen() {
        None if !front.stopped => Some(why_no_wheel(&front, settings.choice)),
        _ => None,
    };
    if front.stopped {
        warnings.push("interrupted: these are the wheels that were found so far".to_owned());
    }
    let is_doubtful = checked.difference > MAX_DIFFERENCE || checked.falls() || failure.is_some();
    Ok(Report {
        outcome: if front.stopped {
            Outcome::Interrupted
        } else if is_doubtful {
            Outcome::Doubtful
        } else {
            Outcome::Done
        },
        object: object::fields().object(&designed),
        text,
        medium: Medium::Text,
        failure,
        warnings,
    })
}

/// The same mission for the present wheel with the mass that the robot file gives it, whatever the formula says of it.
fn of_file(mut params: MissionParams, carrier: &Carrier) -> MissionParams {
    params.mass_formula = carrier.present_mass.to_string();
    params
}

/// Why no wheel is chosen.
fn why_no_wheel(front: &MissionFront, choice: Choice) -> String {
    match (choice, front.points.first()) {
        (Choice::MaxMass(limit), Some(lightest)) => format!(
            "no wheel of at most {} kg holds every slope with the pull margin; the lightest that does has {} kg",
            shown(limit),
            shown(lightest.wheel_mass)
        ),
        _ => "no wheel within the bounds holds every slope on every soil with the pull margin; the nearest one is printed".to_owned(),
    }
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    object::fields().schema()
}
