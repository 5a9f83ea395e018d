//! `map`: slip, energy and risk of a robot on every cell of an elevation model.

#[cfg(feature = "parquet")]
mod cell_table;
mod costmap;
mod gazebo;
mod grid_map;
mod object;
mod outputs;
pub(super) mod picture;
mod soils;
pub(super) mod summary;
mod work;

use std::path::PathBuf;

use grouser_report::number::{parse_finite, shown};
use grouser_terra::Caution;
use grouser_terrain::raster::{Dem, DemCaution};
use grouser_terrain::{Envelope, Headings, MapLayout, MapMaker, MapSettings, MapSoil, SoilMap};

use crate::error::Result;
use crate::exit::Outcome;
use crate::input;
use crate::model_error;
use crate::session::Session;
use crate::soil_choice::SoilArguments;
use crate::verb_report::Report;
use crate::wheel_choice::{GravityArgument, MaxSlip};

use outputs::Outputs;
use work::Shard;

#[derive(clap::Args, Debug)]
#[command(
    group = clap::ArgGroup::new("uncertain").args(["soil_intervals", "soil_map"]).multiple(true),
    about = "Slip, energy and risk of a robot on every cell of an elevation model",
    long_about = "Slip, sinkage, energy per metre, tip-over margin and the probability of immobilisation of a robot on every \
        cell of an elevation model, for 8 or 16 headings, as a GeoTIFF with the model's own place and coordinate system.\n\n\
        The exact solver fills a table over pitch and roll, whose error between the nodes is checked and reported. Without \
        --soil-intervals the soil is treated as exactly known, and every probability is 0 or 1. An interrupted job goes on \
        where it ended when the same command runs again.",
    after_help = "Examples:\n  grouser map dem.tif --robot rover.toml --soil dry-sand -o map.tif -o map.svg\n  \
        grouser map dem.tif --robot rover.toml --soil sand.toml --soil-intervals intervals.toml -o map.tif -o costmap.yaml\n  \
        grouser map dem.tif --robot rover.toml --soil dry-sand -o map.tif -o map.mcap -o gazebo.sdf\n  \
        grouser map dem.tif --robot rover.toml --soil dry-sand --soil-map soils.toml -o map.tif\n  \
        grouser map dem.tif --robot rover.toml --soil lunar --gravity-m-per-s2 moon --shard 1/4 -o map.tif"
)]
pub(crate) struct Arguments {
    /// The elevation model: GeoTIFF in metres, ESRI ASCII grid (.asc) or picture (.png)
    #[arg(value_name = "DEM")]
    dem: PathBuf,
    /// A robot file with masses and widths
    #[arg(long, value_name = "FILE.toml")]
    robot: PathBuf,
    #[command(flatten)]
    soil: SoilArguments,
    /// 95 % intervals of the soil's numbers: soils are drawn from them
    #[arg(long, value_name = "FILE.toml")]
    soil_intervals: Option<PathBuf>,
    /// A legend of soils with a raster of their places; ground without a class has the soil of --soil
    #[arg(long, value_name = "FILE.toml")]
    soil_map: Option<PathBuf>,
    /// Soils that are drawn from the intervals of each soil
    #[arg(long, value_name = "N", default_value = "64", value_parser = clap::value_parser!(u16).range(1..=4096), requires = "uncertain")]
    soil_draws: u16,
    /// Seed of the soil draws
    #[arg(long, value_name = "N", default_value = "1", requires = "uncertain")]
    seed: u64,
    /// Level of the energy's CVaR: the mean over the soil draws beyond this share
    #[arg(long, value_name = "ALPHA", value_parser = parse_finite, default_value = "0.9", requires = "uncertain")]
    cvar: f64,
    /// Directions: 4, 8 or 16
    #[arg(long, value_name = "N", default_value = "8")]
    headings: u8,
    /// Maximum pitch that is computed, in degrees; steeper cells are `steep`
    #[arg(long, value_name = "DEG", value_parser = parse_finite, default_value = "30")]
    max_pitch_deg: f64,
    /// Maximum roll that is computed, in degrees
    #[arg(long, value_name = "DEG", value_parser = parse_finite, default_value = "25")]
    max_roll_deg: f64,
    /// Size of a cell in m, where the file does not give it
    #[arg(long, value_name = "M", value_parser = parse_finite)]
    cell_m: Option<f64>,
    /// Height of a grey level of a picture in m
    #[arg(long, value_name = "M", value_parser = parse_finite, default_value = "0.001")]
    height_step_m: f64,
    #[command(flatten)]
    gravity: GravityArgument,
    #[command(flatten)]
    max_slip: MaxSlip,
    /// Compute only part I of N of the map, into a file next to the output
    #[arg(long, value_name = "I/N", value_parser = work::parse_shard)]
    shard: Option<Shard>,
    /// Join the parts of N shards
    #[arg(long, value_name = "N", conflicts_with = "shard", value_parser = clap::value_parser!(u16).range(1..=9999))]
    join: Option<u16>,
    /// The map (.tif; needed), a figure (.svg, .png), a Nav2 costmap (.yaml and a .pgm), a `grid_map` message
    /// (.mcap), gz-sim's slip map (.sdf and a .png), a table (.parquet, where built with it); may be given
    /// several times
    #[arg(short, long, value_name = "FILE", required = true)]
    output: Vec<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments, session: &mut Session) -> Result<Report> {
    let outputs = Outputs::begin(&arguments.output, arguments.shard)?;
    let headings = Headings::new(arguments.headings)?;
    let chosen = arguments.soil.choose(session)?;
    session.used_file(&arguments.robot)?;
    let model = arguments.gravity.of(input::robot(&arguments.robot)?);
    let mut dem = Dem::open(&arguments.dem, arguments.cell_m, arguments.height_step_m)?;
    session.used_file(&arguments.dem)?;
    let [max_pitch, max_roll] =
        [arguments.max_pitch_deg, arguments.max_roll_deg].map(f64::to_radians);
    let envelope = Envelope::within(&model, max_pitch, max_roll)?;
    let mut warnings = warnings([max_pitch, max_roll], &envelope);
    let drawn = soils::draws(arguments, &chosen.soil, session)?;
    let place = soils::soil_map(arguments, &dem, session)?;
    let legend = place.as_ref().map_or(&[][..], SoilMap::soils);
    let others = soils::legend_draws(arguments, legend, session)?;
    let job = work::job(
        arguments,
        session,
        (&chosen.soil, model.gravity()),
        (&drawn, legend, &others),
        &envelope,
    );
    let draws = others.iter().map(Vec::len).fold(drawn.len(), usize::max);
    let mut layout =
        MapLayout::new(&dem, &model, headings, draws, &job).of_soil(&chosen.name, &chosen.soil);
    let names = legend.iter().map(|entry| entry.name.clone());
    layout.soils.extend(names);
    layout.cvar_level = arguments.cvar;
    outputs.check(&layout)?;
    let model_error = model_error::pull_per_load(
        std::iter::once(&chosen.soil).chain(legend.iter().map(|entry| &entry.soil)),
        arguments.max_slip.max_slip,
        model_error::has_lugs(&model),
    );
    let settings = MapSettings::new(headings, envelope).with_cvar_level(arguments.cvar)?;
    let soils_with_draws: Vec<_> = std::iter::once((&chosen.soil, drawn.as_slice()))
        .chain(
            legend
                .iter()
                .map(|entry| &entry.soil)
                .zip(others.iter().map(Vec::as_slice)),
        )
        .collect();
    let mut tables =
        soils::tables(&model, &soils_with_draws, envelope, arguments.max_slip)?.into_iter();
    let Some((soil, draws)) = tables.next() else {
        return Err(crate::error::Error::usage_without_hint(
            "a map needs a soil",
        ));
    };
    let mut maker = MapMaker::new(settings, soil, draws, layout.cell);
    if let Some(place) = place {
        let others = tables
            .map(|(own, draws)| MapSoil::new(own, draws))
            .collect();
        maker = maker.with_soil_map(place, others, dem.georeference().clone())?;
    }
    let made = work::Job {
        maker: &maker,
        layout: &layout,
        outputs: &outputs,
        shard: arguments.shard,
        join: arguments.join,
    }
    .run(&mut dem)?;
    warnings.extend(dem.cautions().into_iter().map(DemCaution::text));
    let Some(journals) = made.journals else {
        let text = format!(
            "shard {} of {}: {} strips in {}\n",
            made.shard.index,
            made.shard.of,
            made.computed + made.resumed,
            crate::error::shown(&outputs.journal())
        );
        let part = made.part(&outputs);
        return Ok(Report {
            warnings,
            ..Report::done(object::part().object(&part), text)
        });
    };
    let (summary, written) = outputs.write(&layout, journals, (&maker, &model), &mut dem)?;
    let result = object::Mapped {
        layout: &layout,
        summary: &summary,
        maker: &maker,
        envelope,
        soil: &chosen.name,
        gravity: layout.gravity,
        resumed: made.resumed,
        model_error,
    };
    warnings.extend(doubts(&result));
    Ok(report(&result, summary.known == 0, &written, warnings))
}

