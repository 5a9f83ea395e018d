//! Heights on a square grid.

use std::ops::RangeInclusive;

use super::UndeclaredNoData;
use crate::error::{Error, Result};

/// Greatest number of cells of a map.
pub(crate) const MAX_CELLS: usize = 1 << 25;
/// Greatest number of nodes along a side.
const MAX_SIDE_NODES: f64 = 1e5;
/// Distance of its nodes, m.
pub(crate) const CELL_LIMITS_M: (f64, f64) = (1e-3, 1e3);

/// Limits of a side, m.
pub(crate) fn side_limits(cell: f64) -> (f64, f64) {
    (2.0 * cell, MAX_SIDE_NODES * cell - cell)
}

/// The greatest other side (m) of a map whose one side is `length` long, by the number of its nodes.
pub(crate) fn max_width(length: f64, cell: f64) -> f64 {
    (MAX_CELLS / side_nodes(length, cell)).saturating_sub(1) as f64 * cell
}

/// Nodes along a side.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a side within its limits has 3 to 1e5 nodes"
)]
fn side_nodes(length: f64, cell: f64) -> usize {
    (length / cell).round() as usize + 1
}

/// Heights at the nodes of a square grid, between which they are bilinear. Beyond the edge the edge goes on.
///
/// ```
/// use grouser_rover::ground::HeightMap;
///
/// // A slope of 10 %: 10 m by 4 m, a node every 0.5 m.
/// let map = HeightMap::from_shape((10.0, 4.0), 0.5, |x, _| 0.1 * x)?;
/// assert!((map.height(3.25, 0.7) - 0.325).abs() < 1e-6);
/// assert_eq!(map.extent(), ((0.0, -2.0), (10.0, 2.0)));
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    origin: (f64, f64),
    cell: f64,
    columns: usize,
    rows: usize,
    heights: Vec<f32>,
    /// No height at all was given for these nodes; they carry their neighbours'. Empty: all known.
    unknown: Vec<bool>,
    /// What a file did not declare as unknown.
    pub(super) undeclared: Option<UndeclaredNoData>,
}

/// Dimensionless, 1.5 · 2⁵²: doubles beside it are 1 apart (IEEE 754), so that a sum with it is rounded to a whole number, which its low
/// bits hold. Conversions take longer, as they allow for what does not fit.
const ROUNDING_SUMMAND: f64 = 6_755_399_441_055_744.0;

/// The cell around a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    index: usize,
    columns: usize,
    share: (f64, f64),
    inside: bool,
}

impl Corner {
    /// Bilinear value of a field of the grid.
    #[inline]
    pub(crate) fn mix(&self, field: &[f32]) -> f64 {
        let (x, y) = self.share;
        let row = |from: usize| {
            let pair = &field[from..from + 2];
            let (left, right) = (f64::from(pair[0]), f64::from(pair[1]));
            left + x * (right - left)
        };
        let (low, high) = (row(self.index), row(self.index + self.columns));
        low + y * (high - low)
    }

    /// The node that lies nearest.
    pub(crate) fn nearest(&self) -> usize {
        let (x, y) = self.share;
        self.index + usize::from(x > 0.5) + if y > 0.5 { self.columns } else { 0 }
    }
}

/// The surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    pub(crate) height: f64,
    pub(crate) slope: [f64; 2],
}

impl HeightMap {
    /// A map whose first node lies at `origin` (m), with nodes every `cell` m; heights row by row from the
    /// origin, each row along x. NaN stands for an unknown height: it takes the nearest known one and
    /// stays marked.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for sizes outside their limits, for heights that do not fit them, for infinite
    /// heights, and where no height is known.
    ///
    /// ```
    /// # use grouser_rover::ground::HeightMap;
    /// let map = HeightMap::new((0.0, 0.0), 1.0, 2, vec![0.0, 0.2, 0.0, 0.2])?;
    /// assert!((map.height(0.5, 0.5) - 0.1).abs() < 1e-6);
    /// assert!(HeightMap::new((0.0, 0.0), 1.0, 2, vec![0.0; 5]).is_err()); // a cell beyond the last row
    /// # Ok::<(), grouser_rover::Error>(())
    /// ```
    pub fn new(origin: (f64, f64), cell: f64, columns: usize, heights: Vec<f32>) -> Result<Self> {
        let of = "height map";
        let far = (-1e7, 1e7);
        Error::check(of, "origin x", origin.0, far, "m")?;
        Error::check(of, "origin y", origin.1, far, "m")?;
        Error::check(of, "cell", cell, CELL_LIMITS_M, "m")?;
        Error::check(of, "columns", columns as f64, (2.0, MAX_SIDE_NODES), "1")?;
        let most = MAX_CELLS as f64;
        Error::check(of, "cells", heights.len() as f64, (4.0, most), "1")?;
        let rows = heights.len() / columns;
        Error::check(of, "rows", rows as f64, (2.0, MAX_SIDE_NODES), "1")?;
        let odd = heights.len() - rows * columns;
        Error::check(of, "cells beyond the last row", odd as f64, (0.0, 0.0), "1")?;
        for height in &heights {
            if !height.is_nan() {
                Error::check(of, "height", f64::from(*height), (-1e6, 1e6), "m")?;
            }
        }
        let mut map = Self {
            origin,
            cell,
            columns,
            rows,
            heights,
            unknown: Vec::new(),
            undeclared: None,
        };
        map.fill_unknown()?;
        Ok(map)
    }

