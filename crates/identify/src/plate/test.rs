//! One plate test.

use std::path::Path;

use crate::error::{Error, Result};
use crate::table::{Column, Table};

/// A plate.
///
/// ```
/// use grouser_identify::plate::Plate;
///
/// let plate = Plate::disc(0.1)?; // m
/// assert!((plate.area - 0.007_853_98).abs() < 1e-8 && plate.width == 0.05);
/// assert!(Plate::disc(f64::NAN).is_err());
/// # Ok::<(), grouser_identify::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate {
    /// Area, m².
    pub area: f64,
    /// Bekker's b, m: the radius of a disc, the shorter side of a rectangle.
    pub width: f64,
}

impl Plate {
    /// A disc of `diameter` (m).
    ///
    /// # Errors
    /// [`Error::Missing`] unless the diameter is a positive number.
    pub fn disc(diameter: f64) -> Result<Self> {
        if !(diameter > 0.0 && diameter.is_finite()) {
            return Err(Error::Missing {
                what: "the plate's diameter in m",
                needed_by: format!("{diameter} is no diameter"),
            });
        }
        Ok(Self {
            area: 0.25 * std::f64::consts::PI * diameter * diameter,
            width: 0.5 * diameter,
        })
    }
}

/// Force against depth under one plate, loading only.
#[derive(Clone, Debug, PartialEq)]
pub struct PlateTest {
    /// What it is called.
    pub name: String,
    /// The plate.
    pub plate: Plate,
    /// Depth below the surface, m.
    pub depth: Vec<f64>,
    /// Force, N, positive downwards on the ground.
    pub force: Vec<f64>,
}

impl PlateTest {
    /// Pressure at a reading, Pa.
    ///
    /// ```
    /// use grouser_identify::plate::{Plate, PlateTest};
    ///
    /// let plate = Plate { area: 0.01, width: 0.05 };
    /// let test = PlateTest { name: "disc".into(), plate, depth: vec![0.01], force: vec![200.0] };
    /// assert_eq!(test.pressure(0), 20e3); // Pa
    /// ```
    #[must_use]
    pub fn pressure(&self, index: usize) -> f64 {
        self.force[index] / self.plate.area
    }
}

const DEPTH: Column = Column(&[("depth_m", 1.0), ("depth_mm", 1e-3)]);
const FORCE: Column = Column(&[("force_n", 1.0), ("force_kn", 1e3)]);
const DIAMETER: Column = Column(&[("plate_diameter_m", 1.0), ("plate_diameter_mm", 1e-3)]);

/// The plate tests of a table: columns `depth_m` or `depth_mm`, `force_n` or `force_kn`, `plate_diameter_m` or
/// `plate_diameter_mm`, and `test` with the name of each row's test where there are several.
///
/// # Errors
/// As [`Table::numbers`] and [`Table::refuse_unread`]; [`Error::Content`] for a test whose plate changes.
///
/// ```
/// let tests = grouser_identify::plate::read_table("../../examples/bevameter/plates.csv".as_ref())?;
/// assert!(tests.len() > 1 && tests[0].depth.len() == tests[0].force.len());
/// # Ok::<(), grouser_identify::Error>(())
/// ```
pub fn read_table(path: &Path) -> Result<Vec<PlateTest>> {
    let table = Table::read(path)?;
    table.refuse_unread(&[DEPTH, FORCE, DIAMETER])?;
    let depth = table.numbers(DEPTH)?;
    let force = table.numbers(FORCE)?;
    let diameter = table.numbers(DIAMETER)?;
    let names = table.texts("test");
    let mut tests: Vec<PlateTest> = Vec::new();
    for row in 0..table.len() {
        let name = names.as_ref().map_or("plate", |names| names[row]);
        let plate = Plate::disc(diameter[row])?;
        let known = tests.iter().position(|test| test.name == name);
        let place = known.unwrap_or_else(|| {
            tests.push(PlateTest {
                name: name.to_owned(),
                plate,
                depth: Vec::new(),
                force: Vec::new(),
            });
            tests.len() - 1
        });
        let test = &mut tests[place];
        if test.plate != plate {
            return Err(Error::Content {
                path: path.to_owned(),
                message: format!(
                    "row {}: the plate of test `{name}` changes from {} m to {} m",
                    row + 1,
                    2.0 * test.plate.width,
                    2.0 * plate.width
                ),
            });
        }
        test.depth.push(depth[row]);
        test.force.push(force[row]);
    }
    Ok(tests)
}
