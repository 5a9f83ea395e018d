//! Do readings lie further from the law than their stated scatter explains?

use super::model::Prediction;
use super::test::{Quantity, Scatter, WheelTest};
use crate::least_squares::{Fit, Loss, NORMAL_MEDIAN_SIZE, solve_damped};
use grouser_real::{Real, median};

/// The normal quantile of a probability of 0.999: of a thousand sound jobs one is called a misfit.
const SIGNIFICANT_SIGMA: f64 = 3.090_232;
/// Scatters are stated by hand, from a few repeated readings: a ratio up to this one is no misfit.
pub(crate) const MAX_SCATTER_RATIO: f64 = 1.5;
/// The efficiency of the median size as an estimate of a normal scatter. Source: Huber & Ronchetti, Robust Statistics,
/// 2009, section 5.1.
const MEDIAN_EFFICIENCY: f64 = 0.37;

/// A quantity whose readings lie further from the law than their stated scatter explains.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Misfit {
    /// The quantity.
    pub quantity: Quantity,
    /// Standard deviation of its readings about the law, in stated standard deviations.
    pub ratio: f64,
    /// How many readings it has.
    pub readings: usize,
}

/// The quantities of `tests` that fail the chi-square test of their stated `scatter` at 0.1 %, and by more than half of it;
/// `freedom` is the share of readings that the fitted numbers leave free. With Huber's loss outliers are expected: the
/// median size of the residuals is tested.
///
/// The quantile is Wilson & Hilferty's, Proc. National Academy of Sciences 17 (1931).
pub(crate) fn misfits(
    tests: &[WheelTest],
    said: &[Prediction],
    scatter: &Scatter,
    loss: Loss,
    freedom: f64,
) -> Vec<Misfit> {
    let of = |quantity: Quantity| {
        let pairs = tests.iter().zip(said);
        let residual = |(test, said): (&WheelTest, &Prediction)| {
            Some((said.of(quantity) - test.read(quantity)?) / scatter.of(quantity))
        };
        let squares: Vec<f64> = pairs.filter_map(residual).map(|r| r * r).collect();
        let readings = squares.len();
        let ratio = ratio_of_misfit(squares, loss, freedom)?;
        Some(Misfit {
            quantity,
            ratio,
            readings,
        })
    };
    Quantity::ALL.into_iter().filter_map(of).collect()
}

/// The standard deviation of residuals with these squares, in stated ones, where that is a misfit.
fn ratio_of_misfit(mut squares: Vec<f64>, loss: Loss, freedom: f64) -> Option<f64> {
    let readings = squares.len();
    let free = readings as f64 * freedom;
    let (variance, free) = match loss {
        Loss::Squares => (squares.iter().sum::<f64>() / free, free),
        Loss::Huber { .. } => {
            let variance =
                median(&mut squares)? / (NORMAL_MEDIAN_SIZE * NORMAL_MEDIAN_SIZE * freedom);
            (variance, MEDIAN_EFFICIENCY * free)
        }
    };
    let spread = 2.0 / (9.0 * free);
    let limit = Real::powi(1.0 - spread + SIGNIFICANT_SIGMA * spread.sqrt(), 3);
    let ratio = variance.sqrt();
    (variance > limit && ratio > MAX_SCATTER_RATIO).then_some(ratio)
}

/// How far the zero of the measured sinkages lies from where the `best` fit of `tests` would have it, m, where no datum is
/// fitted: beyond chance, as in [`misfits`], and by more than [`MAX_SCATTER_RATIO`] of the `scatter`. `variance` is that of the
/// residuals, with their correlation.
///
/// Source: the score test of Rao, Mathematical Proceedings of the Cambridge Philosophical Society 44 (1948): one linear step.
pub(crate) fn sinkage_shift(
    tests: &[WheelTest],
    scatter: f64,
    best: &Fit,
    variance: f64,
) -> Option<f64> {
    let quantities = |test: &WheelTest| {
        let read = Quantity::ALL.map(|quantity| test.read(quantity).map(|_| quantity));
        read.into_iter().flatten()
    };
    let is_sinkage = |quantity| f64::from(u8::from(quantity == Quantity::Sinkage));
    let datum: Vec<f64> = tests.iter().flat_map(quantities).map(is_sinkage).collect();
    // what no free number makes up for
    let free: Vec<usize> = (0..best.x.len()).filter(|i| !best.on_bound(*i)).collect();
    let rows = best.jacobian.iter();
    let rows: Vec<Vec<f64>> = rows
        .map(|row| free.iter().map(|i| row[*i]).collect())
        .collect();
    let moved = solve_damped(&rows, &datum, &vec![0.0; free.len()])?;
    let (mut product, mut square) = (0.0, 0.0);
    for ((row, datum), residual) in rows.iter().zip(&datum).zip(&best.residuals) {
        let own = datum + row.iter().zip(&moved).map(|(a, b)| a * b).sum::<f64>();
        product += own * residual;
        square += own * own;
    }
    let shift = -product / square;
    let is_beyond_chance = shift.abs() > SIGNIFICANT_SIGMA * (variance / square).sqrt();
    (is_beyond_chance && shift.abs() > MAX_SCATTER_RATIO).then_some(shift * scatter)
}

