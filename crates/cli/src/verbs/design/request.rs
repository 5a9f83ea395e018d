//! The request to `design`: flags, the mission file behind them, and defaults.

use std::ffi::OsStr;
use std::str::FromStr;

use grouser_design::mission::{
    self, Choice, FrontSettings, MissionFile, MissionParams, SlopeShare, SoilMeasure, SoilShare,
    WheelRanges,
};
use grouser_files::Document;
use grouser_files::soil::names_file;
use grouser_report::number::{parse_finite, shown};

use super::Arguments;
use super::carrier::Carrier;
use crate::error::{Error, Result};
use crate::output::OutputFile;
use crate::session::Session;
use crate::soil_choice::{self, Overrides};

/// Bounds of the radius and of the width where none are given, over the present size.
const RADIUS_FACTORS: (f64, f64) = (0.6, 1.5);
const WIDTH_FACTORS: (f64, f64) = (0.5, 2.0);

/// Wheels keep this share of the distance at which they would touch.
const CLEARANCE_SHARE: f64 = 0.98;

/// Thickness of a new lug where none is given, m: that of the sheet in the default formula of the mass.
const LUG_THICKNESS_M: f64 = 0.002;

/// Something with its share of the way, if one is given.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shared<T>(pub(super) T, pub(super) Option<f64>);

pub(super) fn parse_soil(text: &str) -> std::result::Result<Shared<String>, String> {
    match text.rsplit_once('=') {
        Some((name, share)) => Ok(Shared(name.to_owned(), Some(parse_finite(share)?))),
        None => Ok(Shared(text.to_owned(), None)),
    }
}

pub(super) fn parse_slope(text: &str) -> std::result::Result<Shared<f64>, String> {
    match text.split_once('=') {
        Some((slope, share)) => Ok(Shared(parse_finite(slope)?, Some(parse_finite(share)?))),
        None => Ok(Shared(parse_finite(text)?, None)),
    }
}

/// `0.1:0.2`, or `0.1` for a size that is fixed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds(f64, f64);

impl FromStr for Bounds {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let number = |part: &str| {
            parse_finite(part).map_err(|_| "must be a number or bounds `from:to`".to_owned())
        };
        let (low, high) = text.split_once(':').unwrap_or((text, text));
        let (low, high) = (number(low)?, number(high)?);
        if low <= high {
            Ok(Self(low, high))
        } else {
            Err("must not fall from its first number to its second".to_owned())
        }
    }
}

#[derive(clap::ValueEnum, Clone, Copy, Debug)]
pub(crate) enum MeasureName {
    /// The worst soil
    Worst,
    /// The mean by the shares
    Mean,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug)]
pub(crate) enum ChoiceName {
    /// Where the front bends most
    Knee,
    /// The lightest wheel
    Lightest,
    /// The wheel of minimum energy
    LeastEnergy,
}

/// A mission, read but not yet put together with its robot.
pub(super) struct Request {
    /// What flags and the mission file give.
    pub(super) file: MissionFile,
    pub(super) soils: Vec<SoilShare>,
    /// Where the numbers of each soil come from.
    pub(super) sources: Vec<String>,
    pub(super) slopes: Vec<SlopeShare>,
}

/// What the flags give.
fn flags(arguments: &Arguments) -> MissionFile {
    let mut given = MissionFile::default();
    given.gravity = arguments.gravity.given();
    given.soils = arguments
        .soil
        .iter()
        .map(|soil| (soil.0.clone(), soil.1))
        .collect();
    given.slopes = arguments
        .slope_deg
        .iter()
        .map(|slope| (slope.0, slope.1))
        .collect();
    given.wheel = [
        arguments.radius_m,
        arguments.width_m,
        arguments.grouser_height_m,
        arguments.grouser_count,
        arguments
            .grouser_thickness_m
            .map(|fixed| Bounds(fixed, fixed)),
    ]
    .map(|bounds| bounds.map(|Bounds(low, high)| (low, high)));
    given.mass_shift = arguments.mass_shift_m.map(|Bounds(low, high)| (low, high));
    given.wheel_mass.clone_from(&arguments.wheel_mass_kg);
    given.measure = arguments.soil_measure.map(|measure| match measure {
        MeasureName::Worst => SoilMeasure::Worst,
        MeasureName::Mean => SoilMeasure::Mean,
    });
    given.min_reserve = arguments.min_reserve;
    given.max_slip = arguments.max_slip;
    given.points = arguments.points.map(usize::from);
    given.seed = arguments.seed;
    let choice = arguments.choice.map(|choice| match choice {
        ChoiceName::Knee => Choice::Knee,
        ChoiceName::Lightest => Choice::Lightest,
        ChoiceName::LeastEnergy => Choice::LeastEnergy,
    });
    given.choice = arguments.max_wheel_mass_kg.map(Choice::MaxMass).or(choice);
    given
}

