//! How often wheels have passed each cell, and with which slip.

use grouser_terra::{MultiPass, PassChange};

/// A wheel that leaves a rut.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Track {
    /// Its index on the robot.
    pub wheel: u8,
    /// The way that it has made, m.
    pub way: f64,
    /// Its slip.
    pub slip: f64,
}

impl Track {
    /// The wheel `wheel` after `way` (m) at `slip`.
    #[must_use]
    pub const fn new(wheel: u8, way: f64, slip: f64) -> Self {
        Self { wheel, way, slip }
    }
}

/// The passes of a cell.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    count: u8,
    last_wheel: u8,
    /// Way of that wheel when it pressed the cell last, m.
    way: f32,
    /// Slip of the pass.
    slip: f32,
}

/// Passes of all cells under a law.
#[derive(Clone, Debug)]
pub(super) struct Passes {
    law: MultiPass,
    cells: Vec<Cell>,
}

impl Passes {
    pub(super) fn new(law: MultiPass, cells: usize) -> Self {
        Self {
            law,
            cells: vec![Cell::default(); cells],
        }
    }

    /// What the passes so far have made of a cell.
    pub(super) fn change(&self, cell: usize) -> PassChange {
        let cell = &self.cells[cell];
        self.law.change(f64::from(cell.slip), cell.count.into())
    }

    /// A wheel presses a cell; it is the same pass while the same wheel has made less than `way` (m) since.
    #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
    pub(super) fn leave(&mut self, cell: usize, track: &Track, way: f64) {
        let cell = &mut self.cells[cell];
        let same = cell.count > 0
            && cell.last_wheel == track.wheel
            && track.way - f64::from(cell.way) < way;
        if !same {
            cell.count = cell.count.saturating_add(1);
        }
        *cell = Cell {
            last_wheel: track.wheel,
            way: track.way as f32,
            slip: track.slip as f32,
            ..*cell
        };
    }
}
