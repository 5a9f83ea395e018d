//! `curve`: a wheel over a range of slip.

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::{Path, PathBuf};

use grouser_terra::{BestSlip, WheelOnSoil};
use rayon::prelude::*;
use serde_json::Value;

use super::curve_figure;
use crate::error::{Error, Outcome, Result, shown as shown_path};
use crate::figure_file::{self, ending};
use crate::law_error::Names;
use crate::number::{exact, parse_finite, short, shown};
use crate::operation::{self, Answer, Asked};
use crate::output::OutputFile;
use crate::report::{Object, Report};
use crate::session::Session;
use crate::table::Table;
use crate::wheel_choice::WheelArguments;

/// More points than this are no curve any more.
const MOST_POINTS: i64 = 100_000;

#[derive(clap::Args, Debug)]
#[command(
    about = "Solve a wheel on a soil over a range of slip",
    after_help = "Examples:\n  grouser curve --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip-from 0 --slip-to 0.9 --points 10\n  \
        grouser curve --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 40 --load-n 65 --load-n 90 --slip-from 0 --slip-to 0.9 --points 91 -o curve.svg"
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    wheel: WheelArguments,
    #[command(flatten)]
    asked: LoadsOrSinkages,
    /// First slip
    #[arg(long, value_name = "S", value_parser = parse_finite, allow_negative_numbers = true)]
    slip_from: f64,
    /// Last slip
    #[arg(long, value_name = "S", value_parser = parse_finite, allow_negative_numbers = true)]
    slip_to: f64,
    /// Number of points, evenly spaced
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=MOST_POINTS))]
    points: u32,
    /// Write a table (.csv) or a figure (.svg, .png); may be given several times
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
}

/// One kind of the two, once or several times.
#[derive(clap::Args, Clone, Debug)]
#[group(required = true)]
struct LoadsOrSinkages {
    /// Load that the wheel carries in N; several times for several curves
    #[arg(long, value_name = "N", value_parser = parse_finite, allow_negative_numbers = true, conflicts_with = "sinkage_m")]
    load_n: Vec<f64>,
    /// Sinkage in m; several times for several curves
    #[arg(long, value_name = "M", value_parser = parse_finite, allow_negative_numbers = true)]
    sinkage_m: Vec<f64>,
}

/// One curve: what it was asked for by, and its points.
pub(super) struct Family {
    pub(super) asked: Asked,
    pub(super) points: Vec<(f64, Answer)>,
    pub(super) most_pull: Option<BestSlip>,
    pub(super) most_efficient: Option<BestSlip>,
}

enum Output {
    Table(OutputFile),
    Figure(figure_file::Target),
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let outputs: Vec<Output> = arguments
        .output
        .iter()
        .map(|path| open(path))
        .collect::<Result<_>>()?;
    let (pair, chosen) = arguments.wheel.pair(session)?;
    let slips = slips(arguments)?;
    let families: Vec<Family> = asked(&arguments.asked)
        .map(|asked| family(arguments, &pair, asked, &slips))
        .collect::<Result<_>>()?;

    let mut text = format!(
        "{}: wheel of radius {} m, width {} m\n",
        chosen.name,
        shown(arguments.wheel.radius_m),
        shown(arguments.wheel.width_m)
    );
    for family in &families {
        add_summary(&mut text, family);
    }
    if outputs.is_empty() {
        text.push_str(&table(&families));
    }
    let frame = Frame {
        arguments,
        pair: &pair,
        soil: &chosen.name,
    };
    for output in outputs {
        text.push_str(&match output {
            Output::Table(file) => frame.write_csv(file, &families)?,
            Output::Figure(target) => target.write(&curve_figure::draw(&chosen.name, &families))?,
        });
    }
    let found = families
        .iter()
        .flat_map(|family| &family.points)
        .any(|(_, a)| a.point.is_some());
    Ok(Report {
        outcome: if found {
            Outcome::Done
        } else {
            Outcome::NoResult
        },
        object: frame.object(&families),
        text,
        failure: (!found).then(|| "no point of the curve has a solution".to_owned()),
        warnings: Vec::new(),
    })
}