    /// What was read as unknown, although the map's file does not declare it.
    #[must_use]
    pub const fn undeclared(&self) -> Option<UndeclaredNoData> {
        self.undeclared
    }

    /// Unknown nodes take the height of the nearest known one in their row, then in their column.
    fn fill_unknown(&mut self) -> Result<()> {
        if !self.heights.iter().any(|height| height.is_nan()) {
            return Ok(());
        }
        self.unknown = self.heights.iter().map(|height| height.is_nan()).collect();
        let known = self.unknown.iter().filter(|unknown| !**unknown).count();
        let most = self.heights.len() as f64;
        Error::check(
            "height map",
            "known heights",
            known as f64,
            (1.0, most),
            "1",
        )?;
        let (columns, rows) = (self.columns, self.rows);
        for row in 0..rows {
            spread(
                &mut self.heights,
                (0..columns).map(|column| row * columns + column),
            );
        }
        for column in 0..columns {
            spread(
                &mut self.heights,
                (0..rows).map(|row| row * columns + column),
            );
        }
        Ok(())
    }

    /// A map of `size` (m) about x from 0 and y around 0, with the heights of `shape`.
    ///
    /// # Errors
    /// As [`HeightMap::new`].
    pub fn from_shape(
        size: (f64, f64),
        cell: f64,
        shape: impl Fn(f64, f64) -> f64,
    ) -> Result<Self> {
        Self::from_lines(size, cell, |y| {
            let shape = &shape;
            move |x| shape(x, y)
        })
    }

    /// [`HeightMap::from_shape`] by the heights along x of each y.
    pub(crate) fn from_lines<L: FnMut(f64) -> f64>(
        size: (f64, f64),
        cell: f64,
        along: impl Fn(f64) -> L,
    ) -> Result<Self> {
        let of = "ground";
        Error::check(of, "cell", cell, CELL_LIMITS_M, "m")?;
        Error::check(of, "size_x", size.0, side_limits(cell), "m")?;
        Error::check(of, "size_y", size.1, side_limits(cell), "m")?;
        let (columns, rows) = (side_nodes(size.0, cell), side_nodes(size.1, cell));
        let most = MAX_CELLS as f64;
        Error::check(of, "cells", columns as f64 * rows as f64, (4.0, most), "1")?;
        let origin = (0.0, -0.5 * (rows - 1) as f64 * cell);
        let mut heights = Vec::with_capacity(rows * columns);
        for row in 0..rows {
            let mut height = along(origin.1 + row as f64 * cell);
            #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
            heights.extend((0..columns).map(|column| height(column as f64 * cell) as f32));
        }
        Self::new(origin, cell, columns, heights)
    }

