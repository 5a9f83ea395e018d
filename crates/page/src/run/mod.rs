//! Runs in columns, as the page plays them: simulated or recorded, with the same keys.

#[cfg(feature = "drive")]
mod columns;
#[cfg(feature = "drive")]
mod drive;
#[cfg(feature = "drive")]
mod ground;
#[cfg(any(feature = "drive", feature = "log"))]
mod learnt;
#[cfg(feature = "log")]
mod log;
#[cfg(feature = "log")]
mod moments;
#[cfg(feature = "log")]
mod overview;
#[cfg(feature = "log")]
mod part;
#[cfg(feature = "log")]
mod parts;

#[cfg(feature = "drive")]
pub use drive::{Drive, DriveRecorder};
#[cfg(feature = "log")]
pub use log::LogRecorder;
#[cfg(feature = "log")]
pub use overview::overview;
#[cfg(feature = "log")]
pub use parts::{LogParts, failed};
