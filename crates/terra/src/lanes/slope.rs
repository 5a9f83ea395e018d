//! Slip demands of many slopes.

use grouser_real::Real;

use crate::angle::Angle;
use crate::error::{Error, Result};
use crate::settings::Settings;
use crate::slip_search::HeldSearch;
use crate::status::SolveStatus;
use crate::traction::SlopeOutcome;
use crate::wheel::RigidWheel;
use crate::wheel_on_soil::WheelOnSoil;

use super::batch::BatchKernel;
use super::columns::BatchInput;
use super::searches::{End, SlipSearch, Traction};

impl BatchKernel {
    /// The slip of smallest magnitude, at most [`MAX_SLIP`](crate::slope::MAX_SLIP), at which a wheel of each `weight` (N) holds
    /// each slope (rad): W cos α is carried and the drawbar pull is W sin α. Where no slip holds it, `slip` is NaN and the status [`SolveStatus::NoSolution`].
    ///
    /// On lanes are smooth wheels on slopes that need a pull. Every other point is searched
    /// by [`WheelOnSoil::slip_demand`], and so is one that brakes. The slips of both agree to the accuracy of the forces.
    ///
    /// ```
    /// use grouser_terra::{BatchKernel, RigidWheel, SolveStatus, catalogue};
    ///
    /// let kernel = BatchKernel::new(catalogue::find("dry-sand").expect("in the catalogue").soil()?);
    /// let slope = [3.0_f64, 6.0, 45.0].map(f64::to_radians);
    /// let (mut slip, mut status) = ([0.0; 3], [SolveStatus::default(); 3]);
    /// kernel.slip_demand(&RigidWheel::new(0.125, 0.1)?, 80.0, &slope, &mut slip, &mut status)?;
    /// assert!(0.0 < slip[0] && slip[0] < slip[1] && slip[2].is_nan());
    /// assert_eq!(status[2], SolveStatus::NoSolution); // 45° are too steep
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Lengths`] if the columns differ in length. A bad point is a status.
    pub fn slip_demand<'a>(
        &self,
        wheel: &RigidWheel,
        weight: impl Into<BatchInput<'a>>,
        slope: impl Into<BatchInput<'a>>,
        slip: &mut [f64],
        status: &mut [SolveStatus],
    ) -> Result<()> {
        let (weight, slope) = (weight.into(), slope.into());
        let n = status.len();
        Error::check_length(slip.len(), n)?;
        weight.check_length(n)?;
        slope.check_length(n)?;
        let on_soil = WheelOnSoil::new(*wheel, *self.soil(), Settings::default())?;
        let max_slip = on_soil.settings().max_slip;
        let begin = |i| Search::new(weight.at(i), slope.at(i), max_slip);
        self.searches(&on_soil, n, begin, |i, end| {
            (slip[i], status[i]) = match end {
                End::Found(found) => (found, SolveStatus::Solved),
                End::NoSolution => (f64::NAN, SolveStatus::NoSolution),
                End::Unsure => alone(&on_soil, weight.at(i), slope.at(i)),
            };
        })
    }
}

/// One point through the general search.
fn alone(on_soil: &WheelOnSoil, weight: f64, slope: f64) -> (f64, SolveStatus) {
    match on_soil.slip_demand(weight, Angle::from_rad(slope)) {
        Ok(SlopeOutcome::Holds { slip }) => (slip.value(), SolveStatus::Solved),
        Ok(SlopeOutcome::Immobilised { .. } | SlopeOutcome::Slides { .. }) => {
            (f64::NAN, SolveStatus::NoSolution)
        }
        Err(_) => (f64::NAN, SolveStatus::BadInput),
    }
}

/// The search of one point, which [`WheelOnSoil::slip_demand`] makes too.
struct Search {
    load: f64,
    required: f64,
    /// The slip to be evaluated next.
    slip: f64,
    held: HeldSearch,
    end: Option<End<f64>>,
}

impl SlipSearch for Search {
    type Found = f64;

    fn next(&self) -> (f64, f64) {
        (self.slip, self.load)
    }

    fn feed(&mut self, found: Option<Traction>) {
        self.held
            .feed(found.map(|found| found.drawbar_pull - self.required));
        match self.held.next_slip() {
            // lanes have no braking wheels
            _ if self.held.sense < 0.0 => self.end = Some(End::Unsure),
            Some(slip) => self.slip = slip,
            None => self.end = Some(self.held.held().map_or(End::NoSolution, End::Found)),
        }
    }

    fn end(&self) -> Option<End<f64>> {
        self.end
    }
}

impl Search {
    /// The search of a point on lanes; `None` for one that needs the general search.
    fn new(weight: f64, slope: f64, max_slip: f64) -> Option<Self> {
        let is_uphill = slope > 0.0 && slope < 89.9_f64.to_radians();
        let is_legal = weight > 0.0 && weight <= 1e12;
        let mut held = HeldSearch::new(max_slip, true);
        let slip = held.next_slip()?;
        (is_uphill && is_legal).then(|| Self {
            load: weight * Real::cos(slope),
            required: weight * Real::sin(slope),
            slip,
            held,
            end: None,
        })
    }
}

#[cfg(test)]
mod tests;
