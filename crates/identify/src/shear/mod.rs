//! Shear tests: cohesion, friction and the shear modulus from shear stress against displacement.

use std::path::Path;

use grouser_opt::{Exact, Functions};
use grouser_real::Scalar;
use grouser_terra::{MohrCoulomb, mobilised_janosi};

use crate::branches::{Branch, branches};
use crate::error::{Error, Result};
use crate::least_squares::{
    Bounded, Fit, Interval, Loss, Settings, Uncertainty, fit, profile, redundancy,
};
use crate::table::{Column, Table};

/// One reading of a shear test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShearReading {
    /// Normal stress, Pa.
    pub normal: f64,
    /// Shear displacement, m.
    pub displacement: f64,
    /// Shear stress, Pa.
    pub shear: f64,
}

/// What shear tests determine of a soil.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ShearFit {
    /// Cohesion, Pa; angle of friction, rad; shear modulus K, m.
    pub values: [f64; 3],
    /// Their standard errors, with the correlation from reading to reading taken into account.
    pub standard_errors: [f64; 3],
    /// Their 95 % intervals by profile likelihood, likewise widened.
    pub intervals: [Interval; 3],
    /// What the data say about them, likewise.
    pub uncertainty: Uncertainty,
    /// How many times more readings there are than independent ones (from the residuals' correlation).
    pub redundancy: f64,
    /// How many tests the readings are of.
    pub tests: usize,
    /// Places of the numbers whose errors and intervals do not contain how tests of the same soil differ, since no second test
    /// determines them.
    pub single_test: Vec<usize>,
    /// The fit; residuals in Pa.
    pub fit: Fit,
}

const NORMAL: Column = Column(&[("normal_stress_pa", 1.0), ("normal_stress_kpa", 1e3)]);
const DISPLACEMENT: Column = Column(&[("displacement_m", 1.0), ("displacement_mm", 1e-3)]);
const SHEAR: Column = Column(&[("shear_stress_pa", 1.0), ("shear_stress_kpa", 1e3)]);

/// Reads `normal_stress_pa` or `_kpa`, `displacement_m` or `_mm`, `shear_stress_pa` or `_kpa`.
///
/// # Errors
/// As [`Table::numbers`] and [`Table::refuse_unread`].
///
/// ```
/// let readings = grouser_identify::shear::read_table("../../examples/bevameter/shear.csv".as_ref())?;
/// assert!(readings.iter().all(|reading| reading.normal > 0.0)); // Pa
/// # Ok::<(), grouser_identify::Error>(())
/// ```
pub fn read_table(path: &Path) -> Result<Vec<ShearReading>> {
    let table = Table::read(path)?;
    table.refuse_unread(&[NORMAL, DISPLACEMENT, SHEAR])?;
    let normal = table.numbers(NORMAL)?;
    let displacement = table.numbers(DISPLACEMENT)?;
    let shear = table.numbers(SHEAR)?;
    Ok((0..table.len())
        .map(|row| ShearReading {
            normal: normal[row],
            displacement: displacement[row],
            shear: shear[row],
        })
        .collect())
}

fn branches_of(readings: &[ShearReading]) -> Vec<Branch> {
    let displacement: Vec<f64> = readings.iter().map(|r| r.displacement).collect();
    let shear: Vec<f64> = readings.iter().map(|r| r.shear).collect();
    branches(&displacement, &shear, true)
}

/// The readings without those of a box or ring that is driven back.
///
/// ```
/// use grouser_identify::shear::{ShearReading, loading};
///
/// let reading = |displacement, shear| ShearReading { normal: 5e3, displacement, shear };
/// let forth = (1..=20).map(|i| reading(1e-3 * f64::from(i), 100.0 * f64::from(i)));
/// let back = [reading(18e-3, 900.0), reading(15e-3, 0.0)];
/// let record: Vec<ShearReading> = forth.chain(back).collect();
/// assert_eq!(loading(&record), record[..20]);
/// ```
#[must_use]
pub fn loading(readings: &[ShearReading]) -> Vec<ShearReading> {
    let pairs = readings.iter().zip(branches_of(readings));
    let kept = pairs.filter(|(_, branch)| !branch.is_unloading);
    kept.map(|(reading, _)| *reading).collect()
}

