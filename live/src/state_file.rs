//! `--state`: what the filter has learnt, kept between runs.
//!
//! ```toml
//! format = 1
//! state = 2
//! robot = "five wheels"
//!
//! [gyro]
//! bias_rad_per_s = 0.001
//! variance = 1e-8
//! ```

use std::path::Path;

use grouser_files::{Document, Section, TomlText, write_whole};
use grouser_slip::filter::Learnt;
use grouser_slip::{Measured, Robot};

use crate::error::{Error, Result};
use crate::print::warn;

/// The version of what is kept.
const STATE: i64 = 2;

/// Any finite number: the filter checks the limits.
const ANY: (f64, f64) = (-1e9, 1e9);

/// Reads the file; `None` where there is none yet, and, with a warning, where another version of the program wrote it.
///
/// # Errors
/// [`Error::Files`] for a file of another robot or with wrong fields.
pub(crate) fn read(path: &Path, robot: &Robot) -> Result<Option<Learnt>> {
    if !path.exists() {
        return Ok(None);
    }
    match parse(&Document::read(path)?, path, robot) {
        Err(error @ Error::OtherState { .. }) => {
            warn(&format!("{error}; the filter starts without it"));
            Ok(None)
        }
        outcome => outcome.map(Some),
    }
}

fn parse(document: &Document, path: &Path, robot: &Robot) -> Result<Learnt> {
    document.parse(|root: &Section<'_>| -> Result<Learnt> {
        let found = root.optional_integer("state")?.unwrap_or(1);
        if found != STATE {
            return Err(Error::OtherState {
                path: path.to_owned(),
                found,
                expected: STATE,
            });
        }
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
        learnt.accelerometer_bias = root.section("accelerometer", |s| known(s, "bias_m_per_s2"))?;
        learnt.log_slip = root.section("common_slip", |s| known(s, "log_slip"))?;
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
    out.whole("state", STATE);
    out.text("robot", robot.name());
    for (header, key, known) in [
        ("[gyro]", "bias_rad_per_s", learnt.gyro_bias),
        (
            "[accelerometer]",
            "bias_m_per_s2",
            learnt.accelerometer_bias,
        ),
        ("[common_slip]", "log_slip", learnt.log_slip),
    ] {
        let Some(known) = known else { continue };
        out.header(header);
        out.number(key, known.value);
        out.number("variance", known.variance);
    }
    out.finish()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;
    use grouser_slip::Wheel;
    use grouser_slip::filter::{FilterSettings, SlipFilter};

    #[test]
    fn a_state_is_read_back_and_one_of_an_earlier_version_is_ignored() {
        let wheel = Wheel::powered("left").ticks_per_turn(100);
        let robot = Robot::new("cart".into(), vec![wheel]).unwrap();
        let learnt = SlipFilter::new(&robot, FilterSettings::default())
            .unwrap()
            .learnt();
        let folder = std::env::temp_dir().join(format!("grouser-state-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("state.toml");
        write(&path, &robot, &learnt).unwrap();
        assert_eq!(read(&path, &robot).unwrap(), Some(learnt));
        let old = "format = 1\nrobot = \"cart\"\n[common_slip]\nslip = 0.1\nvariance = 0.01\n";
        std::fs::write(&path, old).unwrap();
        assert_eq!(read(&path, &robot).unwrap(), None);
        let error = parse(&Document::read(&path).unwrap(), &path, &robot).unwrap_err();
        assert!(
            error
                .to_string()
                .ends_with("the state is of version 1, but this program reads version 2")
        );
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
