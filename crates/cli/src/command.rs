//! The command line as clap reads it.

use crate::exit::EXIT_CODES;
use crate::verbs::Verb;

/// The whole command line.
#[derive(clap::Parser, Debug)]
#[command(
    name = "grouser",
    bin_name = "grouser",
    version,
    about = "Predicts, measures, optimises and controls wheel slip on soft ground",
    long_about = "Predicts, measures, optimises and controls wheel slip of robots on soft ground.\n\n\
        Every flag carries its unit. Under --json standard output holds one JSON object, of an error too: \
        `grouser help VERB --schema` describes it.",
    after_help = exit_codes(),
    arg_required_else_help = true,
    disable_help_subcommand = true,
    infer_long_args = false
)]
pub(crate) struct Command {
    /// Print exactly one JSON object on standard output
    #[arg(long, global = true, display_order = 900)]
    pub(crate) json: bool,

    /// Print details too
    #[arg(short, long, global = true, display_order = 901)]
    pub(crate) verbose: bool,

    /// Print numbers with this many significant digits
    #[arg(long, global = true, display_order = 902, value_name = "N", default_value = "3", value_parser = clap::value_parser!(u8).range(1..=17))]
    pub(crate) digits: u8,

    /// What to do
    #[command(subcommand)]
    pub(crate) verb: Verb,
}

fn exit_codes() -> String {
    let codes = EXIT_CODES.map(|(code, meaning)| format!("\n  {code:>3}  {meaning}"));
    format!("Exit codes:{}", codes.concat())
}
