//! A stand-in for one wheel on one soil, with a bound on its error.

use grouser_real::Real;

use crate::contact::{entry_angle, sinkage_from_entry_angle};
use crate::error::{Error, Result};
use crate::lanes::{BatchForces, BatchKernel, BatchOutcome, BatchPoints};
use crate::pressure::SinkageExponent;
use crate::settings::Accuracy;
use crate::wheel_on_soil::WheelOnSoil;

/// Chebyshev points in each direction.
const N: usize = 16;
const ALL: usize = N * N;
/// Points in each direction at which the error is looked at: between the nodes and at the ends.
const CHECKS: usize = N + 1;
/// The bound is this many times the greatest error seen at the check points.
const SAFETY: f64 = 4.0;

/// The box that a surrogate serves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurrogateBox {
    /// Least and greatest slip, within [0, 1].
    pub slip: (f64, f64),
    /// Least and greatest sinkage, m.
    pub sinkage: (f64, f64),
}

/// How far a surrogate may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurrogateBounds {
    /// Of vertical force, drawbar pull and torque/r over max(|W|, |DP|, |T|/r) at a sinkage.
    pub forces: f64,
    /// Of the entry angle under a load, relative.
    pub theta_1: f64,
}

/// Forces in (ln θ_1, s) and ln θ_1 in (ln W, s) as tensor products of Chebyshev polynomials: for a caller
/// who asks one wheel on one soil very often and knows its range. Nothing else in this crate ever uses one.
///
/// The forces are divided by θ_1²ⁿ⁺¹ and taken in ln θ_1, the angle as ln θ_1 in ln W: all of them smooth, down to
/// small sinkages. The error is measured where the interpolation is worst, between the nodes and at the
/// ends of the box, on 17 × 17 points against the direct kernel; the bound is four times the greatest found.
/// It is a measured bound, not a proven one; it holds as long as the error between check points behaves as
/// at them, which is so for the smooth functions of driving.
///
/// ```
/// use grouser_terra::{RigidWheel, Settings, Surrogate, SurrogateBox, WheelOnSoil, catalogue};
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let pair = WheelOnSoil::new(RigidWheel::new(0.125, 0.1)?, soil, Settings::default())?;
/// let fast = Surrogate::new(&pair, SurrogateBox { slip: (0.05, 0.8), sinkage: (0.004, 0.03) })?;
/// assert!(fast.bounds().forces < 1e-7);
/// let forces = fast.under_load(80.0, 0.2)?;
/// assert!((forces.vertical_force - 80.0).abs() < 80.0 * 1e-6);
/// assert!(fast.under_load(80.0, 0.9).is_err()); // outside its box
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Surrogate {
    radius: f64,
    power: f64,
    inside: SurrogateBox,
    /// ln θ_1
    angle: Interval,
    slip: Interval,
    /// ln W
    load: Interval,
    forces: [Tensor; 3],
    angles: Tensor,
    bounds: SurrogateBounds,
}

/// A range, mapped to [−1, 1].
#[derive(Clone, Copy, Debug)]
struct Interval {
    middle: f64,
    half: f64,
}

impl Interval {
    fn new(low: f64, high: f64) -> Self {
        Self {
            middle: 0.5 * (low + high),
            half: 0.5 * (high - low),
        }
    }

    fn at(self, t: f64) -> f64 {
        self.middle + self.half * t
    }

    /// Chebyshev polynomials at x.
    fn basis(self, x: f64) -> [f64; N] {
        let t = (x - self.middle) / self.half;
        let mut basis = [1.0; N];
        basis[1] = t;
        for k in 2..N {
            // two at a time, from two halves: a shorter chain than one by one
            let (a, b) = (k / 2, k - k / 2);
            basis[k] = 2.0 * basis[a] * basis[b] - basis[b - a];
        }
        basis
    }
}

/// Coefficients: rows in the first variable, columns in the second.
type Tensor = [[f64; N]; N];

fn node(k: usize) -> f64 {
    Real::cos(core::f64::consts::PI * (k as f64 + 0.5) / N as f64)
}

/// What the value at node k gives to coefficient j.
fn transform() -> Tensor {
    core::array::from_fn(|k| {
        core::array::from_fn(|j| {
            let share = if j == 0 { 1.0 } else { 2.0 } / N as f64;
            share * Real::cos(core::f64::consts::PI * (k as f64 + 0.5) * j as f64 / N as f64)
        })
    })
}

