//! `climb`: what slopes cost a wheel or a robot, up to the steepest that it holds.

mod proof;

use std::collections::BTreeMap;
use std::path::PathBuf;

use grouser_figure::{Axis, Chart, Curve, Figure, Style};
use grouser_report::number::{parse_finite, shown};
use grouser_report::{Fields, fields};
use grouser_terra::slope::greatest_surplus;
use grouser_terra::{Angle, Caution, Kinematics, Slip, SlopeOutcome, Soil, WheelOnSoil};
use grouser_terrain::{ClimbStep, DemandSolver, MAX_SLOPE_RAD, climb};

use crate::error::{Error, Result};
use crate::exit::Outcome;
use crate::input;
use crate::law_error::Names;
use crate::model_error;
use crate::output_choice::Output;
use crate::progress::Progress;
use crate::session::Session;
use crate::soil_choice::SoilArguments;
use crate::verb_report::Report;
use crate::wheel_choice::{GravityArgument, GrouserArguments, MaxSlip};
use proof::Proved;

/// Slopes of the table between the level and the steepest one.
const ROWS: u32 = 12;

/// The table ends this far below the steepest slope, rad: rounding decides whether that itself is held.
const BELOW_RAD: f64 = 1e-9;

/// A robot this close to tipping over on its steepest slope is limited by that and not by the soil, rad.
const NEAR_TIPPING_RAD: f64 = 1e-4;

#[derive(clap::Args, Debug)]
#[command(
    about = "The steepest slope that a wheel or a robot climbs, and what slopes cost",
    long_about = "The steepest slope that a wheel or a robot climbs straight on, and slip, energy per metre and margins up \
        to it.\n\nEnergy is that of the torque at the wheels. Gravity turns masses into loads; the soil's numbers stay those \
        of its file.",
    after_help = "Examples:\n  grouser climb --soil lunar --radius-m 0.125 --width-m 0.15 --mass-kg 20 --gravity-m-per-s2 moon\n  \
        grouser climb --soil dry-sand --radius-m 0.15 --width-m 0.12 --load-n 40 --certify 0.1\n  \
        grouser climb --soil dry-sand --robot examples/robots/rocker-bogie.toml -o climb.csv -o climb.svg"
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    soil: SoilArguments,
    /// A robot file with masses and widths, instead of a single wheel
    #[arg(long, value_name = "FILE.toml", conflicts_with_all = ["radius_m", "width_m", "load_n", "mass_kg", "grouser_height_m"])]
    robot: Option<PathBuf>,
    /// Radius of the wheel in m
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_hyphen_values = true, required_unless_present = "robot")]
    radius_m: Option<f64>,
    /// Width of the wheel in m
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_hyphen_values = true, required_unless_present = "robot")]
    width_m: Option<f64>,
    #[command(flatten)]
    grousers: GrouserArguments,
    /// Weight on the wheel in N
    #[arg(long, value_name = "N", value_parser = parse_finite, allow_hyphen_values = true, conflicts_with = "mass_kg")]
    load_n: Option<f64>,
    /// Mass on the wheel in kg, instead of its weight
    #[arg(long, value_name = "KG", value_parser = parse_finite, allow_hyphen_values = true)]
    mass_kg: Option<f64>,
    #[command(flatten)]
    gravity: GravityArgument,
    #[command(flatten)]
    max_slip: MaxSlip,
    /// Prove that no slip up to the maximum holds a slope that is steeper by this, in degrees; for a wheel (exit code 3 if not proved)
    #[arg(long, value_name = "DEG", num_args = 0..=1, default_missing_value = "0.1", value_parser = parse_finite, conflicts_with = "robot")]
    certify: Option<f64>,
    /// Write a table (.csv) or a figure (.svg, .png); may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
}

/// A wheel or a robot on its soil.
enum Climber {
    Wheel { pair: Box<WheelOnSoil>, weight: f64 },
    Robot(Box<DemandSolver>),
}

