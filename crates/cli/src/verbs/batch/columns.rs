//! The columns of `batch`: the operating point of a row, and the row with its result.

use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;

use super::stream::Line;
use crate::error::{Error, Result};
use grouser_files::soil::SoilNumber;
use grouser_files::{is_quantity_name, nearest};
use grouser_log::csv::{Field, quoted, split};
use grouser_report::number::{parse_finite, parse_plain, push_exact};
use grouser_terra::{Cautions, Prescribed};

/// The columns that are added, in order; the side force only beside a column of slip angles, the fluctuations as
/// lugs pass only beside columns of lugs.
const ADDED: [&str; 8] = [
    "vertical_force_n",
    "drawbar_pull_n",
    "torque_nm",
    SIDE_FORCE,
    PULL_FLUCTUATION,
    TORQUE_FLUCTUATION,
    "status",
    "cautions",
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

/// Numbers of a soil that a row may have of its own.
pub(super) const SOIL_NUMBERS: [SoilNumber; 8] = [
    SoilNumber::KC,
    SoilNumber::KPhi,
    SoilNumber::Exponent,
    SoilNumber::Cohesion,
    SoilNumber::Phi,
    SoilNumber::KShear,
    SoilNumber::C1,
    SoilNumber::C2,
];

/// Numbers of a soil that only the soil itself has.
const OF_THE_SOIL: [&str; 4] = ["n_1", "n_2", "unit_weight_n_per_m3", "transport_layer_m"];

/// Why a column that is not read must not be ignored: to ignore it would give a result for another wheel; `None`
/// where it may.
fn refusal(name: &str) -> Option<String> {
    let is_soil_number = |name| SOIL_NUMBERS.iter().any(|number| number.key() == name);
    if READ.contains(&name) || ADDED.contains(&name) || is_soil_number(name) {
        return None;
    }
    if OF_THE_SOIL.contains(&name) {
        return Some("this number comes from the soil: name a soil file in `soil`".to_owned());
    }
    is_quantity_name(name).then(|| {
        let read = READ.into_iter().chain(SOIL_NUMBERS.map(SoilNumber::key));
        let meant = nearest(&name.to_lowercase().replace(['-', ' '], "_"), read)
            .map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
        format!(
            "{meant}read are `{}` and, of the soil, `{}`; rename a column that is only a remark, as `note_…` or \
             `measured_…`",
            READ.join("`, `"),
            SOIL_NUMBERS.map(SoilNumber::key).join("`, `")
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
    /// Of [`SOIL_NUMBERS`].
    soil_numbers: [Option<usize>; SOIL_NUMBERS.len()],
}

/// Numbers of a soil that a row has of its own, SI, in the order of [`SOIL_NUMBERS`].
pub(super) type SoilNumbers = [Option<f64>; SOIL_NUMBERS.len()];

/// The operating point of a row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Point<'a> {
    pub(super) soil: Cow<'a, str>,
    pub(super) soil_numbers: SoilNumbers,
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
    /// What to keep in mind.
    pub(super) cautions: Cautions,
}

/// A row: its line, and its operating point or what is wrong.
#[derive(Debug)]
pub(super) struct Row<'a> {
    line: Line<'a>,
    layout: Layout,
    pub(super) point: Result<Point<'a>, String>,
}

/// Where the sinkage goes in a row's line.
#[derive(Debug)]
enum Layout {
    /// The line is complete, but for a column that is added.
    Whole,
    /// In these bytes of the line, which hold nothing.
    Empty(Range<usize>),
    /// The line has not the fields of the header.
    Broken,
}

/// The columns of a soil's numbers.
fn find_all(
    find: &impl Fn(&str) -> Result<Option<usize>>,
) -> Result<[Option<usize>; SOIL_NUMBERS.len()]> {
    let mut places = [None; SOIL_NUMBERS.len()];
    for (place, number) in places.iter_mut().zip(SOIL_NUMBERS) {
        *place = find(number.key())?;
    }
    Ok(places)
}

impl Columns {
    /// Which of a soil's numbers have a column.
    pub(super) fn has_soil_numbers(&self) -> [bool; SOIL_NUMBERS.len()] {
        self.soil_numbers.map(|place| place.is_some())
    }

    /// Reads the header.
    pub(super) fn read(header: Option<Line<'_>>, path: &Path) -> Result<Self> {
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
        split(line.text, b',', &mut fields).map_err(|bad| {
            refuse(
                format!("line 1: column {} {}", bad.field + 1, bad.what),
                None,
            )
        })?;
        let names: Vec<String> = fields
            .iter()
            .map(|field| field.value(line.text).into_owned())
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
                // `radius_mm` for `radius_m`
                let stem = name.rsplit_once('_').map_or(name, |(stem, _)| stem);
                let unit =
                    |other: &&String| other.rsplit_once('_').is_some_and(|(own, _)| own == stem);
                let other = names.iter().find(unit);
                let other = other.map_or(String::new(), |other| {
                    format!("; `{other}` is in another unit")
                });
                refuse(
                    format!("line 1: there is no column `{name}`{other}"),
                    Some(hint),
                )
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
            soil_numbers: find_all(&find)?,
            header: line.text.to_owned(),
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

    /// Reads a row; `fields` is room for its fields.
    pub(super) fn row<'a>(&self, line: Line<'a>, fields: &mut Vec<Field>) -> Row<'a> {
        let read = if line.is_text {
            split(line.text, b',', fields)
                .map_err(|bad| format!("field {} {}", bad.field + 1, bad.what))
        } else {
            Err("the row is not UTF-8".to_owned())
        };
        let wanted = self.names.len();
        let (layout, point) = match read {
            Ok(()) if fields.len() == wanted => self.read_row(line.text, fields),
            Ok(()) => {
                let count = fields.len();
                let message = format!("{count} fields, but the header has {wanted}");
                (Layout::Broken, Err(message))
            }
            Err(broken) => (Layout::Broken, Err(broken)),
        };
        Row {
            line,
            layout,
            point,
        }
    }

    /// Where the sinkage of a row goes, and its operating point.
    fn read_row<'a>(&self, line: &'a str, fields: &[Field]) -> (Layout, Result<Point<'a>, String>) {
        let is_filled = |index: usize| !fields[index].value(line).is_empty();
        let has_sinkage = self.sinkage.is_some_and(is_filled);
        let layout = match self.sinkage {
            Some(index) if !has_sinkage => Layout::Empty(fields[index].place()),
            _ => Layout::Whole,
        };
        (layout, self.point(line, fields, has_sinkage))
    }

    fn point<'a>(
        &self,
        line: &'a str,
        fields: &[Field],
        has_sinkage: bool,
    ) -> Result<Point<'a>, String> {
        let is_filled = |index: usize| !fields[index].value(line).is_empty();
        let optional = |index: Option<usize>, name: &str| {
            let Some(field) = index.map(|index| fields[index]) else {
                return Ok(None);
            };
            // as most fields are
            if let Some(number) = parse_plain(field.text(line)) {
                return Ok(Some(number));
            }
            let text = field.value(line);
            if text.is_empty() {
                return Ok(None);
            }
            match parse_finite(&text) {
                Ok(number) => Ok(Some(number)),
                Err(reason) => Err(format!("`{name}` is `{text}`, but {reason}")),
            }
        };
        let required = |index: Option<usize>, name: &str| {
            optional(index, name)?.ok_or_else(|| format!("`{name}` is empty"))
        };
        let prescribed = match (has_sinkage, self.load.is_some_and(is_filled)) {
            (true, false) => Prescribed::Sinkage(required(self.sinkage, "sinkage_m")?),
            (false, true) => Prescribed::Load(required(self.load, "load_n")?),
            (true, true) => {
                return Err(
                    "both `sinkage_m` and `load_n` are filled, but exactly one must be".to_owned(),
                );
            }
            (false, false) => {
                return Err(
                    "neither `sinkage_m` nor `load_n` is filled, but exactly one must be"
                        .to_owned(),
                );
            }
        };
        let height = optional(self.grouser_height, "grouser_height_m")?;
        let other_sizes = [self.grouser_count, self.grouser_thickness];
        if height.is_none() && other_sizes.into_iter().flatten().any(is_filled) {
            return Err(
                "`grouser_height_m` is empty, but other sizes of the lugs are not".to_owned(),
            );
        }
        let count = optional(self.grouser_count, "grouser_count")?.unwrap_or(0.0);
        if count.fract() != 0.0 {
            return Err(format!(
                "`grouser_count` is {count}, but must be a whole number"
            ));
        }
        let grousers = match height {
            Some(height) if height != 0.0 => Some([
                height,
                count,
                optional(self.grouser_thickness, "grouser_thickness_m")?.unwrap_or(0.0),
            ]),
            _ => None,
        };
        let mut soil_numbers = [None; SOIL_NUMBERS.len()];
        if self.has_soil_numbers().contains(&true) {
            for ((found, place), number) in soil_numbers
                .iter_mut()
                .zip(self.soil_numbers)
                .zip(SOIL_NUMBERS)
            {
                *found = optional(place, number.key())?.map(|value| value * number.key_unit());
            }
        }
        Ok(Point {
            grousers,
            soil_numbers,
            soil: fields[self.soil].value(line),
            radius_m: required(Some(self.radius), "radius_m")?,
            width_m: required(Some(self.width), "width_m")?,
            rebound: optional(self.rebound, "rebound")?,
            slip: required(Some(self.slip), "slip")?,
            slip_angle_deg: optional(self.slip_angle, "slip_angle_deg")?.unwrap_or(0.0),
            prescribed,
        })
    }

    /// Appends the row with its sinkage and forces, as a line. Numbers that there are not stay empty; the
    /// status is a field as it is written.
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
        match &row.layout {
            Layout::Whole => text.push_str(row.line.text),
            Layout::Empty(place) => {
                text.push_str(&row.line.text[..place.start]);
                push(text, sinkage);
                text.push_str(&row.line.text[place.end..]);
            }
            Layout::Broken => self.push_broken(text, row.line),
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
        text.push_str(status);
        text.push(',');
        let mut gap = "";
        for caution in numbers.iter().flat_map(|of| of.cautions.iter()) {
            text.push_str(gap);
            text.push_str(caution.key());
            gap = " ";
        }
        text.push('\n');
    }

    /// Appends a line that has not the fields of the header as a row with as many: what is missing stays empty, what
    /// is too much is left out, and a line without fields is the first.
    fn push_broken(&self, text: &mut String, line: Line<'_>) {
        let mut fields = Vec::new();
        let is_split = line.is_text && split(line.text, b',', &mut fields).is_ok();
        for index in 0..self.names.len() {
            if index > 0 {
                text.push(',');
            }
            match fields.get(index) {
                Some(field) if is_split => {
                    let is_blank = field.value(line.text).is_empty();
                    if !(is_blank && Some(index) == self.sinkage) {
                        text.push_str(field.raw(line.text));
                    }
                }
                _ if index == 0 && !is_split => text.push_str(&quoted(line.text)),
                _ => {}
            }
        }
    }
}
