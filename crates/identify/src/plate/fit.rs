//! Bekker's exponent and moduli from plate tests.

use grouser_opt::{Exact, Functions};
use grouser_real::{Real, Scalar, median};

use super::left_out::{LeftOut, MIN_READINGS, Use};
use super::test::PlateTest;
use crate::branches::{Branch, branches};
use crate::error::{Error, Result};
use crate::least_squares::{
    Bounded, Fit, Interval, Loss, NORMAL_MEDIAN_SIZE, Settings, Uncertainty, Verdict, fit, profile,
    redundancy,
};

/// Rounds in which a robust fit and the scatter about it take turns.
const MAX_SCALES: usize = 30;
/// Scatters that differ by less than this share are the same.
const SAME_SCALE: f64 = 1e-4;
/// Readings without scatter count as if they had this one, in ln p.
const LEAST_SCALE: f64 = 1e-9;
/// The greatest modulus that soils may have, Pa/mⁿ.
const MAX_MODULUS: f64 = 1e12;

/// How plate tests are fitted.
///
/// ```
/// use grouser_identify::plate::PlateSettings;
///
/// let mut settings = PlateSettings::default();
/// settings.fit_datum = true; // the height of each test's surface is uncertain
/// assert_eq!(settings.least_depth, 2e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlateSettings {
    /// Readings at less depth are left out, m: there the surface's own roughness and the datum rule.
    pub least_depth: f64,
    /// Is the height of each test's surface fitted too?
    pub fit_datum: bool,
    /// What a residual costs, in multiples of the readings' scatter about the law, which the fit finds.
    pub loss: Loss,
}

impl Default for PlateSettings {
    fn default() -> Self {
        Self {
            least_depth: 2e-3,
            fit_datum: false,
            loss: Loss::Squares,
        }
    }
}

/// One identified number.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlateParameter {
    /// Its name, with its unit.
    pub name: String,
    /// Its value, SI.
    pub value: f64,
    /// Its standard error, with the correlation from reading to reading taken into account; NaN where the
    /// data do not determine.
    pub standard_error: f64,
    /// Its 95 % interval by profile likelihood, likewise widened.
    pub interval: Interval,
    /// What the data say about it.
    pub verdict: Verdict,
}

/// What plate tests determine of a soil.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlateFit {
    /// Sinkage exponent n.
    pub n: f64,
    /// k_c, N/m^(n+1); 0 with plates of one width only.
    pub k_c: f64,
    /// k_phi, N/m^(n+2); with plates of one width this holds all of k.
    pub k_phi: f64,
    /// The numbers with their uncertainty: n, then k_c and k_phi or k alone, then datums.
    pub parameters: Vec<PlateParameter>,
    /// k_c and k_phi with their uncertainty, linear about the fit; not identifiable with plates of one width.
    pub moduli: [PlateParameter; 2],
    /// Each test's readings that were used: index, and ln(p/p_model) there.
    pub residuals: Vec<Vec<(usize, f64)>>,
    /// How many readings were not used.
    pub left_out: LeftOut,
    /// Standard deviation of ln p about the law.
    pub relative_deviation: f64,
    /// How many times more readings there are than independent ones (from the residuals' correlation).
    pub redundancy: f64,
    /// How many tests the readings are of: a name has several where its depth begins anew.
    pub count: usize,
    /// Names of the parameters whose errors and intervals do not contain how tests of the same soil differ, since no second
    /// test determines them.
    pub single_test: Vec<String>,
    /// The fit.
    pub fit: Fit,
    /// What its numbers leave uncertain.
    uncertainty: Uncertainty,
}

impl PlateFit {
    /// By the delta method, from the moduli under the narrowest and the widest plate.
    fn find_errors_of_moduli(&mut self, tests: &[PlateTest], quantile: f64) {
        // k at an infinite width is k_phi
        let Some(mixtures) = self.scatter(tests, f64::INFINITY, true) else {
            return;
        };
        // places in what `scatter` gives
        for (modulus, place) in self.moduli.iter_mut().zip([2, 1]) {
            let squares = mixtures.iter().map(|moved| moved[place] * moved[place]);
            let error = squares.sum::<f64>().sqrt();
            let end = |value: f64| value.is_finite().then_some(value);
            modulus.standard_error = error;
            modulus.interval = Interval {
                low: end(modulus.value - quantile * error),
                high: end(modulus.value + quantile * error),
            };
            modulus.verdict = Verdict::Identified.of_share(error / modulus.value.abs());
        }
    }

