//! The columns of `batch`: the operating point of a row, and the row with its result.

use std::borrow::Cow;
use std::path::Path;

use super::stream::Line;
use crate::error::{Error, Result};
use crate::operation::Prescribed;
use grouser_files::{is_quantity_name, nearest};
use grouser_log::csv::{Field, quoted, split};
use grouser_report::number::{parse_finite, push_exact};

/// The columns that are added, in order; the side force only beside a column of slip angles, the fluctuations as
/// lugs pass only beside columns of lugs.
const ADDED: [&str; 7] = [
    "vertical_force_n",
    "drawbar_pull_n",
    "torque_nm",
    SIDE_FORCE,
    PULL_FLUCTUATION,
    TORQUE_FLUCTUATION,
    "status",
];
const SIDE_FORCE: &str = "side_force_n";
const PULL_FLUCTUATION: &str = "pull_fluctuation_n";
const TORQUE_FLUCTUATION: &str = "torque_fluctuation_nm";

/// The columns that are read.
const READ: [&str; 11] = [
    "soil",
    "radius_m",
    "width_m",
    "slip",
    "slip_angle_deg",
    "rebound",
    "sinkage_m",
    "load_n",
    "grouser_height_m",
    "grouser_count",
    "grouser_thickness_m",
];

/// Numbers of a soil, which come from the soil itself.
const OF_THE_SOIL: [&str; 12] = [
    "n",
    "n_1",
    "n_2",
    "c_1",
    "c_2",
    "k_c_kn_per_m_n1",
    "k_phi_kn_per_m_n2",
    "cohesion_kpa",
    "phi_deg",
    "k_shear_m",
    "unit_weight_n_per_m3",
    "transport_layer_m",
];

/// Why a column that is not read must not be ignored: to ignore it would give a result for another wheel; `None`
/// where it may.
fn refusal(name: &str) -> Option<String> {
    if READ.contains(&name) || ADDED.contains(&name) {
        return None;
    }
    if OF_THE_SOIL.contains(&name) {
        return Some("numbers of a soil come from the soil: name a soil file in `soil`".to_owned());
    }
    is_quantity_name(name).then(|| {
        let meant = nearest(&name.to_lowercase().replace(['-', ' '], "_"), READ)
            .map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
        format!(
            "{meant}read are `{}`; rename a column that is only a remark, as `note_…` or `measured_…`",
            READ.join("`, `")
        )
    })
}

/// Where the columns of the input stand.
#[derive(Debug)]
pub(super) struct Columns {
    /// The header's line.
    header: String,
    /// Its fields.
    names: Vec<String>,
    soil: usize,
    radius: usize,
    width: usize,
    slip: usize,
    slip_angle: Option<usize>,
    rebound: Option<usize>,
    sinkage: Option<usize>,
    load: Option<usize>,
    grouser_height: Option<usize>,
    grouser_count: Option<usize>,
    grouser_thickness: Option<usize>,
}

/// The operating point of a row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Point<'a> {
    pub(super) soil: Cow<'a, str>,
    pub(super) radius_m: f64,
    pub(super) width_m: f64,
    /// Height (m), number and thickness (m) of the lugs; `None` for a smooth wheel.
    pub(super) grousers: Option<[f64; 3]>,
    /// `None`: as the soil has it.
    pub(super) rebound: Option<f64>,
    pub(super) slip: f64,
    pub(super) slip_angle_deg: f64,
    pub(super) prescribed: Prescribed,
}

/// What is written of a solved row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbers {
    pub(super) sinkage: f64,
    /// Vertical force (N), drawbar pull (N) and torque (N m).
    pub(super) forces: [f64; 3],
    /// Side force, N.
    pub(super) side: f64,
    /// Fluctuation of pull (N) and torque (N m) as lugs pass; `None` for a smooth wheel.
    pub(super) fluctuation: Option<[f64; 2]>,
}

/// A row: its line with its fields, and its operating point or what is wrong.
#[derive(Debug)]
pub(super) struct Row<'a> {
    line: &'a str,
    fields: Vec<Field>,
    /// The whole line as the first field, where it has no fields.
    whole: Option<Cow<'a, str>>,
    pub(super) point: Result<Point<'a>, String>,
}

