//! A slip curve of one wheel under one load: its points know of each other.
//!
//! Eight slips, Chebyshev's of the curve's range, are solved from nothing. What their searches ended with is smooth in
//! slip, and interpolated it gives the sinkage of every other point to 1e-6 and better, from where one evaluation of the
//! fine rule ends the search. A long curve takes that step at sixteen further slips alone: they make Chebyshev's
//! twenty-four with the first ones, and polynomials through their sinkages, pulls and torques give all points. The
//! coefficients fall geometrically, so that the last ones bound what is left out. Where they have not fallen that far,
//! every point takes the step. Its residual is looked at; where the curve is less smooth, the fine rule goes on.

use crate::status::SolveStatus;

use super::columns::{BatchColumns, Inputs};
use super::load::{LoadSheet, Start};
use super::machine::Level;
use super::plan::{CHUNK, Chunk, SINGLE_STEP, within};
use super::sheet::eight;
use super::vector::Vector;

/// Slips that are solved from nothing: one group.
const FIRST_NODES: usize = 8;
/// Least number of points for which this is worth while.
const MIN_CURVE_POINTS: usize = if CHUNK < 24 { CHUNK } else { 24 };
/// Least error that interpolated slopes are taken to have: a residual of ln W below 2e-6 is gone straight.
const MIN_SLOPE_ERROR: f64 = 1e-4;

/// Slips of the polynomials: thrice as many, since every third of Chebyshev's is one of the first.
const ALL_NODES: usize = 3 * FIRST_NODES;
/// Least number of points for which the polynomials are worth while.
const MIN_POLYNOMIAL_POINTS: usize = 2 * ALL_NODES;
/// The last coefficients, of which each has to be small: one alone may be so by chance.
const LAST: usize = 3;
/// Greatest last coefficient over the size of the quantity. On 200 random curves over the soils of the catalogue the
/// polynomials were off by less than the greatest of the last three, which leaves a tenth of the 1e-9 of the forces.
const MAX_LAST: f64 = 1e-10;

/// cos(π i/(2 n)), by the cosine's series up to π/2.
const fn cosine(i: usize, n: usize) -> f64 {
    let i = i % (4 * n);
    let i = if i > 2 * n { 4 * n - i } else { i };
    let (i, sign) = if i > n { (2 * n - i, -1.0) } else { (i, 1.0) };
    let x = core::f64::consts::FRAC_PI_2 * i as f64 / n as f64;
    let (mut term, mut sum, mut k) = (1.0, 1.0, 0);
    while k < 24 {
        term *= -x * x / ((k + 1) * (k + 2)) as f64;
        sum += term;
        k += 2;
    }
    sign * sum
}

/// Where N of Chebyshev's nodes lie between −1 and 1.
const fn nodes<const N: usize>() -> [f64; N] {
    let mut nodes = [0.0; N];
    let mut k = 0;
    while k < N {
        nodes[k] = cosine(2 * k + 1, N);
        k += 1;
    }
    nodes
}

/// What the value at the k-th node gives to the j-th coefficient, by the discrete orthogonality of the
/// cosines.
const fn transform<const N: usize>() -> [[f64; N]; N] {
    let mut rows = [[0.0; N]; N];
    let mut k = 0;
    while k < N {
        let mut j = 0;
        while j < N {
            let share = if j == 0 { 1.0 } else { 2.0 };
            rows[k][j] = share / N as f64 * cosine(j * (2 * k + 1), N);
            j += 1;
        }
        k += 1;
    }
    rows
}

static FIRST: [f64; FIRST_NODES] = nodes();
static FIRST_TRANSFORM: [[f64; FIRST_NODES]; FIRST_NODES] = transform();
static ALL: [f64; ALL_NODES] = nodes();
static ALL_TRANSFORM: [[f64; ALL_NODES]; ALL_NODES] = transform();

/// Four smooth functions of slip as sums of Chebyshev polynomials.
pub(super) struct Smooth {
    coefficients: [[f64; FIRST_NODES]; 4],
    middle: f64,
    per_half: f64,
    /// Error of the slopes of DP/W and T/(r W): twice what their last two coefficients come to, since what is left out
    /// also falls on those that are not.
    pub(super) slope_error: f64,
}

