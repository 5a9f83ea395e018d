//! Is a relief, a robot or a soil the one that a map was made for?

use std::collections::BTreeMap;
use std::path::Path;

use grouser_files::soil::names_file;
use grouser_rover::robot::RobotModel;
use grouser_terra::Soil;

use super::PlanMap;
use crate::error::{Error, Result};
use crate::headings::Headings;
use crate::pose::Footprint;
use crate::raster::Dem;

/// A map holds pitches as numbers of 7 digits; those of another relief or robot differ by more than this, deg.
const MAX_PITCH_DIFFERENCE_DEG: f32 = 1e-3;
/// Places differ by more than this share of a cell where the relief lies elsewhere.
const MAX_SHIFT_SHARE: f64 = 1e-3;
/// Rows of the relief that are read at once.
const ROWS_AT_ONCE: u32 = 64;

impl PlanMap {
    /// Refuses a relief, a robot or a soil that the map was not made for, as far as the map shows it: the size and the
    /// place of the relief, the name and the turning radius of the robot, the name of the soil (a key of the catalogue, or
    /// a file, whose folder does not count) with its numbers and laws, and the pitch of the robot on the relief at every cell
    /// and heading.
    ///
    /// # Errors
    /// [`Error::OtherMap`] for the first that differs, [`Error::Terrain`] for a relief that cannot be read.
    pub fn check_sources(
        &self,
        dem: &mut Dem,
        model: &RobotModel,
        (name, soil): (&str, &Soil),
    ) -> Result<()> {
        let layout = &self.layout;
        let own = layout.clone().of_robot(model).of_soil(name, soil);
        let other = |of, field: &str, value: String, limit: String| {
            if value == limit {
                return Ok(());
            }
            Err(Error::OtherMap {
                of,
                field: field.to_owned(),
                value,
                limit,
            })
        };
        other("the robot", "name", own.robot, layout.robot.clone())?;
        let radius = |radius: f64| format!("{radius} m");
        other(
            "the robot",
            "turning radius",
            radius(own.turning_radius),
            radius(layout.turning_radius),
        )?;
        let first = layout.soils.first().map_or("", String::as_str);
        other(
            "the soil",
            "name",
            without_folder(name),
            without_folder(first),
        )?;
        if !layout.soil_numbers.is_empty() {
            let (own, of_map) = (numbers(&own.soil_numbers), numbers(&layout.soil_numbers));
            for key in own.keys().chain(of_map.keys()) {
                let [found, expected] = [&own, &of_map]
                    .map(|numbers| numbers.get(key).copied().unwrap_or("left out").to_owned());
                other("the soil", key, found, expected)?;
            }
        }

        let relief = "the elevation";
        let (columns, rows) = dem.size();
        let size = |columns: u32, rows: u32| format!("{columns} by {rows} cells");
        let (found, expected) = (size(columns, rows), size(layout.columns, layout.rows));
        other(relief, "size", found, expected)?;
        for (name, (column, row)) in [
            ("upper left cell", (0, 0)),
            ("lower right cell", (columns - 1, rows - 1)),
        ] {
            let places = [dem.georeference(), &layout.georeference];
            let places = places.map(|at| at.centre(column, row));
            let apart = match places {
                [Some(a), Some(b)] => {
                    (a[0] - b[0]).hypot(a[1] - b[1]) > MAX_SHIFT_SHARE * layout.cell
                }
                [a, b] => a.is_some() != b.is_some(),
            };
            if apart {
                let place = |at: Option<[f64; 2]>| {
                    at.map_or("nowhere".to_owned(), |[x, y]| format!("at ({x}, {y}) m"))
                };
                let [found, expected] = places.map(place);
                other(relief, name, found, expected)?;
            }
        }
        self.check_pitches(dem, model)
    }

    fn check_pitches(&self, dem: &mut Dem, model: &RobotModel) -> Result<()> {
        let layout = &self.layout;
        let headings: Headings = layout.headings;
        let footprints = Footprint::all(model, headings, layout.cell);
        let reach = footprints.iter().map(Footprint::reach).max().unwrap_or(0);
        let reach = u32::try_from(reach).unwrap_or(u32::MAX).saturating_add(1);
        let mut poses = self.pitch.iter();
        for first in (0..layout.rows).step_by(ROWS_AT_ONCE as usize) {
            let rows = first..layout.rows.min(first + ROWS_AT_ONCE);
            let around = first.saturating_sub(reach)..rows.end.saturating_add(reach);
            let window = dem.window(around)?;
            let cells = rows.flat_map(|row| (0..layout.columns).map(move |column| (row, column)));
            for (row, column) in cells {
                let height = |down: i64, right: i64| {
                    window.height(i64::from(row) + down, i64::from(column) + right)
                };
                for (footprint, expected) in footprints.iter().zip(&mut poses) {
                    let found = footprint.pose(height).map_or(f32::NAN, |pose| {
                        #[allow(clippy::cast_possible_truncation, reason = "as the map holds it")]
                        let pitch = pose.pitch.to_degrees() as f32;
                        pitch
                    });
                    let same = (found - expected).abs() <= MAX_PITCH_DIFFERENCE_DEG
                        || found.is_nan() && expected.is_nan();
                    if !same {
                        let [x, y] = layout.place_of(column, row);
                        let shown = |pitch: f32| {
                            if pitch.is_nan() {
                                "unknown".to_owned()
                            } else {
                                format!("{pitch} deg")
                            }
                        };
                        return Err(Error::OtherMap {
                            of: "the relief or the robot",
                            field: "pitch".to_owned(),
                            value: format!("{} at ({x}, {y}) m", shown(found)),
                            limit: shown(*expected),
                        });
                    }
                }
            }
        }
        Ok(())
    }
}

/// Keys and values of a soil file.
fn numbers(text: &str) -> BTreeMap<&str, &str> {
    text.lines()
        .filter_map(|line| line.split_once(" = "))
        .collect()
}

/// A soil's key, or the name of its file.
fn without_folder(soil: &str) -> String {
    let file = Path::new(soil)
        .file_name()
        .filter(|_| names_file(soil.as_ref()));
    file.map_or(soil.to_owned(), |name| name.to_string_lossy().into_owned())
}
