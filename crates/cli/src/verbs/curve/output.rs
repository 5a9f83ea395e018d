//! What `curve` tells: text, a table, JSON.

use std::collections::BTreeMap;
use std::fmt::Write as _; // writing to a string cannot fail

use grouser_terra::{BestSlip, Caution, OperatingPoint, WheelOnSoil};
use serde_json::Value;

use super::Family;
use crate::csv_line::field;
use crate::operation::Asked;
use crate::report::Object;
use crate::wheel_choice::WheelArguments;
use grouser_report::Table;
use grouser_report::number::{exact, short, shown};

/// What is worth knowing of a curve, in a line.
pub(super) fn summary(family: &Family) -> String {
    let mut text = String::new();
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
    let mut cautions: BTreeMap<Caution, u32> = BTreeMap::new();
    for point in family
        .points
        .iter()
        .filter_map(|(_, answer)| answer.point.as_ref())
    {
        for caution in point.cautions.iter() {
            *cautions.entry(caution).or_default() += 1;
        }
    }
    for (caution, count) in cautions {
        let _ = writeln!(text, "caution at {count} points: {caution}");
    }
    text
}

/// All points, for people.
pub(super) fn table(families: &[Family]) -> String {
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
                        .and_then(OperatingPoint::tractive_efficiency)
                        .map(|share| 100.0 * share),
                ),
                answer.status.key().to_owned(),
            ]);
        }
    }
    table.render()
}

/// What all points of the run share.
pub(super) struct Frame<'a> {
    pub(super) wheel: &'a WheelArguments,
    pub(super) pair: &'a WheelOnSoil,
    pub(super) soil: &'a str,
}

impl Frame<'_> {
    /// All points, with the columns of `batch`.
    pub(super) fn csv(&self, families: &[Family]) -> String {
        let mut lines = String::from(
            "soil,radius_m,width_m,rebound,slip,sinkage_m,load_n,vertical_force_n,drawbar_pull_n,torque_nm,status\n",
        );
        let rebound = self.pair.soil().params().rebound;
        let shared = [self.wheel.radius_m, self.wheel.width_m, rebound].map(short);
        for family in families {
            let load = family.asked.load().map_or_else(String::new, short);
            for (slip, answer) in &family.points {
                let point = answer.point.as_ref();
                let number = |value: Option<f64>| value.map_or_else(String::new, exact);
                let _ = writeln!(
                    lines,
                    "{},{},{},{},{load},{},{},{},{}",
                    field(self.soil),
                    shared.join(","),
                    short(*slip),
                    number(point.map(|point| point.sinkage)),
                    number(point.map(|point| point.forces.vertical_force)),
                    number(point.map(|point| point.forces.drawbar_pull)),
                    number(point.map(|point| point.forces.torque)),
                    answer.status.key()
                );
            }
        }
        lines
    }

    /// `curves` has one entry for each load or sinkage, `points` all points of all of them.
    pub(super) fn object(&self, families: &[Family]) -> Object {
        let points = families.iter().flat_map(|family| {
            family.points.iter().map(|(slip, answer)| {
                let mut object = Object::from_iter([
                    ("slip".to_owned(), Value::from(*slip)),
                    ("load_n".to_owned(), Value::from(family.asked.load())),
                ]);
                object.extend(answer.object());
                Value::Object(object)
            })
        });
        [
            ("soil", Value::from(self.soil)),
            ("radius_m", Value::from(self.wheel.radius_m)),
            ("width_m", Value::from(self.wheel.width_m)),
            ("rebound", Value::from(self.pair.soil().params().rebound)),
            ("slip_angle_deg", Value::from(self.wheel.slip_angle_deg)),
            ("curves", families.iter().map(curve).collect()),
            ("points", points.collect()),
        ]
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value))
        .collect()
    }
}

fn curve(family: &Family) -> Value {
    let best = |best: Option<BestSlip>, key: &str| {
        Value::from(best.map(|best| {
            Object::from_iter([
                ("slip".to_owned(), Value::from(best.slip.value())),
                (key.to_owned(), Value::from(best.value)),
            ])
        }))
    };
    let sinkage = match family.asked {
        Asked::Load(_) => None,
        Asked::Sinkage(sinkage) => Some(sinkage),
    };
    Object::from_iter(
        [
            ("load_n", Value::from(family.asked.load())),
            ("sinkage_m", Value::from(sinkage)),
            ("most_pull", best(family.most_pull, "drawbar_pull_n")),
            (
                "most_efficient",
                best(family.most_efficient, "tractive_efficiency"),
            ),
        ]
        .map(|(key, value)| (key.to_owned(), value)),
    )
    .into()
}
