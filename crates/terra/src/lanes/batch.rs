//! Batches: many operating points on one soil, eight at a time.

use core::ops::Range;

use crate::caution::{Cautions, Judged};
use crate::contact::ladder::ExponentTables;
use crate::error::{Error, Result};
use crate::kinematics::Kinematics;
use crate::settings::Settings;
use crate::sinkage::LoadOutcome;
use crate::slip::Slip;
use crate::soil::{EXPONENT, Soil, SoilParams};
use crate::status::SolveStatus;
use crate::wheel::RigidWheel;
use crate::wheel_on_soil::WheelOnSoil;

use super::columns::{
    BatchColumns, BatchInput, BatchPoints, Inputs, SOIL_NUMBERS, SoilColumns, SoilInputs, put,
};
use super::forces::ForceSheet;
use super::load::LoadSheet;
use super::machine::Level;
use super::plan::{CHUNK, Chunk, Plan, Prepared};

/// One soil, ready for batches.
///
/// Points that drive straight ahead with a sinkage of at most half the radius run on lanes: on AVX2 with
/// fused multiply-add or AVX-512 where the machine has it (chosen at run time, feature `std`), otherwise in
/// plain vector code; all have the same bits with the feature `deterministic`. All others run one at a time through [`WheelOnSoil`], to the same accuracy. A bad
/// point never changes another: a good one gets the same bits as alone.
///
/// ```
/// use grouser_terra::{BatchColumns, BatchKernel, BatchPoints, SolveStatus, catalogue};
/// let kernel = BatchKernel::new(catalogue::find("dry-sand").expect("in the catalogue").soil()?);
/// // one wheel at two slips and two sinkages
/// let points = BatchPoints {
///     radius: 0.1.into(),
///     width: 0.05.into(),
///     rebound: 0.0.into(),
///     slip: (&[0.2, 7.0]).into(),
/// };
/// let [mut sinkage, mut vertical_force, mut drawbar_pull, mut torque] = [[0.0; 2]; 4];
/// let mut status = [SolveStatus::default(); 2];
/// let mut columns = BatchColumns {
///     sinkage: &mut sinkage,
///     vertical_force: &mut vertical_force,
///     drawbar_pull: &mut drawbar_pull,
///     torque: &mut torque,
///     status: &mut status,
/// };
/// kernel.forces(&points, 0.01, &mut columns)?;
/// assert_eq!(status, [SolveStatus::Solved, SolveStatus::BadInput]); // slip 7
/// assert!(vertical_force[0] > 0.0 && vertical_force[1].is_nan());
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct BatchKernel {
    soil: Soil,
    prepared: Option<Prepared>,
    level: Level,
}

/// What a batch computes.
#[derive(Clone, Copy)]
enum Task {
    Forces,
    Load,
}

/// Room for a chunk in work. It is not cleared between calls.
struct Workspace {
    /// Numbers that all points share, as columns.
    constants: [[f64; CHUNK]; 5],
    /// And numbers of their soils.
    soils: [[f64; CHUNK]; SOIL_NUMBERS],
    plan: Plan,
    forces: ForceSheet,
    load: LoadSheet,
}

impl Workspace {
    const EMPTY: Self = Self {
        constants: [[0.0; CHUNK]; 5],
        soils: [[0.0; CHUNK]; SOIL_NUMBERS],
        plan: Plan::EMPTY,
        forces: ForceSheet::EMPTY,
        load: LoadSheet::EMPTY,
    };

    /// Calls `work` with the workspace of this thread.
    #[cfg(feature = "std")]
    fn with<T>(work: impl FnOnce(&mut Self) -> T) -> T {
        std::thread_local! {
            static KEPT: core::cell::RefCell<Workspace> =
                const { core::cell::RefCell::new(Workspace::EMPTY) };
        }
        KEPT.with_borrow_mut(work)
    }

    #[cfg(not(feature = "std"))]
    fn with<T>(work: impl FnOnce(&mut Self) -> T) -> T {
        let mut room = Self::EMPTY;
        work(&mut room)
    }
}

