//! Lukšan & Vlček, Test problems for nonsmooth unconstrained and linearly constrained optimization,
//! TR V-798, Institute of Computer Science AS CR, 2000: the set TEST06.

use grouser_opt::{Functions, ProblemParams};
use grouser_real::Scalar;

use super::suite::{absolute, plain};

struct Spiral;
impl Functions for Spiral {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let r = x[0].hypot(x[1]);
        let bowl = R::from_f64(0.005) * r.square();
        f[0] = (x[0] - r * r.cos()).square() + bowl;
        f[1] = (x[1] - r * r.sin()).square() + bowl;
    }
}

pub(crate) fn spiral() -> ProblemParams<'static> {
    plain(&[1.418_31, -4.794_62], 2, Spiral)
}

struct RosenSuzuki;
impl Functions for RosenSuzuki {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let c = R::from_f64;
        let [a, b, d, e] = [x[0], x[1], x[2], x[3]];
        let (a2, b2, d2, e2) = (a.square(), b.square(), d.square(), e.square());
        let f1 = a2 + b2 + c(2.0) * d2 + e2 - c(5.0) * (a + b) - c(21.0) * d + c(7.0) * e;
        let ten = c(10.0);
        f[0] = f1;
        f[1] = f1 + ten * (a2 + b2 + d2 + e2 + a - b + d - e - c(8.0));
        f[2] = f1 + ten * (a2 + c(2.0) * b2 + d2 + c(2.0) * e2 - a - e - ten);
        f[3] = f1 + ten * (a2 + b2 + d2 + c(2.0) * a - b - e - c(5.0));
    }
}

pub(crate) fn rosen_suzuki() -> ProblemParams<'static> {
    plain(&[0.0; 4], 4, RosenSuzuki)
}

struct Pbc3;
impl Functions for Pbc3 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        for (i, f) in f.iter_mut().enumerate() {
            let t = 0.5 * i as f64;
            let y = 0.15 * (-t).exp() + (-5.0 * t).exp() / 52.0
                - (-2.0 * t).exp() * (3.0 * (2.0 * t).sin() + 11.0 * (2.0 * t).cos()) / 65.0;
            let t = R::from_f64(t);
            *f = x[2] / x[1] * (-x[0] * t).exp() * (x[1] * t).sin() - R::from_f64(y);
        }
    }
}

pub(crate) fn pbc3() -> ProblemParams<'static> {
    absolute(&[1.0; 3], 21, Pbc3)
}

struct KowalikOsborne;
impl Functions for KowalikOsborne {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        const DATA: [(f64, f64); 11] = [
            (4.0, 0.1957),
            (2.0, 0.1947),
            (1.0, 0.1735),
            (0.5, 0.16),
            (0.25, 0.0844),
            (0.167, 0.0627),
            (0.125, 0.0456),
            (0.1, 0.0342),
            (0.0833, 0.0323),
            (0.0714, 0.0235),
            (0.0625, 0.0246),
        ];
        for (f, (u, y)) in f.iter_mut().zip(DATA) {
            let u = R::from_f64(u);
            *f = R::from_f64(y) - x[0] * u * (u + x[1]) / ((u + x[2]) * u + x[3]);
        }
    }
}

pub(crate) fn kowalik_osborne() -> ProblemParams<'static> {
    absolute(&[0.25, 0.39, 0.415, 0.39], 11, KowalikOsborne)
}

struct Davidon2;
impl Functions for Davidon2 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        for (i, f) in f.iter_mut().enumerate() {
            let t = 0.2 * (i + 1) as f64;
            let c = R::from_f64;
            *f = (x[0] + x[1] * c(t) - c(t.exp())).square()
                + (x[2] + x[3] * c(t.sin()) - c(t.cos())).square();
        }
    }
}

pub(crate) fn davidon_2() -> ProblemParams<'static> {
    absolute(&[25.0, 5.0, -5.0, -1.0], 20, Davidon2)
}

struct Oet5;
impl Functions for Oet5 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        for (i, f) in f.iter_mut().enumerate() {
            let t = 0.25 + 0.75 * i as f64 / 20.0;
            let u = R::from_f64(t);
            *f = x[3] - ((x[0] * u + x[1]) * u + x[2]).square() - R::from_f64(t.sqrt());
        }
    }
}

pub(crate) fn oet5() -> ProblemParams<'static> {
    absolute(&[1.0; 4], 21, Oet5)
}

struct RationalExp;
impl Functions for RationalExp {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        for (i, f) in f.iter_mut().enumerate() {
            let t = 0.1 * i as f64 - 1.0;
            let u = R::from_f64(t);
            *f = (x[0] + u * x[1]) / (R::ONE + u * (x[2] + u * (x[3] + u * x[4])))
                - R::from_f64(t.exp());
        }
    }
}

pub(crate) fn exp() -> ProblemParams<'static> {
    absolute(&[0.5, 0.0, 0.0, 0.0, 0.0], 21, RationalExp)
}

