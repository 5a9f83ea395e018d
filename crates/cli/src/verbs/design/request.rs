//! The request to `design`: flags, the mission file behind them, and defaults.

use std::ffi::OsStr;
use std::str::FromStr;

use grouser_design::mission::{
    self, Choice, FrontSettings, MissionFile, MissionParams, SlopeShare, SoilMeasure, SoilShare,
    WheelRanges,
};
use grouser_files::Document;
use grouser_report::number::parse_finite;

use super::Arguments;
use super::carrier::Carrier;
use crate::error::{Error, Result};
use crate::session::Session;
use crate::soil_choice;

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
    /// The wheel of least energy
    LeastEnergy,
}

/// A mission, read but not yet put together with its robot.
pub(super) struct Request<'a> {
    arguments: &'a Arguments,
    file: MissionFile,
    /// Gravity of the mission file, m/s².
    pub(super) gravity: Option<f64>,
    pub(super) soils: Vec<SoilShare>,
    /// Where the numbers of each soil come from.
    pub(super) sources: Vec<String>,
    pub(super) slopes: Vec<SlopeShare>,
}

pub(super) fn read<'a>(arguments: &'a Arguments, session: &mut Session) -> Result<Request<'a>> {
    let file = match &arguments.mission {
        None => MissionFile::default(),
        Some(path) => {
            let document = Document::read(path)?;
            session.used_document(&document);
            mission::parse(&document)?
        }
    };
    let soils = if arguments.soil.is_empty() {
        file.soils.clone()
    } else {
        let given = arguments.soil.iter();
        given.map(|soil| (soil.0.clone(), soil.1)).collect()
    };
    let slopes = if arguments.slope_deg.is_empty() {
        file.slopes.clone()
    } else {
        arguments.slope_deg.iter().map(|s| (s.0, s.1)).collect()
    };
    for (is_missing, what, flag) in [
        (soils.is_empty(), "soil", "--soil KEY"),
        (slopes.is_empty(), "slope", "--slope-deg DEG"),
    ] {
        if is_missing {
            return Err(Error::usage(
                format!("the mission has no {what}"),
                format!("give `{flag}`, or [[{what}]] in a mission file"),
            ));
        }
    }
    let (mut chosen, mut sources) = (Vec::new(), Vec::new());
    let is_single = soils.len() == 1;
    for (name, share) in mission::shares("soils", soils)? {
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
    let slopes = mission::shares("slopes", slopes)?;
    Ok(Request {
        arguments,
        gravity: file.gravity,
        soils: chosen,
        sources,
        slopes: slopes
            .into_iter()
            .map(|(slope_deg, share)| SlopeShare { slope_deg, share })
            .collect(),
        file,
    })
}

impl Request<'_> {
    /// The bounds of the wheel: flags, the mission file, or around the present one.
    pub(super) fn ranges(&self, carrier: &Carrier) -> Result<WheelRanges> {
        let (arguments, present) = (self.arguments, &carrier.present);
        let given = |place: usize, flag: Option<Bounds>| {
            let flag = flag.map(|Bounds(low, high)| (low, high));
            flag.or(self.file.wheel[place])
        };
        let height = given(2, arguments.grouser_height_m);
        let count = given(3, arguments.grouser_count);
        let thickness = arguments.grouser_thickness_m.map(|t| (t, t));
        let mut ranges = WheelRanges::fixed(present);
        ranges.grouser_height = height.unwrap_or(ranges.grouser_height);
        ranges.grouser_count = count.unwrap_or(ranges.grouser_count);
        if ranges.grouser_count.1 > 0.0 && present.grouser_count == 0.0 {
            ranges.grouser_thickness = (LUG_THICKNESS_M, LUG_THICKNESS_M);
        }
        ranges.grouser_thickness = thickness
            .or(self.file.wheel[4])
            .unwrap_or(ranges.grouser_thickness);
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
        ranges.radius = given(0, arguments.radius_m).unwrap_or_else(|| {
            let high = (RADIUS_FACTORS.1 * present.radius).min(room);
            let low = RADIUS_FACTORS.0 * present.radius;
            (low.min(high), high)
        });
        ranges.width = given(1, arguments.width_m).unwrap_or((
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
        let (arguments, file) = (self.arguments, &self.file);
        if let Some(formula) = &arguments.wheel_mass_kg {
            params.mass_formula.clone_from(formula);
            "--wheel-mass-kg".clone_into(&mut params.mass_place);
        } else if let Some(formula) = &file.wheel_mass {
            params.mass_formula.clone_from(formula);
            "wheel_mass_kg of the mission file".clone_into(&mut params.mass_place);
        }
        let measure = arguments.soil_measure.map(|measure| match measure {
            MeasureName::Worst => SoilMeasure::Worst,
            MeasureName::Mean => SoilMeasure::Mean,
        });
        params.measure = measure.or(file.measure).unwrap_or(params.measure);
        let reserve = arguments.min_reserve.or(file.min_reserve);
        params.min_reserve = reserve.unwrap_or(params.min_reserve);
        let slip = arguments.max_slip.or(file.max_slip);
        params.max_slip = slip.unwrap_or(params.max_slip);
    }

    pub(super) fn settings(&self, settings: &mut FrontSettings) {
        let (arguments, file) = (self.arguments, &self.file);
        let choice = arguments.choice.map(|choice| match choice {
            ChoiceName::Knee => Choice::Knee,
            ChoiceName::Lightest => Choice::Lightest,
            ChoiceName::LeastEnergy => Choice::LeastEnergy,
        });
        let limit = arguments.max_wheel_mass_kg.map(Choice::MaxMass);
        let chosen = limit.or(choice).or(file.choice);
        settings.choice = chosen.unwrap_or(settings.choice);
        let points = arguments.points.map(usize::from).or(file.points);
        settings.points = points.unwrap_or(settings.points);
        settings.seed = arguments.seed.or(file.seed).unwrap_or(settings.seed);
    }
}