/// The instructions that this machine's lanes run on: `avx512`, `avx2` or `portable`. The last digits of forces may
/// differ between them. `deterministic` with that feature, where they do not.
///
/// ```
/// let names = ["avx512", "avx2", "portable", "deterministic"];
/// assert!(names.contains(&grouser_terra::instructions()));
/// ```
#[must_use]
pub fn instructions() -> &'static str {
    if grouser_real::DETERMINISTIC {
        return "deterministic";
    }
    Level::best().name()
}

impl BatchKernel {
    /// Prepares a soil. Its own rebound ratio has no effect: each point brings one.
    #[must_use]
    pub fn new(soil: Soil) -> Self {
        Self {
            soil,
            prepared: Prepared::new(&soil),
            level: Level::best(),
        }
    }

    /// The same kernel without the machine's vector instructions, for comparison.
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

    /// Does any point of this soil run on lanes?
    pub(super) const fn has_lanes(&self) -> bool {
        self.prepared.is_some()
    }

    /// The soil.
    #[must_use]
    pub const fn soil(&self) -> &Soil {
        &self.soil
    }

    /// Forces at given sinkages (m).
    ///
    /// # Errors
    /// [`Error::Lengths`] if the columns differ in length. A bad point is a status.
    pub fn forces<'a>(
        &self,
        points: &BatchPoints<'a>,
        sinkage: impl Into<BatchInput<'a>>,
        out: &mut BatchColumns<'_>,
    ) -> Result<()> {
        let inputs = (points, None, sinkage.into());
        Workspace::with(|room| self.run(inputs, out, (Task::Forces, room)))
    }

    /// Sinkages and forces under given loads (N).
    ///
    /// # Errors
    /// As [`BatchKernel::forces`].
    ///
    /// ```
    /// use grouser_terra::{BatchColumns, BatchKernel, BatchPoints, SolveStatus, catalogue};
    ///
    /// let kernel = BatchKernel::new(catalogue::find("dry-sand").expect("in the catalogue").soil()?);
    /// let points = BatchPoints {
    ///     radius: 0.125.into(), // one number for all points
    ///     width: 0.1.into(),
    ///     rebound: 0.0.into(),
    ///     slip: (&[0.1, 0.2, 0.3]).into(), // one for each
    /// };
    /// let [mut sinkage, mut vertical_force, mut drawbar_pull, mut torque] = [[0.0; 3]; 4];
    /// let mut status = [SolveStatus::default(); 3];
    /// let mut columns = BatchColumns {
    ///     sinkage: &mut sinkage,
    ///     vertical_force: &mut vertical_force,
    ///     drawbar_pull: &mut drawbar_pull,
    ///     torque: &mut torque,
    ///     status: &mut status,
    /// };
    /// kernel.under_load(&points, 80.0, &mut columns)?;
    /// assert_eq!(status, [SolveStatus::Solved; 3]);
    /// assert!(drawbar_pull[0] < drawbar_pull[2]);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    pub fn under_load<'a>(
        &self,
        points: &BatchPoints<'a>,
        load: impl Into<BatchInput<'a>>,
        out: &mut BatchColumns<'_>,
    ) -> Result<()> {
        let inputs = (points, None, load.into());
        Workspace::with(|room| self.run(inputs, out, (Task::Load, room)))
    }

    /// [`BatchKernel::forces`] with a soil for each point.
    ///
    /// # Errors
    /// As [`BatchKernel::forces`].
    pub fn forces_on<'a>(
        &self,
        soils: &SoilColumns<'a>,
        points: &BatchPoints<'a>,
        sinkage: impl Into<BatchInput<'a>>,
        out: &mut BatchColumns<'_>,
    ) -> Result<()> {
        let inputs = (points, Some(soils), sinkage.into());
        Workspace::with(|room| self.run(inputs, out, (Task::Forces, room)))
    }

    /// [`BatchKernel::under_load`] with a soil for each point: [`SoilColumns`] has an example.
    ///
    /// # Errors
    /// As [`BatchKernel::forces`].
    pub fn under_load_on<'a>(
        &self,
        soils: &SoilColumns<'a>,
        points: &BatchPoints<'a>,
        load: impl Into<BatchInput<'a>>,
        out: &mut BatchColumns<'_>,
    ) -> Result<()> {
        let inputs = (points, Some(soils), load.into());
        Workspace::with(|room| self.run(inputs, out, (Task::Load, room)))
    }

    /// A slip curve: sinkages and forces of one wheel under one load (N) at many slips, on this soil with
    /// its own rebound.
    ///
    /// [`BatchKernel::under_load`] with one size and one load.
    ///
    /// ```
    /// use grouser_terra::{BatchColumns, BatchKernel, SolveStatus, RigidWheel, catalogue};
    /// let kernel = BatchKernel::new(catalogue::find("dry-sand").expect("in the catalogue").soil()?);
    /// let slip: Vec<f64> = (0..101).map(|i| 0.009 * f64::from(i)).collect();
    /// let [mut sinkage, mut vertical_force, mut drawbar_pull, mut torque] = [[0.0; 101]; 4];
    /// let mut status = [SolveStatus::default(); 101];
    /// let mut columns = BatchColumns {
    ///     sinkage: &mut sinkage,
    ///     vertical_force: &mut vertical_force,
    ///     drawbar_pull: &mut drawbar_pull,
    ///     torque: &mut torque,
    ///     status: &mut status,
    /// };
    /// kernel.curve(&RigidWheel::new(0.125, 0.1)?, 80.0, &slip, &mut columns)?;
    /// assert!(drawbar_pull[0] < 0.0 && drawbar_pull[100] > 0.0);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Lengths`] if the columns differ in length; [`Error::OutOfRange`] for a wheel with grousers:
    /// lanes have the laws of smooth wheels only. A bad slip is a status.
    pub fn curve(
        &self,
        wheel: &RigidWheel,
        load: f64,
        slip: &[f64],
        out: &mut BatchColumns<'_>,
    ) -> Result<()> {
        let height = wheel.grousers().map_or(0.0, |grousers| grousers.height);
        Error::check_range("grouser_height", height, 0.0, 0.0, "m")?;
        let points = BatchPoints {
            radius: wheel.radius().into(),
            width: wheel.width().into(),
            rebound: self.soil.params().rebound.into(),
            slip: slip.into(),
        };
        self.under_load(&points, load, out)
    }

    /// What to keep in mind about the solved point at a place of columns, from its numbers alone, as
    /// [`WheelOnSoil::at_sinkage`] has it; nothing of a point that is not solved. Whether several sinkages carry a load is said
    /// by [`WheelOnSoil::under_load`] only: on soil that rises behind the wheel or that a rim carries along, and for s < 0.
    ///
    /// ```
    /// use grouser_terra::{BatchColumns, BatchKernel, BatchPoints, Caution, SolveStatus, catalogue};
    /// let kernel = BatchKernel::new(catalogue::find("dry-sand").expect("in the catalogue").soil()?);
    /// let points = BatchPoints {
    ///     radius: 0.1.into(),
    ///     width: 0.05.into(),
    ///     rebound: 0.0.into(),
    ///     slip: 0.9.into(),
    /// };
    /// let [mut sinkage, mut vertical_force, mut drawbar_pull, mut torque] = [[0.0]; 4];
    /// let mut columns = BatchColumns {
    ///     sinkage: &mut sinkage,
    ///     vertical_force: &mut vertical_force,
    ///     drawbar_pull: &mut drawbar_pull,
    ///     torque: &mut torque,
    ///     status: &mut [SolveStatus::default()],
    /// };
    /// kernel.under_load(&points, 200.0, &mut columns)?;
    /// assert!(kernel.cautions(&points, &columns, 0).contains(Caution::DeepSinkage)); // 67 mm
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    #[must_use]
    pub fn cautions(
        &self,
        points: &BatchPoints<'_>,
        found: &BatchColumns<'_>,
        at: usize,
    ) -> Cautions {
        cautions_of(self.soil.params(), points, (found, at))
    }

    /// [`BatchKernel::cautions`] with a soil for each point.
    #[must_use]
    pub fn cautions_on(
        &self,
        soils: &SoilColumns<'_>,
        points: &BatchPoints<'_>,
        found: &BatchColumns<'_>,
        at: usize,
    ) -> Cautions {
        cautions_of(&soils.params(&self.soil, at), points, (found, at))
    }

    fn run(
        &self,
        (points, soils, given): (&BatchPoints<'_>, Option<&SoilColumns<'_>>, BatchInput<'_>),
        out: &mut BatchColumns<'_>,
        (task, room): (Task, &mut Workspace),
    ) -> Result<()> {
        let n = out.check_lengths()?;
        let soil_inputs = soils.map_or([BatchInput::Constant(0.0); SOIL_NUMBERS], SoilColumns::all);
        let tables = soils.and_then(|soils| shared_tables(soils.n));
        let inputs = [
            points.radius,
            points.width,
            points.rebound,
            points.slip,
            given,
        ];
        let Workspace {
            constants,
            soils: of_soils,
            plan,
            forces,
            load,
        } = room;
        let all = inputs.iter().zip(&mut *constants);
        for (input, constant) in all.chain(soil_inputs.iter().zip(&mut *of_soils)) {
            match *input {
                BatchInput::Constant(x) => constant[..n.min(CHUNK)].fill(x),
                BatchInput::Column(column) => Error::check_length(column.len(), n)?,
            }
        }
        let chunk = chunk_length(n);
        for from in (0..n).step_by(chunk) {
            let range = from..n.min(from + chunk);
            let [radius, width, rebound, slip, given] =
                core::array::from_fn(|k| part(inputs[k], &constants[k], range.clone()));
            let inputs = Inputs {
                radius,
                width,
                rebound,
                slip,
                given,
                soil: soils.map(|_| SoilInputs {
                    numbers: core::array::from_fn(|k| {
                        part(soil_inputs[k], &of_soils[k], range.clone())
                    }),
                    tables: tables.as_ref(),
                }),
            };
            self.chunk(inputs, task, (plan, forces, load), out.part(range));
        }
        Ok(())
    }

    fn chunk(
        &self,
        inputs: Inputs<'_>,
        task: Task,
        (plan, forces, load): (&mut Plan, &mut ForceSheet, &mut LoadSheet),
        mut out: BatchColumns<'_>,
    ) {
        if let Some(prepared) = &self.prepared {
            let mut chunk = Chunk {
                prepared,
                inputs,
                plan: &mut *plan,
                out: out.part(0..inputs.len()),
            };
            match task {
                Task::Forces => self.level.forces(&mut chunk, forces),
                Task::Load => self.level.load(&mut chunk, load),
            }
        }
        // What the lanes do not serve, and what they gave back.
        let solve = !matches!(task, Task::Forces);
        let mut contact = None;
        for i in 0..inputs.len() {
            if self.prepared.is_none()
                || plan.is_single(i)
                || out.status[i] == SolveStatus::NotConverged
            {
                let solved = self.single(&mut contact, &inputs, (i, solve));
                let (status, numbers) = solved.unwrap_or((SolveStatus::BadInput, [f64::NAN; 4]));
                out.set(i, status, numbers);
            }
        }
    }

    /// One point through the general kernel, with the contact of the last such point: its status, sinkage, vertical
    /// force, drawbar pull and torque.
    fn single(
        &self,
        contact: &mut Option<WheelOnSoil>,
        inputs: &Inputs<'_>,
        (i, solve): (usize, bool),
    ) -> Result<(SolveStatus, [f64; 4])> {
        let rebound = inputs.rebound[i];
        let wheel = RigidWheel::new(inputs.radius[i], inputs.width[i])?;
        let new =
            |soil: Soil| WheelOnSoil::new(wheel, soil.with_rebound(rebound)?, Settings::default());
        let contact = match (contact, &inputs.soil) {
            (contact, Some(soils)) => {
                let params = put(self.soil.params(), soils.numbers.map(|of| of[i]));
                contact.insert(new(Soil::new(params)?)?)
            }
            (Some(contact), None) if contact.soil().params().rebound == rebound => {
                contact.set_wheel(wheel)?;
                contact
            }
            (contact, None) => contact.insert(new(self.soil)?),
        };
        let motion = Kinematics::straight(Slip::new(inputs.slip[i])?);
        let sinkage = if solve {
            match contact.sinkage_under(inputs.given[i], &motion)?.outcome {
                LoadOutcome::Solved(found) => found.sinkage,
                outcome @ (LoadOutcome::NoSolution { .. } | LoadOutcome::NotConverged) => {
                    return Ok((outcome.status(), [f64::NAN; 4]));
                }
            }
        } else {
            inputs.given[i]
        };
        let f = contact.forces_at(sinkage, &motion)?;
        let numbers = [sinkage, f.vertical_force, f.drawbar_pull, f.torque];
        Ok((SolveStatus::Solved, numbers))
    }
}