impl Smooth {
    fn new(values: [&[f64]; 4], Range { low, high }: Range) -> Self {
        let mut coefficients = [[0.0; FIRST_NODES]; 4];
        for (sums, values) in coefficients.iter_mut().zip(values) {
            for (value, row) in values.iter().zip(&FIRST_TRANSFORM) {
                for (sum, share) in sums.iter_mut().zip(row) {
                    *sum += value * share;
                }
            }
        }
        let [_, _, pull, turn] = &coefficients;
        let last = |of: &[f64; FIRST_NODES]| of[FIRST_NODES - 2].abs() + of[FIRST_NODES - 1].abs();
        Self {
            slope_error: (2.0 * last(pull).max(last(turn))).max(MIN_SLOPE_ERROR),
            coefficients,
            middle: 0.5 * (low + high),
            per_half: 2.0 / (high - low),
        }
    }

    /// x, dx/d ln W and the slopes of DP/W and T/(r W) at eight slips, by Clenshaw's sum.
    #[inline(always)]
    pub(super) fn at<V: Vector>(&self, slip: V) -> [V; 4] {
        let t = (slip - V::from_f64(self.middle)) * V::from_f64(self.per_half);
        clenshaw(&self.coefficients, t)
    }
}

/// Σ c_j T_j(t) of several functions by Clenshaw's sum. Loops: closures would not be compiled for the machine.
#[inline(always)]
fn clenshaw<V: Vector, const N: usize, const M: usize>(
    coefficients: &[[f64; N]; M],
    t: V,
) -> [V; M] {
    let twice = t + t;
    let mut b = [V::ZERO; M];
    let mut after = [V::ZERO; M];
    for j in (1..N).rev() {
        for ((b, after), c) in b.iter_mut().zip(&mut after).zip(coefficients) {
            let next = twice.mul_add(*b, V::from_f64(c[j]) - *after);
            *after = *b;
            *b = next;
        }
    }
    for ((b, after), c) in b.iter_mut().zip(&after).zip(coefficients) {
        *b = t.mul_add(*b, V::from_f64(c[0]) - *after);
    }
    b
}

/// The range of a curve's slips.
#[derive(Clone, Copy)]
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    /// Of the slips that the lanes serve; `None` for a range that is none.
    fn from_slips(slips: &[f64]) -> Option<Self> {
        let (mut low, mut high) = (1.0_f64, 0.0_f64);
        for &slip in slips {
            if (0.0..=1.0).contains(&slip) {
                (low, high) = (low.min(slip), high.max(slip));
            }
        }
        (high - low > 1e-3).then_some(Self { low, high })
    }

    /// The slip at a place between −1 and 1.
    fn slip(self, place: f64) -> f64 {
        0.5 * (self.low + self.high) + 0.5 * (self.high - self.low) * place
    }
}

/// The operating points of some slips of a curve.
#[derive(Clone, Copy)]
struct Solved<const N: usize> {
    sinkage: [f64; N],
    drawbar_pull: [f64; N],
    torque: [f64; N],
}

impl<const N: usize> Solved<N> {
    const EMPTY: Self = Self {
        sinkage: [0.0; N],
        drawbar_pull: [0.0; N],
        torque: [0.0; N],
    };

    /// Solves slips of a curve; `None` where one has no solution.
    fn new(
        chunk: &mut Chunk<'_>,
        slip: &[f64; N],
        sheet: &mut LoadSheet,
        (level, expected): (Level, Option<&Smooth>),
    ) -> Option<Self> {
        let inputs = chunk.inputs;
        let mut solved = Self::EMPTY;
        let mut status = [SolveStatus::NotConverged; N];
        let mut nodes = Chunk {
            prepared: chunk.prepared,
            inputs: Inputs {
                radius: &inputs.radius[..N],
                width: &inputs.width[..N],
                rebound: &inputs.rebound[..N],
                slip,
                given: &inputs.given[..N],
                soil: None,
            },
            plan: &mut *chunk.plan,
            out: BatchColumns {
                sinkage: &mut solved.sinkage,
                vertical_force: &mut [0.0; N],
                drawbar_pull: &mut solved.drawbar_pull,
                torque: &mut solved.torque,
                status: &mut status,
            },
        };
        let start = Start {
            expected,
            nodes: true,
        };
        level.load(&mut nodes, sheet, start);
        (status == [SolveStatus::Solved; N]).then_some(solved)
    }
}

/// What the polynomials of a curve go through.
pub(super) struct CurveNodes<'a> {
    range: Range,
    /// Sinkage (m), drawbar pull (N) and torque (N m) at [`ALL`].
    solved: &'a Solved<ALL_NODES>,
    /// What their errors are measured by.
    sizes: [f64; 3],
}

impl<'a> CurveNodes<'a> {
    /// Those of a wheel of this radius, m, under its load, N.
    fn new(range: Range, solved: &'a Solved<ALL_NODES>, (load, radius): (f64, f64)) -> Self {
        let least = solved.sinkage.iter().copied().fold(f64::INFINITY, f64::min);
        Self {
            range,
            solved,
            sizes: [least, load, load * radius],
        }
    }