fn open(path: &Path) -> Result<Output> {
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

fn asked(given: &LoadsOrSinkages) -> impl Iterator<Item = Asked> {
    let loads = given.load_n.iter().map(|load| Asked::Load(*load));
    loads.chain(
        given
            .sinkage_m
            .iter()
            .map(|sinkage| Asked::Sinkage(*sinkage)),
    )
}

fn slips(arguments: &Arguments) -> Result<Vec<f64>> {
    let (from, to) = (arguments.slip_from, arguments.slip_to);
    for (flag, value) in [("--slip-from", from), ("--slip-to", to)] {
        if !(-1.0..=1.0).contains(&value) {
            return Err(Error::usage_without_hint(format!(
                "`{flag}` is {}, but must lie in [-1, 1]",
                crate::number::told(value)
            )));
        }
    }
    if !(from < to) {
        return Err(Error::usage_without_hint(format!(
            "`--slip-from` is {}, but must be less than `--slip-to`, {}",
            crate::number::told(from),
            crate::number::told(to)
        )));
    }
    let last = arguments.points - 1;
    let share = |i: u32| f64::from(i) / f64::from(last);
    // The last point is exactly the one that was asked for.
    Ok((0..=last)
        .map(|i| {
            if i == last {
                to
            } else {
                from + (to - from) * share(i)
            }
        })
        .collect())
}

fn family(
    arguments: &Arguments,
    pair: &WheelOnSoil,
    asked: Asked,
    slips: &[f64],
) -> Result<Family> {
    let refuse = |error| Names::Flags.error(&error);
    let points = slips
        .par_iter()
        .map(|slip| {
            let kinematics = arguments.wheel.kinematics(*slip)?;
            let answer = operation::solve(pair, asked, &kinematics).map_err(refuse)?;
            Ok((*slip, answer))
        })
        .collect::<Result<_>>()?;
    let straight = arguments.wheel.slip_angle_deg == 0.0;
    let (most_pull, most_efficient) = match asked {
        Asked::Load(load) if straight => (
            pair.slip_of_maximum_pull(load).map_err(refuse)?,
            pair.slip_of_maximum_efficiency(load).map_err(refuse)?,
        ),
        _ => (None, None),
    };
    Ok(Family {
        asked,
        points,
        most_pull,
        most_efficient,
    })
}

fn add_summary(text: &mut String, family: &Family) {
    let _ = match family.asked {
        Asked::Load(load) => write!(text, "under {} N:", shown(load)),
        Asked::Sinkage(sinkage) => write!(text, "at a sinkage of {} mm:", shown(1e3 * sinkage)),
    };
    let solved = family
        .points
        .iter()
        .filter(|(_, answer)| answer.point.is_some())
        .count();
    let _ = write!(text, " {solved} of {} points solved", family.points.len());
    if let Some(best) = &family.most_pull {
        let (pull, slip) = (shown(best.value), shown(best.slip.value()));
        let _ = write!(text, "; most pull {pull} N at slip {slip}");
    }
    if let Some(best) = &family.most_efficient {
        let (share, slip) = (shown(100.0 * best.value), shown(best.slip.value()));
        let _ = write!(text, "; best efficiency {share} % at slip {slip}");
    }
    text.push('\n');
}

fn table(families: &[Family]) -> String {
    let mut table = Table::new()
        .number("slip")
        .number("load N")
        .number("sinkage mm")
        .number("pull N")
        .number("torque N m")
        .number("efficiency %")
        .text("status");
    for family in families {
        for (slip, answer) in &family.points {
            let load = match family.asked {
                Asked::Load(load) => Some(load),
                Asked::Sinkage(_) => answer.point.map(|point| point.forces.vertical_force),
            };
            let point = answer.point.as_ref();
            let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), shown);
            table.row([
                shown(*slip),
                number(load),
                number(point.map(|point| 1e3 * point.sinkage)),
                number(point.map(|point| point.forces.drawbar_pull)),
                number(point.map(|point| point.forces.torque)),
                number(
                    point
                        .and_then(|p| p.tractive_efficiency())
                        .map(|share| 100.0 * share),
                ),
                answer.status.key().to_owned(),
            ]);
        }
    }
    table.render()
}

/// What all points of the run share.
struct Frame<'a> {
    arguments: &'a Arguments,
    pair: &'a WheelOnSoil,
    soil: &'a str,
}

impl Frame<'_> {
    /// The columns of `batch`.
    fn write_csv(&self, mut file: OutputFile, families: &[Family]) -> Result<String> {
        use std::io::Write as _;
        let path = file.path().to_owned();
        let mut lines = String::from(
            "soil,radius_m,width_m,rebound,slip,sinkage_m,load_n,vertical_force_n,drawbar_pull_n,torque_nm,status\n",
        );
        let wheel = &self.arguments.wheel;
        let shared = [
            wheel.radius_m,
            wheel.width_m,
            self.pair.soil().params().rebound,
        ]
        .map(short);
        for family in families {
            for (slip, answer) in &family.points {
                let load = match family.asked {
                    Asked::Load(load) => short(load),
                    Asked::Sinkage(_) => String::new(),
                };
                let point = answer.point.as_ref();
                let number = |value: Option<f64>| value.map_or_else(String::new, exact);
                let _ = writeln!(
                    lines,
                    "{},{},{},{},{},{},{},{},{}",
                    crate::csv_line::field(self.soil),
                    shared.join(","),
                    short(*slip),
                    number(point.map(|point| point.sinkage)),
                    load,
                    number(point.map(|point| point.forces.vertical_force)),
                    number(point.map(|point| point.forces.drawbar_pull)),
                    number(point.map(|point| point.forces.torque)),
                    answer.status.key()
                );
            }
        }
        file.write_all(lines.as_bytes())
            .map_err(|error| Error::file("write", &path, &error))?;
        file.finish()?;
        Ok(format!("wrote {}\n", shown_path(&path)))
    }

    fn object(&self, families: &[Family]) -> Object {
        let wheel = &self.arguments.wheel;
        [
            ("soil", Value::from(self.soil)),
            ("radius_m", Value::from(wheel.radius_m)),
            ("width_m", Value::from(wheel.width_m)),
            ("rebound", Value::from(self.pair.soil().params().rebound)),
            ("slip_angle_deg", Value::from(wheel.slip_angle_deg)),
            ("curves", families.iter().map(curve_object).collect()),
        ]
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
    }
}

fn curve_object(family: &Family) -> Value {
    let points = family.points.iter().map(|(slip, answer)| {
        let mut object = Object::from_iter([("slip".to_owned(), Value::from(*slip))]);
        object.extend(answer.object());
        Value::Object(object)
    });
    let best = |best: Option<BestSlip>, key: &str| {
        Value::from(best.map(|best| {
            Object::from_iter([
                ("slip".to_owned(), Value::from(best.slip.value())),
                (key.to_owned(), Value::from(best.value)),
            ])
        }))
    };
    let load = match family.asked {
        Asked::Load(load) => Some(load),
        Asked::Sinkage(_) => None,
    };
    Object::from_iter(
        [
            ("load_n", Value::from(load)),
            ("most_pull", best(family.most_pull, "drawbar_pull_n")),
            (
                "most_efficient",
                best(family.most_efficient, "tractive_efficiency"),
            ),
            ("points", points.collect()),
        ]
        .map(|(key, value)| (key.to_owned(), value)),
    )
    .into()
}