    /// Number of nodes.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.heights.len()
    }

    /// Distance of the nodes, m.
    #[must_use]
    pub const fn cell(&self) -> f64 {
        self.cell
    }

    /// The first node and the last one, m.
    #[must_use]
    pub fn extent(&self) -> ((f64, f64), (f64, f64)) {
        let (x, y) = self.origin;
        let far = |from: f64, count: usize| from + (count - 1) as f64 * self.cell;
        (self.origin, (far(x, self.columns), far(y, self.rows)))
    }

    /// The y of each row, and the x of each node of a row, m.
    pub(crate) fn lines(&self) -> (impl Iterator<Item = f64>, impl Iterator<Item = f64> + Clone) {
        let at = |from: f64, count: usize, cell: f64| {
            (0..count).map(move |index| from + index as f64 * cell)
        };
        (
            at(self.origin.1, self.rows, self.cell),
            at(self.origin.0, self.columns, self.cell),
        )
    }

    /// Where a node lies, m.
    #[must_use]
    pub fn centre_of(&self, index: usize) -> (f64, f64) {
        (
            self.origin.0 + (index % self.columns) as f64 * self.cell,
            self.origin.1 + (index / self.columns) as f64 * self.cell,
        )
    }

    /// Height at (x, y), m.
    #[must_use]
    pub fn height(&self, x: f64, y: f64) -> f64 {
        self.corner(x, y).mix(&self.heights)
    }

    /// Is (x, y) on the map, and the height of the node next to it known?
    ///
    /// ```
    /// # use grouser_rover::ground::HeightMap;
    /// let map = HeightMap::new((0.0, 0.0), 1.0, 2, vec![0.3, f32::NAN, 0.3, 0.3])?;
    /// assert!(map.known(0.0, 0.0) && !map.known(1.0, 0.0));
    /// # Ok::<(), grouser_rover::Error>(())
    /// ```
    #[must_use]
    pub fn known(&self, x: f64, y: f64) -> bool {
        self.is_known(&self.corner(x, y))
    }

    pub(crate) fn corner(&self, x: f64, y: f64) -> Corner {
        let (along, across) = self.in_cells(x, y);
        self.corner_in_cells(along, across)
    }

    /// Where (x, y) lies in cells from the first node.
    pub(crate) fn in_cells(&self, x: f64, y: f64) -> (f64, f64) {
        (
            (x - self.origin.0) / self.cell,
            (y - self.origin.1) / self.cell,
        )
    }

    /// Height at a place in cells from the first node, m.
    #[inline(always)]
    pub(crate) fn height_in_cells(&self, along: f64, across: f64) -> f64 {
        self.corner_in_cells(along, across).mix(&self.heights)
    }

    /// The cell around a place in cells from the first node. NaN counts as 0.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_sign_loss,
        reason = "clamped to the map, which has at most 1e5 nodes a side"
    )]
    #[inline]
    pub(crate) fn corner_in_cells(&self, along: f64, across: f64) -> Corner {
        let at = [along, across];
        let last = [self.columns, self.rows].map(|count| f64::from(count as i32 - 1));
        let inside = at[0] >= 0.0 && at[0] <= last[0] && at[1] >= 0.0 && at[1] <= last[1];
        let at: [f64; 2] = std::array::from_fn(|i| at[i].max(0.0).min(last[i]));
        // rounded to even: on a node it is this one or the one before, with the share 1
        let below: [f64; 2] = std::array::from_fn(|i| {
            ((at[i] - 0.5) + ROUNDING_SUMMAND).min(last[i] - 1.0 + ROUNDING_SUMMAND)
        });
        let [column, row] = below.map(|below| below.to_bits() as u32 as usize);
        Corner {
            index: row * self.columns + column,
            columns: self.columns,
            share: (
                at[0] - (below[0] - ROUNDING_SUMMAND),
                at[1] - (below[1] - ROUNDING_SUMMAND),
            ),
            inside,
        }
    }

    pub(crate) fn surface(&self, corner: &Corner) -> Surface {
        let at = |index: usize| f64::from(self.heights[index]);
        let (x, y) = corner.share;
        let (low, high) = (corner.index, corner.index + self.columns);
        let (a, b, c, d) = (at(low), at(low + 1), at(high), at(high + 1));
        Surface {
            height: (1.0 - y) * (a + x * (b - a)) + y * (c + x * (d - c)),
            slope: [
                ((1.0 - y) * (b - a) + y * (d - c)) / self.cell,
                ((1.0 - x) * (c - a) + x * (d - b)) / self.cell,
            ],
        }
    }

    /// Does the point lie on the map, and is the height of the node next to it known?
    pub(crate) fn is_known(&self, corner: &Corner) -> bool {
        let is_unknown = || self.unknown.get(corner.nearest()).copied();
        corner.inside && !is_unknown().unwrap_or_default()
    }

    /// The nodes of a rectangle, row by row.
    pub(crate) fn indices_between(
        &self,
        low: (f64, f64),
        high: (f64, f64),
    ) -> impl Iterator<Item = usize> + use<> {
        let columns = self.columns;
        let across = nodes(
            low.0 - self.origin.0,
            high.0 - self.origin.0,
            self.cell,
            columns,
        );
        let rows = nodes(
            low.1 - self.origin.1,
            high.1 - self.origin.1,
            self.cell,
            self.rows,
        );
        rows.flat_map(move |row| across.clone().map(move |column| row * columns + column))
    }
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the map before"
)]
fn nodes(low: f64, high: f64, cell: f64, count: usize) -> RangeInclusive<usize> {
    let last = (count - 1) as f64;
    let low = (low / cell).ceil().clamp(0.0, last) as usize;
    let high = (high / cell).floor().clamp(0.0, last) as usize;
    low..=high
}

