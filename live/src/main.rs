//! `grouser-live`: what `grouser live` runs.

use std::process::ExitCode;

use clap::Parser as _;
use grouser_live::arguments::Arguments;
use grouser_live::run;

fn main() -> ExitCode {
    match run::run(&Arguments::parse()) {
        Ok(outcome) => ExitCode::from(outcome.exit_code()),
        Err(error) => {
            grouser_live::complain(&error.to_string());
            ExitCode::from(2)
        }
    }
}