/// What K may be in a soil, m.
const MODULUS_LIMITS_M: (f64, f64) = (1e-6, 10.0);
/// Where searches for K begin, as shares of the longest displacement.
const K_SHEAR_STARTS: [f64; 7] = [0.2, 1.0, 0.45, 0.09, 0.04, 0.018, 0.008];

/// What K may be in tests of this `reach` (m): no less and no more than in a soil.
fn bounds_of_modulus(reach: f64) -> (f64, f64) {
    let (least, greatest) = MODULUS_LIMITS_M;
    let lower = (1e-6 * reach).clamp(least, 0.1 * greatest);
    (lower, (10.0 * reach).clamp(2.0 * lower, greatest))
}

struct Law<'a>(&'a [ShearReading]);

impl Functions for Law<'_> {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        let strength = MohrCoulomb {
            cohesion: x[0],
            phi: x[1],
        };
        for (slot, reading) in out.iter_mut().zip(self.0) {
            let shown = mobilised_janosi(R::from_f64(reading.displacement), x[2]);
            let said = strength.strength(R::from_f64(reading.normal)) * shown;
            *slot = said - R::from_f64(reading.shear);
        }
    }
}

/// c, φ and K by least squares on τ = (c + σ tan φ)(1 − e^(−j/K)).
///
/// Huber's threshold, if `loss` has one, is in Pa.
///
/// Source: \[JH61\] with Mohr-Coulomb's strength. Readings at one normal stress only do not separate cohesion
/// from friction, and readings past the rise alone do not determine K: the result names both. Errors are widened where
/// readings that follow each other have residuals that are alike, as those of plates
/// ([`fit_plates`](crate::plate::fit_plates)), and where tests differ by more than that; a test ends where the displacement
/// begins anew. All readings are of loading, in the order of time: [`loading`] leaves the others out.
///
/// # Errors
/// [`Error::TooFew`] for fewer readings than numbers.
///
/// ```
/// use grouser_identify::least_squares::Loss;
/// use grouser_identify::shear::{ShearReading, fit_shear};
///
/// // τ = (1 kPa + σ tan 30°)(1 − e^(−j/20 mm)) at two normal stresses
/// let tan = 30_f64.to_radians().tan();
/// let readings: Vec<ShearReading> = [5e3, 20e3]
///     .into_iter()
///     .flat_map(|normal| (1..=20).map(move |i| (normal, 5e-3 * f64::from(i))))
///     .map(|(normal, displacement)| ShearReading {
///         normal,
///         displacement,
///         shear: (1e3 + normal * tan) * (1.0 - (-displacement / 0.02).exp()),
///     })
///     .collect();
/// let [cohesion, phi, k_shear] = fit_shear(&readings, Loss::Squares)?.values;
/// assert!((cohesion - 1e3).abs() < 1.0 && (phi.to_degrees() - 30.0).abs() < 1e-3);
/// assert!((k_shear - 0.02).abs() < 1e-6);
/// # Ok::<(), grouser_identify::Error>(())
/// ```
pub fn fit_shear(readings: &[ShearReading], loss: Loss) -> Result<ShearFit> {
    let most = readings.iter().map(|r| r.shear).fold(0.0, f64::max);
    let reach = readings.iter().map(|r| r.displacement).fold(0.0, f64::max);
    if readings.len() < 3 || !(most > 0.0 && reach > 0.0) {
        return Err(Error::TooFew {
            residuals: readings.len(),
            parameters: 3,
        });
    }
    let (least, greatest) = bounds_of_modulus(reach);
    // far from its K a search may take all readings for mobilised, where K has no effect: the best of several
    let from = |k_shear: f64| {
        [
            Bounded {
                start: 0.0,
                lower: 0.0,
                upper: 10.0 * most,
            },
            Bounded {
                start: 0.5,
                lower: 0.0,
                upper: 1.2,
            },
            Bounded {
                start: (k_shear * reach).clamp(least, greatest),
                lower: least,
                upper: greatest,
            },
        ]
    };
    let settings = Settings {
        loss,
        ..Settings::default()
    };
    let law = Exact(Law(readings));
    let mut found = fit(&law, readings.len(), &from(K_SHEAR_STARTS[0]), &settings)?;
    for k_shear in &K_SHEAR_STARTS[1..] {
        let other = fit(&law, readings.len(), &from(*k_shear), &settings)?;
        if other.cost < found.cost {
            found = other;
        }
    }
    let branches = branches_of(readings);
    let tests = branches.chunk_by(|a, b| a.test == b.test);
    let lengths: Vec<usize> = tests.map(<[Branch]>::len).collect();
    let mut rest = found.residuals.iter().copied();
    let series = lengths
        .iter()
        .map(|length| rest.by_ref().take(*length).collect::<Vec<_>>());
    let redundancy = redundancy(series.map(Vec::into_iter));
    let alone = Uncertainty::from_fit(&found, loss).of_alike(&found, redundancy);
    let mut uncertainty = alone.clone();
    let single_test = uncertainty.add_tests(&found, loss, &lengths);
    let mut intervals = [Interval {
        low: None,
        high: None,
    }; 3];
    for (index, slot) in intervals.iter_mut().enumerate() {
        let own = profile(&law, &found, index, 0.95, &settings)?;
        let widening = redundancy.sqrt() * uncertainty.widening(&alone, index);
        *slot = own.widened(found.x[index], widening);
    }
    uncertainty.judge_intervals(&found, &intervals);
    let three = |list: &[f64]| [list[0], list[1], list[2]];
    Ok(ShearFit {
        values: three(&found.x),
        standard_errors: three(&uncertainty.standard_errors),
        intervals,
        uncertainty,
        redundancy,
        tests: lengths.len(),
        single_test,
        fit: found,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::least_squares::Verdict;

    fn readings(normals: &[f64]) -> Vec<ShearReading> {
        // c 1.2 kPa, φ 31°, K 15 mm, with a wave of 40 Pa for noise
        let mut out = Vec::new();
        for (i, normal) in normals.iter().enumerate() {
            for step in 1..=20 {
                let displacement = 0.003 * f64::from(step);
                let strength = 1200.0 + normal * 31_f64.to_radians().tan();
                let noise = 40.0 * (1.7 * f64::from(step) + i as f64).sin();
                out.push(ShearReading {
                    normal: *normal,
                    displacement,
                    shear: strength * (1.0 - (-displacement / 0.015).exp()) + noise,
                });
            }
        }
        out
    }

    /// Readings without a rise leave K at its least, which is the least that a soil may have.
    #[test]
    fn a_modulus_that_the_readings_leave_open_is_one_that_a_soil_may_have() {
        let reading = |i: u32| ShearReading {
            normal: 5e3 * f64::from(1 + i % 3),
            displacement: 2e-4 * f64::from(1 + i),
            shear: 500.0 + 2e3 * f64::from(1 + i % 3),
        };
        let readings: Vec<ShearReading> = (0..12).map(reading).collect();
        let [_, _, k_shear] = fit_shear(&readings, Loss::Squares).unwrap().values;
        assert!((1e-6..=10.0).contains(&k_shear), "{k_shear}");
    }

    #[test]
    fn a_modulus_is_bounded_by_the_reach_and_by_what_soils_have() {
        let close = |(found, wanted): (f64, f64)| (found / wanted - 1.0).abs() < 1e-12;
        for (reach, least, greatest) in [
            (1e-9, 1e-6, 2e-6),
            (1e-7, 1e-6, 2e-6),
            (0.05, 1e-6, 0.5),
            (0.8, 1e-6, 8.0),
            (3.0, 3e-6, 10.0),
            (1e9, 1.0, 10.0),
        ] {
            let found = bounds_of_modulus(reach);
            assert!(
                [(found.0, least), (found.1, greatest)]
                    .into_iter()
                    .all(close),
                "{reach}: {found:?}"
            );
        }
    }

    #[test]
    fn the_soil_is_found_within_its_intervals() {
        let found = fit_shear(&readings(&[2e3, 6e3, 12e3]), Loss::Squares).unwrap();
        for (index, truth) in [1200.0, 31_f64.to_radians(), 0.015].into_iter().enumerate() {
            let interval = found.intervals[index];
            assert!(interval.low.unwrap() < truth && truth < interval.high.unwrap());
            let half = found.uncertainty.half_width(index, 0.95);
            assert!((found.values[index] - truth).abs() < half);
        }
    }

    /// Tests whose strengths differ, with noise that lasts: what widens errors widens intervals.
    #[test]
    fn an_interval_contains_what_is_alike_and_how_tests_differ() {
        let mut all = readings(&[2e3, 6e3, 12e3, 2e3, 6e3, 12e3]);
        for (i, reading) in all.iter_mut().enumerate() {
            let wave = 60.0 * (0.3 * i as f64).sin();
            reading.shear += wave + 40.0 * (i / 20 % 4) as f64;
        }
        let found = fit_shear(&all, Loss::Squares).unwrap();
        let own = Uncertainty::from_fit(&found.fit, Loss::Squares);
        let alone = own.of_alike(&found.fit, found.redundancy);
        assert!(found.redundancy > 2.0);
        assert!(found.uncertainty.widening(&alone, 0) > 1.2);
        for index in 0..3 {
            let (low, high) = (found.intervals[index].low, found.intervals[index].high);
            let half = found.uncertainty.half_width(index, 0.95);
            let ratio = 0.5 * (high.unwrap() - low.unwrap()) / half;
            assert!((ratio - 1.0).abs() < 0.1, "{index}: {ratio}");
        }
    }

    /// Noise that lasts, as a logger's: of 60 shear boxes of four loads the intervals hold the truth in 57 ± 1.7 where
    /// noise is independent, and nearly as often where neighbours have a correlation of 0.9.
    #[test]
    fn readings_that_are_alike_widen_the_intervals() {
        let mut state = 1_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        // twelve uniform numbers: nearly normal, of variance 1
        let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        for (rho, least) in [(0.0, 52), (0.9, 46)] {
            let mut hits = [0; 3];
            for _ in 0..60 {
                let mut list = Vec::new();
                for load in [3e3, 6e3, 10e3, 15e3] {
                    let mut noise = normal();
                    for step in 1..=60 {
                        noise = rho * noise + (1.0 - rho * rho).sqrt() * normal();
                        let displacement = 1e-3 * f64::from(step);
                        let strength = 1600.0 + load * 34_f64.to_radians().tan();
                        list.push(ShearReading {
                            normal: load,
                            displacement,
                            shear: strength * (1.0 - (-displacement / 0.016).exp()) + 100.0 * noise,
                        });
                    }
                }
                let found = fit_shear(&list, Loss::Squares).unwrap();
                let truth = [1600.0, 34_f64.to_radians(), 0.016];
                for ((hits, truth), interval) in hits.iter_mut().zip(truth).zip(found.intervals) {
                    let (low, high) = (interval.low.unwrap_or(0.0), interval.high.unwrap());
                    *hits += i32::from(low <= truth && truth <= high);
                }
            }
            println!("correlation {rho}: c, φ and K in {hits:?} of 60");
            assert!(hits.iter().all(|hits| *hits >= least), "{rho}: {hits:?}");
        }
    }

    #[test]
    fn one_normal_stress_cannot_tell_cohesion_from_friction() {
        let found = fit_shear(&readings(&[6e3]), Loss::Squares).unwrap();
        let verdicts = &found.uncertainty.verdicts;
        let lost = verdicts[..2].iter().all(|v| *v != Verdict::Identified);
        assert!(lost, "{verdicts:?}");
        assert_eq!(verdicts[2], Verdict::Identified);
    }

    #[test]
    fn an_outlier_pulls_with_a_bounded_force() {
        let mut spoilt = readings(&[2e3, 6e3, 12e3]);
        spoilt[30].shear *= 3.0;
        let plain = fit_shear(&spoilt, Loss::Squares).unwrap();
        let robust = fit_shear(&spoilt, Loss::Huber { threshold: 60.0 }).unwrap();
        let off = |fit: &ShearFit| (fit.values[1] - 31_f64.to_radians()).abs();
        assert!(
            off(&robust) < 0.2 * off(&plain),
            "{} {}",
            off(&robust),
            off(&plain)
        );
    }
}
