//! The best worst case of two objectives, and what each constraint costs.
//! `cargo run -p grouser-opt --example compromise`

use std::io::Write as _;

use grouser_opt::{Exact, Functions, Method, Problem, ProblemParams, Settings, Variable, solve};
use grouser_real::Scalar;

/// Two distances and a disc that the point must stay outside of.
struct Detour;

impl Functions for Detour {
    fn evaluate<R: Scalar>(&self, x: &[R], out: &mut [R]) {
        let c = R::from_f64;
        out[0] = (x[0] - c(1.0)).square() + x[1].square();
        out[1] = (x[0] + c(1.0)).square() + x[1].square();
        out[2] = c(0.25) - x[0].square() - x[1].square();
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = Problem::new(
        ProblemParams::new(&[0.5, 0.5], 2, Exact(Detour))
            .variables(vec![
                Variable::bounded("x", 0.5, -2.0, 2.0),
                Variable::bounded("y", 0.5, -2.0, 2.0),
            ])
            .inequalities(vec!["outside the disc".to_owned()]),
    )?;
    let solution = solve(&problem, &Method::Minimax, &Settings::default())?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}: x = {:.4?}", solution.status.name(), solution.x)?;
    writeln!(out, "objectives {:.4?}", solution.objectives)?;
    writeln!(
        out,
        "price of the disc {:.4?}",
        solution.multipliers.inequalities
    )?;
    Ok(())
}
