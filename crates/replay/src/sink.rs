//! The output of a run, row by row.

use std::io;

use grouser_slip::detect::Change;
use grouser_slip::onboard::SoilEstimate;
use grouser_slip::{Health, Motion, WheelEstimate};

use crate::odometry::Odometry;

/// One wheel at one time, as a row of the output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<'a> {
    /// Seconds since the log's start.
    pub time_s: f64,
    /// Seconds since its last row; of a gap of the log half a second.
    pub lasts_s: f64,
    /// The wheel's index in the robot's order.
    pub wheel: usize,
    /// The wheel's name.
    pub name: &'a str,
    /// Its slip, where it has one.
    pub slip: Option<f64>,
    /// Standard deviation of its error.
    pub slip_sigma: Option<f64>,
    /// How it moves, where that is known.
    pub motion: Option<Motion>,
    /// How far this can be trusted.
    pub health: Health,
    /// From its heading to the way of its centre, to the left positive, rad, where it moves.
    pub side_slip_angle: Option<f64>,
}

/// The whole robot at one time: when some wheel was read.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// When, ns on the log's clock.
    pub time_ns: i64,
    /// Seconds since the log's start.
    pub time_s: f64,
    /// Each wheel, in the robot's order.
    pub wheels: &'a [WheelEstimate],
    /// Where the robot is and how it moves, corrected for slip; `None` where nothing new is known of it.
    pub odometry: Option<Odometry>,
    /// What is learnt of the soil so far, with [`Options::learn_soil`](crate::Options).
    pub soil: Option<SoilEstimate>,
}

/// Where a run's output goes.
///
/// ```
/// use grouser_replay::{Row, Sink};
///
/// /// The maximum slip of any wheel.
/// struct Maximum(f64);
///
/// impl Sink for Maximum {
///     fn row(&mut self, row: &Row<'_>) -> std::io::Result<()> {
///         self.0 = self.0.max(row.slip.unwrap_or(0.0));
///         Ok(())
///     }
/// }
/// ```
pub trait Sink {
    /// One wheel, whenever it was read.
    ///
    /// # Errors
    /// What ends the run.
    fn row(&mut self, row: &Row<'_>) -> io::Result<()>;

    /// The whole robot, after the rows of one time.
    ///
    /// # Errors
    /// What ends the run.
    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        let _ = step;
        Ok(())
    }

    /// An event that begins or ends, before the rows of its time.
    ///
    /// # Errors
    /// What ends the run.
    fn event(&mut self, change: &Change) -> io::Result<()> {
        let _ = change;
        Ok(())
    }
}

/// A closure that takes rows alone.
pub(crate) struct Rows<F>(pub(crate) F);

impl<F: FnMut(&Row<'_>) -> io::Result<()>> Sink for Rows<F> {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        (self.0)(row)
    }
}