/// Coefficients of the tensor that takes the values at the nodes (row by row).
fn interpolate(values: &[f64; ALL], transform: &Tensor) -> Tensor {
    let mut rows = [[0.0; N]; N];
    for (row, values) in rows.iter_mut().zip(values.as_chunks::<N>().0) {
        for (value, shares) in values.iter().zip(transform) {
            for (sum, share) in row.iter_mut().zip(shares) {
                *sum += value * share;
            }
        }
    }
    let mut out = [[0.0; N]; N];
    for (row, shares) in rows.iter().zip(transform) {
        for (sums, share) in out.iter_mut().zip(shares) {
            for (sum, x) in sums.iter_mut().zip(row) {
                *sum += share * x;
            }
        }
    }
    out
}

fn value(tensor: &Tensor, a: &[f64; N], b: &[f64; N]) -> f64 {
    let mut columns = [0.0; N];
    for (row, a) in tensor.iter().zip(a) {
        for (column, c) in columns.iter_mut().zip(row) {
            *column += a * c;
        }
    }
    columns.iter().zip(b).map(|(x, b)| x * b).sum()
}

impl Surrogate {
    /// Builds a surrogate by the direct kernel on lanes: some 600 points, 100 µs (see RESULTS.md).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a slip outside [0, 1], an empty box, a soil whose exponent depends on slip,
    /// the reference mode or a wheel with grousers (the direct kernel on lanes serves none of the three), a
    /// soil on which no one load lies inside the box at all of its slips; the errors of
    /// [`WheelOnSoil::forces_at`] for sinkages outside the model.
    pub fn new(pair: &WheelOnSoil, inside: SurrogateBox) -> Result<Self> {
        let SurrogateBox { slip, sinkage } = inside;
        Error::check_range("slip", slip.0, 0.0, 1.0, "1")?;
        Error::check_range("slip", slip.1, slip.0 + 1e-6, 1.0, "1")?;
        let radius = pair.wheel().radius();
        Error::check_range("sinkage", sinkage.0, 1e-4 * radius, radius, "m")?;
        Error::check_range("sinkage", sinkage.1, sinkage.0 * 1.001, radius, "m")?;
        let SinkageExponent { n_0, n_1, n_2 } = pair.laws().exponent;
        Error::check_range("n_1", n_1, 0.0, 0.0, "1")?;
        Error::check_range("n_2", n_2, 0.0, 0.0, "1")?;
        let height = pair.wheel().grousers().map_or(0.0, |g| g.height);
        Error::check_range("grouser_height", height, 0.0, 0.0, "m")?;
        if pair.settings().accuracy != Accuracy::Standard {
            return Err(Error::OutOfRange {
                field: "accuracy of a surrogate",
                value: 1e-13,
                low: 1e-9,
                high: 1.0,
                unit: "1",
            });
        }
        let angle = Interval::new(
            Real::ln(entry_angle(sinkage.0, radius)),
            Real::ln(entry_angle(sinkage.1, radius)),
        );
        let mut new = Self {
            radius,
            power: 2.0 * n_0 + 1.0,
            inside,
            angle,
            slip: Interval::new(slip.0, slip.1),
            load: Interval::new(0.0, 1.0),
            forces: [[[0.0; N]; N]; 3],
            angles: [[0.0; N]; N],
            bounds: SurrogateBounds {
                forces: 0.0,
                theta_1: 0.0,
            },
        };
        let direct = Direct::new(pair);
        let transform = transform();
        new.fit_forces(&direct, &transform)?;
        new.fit_angle(&direct, &transform)?;
        new.check(&direct)?;
        Ok(new)
    }

    /// The box.
    #[must_use]
    pub const fn inside(&self) -> &SurrogateBox {
        &self.inside
    }

    /// Least and greatest load that [`Surrogate::under_load`] takes, N: carried inside the box at every slip.
    #[must_use]
    pub fn loads(&self) -> (f64, f64) {
        (Real::exp(self.load.at(-1.0)), Real::exp(self.load.at(1.0)))
    }

    /// How far it may be off.
    #[must_use]
    pub const fn bounds(&self) -> &SurrogateBounds {
        &self.bounds
    }

