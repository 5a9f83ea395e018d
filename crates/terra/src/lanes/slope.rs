//! Slip demands of many slopes: every point brings its own search, all searches take their next slip at the same time.

use grouser_real::Real;

use crate::angle::Angle;
use crate::error::{Error, Result};
use crate::settings::Settings;
use crate::slip_search::{ROOT_PRECISION, RootSearch};
use crate::status::SolveStatus;
use crate::traction::{SAMPLES, SlopeOutcome};
use crate::wheel::RigidWheel;
use crate::wheel_on_soil::WheelOnSoil;

use super::batch::BatchKernel;
use super::columns::{BatchColumns, BatchInput, BatchPoints};

/// Searches at a time: a few full groups of lanes, on a stack that is not large.
const SEARCHES: usize = 64;

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
        let lanes = self.has_lanes() && wheel.grousers().is_none();
        let mut rounds = Rounds::new(self, &on_soil);
        let mut waiting = 0..n;
        let mut searches = [const { None }; SEARCHES];
        loop {
            for place in &mut searches {
                while place.is_none()
                    && let Some(i) = waiting.next()
                {
                    let (weight, slope) = (weight.at(i), slope.at(i));
                    *place = Search::new(i, weight, slope).filter(|_| lanes);
                    if place.is_none() {
                        (slip[i], status[i]) = alone(&on_soil, weight, slope);
                    }
                }
            }
            if !rounds.run(&mut searches)? {
                return Ok(());
            }
            for place in &mut searches {
                let Some(search) = place else { continue };
                let i = search.point;
                match search.end {
                    None => continue,
                    Some(End::Holds(found)) => (slip[i], status[i]) = (found, SolveStatus::Solved),
                    Some(End::TooSteep) => {
                        (slip[i], status[i]) = (f64::NAN, SolveStatus::NoSolution);
                    }
                    Some(End::Unsure) => {
                        (slip[i], status[i]) = alone(&on_soil, weight.at(i), slope.at(i));
                    }
                }
                *place = None;
            }
        }
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

/// The columns of one round: a slip and a load for each search.
struct Rounds<'a> {
    kernel: &'a BatchKernel,
    on_soil: &'a WheelOnSoil,
    slip: [f64; SEARCHES],
    load: [f64; SEARCHES],
    out: [[f64; SEARCHES]; 4],
    status: [SolveStatus; SEARCHES],
}

impl<'a> Rounds<'a> {
    const fn new(kernel: &'a BatchKernel, on_soil: &'a WheelOnSoil) -> Self {
        Self {
            kernel,
            on_soil,
            slip: [0.0; SEARCHES],
            load: [0.0; SEARCHES],
            out: [[0.0; SEARCHES]; 4],
            status: [SolveStatus::NotConverged; SEARCHES],
        }
    }

    /// Evaluates the next slip of every search; false where there is none.
    fn run(&mut self, searches: &mut [Option<Search>; SEARCHES]) -> Result<bool> {
        let mut count = 0;
        for search in searches.iter().flatten() {
            (self.slip[count], self.load[count]) = (search.slip, search.load);
            count += 1;
        }
        if count == 0 {
            return Ok(false);
        }
        let wheel = self.on_soil.wheel();
        let points = BatchPoints {
            radius: wheel.radius().into(),
            width: wheel.width().into(),
            rebound: self.kernel.soil().params().rebound.into(),
            slip: (&self.slip[..count]).into(),
        };
        let [sinkage, vertical_force, drawbar_pull, torque] = &mut self.out;
        let mut columns = BatchColumns {
            sinkage: &mut sinkage[..count],
            vertical_force: &mut vertical_force[..count],
            drawbar_pull: &mut drawbar_pull[..count],
            torque: &mut torque[..count],
            status: &mut self.status[..count],
        };
        self.kernel
            .under_load(&points, &self.load[..count], &mut columns)?;
        for (k, search) in searches.iter_mut().flatten().enumerate() {
            match self.status[k] {
                SolveStatus::Solved => search.feed(Some(self.out[2][k])),
                SolveStatus::NoSolution => search.feed(None),
                _ => search.end = Some(End::Unsure),
            }
        }
        Ok(true)
    }
}

/// Samples are made finer by this factor about the best one, at most so often: what is left undecided then is the general
/// search's, which takes a millisecond.
const FINER: u32 = 16;
const MAX_FINER: u32 = 3;

/// How a search ended.
#[derive(Clone, Copy)]
enum End {
    Holds(f64),
    TooSteep,
    /// The general search decides.
    Unsure,
}

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
    point: usize,
    load: f64,
    required: f64,
    /// The slip to be evaluated next.
    slip: f64,
    samples: Samples,
    /// How often the samples were made finer about the best one.
    finer: u32,
    root: Option<RootSearch>,
    end: Option<End>,
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

impl Search {
    /// The search of a point on lanes; `None` for one that needs the general search.
    fn new(point: usize, weight: f64, slope: f64) -> Option<Self> {
        let is_uphill = slope > 0.0 && slope < 89.9_f64.to_radians();
        let is_legal = weight > 0.0 && weight <= 1e12;
        (is_uphill && is_legal).then(|| Self {
            point,
            load: weight * Real::cos(slope),
            required: weight * Real::sin(slope),
            slip: 0.0,
            samples: Samples::new(0.0, 1.0 / f64::from(SAMPLES), SAMPLES + 1),
            finer: 0,
            root: None,
            end: None,
        })
    }

    /// Takes the pull at the slip that was evaluated, N; `None` where the load is not carried.
    fn feed(&mut self, pull: Option<f64>) {
        let surplus = pull.map(|pull| pull - self.required);
        if let Some(root) = &mut self.root {
            root.feed(surplus);
            self.refine();
        } else {
            self.sample(surplus);
        }
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
            None if !self.samples.may_reach() => self.end = Some(End::TooSteep),
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
                None => self.end = Some(End::Holds(root.root())),
            }
        }
    }
}