    /// Do plates of several widths separate k_c from k_phi?
    #[must_use]
    pub fn is_separable(&self) -> bool {
        self.moduli[0].standard_error.is_finite()
    }

    /// How far (n, k_c/b + k_phi at the width b, k_c) move with one standard deviation of each independent mixture of what
    /// was fitted to `tests`, n held where it is not `free`; `None` where the tests do not determine them.
    pub(crate) fn scatter(
        &self,
        tests: &[PlateTest],
        width: f64,
        free: bool,
    ) -> Option<Vec<[f64; 3]>> {
        let shape = Shape::from_tests(tests);
        let fitted: Vec<usize> = (usize::from(!free)..=shape.moduli()).collect();
        let mixtures = self.uncertainty.scatter(&fitted)?;
        let moved = |mixture: &Vec<f64>| {
            // d exp(x) = exp(x) dx
            let modulus = |index: usize| Real::exp(self.fit.x[index]) * mixture[index];
            let (narrow, wide) = (modulus(1), modulus(shape.moduli()));
            let k = shape.between(narrow, wide, width);
            let k_c = shape.cohesive(narrow, wide);
            [mixture[0], k, k_c]
        };
        Some(mixtures.iter().map(moved).collect())
    }
}

/// ln p of each reading as a function of (n, ln k or ln k under the narrowest and the widest plate, datums).
struct Law<'a> {
    tests: &'a [PlateTest],
    used: &'a [Vec<usize>],
    shape: Shape,
    fit_datum: bool,
}

/// Plates of one width determine k alone; of several, k at the least and the greatest width.
#[derive(Clone, Copy)]
enum Shape {
    One,
    Two { least: f64, greatest: f64 },
}

impl Shape {
    fn from_tests(tests: &[PlateTest]) -> Self {
        let widths = tests.iter().map(|test| test.plate.width);
        let least = widths.clone().fold(f64::INFINITY, f64::min);
        let greatest = widths.fold(0.0, f64::max);
        if greatest > least * (1.0 + 1e-6) {
            Self::Two { least, greatest }
        } else {
            Self::One
        }
    }

    fn moduli(self) -> usize {
        match self {
            Self::One => 1,
            Self::Two { .. } => 2,
        }
    }

    /// k at a width from the moduli at the outer widths: linear in 1/b, as k_c/b + k_phi is.
    fn modulus<R: Scalar>(self, x: &[R], width: f64) -> R {
        match self {
            Self::One => x[1].exp(),
            Self::Two { .. } => self.between(x[1].exp(), x[2].exp(), width),
        }
    }

    /// k at a width from k at the least and at the greatest width, or from the only one.
    fn between<R: Scalar>(self, narrow: R, wide: R, width: f64) -> R {
        match self {
            Self::One => narrow,
            Self::Two { least, greatest } => {
                let share = (1.0 / width - 1.0 / greatest) / (1.0 / least - 1.0 / greatest);
                R::from_f64(share) * narrow + R::from_f64(1.0 - share) * wide
            }
        }
    }

    /// k_c from k at the least and at the greatest width.
    fn cohesive(self, narrow: f64, wide: f64) -> f64 {
        match self {
            Self::One => 0.0,
            Self::Two { least, greatest } => (narrow - wide) / (1.0 / least - 1.0 / greatest),
        }
    }
}

impl Functions for Law<'_> {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        let mut slots = out.iter_mut();
        for (index, (test, used)) in self.tests.iter().zip(self.used).enumerate() {
            let k = self.shape.modulus(x, test.plate.width);
            let datum = if self.fit_datum {
                x[1 + self.shape.moduli() + index]
            } else {
                R::ZERO
            };
            for &reading in used {
                let depth = R::from_f64(test.depth[reading]) - datum;
                let measured = R::from_f64(Real::ln(test.pressure(reading)));
                if let Some(slot) = slots.next() {
                    *slot = k.ln() + x[0] * depth.ln() - measured;
                }
            }
        }
    }
}

