//! `--state`: what the filter has learnt, kept between runs.
//!
//! ```toml
//! format = 1
//! robot = "five wheels"
//!
//! [gyro]
//! bias_rad_per_s = 0.001
//! variance = 1e-8
//! ```

use std::path::Path;

use grouser_files::{Document, Section, TomlText, write_whole};
use grouser_slip::filter::{Learnt, LearntWheel, SlipPrior};
use grouser_slip::{Measured, Robot};

use crate::error::{Error, Result};

/// Any finite number: the filter checks the limits.
const ANY: (f64, f64) = (-1e9, 1e9);

/// Reads the file; `None` where there is none yet.
///
/// # Errors
/// [`Error::Files`] for a file of another robot or with wrong fields.
pub(crate) fn read(path: &Path, robot: &Robot) -> Result<Option<Learnt>> {
    if !path.exists() {
        return Ok(None);
    }
    parse(&Document::read(path)?, path, robot).map(Some)
}

fn parse(document: &Document, path: &Path, robot: &Robot) -> Result<Learnt> {
    document.parse(|root: &Section<'_>| -> Result<Learnt> {
        let name = root.text("robot")?;
        if name != robot.name() {
            return Err(Error::OtherRobot {
                path: path.to_owned(),
                found: name.to_owned(),
                robot: robot.name().to_owned(),
            });
        }
        let mut learnt = Learnt::default();
        let known = |section: &Section<'_>, key: &'static str| -> Result<Measured> {
            Ok(Measured {
                value: section.number(key, ANY)?,
                variance: section.number("variance", ANY)?,
            })
        };
        learnt.gyro_bias = root.section("gyro", |s| known(s, "bias_rad_per_s"))?;
        let forward = root.section("accelerometer_forward", |s| known(s, "bias_m_per_s2"))?;
        let left = root.section("accelerometer_left", |s| known(s, "bias_m_per_s2"))?;
        learnt.accelerometer_bias = [forward, left];
        learnt.common_slip = root.section("common_slip", |s| known(s, "slip"))?;
        let wheels = root.sections("wheel", |section| {
            let name = section.text("name")?;
            let skid = section.optional_number("skid", ANY)?;
            let sigma = section.optional_number("skid_sigma", ANY)?;
            let excess = section.optional_number("radius_excess", ANY)?;
            let variance = section.optional_number("radius_excess_variance", ANY)?;
            let mut wheel = LearntWheel::default();
            wheel.free_slip = skid
                .zip(sigma)
                .map(|(mean, sigma)| SlipPrior { mean, sigma });
            wheel.radius_excess = excess
                .zip(variance)
                .map(|(value, variance)| Measured { value, variance });
            Ok((name.to_owned(), wheel))
        })?;
        for (name, wheel) in wheels {
            if let Some(slot) = robot
                .wheel_index(&name)
                .and_then(|i| learnt.wheels.get_mut(i))
            {
                *slot = wheel;
            }
        }
        Ok(learnt)
    })
}

/// Writes the file as a whole or not at all. A state that could not be read again is not written.
///
/// # Errors
/// [`Error::File`]; [`Error::Files`] for a number that a state cannot have.
pub(crate) fn write(path: &Path, robot: &Robot, learnt: &Learnt) -> Result<()> {
    let text = text(robot, learnt);
    let name = path.display().to_string();
    parse(&Document::from_text(&name, text.clone())?, path, robot)?;
    write_whole(path, text.as_bytes()).map_err(|error| Error::File {
        path: path.to_owned(),
        source: error.into(),
    })
}

fn text(robot: &Robot, learnt: &Learnt) -> String {
    let mut out = TomlText::new(&[
        "What the slip filter has learnt of this robot; `grouser live --state` keeps it.",
    ]);
    out.text("robot", robot.name());
    let [forward, left] = learnt.accelerometer_bias;
    for (header, key, known) in [
        ("[gyro]", "bias_rad_per_s", learnt.gyro_bias),
        ("[accelerometer_forward]", "bias_m_per_s2", forward),
        ("[accelerometer_left]", "bias_m_per_s2", left),
        ("[common_slip]", "slip", learnt.common_slip),
    ] {
        let Some(known) = known else { continue };
        out.header(header);
        out.number(key, known.value);
        out.number("variance", known.variance);
    }
    for (wheel, known) in robot.wheels().iter().zip(&learnt.wheels) {
        out.header("[[wheel]]");
        out.text("name", &wheel.name);
        out.optional_number("skid", known.free_slip.map(|skid| skid.mean));
        out.optional_number("skid_sigma", known.free_slip.map(|skid| skid.sigma));
        out.optional_number(
            "radius_excess",
            known.radius_excess.map(|excess| excess.value),
        );
        out.optional_number(
            "radius_excess_variance",
            known.radius_excess.map(|excess| excess.variance),
        );
    }
    out.finish()
}