    /// Forces at a sinkage (m), to [`SurrogateBounds::forces`].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] outside the box.
    pub fn forces(&self, sinkage: f64, slip: f64) -> Result<BatchForces> {
        let SurrogateBox {
            slip: slips,
            sinkage: sinkages,
        } = self.inside;
        Error::check_range("slip", slip, slips.0, slips.1, "1")?;
        Error::check_range("sinkage", sinkage, sinkages.0, sinkages.1, "m")?;
        let x = Real::ln(entry_angle(sinkage, self.radius));
        let [vertical_force, drawbar_pull, torque] = self.forces_by(x, &self.slip.basis(slip));
        Ok(BatchForces {
            sinkage,
            vertical_force,
            drawbar_pull,
            torque,
        })
    }

    /// Sinkage and forces under a load (N): the entry angle to [`SurrogateBounds::theta_1`], and the forces at
    /// that angle to [`SurrogateBounds::forces`], vertical force included: it tells how well the load is met.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] outside the box and outside [`Surrogate::loads`].
    pub fn under_load(&self, load: f64, slip: f64) -> Result<BatchForces> {
        let slips = self.inside.slip;
        Error::check_range("slip", slip, slips.0, slips.1, "1")?;
        let (least, greatest) = self.loads();
        Error::check_range("load", load, least, greatest, "N")?;
        let by_slip = self.slip.basis(slip);
        let x = self.angle_by(load, &by_slip);
        let [vertical_force, drawbar_pull, torque] = self.forces_by(x, &by_slip);
        Ok(BatchForces {
            sinkage: sinkage_from_entry_angle(Real::exp(x), self.radius),
            vertical_force,
            drawbar_pull,
            torque,
        })
    }

    /// Forces at x = ln θ_1.
    fn forces_by(&self, x: f64, by_slip: &[f64; N]) -> [f64; 3] {
        let by_angle = self.angle.basis(x);
        let scale = Real::exp(self.power * x);
        self.forces
            .each_ref()
            .map(|tensor| scale * value(tensor, &by_angle, by_slip))
    }

    /// ln θ_1 under a load.
    fn angle_by(&self, load: f64, by_slip: &[f64; N]) -> f64 {
        let by_load = self.load.basis(Real::ln(load));
        value(&self.angles, &by_load, by_slip)
    }

    fn fit_forces(&mut self, direct: &Direct, transform: &Tensor) -> Result<()> {
        let mut angles = [0.0; ALL];
        let mut slips = [0.0; ALL];
        for i in 0..ALL {
            angles[i] = self.angle.at(node(i / N));
            slips[i] = self.slip.at(node(i % N));
        }
        let sinkages = angles.map(|x| sinkage_from_entry_angle(Real::exp(x), self.radius));
        let found = direct.forces(&sinkages, &slips)?;
        for (force, tensor) in self.forces.iter_mut().enumerate() {
            let mut values = [0.0; ALL];
            for i in 0..ALL {
                values[i] = three(&found[i])[force] * Real::exp(-self.power * angles[i]);
            }
            *tensor = interpolate(&values, transform);
        }
        Ok(())
    }

    fn fit_angle(&mut self, direct: &Direct, transform: &Tensor) -> Result<()> {
        // the loads that every slip of the box carries between its sinkages
        let mut slips = [0.0; 2 * CHECKS];
        let mut sinkages = [self.inside.sinkage.0; 2 * CHECKS];
        for k in 0..CHECKS {
            slips[k] = self.slip.at(check(k));
            slips[CHECKS + k] = slips[k];
            sinkages[CHECKS + k] = self.inside.sinkage.1;
        }
        let edges = direct.forces(&sinkages, &slips)?;
        let force = |f: &BatchForces| f.vertical_force;
        let least = edges[..CHECKS].iter().map(force).fold(0.0, f64::max);
        let greatest = edges[CHECKS..]
            .iter()
            .map(force)
            .fold(f64::INFINITY, f64::min);
        // a little inside, so that no slip between these leaves the box
        let (least, greatest) = (least * (1.0 + 1e-6), greatest * (1.0 - 1e-6));
        Error::check_range(
            "greatest load in the box",
            greatest,
            least * 1.001,
            f64::MAX,
            "N",
        )?;
        self.load = Interval::new(Real::ln(least), Real::ln(greatest));
        let mut loads = [0.0; ALL];
        let mut slips = [0.0; ALL];
        for i in 0..ALL {
            loads[i] = Real::exp(self.load.at(node(i / N)));
            slips[i] = self.slip.at(node(i % N));
        }
        let found = direct.under_load(&loads, &slips)?;
        let angles = core::array::from_fn(|i| Real::ln(entry_angle(found[i].sinkage, self.radius)));
        self.angles = interpolate(&angles, transform);
        Ok(())
    }