impl Columns {
    /// Reads the header.
    pub(super) fn read(header: Option<Line>, path: &Path) -> Result<Self> {
        let refuse = |message: String, hint: Option<&str>| {
            Error::content(path, message, hint.map(str::to_owned))
        };
        let Some(line) = header else {
            return Err(refuse("line 1: the file is empty".to_owned(), None));
        };
        if !line.is_text {
            return Err(refuse("line 1: the header is not UTF-8".to_owned(), None));
        }
        let mut fields = Vec::new();
        split(&line.text, b',', &mut fields).map_err(|bad| {
            refuse(
                format!("line 1: column {} {}", bad.field + 1, bad.what),
                None,
            )
        })?;
        let names: Vec<String> = fields
            .iter()
            .map(|field| field.value(&line.text).into_owned())
            .collect();
        let find = |name: &str| -> Result<Option<usize>> {
            let mut places = (0..names.len()).filter(|index| names[*index] == name);
            let place = places.next();
            match places.next() {
                Some(second) => Err(refuse(
                    format!(
                        "line 1: column {} is `{name}`, as is an earlier one",
                        second + 1
                    ),
                    None,
                )),
                None => Ok(place),
            }
        };
        let need = |name: &str| {
            find(name)?.ok_or_else(|| {
                let hint = if line.text.contains(';') && !line.text.contains(',') {
                    "columns are separated by commas, not by `;`"
                } else {
                    "needed are `soil`, `radius_m`, `width_m`, `slip`, and `sinkage_m` or `load_n`"
                };
                refuse(format!("line 1: there is no column `{name}`"), Some(hint))
            })
        };
        let columns = Self {
            soil: need("soil")?,
            radius: need("radius_m")?,
            width: need("width_m")?,
            slip: need("slip")?,
            slip_angle: find("slip_angle_deg")?,
            rebound: find("rebound")?,
            sinkage: find("sinkage_m")?,
            load: find("load_n")?,
            grouser_height: find("grouser_height_m")?,
            grouser_count: find("grouser_count")?,
            grouser_thickness: find("grouser_thickness_m")?,
            header: line.text.clone(),
            names: names.clone(),
        };
        if let Some((name, hint)) = names.iter().find_map(|n| Some((n, refusal(n)?))) {
            let message = format!("line 1: column `{name}` is a quantity that is not read");
            return Err(refuse(message, Some(&hint)));
        }
        if columns.sinkage.is_none() && columns.load.is_none() {
            let message = "line 1: there is neither a column `sinkage_m` nor a column `load_n`";
            return Err(refuse(message.to_owned(), None));
        }
        let lugs = [columns.grouser_height, columns.grouser_count];
        let thickness = columns.grouser_thickness;
        if lugs.iter().flatten().count() == 1 || (lugs == [None; 2] && thickness.is_some()) {
            let message = "line 1: lugs need both columns `grouser_height_m` and `grouser_count`";
            return Err(refuse(message.to_owned(), None));
        }
        Ok(columns)
    }

    /// The header of the completed table.
    pub(super) fn header(&self) -> String {
        let mut line = self.header.clone();
        if self.sinkage.is_none() {
            line.push_str(",sinkage_m");
        }
        for name in self.added() {
            line.push(',');
            line.push_str(name);
        }
        line.push('\n');
        line
    }

