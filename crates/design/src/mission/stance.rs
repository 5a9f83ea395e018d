//! What the wheels carry on each slope, as functions of the radius and the mass of the new wheel and of where the chassis' mass
//! lies.
//!
//! A larger wheel raises the chassis, so that loads shift further on a slope; a heavier one adds weight. Loads are
//! linear in the mass and in the shift of the chassis' mass, and smooth in the radius: they are sampled at Chebyshev points and interpolated, so that they
//! have exact derivatives without a linkage over dual numbers.

use grouser_real::Real;
use grouser_real::Scalar;

/// Nodes in the radius. The loads are ratios of low polynomials in it, and the remainder is measured.
const NODES: usize = 8;

/// The weight of a robot and what each of its wheels carries, on each slope of a mission.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// N.
    pub weight: f64,
    /// N at right angles to the ground: for each slope, for each wheel.
    pub loads: Vec<Vec<f64>>,
}

/// A polynomial over [low, high] by its Chebyshev coefficients.
#[derive(Clone, Debug, PartialEq)]
struct Polynomial(Vec<f64>);

impl Polynomial {
    /// Through values at the Chebyshev points of [`nodes`].
    fn through(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let coefficient = |k: usize| {
            let sum: f64 = values
                .iter()
                .enumerate()
                .map(|(j, value)| value * Real::cos(k as f64 * angle(j, values.len())))
                .sum();
            if k == 0 { sum / n } else { 2.0 * sum / n }
        };
        Self((0..values.len()).map(coefficient).collect())
    }

    /// Clenshaw's recurrence at `x` in [−1, 1].
    fn at<R: Scalar>(&self, x: R) -> R {
        let (mut b_1, mut b_2) = (R::ZERO, R::ZERO);
        for c in self.0.iter().skip(1).rev() {
            let b = R::from_f64(*c) + (x + x) * b_1 - b_2;
            (b_2, b_1) = (b_1, b);
        }
        R::from_f64(self.0.first().copied().unwrap_or(0.0)) + x * b_1 - b_2
    }
}

fn angle(j: usize, n: usize) -> f64 {
    std::f64::consts::PI * (j as f64 + 0.5) / n as f64
}

/// The radii at which the loads are sampled.
fn nodes((low, high): (f64, f64)) -> Vec<f64> {
    if low == high {
        return vec![low];
    }
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    (0..NODES)
        .map(|j| middle + half * Real::cos(angle(j, NODES)))
        .collect()
}

/// A number that is linear in mass and shift: at none of both, per kg, and per m.
#[derive(Clone, Debug, PartialEq)]
struct Affine {
    bare: Polynomial,
    per_mass: Polynomial,
    per_shift: Polynomial,
}

/// Loads over radius, mass and shift.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stance {
    pub(super) radii: (f64, f64),
    pub(super) shifts: (f64, f64),
    weight: f64,
    weight_per_mass: f64,
    /// By slope, then by wheel.
    loads: Vec<Vec<Affine>>,
    /// The greatest difference between interpolated and sampled loads beside the nodes, share of the weight.
    pub(super) error: f64,
}