    /// Coefficients of Chebyshev's polynomials.
    #[inline(always)]
    fn coefficients<V: Vector>(&self) -> [[f64; ALL_NODES]; 3] {
        let Solved {
            sinkage,
            drawbar_pull,
            torque,
        } = self.solved;
        let values = [sinkage, drawbar_pull, torque];
        let mut coefficients = [[0.0; ALL_NODES]; 3];
        for at in (0..ALL_NODES).step_by(8) {
            let mut sums = [V::ZERO; 3];
            for (k, row) in ALL_TRANSFORM.iter().enumerate() {
                let row = V::load(row, at);
                for (sum, values) in sums.iter_mut().zip(values) {
                    *sum = row.mul_add(V::from_f64(values[k]), *sum);
                }
            }
            for (sum, coefficients) in sums.iter().zip(&mut coefficients) {
                sum.store(coefficients, at);
            }
        }
        coefficients
    }
}

/// Writes the points of a curve by its polynomials; `false`, and nothing written, where they are not close enough.
#[inline(always)]
pub(super) fn write<V: Vector>(
    nodes: &CurveNodes<'_>,
    inputs: &Inputs<'_>,
    out: &mut BatchColumns<'_>,
) -> bool {
    let coefficients = nodes.coefficients::<V>();
    for (of, size) in coefficients.iter().zip(nodes.sizes) {
        for last in &of[ALL_NODES - LAST..] {
            if !(last.abs() <= MAX_LAST * size) {
                return false;
            }
        }
    }
    let Range { low, high } = nodes.range;
    let (middle, per_half) = (0.5 * (low + high), 2.0 / (high - low));
    for at in (0..inputs.len()).step_by(8) {
        let slip: V = eight(inputs.slip, at);
        let t = (slip - V::from_f64(middle)) * V::from_f64(per_half);
        let good = V::select(within(slip, 0.0, 1.0), V::ONE, V::ZERO).to_array();
        let [sinkage, pull, torque] = clenshaw(&coefficients, t);
        let (sinkage, pull, torque) = (sinkage.to_array(), pull.to_array(), torque.to_array());
        for k in 0..8.min(inputs.len() - at) {
            if good[k] > 0.0 {
                let numbers = [sinkage[k], inputs.given[at + k], pull[k], torque[k]];
                out.set(at + k, SolveStatus::Solved, numbers);
            }
        }
    }
    true
}

/// Solves the points of a curve that the lanes serve.
pub(super) fn run(chunk: &mut Chunk<'_>, sheet: &mut LoadSheet, level: Level) {
    let range =
        Range::from_slips(chunk.inputs.slip).filter(|_| chunk.inputs.len() >= MIN_CURVE_POINTS);
    let first = range.and_then(|range| {
        let slip = FIRST.map(|place| range.slip(place));
        let first = Solved::new(chunk, &slip, sheet, (level, None))?;
        Some((range, first))
    });
    let Some((range, first)) = first else {
        return level.load(chunk, sheet, Start::ALONE);
    };
    let values = sheet.kept.each_ref().map(|column| &column.0[..]);
    let smooth = Smooth::new(values, range);
    if !by_polynomials(chunk, sheet, (level, &smooth), (range, &first)) {
        let start = Start {
            expected: Some(&smooth),
            nodes: false,
        };
        level.load(chunk, sheet, start);
    }
}

fn by_polynomials(
    chunk: &mut Chunk<'_>,
    sheet: &mut LoadSheet,
    (level, smooth): (Level, &Smooth),
    (range, first): (Range, &Solved<FIRST_NODES>),
) -> bool {
    const OTHERS: usize = ALL_NODES - FIRST_NODES;
    // the middle one of each three is a node of the first
    let place = |other: usize| 3 * (other / 2) + 2 * (other % 2);
    let inputs = chunk.inputs;
    if inputs.len() < MIN_POLYNOMIAL_POINTS {
        return false;
    }
    let slip: [f64; OTHERS] = core::array::from_fn(|other| range.slip(ALL[place(other)]));
    let Some(others) = Solved::new(chunk, &slip, sheet, (level, Some(smooth))) else {
        return false;
    };
    let mut solved = Solved::EMPTY;
    for (all, (first, others)) in [
        (&mut solved.sinkage, (&first.sinkage, &others.sinkage)),
        (
            &mut solved.drawbar_pull,
            (&first.drawbar_pull, &others.drawbar_pull),
        ),
        (&mut solved.torque, (&first.torque, &others.torque)),
    ] {
        for (k, x) in first.iter().enumerate() {
            all[3 * k + 1] = *x;
        }
        for (k, x) in others.iter().enumerate() {
            all[place(k)] = *x;
        }
    }
    let nodes = CurveNodes::new(range, &solved, (inputs.given[0], inputs.radius[0]));
    let is_done = level.curve(&nodes, &inputs, &mut chunk.out);
    if is_done {
        // slips out of range are for the general kernel
        for (step, slip) in chunk.plan.steps.iter_mut().zip(inputs.slip) {
            let is_good = (0.0..=1.0).contains(slip);
            *step = if is_good { 0.0 } else { SINGLE_STEP };
        }
    }
    is_done
}