    /// Measures the error at the check points.
    fn check(&mut self, direct: &Direct) -> Result<()> {
        let (mut forces, mut angle) = (0.0_f64, 0.0_f64);
        let (least, greatest) = self.loads();
        for k in 0..CHECKS {
            let slips: [f64; CHECKS] = core::array::from_fn(|j| self.slip.at(check(j)));
            let x = self.angle.at(check(k));
            let sinkages = [sinkage_from_entry_angle(Real::exp(x), self.radius); CHECKS];
            let exact = direct.forces(&sinkages, &slips)?;
            for (slip, exact) in slips.iter().zip(&exact) {
                let by_slip = self.slip.basis(*slip);
                let got = self.forces_by(x, &by_slip);
                let per = [1.0, 1.0, 1.0 / self.radius];
                let exact = three(exact);
                let size = (0..3).fold(0.0_f64, |m, i| m.max((exact[i] * per[i]).abs()));
                let off = (0..3).fold(0.0_f64, |m, i| m.max(((got[i] - exact[i]) * per[i]).abs()));
                forces = forces.max(off / size);
                if (least..=greatest).contains(&exact[0]) {
                    angle = angle.max((self.angle_by(exact[0], &by_slip) - x).abs());
                }
            }
        }
        // the direct kernel's own 1e-9 on top
        self.bounds = SurrogateBounds {
            forces: SAFETY * forces + 1e-9,
            theta_1: SAFETY * angle + 1e-9,
        };
        Ok(())
    }
}

/// The k-th check point: where the Chebyshev polynomial of the nodes has its extremes.
fn check(k: usize) -> f64 {
    Real::cos(core::f64::consts::PI * k as f64 / N as f64)
}

fn three(f: &BatchForces) -> [f64; 3] {
    [f.vertical_force, f.drawbar_pull, f.torque]
}

/// The direct kernel for one wheel.
struct Direct {
    kernel: BatchKernel,
    wheel: [f64; 3],
}

impl Direct {
    fn new(pair: &WheelOnSoil) -> Self {
        let wheel = pair.wheel();
        Self {
            kernel: BatchKernel::new(*pair.soil()),
            wheel: [wheel.radius(), wheel.width(), pair.soil().params().rebound],
        }
    }

    fn forces<const M: usize>(
        &self,
        sinkages: &[f64; M],
        slips: &[f64; M],
    ) -> Result<[BatchForces; M]> {
        self.solve(slips, |points, out| {
            self.kernel.forces(points, sinkages, out)
        })
    }

    fn under_load<const M: usize>(
        &self,
        loads: &[f64; M],
        slips: &[f64; M],
    ) -> Result<[BatchForces; M]> {
        self.solve(slips, |points, out| {
            self.kernel.under_load(points, loads, out)
        })
    }

    /// The one wheel at all these slips.
    fn solve<const M: usize>(
        &self,
        slip: &[f64; M],
        kernel: impl FnOnce(&BatchPoints<'_>, &mut [BatchOutcome]) -> Result<()>,
    ) -> Result<[BatchForces; M]> {
        let mut out = [BatchOutcome::default(); M];
        let [radius, width, rebound] = &self.wheel.map(|x| [x; M]);
        let points = BatchPoints {
            radius,
            width,
            rebound,
            slip,
        };
        kernel(&points, &mut out)?;
        done(&out)
    }
}

/// All of them, or the first that is none.
fn done<const M: usize>(out: &[BatchOutcome; M]) -> Result<[BatchForces; M]> {
    let mut all = [BatchForces {
        sinkage: 0.0,
        vertical_force: 0.0,
        drawbar_pull: 0.0,
        torque: 0.0,
    }; M];
    for (place, outcome) in all.iter_mut().zip(out) {
        *place = match outcome {
            BatchOutcome::Done(forces) => *forces,
            BatchOutcome::Bad(error) => return Err(*error),
            BatchOutcome::NoSolution(_) => {
                return Err(Error::NotAbove {
                    field: "load carried inside the surrogate's box",
                    value: 0.0,
                    limit: 0.0,
                    unit: "N",
                });
            }
        };
    }
    Ok(all)
}
