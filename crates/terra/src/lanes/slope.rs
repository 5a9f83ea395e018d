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
use super::plan::CHUNK;

impl BatchKernel {
    /// The smallest slip at which a wheel of each `weight` (N) holds each slope (rad): W cos α is carried and the drawbar pull
    /// is W sin α. Where no slip holds it, `slip` is NaN and the status [`SolveStatus::NoSolution`].
    ///
    /// On lanes are smooth wheels on slopes that need a pull, whose slip is looked for in [0, 1]; every other point, and one
    /// that lacks less than the pull may have between two samples, is searched by [`WheelOnSoil::slip_demand`]. The slips of
    /// both agree to the accuracy of the forces.
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
        let mut searches = [const { None }; CHUNK];
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
                        (slip[i], status[i]) = (f64::NAN, SolveStatus::NoSolution)
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
    slip: [f64; CHUNK],
    load: [f64; CHUNK],
    out: [[f64; CHUNK]; 4],
    status: [SolveStatus; CHUNK],
}

impl<'a> Rounds<'a> {
    const fn new(kernel: &'a BatchKernel, on_soil: &'a WheelOnSoil) -> Self {
        Self {
            kernel,
            on_soil,
            slip: [0.0; CHUNK],
            load: [0.0; CHUNK],
            out: [[0.0; CHUNK]; 4],
            status: [SolveStatus::NotConverged; CHUNK],
        }
    }

    /// Evaluates the next slip of every search; false where there is none.
    fn run(&mut self, searches: &mut [Option<Search>; CHUNK]) -> Result<bool> {
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

/// How a search ended.
#[derive(Clone, Copy)]
enum End {
    Holds(f64),
    TooSteep,
    /// The general search decides.
    Unsure,
}

/// The search of one point, as [`WheelOnSoil::slip_demand`] makes it from slip 0 on.
struct Search {
    point: usize,
    load: f64,
    required: f64,
    /// The slip to be evaluated next.
    slip: f64,
    /// Samples so far, and the last two and the best of them: pull less what is required, N.
    samples: u32,
    last: [Option<f64>; 2],
    best: f64,
    /// By how much the pull changed at most between two samples beside the best one, N.
    change: f64,
    is_after_best: bool,
    root: Option<RootSearch>,
    end: Option<End>,
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
            samples: 0,
            last: [None; 2],
            best: f64::NEG_INFINITY,
            change: 0.0,
            is_after_best: false,
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
        let step = 1.0 / f64::from(SAMPLES);
        match surplus {
            Some(now) if now >= 0.0 => {
                // from slip 0 on: a braked wheel that pulls this much is the general search's
                let Some(before) = self.last[0] else {
                    self.end = Some(End::Unsure);
                    return;
                };
                let low = f64::from(self.samples - 1) * step;
                let root = RootSearch::new((low, before), (self.slip, now), ROOT_PRECISION);
                self.root = Some(root);
                self.refine();
                return;
            }
            Some(now) => {
                let change = self.last[0].map_or(0.0, |before| (now - before).abs());
                if now > self.best {
                    let earlier = match self.last {
                        [Some(one), Some(two)] => (one - two).abs(),
                        _ => 0.0,
                    };
                    (self.best, self.change) = (now, change.max(earlier));
                    self.is_after_best = true;
                } else if self.is_after_best {
                    self.change = self.change.max(change);
                    self.is_after_best = false;
                }
                self.last = [surplus, self.last[0]];
            }
            None => self.last = [None, None],
        }
        self.samples += 1;
        self.slip = f64::from(self.samples) * step;
        if self.samples > SAMPLES {
            // between samples a pull with one maximum exceeds the best by no more than it changes beside it
            let is_near = self.best + 2.0 * self.change >= 0.0;
            self.end = Some(if is_near { End::Unsure } else { End::TooSteep });
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