/// n, k_c and k_phi by least squares in ln p, p = (k_c/b + k_phi) (z − z_0)ⁿ.
///
/// A power law spans decades of pressure, so its errors are relative. Plates of two widths or more determine k_c
/// and k_phi apart; of one width only their sum, which is given as k_phi. Readings follow each other closely
/// and their residuals are alike: with the correlation ρ of neighbours, m of them count no more than
/// m (1 − ρ)/(1 + ρ) independent ones, and errors are widened accordingly. Where tests differ by more than that, errors are
/// those of the jackknife over tests, with its degrees of freedom. Readings while the plate goes up, or comes down again to
/// where it has been, are left out.
///
/// Source: \[Bekker69\]; the widening: Bayley & Hammersley, J. Royal Statistical Society Supplement 8 (1946).
///
/// # Errors
/// [`Error::TooFew`] where fewer than ten readings lie deeper than the least depth.
pub fn fit_plates(tests: &[PlateTest], settings: &PlateSettings) -> Result<PlateFit> {
    let branches = tests
        .iter()
        .map(|test| branches(&test.depth, &test.force, false));
    let branches: Vec<Vec<Branch>> = branches.collect();
    let uses: Vec<Vec<Use>> = tests
        .iter()
        .zip(&branches)
        .map(|(test, branches)| Use::of_test(test, branches, settings.least_depth))
        .collect();
    let used: Vec<Vec<usize>> = uses
        .iter()
        .map(|uses| {
            let is_fitted = |i: &usize| uses[*i] == Use::Fitted;
            (0..uses.len()).filter(is_fitted).collect()
        })
        .collect();
    // one name may have several tests in a row
    let lengths: Vec<usize> = used
        .iter()
        .zip(&branches)
        .flat_map(|(used, branches)| used.chunk_by(|a, b| branches[*a].test == branches[*b].test))
        .map(<[usize]>::len)
        .collect();
    let count: usize = used.iter().map(Vec::len).sum();
    let shape = Shape::from_tests(tests);
    if count < MIN_READINGS || used.iter().any(Vec::is_empty) {
        return Err(Error::TooFew {
            residuals: count,
            parameters: 1 + shape.moduli(),
        });
    }
    let mut start = vec![
        Bounded {
            start: 1.0,
            lower: 0.1,
            upper: 3.0,
        };
        1
    ];
    start.extend(vec![
        Bounded {
            start: Real::ln(1e6_f64),
            lower: 0.0,
            upper: Real::ln(MAX_MODULUS),
        };
        shape.moduli()
    ]);
    if settings.fit_datum {
        start.extend(used.iter().zip(tests).map(|(used, test)| {
            let shallowest = used.iter().map(|i| test.depth[*i]);
            let shallowest = shallowest.fold(f64::INFINITY, f64::min);
            Bounded {
                start: 0.0,
                lower: -0.02,
                upper: (0.9 * shallowest).max(0.0),
            }
        }));
    }
    let law = Exact(Law {
        tests,
        used: &used,
        shape,
        fit_datum: settings.fit_datum,
    });
    let (found, search) = fit_robustly(&law, count, start, settings.loss)?;
    let residuals = split(&found.residuals, &used);
    let series = residuals.iter().map(|test| test.iter().map(|(_, r)| *r));
    let redundancy = redundancy(series);
    let readings = Uncertainty::from_fit(&found, search.loss).of_alike(&found, redundancy);
    let mut uncertainty = readings.clone();
    let single = uncertainty.add_tests(&found, search.loss, &lengths);
    let intervals = (0..found.x.len())
        .map(|index| {
            let own = profile(&law, &found, index, 0.95, &search)?;
            let widening = redundancy.sqrt() * uncertainty.widening(&readings, index);
            Ok(own.widened(found.x[index], widening))
        })
        .collect::<Result<Vec<Interval>>>()?;
    uncertainty.judge_intervals(&found, &intervals);
    let mut fit = assemble(
        tests,
        found,
        uncertainty,
        &intervals,
        (shape, residuals, redundancy),
        uses.into_iter().flatten().collect(),
    );
    // a datum is that of its test
    let shared = single.into_iter().filter(|k| *k <= shape.moduli());
    fit.single_test = shared.map(|k| fit.parameters[k].name.clone()).collect();
    fit.count = lengths.len();
    Ok(fit)
}

