//! `[wheel]`, `[soil]`, `[state]` and `[robust]`: the numbers that are fixed, in one world or several.

use grouser_files::gravity::read_gravity;
use grouser_files::{Section, nearest};
use grouser_opt::{Measure, Uncertainty, sample};
use grouser_terra::{Angle, EARTH_GRAVITY_M_PER_S2, RigidWheel, Soil, SoilParams, catalogue};

use crate::builder::DesignBuilder;
use crate::design::WorldInputs;
use crate::error::{Error, Result};
use crate::quantity::{Fixed, Parameter, Place};
use crate::scope::Scope;

const FINITE: (f64, f64) = (f64::MIN, f64::MAX);

/// The soil's key and all fixed numbers.
pub(super) fn read_fixed(root: &Section<'_>, builder: &mut DesignBuilder) -> Result<()> {
    let fixed = &mut builder.fixed;
    root.section("wheel", |s| {
        read_section(s, Place::Wheel, fixed)?;
        let size = |parameter| fixed.get(parameter).unwrap_or(0.1);
        let wheel = RigidWheel::new(size(Parameter::Radius), size(Parameter::Width));
        refuse(s, wheel.err())
    })?;
    let key = root.section("soil", |section| {
        let key = section.optional_text("key")?;
        if let Some(key) = key {
            fill_from_catalogue(section, "key", key, fixed)?;
        }
        read_section(section, Place::Soil, fixed)?;
        refuse(section, soil_of(fixed).err())?;
        Ok::<_, Error>(key.map(str::to_owned))
    })?;
    builder.soil = key.flatten();
    root.section("state", |s| {
        read_section(s, Place::State, fixed)?;
        read_mass(s, fixed)
    })?;
    Ok(())
}

/// `mass_kg` in place of `load_n`, under `gravity_m_per_s2` (a number, earth, moon or mars); the Earth's where it is
/// absent. The numbers of the soil do not change with it.
fn read_mass(section: &Section<'_>, fixed: &mut Fixed) -> Result<()> {
    let gravity = read_gravity(section)?;
    let mass = section.optional_number("mass_kg", (0.0, 1e12))?;
    let wrong = match mass {
        Some(_) if fixed.get(Parameter::Load).is_some() => {
            Some("both `load_n` and `mass_kg` are given; exactly one of them can be")
        }
        None if gravity.is_some() => Some("`gravity_m_per_s2` has an effect only with `mass_kg`"),
        _ => None,
    };
    if let Some(message) = wrong {
        return Err(Error::Contradiction {
            at: section.place(),
            message: message.to_owned(),
        });
    }
    if let Some(mass) = mass {
        fixed.set(
            Parameter::Load,
            mass * gravity.unwrap_or(EARTH_GRAVITY_M_PER_S2),
        );
    }
    Ok(())
}

fn read_section(section: &Section<'_>, place: Place, fixed: &mut Fixed) -> Result<()> {
    for (parameter, name, own, _) in Parameter::ALL {
        let limits = match parameter {
            Parameter::Slip => (-1.0, 1.0),
            Parameter::Slope => (-89.9, 89.9),
            Parameter::Theta => (-90.0, 90.0),
            _ => FINITE,
        };
        if own == place
            && let Some(value) = section.optional_number(name, limits)?
        {
            fixed.set(parameter, value);
        }
    }
    Ok(())
}

/// The soil of the numbers that are given, with harmless ones in place of the others.
fn soil_of(fixed: &Fixed) -> grouser_terra::Result<Soil> {
    let or = |parameter, other| fixed.get(parameter).unwrap_or(other);
    let moduli = [Parameter::KC, Parameter::KPhi].map(|parameter| 1e3 * or(parameter, 1.0));
    let open = Soil::bekker(moduli[0], moduli[1], or(Parameter::Exponent, 1.0))
        .cohesion(1e3 * or(Parameter::Cohesion, 0.0))
        .phi(Angle::from_deg(or(Parameter::Phi, 30.0)))
        .k_shear(or(Parameter::KShear, 0.01))
        .stress_position(or(Parameter::C1, 0.0), or(Parameter::C2, 0.0));
    Soil::new(SoilParams {
        n_1: or(Parameter::ExponentDriving, 0.0),
        n_2: or(Parameter::ExponentBraking, 0.0),
        rebound: or(Parameter::Rebound, 0.0),
        ..open.params()?
    })
}

/// Refuses a number of the section that the laws refuse.
fn refuse(section: &Section<'_>, error: Option<grouser_terra::Error>) -> Result<()> {
    let refused = match error {
        Some(grouser_terra::Error::OutOfRange(range)) => section.refused(&range),
        _ => None,
    };
    refused.map_or(Ok(()), |error| Err(error.into()))
}

/// Copies the numbers of a soil of the catalogue.
fn fill_from_catalogue(
    section: &Section<'_>,
    field: &str,
    key: &str,
    fixed: &mut Fixed,
) -> Result<()> {
    let Some(entry) = catalogue::find(key) else {
        return Err(Error::UnknownSoil {
            at: section.place_of(field),
            key: key.chars().take(64).collect(),
            meant: nearest(key, catalogue::entries().iter().map(|e| e.key)),
        });
    };
    for (parameter, value) in [
        (Parameter::Exponent, Some(entry.n)),
        (Parameter::ExponentDriving, Some(entry.n_1)),
        (Parameter::KC, Some(entry.k_c_kn)),
        (Parameter::KPhi, Some(entry.k_phi_kn)),
        (Parameter::Cohesion, Some(entry.cohesion_kpa)),
        (Parameter::Phi, Some(entry.phi_deg)),
        (Parameter::KShear, entry.k_shear),
        (Parameter::C1, entry.c_1),
        (Parameter::C2, entry.c_2),
    ] {
        // What the source does not give stays as it was: the file may give it.
        if let Some(value) = value {
            fixed.set(parameter, value);
        }
    }
    Ok(())
}

