//! The slip estimator beside a running ROS 2 robot: a node without a ROS installation.
//!
//! ```text
//! transport ─► first messages choose the topics ─► Intake ─► Engine ─► slip, odometry, events, diagnostics
//! ```
//!
//! Topic choice, codec and estimator are those of recorded logs (`grouser_log::Preview`, `Intake`, `grouser_replay::Engine`):
//! a bag that is replayed through a transport gives the bits of `grouser estimate`.
//!
//! The entry is [`run`](run::run); the primary type is the trait [`Transport`](transport::Transport).
#![forbid(unsafe_code)]

pub mod arguments;
mod command;
mod environment;
mod error;
mod latency;
mod look;
mod node;
mod outputs;
mod print;
mod recorder;
pub mod run;
mod screen;
mod senders;
mod state_file;
pub mod transport;
pub mod type_hash;

pub use error::{Error, Result};
pub use print::complain;
