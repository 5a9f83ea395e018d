//! Batches: many operating points on one soil, eight at a time.

use crate::error::{Error, Result};
use crate::kinematics::Kinematics;
use crate::settings::Settings;
use crate::sinkage::LoadStatus;
use crate::slip::Slip;
use crate::soil::Soil;
use crate::wheel::RigidWheel;
use crate::wheel_on_soil::WheelOnSoil;

use super::forces::ForceSheet;
use super::load::LoadSheet;
use super::machine::Level;
use super::plan::{CHUNK, Plan, Prepared};

/// Operating points side by side: one slice a quantity, all of one length.
#[derive(Clone, Copy, Debug)]
pub struct BatchPoints<'a> {
    /// Wheel radius, m.
    pub radius: &'a [f64],
    /// Wheel width, m.
    pub width: &'a [f64],
    /// Rebound ratio λ of the soil behind the wheel.
    pub rebound: &'a [f64],
    /// Slip.
    pub slip: &'a [f64],
}

/// What a batch gives for a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BatchForces {
    /// Sinkage, m.
    pub sinkage: f64,
    /// Vertical force, N.
    pub vertical_force: f64,
    /// Drawbar pull, N.
    pub drawbar_pull: f64,
    /// Torque, N m.
    pub torque: f64,
}

/// How a point of a batch ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BatchOutcome {
    /// Computed.
    Done(BatchForces),
    /// No sinkage carries the load, or the search for it ended without its result.
    NoSolution(LoadStatus),
    /// The point is no operating point.
    Bad(Error),
}

/// One soil, ready for batches.
///
/// Points that drive straight ahead with a sinkage of at most half the radius run on lanes: on AVX2 with
/// fused multiply-add or AVX-512 where the machine has it (chosen at run time, feature `std`), otherwise in
/// plain vector code. All others run one at a time through [`WheelOnSoil`], to the same accuracy. A bad
/// point never touches another: a good one gives the same bits as alone.
///
/// ```
/// use grouser_terra::{BatchKernel, BatchOutcome, BatchPoints, catalogue};
/// let kernel = BatchKernel::new(catalogue::find("dry-sand").expect("in the catalogue").soil()?);
/// let points =
///     BatchPoints { radius: &[0.1, 0.1], width: &[0.05, 0.05], rebound: &[0.0, 0.0], slip: &[0.2, 7.0] };
/// let mut out = [BatchOutcome::default(); 2];
/// kernel.forces(&points, &[0.01, 0.01], &mut out)?;
/// assert!(matches!(out[0], BatchOutcome::Done(_)));
/// assert!(matches!(out[1], BatchOutcome::Bad(_))); // slip 7
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct BatchKernel {
    soil: Soil,
    prepared: Option<Prepared>,
    level: Level,
}

