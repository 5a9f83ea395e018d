#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub use grouser_design as design;
pub use grouser_doctor as doctor;
pub use grouser_figure as figure;
pub use grouser_files as files;
pub use grouser_identify as identify;
pub use grouser_log as log;
pub use grouser_opt as opt;
pub use grouser_real as real;
pub use grouser_replay as replay;
pub use grouser_report as report;
pub use grouser_rover as rover;
pub use grouser_slip as slip;
pub use grouser_terra as terra;
pub use grouser_terrain as terrain;

// The command: it computes nothing about wheels itself. A verb is a folder or a file in `verbs/`: its arguments (clap), and a
// function that runs it in a session and returns a report. What verbs share is in the other modules.
#[cfg(feature = "command")]
mod command;
#[cfg(feature = "command")]
mod companion;
#[cfg(feature = "command")]
mod error;
#[cfg(feature = "command")]
mod exit;
#[cfg(feature = "command")]
mod figure_file;
#[cfg(feature = "command")]
mod files_in_use;
#[cfg(feature = "command")]
mod input;
#[cfg(feature = "command")]
mod interrupt;
#[cfg(feature = "command")]
mod law_error;
#[cfg(feature = "command")]
mod library_error;
mod model_error;
#[cfg(feature = "command")]
mod operation;
#[cfg(feature = "command")]
mod output;
#[cfg(feature = "command")]
mod output_choice;
#[cfg(feature = "command")]
mod progress;
#[cfg(feature = "command")]
mod report_file;
#[cfg(feature = "command")]
mod run;
#[cfg(feature = "command")]
mod session;
#[cfg(feature = "command")]
mod soil_choice;
#[cfg(feature = "command")]
mod soil_text;
#[cfg(feature = "command")]
mod terminal;
#[cfg(feature = "command")]
mod thread_pool;
#[cfg(feature = "command")]
mod usage;
#[cfg(feature = "command")]
mod values;
#[cfg(feature = "command")]
mod verb_report;
#[cfg(feature = "command")]
mod verbs;
#[cfg(feature = "command")]
mod wheel_choice;

#[cfg(feature = "command")]
pub use run::run_command;

/// The Rust of the tutorials compiles and holds.
#[cfg(doctest)]
mod tutorials {
    #[doc = include_str!("../../../docs/tutorials/5-on-the-robot.md")]
    mod on_the_robot {}
    #[doc = include_str!("../../../docs/tutorials/6-as-a-library.md")]
    mod as_a_library {}
}