impl Stance {
    /// From samples of `stand` (radius in m, mass of a new wheel in kg, shift of the chassis' mass forwards in m).
    pub(super) fn sample<E>(
        radii: (f64, f64),
        shifts: (f64, f64),
        mut stand: impl FnMut(f64, f64, f64) -> Result<Standing, E>,
    ) -> Result<Self, E> {
        let at = nodes(radii);
        let mut samples = Vec::with_capacity(at.len());
        // the bound that is further away; what no shift gives is 0
        let shift = if shifts.0.abs() > shifts.1.abs() {
            shifts.0
        } else {
            shifts.1
        };
        for radius in &at {
            let bare = stand(*radius, 0.0, 0.0)?;
            let heavy = stand(*radius, 1.0, 0.0)?;
            let shifted = if shift == 0.0 {
                bare.clone()
            } else {
                stand(*radius, 0.0, shift)?
            };
            samples.push([bare, heavy, shifted]);
        }
        let first = &samples[0];
        let per = if shift == 0.0 { 0.0 } else { 1.0 / shift };
        let affine = |slope: usize, wheel: usize| {
            let over = |which: usize, scale: f64, base: f64| {
                let all = samples.iter().map(|sample| {
                    let load = |of: &Standing| of.loads[slope][wheel];
                    scale * (load(&sample[which]) - base * load(&sample[0]))
                });
                Polynomial::through(&all.collect::<Vec<f64>>())
            };
            Affine {
                bare: over(0, 1.0, 0.0),
                per_mass: over(1, 1.0, 1.0),
                per_shift: over(2, per, 1.0),
            }
        };
        let loads = (0..first[0].loads.len())
            .map(|slope| {
                let wheels = first[0].loads[slope].len();
                (0..wheels).map(|wheel| affine(slope, wheel)).collect()
            })
            .collect();
        let mut stance = Self {
            radii,
            shifts,
            weight: first[0].weight,
            weight_per_mass: first[1].weight - first[0].weight,
            loads,
            error: 0.0,
        };
        for share in [0.0, 0.3, 0.62, 1.0] {
            let radius = radii.0 + share * (radii.1 - radii.0);
            let shift = shifts.0 + (0.8 - 0.6 * share) * (shifts.1 - shifts.0);
            let exact = stand(radius, 0.7, shift)?;
            for (slope, row) in exact.loads.iter().enumerate() {
                for (wheel, load) in row.iter().enumerate() {
                    let off = (stance.load(slope, wheel, (radius, 0.7, shift)) - load).abs();
                    stance.error = stance.error.max(off / exact.weight);
                }
            }
        }
        Ok(stance)
    }

    pub(super) fn wheels(&self) -> usize {
        self.loads.first().map_or(0, Vec::len)
    }

    /// N.
    pub(super) fn weight<R: Scalar>(&self, mass: R) -> R {
        R::from_f64(self.weight) + mass * R::from_f64(self.weight_per_mass)
    }

    /// N, of a radius (m), mass (kg) and shift (m).
    pub(super) fn load<R: Scalar>(
        &self,
        slope: usize,
        wheel: usize,
        (radius, mass, shift): (R, R, R),
    ) -> R {
        let (low, high) = self.radii;
        let x = if low == high {
            R::ZERO
        } else {
            (radius * R::from_f64(2.0) - R::from_f64(low + high)) * R::from_f64(1.0 / (high - low))
        };
        let Affine {
            bare,
            per_mass,
            per_shift,
        } = &self.loads[slope][wheel];
        bare.at(x) + mass * per_mass.at(x) + shift * per_shift.at(x)
    }

    /// Do two wheels carry the same on every slope, whatever the new wheel is?
    pub(super) fn carry_alike(&self, a: usize, b: usize) -> bool {
        let tolerance = 1e-10 * self.weight.abs();
        let alike = |a: &Polynomial, b: &Polynomial| {
            a.0.iter()
                .zip(&b.0)
                .all(|(a, b)| (a - b).abs() <= tolerance)
        };
        self.loads.iter().all(|row| {
            let (a, b) = (&row[a], &row[b]);
            alike(&a.bare, &b.bare)
                && alike(&a.per_mass, &b.per_mass)
                && alike(&a.per_shift, &b.per_shift)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolated_loads_are_those_of_a_rigid_robot_between_the_nodes() {
        // Two axles at ±0.2 m, centre of gravity 0.1 m above the axle, on a slope of 20°.
        let stand =
            |radius: f64, mass: f64, shift: f64| -> Result<Standing, std::convert::Infallible> {
                let weight = (10.0 + 4.0 * mass) * 9.81;
                let (sin, cos) = 20f64.to_radians().sin_cos();
                let height = (10.0 * (0.1 + radius) + 4.0 * mass * radius) / (10.0 + 4.0 * mass);
                let rear =
                    weight * (0.5 * cos + sin * height / 0.4) - 10.0 * 9.81 * cos * shift / 0.4;
                let loads = vec![vec![weight * cos - rear, rear]];
                Ok(Standing { weight, loads })
            };
        let stance = Stance::sample((0.05, 0.3), (-0.1, 0.05), stand).unwrap();
        assert!(stance.error < 1e-12, "{}", stance.error);
        let exact = stand(0.217, 1.3, 0.03).unwrap();
        for wheel in 0..2 {
            let off = stance.load(0, wheel, (0.217, 1.3, 0.03)) - exact.loads[0][wheel];
            assert!(off.abs() < 1e-9, "{off}");
        }
        assert!(!stance.carry_alike(0, 1) && stance.carry_alike(1, 1));
        assert!((stance.weight(1.3) - exact.weight).abs() < 1e-9);
    }
}
