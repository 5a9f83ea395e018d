//! Slip demands of many slopes.

use grouser_real::Real;

use crate::angle::Angle;
use crate::error::{Error, Result};
use crate::settings::Settings;
use crate::slip_search::{ROOT_PRECISION, RootSearch, SAMPLES};
use crate::status::SolveStatus;
use crate::traction::SlopeOutcome;
use crate::wheel::RigidWheel;
use crate::wheel_on_soil::WheelOnSoil;

use super::batch::BatchKernel;
use super::columns::BatchInput;
use super::searches::{End, SlipSearch, Traction};

impl BatchKernel {
    /// The smallest slip at which a wheel of each `weight` (N) holds each slope (rad): W cos α is carried and the drawbar pull
    /// is W sin α. Where no slip holds it, `slip` is NaN and the status [`SolveStatus::NoSolution`].
    ///
    /// On lanes are smooth wheels on slopes that need a pull, whose slip is looked for in [0, 1]. Every other point is searched
    /// by [`WheelOnSoil::slip_demand`], and so is one that lacks less than the pull may have between two samples, or whose pull
    /// falls from slip 0 on. The slips of both agree to the accuracy of the forces.
    ///
    /// ```
    /// use grouser_terra::{BatchKernel, RigidWheel, SolveStatus, catalogue};
    ///
    /// let kernel = BatchKernel::new(catalogue::find("dry-sand").expect("in the catalogue").soil()?);
    /// let slope = [4.0_f64, 8.0, 45.0].map(f64::to_radians);
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
        let begin = |i| Search::new(weight.at(i), slope.at(i));
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
        Ok(SlopeOutcome::Immobilised { .. }) => (f64::NAN, SolveStatus::NoSolution),
        Err(_) => (f64::NAN, SolveStatus::BadInput),
    }
}

/// Samples are made finer by this factor about the best one, at most so often: what is left undecided then is the general
/// search's, which takes a millisecond.
const FINER: u32 = 16;
const MAX_FINER: u32 = 3;

/// Samples of the pull, at equal steps of the slip.
struct Samples {
    /// Slip of the first one, and the step.
    from: f64,
    step: f64,
    /// How many were taken, and how many there are.
    taken: u32,
    count: u32,
    /// Slip and surplus (pull less what is required, N) of the last two, where the load was carried.
    last: [Option<(f64, f64)>; 2],
    /// Slip and surplus of the best.
    best: (f64, f64),
    /// By how much the pull changed at most between two samples beside the best one, N.
    change: f64,
    is_after_best: bool,
}

/// The search of one point, as [`WheelOnSoil::slip_demand`] makes it from slip 0 on.
struct Search {
    load: f64,
    required: f64,
    /// The slip to be evaluated next.
    slip: f64,
    samples: Samples,
    /// How often the samples were made finer about the best one.
    finer: u32,
    root: Option<RootSearch>,
    end: Option<End<f64>>,
}

impl Samples {
    const fn new(from: f64, step: f64, count: u32) -> Self {
        Self {
            from,
            step,
            taken: 0,
            count,
            last: [None; 2],
            best: (from, f64::NEG_INFINITY),
            change: 0.0,
            is_after_best: false,
        }
    }

    /// Takes the next sample.
    fn take(&mut self, slip: f64, surplus: Option<f64>) {
        self.taken += 1;
        let now = surplus.map(|surplus| (slip, surplus));
        let change = |one: Option<(f64, f64)>, two: Option<(f64, f64)>| match (one, two) {
            (Some(one), Some(two)) => (one.1 - two.1).abs(),
            _ => 0.0,
        };
        if let Some(now) = now {
            let latest = change(self.last[0], Some(now));
            if now.1 > self.best.1 {
                self.best = now;
                self.change = latest.max(change(self.last[1], self.last[0]));
                self.is_after_best = true;
            } else if self.is_after_best {
                self.change = self.change.max(latest);
                self.is_after_best = false;
            }
            self.last = [Some(now), self.last[0]];
        } else {
            self.last = [None, None];
        }
    }

    /// The slip of the next sample; `None` after the last one.
    fn next_slip(&self) -> Option<f64> {
        (self.taken < self.count)
            .then(|| (self.from + f64::from(self.taken) * self.step).clamp(0.0, 1.0))
    }

    /// May the pull reach what is required between the samples? One with a single maximum exceeds the best sample by no more
    /// than it changes beside it.
    fn may_reach(&self) -> bool {
        self.best.1 + 2.0 * self.change >= 0.0
    }

    /// Finer samples about the best one.
    fn finer(&self) -> Self {
        let from = self.best.0 - self.step;
        Self::new(from, self.step / f64::from(FINER), 2 * FINER + 1)
    }
}

impl SlipSearch for Search {
    type Found = f64;

    fn next(&self) -> (f64, f64) {
        (self.slip, self.load)
    }

    fn feed(&mut self, found: Option<Traction>) {
        let surplus = found.map(|found| found.drawbar_pull - self.required);
        if let Some(root) = &mut self.root {
            root.feed(surplus);
            self.refine();
        } else {
            self.sample(surplus);
        }
    }

    fn end(&self) -> Option<End<f64>> {
        self.end
    }
}

impl Search {
    /// The search of a point on lanes; `None` for one that needs the general search.
    fn new(weight: f64, slope: f64) -> Option<Self> {
        let is_uphill = slope > 0.0 && slope < 89.9_f64.to_radians();
        let is_legal = weight > 0.0 && weight <= 1e12;
        (is_uphill && is_legal).then(|| Self {
            load: weight * Real::cos(slope),
            required: weight * Real::sin(slope),
            slip: 0.0,
            samples: Samples::new(0.0, 1.0 / f64::from(SAMPLES), SAMPLES + 1),
            finer: 0,
            root: None,
            end: None,
        })
    }

    fn sample(&mut self, surplus: Option<f64>) {
        match (surplus, self.samples.last[0]) {
            (Some(now), Some(before)) if now >= 0.0 => {
                self.root = Some(RootSearch::new(before, (self.slip, now), ROOT_PRECISION));
                return self.refine();
            }
            // a wheel that pulls this much at slip 0 may do so braked
            (Some(now), None) if now >= 0.0 => {
                self.end = Some(End::Unsure);
                return;
            }
            _ => self.samples.take(self.slip, surplus),
        }
        match self.samples.next_slip() {
            Some(slip) => self.slip = slip,
            // a pull that falls from slip 0 on has its maximum below
            None if self.samples.best.0 == 0.0 => self.end = Some(End::Unsure),
            None if !self.samples.may_reach() => self.end = Some(End::NoSolution),
            None if self.finer < MAX_FINER => {
                self.finer += 1;
                self.samples = self.samples.finer();
                self.slip = self.samples.next_slip().unwrap_or(0.0);
            }
            None => self.end = Some(End::Unsure),
        }
    }

    fn refine(&mut self) {
        if let Some(root) = &mut self.root {
            match root.next_slip() {
                Some(slip) => self.slip = slip,
                None => self.end = Some(End::Found(root.root())),
            }
        }
    }
}

#[cfg(test)]
mod tests;
