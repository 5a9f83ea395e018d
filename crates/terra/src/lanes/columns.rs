//! The columns of a batch: inputs, results and the status of each point.

use core::ops::Range;

use crate::angle::Angle;
use crate::contact::ladder::ExponentTables;
use crate::error::{Error, Result};
use crate::pressure::{Bekker, Pressure, Reece};
use crate::soil::{Soil, SoilParams};
use crate::status::SolveStatus;

/// One quantity of all points of a batch: the same number for all, or one for each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BatchInput<'a> {
    /// The same for every point.
    Constant(f64),
    /// One number for each point.
    Column(&'a [f64]),
}

impl BatchInput<'_> {
    /// The number of a point.
    pub(super) fn at(&self, i: usize) -> f64 {
        match self {
            Self::Constant(x) => *x,
            Self::Column(column) => column[i],
        }
    }

    /// Is it good for `n` points?
    pub(super) fn check_length(&self, n: usize) -> Result<()> {
        match self {
            Self::Constant(_) => Ok(()),
            Self::Column(column) => Error::check_length(column.len(), n),
        }
    }
}

impl From<f64> for BatchInput<'_> {
    fn from(x: f64) -> Self {
        Self::Constant(x)
    }
}

impl<'a, T: AsRef<[f64]> + ?Sized> From<&'a T> for BatchInput<'a> {
    fn from(column: &'a T) -> Self {
        Self::Column(column.as_ref())
    }
}

/// Operating points side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BatchPoints<'a> {
    /// Wheel radius, m.
    pub radius: BatchInput<'a>,
    /// Wheel width, m.
    pub width: BatchInput<'a>,
    /// Rebound ratio λ of the soil behind the wheel.
    pub rebound: BatchInput<'a>,
    /// Slip.
    pub slip: BatchInput<'a>,
}

/// Numbers of the soil under each point: draws of a soil that is known within bounds, say. All other numbers and the laws are
/// those of the kernel's soil.
///
/// ```
/// use grouser_terra::{
///     BatchColumns, BatchKernel, BatchPoints, SoilColumns, SolveStatus, catalogue,
/// };
/// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let kernel = BatchKernel::new(sand);
/// let phi = [29.0_f64, 30.0, 95.0].map(f64::to_radians);
/// let soils = SoilColumns {
///     n: (&[1.0, 1.1, 1.2]).into(),
///     phi: (&phi).into(),
///     ..SoilColumns::from_soil(&sand)
/// };
/// let points = BatchPoints {
///     radius: 0.125.into(),
///     width: 0.1.into(),
///     rebound: 0.0.into(),
///     slip: 0.2.into(),
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
/// kernel.under_load_on(&soils, &points, 80.0, &mut columns)?;
/// assert!(sinkage[0] < sinkage[1]); // a greater exponent is softer near the surface
/// assert_eq!(status[2], SolveStatus::BadInput); // φ = 95°
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoilColumns<'a> {
    /// k_c of Bekker's law, N/m^(n+1); k_c′ where the kernel's soil has Reece's.
    pub k_c: BatchInput<'a>,
    /// k_phi of Bekker's law, N/m^(n+2); k_phi′ where the kernel's soil has Reece's.
    pub k_phi: BatchInput<'a>,
    /// Sinkage exponent. Points that share one take half the time.
    pub n: BatchInput<'a>,
    /// Cohesion, Pa.
    pub cohesion: BatchInput<'a>,
    /// Angle of internal friction, rad.
    pub phi: BatchInput<'a>,
    /// Shear deformation modulus, m.
    pub k_shear: BatchInput<'a>,
    /// Maximum stress at θ_m = (c_1 + c_2 s) θ_1.
    pub c_1: BatchInput<'a>,
    /// Maximum stress at θ_m = (c_1 + c_2 s) θ_1.
    pub c_2: BatchInput<'a>,
}

/// How many numbers of a soil are columns.
pub(super) const SOIL_NUMBERS: usize = 8;

impl<'a> SoilColumns<'a> {
    /// One soil for all points.
    #[must_use]
    pub fn from_soil(soil: &Soil) -> Self {
        let params = soil.params();
        let (k_c, k_phi) = match params.pressure {
            Pressure::Bekker(law) => (law.k_c, law.k_phi),
            Pressure::Reece(law) => (law.k_c_prime, law.k_phi_prime),
        };
        Self {
            k_c: k_c.into(),
            k_phi: k_phi.into(),
            n: params.n.into(),
            cohesion: params.cohesion.into(),
            phi: params.phi.rad().into(),
            k_shear: params.k_shear.into(),
            c_1: params.c_1.into(),
            c_2: params.c_2.into(),
        }
    }

