//! Lukšan & Vlček, TR V-798, 2000: the linearly constrained set TEST22.

use std::f64::consts::TAU;

use grouser_opt::{Functions, ProblemParams, Relation};
use grouser_real::Scalar;

use super::luksan_vlcek_unconstrained::{WONG_START, hs113};
use super::suite::{absolute, at_most, plain};

struct Wong2;
impl Functions for Wong2 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let (objective, curved, _) = hs113(x);
        f[0] = objective;
        for (f, g) in f[1..].iter_mut().zip(curved) {
            *f = objective + R::from_f64(10.0) * g;
        }
    }
}

/// As in the unconstrained set, with the linear constraints of HS 113 kept as such.
pub(crate) fn wong2() -> ProblemParams<'static> {
    plain(&WONG_START, 6, Wong2).linear(vec![
        at_most(1, 10, &[(0, 4.0), (1, 5.0), (6, -3.0), (7, 9.0)], 105.0),
        at_most(2, 10, &[(0, 10.0), (1, -8.0), (6, -17.0), (7, 2.0)], 0.0),
        at_most(3, 10, &[(0, -8.0), (1, 2.0), (8, 5.0), (9, -2.0)], 12.0),
    ])
}

struct Mad1;
impl Functions for Mad1 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = x[0].square() + x[1].square() + x[0] * x[1] - R::ONE;
        f[1] = x[0].sin();
        f[2] = -x[1].cos();
    }
}

pub(crate) fn mad1() -> ProblemParams<'static> {
    plain(&[1.0, 2.0], 3, Mad1).linear(vec![at_most(1, 2, &[(0, -1.0), (1, -1.0)], -0.5)])
}

struct Mad4;
impl Functions for Mad4 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        f[0] = -(x[0] - x[1]).exp();
        f[1] = (x[0] - R::ONE).sinh() - R::ONE;
        f[2] = -x[1].ln() - R::ONE;
    }
}

pub(crate) fn mad4() -> ProblemParams<'static> {
    let mut params =
        plain(&[-1.0, 0.01], 3, Mad4).linear(vec![at_most(1, 2, &[(0, -0.05), (1, 1.0)], 0.5)]);
    params.variables[1].lower = 0.01;
    params
}

struct Pentagon;
impl Functions for Pentagon {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        for (f, (i, j)) in f.iter_mut().zip([(0, 2), (2, 4), (4, 0)]) {
            *f = -((x[i] - x[j]).square() + (x[i + 1] - x[j + 1]).square()).sqrt();
        }
    }
}

/// Three points in a regular pentagon, as far apart as can be.
pub(crate) fn pentagon() -> ProblemParams<'static> {
    let mut linear = Vec::new();
    for point in 0..3 {
        for side in 0..5 {
            let (sin, cos) = (TAU * f64::from(side) / 5.0).sin_cos();
            let terms = [(2 * point, sin), (2 * point + 1, cos)];
            linear.push(at_most(linear.len() + 1, 6, &terms, 1.0));
        }
    }
    plain(&[-1.0, 0.0, 0.0, -1.0, 1.0, 0.0], 3, Pentagon).linear(linear)
}

struct Antenna;
impl Functions for Antenna {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        for (j, f) in f.iter_mut().enumerate() {
            let angle = (8.5 + 0.5 * (j + 1) as f64).to_radians();
            let wave = R::from_f64(TAU * angle.sin());
            let mut sum = R::ZERO;
            for &x in x {
                sum += (wave * x).cos();
            }
            *f = (R::ONE + R::from_f64(2.0) * sum) / R::from_f64(15.0);
        }
    }
}

/// An antenna array: the last element fixed, two of them one wavelength apart, the others at least 0.4.
pub(crate) fn mad6() -> ProblemParams<'static> {
    let start: Vec<f64> = (1..=7).map(|i| 0.5 * f64::from(i)).collect();
    let mut linear: Vec<_> = (0..6)
        .map(|i| at_most(i + 1, 7, &[(i, 1.0), (i + 1, -1.0)], -0.4))
        .collect();
    let mut apart = at_most(7, 7, &[(3, -1.0), (5, 1.0)], 1.0);
    apart.relation = Relation::Equal;
    linear.push(apart);
    let mut params = absolute(&start, 163, Antenna).linear(linear);
    params.variables[0].lower = 0.4;
    (params.variables[6].lower, params.variables[6].upper) = (3.5, 3.5);
    params
}
