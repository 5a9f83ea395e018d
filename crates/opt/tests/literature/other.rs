//! Charalambous & Conn 1978 (CB2), and the worked example of the MATLAB manual's fminimax page.

use grouser_opt::{Functions, ProblemParams};
use grouser_real::Scalar;

use super::suite::plain;

struct Cb2;
impl Functions for Cb2 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let two = R::from_f64(2.0);
        f[0] = x[0].square() + x[1].powi(4);
        f[1] = (two - x[0]).square() + (two - x[1]).square();
        f[2] = two * (x[1] - x[0]).exp();
    }
}

pub(crate) fn cb2() -> ProblemParams<'static> {
    plain(&[2.0, 2.0], 3, Cb2)
}

struct MatlabPage;
impl Functions for MatlabPage {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let c = R::from_f64;
        f[0] = c(2.0) * x[0].square() + x[1].square() - c(48.0) * x[0] - c(40.0) * x[1] + c(304.0);
        f[1] = -x[0].square() - c(3.0) * x[1].square();
        f[2] = x[0] + c(3.0) * x[1] - c(18.0);
        f[3] = -x[0] - x[1];
        f[4] = x[0] + x[1] - c(8.0);
    }
}

/// The optimum (4, 4) is local: f2 falls without limit, but the others hold the maximum up.
pub(crate) fn matlab_page() -> ProblemParams<'static> {
    plain(&[0.1, 0.1], 5, MatlabPage)
}
