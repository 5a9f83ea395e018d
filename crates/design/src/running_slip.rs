//! The slip that a slip controller is given as its setpoint.

use grouser_opt::{Status, Variable};
use grouser_terra::{RigidWheel, Soil};

use crate::builder::State;
use crate::design::Design;
use crate::error::{Error, Result};
use crate::solve::Answer;

/// The slip of the greatest tractive efficiency of a wheel under `load_n` (N) on a soil with all its laws,
/// between 0.01 and 0.8.
///
/// ```
/// use grouser_design::running_slip;
/// use grouser_terra::{RigidWheel, catalogue};
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let slip = running_slip(&RigidWheel::new(0.125, 0.1)?, &soil, 60.0)?;
/// assert!((slip - 0.4771).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::NoRunningSlip`] where the search ends without a solution: the soil carries no such wheel, or the
/// wheel pulls at no slip; what [`DesignBuilder::build`](crate::DesignBuilder::build) refuses.
pub fn running_slip(wheel: &RigidWheel, soil: &Soil, load_n: f64) -> Result<f64> {
    let design = Design::builder(wheel, soil, State::under_load(load_n))
        .title("The slip to run at")
        .variable(Variable::bounded("slip", 0.2, 0.01, 0.8))
        .minimise("efficiency", "-tractive_efficiency")
        .build()?;
    let no_slip = |reason| Error::NoRunningSlip { reason };
    let Answer::Optimum(optimum) = design.solve()? else {
        return Err(no_slip("the search gave a front".to_owned()));
    };
    match optimum.status {
        Status::NotFinite {
            reason: Some(reason),
            ..
        } => Err(no_slip(reason)),
        Status::NotFinite { .. } | Status::NoFeasiblePoint(_) | Status::Unbounded => {
            Err(no_slip(optimum.status.name().to_owned()))
        }
        _ => Ok(optimum.x[0]),
    }
}
