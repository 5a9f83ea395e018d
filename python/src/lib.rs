//! The extension module `grouser._core`: the Rust libraries as Python objects.
//!
//! The public modules in `python/grouser/` are built on it: they check and broadcast arrays, this module
//! computes with the interpreter released. Bad input is raised as `grouser.InputError` (a `ValueError`) or
//! `grouser.InputTypeError` (a `TypeError`), both with field, value, limit and unit.
#![forbid(unsafe_op_in_unsafe_fn)]

mod argument;
mod batch;
mod callable;
mod command;
mod contact;
mod drive;
mod error;
mod figure;
mod fleet;
mod ground_contact;
mod identify;
mod logs;
mod operating_point;
mod optimize;
mod robot;
mod rows;
mod sample;
mod settings_text;
mod slip;
mod slip_map;
mod soil;
mod terrain;
mod wheel;
mod workers;

#[pyo3::pymodule(gil_used = false)]
mod _core {
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_export]
    use super::{
        batch::{instructions, point_cautions, solve_curve, solve_points},
        command::run_command,
        contact::{WheelOnSoil, slips_from_speeds},
        drive::{Scenario, Simulation},
        figure::{chart, write_file},
        fleet::Fleet,
        ground_contact::GroundContacts,
        identify::identify,
        logs::{Engine, estimate, read_samples},
        operating_point::OperatingPoint,
        optimize::{solve, solve_file, solve_front, solve_many},
        robot::Robot,
        sample::Sample,
        slip::{OnBoard, SlipFilter},
        slip_map::SlipMap,
        soil::{Soil, catalogue_keys},
        terrain::SlipMapper,
        wheel::Wheel,
    };
}
