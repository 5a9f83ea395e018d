//! The command line as clap reads it.

use crate::verbs::Verb;

/// The whole command line.
#[derive(clap::Parser, Debug)]
#[command(
    name = "grouser",
    bin_name = "grouser",
    version,
    about = "Predicts, measures, optimises and controls wheel slip on soft ground",
    long_about = "Predicts, measures, optimises and controls wheel slip of robots on soft ground.\n\n\
        Every flag carries its unit. Exit codes: 0 done, 1 ended without its result (no solution), \
        2 bad usage or input, 3 partial.",
    max_term_width = 100,
    disable_help_subcommand = true,
    infer_long_args = false
)]
pub(crate) struct Command {
    /// Print exactly one JSON object on standard output
    #[arg(long, global = true, display_order = 900)]
    pub(crate) json: bool,

    /// What to do
    #[command(subcommand)]
    pub(crate) verb: Verb,
}