struct Evd61;
impl Functions for Evd61 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        for (i, f) in f.iter_mut().enumerate() {
            let t = 0.1 * i as f64;
            let y = 0.5 * (-t).exp() - (-2.0 * t).exp()
                + 0.5 * (-3.0 * t).exp()
                + 1.5 * (-1.5 * t).exp() * (7.0 * t).sin()
                + (-2.5 * t).exp() * (5.0 * t).sin();
            let t = R::from_f64(t);
            *f = x[0] * (-x[1] * t).exp() * (x[2] * t + x[3]).cos() + x[4] * (-x[5] * t).exp()
                - R::from_f64(y);
        }
    }
}

pub(crate) fn evd61() -> ProblemParams<'static> {
    absolute(&[2.0, 2.0, 7.0, 0.0, -2.0, 1.0], 51, Evd61)
}

/// The 41 frequencies of the digital filter problem.
fn frequency(i: usize) -> f64 {
    match i {
        0..=5 => 0.01 * i as f64,
        6..=19 => 0.07 + 0.03 * (i - 6) as f64,
        20 => 0.5,
        21..=34 => 0.54 + 0.03 * (i - 21) as f64,
        _ => 0.95 + 0.01 * (i - 35) as f64,
    }
}

struct Filter;
impl Functions for Filter {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        for (i, f) in f.iter_mut().enumerate() {
            let y = frequency(i);
            let (sin, cos) = (std::f64::consts::PI * y).sin_cos();
            let q = |a: R, b: R| {
                (a + (R::ONE + b) * R::from_f64(cos)).square()
                    + ((R::ONE - b) * R::from_f64(sin)).square()
            };
            *f = x[8]
                * (q(x[0], x[1]) / q(x[2], x[3])).sqrt()
                * (q(x[4], x[5]) / q(x[6], x[7])).sqrt()
                - R::from_f64((1.0 - 2.0 * y).abs());
        }
    }
}

pub(crate) fn filter() -> ProblemParams<'static> {
    absolute(
        &[0.0, 1.0, 0.0, -0.15, 0.0, -0.68, 0.0, -0.72, 0.37],
        41,
        Filter,
    )
}

/// Hock & Schittkowski's problem 113: its objective, five nonlinear constraints, three linear ones.
pub(crate) fn hs113<R: Scalar>(x: &[R]) -> (R, [R; 5], [R; 3]) {
    let c = R::from_f64;
    let from = |i: usize, centre: f64| (x[i] - c(centre)).square();
    let objective = x[0].square() + x[1].square() + x[0] * x[1] - c(14.0) * x[0] - c(16.0) * x[1]
        + from(2, 10.0)
        + c(4.0) * from(3, 5.0)
        + from(4, 3.0)
        + c(2.0) * from(5, 1.0)
        + c(5.0) * x[6].square()
        + c(7.0) * from(7, 11.0)
        + c(2.0) * from(8, 10.0)
        + from(9, 7.0)
        + c(45.0);
    let curved = [
        c(3.0) * from(0, 2.0) + c(4.0) * from(1, 3.0) + c(2.0) * x[2].square()
            - c(7.0) * x[3]
            - c(120.0),
        c(5.0) * x[0].square() + c(8.0) * x[1] + from(2, 6.0) - c(2.0) * x[3] - c(40.0),
        c(0.5) * from(0, 8.0) + c(2.0) * from(1, 4.0) + c(3.0) * x[4].square() - x[5] - c(30.0),
        x[0].square() + c(2.0) * from(1, 2.0) - c(2.0) * x[0] * x[1] + c(14.0) * x[4]
            - c(6.0) * x[5],
        c(6.0) * x[1] - c(3.0) * x[0] + c(12.0) * from(8, 8.0) - c(7.0) * x[9],
    ];
    let linear = [
        c(4.0) * x[0] + c(5.0) * x[1] - c(3.0) * x[6] + c(9.0) * x[7] - c(105.0),
        c(10.0) * x[0] - c(8.0) * x[1] - c(17.0) * x[6] + c(2.0) * x[7],
        c(2.0) * x[1] - c(8.0) * x[0] + c(5.0) * x[8] - c(2.0) * x[9] - c(12.0),
    ];
    (objective, curved, linear)
}

pub(crate) const WONG_START: [f64; 10] = [2.0, 3.0, 5.0, 5.0, 1.0, 2.0, 7.0, 3.0, 6.0, 10.0];

struct Wong2;
impl Functions for Wong2 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let (objective, curved, linear) = hs113(x);
        f[0] = objective;
        for (f, g) in f[1..].iter_mut().zip(curved.iter().chain(&linear)) {
            *f = objective + R::from_f64(10.0) * *g;
        }
    }
}

pub(crate) fn wong2() -> ProblemParams<'static> {
    plain(&WONG_START, 9, Wong2)
}

struct Polak3;
impl Functions for Polak3 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        for (k, f) in (1_i32..).zip(f) {
            let mut sum = R::ZERO;
            for (i, &x) in (1_i32..).zip(x) {
                let centre = f64::from(2 * i + k - 3).sin();
                sum += R::from_f64(f64::from(i + k - 1)) * (x - R::from_f64(centre)).square().exp();
            }
            *f = sum;
        }
    }
}

pub(crate) fn polak3() -> ProblemParams<'static> {
    plain(&[1.0; 11], 10, Polak3)
}
