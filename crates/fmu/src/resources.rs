//! The resources of a unit: the soil as a soil file, the wheel and the start of the inputs as another.

use std::path::Path;

use grouser_files::soil::{self, SoilFile};
use grouser_files::wheel_sizes::with_grousers;
use grouser_files::{Document, TomlText};
use grouser_terra::catalogue::Completion;
use grouser_terra::{GrouserRule, RigidWheel};

use crate::error::Result;
use crate::model::Model;
use crate::variables::{INPUTS, VARIABLES};

/// Any number; the laws check more closely.
const FINITE: (f64, f64) = (f64::MIN, f64::MAX);

/// The text of the soil's resource.
pub(crate) fn soil_text(model: &Model, (name, source): (&str, &str)) -> Result<String> {
    let file = SoilFile::new(name, source, *model.pair().soil().params());
    Ok(soil::to_toml(&file, &[])?)
}

/// The text of the wheel's resource.
pub(crate) fn wheel_text(model: &Model, token: &str) -> String {
    let wheel = model.pair().wheel();
    let mut text = TomlText::new(&[]);
    text.text("token", token);
    text.number("radius_m", wheel.radius());
    text.number("width_m", wheel.width());
    if let Some(grousers) = wheel.grousers()
        && let GrouserRule::Lugs { count, thickness } = grousers.rule
    {
        text.number("grouser_height_m", grousers.height);
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a whole number of lugs, far below 2^63"
        )]
        text.whole("grouser_count", count as i64);
        text.number("grouser_thickness_m", thickness);
    }
    // the start
    for (variable, value) in VARIABLES.iter().zip(model.start) {
        text.number(variable.name, value);
    }
    text.finish()
}

/// The model of a folder of resources, and its token.
pub(crate) fn read(folder: &Path) -> Result<(Model, String)> {
    let soil = soil::read(&folder.join("soil.toml"))?.completed(&Completion::default())?;
    let document = Document::read(&folder.join("wheel.toml"))?;
    let (wheel, start, token) = document.parse(|root| {
        let bare = RigidWheel::new(
            root.number("radius_m", FINITE)?,
            root.number("width_m", FINITE)?,
        )
        .map_err(|source| root.refused_by_law(source))?;
        let mut start = [0.0; INPUTS];
        for (value, variable) in start.iter_mut().zip(VARIABLES) {
            *value = root.number(variable.name, FINITE)?;
        }
        let token = root.text("token")?.to_owned();
        grouser_files::Result::Ok((with_grousers(root, bare)?, start, token))
    })?;
    Ok((Model::new(wheel, soil, start)?, token))
}