/// What is known of a climb.
struct Climbed {
    soil: String,
    gravity: f64,
    max_slip: f64,
    /// The steepest slope, rad; `None` where the level is too much already.
    steepest: Option<f64>,
    /// Half of the interval about it that holds 90 % of measurements, rad; `None` where that is not known.
    model_error: Option<f64>,
    steps: Vec<ClimbStep>,
    /// What is proved, with --certify.
    proof: Option<Proved>,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let outputs = Output::begin(&arguments.output)?;
    let chosen = arguments.soil.choose(session)?;
    let climber = climber(arguments, &chosen.soil, session)?;
    let gravity = match &climber {
        Climber::Robot(solver) => solver.model().gravity(),
        Climber::Wheel { .. } => arguments.gravity.with_mass(arguments.mass_kg.is_some())?,
    };
    let progress = Progress::of_work("searching for the steepest slope");
    let steepest = climber.steepest()?;
    let slopes: Vec<f64> = match steepest {
        Some(steepest) => (0..=ROWS)
            .map(|row| (steepest - BELOW_RAD).max(0.0) * f64::from(row) / f64::from(ROWS))
            .collect(),
        None => vec![0.0],
    };
    let steps = climber.steps(&slopes)?;
    let proof = match (&climber, arguments.certify) {
        (Climber::Wheel { pair, weight }, Some(margin)) => {
            Some(Proved::new(pair, *weight, steepest, margin)?)
        }
        _ => None,
    };
    drop(progress);
    // the steepest slope is held at the slip of the last step
    let slip = steps.last().and_then(|step| step.slip);
    let slip = slip.unwrap_or(arguments.max_slip.max_slip);
    let climbed = Climbed {
        soil: chosen.name,
        gravity,
        max_slip: arguments.max_slip.max_slip,
        steepest,
        model_error: model_error::pull_per_load([&chosen.soil], slip, climber.has_lugs()),
        steps,
        proof,
    };
    let mut text = climbed.text();
    if let Some(proof) = &climbed.proof {
        text.push_str(&proof.text(climbed.model_error));
    }
    text.push_str(&Output::write_all(
        outputs,
        || step().csv(&climbed.steps),
        || Ok(climbed.draw()),
    )?);
    let failure = steepest
        .is_none()
        .then(|| "not even level ground is climbed: no slip gives enough pull".to_owned());
    let is_unproved = climbed
        .proof
        .as_ref()
        .is_some_and(|proof| !proof.is_proved());
    let outcome = if is_unproved {
        Outcome::Doubtful
    } else {
        Outcome::Done
    };
    let report = Report {
        outcome,
        warnings: climbed.warnings(),
        ..Report::done(object().object(&climbed), text)
    };
    Ok(report.failing(failure))
}

fn climber(arguments: &Arguments, soil: &Soil, session: &mut Session) -> Result<Climber> {
    let refuse = |error| Names::Flags.error(&error);
    if let Some(path) = &arguments.robot {
        session.used_file(path)?;
        let model = arguments.gravity.of(input::robot(path)?);
        let solver = DemandSolver::new(model, *soil)
            .and_then(|solver| solver.with_max_slip(arguments.max_slip.max_slip))
            .map_err(|error| Error::from(error).in_file(path))?;
        return Ok(Climber::Robot(Box::new(solver)));
    }
    let (Some(radius), Some(width)) = (arguments.radius_m, arguments.width_m) else {
        return Err(Error::usage(
            "there is neither a robot nor a wheel",
            "give `--robot FILE.toml`, or `--radius-m` and `--width-m`",
        ));
    };
    let weight = match (arguments.load_n, arguments.mass_kg) {
        (Some(load), _) => load,
        (None, Some(mass)) => mass * arguments.gravity.with_mass(true)?,
        (None, None) => {
            return Err(Error::usage(
                "the wheel has no weight",
                "give `--load-n`, or `--mass-kg` with `--gravity-m-per-s2`",
            ));
        }
    };
    if !(weight > 0.0) {
        let (field, value, unit) = match arguments.mass_kg {
            Some(mass) => ("mass", mass, "kg"),
            None => ("load", weight, "N"),
        };
        return Err(refuse(grouser_terra::Error::NotAbove {
            field,
            value,
            limit: 0.0,
            unit,
        }));
    }
    let wheel = arguments.grousers.on(radius, width).map_err(refuse)?;
    let settings = arguments.max_slip.settings();
    let pair = WheelOnSoil::new(wheel, *soil, settings).map_err(refuse)?;
    Ok(Climber::Wheel {
        pair: Box::new(pair),
        weight,
    })
}

impl Climber {
    fn steepest(&self) -> Result<Option<f64>> {
        match self {
            Self::Wheel { pair, weight } => {
                let slope = pair.gradeability(*weight);
                Ok(slope
                    .map_err(|error| Names::Flags.error(&error))?
                    .map(Angle::rad))
            }
            Self::Robot(solver) => Ok(solver.steepest()?.map(|(slope, _)| slope)),
        }
    }

    fn has_lugs(&self) -> bool {
        match self {
            Self::Wheel { pair, .. } => pair.wheel().grousers().is_some(),
            Self::Robot(solver) => model_error::has_lugs(solver.model()),
        }
    }

    fn steps(&self, slopes: &[f64]) -> Result<Vec<ClimbStep>> {
        match self {
            Self::Robot(solver) => Ok(climb(solver, slopes)?),
            Self::Wheel { pair, weight } => slopes
                .iter()
                .map(|slope| wheel_step(pair, *weight, *slope))
                .collect::<grouser_terra::Result<_>>()
                .map_err(|error| Names::Flags.error(&error)),
        }
    }
}

