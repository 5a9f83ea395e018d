//! Slips of the greatest pull or efficiency of many loads.

use crate::error::{Error, Result};
use crate::operating_point::tractive_efficiency;
use crate::settings::Settings;
use crate::slip_search::BestSearch;
use crate::status::SolveStatus;
use crate::wheel::RigidWheel;
use crate::wheel_on_soil::WheelOnSoil;

use super::batch::BatchKernel;
use super::columns::BatchInput;
use super::searches::{End, SlipSearch, Traction};

/// A pull above this share of max(W, T/r) may be one: forces on lanes and by themselves agree to 1e-9 of it.
const NO_PULL: f64 = -1e-8;

/// What is greatest at the best slip.
///
/// ```
/// use grouser_terra::BestOf;
/// assert_eq!(BestOf::default(), BestOf::Efficiency);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BestOf {
    /// The drawbar pull, N.
    Pull,
    /// The tractive efficiency.
    #[default]
    Efficiency,
}

/// Where a search for best slips writes: one slice a quantity, all of one length. Where the status of a point is not
/// [`SolveStatus::Solved`] its numbers are NaN.
#[derive(Debug)]
pub struct BestSlipColumns<'a> {
    /// Slip.
    pub slip: &'a mut [f64],
    /// The greatest pull (N) or efficiency.
    pub value: &'a mut [f64],
    /// How each point ended; [`SolveStatus::NoSolution`] where no slip carries the load or, for the efficiency, none pulls.
    pub status: &'a mut [SolveStatus],
}

impl BatchKernel {
    /// The slip in [0, 1] of the greatest pull or efficiency of a wheel under each `load` (N).
    ///
    /// Smooth wheels run on lanes, all other points through [`WheelOnSoil::slip_of_maximum_pull`] and
    /// [`WheelOnSoil::slip_of_maximum_efficiency`]. The values of both agree to the accuracy of the forces, the slips to about
    /// its square root, since an optimum is flat.
    ///
    /// ```
    /// use grouser_terra::{BatchKernel, BestOf, BestSlipColumns, RigidWheel, SolveStatus, catalogue};
    ///
    /// let kernel = BatchKernel::new(catalogue::find("dry-sand").expect("in the catalogue").soil()?);
    /// let ([mut slip, mut value], mut status) = ([[0.0; 3]; 2], [SolveStatus::default(); 3]);
    /// let mut columns = BestSlipColumns { slip: &mut slip, value: &mut value, status: &mut status };
    /// let loads = [20.0, 40.0, -1.0];
    /// kernel.best_slip(&RigidWheel::new(0.125, 0.1)?, BestOf::Efficiency, &loads, &mut columns)?;
    /// assert!(value[1] < value[0] && value[0] < 1.0 - slip[0]); // η < 1 − s
    /// assert_eq!(status[2], SolveStatus::BadInput);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Lengths`] if the columns differ in length. A bad point is a status.
    pub fn best_slip<'a>(
        &self,
        wheel: &RigidWheel,
        of: BestOf,
        load: impl Into<BatchInput<'a>>,
        out: &mut BestSlipColumns<'_>,
    ) -> Result<()> {
        let load = load.into();
        let n = out.status.len();
        Error::check_length(out.slip.len(), n)?;
        Error::check_length(out.value.len(), n)?;
        load.check_length(n)?;
        let on_soil = WheelOnSoil::new(*wheel, *self.soil(), Settings::default())?;
        let begin = |i| Search::new(of, wheel.radius(), load.at(i));
        self.searches(&on_soil, n, begin, |i, end| {
            let nan = (f64::NAN, f64::NAN);
            let ((slip, value), status) = match end {
                End::Found(best) => (best, SolveStatus::Solved),
                End::NoSolution => (nan, SolveStatus::NoSolution),
                End::Unsure => {
                    let alone = match of {
                        BestOf::Pull => on_soil.slip_of_maximum_pull(load.at(i)),
                        BestOf::Efficiency => on_soil.slip_of_maximum_efficiency(load.at(i)),
                    };
                    match alone {
                        Ok(Some(best)) => ((best.slip.value(), best.value), SolveStatus::Solved),
                        Ok(None) => (nan, SolveStatus::NoSolution),
                        Err(_) => (nan, SolveStatus::BadInput),
                    }
                }
            };
            (out.slip[i], out.value[i], out.status[i]) = (slip, value, status);
        })
    }
}

/// The search of one point, as [`WheelOnSoil::slip_of_maximum_pull`] makes it.
struct Search {
    of: BestOf,
    radius: f64,
    load: f64,
    slip: f64,
    best: BestSearch,
    /// The greatest pull, as a share of max(W, T/r).
    max_pull: f64,
    is_over: bool,
}

impl Search {
    /// `None` for a load that only the general search can name.
    fn new(of: BestOf, radius: f64, load: f64) -> Option<Self> {
        let mut best = BestSearch::new();
        let slip = best.next_slip()?;
        (load > 0.0 && load <= 1e12).then_some(Self {
            of,
            radius,
            load,
            slip,
            best,
            max_pull: f64::NEG_INFINITY,
            is_over: false,
        })
    }
}

impl SlipSearch for Search {
    type Found = (f64, f64);

    fn next(&self) -> (f64, f64) {
        (self.slip, self.load)
    }

    fn feed(&mut self, found: Option<Traction>) {
        let value = found.and_then(
            |Traction {
                 drawbar_pull,
                 torque,
             }| {
                let size = self.load.max(torque.abs() / self.radius);
                self.max_pull = self.max_pull.max(drawbar_pull / size);
                match self.of {
                    BestOf::Pull => Some(drawbar_pull),
                    BestOf::Efficiency => {
                        tractive_efficiency(1.0 - self.slip, self.radius, drawbar_pull, torque)
                    }
                }
            },
        );
        self.best.feed(value);
        match self.best.next_slip() {
            Some(slip) => self.slip = slip,
            None => self.is_over = true,
        }
    }

    fn end(&self) -> Option<End<(f64, f64)>> {
        self.is_over.then(|| match self.best.best() {
            Some(best) => End::Found(best),
            None if self.max_pull > NO_PULL => End::Unsure,
            None => End::NoSolution,
        })
    }
}

#[cfg(test)]
mod tests;