#[cfg(test)]
mod tests {
    use super::super::Lanes;
    use super::*;

    #[test]
    fn smooth_functions_come_back() {
        let range = Range {
            low: 0.1,
            high: 0.7,
        };
        let slip = FIRST.map(|place| range.slip(place));
        let values = slip.map(|s| (3.0 * s).exp());
        let smooth = Smooth::new([&values, &slip, &values, &values], range);
        for i in 0..=60 {
            let s = 0.1 + 0.01 * f64::from(i);
            let [exponential, line, ..] = smooth.at(Lanes([s; 8]));
            // eight points leave 2 e^2.1 0.9⁸/8!/2⁸ of it
            assert!((exponential.0[0] - (3.0 * s).exp()).abs() < 7e-7);
            assert!((line.0[7] - s).abs() < 1e-14);
        }
    }

    /// What the polynomials make of e^(rate (s − 0.1)): whether they are close enough, and their worst error.
    fn exponential(rate: f64, size: f64, level: Level) -> (bool, f64) {
        let range = Range {
            low: 0.1,
            high: 0.7,
        };
        let values = ALL.map(|place| (rate * (range.slip(place) - 0.1)).exp());
        let nodes = CurveNodes {
            range,
            solved: &Solved {
                sinkage: values,
                drawbar_pull: values,
                torque: values,
            },
            sizes: [size; 3],
        };
        let slip: [f64; 97] = core::array::from_fn(|i| 0.1 + 0.6 * i as f64 / 96.0);
        let [
            mut sinkage,
            mut vertical_force,
            mut drawbar_pull,
            mut torque,
        ] = [[0.0; 97]; 4];
        let mut status = [SolveStatus::NotConverged; 97];
        let mut out = BatchColumns {
            sinkage: &mut sinkage,
            vertical_force: &mut vertical_force,
            drawbar_pull: &mut drawbar_pull,
            torque: &mut torque,
            status: &mut status,
        };
        let same = [1.0; 97];
        let inputs = Inputs {
            radius: &same,
            width: &same,
            rebound: &same,
            slip: &slip,
            given: &same,
            soil: None,
        };
        let is_close = level.curve(&nodes, &inputs, &mut out);
        let off = slip
            .iter()
            .zip(torque)
            .map(|(s, got)| (got - (rate * (s - 0.1)).exp()).abs());
        (is_close, off.fold(0.0, f64::max))
    }

    /// The least sinkage, the load, and the load at the radius.
    #[test]
    fn what_errors_of_a_curve_are_measured_by() {
        let (low, high) = (0.1, 0.7);
        let sinkage = core::array::from_fn(|i| 0.02 + (i as f64 - 7.0).powi(2));
        let solved = Solved {
            sinkage,
            ..Solved::EMPTY
        };
        let nodes = CurveNodes::new(Range { low, high }, &solved, (30.0, 0.25));
        assert_eq!(nodes.sizes, [0.02, 30.0, 7.5]);
    }

    #[test]
    fn polynomials_return_smooth_functions_and_refuse_steep_ones() {
        for level in super::super::machine::tests::levels() {
            let (is_close, off) = exponential(-3.0, 1.0, level);
            assert!(is_close && off < 1e-14, "{off:e}");
            let (is_close, off) = exponential(-20.0, 1.0, level);
            assert!(is_close && off < 1e-10, "{off:e}");
            // for a quantity that is small the same is not close
            assert!(!exponential(-20.0, 1e-4, level).0);
            assert!(!exponential(-200.0, 1.0, level).0);
        }
    }

