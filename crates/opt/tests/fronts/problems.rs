//! Published multi-objective problems with known fronts.

use grouser_opt::{Exact, Functions, ParetoSettings, Problem, ProblemParams, Variable};
use grouser_real::Scalar;

/// ZDT1 (Zitzler, Deb & Thiele 2000): front f2 = 1 − √f1.
pub(crate) struct Zdt1;
impl Functions for Zdt1 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let mut sum = R::ZERO;
        for &x in &x[1..] {
            sum += x;
        }
        let g = R::ONE + sum * R::from_f64(9.0 / (x.len() - 1) as f64);
        f[0] = x[0];
        f[1] = g * (R::ONE - (x[0] / g).sqrt());
    }
}

/// DTLZ2 (Deb, Thiele, Laumanns & Zitzler 2005) with three objectives: the front is the unit sphere.
pub(crate) struct Dtlz2;
impl Functions for Dtlz2 {
    fn evaluate<R: Scalar>(&self, x: &[R], f: &mut [R]) {
        let mut g = R::ZERO;
        for &x in &x[2..] {
            g += (x - R::from_f64(0.5)).square();
        }
        let quarter = R::PI * R::from_f64(0.5);
        let (s1, c1) = (x[0] * quarter).sin_cos();
        let (s2, c2) = (x[1] * quarter).sin_cos();
        f[0] = (R::ONE + g) * c1 * c2;
        f[1] = (R::ONE + g) * c1 * s2;
        f[2] = (R::ONE + g) * s1;
    }
}

fn unit_box(n: usize, m: usize, model: impl Functions + 'static) -> Problem<'static> {
    let params = ProblemParams::new(&vec![0.9; n], m, Exact(model));
    let variables: Vec<_> = params
        .variables
        .iter()
        .map(|v| Variable::bounded(v.name.clone(), 0.9, 0.0, 1.0))
        .collect();
    Problem::new(params.variables(variables)).expect("a published problem")
}

pub(crate) fn zdt1() -> (Problem<'static>, ParetoSettings) {
    let mut settings = ParetoSettings::default();
    settings.population = 100;
    settings.generations = 250;
    (unit_box(30, 2, Zdt1), settings)
}

pub(crate) fn dtlz2() -> (Problem<'static>, ParetoSettings) {
    let mut settings = ParetoSettings::default();
    settings.population = 92;
    settings.generations = 250;
    settings.divisions = Some(12);
    (unit_box(12, 3, Dtlz2), settings)
}