/// The fit, and the settings that it ended with. The threshold of Huber's loss counts multiples of the scatter, which is not
/// known beforehand: the fit and the median of its residuals' sizes take turns.
///
/// Source: Huber & Ronchetti, Robust Statistics, 2009, section 7.8 (location with an auxiliary scale).
fn fit_robustly(
    law: &Exact<Law<'_>>,
    count: usize,
    mut start: Vec<Bounded>,
    loss: Loss,
) -> Result<(Fit, Settings)> {
    let mut search = Settings::default();
    let mut found = fit(law, count, &start, &search)?;
    let Loss::Huber { threshold } = loss else {
        return Ok((found, search));
    };
    let mut scale = f64::INFINITY;
    for _ in 0..MAX_SCALES {
        let last = scale;
        scale = robust_deviation(&found.residuals).max(LEAST_SCALE);
        if is_same_scale(scale, last) {
            break;
        }
        search.loss = Loss::Huber {
            threshold: threshold * scale,
        };
        for (bounded, x) in start.iter_mut().zip(&found.x) {
            bounded.start = *x;
        }
        found = fit(law, count, &start, &search)?;
    }
    Ok((found, search))
}

fn is_same_scale(scale: f64, last: f64) -> bool {
    (scale - last).abs() <= SAME_SCALE * scale
}

/// The standard deviation of normal residuals whose sizes have this median: outliers do not count in it.
fn robust_deviation(residuals: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = residuals.iter().map(|r| r.abs()).collect();
    median(&mut sizes).unwrap_or(0.0) / NORMAL_MEDIAN_SIZE
}

fn assemble(
    tests: &[PlateTest],
    found: Fit,
    uncertainty: Uncertainty,
    intervals: &[Interval],
    (shape, residuals, redundancy): (Shape, Vec<Vec<(usize, f64)>>, f64),
    left_out: LeftOut,
) -> PlateFit {
    let n = found.x[0];
    let number = |name: String, index: usize| {
        let x = found.x[index];
        PlateParameter {
            name,
            value: x,
            standard_error: uncertainty.standard_errors[index],
            interval: intervals[index],
            verdict: uncertainty.verdicts[index],
        }
    };
    // k is the exponential of what was fitted
    let modulus = |name: String, index: usize| {
        let own = number(name, index);
        let value = Real::exp(own.value);
        PlateParameter {
            value,
            standard_error: value * own.standard_error,
            interval: Interval {
                low: own.interval.low.map(Real::exp),
                high: own.interval.high.map(Real::exp),
            },
            // judged as itself, and not as its logarithm
            verdict: own.verdict.of_share(own.standard_error),
            ..own
        }
    };
    let mut parameters = vec![number("n".to_owned(), 0)];
    let (k_c, k_phi) = match shape {
        Shape::One => {
            let k = modulus("k_pa_per_m_n".to_owned(), 1);
            let k_phi = k.value;
            parameters.push(k);
            (0.0, k_phi)
        }
        Shape::Two { least, greatest } => {
            let at = |index: usize, width: f64| {
                // the rounding of the width's own unit is no part of its name
                let width_mm = (1e9 * width).round() / 1e6;
                modulus(format!("k_pa_per_m_n_at_b_{width_mm}_mm"), index)
            };
            let (narrow, wide) = (at(1, least), at(2, greatest));
            let k_c = shape.cohesive(narrow.value, wide.value);
            let k_phi = narrow.value - k_c / least;
            parameters.extend([narrow, wide]);
            (k_c, k_phi)
        }
    };
    let datums = tests.iter().zip(parameters.len()..found.x.len());
    parameters
        .extend(datums.map(|(test, place)| number(format!("datum_m of {}", test.name), place)));
    let moduli = [("k_c_n_per_m_n1", k_c), ("k_phi_n_per_m_n2", k_phi)].map(|(name, value)| {
        PlateParameter {
            name: name.to_owned(),
            value,
            standard_error: f64::NAN,
            interval: Interval {
                low: None,
                high: None,
            },
            verdict: Verdict::NotIdentifiable,
        }
    });
    let mut fit = PlateFit {
        n,
        k_c,
        k_phi,
        moduli,
        parameters,
        residuals,
        left_out,
        relative_deviation: uncertainty.residual_deviation,
        redundancy,
        single_test: Vec::new(),
        count: 0,
        fit: found,
        uncertainty,
    };
    if matches!(shape, Shape::Two { .. }) {
        let quantile = |k: usize| fit.uncertainty.quantile(k, 0.95);
        fit.find_errors_of_moduli(tests, quantile(1).max(quantile(2)));
    }
    fit
}

