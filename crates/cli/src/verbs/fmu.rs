//! `fmu`: a wheel on a soil as a co-simulation unit of FMI 3.0.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};

use grouser_fmu::{Model, package};
use grouser_terra::Settings;

use crate::error::{Error, Result, shown};
use crate::law_error::Names;
use crate::output::OutputFile;
use crate::session::Session;
use crate::verb_report::Report;
use crate::wheel_choice::WheelArguments;
use grouser_report::number::parse_finite;
use grouser_report::{Fields, fields};

/// The function that every library of a unit for co-simulation has.
const FUNCTION: &[u8] = b"fmi3InstantiateCoSimulation";

#[derive(clap::Args, Debug)]
#[command(
    about = "Write a wheel on a soil as a co-simulation unit (FMI 3.0)",
    long_about = "Write a wheel on a soil as a co-simulation unit (FMI 3.0): load, slip and slip angle are inputs; sinkage, drawbar \
        pull, side force, torque, status and cautions are outputs. The unit runs where this program runs.",
    after_help = "Example:\n  grouser fmu --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 80 --slip 0.2 -o wheel.fmu"
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    wheel: WheelArguments,
    /// Load in N with which a simulation starts
    #[arg(long, value_name = "N", value_parser = parse_finite, allow_hyphen_values = true, default_value_t = 0.0)]
    load_n: f64,
    /// Slip with which it starts
    #[arg(long, value_name = "S", value_parser = parse_finite, allow_hyphen_values = true, default_value_t = 0.0)]
    slip: f64,
    /// The shared library of the unit [default: the one in the folder of this program]
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,
    /// The unit; its name is that of the model: letters, digits and `_`
    #[arg(short, long, value_name = "FILE.fmu")]
    output: PathBuf,
}

impl Arguments {
    /// The shared library.
    fn library(&self) -> Result<PathBuf> {
        if let Some(library) = &self.library {
            return Ok(library.clone());
        }
        let name = format!("{DLL_PREFIX}grouser_fmu{DLL_SUFFIX}");
        let own = std::env::current_exe().ok();
        let beside = own.as_deref().and_then(Path::parent);
        // cargo puts the library into `deps` when it builds the command
        let places = beside.map(|folder| [folder.join(&name), folder.join("deps").join(&name)]);
        let mut places = places.into_iter().flatten();
        places.find(|file| file.is_file()).ok_or_else(|| {
            Error::usage(
                format!("the library `{name}`, which a unit contains, is not in the folder of `grouser`"),
                "build it with `cargo build --release -p grouser-fmu` of the source, and copy it there or name it by \
                 `--library`",
            )
        })
    }
}

/// A unit that was written.
struct Unit<'a> {
    arguments: &'a Arguments,
    name: &'a str,
    soil: &'a str,
    library: &'a Path,
    bytes: usize,
}

fn fields<'a>() -> Fields<'a, &'a Unit<'a>> {
    fields! { |unit: &'a Unit<'a>|
        "output" "the unit that was written" = unit.arguments.output.display().to_string();
        "model" "name of the model" = unit.name;
        "soil" "soil" = unit.soil;
        "radius_m" "radius of the wheel" = unit.arguments.wheel.radius_m;
        "width_m" "width of the wheel" = unit.arguments.wheel.width_m;
        "library" "the shared library in it" = unit.library.display().to_string();
        "bytes" "size of the unit" = unit.bytes;
    }
}

/// The JSON schema.
pub(crate) fn schema() -> serde_json::Value {
    fields().schema()
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let refuse = |error: grouser_fmu::Error| match error {
        grouser_fmu::Error::Law(error) => Names::Flags.error(&error),
        other => Error::usage_without_hint(other.to_string()),
    };
    let (pair, chosen) = arguments.wheel.pair(session, Settings::default())?;
    let start = [
        arguments.load_n,
        arguments.slip,
        arguments.wheel.slip_angle_deg,
    ];
    let model = Model::new(*pair.wheel(), *pair.soil(), start).map_err(refuse)?;
    let path = arguments.library()?;
    session.used_file(&path)?;
    let library = std::fs::read(&path).map_err(|error| Error::file("read", &path, &error))?;
    if !library
        .windows(FUNCTION.len())
        .any(|window| window == FUNCTION)
    {
        return Err(Error::content(
            &path,
            "it is no library of a unit for co-simulation",
            Some("`cargo build --release -p grouser-fmu` of the source builds it".to_owned()),
        ));
    }
    let name = arguments
        .output
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let soil = (chosen.name.as_str(), chosen.source.as_str());
    let unit = package(&model, &name, soil, &library).map_err(refuse)?;
    let line = OutputFile::create(&arguments.output)?.write_whole(&unit)?;
    let text = format!(
        "{line}model {name}: {} on {}, with the library {}\n",
        "load_n, slip and slip_angle_deg in; sinkage, forces and torque out",
        chosen.name,
        shown(&path)
    );
    let made = Unit {
        arguments,
        name: &name,
        soil: &chosen.name,
        library: &path,
        bytes: unit.len(),
    };
    Ok(Report::done(fields().object(&made), text))
}