    /// All columns, in the order of [`SoilInputs`].
    pub(super) const fn all(&self) -> [BatchInput<'a>; SOIL_NUMBERS] {
        [
            self.k_c,
            self.k_phi,
            self.n,
            self.cohesion,
            self.phi,
            self.k_shear,
            self.c_1,
            self.c_2,
        ]
    }

    /// What a soil becomes at a point.
    pub(super) fn params(&self, soil: &Soil, i: usize) -> SoilParams {
        put(soil.params(), self.all().map(|input| input.at(i)))
    }
}

/// The parameters of a soil with other numbers, in the order of [`SoilInputs`].
pub(super) fn put(soil: &SoilParams, numbers: [f64; SOIL_NUMBERS]) -> SoilParams {
    let [k_c, k_phi, n, cohesion, phi, k_shear, c_1, c_2] = numbers;
    SoilParams {
        pressure: match soil.pressure {
            Pressure::Bekker(_) => Pressure::Bekker(Bekker { k_c, k_phi }),
            Pressure::Reece(_) => Pressure::Reece(Reece {
                k_c_prime: k_c,
                k_phi_prime: k_phi,
            }),
        },
        n,
        cohesion,
        phi: Angle::from_rad(phi),
        k_shear,
        c_1,
        c_2,
        ..*soil
    }
}

/// Where a batch writes: one slice a quantity, all of one length. Where the status of a point is not
/// [`SolveStatus::Solved`] its numbers are NaN.
#[derive(Debug)]
pub struct BatchColumns<'a> {
    /// Sinkage, m.
    pub sinkage: &'a mut [f64],
    /// Vertical force, N.
    pub vertical_force: &'a mut [f64],
    /// Drawbar pull, N.
    pub drawbar_pull: &'a mut [f64],
    /// Torque, N m.
    pub torque: &'a mut [f64],
    /// How each point ended.
    pub status: &'a mut [SolveStatus],
}

impl BatchColumns<'_> {
    /// The length of all columns.
    pub(super) fn check_lengths(&self) -> Result<usize> {
        let n = self.status.len();
        for column in [
            &self.sinkage,
            &self.vertical_force,
            &self.drawbar_pull,
            &self.torque,
        ] {
            Error::check_length(column.len(), n)?;
        }
        Ok(n)
    }

    /// The points of a range.
    pub(super) fn part(&mut self, range: Range<usize>) -> BatchColumns<'_> {
        BatchColumns {
            sinkage: &mut self.sinkage[range.clone()],
            vertical_force: &mut self.vertical_force[range.clone()],
            drawbar_pull: &mut self.drawbar_pull[range.clone()],
            torque: &mut self.torque[range.clone()],
            status: &mut self.status[range],
        }
    }

    /// Writes one point: sinkage, vertical force, drawbar pull and torque.
    #[inline(always)]
    pub(super) fn set(&mut self, i: usize, status: SolveStatus, numbers: [f64; 4]) {
        [
            self.sinkage[i],
            self.vertical_force[i],
            self.drawbar_pull[i],
            self.torque[i],
        ] = numbers;
        self.status[i] = status;
    }
}

/// The inputs of a chunk: one slice a quantity, all of one length.
#[derive(Clone, Copy)]
pub(super) struct Inputs<'a> {
    pub(super) radius: &'a [f64],
    pub(super) width: &'a [f64],
    pub(super) rebound: &'a [f64],
    pub(super) slip: &'a [f64],
    /// Sinkage or load.
    pub(super) given: &'a [f64],
    /// The soils of the points, unless they are the kernel's.
    pub(super) soil: Option<SoilInputs<'a>>,
}

/// Numbers of the soils of a chunk.
#[derive(Clone, Copy)]
pub(super) struct SoilInputs<'a> {
    /// k_c, k_phi, n, cohesion, phi, k_shear, c_1 and c_2.
    pub(super) numbers: [&'a [f64]; SOIL_NUMBERS],
    /// The tables of the exponent where all points share it.
    pub(super) tables: Option<&'a ExponentTables>,
}

impl Inputs<'_> {
    pub(super) const fn len(&self) -> usize {
        self.given.len()
    }
}