    #[test]
    fn a_range_is_that_of_the_slips_that_lanes_serve() {
        let of = |slips: &[f64]| Range::from_slips(slips).map(|range| (range.low, range.high));
        assert_eq!(of(&[0.3, 0.1, 0.7]), Some((0.1, 0.7)));
        assert_eq!(of(&[0.0, 1.0]), Some((0.0, 1.0)));
        assert_eq!(of(&[0.3, -0.1, 1.1, f64::NAN, 0.2]), Some((0.2, 0.3)));
        // too narrow, or none
        assert_eq!(of(&[0.25, 0.25 + 0.9e-3]), None);
        assert!(of(&[0.25, 0.25 + 1.1e-3]).is_some());
        assert_eq!(of(&[-0.5, 1.5]), None);
        let range = Range {
            low: 0.25,
            high: 0.75,
        };
        assert_eq!(
            [-1.0, 0.0, 0.5, 1.0].map(|place| range.slip(place)),
            [0.25, 0.5, 0.625, 0.75]
        );
    }

    /// T_j(t) = cos(j arccos t).
    #[test]
    fn sums_of_chebyshev_polynomials() {
        for t in [-1.0, -0.77, -0.2, 0.0, 0.31, 0.9, 1.0_f64] {
            let expected = |c: [f64; 5]| {
                let terms = c.iter().enumerate();
                terms
                    .map(|(j, c)| c * (j as f64 * t.acos()).cos())
                    .sum::<f64>()
            };
            let rows = [[0.5, -1.0, 2.0, 0.25, -3.0], [-0.125, 4.0, 0.0, 1.0, 0.5]];
            let sums = clenshaw(&rows, Lanes([t; 8]));
            for (sum, row) in sums.iter().zip(rows) {
                assert!((sum.0[5] - expected(row)).abs() < 1e-14);
            }
        }
    }

    /// Slopes whose last two coefficients are a and b are known to 2 (|a| + |b|), and at best to 1e-4.
    #[test]
    fn the_error_of_interpolated_slopes() {
        let range = Range {
            low: 0.0,
            high: 1.0,
        };
        let with = |a: f64, b: f64| {
            FIRST.map(|t: f64| a * (6.0 * t.acos()).cos() + b * (7.0 * t.acos()).cos())
        };
        let zero = [0.0; FIRST_NODES];
        let error =
            |pull: &[f64], turn: &[f64]| Smooth::new([&zero, &zero, pull, turn], range).slope_error;
        assert!((error(&with(0.1, -0.3), &zero) - 0.8).abs() < 1e-13);
        assert!((error(&zero, &with(-0.2, 0.1)) - 0.6).abs() < 1e-13);
        assert!((error(&with(0.1, 0.0), &with(0.0, 0.2)) - 0.4).abs() < 1e-13);
        assert_eq!(error(&with(1e-5, 1e-5), &zero), MIN_SLOPE_ERROR);
    }

    /// From twice 24 points on a smooth curve is that of its polynomials.
    #[test]
    fn long_curves_are_polynomials() {
        const N: usize = MIN_POLYNOMIAL_POINTS;
        let soil = crate::catalogue::find("dry-sand").unwrap().soil().unwrap();
        let prepared = super::super::plan::Prepared::new(&soil).unwrap();
        let is_polynomial = |n: usize| {
            let slip: [f64; N] = core::array::from_fn(|i| 0.1 + 0.01 * i as f64);
            let [radius, width, rebound, load] = [0.125, 0.1, 0.0, 80.0].map(|x| [x; N]);
            let [
                mut sinkage,
                mut vertical_force,
                mut drawbar_pull,
                mut torque,
            ] = [[0.0; N]; 4];
            let mut status = [SolveStatus::NotConverged; N];
            let mut plan = super::super::plan::Plan::EMPTY;
            let mut sheet = LoadSheet::EMPTY;
            let mut out = BatchColumns {
                sinkage: &mut sinkage,
                vertical_force: &mut vertical_force,
                drawbar_pull: &mut drawbar_pull,
                torque: &mut torque,
                status: &mut status,
            };
            let mut chunk = Chunk {
                prepared: &prepared,
                inputs: Inputs {
                    radius: &radius[..n],
                    width: &width[..n],
                    rebound: &rebound[..n],
                    slip: &slip[..n],
                    given: &load[..n],
                    soil: None,
                },
                plan: &mut plan,
                out: out.part(0..n),
            };
            let level = Level::best();
            let range = Range::from_slips(chunk.inputs.slip).unwrap();
            let first = FIRST.map(|place| range.slip(place));
            let first = Solved::new(&mut chunk, &first, &mut sheet, (level, None)).unwrap();
            let values = sheet.kept.each_ref().map(|column| &column.0[..]);
            let smooth = Smooth::new(values, range);
            let is_done = by_polynomials(&mut chunk, &mut sheet, (level, &smooth), (range, &first));
            assert_eq!(is_done, status[..n] == [SolveStatus::Solved; N][..n]);
            is_done
        };
        assert!(is_polynomial(N) && !is_polynomial(N - 1));
    }
}