pub(super) fn read(arguments: &Arguments, session: &mut Session) -> Result<Request> {
    let mut file = flags(arguments);
    let by_flags = [!file.soils.is_empty(), !file.slopes.is_empty()];
    if let Some(path) = &arguments.mission {
        let document = Document::read(path)?;
        session.used_document(&document);
        file = file.or(mission::parse(&document)?);
    }
    for (is_missing, what, flag) in [
        (file.soils.is_empty(), "soil", "--soil KEY"),
        (file.slopes.is_empty(), "slope", "--slope-deg DEG"),
    ] {
        if is_missing {
            return Err(Error::usage(
                format!("the mission has no {what}"),
                format!("give `{flag}`, or [[{what}]] in a mission file"),
            ));
        }
    }
    // shares that no flag gives are those of the mission file
    let of_shares = |is_by_flag: bool, error: grouser_design::Error| {
        let error = Error::from(error);
        match &arguments.mission {
            Some(path) if !is_by_flag => error.in_file(path),
            _ => error,
        }
    };
    let (mut chosen, mut sources) = (Vec::new(), Vec::new());
    let is_single = file.soils.len() == 1;
    for (name, share) in mission::shares("soils", file.soils.clone())
        .map_err(|error| of_shares(by_flags[0], error))?
    {
        let one = soil_choice::choose(OsStr::new(&name), &arguments.overrides)?;
        // The provenance has room for one soil; several are listed with their sources in the result.
        if is_single {
            one.note(&arguments.overrides, session);
        } else if let Some(document) = &one.document {
            session.used_document(document);
        }
        sources.push(one.source);
        chosen.push(SoilShare {
            name: one.name,
            soil: one.soil,
            share,
        });
    }
    let slopes = mission::shares("slopes", file.slopes.clone())
        .map_err(|error| of_shares(by_flags[1], error))?;
    Ok(Request {
        soils: chosen,
        sources,
        slopes: slopes
            .into_iter()
            .map(|(slope_deg, share)| SlopeShare { slope_deg, share })
            .collect(),
        file,
    })
}

impl Request {
    /// The mission's text, as `output` will hold it.
    ///
    /// # Errors
    /// Where flags complete a soil, which a mission file does not hold.
    pub(super) fn toml(&self, overrides: &Overrides, output: &OutputFile) -> Result<String> {
        if let Some((flag, _)) = overrides.given().next() {
            return Err(Error::usage(
                format!(
                    "a mission file holds no soil that `--{}` completes",
                    flag.replace('_', "-")
                ),
                "write the whole soil to a file and name that: `grouser init soil -o soil.toml`",
            ));
        }
        let mut file = self.file.clone();
        for (name, _) in &mut file.soils {
            if names_file(name.as_ref()) {
                *name = output.reaches(name.as_ref()).display().to_string();
            }
        }
        Ok(mission::to_toml(&file, &[]))
    }

    /// The bounds of the wheel: flags, the mission file, or around the present one.
    pub(super) fn ranges(&self, carrier: &Carrier) -> Result<WheelRanges> {
        let present = &carrier.present;
        let [radius, width, height, count, thickness] = self.file.wheel;
        let mut ranges = WheelRanges::fixed(present);
        ranges.grouser_height = height.unwrap_or(ranges.grouser_height);
        ranges.grouser_count = count.unwrap_or(ranges.grouser_count);
        if ranges.grouser_count.1 > 0.0 && present.grouser_count == 0.0 {
            ranges.grouser_thickness = (LUG_THICKNESS_M, LUG_THICKNESS_M);
        }
        ranges.grouser_thickness = thickness.unwrap_or(ranges.grouser_thickness);
        if ranges.grouser_count.1 == 0.0 {
            if ranges.grouser_height.1 > 0.0 && height.is_some() {
                return Err(Error::usage(
                    "lugs have a height, but no number",
                    "give `--grouser-count FROM:TO` too",
                ));
            }
            (ranges.grouser_height, ranges.grouser_thickness) = ((0.0, 0.0), (0.0, 0.0));
        }
        let room = CLEARANCE_SHARE * carrier.touching_radius(ranges.grouser_height.1);
        ranges.radius = radius.unwrap_or_else(|| {
            let high = (RADIUS_FACTORS.1 * present.radius).min(room);
            let low = RADIUS_FACTORS.0 * present.radius;
            (low.min(high), high)
        });
        ranges.mass_shift = self.file.mass_shift.unwrap_or((0.0, 0.0));
        let (back, front) = carrier.shift_limits();
        if ranges.mass_shift.0 < back || ranges.mass_shift.1 > front {
            return Err(Error::usage(
                format!(
                    "`mass_shift_m` is {} to {} m, but must be within {} to {} m",
                    shown(ranges.mass_shift.0),
                    shown(ranges.mass_shift.1),
                    shown(back),
                    shown(front)
                ),
                "beyond the outermost wheels the robot tips over",
            ));
        }
        ranges.width = width.unwrap_or((
            WIDTH_FACTORS.0 * present.width,
            WIDTH_FACTORS.1 * present.width,
        ));
        Ok(ranges)
    }

    /// The radius from which wheels touch each other, if the bounds allow it.
    pub(super) fn touching_radius(carrier: &Carrier, ranges: &WheelRanges) -> Option<f64> {
        let limit = carrier.touching_radius(ranges.grouser_height.1);
        (ranges.radius.1 > limit).then_some(limit)
    }

    pub(super) fn complete(&self, params: &mut MissionParams) {
        let file = &self.file;
        if let Some(formula) = &file.wheel_mass {
            params.mass_formula.clone_from(formula);
            "wheel_mass_kg".clone_into(&mut params.mass_place);
        }
        params.measure = file.measure.unwrap_or(params.measure);
        params.min_reserve = file.min_reserve.unwrap_or(params.min_reserve);
        params.max_slip = file.max_slip.unwrap_or(params.max_slip);
    }

    pub(super) fn settings(&self, settings: &mut FrontSettings) {
        let file = &self.file;
        settings.choice = file.choice.unwrap_or(settings.choice);
        settings.points = file.points.unwrap_or(settings.points);
        settings.seed = file.seed.unwrap_or(settings.seed);
    }
}
