//! The columns of a batch: inputs, results and the status of each point.

use core::ops::Range;

use crate::error::{Error, Result};
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
}

impl Inputs<'_> {
    pub(super) const fn len(&self) -> usize {
        self.given.len()
    }
}
