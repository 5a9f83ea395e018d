//! Soils drawn from the intervals within which a soil's numbers are known.

use grouser_files::{Document, Section};
use grouser_rover::ground::Noise;
use grouser_terra::{Angle, Bekker, Pressure, Soil, SoilParams};

use crate::error::{Error, Result};

/// Half of a 95 % interval in standard deviations.
const HALF_WIDTH_SIGMA: f64 = 1.96;
/// How often a number is drawn again that its laws refuse.
const MAX_TRIES: u32 = 1000;
/// The stream of random numbers that draws use.
const STREAM: u64 = 71;

/// A number of a soil that an interval may be given for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Number {
    N,
    KC,
    KPhi,
    Cohesion,
    Phi,
    KShear,
    C1,
    C2,
}

impl Number {
    /// The keys of a soil file, and what their numbers are multiplied with to be SI.
    const ALL: [(&'static str, Self, f64); 8] = [
        ("n", Self::N, 1.0),
        ("k_c_kn_per_m_n1", Self::KC, 1e3),
        ("k_phi_kn_per_m_n2", Self::KPhi, 1e3),
        ("cohesion_kpa", Self::Cohesion, 1e3),
        ("phi_deg", Self::Phi, std::f64::consts::PI / 180.0),
        ("k_shear_m", Self::KShear, 1.0),
        ("c_1", Self::C1, 1.0),
        ("c_2", Self::C2, 1.0),
    ];

    fn of(self, p: &SoilParams) -> Option<f64> {
        Some(match self {
            Self::N => p.n,
            Self::KC | Self::KPhi => match p.pressure {
                Pressure::Bekker(Bekker { k_c, k_phi }) => {
                    if self == Self::KC {
                        k_c
                    } else {
                        k_phi
                    }
                }
                _ => return None,
            },
            Self::Cohesion => p.cohesion,
            Self::Phi => p.phi.rad(),
            Self::KShear => p.k_shear,
            Self::C1 => p.c_1,
            Self::C2 => p.c_2,
        })
    }

    fn set(self, p: &mut SoilParams, value: f64) {
        match self {
            Self::N => p.n = value,
            Self::KC | Self::KPhi => {
                if let Pressure::Bekker(bekker) = &mut p.pressure {
                    if self == Self::KC {
                        bekker.k_c = value;
                    } else {
                        bekker.k_phi = value;
                    }
                }
            }
            Self::Cohesion => p.cohesion = value,
            Self::Phi => p.phi = Angle::from_rad(value),
            Self::KShear => p.k_shear = value,
            Self::C1 => p.c_1 = value,
            Self::C2 => p.c_2 = value,
        }
    }
}

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
    numbers: Vec<(&'static str, Number, [f64; 2])>,
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

    /// The numbers that vary, by their keys.
    pub fn keys(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.numbers.iter().map(|(key, ..)| *key)
    }

    /// `count` soils: each number is normal about the soil's own, with the interval's ends 1.96 standard deviations
    /// away on either side. Numbers are drawn independently of each other, since an interval holds no correlation.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] where the soil's own number lies outside its interval, [`Error::NoDraw`] where nearly all
    /// draws are illegal.
    pub fn draw(&self, soil: &Soil, count: usize, seed: u64) -> Result<Vec<Soil>> {
        let own = *soil.params();
        let mut noise = Noise::new(seed, STREAM);
        for (key, number, [low, high]) in &self.numbers {
            let value = number.of(&own).unwrap_or(f64::NAN);
            Error::check("soil within its intervals", key, value, (*low, *high), "SI")?;
        }
        (0..count)
            .map(|_| {
                for _ in 0..MAX_TRIES {
                    let mut params = own;
                    for (_, number, [low, high]) in &self.numbers {
                        let centre = number.of(&own).unwrap_or(f64::NAN);
                        let z = noise.normal();
                        let half = if z < 0.0 { centre - low } else { high - centre };
                        number.set(&mut params, centre + z * half / HALF_WIDTH_SIGMA);
                    }
                    if let Ok(soil) = Soil::new(params) {
                        return Ok(soil);
                    }
                }
                Err(Error::NoDraw {
                    field: self.numbers.first().map_or("n", |(key, ..)| key),
                    tries: MAX_TRIES,
                })
            })
            .collect()
    }
}

fn read(root: &Section<'_>) -> grouser_files::Result<SoilIntervals> {
    const ANY: (f64, f64) = (-1e12, 1e12);
    let mut numbers = Vec::new();
    for (key, number, unit) in Number::ALL {
        let interval = root.section(key, |s| -> grouser_files::Result<_> {
            let low = s.number("low", ANY)?;
            Ok([low * unit, s.number("high", (low, ANY.1))? * unit])
        })?;
        numbers.extend(interval.map(|interval| (key, number, interval)));
    }
    Ok(SoilIntervals {
        source: root.text("source")?.to_owned(),
        numbers,
    })
}
