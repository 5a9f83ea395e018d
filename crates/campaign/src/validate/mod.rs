//! The model held against measured data.

pub mod cmu;
pub mod ding;
mod fitting;
mod on_ding;
mod on_trials;
mod rows;
mod run;
mod score;

pub use rows::{FitReport, Found, MeasuredPoint, ModelName, Row, Series, Split, Validation};
pub use run::{GREATEST_SLIP, PLATES, plate_tests, validate};
pub use score::Score;
