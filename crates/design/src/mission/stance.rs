//! What the wheels carry on each slope, as functions of the radius and the mass of the new wheel.
//!
//! A larger wheel raises the chassis, so that loads shift further on a slope; a heavier one adds weight. Loads are
//! linear in the mass and smooth in the radius: they are sampled at Chebyshev points and interpolated, so that they
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

/// A number that is linear in the mass: at no mass, and per kg.
#[derive(Clone, Debug, PartialEq)]
struct Affine {
    bare: Polynomial,
    per_mass: Polynomial,
}

/// Loads over radius and mass.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stance {
    pub(super) radii: (f64, f64),
    weight: f64,
    weight_per_mass: f64,
    /// By slope, then by wheel.
    loads: Vec<Vec<Affine>>,
    /// The greatest difference between interpolated and sampled loads beside the nodes, share of the weight.
    pub(super) error: f64,
}

impl Stance {
    /// From samples of `stand` (radius in m, mass of a new wheel in kg).
    pub(super) fn sample<E>(
        radii: (f64, f64),
        mut stand: impl FnMut(f64, f64) -> Result<Standing, E>,
    ) -> Result<Self, E> {
        let at = nodes(radii);
        let mut pairs = Vec::with_capacity(at.len());
        for radius in &at {
            pairs.push((stand(*radius, 0.0)?, stand(*radius, 1.0)?));
        }
        let first = &pairs[0];
        let affine = |slope: usize, wheel: usize| {
            let bare: Vec<f64> = pairs.iter().map(|(b, _)| b.loads[slope][wheel]).collect();
            let per_mass: Vec<f64> = pairs
                .iter()
                .map(|(b, m)| m.loads[slope][wheel] - b.loads[slope][wheel])
                .collect();
            Affine {
                bare: Polynomial::through(&bare),
                per_mass: Polynomial::through(&per_mass),
            }
        };
        let loads = (0..first.0.loads.len())
            .map(|slope| {
                let wheels = first.0.loads[slope].len();
                (0..wheels).map(|wheel| affine(slope, wheel)).collect()
            })
            .collect();
        let mut stance = Self {
            radii,
            weight: first.0.weight,
            weight_per_mass: first.1.weight - first.0.weight,
            loads,
            error: 0.0,
        };
        for share in [0.0, 0.3, 0.62, 1.0] {
            let radius = radii.0 + share * (radii.1 - radii.0);
            let exact = stand(radius, 0.7)?;
            for (slope, row) in exact.loads.iter().enumerate() {
                for (wheel, load) in row.iter().enumerate() {
                    let off = (stance.load(slope, wheel, radius, 0.7) - load).abs();
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

    /// N.
    pub(super) fn load<R: Scalar>(&self, slope: usize, wheel: usize, radius: R, mass: R) -> R {
        let (low, high) = self.radii;
        let x = if low == high {
            R::ZERO
        } else {
            (radius * R::from_f64(2.0) - R::from_f64(low + high)) * R::from_f64(1.0 / (high - low))
        };
        let Affine { bare, per_mass } = &self.loads[slope][wheel];
        bare.at(x) + mass * per_mass.at(x)
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
            alike(&row[a].bare, &row[b].bare) && alike(&row[a].per_mass, &row[b].per_mass)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolated_loads_are_those_of_a_rigid_robot_between_the_nodes() {
        // Two axles at ±0.2 m, centre of gravity 0.1 m above the axle, on a slope of 20°.
        let stand = |radius: f64, mass: f64| -> Result<Standing, std::convert::Infallible> {
            let weight = (10.0 + 4.0 * mass) * 9.81;
            let (sin, cos) = 20f64.to_radians().sin_cos();
            let height = (10.0 * (0.1 + radius) + 4.0 * mass * radius) / (10.0 + 4.0 * mass);
            let rear = weight * (0.5 * cos + sin * height / 0.4);
            let loads = vec![vec![weight * cos - rear, rear]];
            Ok(Standing { weight, loads })
        };
        let stance = Stance::sample((0.05, 0.3), stand).unwrap();
        assert!(stance.error < 1e-12, "{}", stance.error);
        let exact = stand(0.217, 1.3).unwrap();
        for wheel in 0..2 {
            let off = stance.load(0, wheel, 0.217, 1.3) - exact.loads[0][wheel];
            assert!(off.abs() < 1e-9, "{off}");
        }
        assert!(!stance.carry_alike(0, 1) && stance.carry_alike(1, 1));
        assert!((stance.weight(1.3) - exact.weight).abs() < 1e-9);
    }
}
