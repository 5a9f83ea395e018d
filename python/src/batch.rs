//! Many operating points at once: arrays in, arrays out, on lanes and threads.

use std::collections::BTreeMap;

use grouser::files::soil::SoilNumber;
use grouser::terra::{
    BatchColumns, BatchInput, BatchKernel, BatchPoints, Caution, SoilColumns, SolveStatus,
};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadwriteArray1};
use pyo3::prelude::*;

use crate::error::{Details, input_error, raised};
use crate::rows::at;
use crate::soil::Soil;
use crate::wheel::Wheel;
use crate::workers::{self, POINTS_PER_BLOCK};

/// A quantity of all points: a contiguous array, which is not copied, or one number.
#[derive(FromPyObject)]
pub(crate) enum Column<'py> {
    Array(PyReadonlyArray1<'py, f64>),
    Constant(f64),
}

impl Column<'_> {
    pub(crate) fn input(&self) -> PyResult<BatchInput<'_>> {
        Ok(match self {
            Self::Array(array) => BatchInput::Column(array.as_slice()?),
            Self::Constant(x) => BatchInput::Constant(*x),
        })
    }
}

/// Points of a curve between two looks at signals: 0.1 s of work.
const POINTS_PER_CURVE: usize = 1 << 20;

/// The columns that a batch writes, allocated by the caller: sinkage, vertical force, drawbar pull, torque.
type Numbers<'py> = [PyReadwriteArray1<'py, f64>; 4];

fn check_length(found: usize, expected: usize) -> PyResult<()> {
    if found == expected {
        return Ok(());
    }
    raised(Err(grouser::terra::Error::Lengths { expected, found }))
}

pub(crate) fn part<'a>(input: BatchInput<'a>, from: usize, to: usize) -> BatchInput<'a> {
    match input {
        BatchInput::Column(column) => BatchInput::Column(&column[from..to]),
        constant => constant,
    }
}

pub(crate) fn write_codes(codes: &mut [u8], statuses: &[SolveStatus]) {
    for (code, status) in codes.iter_mut().zip(statuses) {
        *code = status.code();
    }
}

/// The first `N` columns, of `N` and as many as there are `keys`, each one number or as long as there are `points`.
fn first_inputs<'a, const N: usize>(
    columns: &'a [Column<'_>],
    keys: usize,
    points: usize,
) -> PyResult<[BatchInput<'a>; N]> {
    check_length(columns.len(), N + keys)?;
    let mut inputs = [BatchInput::Constant(0.0); N];
    for (place, column) in columns.iter().enumerate() {
        let input = column.input()?;
        if let BatchInput::Column(values) = input {
            check_length(values.len(), points)?;
        }
        if let Some(own) = inputs.get_mut(place) {
            *own = input;
        }
    }
    Ok(inputs)
}

/// The soil of each point: the numbers of `keys` (of soil files) in `columns`, in the keys' units and scaled here into `room`.
fn soil_columns<'a>(
    soil: &Soil,
    keys: &[String],
    columns: &'a [Column<'_>],
    room: &'a mut [Vec<f64>],
) -> PyResult<Option<SoilColumns<'a>>> {
    if keys.is_empty() {
        return Ok(None);
    }
    let mut soils = SoilColumns::from_soil(&soil.soil);
    for ((key, column), scaled) in keys.iter().zip(columns).zip(room) {
        let number = SoilNumber::named(key);
        let place = number.and_then(|number| Some((number, number.column(&mut soils)?)));
        let Some((number, place)) = place else {
            let known = SoilNumber::all().filter(|number| number.column(&mut soils).is_some());
            let known: Vec<&str> = known.map(SoilNumber::key).collect();
            let message = format!(
                "{key} is no number that differs by point: {}",
                known.join(", ")
            );
            return Err(input_error(message, Details::field("draws")));
        };
        let unit = number.key_unit();
        *place = match column.input()? {
            BatchInput::Constant(x) => BatchInput::Constant(x * unit),
            BatchInput::Column(values) if unit == 1.0 => BatchInput::Column(values),
            BatchInput::Column(values) => {
                scaled.extend(values.iter().map(|x| x * unit));
                BatchInput::Column(scaled)
            }
        };
    }
    Ok(Some(soils))
}

