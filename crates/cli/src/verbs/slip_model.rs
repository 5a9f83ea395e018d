//! `slip-model`: the analytical slip model of the paper, at a point or over a range.

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::PathBuf;

use grouser_terra::{Angle, Mobilised, ModelOutcome, ModelSlip, slip_model};
use serde_json::Value;

use super::slip_model_figure;
use super::slip_model_grid::{Axes, Values};
use crate::error::{Error, Outcome, Result, shown as shown_path};
use crate::figure_file::{self, ending};
use crate::law_error::Names;
use crate::number::{exact, parse_finite, short, shown};
use crate::output::OutputFile;
use crate::report::{Object, Report};
use crate::session::Session;
use crate::soil_choice::{Overrides, choose};
use crate::table::Table;

#[derive(clap::Args, Debug)]
#[command(
    about = "Evaluate the analytical slip model of Ani et al. (2012)",
    long_about = "Evaluate the analytical slip model of Ani et al. (2012): the slip S at which the soil at an angle \
        of the rim mobilises a share of its strength; by default none of it, S_0.\n\n\
        S is 1 - v/(r w), the driving formula continued below zero. S_0 is never positive (figures of the paper \
        apparently show its magnitude) and depends on the angle and on sinkage/radius alone: no soil can move it. \
        Outside the contact it is computed all the same, with a caution.",
    after_help = "Examples:\n  grouser slip-model --theta-deg 32 --sinkage-m 0.03 --radius-m 0.1\n  \
        grouser slip-model --theta-deg 0:40 --sinkage-m 0.01,0.014,0.02,0.03 --radius-m 0.1 -o slip.svg\n  \
        grouser slip-model --theta-deg 10 --sinkage-m 0.02 --radius-m 0.1 --mobilised 0.5 --soil dry-sand"
)]
pub(crate) struct Arguments {
    /// Angle on the rim from the vertical, positive towards travel, in degrees: a number, a list `a,b,c` or a range `from:to`
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    theta_deg: Values,
    /// Sinkage in m: a number, a list or a range
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    sinkage_m: Values,
    /// Radius of the wheel in m: a number, a list or a range
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    radius_m: Values,
    /// Points of a range
    #[arg(long, value_name = "N", default_value_t = 101, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    points: u32,
    /// Share of the soil's strength that is mobilised, from 0 to less than 1; above 0 it needs K
    #[arg(long, value_name = "X", value_parser = parse_finite, allow_negative_numbers = true, default_value_t = 0.0)]
    mobilised: f64,
    /// A soil, for its K: a key of the catalogue, or a file when it contains `/` or `.`
    #[arg(long, value_name = "KEY|FILE")]
    soil: Option<std::ffi::OsString>,
    #[command(flatten)]
    overrides: Overrides,
    /// Write a table (.csv) or a figure (.svg, .png); may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
}

/// One answer of the model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) theta_deg: f64,
    pub(super) sinkage_m: f64,
    pub(super) radius_m: f64,
    pub(super) outcome: ModelOutcome,
}

enum Output {
    Table(OutputFile),
    Figure(figure_file::Target),
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let outputs: Vec<Output> = arguments.output.iter().map(open).collect::<Result<_>>()?;
    let mobilised = mobilised(arguments, session)?;
    let axes = Axes::new(
        &arguments.theta_deg,
        &arguments.sinkage_m,
        &arguments.radius_m,
        arguments.points,
    )?;
    let points: Vec<Point> = axes
        .points()
        .map(|at| evaluate(at, mobilised))
        .collect::<Result<_>>()?;
    let reached = points.iter().any(|point| point.slip().is_some());
    let failure = (!reached).then(|| match points.first().map(|point| point.outcome) {
        Some(ModelOutcome::Unreachable { most }) => format!(
            "`--mobilised` is {}, but even a wheel that spins on the spot mobilises {} there",
            crate::number::told(arguments.mobilised),
            shown(most)
        ),
        _ => "the model has no slip for any of the points".to_owned(),
    });

