//! Columns of results that are computed point by point, or block by block, on threads.

use grouser::terra::{BatchInput, SolveStatus};
use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::workers;

pub(crate) type Floats<'py> = Bound<'py, PyArray1<f64>>;
pub(crate) type Codes<'py> = Bound<'py, PyArray1<u8>>;

/// The status of a point that is none.
pub(crate) const BAD: u8 = SolveStatus::BadInput.code();

/// A point costs some hundred times one of a batch: threads pay from a few dozen on.
const COST_OF_A_POINT: usize = 256;

/// The number of a point.
pub(crate) fn at(column: BatchInput<'_>, i: usize) -> f64 {
    match column {
        BatchInput::Constant(x) => x,
        BatchInput::Column(values) => values[i],
    }
}

/// Status codes and results of `points`, which `compute` writes for the points from an index on, `block` of them between two
/// looks at signals.
pub(crate) fn blocks<T: Clone + Send + Empty>(
    py: Python<'_>,
    points: usize,
    (threads, block): (usize, usize),
    compute: impl Fn(usize, &mut [u8], &mut [T]) + Sync,
) -> PyResult<(Vec<u8>, Vec<T>)> {
    let mut status = filled(0, points)?;
    let mut results = filled(T::EMPTY, points)?;
    let threads = workers::count(threads, points.saturating_mul(COST_OF_A_POINT));
    let mut from = 0;
    for (status, results) in status
        .chunks_mut(block * threads)
        .zip(results.chunks_mut(block * threads))
    {
        let n = status.len();
        let jobs = status
            .chunks_mut(block)
            .zip(results.chunks_mut(block))
            .enumerate()
            .map(|(k, (status, results))| {
                let compute = &compute;
                move || compute(from + k * block, status, results)
            })
            .collect();
        workers::run(py, jobs);
        py.check_signals()?;
        from += n;
    }
    Ok((status, results))
}

/// [`blocks`] of points that are computed one by one.
pub(crate) fn rows<T: Clone + Send + Empty>(
    py: Python<'_>,
    points: usize,
    threads: usize,
    compute: impl Fn(usize) -> (u8, T) + Sync,
) -> PyResult<(Vec<u8>, Vec<T>)> {
    /// One point takes some 10 µs, a slip demand a millisecond.
    const BLOCK: usize = 64;
    blocks(py, points, (threads, BLOCK), |from, status, results| {
        for (j, (status, result)) in status.iter_mut().zip(results).enumerate() {
            (*status, *result) = compute(from + j);
        }
    })
}

/// A result that is none.
pub(crate) trait Empty {
    const EMPTY: Self;
}

impl Empty for f64 {
    const EMPTY: Self = f64::NAN;
}

impl<const N: usize> Empty for [f64; N] {
    const EMPTY: Self = [f64::NAN; N];
}

/// `points` times `value`; a `MemoryError` where there is no room for them.
fn filled<T: Clone>(value: T, points: usize) -> PyResult<Vec<T>> {
    let mut column = Vec::new();
    column
        .try_reserve_exact(points)
        .map_err(|_| PyMemoryError::new_err(format!("no memory for {points} points")))?;
    column.resize(points, value);
    Ok(column)
}

/// One column of rows.
pub(crate) fn column<'py, const N: usize>(
    py: Python<'py>,
    rows: &[[f64; N]],
    k: usize,
) -> Floats<'py> {
    let column: Vec<f64> = rows.iter().map(|row| row[k]).collect();
    column.into_pyarray(py)
}