/// The tables of the exponent that all points share, if it is legal: else each point by itself says so.
fn shared_tables(n: BatchInput<'_>) -> Option<ExponentTables> {
    match n {
        BatchInput::Constant(n) => (EXPONENT.0..=EXPONENT.1)
            .contains(&n)
            .then(|| ExponentTables::with_exponent(n)),
        BatchInput::Column(_) => None,
    }
}

/// How many of `n` points are worked on together.
fn chunk_length(n: usize) -> usize {
    // as equal as they can be: groups that are not full are lost work
    n.div_ceil(n.div_ceil(CHUNK).max(1))
        .max(1)
        .next_multiple_of(8)
}

/// Cautions at a place of columns on a soil.
fn cautions_of(
    soil: &SoilParams,
    points: &BatchPoints<'_>,
    (found, at): (&BatchColumns<'_>, usize),
) -> Cautions {
    let mut out = Cautions::default();
    if found.status[at] != SolveStatus::Solved {
        return out;
    }
    let Ok(slip) = Slip::new(points.slip.at(at)) else {
        return out;
    };
    let motion = Kinematics::straight(slip);
    let (s, radius, width) = (slip.value(), points.radius.at(at), points.width.at(at));
    let (sinkage, vertical_force) = (found.sinkage[at], found.vertical_force[at]);
    let (pull, torque) = (found.drawbar_pull[at] * radius, found.torque[at]);
    let rebound = points.rebound.at(at);
    // a driving wheel shears forwards, and compacts what does not spring back
    let is_driving = slip.is_driving();
    let lost_work = if is_driving && rebound == 0.0 {
        0.0
    } else {
        torque * (1.0 + s.min(0.0)) - pull * (1.0 - s.max(0.0))
    };
    let fitted = soil.fitted;
    out.judge(&Judged {
        position: soil.laws().position_at(&motion.motion::<f64>()),
        sinkage,
        radius,
        reverses: !is_driving && reverses((soil, radius, width, rebound), sinkage, &motion),
        outside_fit: fitted.is_some_and(|f| !f.holds(&motion, width, vertical_force)),
        lost_work: (lost_work, torque.abs().max(pull.abs())),
    });
    out
}

/// The numbers of a range of points, from the column of the number that all share.
fn part<'a>(input: BatchInput<'a>, constant: &'a [f64; CHUNK], range: Range<usize>) -> &'a [f64] {
    match input {
        BatchInput::Constant(_) => &constant[..range.len()],
        BatchInput::Column(column) => &column[range],
    }
}

/// Does the shear under a wheel of this radius and width, m, and this rebound change its sign?
fn reverses(
    (soil, radius, width, rebound): (&SoilParams, f64, f64, f64),
    sinkage: f64,
    motion: &Kinematics,
) -> bool {
    let contact = || -> Result<_> {
        let wheel = RigidWheel::new(radius, width)?;
        let soil = Soil::new(SoilParams { rebound, ..*soil })?;
        let contact = WheelOnSoil::new(wheel, soil, Settings::default())?;
        Ok(contact.contact(contact.entry_angle(sinkage, motion)?, motion))
    };
    contact().is_ok_and(|contact| {
        let angles = contact.angles();
        contact.shear.reverses(angles.theta_1 - angles.theta_2)
    })
}

#[cfg(test)]
mod tests;