    let mut text = match points.as_slice() {
        [point] => single(point, arguments.mobilised),
        points if outputs.is_empty() => table(points),
        points => format!("{} points\n", points.len()),
    };
    for output in outputs {
        text.push_str(&match output {
            Output::Table(file) => write_csv(file, &points, arguments.mobilised)?,
            Output::Figure(target) => target.write(&slip_model_figure::draw(
                &axes,
                &points,
                arguments.mobilised,
            )?)?,
        });
    }
    Ok(Report {
        outcome: if reached {
            Outcome::Done
        } else {
            Outcome::NoResult
        },
        object: object(&points, mobilised),
        text,
        failure,
        warnings: Vec::new(),
    })
}

fn open(path: &PathBuf) -> Result<Output> {
    match ending(path).as_deref() {
        Some("csv") => Ok(Output::Table(OutputFile::create(path)?)),
        Some("svg" | "png") => figure_file::Target::of(path).map(Output::Figure),
        _ => Err(Error::usage(
            format!(
                "{} does not end in `.csv`, `.svg` or `.png`",
                shown_path(path)
            ),
            "the ending of the output's name chooses its format",
        )),
    }
}

/// The share with the K that it needs: of a flag, else of the soil.
fn mobilised(arguments: &Arguments, session: &mut Session) -> Result<Option<Mobilised>> {
    let share = arguments.mobilised;
    if !(0.0..1.0).contains(&share) {
        return Err(Error::usage_without_hint(format!(
            "`--mobilised` is {}, but must lie in [0, 1)",
            crate::number::told(share)
        )));
    }
    // Only K enters; a soil that lacks c_1 and c_2 serves as well.
    let soil = match &arguments.soil {
        Some(name) => {
            let unused = |given: Option<f64>| given.or(Some(0.0));
            let overrides = Overrides {
                c_1: unused(arguments.overrides.c_1),
                c_2: unused(arguments.overrides.c_2),
                ..arguments.overrides
            };
            let chosen = choose(name, &overrides)?;
            session.used_soil(&chosen.name, &chosen.source);
            Some(chosen.soil)
        }
        None => None,
    };
    if share == 0.0 {
        return Ok(None);
    }
    let k_shear = arguments
        .overrides
        .k_shear_m
        .or(soil.map(|soil| soil.params().k_shear));
    match k_shear {
        Some(k_shear) => Ok(Some(Mobilised { share, k_shear })),
        None => Err(Error::usage(
            "missing `--soil` or `--k-shear-m`, which `--mobilised` needs",
            "the share that is mobilised depends on the shear deformation modulus K",
        )),
    }
}

fn evaluate(
    [theta_deg, sinkage_m, radius_m]: [f64; 3],
    mobilised: Option<Mobilised>,
) -> Result<Point> {
    let theta = Angle::from_deg(theta_deg);
    let outcome = slip_model(theta, sinkage_m, radius_m, mobilised)
        .map_err(|error| Names::Flags.error(&error))?;
    Ok(Point {
        theta_deg,
        sinkage_m,
        radius_m,
        outcome,
    })
}

impl Point {
    pub(super) fn slip(&self) -> Option<ModelSlip> {
        match self.outcome {
            ModelOutcome::Slip(slip) => Some(slip),
            _ => None,
        }
    }

    fn status(&self) -> &'static str {
        if self.slip().is_some() {
            "ok"
        } else {
            "unreachable"
        }
    }

    fn cautions(&self) -> Vec<&'static str> {
        let outside = self.slip().is_some_and(|slip| !slip.in_contact);
        outside.then_some("outside-contact").into_iter().collect()
    }

    fn object(&self) -> Object {
        let slip = self.slip();
        let number = |f: fn(&ModelSlip) -> f64| Value::from(slip.as_ref().map(f));
        let most = match self.outcome {
            ModelOutcome::Unreachable { most } => Some(most),
            _ => None,
        };
        [
            ("theta_deg", Value::from(self.theta_deg)),
            ("sinkage_m", Value::from(self.sinkage_m)),
            ("radius_m", Value::from(self.radius_m)),
            ("status", Value::from(self.status())),
            ("slip", number(|slip| slip.driving_formula)),
            ("slip_magnitude", number(|slip| slip.driving_formula.abs())),
            ("slip_ratio", number(|slip| slip.slip.value())),
            ("theta_1_deg", number(|slip| slip.theta_1.deg())),
            ("in_contact", Value::from(slip.map(|slip| slip.in_contact))),
            ("most_mobilised", Value::from(most)),
            ("cautions", Value::from(self.cautions())),
        ]
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
    }
}

