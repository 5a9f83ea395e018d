//! The table and the figures of a validation.

use super::score::Score;
use grouser_files::soil::SoilFile;
use grouser_identify::Parameter;
use grouser_identify::least_squares::Verdict;
use grouser_identify::plate::PlateFit;
use grouser_identify::wheel::Quantity;

/// Whose prediction a row judges.
///
/// ```
/// use grouser_campaign::validate::ModelName;
///
/// assert_eq!(ModelName::WongReece.key(), "wong-reece");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ModelName {
    /// The laws of this project for soil that is dug, pushed and ploughed.
    Grouser,
    /// \[WR67\] alone: stress place by the slip in the wheel's plane, no slip-sinkage, no rear contact.
    WongReece,
    /// Laws that others have published, with as many fitted numbers as ours: the baseline that shows what ours
    /// add.
    PublishedLaws,
}

impl ModelName {
    /// Its name in tables.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Grouser => "grouser",
            Self::WongReece => "wong-reece",
            Self::PublishedLaws => "published-laws",
        }
    }
}

/// Did the numbers of the model see the tests of a row?
///
/// ```
/// assert_eq!(grouser_campaign::validate::Split::HeldOut.key(), "held-out");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// They were fitted to them.
    Fitted,
    /// They never saw them.
    HeldOut,
}

impl Split {
    /// Its name in tables.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Fitted => "fitted",
            Self::HeldOut => "held-out",
        }
    }
}

/// Which slips a row judges, as the test bed states them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlipGroup {
    /// |s| ≤ 0.75: what the fits see.
    Steady,
    /// s > 0.75: nearly spinning on the spot.
    Spinning,
    /// s = −1: the wheel does not turn.
    Locked,
}

impl SlipGroup {
    /// All.
    pub const ALL: [Self; 3] = [Self::Steady, Self::Spinning, Self::Locked];

    /// Its name in tables.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::Spinning => "spinning",
            Self::Locked => "locked",
        }
    }

    /// The group of a stated slip.
    #[must_use]
    pub fn from_slip(slip: f64) -> Self {
        if slip > super::MAX_SLIP + 0.01 {
            Self::Spinning
        } else if slip < -super::MAX_SLIP - 0.01 {
            Self::Locked
        } else {
            Self::Steady
        }
    }
}

/// One row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The data set.
    pub data_set: &'static str,
    /// The wheel.
    pub wheel: &'static str,
    /// Slip angle, deg.
    pub slip_angle_deg: f64,
    /// Which slips.
    pub slips: SlipGroup,
    /// What was measured.
    pub quantity: Quantity,
    /// Whose prediction.
    pub model: ModelName,
    /// To what the model's numbers were fitted.
    pub fit: &'static str,
    /// Did the model's numbers see these tests?
    pub split: Split,
    /// The errors, in the unit of the quantity.
    pub score: Score,
    /// How many numbers were fitted, offsets of the measurement included, plate tests aside.
    pub fitted_parameters: usize,
    /// The error that the published model of this data set has, in the unit of the quantity.
    pub published_rmse: Option<f64>,
    /// The scatter of repeated trials, in the unit of the quantity.
    pub scatter: Option<f64>,
    /// Tests whose load nothing below the hub carries: predicted with the hub at the ground.
    pub hub_buried: usize,
}

/// A number that a fit found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Found {
    /// Which.
    pub parameter: Parameter,
    /// Its value, SI.
    pub value: f64,
    /// Its standard error, SI; NaN where there is none.
    pub standard_error: f64,
    /// What the data say about it.
    pub verdict: Verdict,
}

/// One fit.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FitReport {
    /// Its data set.
    pub data_set: &'static str,
    /// Its model.
    pub model: ModelName,
    /// To what it was fitted.
    pub fit: &'static str,
    /// The soil with what was found.
    pub soil: grouser_terra::OpenSoil,
    /// How it ended.
    pub status: grouser_identify::least_squares::Status,
    /// What it found.
    pub found: Vec<Found>,
    /// Greatest over least singular value of the scaled Jacobian.
    pub condition: f64,
}

/// A measured point of a figure, in the unit of its quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeasuredPoint {
    /// The slip that the test bed states.
    pub slip: f64,
    /// What was read.
    pub value: f64,
    /// Its standard deviation, where it is known.
    pub deviation: f64,
}

/// Measured points and predicted lines of one quantity at one slip angle.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Series {
    /// The data set.
    pub data_set: &'static str,
    /// The wheel.
    pub wheel: &'static str,
    /// Slip angle, deg.
    pub slip_angle_deg: f64,
    /// What was measured.
    pub quantity: Quantity,
    /// The points.
    pub measured: Vec<MeasuredPoint>,
    /// Lines (slip, value) by model and fit.
    pub lines: Vec<(ModelName, &'static str, Vec<[f64; 2]>)>,
}

/// A validation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Validation {
    /// The table.
    pub rows: Vec<Row>,
    /// The fits behind it.
    pub fits: Vec<FitReport>,
    /// The result of the plate tests.
    pub plates: PlateFit,
    /// The figures' data.
    pub series: Vec<Series>,
}

impl Validation {
    /// The soil of the main fit (this project's laws on the smooth wheel at slip angle 0) with every number and
    /// law, and its remarks; `None` where that fit is missing.
    #[must_use]
    pub fn soil_file(&self) -> Option<(SoilFile, Vec<String>)> {
        let fit = self
            .fits
            .iter()
            .find(|fit| fit.model == ModelName::Grouser)?;
        let name = format!("{}, fitted on {}", fit.data_set, fit.fit);
        let source = format!(
            "grouser validate: {} on {} of {}",
            fit.model.key(),
            fit.fit,
            fit.data_set
        );
        let remarks = fit.found.iter().map(|found| {
            let value = |x| found.parameter.to_key_unit(x);
            format!(
                "{} {:.4}, standard error {:.4}, {}",
                found.parameter.key(),
                value(found.value),
                value(found.standard_error),
                found.verdict.key()
            )
        });
        Some((SoilFile::new(&name, &source, fit.soil), remarks.collect()))
    }
}