/// What is doubtful before the map is made.
fn warnings(requested: [f64; 2], envelope: &Envelope) -> Vec<String> {
    let mut warnings = Vec::new();
    if envelope.max_pitch < requested[0] {
        warnings.push(format!(
            "a wheel loses the ground within the requested pitch and roll: the map ends at {:.1}° and {:.1}°",
            envelope.max_pitch.to_degrees(),
            envelope.max_roll.to_degrees()
        ));
    }
    warnings
}

/// What is doubtful about the map.
fn doubts(result: &object::Mapped<'_>) -> Vec<String> {
    let mut warnings = Vec::new();
    if result.model_error.is_none() {
        warnings.push(model_error::UNKNOWN.to_owned());
    }
    if result.error().slip > grouser_terrain::SLIP_BOUND {
        warnings.push(format!(
            "the table differs from the exact solver by up to {:.1e} in slip, more than {:.0e}",
            result.error().slip,
            grouser_terrain::SLIP_BOUND
        ));
    }
    if let Some(share) = result.deep_share().filter(|share| *share > 0.0) {
        warnings.push(format!(
            "caution at {} % of the cells and headings that drive: {}",
            shown(100.0 * share),
            Caution::DeepSinkage
        ));
    }
    warnings
}

fn report(
    result: &object::Mapped<'_>,
    is_empty: bool,
    written: &str,
    warnings: Vec<String>,
) -> Report {
    Report {
        outcome: if is_empty {
            Outcome::NoResult
        } else if result.error().slip > grouser_terrain::SLIP_BOUND {
            Outcome::Doubtful
        } else {
            Outcome::Done
        },
        failure: is_empty.then(|| "the height of no cell and its surroundings is known".to_owned()),
        warnings,
        ..Report::done(object::fields().object(result), result.text() + written)
    }
}

/// The JSON schema: of a map, or of a shard.
pub(crate) fn schema() -> serde_json::Value {
    serde_json::json!({"anyOf": [object::fields().schema(), object::part().schema()]})
}
