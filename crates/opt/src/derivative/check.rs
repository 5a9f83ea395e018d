//! Derivatives that a model claims, checked against finite differences entry by entry.

use crate::derivative::Differences;
use crate::jacobian::Jacobian;
use crate::model::Model;
use crate::problem::Problem;

/// One entry of the Jacobian that is off.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WrongEntry {
    /// The function whose gradient is off.
    pub function: String,
    /// The variable by which it is differentiated.
    pub variable: String,
    /// What the model claims.
    pub claimed: f64,
    /// What central differences give.
    pub difference: f64,
}

/// What [`check_derivatives`] found.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct DerivativeCheck {
    /// Every entry that is off, function by function.
    pub wrong: Vec<WrongEntry>,
    /// How many entries were compared.
    pub entries: usize,
    /// The greatest discrepancy |claimed − difference| / max(1, |difference|).
    pub worst: f64,
}

/// Compares the model's derivatives at `x` with central differences and names each entry that is
/// off by more than `tolerance`·max(1, |difference|). 1e-6 is a sensible tolerance: the differences
/// themselves are good to about 1e-9 for functions of ordinary size.
///
/// # Errors
/// `x` has another length than the problem has variables, or a point that is not finite.
///
/// ```
/// use grouser_opt::{Jacobian, Model, Problem, ProblemParams, check_derivatives};
///
/// /// x² with the derivative 3 x, which is wrong.
/// struct Wrong;
/// impl Model for Wrong {
///     fn values(&self, x: &[f64], values: &mut [f64]) {
///         values[0] = x[0] * x[0];
///     }
///     fn derivatives(&self, x: &[f64], values: &mut [f64], jacobian: &mut Jacobian) {
///         self.values(x, values);
///         jacobian.set(0, 0, 3.0 * x[0]);
///     }
/// }
/// let problem = Problem::new(ProblemParams::new(&[1.0], 1, Wrong))?;
/// let check = check_derivatives(&problem, &[2.0], 1e-6)?;
/// assert_eq!(check.wrong[0].claimed, 6.0);
/// assert!((check.wrong[0].difference - 4.0).abs() < 1e-6);
/// # Ok::<(), grouser_opt::Error>(())
/// ```
pub fn check_derivatives(
    problem: &Problem<'_>,
    x: &[f64],
    tolerance: f64,
) -> crate::Result<DerivativeCheck> {
    crate::Error::check_length("the point", x.len(), problem.variables().len())?;
    for (variable, &value) in problem.variables().iter().zip(x) {
        crate::Error::check_finite("point", &variable.name, value)?;
    }
    let functions = problem.function_count();
    let (mut values, mut claimed) = (vec![0.0; functions], Jacobian::zeros(functions, x.len()));
    problem.model().derivatives(x, &mut values, &mut claimed);
    let lower: Vec<f64> = problem.variables().iter().map(|v| v.lower).collect();
    let upper: Vec<f64> = problem.variables().iter().map(|v| v.upper).collect();
    let mut differences = Jacobian::zeros(functions, x.len());
    Differences::new(|x: &[f64], out: &mut [f64]| problem.model().values(x, out))
        .within(&lower, &upper)
        .derivatives(x, &mut values, &mut differences);
    let mut check = DerivativeCheck::default();
    for row in 0..functions {
        for (column, variable) in problem.variables().iter().enumerate() {
            if !(variable.lower < variable.upper) {
                continue;
            }
            let (a, b) = (claimed.row(row)[column], differences.row(row)[column]);
            let discrepancy = (a - b).abs() / b.abs().max(1.0);
            check.entries += 1;
            if !(discrepancy <= tolerance) {
                check.wrong.push(WrongEntry {
                    function: problem.function_name(row).to_owned(),
                    variable: variable.name.clone(),
                    claimed: a,
                    difference: b,
                });
            }
            if discrepancy > check.worst || discrepancy.is_nan() {
                check.worst = discrepancy;
            }
        }
    }
    Ok(check)
}
