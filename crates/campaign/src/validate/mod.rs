//! The model held against measured data.

pub mod cmu;
pub mod ding;
mod figure;
mod fitting;
mod on_ding;
mod on_trials;
mod rows;
mod run;
mod score;
mod text;
pub mod trec;

pub use rows::{
    FitReport, Found, MeasuredPoint, ModelName, Row, Series, SlipGroup, Split, Validation,
};
pub use run::{MAX_SLIP, PLATES, plate_tests, read_press, validate};
pub use score::Score;