/// The errors of one set of laws on tests that were left out of its fit.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LawScore {
    /// The laws ([`LawPreset::key`](grouser_terra::LawPreset::key)).
    pub laws: &'static str,
    /// Which tests were left out: a slip angle, or one test after the other.
    pub left_out: String,
    /// How many.
    pub tests: usize,
    /// Root mean square error of each quantity that was read, SI, with the number of readings.
    pub rmse: Vec<(Quantity, f64, usize)>,
}

/// The root mean square error of predictions of each quantity that was read, SI, with the number of readings.
pub fn rmse<'a>(
    pairs: impl Iterator<Item = (&'a WheelTest, &'a Prediction)>,
) -> Vec<(Quantity, f64, usize)> {
    let pairs: Vec<_> = pairs.collect();
    let of = |quantity: Quantity| {
        let errors = pairs
            .iter()
            .filter_map(|(test, said)| Some(said.of(quantity) - test.read(quantity)?));
        let (sum, count) = errors.fold((0.0, 0), |(sum, count), e| (sum + e * e, count + 1));
        (count > 0).then(|| (quantity, (sum / count as f64).sqrt(), count))
    };
    Quantity::ALL.into_iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use grouser_terra::{Kinematics, Slip};

    use super::*;
    use crate::wheel::Support;

    /// The chi-square quantile of 0.999 with 10 degrees of freedom, over 10; with 90 the scatter's ratio decides.
    const QUANTILE_10: f64 = 2.958_83;

    #[test]
    fn a_variance_beyond_its_quantile_is_a_misfit() {
        // twenty readings of which half are free, and a hundred of which nine in ten are
        let squares = |variance: f64, readings: usize, freedom: f64| {
            ratio_of_misfit(vec![variance * freedom; readings], Loss::Squares, freedom)
        };
        assert_eq!(squares(0.99 * QUANTILE_10, 20, 0.5), None);
        let ratio = squares(1.01 * QUANTILE_10, 20, 0.5).unwrap();
        assert!(
            (ratio - (1.01 * QUANTILE_10).sqrt()).abs() < 1e-12,
            "{ratio}"
        );
        assert_eq!(squares(1.49 * 1.49, 100, 0.9), None);
        assert!(squares(1.51 * 1.51, 100, 0.9).is_some());
        assert_eq!(squares(1.5 * 1.5, 100, 1.0), None);
        assert_eq!(squares(1.0, 0, 0.5), None);
    }

    #[test]
    fn a_quantity_is_held_against_its_own_scatter() {
        let kinematics = Kinematics::straight(Slip::new(0.2).unwrap());
        let test = |torque: f64| WheelTest {
            kinematics,
            support: Support::Load(50.0),
            pull: Some(10.0),
            side: None,
            torque: Some(torque),
            sinkage: None,
        };
        let predicted = Prediction {
            pull: 10.5,
            side: 9.0,
            torque: 4.0,
            sinkage: 0.01,
            hub_buried: false,
        };
        let scatter = Scatter {
            torque: 0.5,
            ..Scatter::default()
        };
        // 4, 2, 6 and 4 of 0.5 N m; half a newton of pull is less than its scatter
        let tests = [6.0, 3.0, 1.0, 6.0].map(test);
        let found = misfits(&tests, &[predicted; 4], &scatter, Loss::Squares, 0.75);
        let torque = Misfit {
            quantity: Quantity::Torque,
            ratio: 24_f64.sqrt(),
            readings: 4,
        };
        assert_eq!(found, [torque]);
        assert_eq!(misfits(&[], &[], &scatter, Loss::Squares, 0.75), []);
    }

    #[test]
    fn outliers_are_no_misfit_by_their_median() {
        // 27 of 100 readings are free: their median is worth ten squares
        let freedom = 0.1 / MEDIAN_EFFICIENCY;
        let huber = |variance: f64, outliers: usize| {
            let size = variance * freedom * NORMAL_MEDIAN_SIZE * NORMAL_MEDIAN_SIZE;
            let mut squares = vec![1e6; outliers];
            squares.resize(100, size);
            ratio_of_misfit(squares, Loss::Huber { threshold: 1.345 }, freedom)
        };
        for outliers in [0, 40] {
            assert_eq!(huber(0.99 * QUANTILE_10, outliers), None);
            let ratio = huber(1.01 * QUANTILE_10, outliers).unwrap();
            assert!(
                (ratio - (1.01 * QUANTILE_10).sqrt()).abs() < 1e-12,
                "{ratio}"
            );
        }
        assert!(huber(1.0, 60).unwrap() > 100.0);
        let none = ratio_of_misfit(Vec::new(), Loss::Huber { threshold: 1.345 }, freedom);
        assert_eq!(none, None);
    }
}