/// Along a line of nodes, what is unknown takes the nearest known height.
fn spread(heights: &mut [f32], line: impl DoubleEndedIterator<Item = usize>) {
    let line: Vec<usize> = line.collect();
    let mut known: Vec<usize> = Vec::new();
    for (place, index) in line.iter().enumerate() {
        if !heights[*index].is_nan() {
            known.push(place);
        }
    }
    let Some(first) = known.first().copied() else {
        return;
    };
    let (mut before, mut next) = (first, 0);
    for (place, index) in line.iter().enumerate() {
        while next < known.len() && known[next] <= place {
            before = known[next];
            next += 1;
        }
        let after = known.get(next).copied();
        let nearest = match after {
            Some(after) if after - place < place.abs_diff(before) => after,
            _ => before,
        };
        if heights[*index].is_nan() {
            heights[*index] = heights[line[nearest]];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_is_itself_between_the_nodes() {
        let map = HeightMap::from_shape((2.0, 1.0), 0.25, |x, y| 0.25 * x - 0.5 * y).unwrap();
        let surface = map.surface(&map.corner(0.61, -0.13));
        assert!((surface.height - (0.25 * 0.61 + 0.5 * 0.13)).abs() < 1e-7);
        assert!((surface.slope[0] - 0.25).abs() < 1e-6 && (surface.slope[1] + 0.5).abs() < 1e-6);
        assert!(map.known(0.61, -0.13) && !map.known(-0.1, 0.0));
        assert_eq!(map.extent(), ((0.0, -0.5), (2.0, 0.5)));
    }

    #[test]
    fn nodes_have_their_heights_and_the_edge_goes_on() {
        let heights: Vec<f32> = (0..15_u8).map(|i| 0.37 * f32::from(i * i)).collect();
        let map = HeightMap::new((-1.0, 2.0), 0.5, 5, heights.clone()).unwrap();
        for (index, height) in heights.iter().enumerate() {
            let (x, y) = map.centre_of(index);
            assert_eq!(map.height(x, y), f64::from(*height), "{index}");
            assert!(map.known(x, y));
            for (d_x, d_y) in [(1e-9, 0.0), (-1e-9, 0.0), (0.0, 1e-9), (0.0, -1e-9)] {
                let off = (map.height(x + d_x, y + d_y) - f64::from(*height)).abs();
                assert!(off < 1e-6, "{index}");
            }
        }
        // between nodes, beyond the edges, and nowhere
        let between = |from: usize, to: usize, share: f64| {
            f64::from(heights[from]) + share * f64::from(heights[to] - heights[from])
        };
        for share in [0.2, 0.8] {
            let (x, y) = (-0.5 + 0.5 * share, 2.0 + 0.5 * share);
            assert!((map.height(x, 2.5) - between(6, 7, share)).abs() < 1e-6);
            assert!((map.height(0.0, y) - between(2, 7, share)).abs() < 1e-6);
        }
        for ((x, y), index) in [((-9.0, -9.0), 0), ((9.0, 9.0), 14), ((f64::NAN, 9.0), 10)] {
            assert_eq!(map.height(x, y), f64::from(heights[index]));
            assert!(!map.known(x, y));
        }
    }

    #[test]
    fn what_is_unknown_is_never_height_zero() {
        let (gap, five) = (f32::NAN, 5.0);
        let map = HeightMap::new((0.0, 0.0), 1.0, 3, vec![five, gap, five, gap, gap, gap]).unwrap();
        assert_eq!(map.height(1.0, 0.0), 5.0);
        assert_eq!(map.height(1.5, 1.0), 5.0);
        assert!(!map.known(1.0, 1.0));
        assert!(HeightMap::new((0.0, 0.0), 1.0, 2, vec![gap; 4]).is_err());
        assert!(HeightMap::new((0.0, 0.0), 1.0, 2, vec![1.0, 2.0, 3.0, f32::INFINITY]).is_err());
        assert!(HeightMap::new((0.0, 0.0), 1.0, 2, vec![1.0; 5]).is_err());
    }
}
