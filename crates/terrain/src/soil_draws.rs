//! Soils drawn from the intervals within which a soil's numbers are known.

use grouser_files::soil::SoilNumber;
use grouser_files::{Document, Section};
use grouser_rover::ground::Noise;
use grouser_terra::{OpenSoil, Soil};

use crate::error::{Error, Result};

/// Half of a 95 % interval in standard deviations.
const HALF_WIDTH_SIGMA: f64 = 1.96;
/// How often a number is drawn again that its laws refuse.
const MAX_TRIES: u32 = 1000;
/// The stream of random numbers that draws use.
const STREAM: u64 = 71;

/// The numbers of a soil that an interval may be given for.
const UNCERTAIN: [SoilNumber; 8] = [
    SoilNumber::Exponent,
    SoilNumber::KC,
    SoilNumber::KPhi,
    SoilNumber::Cohesion,
    SoilNumber::Phi,
    SoilNumber::KShear,
    SoilNumber::C1,
    SoilNumber::C2,
];

/// The 95 % intervals of a soil's numbers, as `identify` reports them. A file:
///
/// ```toml
/// format = 1
/// source = "wheel tests of 2026-03-02"
/// phi_deg = { low = 27.0, high = 33.0 }
/// cohesion_kpa = { low = 0.4, high = 1.6 }
/// # also n, k_c_kn_per_m_n1, k_phi_kn_per_m_n2, k_shear_m, c_1, c_2
/// ```
///
/// ```
/// use grouser_files::Document;
/// use grouser_terra::catalogue;
/// use grouser_terrain::SoilIntervals;
///
/// let text = "format = 1\nsource = \"a guess\"\nphi_deg = { low = 27.0, high = 33.0 }\n";
/// let intervals = SoilIntervals::parse(&Document::from_text("guess.toml", text.into())?)?;
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil().expect("complete");
/// let draws = intervals.draw(&soil, 64, 1)?;
/// let mean = draws.iter().map(|soil| soil.params().phi.deg()).sum::<f64>() / 64.0;
/// assert!((mean - 30.0).abs() < 1.0);
/// # Ok::<(), grouser_terrain::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SoilIntervals {
    source: String,
    numbers: Vec<(SoilNumber, (f64, f64))>,
}

impl SoilIntervals {
    /// Out of a document.
    ///
    /// # Errors
    /// What the file lacks or has wrong, with its place.
    pub fn parse(document: &Document) -> Result<Self> {
        Ok(document.parse(read)?)
    }

    /// Where the intervals come from.
    #[must_use]
    pub fn source(&self) -> &str {
        &self.source
    }

    /// `count` soils: each number is normal about the soil's own, with the interval's ends 1.96 standard deviations
    /// away on either side. Numbers are drawn independently of each other, since an interval holds no correlation.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] where the soil's own number lies outside its interval, [`Error::NoDraw`] where nearly all
    /// draws are illegal.
    pub fn draw(&self, soil: &Soil, count: usize, seed: u64) -> Result<Vec<Soil>> {
        let own = OpenSoil::from(*soil.params());
        let mut noise = Noise::new(seed, STREAM);
        let mut centres = Vec::with_capacity(self.numbers.len());
        for (number, limits) in &self.numbers {
            let centre = number.of(&own).ok_or(Error::Law {
                of: "soil within its intervals".to_owned(),
                source: grouser_terra::Error::Missing {
                    field: number.key(),
                    needed_by: "its interval",
                },
            })?;
            let of = "soil within its intervals";
            // in the unit of the key, which the file gives
            let unit = number.key_unit();
            let ends = (limits.0 / unit, limits.1 / unit);
            if !(limits.0 <= centre && centre <= limits.1) {
                Error::check(of, number.key(), centre / unit, ends, "")?;
            }
            centres.push(centre);
        }
        (0..count)
            .map(|_| {
                for _ in 0..MAX_TRIES {
                    let mut drawn = own;
                    for ((number, (low, high)), centre) in self.numbers.iter().zip(&centres) {
                        let z = noise.normal();
                        let half = if z < 0.0 { centre - low } else { high - centre };
                        number.put(&mut drawn, centre + z * half / HALF_WIDTH_SIGMA);
                    }
                    if let Ok(soil) = drawn.soil() {
                        return Ok(soil);
                    }
                }
                Err(Error::NoDraw {
                    field: self.numbers.first().map_or("n", |(number, _)| number.key()),
                    tries: MAX_TRIES,
                })
            })
            .collect()
    }
}

fn read(root: &Section<'_>) -> grouser_files::Result<SoilIntervals> {
    const ANY: (f64, f64) = (-1e12, 1e12);
    let mut numbers = Vec::new();
    for number in UNCERTAIN {
        let unit = number.key_unit();
        let interval = root.section(number.key(), |s| -> grouser_files::Result<_> {
            let low = s.number("low", ANY)?;
            Ok((low * unit, s.number("high", (low, ANY.1))? * unit))
        })?;
        numbers.extend(interval.map(|interval| (number, interval)));
    }
    Ok(SoilIntervals {
        source: root.text("source")?.to_owned(),
        numbers,
    })
}