/// The residuals test by test, as measured over model.
fn split(residuals: &[f64], used: &[Vec<usize>]) -> Vec<Vec<(usize, f64)>> {
    let mut rest = residuals.iter();
    used.iter()
        .map(|used| {
            used.iter()
                .zip(rest.by_ref())
                .map(|(index, r)| (*index, -r))
                .collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plate::Plate;

    /// With one plate the law is a straight line, so that profile and linear intervals are the same, whatever widens them.
    #[test]
    fn an_interval_contains_what_is_alike_and_how_tests_differ() {
        let plate = Plate::disc(0.1).unwrap();
        let test = |spot: u32| {
            let depth: Vec<f64> = (3..=30).map(|mm| 1e-3 * f64::from(mm)).collect();
            let pressure = |z: &f64| {
                let wave = 0.056 * (1200.0 * z + f64::from(spot)).sin();
                // exponents differ about the middle depth
                let turned = 0.05 * (f64::from(spot % 3) - 1.0) * (z / 0.014).ln();
                1e6 * z * (wave + turned).exp()
            };
            PlateTest {
                name: spot.to_string(),
                plate,
                force: depth.iter().map(|z| plate.area * pressure(z)).collect(),
                depth,
            }
        };
        let tests: Vec<PlateTest> = (0..5).map(test).collect();
        let found = fit_plates(&tests, &PlateSettings::default()).unwrap();
        let alone = redundancy_alone(&found);
        let half = found.uncertainty.half_width(1, 0.95);
        assert!(
            found.redundancy > 1.2 && half > 1.5 * alone,
            "{} {half} {alone}",
            found.redundancy
        );
        for index in [0, 1] {
            let interval = found.parameters[index].interval;
            let [low, high] = [interval.low, interval.high].map(|end| {
                let end = end.unwrap();
                if index == 0 { end } else { end.ln() }
            });
            let half = found.uncertainty.half_width(index, 0.95);
            assert!(
                (0.5 * (high - low) / half - 1.0).abs() < 5e-3,
                "{index}: {low} {high} {half}"
            );
        }
        // an exponent that is held moves with nothing
        let of_exponent = |free| -> f64 {
            let mixtures = found.scatter(&tests, 0.05, free).unwrap();
            mixtures.iter().map(|moved| moved[0] * moved[0]).sum()
        };
        let error = found.parameters[0].standard_error;
        assert!((of_exponent(true).sqrt() / error - 1.0).abs() < 1e-9);
        assert_eq!(of_exponent(false), 0.0);
    }

    /// The half width of ln k's interval where only the residuals' likeness widens it.
    fn redundancy_alone(found: &PlateFit) -> f64 {
        let own = Uncertainty::from_fit(&found.fit, Loss::Squares);
        own.of_alike(&found.fit, found.redundancy)
            .half_width(1, 0.95)
    }

    #[test]
    fn a_scale_is_found_where_two_rounds_agree_within_a_ten_thousandth() {
        assert!(!is_same_scale(1.0, f64::INFINITY));
        assert!(
            is_same_scale(1.0, 1.0) && is_same_scale(2.0, 2.0001) && is_same_scale(2.0, 1.9999)
        );
        assert!(!is_same_scale(2.0, 2.0003) && !is_same_scale(2.0, 1.9997));
        // 0.0001 of a scale of 10,000 is 1
        assert!(is_same_scale(1e4, 9999.0) && !is_same_scale(1e4, 9998.5));
    }

    #[test]
    fn the_robust_deviation_is_the_middle_size_over_that_of_a_normal_number() {
        let per_size = 1.0 / 0.674_489_75;
        assert_eq!(robust_deviation(&[]), 0.0);
        for (residuals, middle) in [(&[-2.0][..], 2.0), (&[9.0, -1.0, 3.0, 0.0, -4.0], 3.0)] {
            let found = robust_deviation(residuals);
            assert!((found - middle * per_size).abs() < 1e-7, "{found}");
        }
    }
}