/// The columns of a chunk for either question: borrowed, since a move would copy them.
pub(super) enum Sheet<'a> {
    Forces(&'a mut ForceSheet),
    Load(&'a mut LoadSheet),
    Curve(&'a mut LoadSheet),
}

/// What a chunk is worked on with.
pub(super) struct Work<'a> {
    pub(super) plan: Plan,
    pub(super) sheet: Sheet<'a>,
}

impl<'a> Work<'a> {
    const fn new(sheet: Sheet<'a>) -> Self {
        Self {
            plan: Plan::new(),
            sheet,
        }
    }
}

impl Default for BatchOutcome {
    fn default() -> Self {
        Self::NoSolution(LoadStatus::NotConverged)
    }
}

impl BatchKernel {
    /// Prepares a soil. Its own rebound ratio does not count: each point brings one.
    #[must_use]
    pub fn new(soil: Soil) -> Self {
        Self {
            soil,
            prepared: Prepared::new(&soil),
            level: Level::best(),
        }
    }

    /// The same kernel without the machine's vector instructions, to compare.
    #[must_use]
    pub fn portable(mut self) -> Self {
        self.level = Level::Portable;
        self
    }

    /// The instructions that the lanes run on: `avx512`, `avx2` or `portable`.
    #[must_use]
    pub const fn instructions(&self) -> &'static str {
        self.level.name()
    }

    /// The soil.
    #[must_use]
    pub const fn soil(&self) -> &Soil {
        &self.soil
    }

    /// Forces at given sinkages (m).
    ///
    /// # Errors
    /// [`Error::Lengths`] if the slices differ in length. A bad point is an outcome.
    pub fn forces(
        &self,
        points: &BatchPoints<'_>,
        sinkage: &[f64],
        out: &mut [BatchOutcome],
    ) -> Result<()> {
        let mut sheet = ForceSheet::EMPTY;
        let mut work = Work::new(Sheet::Forces(&mut sheet));
        self.run(points, sinkage, out, &mut work)
    }

    /// Sinkages and forces under given loads (N).
    ///
    /// # Errors
    /// As [`BatchKernel::forces`].
    pub fn under_load(
        &self,
        points: &BatchPoints<'_>,
        load: &[f64],
        out: &mut [BatchOutcome],
    ) -> Result<()> {
        let mut sheet = LoadSheet::EMPTY;
        let mut work = Work::new(Sheet::Load(&mut sheet));
        self.run(points, load, out, &mut work)
    }

    /// A slip curve: sinkages and forces of one wheel under one load (N) at many slips, on this soil with
    /// its own rebound. Points begin where their neighbours on the curve say, so that most take one
    /// evaluation; each is still looked at by itself, and as good as by [`BatchKernel::under_load`].
    ///
    /// ```
    /// use grouser_terra::{BatchKernel, BatchOutcome, RigidWheel, catalogue};
    /// let kernel = BatchKernel::new(catalogue::find("dry-sand").expect("in the catalogue").soil()?);
    /// let slip: Vec<f64> = (0..101).map(|i| 0.009 * f64::from(i)).collect();
    /// let mut out = [BatchOutcome::default(); 101];
    /// kernel.curve(&RigidWheel::new(0.125, 0.1)?, 80.0, &slip, &mut out)?;
    /// let pull = |i: usize| match out[i] {
    ///     BatchOutcome::Done(forces) => forces.drawbar_pull,
    ///     _ => f64::NAN,
    /// };
    /// assert!(pull(0) < 0.0 && pull(100) > 0.0);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Lengths`] if the slices differ in length; [`Error::OutOfRange`] for a wheel with grousers:
    /// lanes know smooth wheels only. A bad slip is an outcome.
    pub fn curve(
        &self,
        wheel: &RigidWheel,
        load: f64,
        slip: &[f64],
        out: &mut [BatchOutcome],
    ) -> Result<()> {
        if slip.len() != out.len() {
            return Err(Error::Lengths {
                expected: out.len(),
                found: slip.len(),
            });
        }
        let height = wheel.grousers().map_or(0.0, |grousers| grousers.height);
        Error::check_range("grouser_height", height, 0.0, 0.0, "m")?;
        let rebound = self.soil.params().rebound;
        let columns = [wheel.radius(), wheel.width(), rebound, load].map(|x| [x; CHUNK]);
        let mut sheet = LoadSheet::EMPTY;
        let mut work = Work::new(Sheet::Curve(&mut sheet));
        for (slip, out) in slip.chunks(CHUNK).zip(out.chunks_mut(CHUNK)) {
            let [radius, width, rebound, load] = columns.each_ref().map(|c| &c[..slip.len()]);
            let points = BatchPoints {
                radius,
                width,
                rebound,
                slip,
            };
            self.run(&points, load, out, &mut work)?;
        }
        Ok(())
    }

    fn run(
        &self,
        points: &BatchPoints<'_>,
        given: &[f64],
        out: &mut [BatchOutcome],
        work: &mut Work<'_>,
    ) -> Result<()> {
        let n = out.len();
        for len in [
            points.radius,
            points.width,
            points.rebound,
            points.slip,
            given,
        ]
        .map(<[f64]>::len)
        {
            if len != n {
                return Err(Error::Lengths {
                    expected: n,
                    found: len,
                });
            }
        }
        // chunks as equal as they can be: groups that are not full are lost work
        let chunk = n
            .div_ceil(n.div_ceil(CHUNK).max(1))
            .max(1)
            .next_multiple_of(8);
        for from in (0..n).step_by(chunk) {
            let range = from..n.min(from + chunk);
            let part = BatchPoints {
                radius: &points.radius[range.clone()],
                width: &points.width[range.clone()],
                rebound: &points.rebound[range.clone()],
                slip: &points.slip[range.clone()],
            };
            self.chunk(&part, &given[range.clone()], work, &mut out[range]);
        }
        Ok(())
    }

    fn chunk(
        &self,
        points: &BatchPoints<'_>,
        given: &[f64],
        work: &mut Work<'_>,
        out: &mut [BatchOutcome],
    ) {
        if let Some(prepared) = &self.prepared {
            self.level.run(prepared, points, given, work, out);
        }
        // What the lanes do not take, and what they gave back.
        let solve = !matches!(work.sheet, Sheet::Forces(_));
        for i in 0..out.len() {
            if self.prepared.is_none()
                || work.plan.is_single(i)
                || matches!(out[i], BatchOutcome::NoSolution(LoadStatus::NotConverged))
            {
                out[i] = self.single(points, given[i], i, solve);
            }
        }
    }

    /// One point through the general kernel.
    fn single(&self, points: &BatchPoints<'_>, given: f64, i: usize, solve: bool) -> BatchOutcome {
        let solved = || -> Result<BatchOutcome> {
            let soil = self.soil.with_rebound(points.rebound[i])?;
            let wheel = RigidWheel::new(points.radius[i], points.width[i])?;
            let pair = WheelOnSoil::new(wheel, soil, Settings::default())?;
            let motion = Kinematics::straight(Slip::new(points.slip[i])?);
            let sinkage = if solve {
                let found = pair.sinkage_under(given, &motion)?;
                match found.sinkage {
                    Some(sinkage) => sinkage,
                    None => return Ok(BatchOutcome::NoSolution(found.status)),
                }
            } else {
                given
            };
            let f = pair.forces_at(sinkage, &motion)?;
            Ok(BatchOutcome::Done(BatchForces {
                sinkage,
                vertical_force: f.vertical_force,
                drawbar_pull: f.drawbar_pull,
                torque: f.torque,
            }))
        };
        solved().unwrap_or_else(BatchOutcome::Bad)
    }
}
