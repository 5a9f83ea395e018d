//! The table and the figures of a validation.

use super::score::Score;
use grouser_identify::Parameter;
use grouser_identify::least_squares::Verdict;
use grouser_identify::plate::PlateFit;
use grouser_identify::wheel::Quantity;

/// Whose prediction a row judges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ModelName {
    /// The laws of this project for soil that is dug, pushed and ploughed.
    Grouser,
    /// \[WR67\] alone: stress place by the slip in the wheel's plane, no slip-sinkage, no rear contact.
    WongReece,
}

impl ModelName {
    /// Its name in tables.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Grouser => "grouser",
            Self::WongReece => "wong-reece",
        }
    }
}

/// Did the numbers of the model see the tests of a row?
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

/// One row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The data set.
    pub data_set: &'static str,
    /// The wheel.
    pub wheel: &'static str,
    /// Slip angle, deg.
    pub slip_angle_deg: f64,
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
pub struct FitReport {
    /// Its data set.
    pub data_set: &'static str,
    /// Its model.
    pub model: ModelName,
    /// To what it was fitted.
    pub fit: &'static str,
    /// How it ended.
    pub status: grouser_identify::least_squares::Status,
    /// What it found.
    pub found: Vec<Found>,
    /// Greatest over least singular value of the scaled Jacobian.
    pub condition: f64,
}

/// A measured point of a figure, in the unit of its quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
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
pub struct Validation {
    /// The table.
    pub rows: Vec<Row>,
    /// The fits behind it.
    pub fits: Vec<FitReport>,
    /// What the plate tests told.
    pub plates: PlateFit,
    /// The figures' data.
    pub series: Vec<Series>,
}