/// `[robust]`: a measure, and several soils or ranges of numbers.
pub(super) fn read_worlds(root: &Section<'_>, builder: &mut DesignBuilder) -> Result<()> {
    let (fixed, seed, scope) = (builder.fixed, builder.seed, builder.scope());
    let scope = &scope;
    root.section("robust", |section| {
        let worst = Measure::WorstCase;
        let measure = match section.choice(
            "measure",
            &[("worst_case", 0), ("mean_plus_deviations", 1), ("cvar", 2)],
        )? {
            1 => Measure::MeanPlusDeviations {
                kappa: section.number("kappa", (0.0, 1e6))?,
            },
            2 => Measure::ConditionalValueAtRisk {
                alpha: section.number("alpha", (0.0, 0.999_999))?,
            },
            _ => worst,
        };
        let soils = section.texts("soils")?;
        let samples = section.optional_integer("samples")?;
        let ranges = section
            .section("ranges", |ranges| read_ranges(ranges, scope))?
            .unwrap_or_default();
        let deviations = section
            .section("deviations", |s| read_deviations(s, scope, &fixed))?
            .unwrap_or_default();
        let kinds = usize::from(!soils.is_empty())
            + usize::from(!ranges.is_empty())
            + usize::from(!deviations.is_empty());
        if kinds != 1 {
            return Err(Error::Contradiction {
                at: section.place(),
                message:
                    "[robust] takes exactly one of `soils`, [robust.ranges] and [robust.deviations]"
                        .to_owned(),
            });
        }
        let worlds = if soils.is_empty() {
            let count = samples
                .and_then(|n| usize::try_from(n).ok())
                .filter(|n| (2..=10_000).contains(n));
            let Some(count) = count else {
                return Err(Error::Contradiction {
                    at: section.place_of("samples"),
                    message: "[robust] needs `samples`, a whole number in [2, 10000]".to_owned(),
                });
            };
            sampled(root, &ranges, &deviations, &fixed, (count, seed))?
        } else {
            soils
                .iter()
                .map(|key| {
                    let mut own = fixed;
                    fill_from_catalogue(section, "soils", key, &mut own)?;
                    Ok(WorldInputs {
                        name: (*key).to_owned(),
                        fixed: own,
                    })
                })
                .collect::<Result<Vec<_>>>()?
        };
        builder.measure = measure;
        builder.sampled = soils.is_empty();
        builder.worlds = worlds;
        Ok::<_, Error>(())
    })?;
    Ok(())
}

/// Parameters that vary: (parameter, low, high) or (parameter, mean, deviation).
type Varied = Vec<(Parameter, f64, f64)>;

fn varied(entry: &grouser_files::Entry<'_, '_>, scope: &Scope) -> Result<Parameter> {
    let refuse = |reason| Error::Name {
        at: entry.place().clone(),
        name: entry.name().chars().take(64).collect(),
        what: "number that varies from world to world",
        reason,
    };
    let Some(parameter) = Parameter::named(entry.name()) else {
        return Err(refuse("it is none of [wheel], [soil] and [state]"));
    };
    if scope.is_replaced(parameter) {
        return Err(refuse("it is a variable"));
    }
    Ok(parameter)
}

fn read_ranges(section: &Section<'_>, scope: &Scope) -> Result<Varied> {
    section
        .entries()
        .iter()
        .map(|entry| {
            let parameter = varied(entry, scope)?;
            let (low, high) = entry.range()?;
            Ok((parameter, low, high))
        })
        .collect()
}

fn read_deviations(section: &Section<'_>, scope: &Scope, fixed: &Fixed) -> Result<Varied> {
    section
        .entries()
        .iter()
        .map(|entry| {
            let parameter = varied(entry, scope)?;
            let mean = fixed.get(parameter).ok_or_else(|| Error::Contradiction {
                at: entry.place().clone(),
                message: format!("`{}` has a deviation but no mean", entry.name()),
            })?;
            let deviation = entry.number((f64::MIN_POSITIVE, f64::MAX))?;
            Ok((parameter, mean, deviation))
        })
        .collect()
}

fn sampled(
    root: &Section<'_>,
    ranges: &Varied,
    deviations: &Varied,
    fixed: &Fixed,
    (count, seed): (usize, u64),
) -> Result<Vec<WorldInputs>> {
    let list = if ranges.is_empty() {
        deviations
    } else {
        ranges
    };
    let uncertainty = if ranges.is_empty() {
        Uncertainty::Normal {
            mean: list.iter().map(|(_, mean, _)| *mean).collect(),
            covariance: (0..list.len())
                .map(|i| {
                    let mut row = vec![0.0; list.len()];
                    row[i] = list[i].2 * list[i].2;
                    row
                })
                .collect(),
        }
    } else {
        Uncertainty::Ranges {
            low: list.iter().map(|(_, low, _)| *low).collect(),
            high: list.iter().map(|(_, _, high)| *high).collect(),
        }
    };
    let samples = sample(&uncertainty, count, seed).map_err(|source| Error::Problem {
        file: root.place().file,
        source,
    })?;
    Ok(samples
        .into_iter()
        .enumerate()
        .map(|(index, values)| {
            let mut own = *fixed;
            for ((parameter, ..), value) in list.iter().zip(values) {
                own.set(*parameter, value);
            }
            WorldInputs {
                name: format!("sample {}", index + 1),
                fixed: own,
            }
        })
        .collect())
}