    /// The columns that are added.
    fn added(&self) -> impl Iterator<Item = &'static str> {
        let (drifting, lugged) = (self.slip_angle.is_some(), self.grouser_height.is_some());
        ADDED.into_iter().filter(move |name| match *name {
            SIDE_FORCE => drifting,
            PULL_FLUCTUATION | TORQUE_FLUCTUATION => lugged,
            _ => true,
        })
    }

    /// What the user should know of the header.
    pub(super) fn warnings(&self) -> Vec<String> {
        let there = |name: &&str| self.names.iter().any(|own| own == name);
        let warning = |name: &str| {
            format!("column `{name}` was there already; the one that was added is the last")
        };
        self.added()
            .filter(|name| there(name))
            .map(warning)
            .collect()
    }

    /// Reads a row.
    pub(super) fn row<'a>(&self, line: &'a Line) -> Row<'a> {
        let mut fields = Vec::with_capacity(self.names.len());
        let read = if line.is_text {
            split(&line.text, b',', &mut fields)
                .map_err(|bad| format!("field {} {}", bad.field + 1, bad.what))
        } else {
            Err("the row is not UTF-8".to_owned())
        };
        let wanted = self.names.len();
        // without fields the line is one field, so that the output stays a table
        let whole = read.is_err().then(|| quoted(&line.text));
        let point = match read {
            Ok(()) if fields.len() == wanted => self.point(&line.text, &fields),
            Ok(()) => Err(format!(
                "{} fields, but the header has {wanted}",
                fields.len()
            )),
            Err(broken) => Err(broken),
        };
        Row {
            line: &line.text,
            fields,
            whole,
            point,
        }
    }

    fn point<'a>(&self, line: &'a str, fields: &[Field]) -> Result<Point<'a>, String> {
        let number = |index: usize, name: &str| {
            let text = fields[index].value(line);
            parse_finite(&text).map_err(|reason| {
                if text.is_empty() {
                    format!("`{name}` is empty")
                } else {
                    format!("`{name}` is `{text}`, but {reason}")
                }
            })
        };
        let filled = |index: &usize| !fields[*index].value(line).is_empty();
        let sinkage = self.sinkage.filter(filled);
        let load = self.load.filter(filled);
        let prescribed = match (sinkage, load) {
            (Some(index), None) => Prescribed::Sinkage(number(index, "sinkage_m")?),
            (None, Some(index)) => Prescribed::Load(number(index, "load_n")?),
            (Some(_), Some(_)) => {
                return Err(
                    "both `sinkage_m` and `load_n` are filled, but exactly one must be".to_owned(),
                );
            }
            (None, None) => {
                return Err(
                    "neither `sinkage_m` nor `load_n` is filled, but exactly one must be"
                        .to_owned(),
                );
            }
        };
        let rebound = self
            .rebound
            .filter(filled)
            .map(|index| number(index, "rebound"));
        let slip_angle = self
            .slip_angle
            .filter(filled)
            .map(|index| number(index, "slip_angle_deg"));
        let optional = |index: Option<usize>, name: &str| {
            let filled = index.filter(filled);
            filled.map_or(Ok(0.0), |index| number(index, name))
        };
        let height = optional(self.grouser_height, "grouser_height_m")?;
        let incomplete = [self.grouser_count, self.grouser_thickness];
        if self.grouser_height.is_some_and(|index| !filled(&index))
            && incomplete.iter().flatten().any(filled)
        {
            return Err(
                "`grouser_height_m` is empty, but other sizes of the lugs are not".to_owned(),
            );
        }
        let grousers = if height == 0.0 {
            None
        } else {
            Some([
                height,
                optional(self.grouser_count, "grouser_count")?,
                optional(self.grouser_thickness, "grouser_thickness_m")?,
            ])
        };
        Ok(Point {
            grousers,
            soil: fields[self.soil].value(line),
            radius_m: number(self.radius, "radius_m")?,
            width_m: number(self.width, "width_m")?,
            rebound: rebound.transpose()?,
            slip: number(self.slip, "slip")?,
            slip_angle_deg: slip_angle.transpose()?.unwrap_or(0.0),
            prescribed,
        })
    }

    /// Appends the row with its sinkage and forces, as a line. Numbers that there are not stay empty.
    pub(super) fn push_line(
        &self,
        text: &mut String,
        row: &Row<'_>,
        numbers: Option<Numbers>,
        status: &str,
    ) {
        let sinkage = numbers.map(|of| of.sinkage);
        let push = |text: &mut String, number: Option<f64>| {
            if let Some(number) = number {
                push_exact(text, number);
            }
        };
        for index in 0..self.names.len() {
            if index > 0 {
                text.push(',');
            }
            match (&row.whole, row.fields.get(index)) {
                (Some(whole), _) if index == 0 => text.push_str(whole),
                (None, Some(field))
                    if Some(index) != self.sinkage || !field.value(row.line).is_empty() =>
                {
                    text.push_str(field.raw(row.line));
                }
                _ if Some(index) == self.sinkage => push(text, sinkage),
                _ => {}
            }
        }
        if self.sinkage.is_none() {
            text.push(',');
            push(text, sinkage);
        }
        for index in 0..3 {
            text.push(',');
            push(text, numbers.map(|of| of.forces[index]));
        }
        if self.slip_angle.is_some() {
            text.push(',');
            push(text, numbers.map(|of| of.side));
        }
        if self.grouser_height.is_some() {
            for index in 0..2 {
                text.push(',');
                push(text, numbers.and_then(|of| Some(of.fluctuation?[index])));
            }
        }
        text.push(',');
        text.push_str(&quoted(status));
        text.push('\n');
    }
}