/// A wheel alone: it has no other to lose the ground with, and nothing to tip over.
fn wheel_step(pair: &WheelOnSoil, weight: f64, slope: f64) -> grouser_terra::Result<ClimbStep> {
    let angle = Angle::from_rad(slope);
    let load = weight * angle.cos();
    let slip = match pair.slip_demand(weight, angle)? {
        SlopeOutcome::Holds { slip } => Some(slip),
        _ => None,
    };
    let point = match slip {
        Some(slip) => pair.under_load(load, &Kinematics::straight(slip))?.point(),
        None => None,
    };
    let most = greatest_surplus(pair.settings().max_slip, |slip| {
        let solved = pair.under_load(load, &Kinematics::straight(Slip::new(slip)?))?;
        Ok::<_, grouser_terra::Error>(solved.point().map(|point| point.forces.drawbar_pull))
    })?;
    Ok(ClimbStep {
        slope,
        slip: slip.map(grouser_terra::Slip::value),
        energy_per_metre: point.and_then(|point| point.energy_per_metre()),
        sinkage: point.map(|point| point.sinkage),
        reserve: most.map_or(f64::NAN, |best| best.1) - weight * angle.sin(),
        tip_over: f64::NAN,
        lifts: false,
        cautions: point.map(|point| point.cautions).unwrap_or_default(),
    })
}

fn step<'a>() -> Fields<'a, &'a ClimbStep> {
    let known = |x: f64| x.is_finite().then_some(x);
    fields! { |step: &'a ClimbStep|
        "slope_deg" "slope" .shown("deg") = step.slope.to_degrees();
        "slip" "slip" .shown("").missing("none") = step.slip;
        "energy_j_per_m" "energy" .shown("J/m").missing("none") = step.energy_per_metre;
        "sinkage_m" "sinkage" .shown("mm").missing("none") = step.sinkage;
        "reserve_n" "pull margin" .shown("N").missing("none") = known(step.reserve);
        "tip_over_deg" "tip-over margin" .shown("deg") =
            known(step.tip_over.to_degrees());
        "cautions" "cautions" = step.cautions.iter().map(Caution::key).collect::<Vec<_>>();
    }
}

fn object<'a>() -> Fields<'a, &'a Climbed> {
    fields! { |climbed: &'a Climbed|
        "soil" "soil" = climbed.soil.as_str();
        "gravity_m_per_s2" "gravity" = climbed.gravity;
        "max_slip" "maximum slip at which a slope is held" = climbed.max_slip;
        "steepest_slope_deg" "the steepest slope that is climbed" = climbed.steepest.map(f64::to_degrees);
        "steepest_slope_model_error_deg" "half of the interval about it that contains 90 % of measurements" =
            climbed.model_error.map(f64::to_degrees);
        "steps" "slopes from the level to the steepest" rows(step()) = &climbed.steps;
        "proof" "what is proved, with --certify" group(proof::fields()) = climbed.proof.as_ref();
    }
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    object().schema()
}

impl Climbed {
    fn text(&self) -> String {
        let steepest = match self.steepest {
            Some(slope) => format!("climbs slopes of up to {}°", shown(slope.to_degrees())),
            None => "climbs no slope".to_owned(),
        };
        let error = model_error::of_slope(self.model_error.filter(|_| self.steepest.is_some()));
        format!(
            "{}: {steepest} under {} m/s²\n{error}\n{}",
            self.soil,
            shown(self.gravity),
            step().table(self.steps.iter())
        )
    }

    fn draw(&self) -> Figure {
        let line = |of: &dyn Fn(&ClimbStep) -> Option<f64>| -> Vec<[f64; 2]> {
            let points = self
                .steps
                .iter()
                .map(|step| Some([step.slope.to_degrees(), of(step)?]));
            points.flatten().filter(|at| at[1].is_finite()).collect()
        };
        let panel = |title: &str, points: Vec<[f64; 2]>| {
            Chart::new(Axis::new("Slope (deg)"), Axis::new(title))
                .curve(Curve::new(points).style(Style::numbered(0)))
        };
        Figure::new(format!(
            "Slip, energy per metre and pull margin against slope on {}",
            self.soil
        ))
        .columns(3)
        .panel(panel("Slip *s*", line(&|step| step.slip)))
        .panel(panel("Energy (J/m)", line(&|step| step.energy_per_metre)))
        .panel(panel("Pull margin (N)", line(&|step| Some(step.reserve))))
    }

    /// What the numbers do not say by themselves.
    fn warnings(&self) -> Vec<String> {
        let unknown = self.model_error.is_none().then_some(model_error::UNKNOWN);
        let mut list: Vec<String> = unknown.into_iter().map(str::to_owned).collect();
        if self
            .steepest
            .is_some_and(|slope| slope > 0.99 * MAX_SLOPE_RAD)
        {
            list.push("steeper slopes were not tried".to_owned());
        }
        let mut cautions = BTreeMap::<_, &ClimbStep>::new();
        for step in &self.steps {
            for caution in step.cautions.iter() {
                cautions.entry(caution).or_insert(step);
            }
        }
        list.extend(cautions.iter().map(|(caution, step)| {
            format!(
                "caution from {}° on: {caution}",
                shown(step.slope.to_degrees())
            )
        }));
        let last = self.steps.last();
        if last.is_some_and(|step| step.tip_over.abs() < NEAR_TIPPING_RAD) {
            list.push(
                "the robot tips over on steeper slopes, which the soil would hold".to_owned(),
            );
        }
        list
    }
}
