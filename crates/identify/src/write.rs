//! A job as the text of its file.

use std::path::Path;

use grouser_files::{TomlText, soil};
use grouser_terra::GrouserRule;

use crate::error::{Error, Result};
use crate::job::{BagTest, Job, LENGTHS, PlateSource, TIMES, WheelJob};
use crate::least_squares::Loss;
use crate::plate::Plate;

/// The text of a file of tests that [`Job::read`] reads to the same job; its soil as by [`soil::to_toml`].
///
/// Paths are written as the job has them: relative ones lie beside the file that is written. `remarks` stand above it as
/// comments.
///
/// ```
/// use grouser_files::Document;
/// use grouser_identify::{Job, PlateSource, to_toml};
///
/// let mut job = Job::new("Sand of our test bed");
/// job.plates = vec![PlateSource::Table("plates.csv".into())];
/// job.shear = Some("shear.csv".into());
/// let text = to_toml(&job, &["tests of the spring"])?;
/// assert_eq!(Job::read(&Document::from_text("tests.toml", text)?)?, job);
/// # Ok::<(), grouser_identify::Error>(())
/// ```
///
/// # Errors
/// [`Error::Unwritable`] for what the file has no key for: a plate that is no disc, a unit without a name, lugs by their share of
/// the surface, Reece's moduli.
pub fn to_toml(job: &Job, remarks: &[&str]) -> Result<String> {
    let mut out = TomlText::new(remarks);
    out.optional_text("key", job.key.as_deref());
    out.text("name", &job.name);
    for plate in &job.plates {
        out.header("[[plate]]");
        match plate {
            PlateSource::Table(table) => path(&mut out, "table", table),
            PlateSource::Bag(test) => bag_test(&mut out, test)?,
        }
    }
    if !job.plates.is_empty() {
        out.header("[plate_fit]");
        out.number("least_depth_m", job.plate_settings.least_depth);
        out.flag("fit_datum", job.plate_settings.fit_datum);
        loss(&mut out, job.plate_settings.loss);
    }
    if let Some(table) = &job.shear {
        out.header("[shear]");
        path(&mut out, "table", table);
    }
    if let Some(wheel) = &job.wheel {
        out.header("[wheel]");
        wheel_job(&mut out, wheel)?;
    }
    out.header("[soil]");
    soil::write_open(&mut out, &job.soil, "[soil.fitted]")
        .map_err(|_| Error::Unwritable("Reece's moduli"))?;
    Ok(out.finish())
}

fn path(out: &mut TomlText, key: &str, path: &Path) {
    out.text(key, &path.display().to_string());
}

fn unit(out: &mut TomlText, key: &str, value: f64, units: &[(&str, f64)]) -> Result<()> {
    let Some((name, _)) = units.iter().find(|(_, unit)| *unit == value) else {
        return Err(Error::Unwritable("a unit without a name"));
    };
    out.text(key, name);
    Ok(())
}

fn bag_test(out: &mut TomlText, test: &BagTest) -> Result<()> {
    let BagTest {
        name,
        plate,
        source,
        depth,
    } = test;
    let diameter = 2.0 * plate.width;
    if Plate::disc(diameter).ok() != Some(*plate) {
        return Err(Error::Unwritable("a plate that is no disc"));
    }
    out.text("name", name);
    out.number("diameter_m", diameter);
    path(out, "bag", &source.bag);
    out.optional_text("topic", source.topic.as_deref());
    out.text("force_field", &source.force);
    out.optional_text("stamp_field", source.stamp.as_deref());
    out.number("force_sign", source.sign);
    path(out, "depth_file", &depth.file);
    out.whole("height_field", depth.height);
    unit(out, "height_unit", depth.height_unit, &LENGTHS)?;
    out.whole("clock_field", depth.clock);
    if let Some((field, scale)) = depth.controller {
        out.whole("controller_field", field);
        unit(out, "controller_unit", scale, &TIMES)?;
    }
    out.optional_number("surface_m", depth.surface);
    Ok(())
}

fn loss(out: &mut TomlText, loss: Loss) {
    if let Loss::Huber { threshold } = loss {
        out.number("huber", threshold);
    }
}

fn wheel_job(out: &mut TomlText, job: &WheelJob) -> Result<()> {
    path(out, "table", &job.table);
    out.number("radius_m", job.wheel.radius());
    out.number("width_m", job.wheel.width());
    if let Some(lugs) = job.wheel.grousers() {
        let GrouserRule::Lugs { count, thickness } = lugs.rule else {
            return Err(Error::Unwritable("lugs by their share of the surface"));
        };
        out.number("grouser_height_m", lugs.height);
        out.line(&format!("grouser_count = {count}"));
        out.number("grouser_thickness_m", thickness);
    }
    let keys: Vec<String> = job.parameters.iter().map(|p| p.key().to_owned()).collect();
    out.texts("fit", &keys);
    for (key, scatter) in [
        ("pull_scatter_n", job.scatter.pull),
        ("side_scatter_n", job.scatter.side),
        ("torque_scatter_nm", job.scatter.torque),
        ("sinkage_scatter_m", job.scatter.sinkage),
    ] {
        out.number(key, scatter);
    }
    loss(out, job.loss);
    out.text("intervals", if job.profile { "profile" } else { "linear" });
    out.whole("starts", job.starts.starts);
    out.whole("seed", job.starts.seed);
    Ok(())
}