/// The soils of a range of points.
fn soils_of<'a>(soils: &SoilColumns<'a>, from: usize, to: usize) -> SoilColumns<'a> {
    let own = |input| part(input, from, to);
    SoilColumns {
        k_c: own(soils.k_c),
        k_phi: own(soils.k_phi),
        n: own(soils.n),
        cohesion: own(soils.cohesion),
        phi: own(soils.phi),
        k_shear: own(soils.k_shear),
        c_1: own(soils.c_1),
        c_2: own(soils.c_2),
    }
}

/// Sinkage and forces under loads, or forces at sinkages. `columns` are radius, width, rebound, slip, and load or sinkage,
/// then the numbers of the soil that `keys` names, each a contiguous array or one number; `status` and `numbers` (sinkage,
/// vertical force, drawbar pull, torque) are written.
#[pyfunction]
pub(crate) fn solve_points<'py>(
    py: Python<'py>,
    soil: &Soil,
    is_load: bool,
    columns: (Vec<Column<'py>>, Vec<String>),
    mut status: PyReadwriteArray1<'py, u8>,
    mut numbers: Numbers<'py>,
    threads: usize,
) -> PyResult<()> {
    let codes = status.as_slice_mut()?;
    let points = codes.len();
    let (columns, keys) = columns;
    let inputs: [_; 5] = first_inputs(&columns, keys.len(), points)?;
    let mut room = vec![Vec::new(); keys.len()];
    let soils = soil_columns(soil, &keys, &columns[inputs.len()..], &mut room)?;
    let [sinkage, vertical_force, drawbar_pull, torque] = &mut numbers;
    let mut rest = [
        sinkage.as_slice_mut()?,
        vertical_force.as_slice_mut()?,
        drawbar_pull.as_slice_mut()?,
        torque.as_slice_mut()?,
    ];
    for column in &rest {
        check_length(column.len(), points)?;
    }
    let kernel = BatchKernel::new(soil.soil);
    let threads = workers::count(threads, points);
    let block = points.min(POINTS_PER_BLOCK * threads);
    let mut statuses = vec![SolveStatus::default(); block];
    let mut from = 0;
    for codes in codes.chunks_mut(block.max(1)) {
        let share = codes.len().div_ceil(threads);
        let block_end = from + codes.len();
        let mut jobs = Vec::with_capacity(threads);
        for status in statuses[..codes.len()].chunks_mut(share) {
            let to = block_end.min(from + share);
            let [sinkage, vertical_force, drawbar_pull, torque] = rest.each_mut().map(|column| {
                let (mine, others) = std::mem::take(column).split_at_mut(to - from);
                *column = others;
                mine
            });
            let mut out = BatchColumns {
                sinkage,
                vertical_force,
                drawbar_pull,
                torque,
                status,
            };
            let [radius, width, rebound, slip, value] = inputs.map(|input| part(input, from, to));
            let points = BatchPoints {
                radius,
                width,
                rebound,
                slip,
            };
            let kernel = &kernel;
            let soils = soils.map(|soils| soils_of(&soils, from, to));
            jobs.push(move || match (&soils, is_load) {
                (None, true) => kernel.under_load(&points, value, &mut out),
                (None, false) => kernel.forces(&points, value, &mut out),
                (Some(soils), true) => kernel.under_load_on(soils, &points, value, &mut out),
                (Some(soils), false) => kernel.forces_on(soils, &points, value, &mut out),
            });
            from = to;
        }
        for result in workers::run(py, jobs) {
            raised(result)?;
        }
        write_codes(codes, &statuses);
        py.check_signals()?;
    }
    Ok(())
}

/// The key of a caution, and which points have it.
type CautionMask<'py> = (&'static str, Bound<'py, PyArray1<bool>>);

