#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub use grouser_design as design;
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

/// The Rust of the tutorials compiles and holds.
#[cfg(doctest)]
mod tutorials {
    #[doc = include_str!("../../../docs/tutorials/5-on-the-robot.md")]
    mod on_the_robot {}
    #[doc = include_str!("../../../docs/tutorials/6-as-a-library.md")]
    mod as_a_library {}
}
