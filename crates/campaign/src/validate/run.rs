//! Every data set against the model.

use std::path::Path;

use super::rows::Validation;
use super::{cmu, ding, trec};
use grouser_identify::Result;
use grouser_identify::plate::{
    BagSource, DepthColumn, Plate, PlateRecord, PlateSettings, PlateTest, fit_plates, read_bag,
};

/// Beyond this stated slip a trial is not fitted and has rows of its own: locked and nearly spinning wheels are no
/// steady state here.
pub const MAX_SLIP: f64 = 0.75;

/// The files of the plate tests below the folder of measured data: name, disc diameter (m) and the height of the
/// sand's surface (m), as the script that was published with them has it.
pub const PLATES: [(&str, f64, f64); 2] = [
    (
        "cmu-wheel/f-d-large-box__force-displacement_1",
        0.06,
        -9.62e-3,
    ),
    (
        "cmu-wheel/f-d-large-box__force-displacement_4",
        0.1,
        -9.0e-3,
    ),
];

/// Every measured data set below `data` against the model, plain Wong-Reece and what was published.
///
/// Plate tests first (their bags and text files), then the smooth wheel at slip angle 0, then everything else as
/// prediction, nearly spinning and locked wheels as rows of their own; a second set of numbers is fitted on slip angles 0 and 60 and predicts those between. At 90°
/// every trial sits deeper than the wheel's radius, outside the model.
///
/// # Errors
/// What a file lacks.
pub fn validate(data: &Path) -> Result<Validation> {
    let tests = plate_tests(data)?;
    let plates = fit_plates(&tests, &PlateSettings::default())?;
    let trials = cmu::trials(&data.join(cmu::TRIALS), "smooth", 1.0)?;
    let grouser = cmu::trials(&data.join(cmu::TRIALS), "grouser", 1.0)?;
    let more = data.join(cmu::LUG_TRIALS);
    let more = if more.is_file() {
        cmu::trials(&more, "grouser", 1.0)?
    } else {
        Vec::new()
    };
    let lugged_ding = data.join(ding::LUGGED);
    let lugged_ding = if lugged_ding.is_file() {
        Some(ding::lugged_tests(&lugged_ding)?)
    } else {
        None
    };
    let mut out = Validation {
        rows: Vec::new(),
        fits: Vec::new(),
        plates,
        series: Vec::new(),
    };
    out.add_trials(&trials, &grouser, &more)?;
    out.add_ding(lugged_ding.as_ref())?;
    let readings = data.join(trec::READINGS);
    if readings.is_file() {
        out.add_trec(&trec::tests(&readings)?)?;
    }
    Ok(out)
}

/// The plate tests of the measured data, from their bags.
///
/// # Errors
/// What a file lacks.
pub fn plate_tests(data: &Path) -> Result<Vec<PlateTest>> {
    PLATES
        .iter()
        .map(|(name, diameter, surface)| {
            let of = format!("{} mm disc", (1e3 * diameter).round());
            let plate = Plate::disc(*diameter)?;
            let record = read_press(data, name, (&of, plate), Some(*surface))?;
            Ok(record.test)
        })
        .collect()
}

/// One record of the press of the measured data: force from `stem.bag`, height from `stem.txt`; `name` and `plate` are
/// what is pressed. The surface of the soil is a height (m), or where the force begins.
///
/// # Errors
/// What a file lacks.
pub fn read_press(
    data: &Path,
    stem: &str,
    (name, plate): (&str, Plate),
    surface: Option<f64>,
) -> Result<PlateRecord> {
    let file = |ending: &str| data.join(format!("{stem}.{ending}"));
    read_bag(
        name,
        plate,
        &BagSource {
            bag: file("bag"),
            topic: None,
            force: "wrench.wrench.force.z".to_owned(),
            stamp: Some("wrench.header.stamp".to_owned()),
            sign: -1.0,
        },
        &DepthColumn {
            file: file("txt"),
            height: 5,
            height_unit: 1e-3,
            clock: 7,
            controller: Some((6, 1e-3)),
            surface,
        },
    )
}