/// The key of each caution that a solved point has, with a mask of the points. `columns` are radius, width, rebound, slip,
/// sinkage (NaN where a point is not solved), vertical force, drawbar pull and torque, then the numbers of the soil that `keys`
/// names.
#[pyfunction]
pub(crate) fn point_cautions<'py>(
    py: Python<'py>,
    soil: &Soil,
    columns: (Vec<Column<'py>>, Vec<String>),
    points: usize,
) -> PyResult<Vec<CautionMask<'py>>> {
    let (columns, keys) = columns;
    let inputs: [_; 8] = first_inputs(&columns, keys.len(), points)?;
    let mut room = vec![Vec::new(); keys.len()];
    let soils = soil_columns(soil, &keys, &columns[inputs.len()..], &mut room)?;
    let soils = soils.unwrap_or_else(|| SoilColumns::from_soil(&soil.soil));
    let kernel = BatchKernel::new(soil.soil);
    let mut masks: BTreeMap<Caution, Vec<bool>> = BTreeMap::new();
    for from in (0..points).step_by(POINTS_PER_BLOCK) {
        let to = points.min(from + POINTS_PER_BLOCK);
        py.detach(|| {
            let soils = soils_of(&soils, from, to);
            let [radius, width, rebound, slip, found @ ..] =
                inputs.map(|input| part(input, from, to));
            let points_here = BatchPoints {
                radius,
                width,
                rebound,
                slip,
            };
            let numbers = |input| (0..to - from).map(|i| at(input, i)).collect::<Vec<f64>>();
            let [
                mut sinkage,
                mut vertical_force,
                mut drawbar_pull,
                mut torque,
            ] = found.map(numbers);
            let is_solved = |sinkage: &f64| match sinkage.is_nan() {
                true => SolveStatus::NotConverged,
                false => SolveStatus::Solved,
            };
            let mut status: Vec<SolveStatus> = sinkage.iter().map(is_solved).collect();
            let found = BatchColumns {
                sinkage: &mut sinkage,
                vertical_force: &mut vertical_force,
                drawbar_pull: &mut drawbar_pull,
                torque: &mut torque,
                status: &mut status,
            };
            for i in 0..to - from {
                for caution in kernel.cautions_on(&soils, &points_here, &found, i).iter() {
                    let mask = masks.entry(caution);
                    mask.or_insert_with(|| vec![false; points])[from + i] = true;
                }
            }
        });
        py.check_signals()?;
    }
    let masks = masks.into_iter();
    Ok(masks
        .map(|(caution, mask)| (caution.key(), mask.into_pyarray(py)))
        .collect())
}

/// Sinkage and forces of one wheel under one load at many slips; outputs as in `solve_points`.
#[pyfunction]
pub(crate) fn solve_curve<'py>(
    py: Python<'py>,
    soil: &Soil,
    wheel: &Wheel,
    load_n: f64,
    slip: PyReadonlyArray1<'py, f64>,
    mut status: PyReadwriteArray1<'py, u8>,
    mut numbers: Numbers<'py>,
) -> PyResult<()> {
    let slip = slip.as_slice()?;
    let kernel = BatchKernel::new(soil.soil);
    let mut statuses = vec![SolveStatus::default(); slip.len()];
    let [sinkage, vertical_force, drawbar_pull, torque] = &mut numbers;
    let [sinkage, vertical_force, drawbar_pull, torque] = [
        sinkage.as_slice_mut()?,
        vertical_force.as_slice_mut()?,
        drawbar_pull.as_slice_mut()?,
        torque.as_slice_mut()?,
    ];
    let codes = status.as_slice_mut()?;
    for found in [
        codes.len(),
        sinkage.len(),
        vertical_force.len(),
        drawbar_pull.len(),
        torque.len(),
    ] {
        check_length(found, slip.len())?;
    }
    // once where there is no point, for what is wrong with the wheel or the load
    for from in (0..slip.len().max(1)).step_by(POINTS_PER_CURVE) {
        let own = from..slip.len().min(from + POINTS_PER_CURVE);
        let mut columns = BatchColumns {
            sinkage: &mut sinkage[own.clone()],
            vertical_force: &mut vertical_force[own.clone()],
            drawbar_pull: &mut drawbar_pull[own.clone()],
            torque: &mut torque[own.clone()],
            status: &mut statuses[own.clone()],
        };
        raised(py.detach(|| kernel.curve(&wheel.0, load_n, &slip[own], &mut columns)))?;
        py.check_signals()?;
    }
    write_codes(codes, &statuses);
    Ok(())
}

/// The instructions that batches run on: `avx512`, `avx2` or `portable`.
#[pyfunction]
pub(crate) fn instructions(soil: &Soil) -> &'static str {
    BatchKernel::new(soil.soil).instructions()
}