/// One point has its keys at the top; several stand in `points`.
fn object(points: &[Point], mobilised: Option<Mobilised>) -> Object {
    let mut object = Object::from_iter([
        (
            "model".to_owned(),
            Value::from("Ani et al. 2012, S = 1 - v/(r w)"),
        ),
        (
            "mobilised".to_owned(),
            Value::from(mobilised.map_or(0.0, |mobilised| mobilised.share)),
        ),
        (
            "k_shear_m".to_owned(),
            Value::from(mobilised.map(|mobilised| mobilised.k_shear)),
        ),
    ]);
    match points {
        [point] => object.extend(point.object()),
        points => {
            let points = points
                .iter()
                .map(|point| Value::Object(point.object()))
                .collect();
            object.insert("points".to_owned(), points);
        }
    }
    object
}

fn single(point: &Point, share: f64) -> String {
    let mut text = format!(
        "θ {} deg, sinkage {} mm, radius {} mm, {} of the strength mobilised\n",
        shown(point.theta_deg),
        shown(1e3 * point.sinkage_m),
        shown(1e3 * point.radius_m),
        if share == 0.0 {
            "none".to_owned()
        } else {
            shown(share)
        }
    );
    if let Some(slip) = point.slip() {
        let mut table = Table::new().text("").number("").text("");
        for (name, value, unit) in [
            ("slip S = 1 − v/(r ω)", slip.driving_formula, ""),
            ("its magnitude", slip.driving_formula.abs(), ""),
            ("as a slip ratio s", slip.slip.value(), ""),
            ("entry angle", slip.theta_1.deg(), "deg"),
        ] {
            table.row([name, &shown(value), unit]);
        }
        text.push_str(&table.render_body());
        if !slip.in_contact {
            let entry = shown(slip.theta_1.deg());
            let _ = writeln!(
                text,
                "caution: θ lies outside the contact, which ends at {entry} deg"
            );
        }
    }
    text
}

fn table(points: &[Point]) -> String {
    let mut table = Table::new()
        .number("θ deg")
        .number("z mm")
        .number("r mm")
        .number("S")
        .number("|S|")
        .number("s")
        .text("");
    for point in points {
        let slip = point.slip();
        let number =
            |f: fn(&ModelSlip) -> f64| slip.as_ref().map(f).map_or_else(|| "–".to_owned(), shown);
        let remark = match slip {
            None => "unreachable",
            Some(slip) if !slip.in_contact => "outside the contact",
            Some(_) => "",
        };
        table.row([
            shown(point.theta_deg),
            shown(1e3 * point.sinkage_m),
            shown(1e3 * point.radius_m),
            number(|slip| slip.driving_formula),
            number(|slip| slip.driving_formula.abs()),
            number(|slip| slip.slip.value()),
            remark.to_owned(),
        ]);
    }
    table.render()
}

fn write_csv(mut file: OutputFile, points: &[Point], share: f64) -> Result<String> {
    use std::io::Write as _;
    let path = file.path().to_owned();
    let mut lines = String::from(
        "theta_deg,sinkage_m,radius_m,mobilised,slip,slip_magnitude,slip_ratio,theta_1_deg,in_contact,status\n",
    );
    for point in points {
        let slip = point.slip();
        let number =
            |f: fn(&ModelSlip) -> f64| slip.as_ref().map(f).map_or_else(String::new, exact);
        let _ = writeln!(
            lines,
            "{},{},{},{},{},{},{},{},{},{}",
            short(point.theta_deg),
            short(point.sinkage_m),
            short(point.radius_m),
            short(share),
            number(|slip| slip.driving_formula),
            number(|slip| slip.driving_formula.abs()),
            number(|slip| slip.slip.value()),
            number(|slip| slip.theta_1.deg()),
            slip.map_or_else(String::new, |slip| slip.in_contact.to_string()),
            point.status()
        );
    }
    file.write_all(lines.as_bytes())
        .map_err(|error| Error::file("write", &path, &error))?;
    file.finish()?;
    Ok(format!("wrote {}\n", shown_path(&path)))
}
