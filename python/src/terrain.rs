//! The maker of slip maps of elevation models.

use std::path::PathBuf;

use grouser::files::Document;
use grouser::files::gravity::GRAVITY_LIMITS_M_PER_S2;
use grouser::rover::ground::Georeference;
use grouser::rover::robot::RobotModel;
use grouser::terra;
use grouser::terrain::raster::Window;
use grouser::terrain::{
    self, DemandSolver, Envelope, Headings, MapLayout, MapSettings, SlipTable, SoilIntervals,
};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyType};
use rayon::prelude::*;

use crate::argument;
use crate::error::{Details, input_error, raised, type_error};
use crate::slip_map::SlipMap;
use crate::soil::Soil;
use crate::workers;

/// Cells that each thread computes between two looks at signals.
const CELLS_PER_BLOCK: usize = 4096;

/// Greatest size of a map.
const MAX_ROWS: usize = 1 << 24;
const MAX_COLUMNS: usize = 1 << 16;

/// What the tables of a mapper are made of; pickled instead of them.
#[derive(Clone, Debug)]
struct Recipe {
    robot: PathBuf,
    soil: Soil,
    cell_m: f64,
    headings: u8,
    gravity_m_per_s2: Option<f64>,
    max_pitch_deg: f64,
    max_roll_deg: f64,
    soil_intervals: Option<PathBuf>,
    soil_draws: u16,
    seed: u64,
    cvar_level: f64,
}

impl Recipe {
    fn draws(&self) -> terrain::Result<Vec<terra::Soil>> {
        let Some(path) = &self.soil_intervals else {
            return Ok(Vec::new());
        };
        let intervals = SoilIntervals::parse(&Document::read(path)?)?;
        intervals.draw(&self.soil.soil, self.soil_draws.into(), self.seed)
    }

    /// The maker of maps, and a map of two by two cells that has what is the same for all of them.
    fn maker(&self) -> terrain::Result<(terrain::MapMaker, MapLayout)> {
        let headings = Headings::new(self.headings)?;
        let model = RobotModel::read(&self.robot)?;
        let model = match self.gravity_m_per_s2 {
            Some(gravity) => model.under_gravity(gravity),
            None => model,
        };
        let [pitch, roll] = [self.max_pitch_deg, self.max_roll_deg].map(f64::to_radians);
        let envelope = Envelope::within(&model, pitch, roll)?;
        let draws = self.draws()?;
        let mut layout = MapLayout::plain(2, 2, self.cell_m, headings).of_robot(&model);
        layout.draws = u32::try_from(draws.len()).unwrap_or(u32::MAX);
        layout.soils = vec![self.soil.name().to_owned()];
        layout.cvar_level = self.cvar_level;
        let table = |soil: &terra::Soil| {
            let solver = DemandSolver::new(model.clone(), *soil)?;
            let table = SlipTable::new(&solver, envelope)?;
            Ok((solver, table))
        };
        let (own, draws) = rayon::join(
            || table(&self.soil.soil),
            || {
                draws
                    .par_iter()
                    .map(table)
                    .collect::<terrain::Result<Vec<_>>>()
            },
        );
        let settings = MapSettings::new(headings, envelope).with_cvar_level(self.cvar_level)?;
        let maker = terrain::MapMaker::new(settings, own?, draws?, self.cell_m);
        Ok((maker, layout))
    }
}

/// Computes what a robot needs on every cell of an elevation model, for 4, 8 or 16 headings.
///
/// The exact solver fills a table over pitch and roll once, in seconds; then a cell is a look-up.
///
/// Parameters
/// ----------
/// robot : path
///     A robot file with masses and widths.
/// soil : Soil
/// cell_m : float
///     Size of the cells, m, 0.001 to 1000.
/// headings : int, optional
///     4, 8 or 16; 8 by default.
/// gravity_m_per_s2 : float, optional
///     The robot file's, else the Earth's.
/// max_pitch_deg, max_roll_deg : float
///     The steepest pose that is computed, 1 to 45 degrees.
/// soil_intervals : path, optional
///     A file of 95 % intervals: soils are drawn from them. Without it every probability is 0 or 1.
/// soil_draws : int, optional
///     How many, 1 to 4096; 64 by default.
/// seed : int, optional
///     Of the draws; 1 by default.
/// cvar_level : float
///     The share of the draws beyond which `energy_cvar_j_per_m` is the mean, 0 to 0.999.
/// threads : int, optional
///     That make the tables; as many as the machine runs by default.
///
/// Raises
/// ------
/// OSError
///     A file cannot be read.
/// InputError
///     What a file has wrong, a number outside its limits, a robot that does not move on level ground.
#[pyclass(frozen, module = "grouser._core")]
pub(crate) struct SlipMapper {
    recipe: Recipe,
    maker: terrain::MapMaker,
    layout: MapLayout,
}

#[pymethods]
impl SlipMapper {
    #[new]
    #[pyo3(signature = (robot, soil, *, cell_m, headings=None, gravity_m_per_s2=None, max_pitch_deg=30.0,
        max_roll_deg=25.0, soil_intervals=None, soil_draws=None, seed=None, cvar_level=0.9, threads=None))]
    #[allow(
        clippy::too_many_arguments,
        reason = "keywords of a Python constructor"
    )]
    fn new(
        py: Python<'_>,
        #[pyo3(from_py_with = argument::path)] robot: PathBuf,
        #[pyo3(from_py_with = argument::object)] soil: Soil,
        #[pyo3(from_py_with = argument::number)] cell_m: f64,
        headings: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument::optional_number)] gravity_m_per_s2: Option<f64>,
        #[pyo3(from_py_with = argument::number)] max_pitch_deg: f64,
        #[pyo3(from_py_with = argument::number)] max_roll_deg: f64,
        #[pyo3(from_py_with = argument::optional_path)] soil_intervals: Option<PathBuf>,
        soil_draws: Option<Bound<'_, PyAny>>,
        seed: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument::number)] cvar_level: f64,
        threads: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        check("cell_m", cell_m, (1e-3, 1e3), "m")?;
        let gravity = gravity_m_per_s2.unwrap_or(terra::EARTH_GRAVITY_M_PER_S2);
        check("gravity_m_per_s2", gravity, GRAVITY_LIMITS_M_PER_S2, "m/s²")?;
        let headings = given("headings", headings, (4, 16), 8)?;
        let soil_draws = given("soil_draws", soil_draws, (1, 4096), 64)?;
        let seed = given("seed", seed, (0, i64::MAX), 1)?;
        let threads = given("threads", threads, (1, 1024), 0)?;
        let absolute = |path: PathBuf| std::path::absolute(path);
        let recipe = Recipe {
            robot: absolute(robot)?,
            soil,
            cell_m,
            headings,
            gravity_m_per_s2,
            max_pitch_deg,
            max_roll_deg,
            soil_intervals: soil_intervals.map(absolute).transpose()?,
            soil_draws,
            seed,
            cvar_level,
        };
        let own = recipe.clone();
        let made = workers::interruptible(py, threads, move || own.maker(), || {})?;
        let (maker, layout) = raised(made)?;
        Ok(Self {
            recipe,
            maker,
            layout,
        })
    }

    /// Cells around a cell that its numbers depend on: the overlap of tiles.
    #[getter]
    fn reach(&self) -> u32 {
        // the cell beyond a wheel's contact takes part in its height
        self.maker.reach() + 1
    }

    /// Twice the greatest difference in slip between table and exact solver that was found between the nodes.
    #[getter]
    fn slip_error(&self) -> f64 {
        self.maker.table_error().slip
    }

    /// The slope that the robot climbs straight on, degrees: on the soil, on the weakest and on the strongest draw.
    #[getter]
    fn steepest_deg(&self) -> (f64, f64, f64) {
        self.maker.soils()[0].steepest().map(f64::to_degrees).into()
    }

    /// The directions of the headings, degrees from x (columns) towards y (against the rows).
    #[getter]
    fn headings_deg(&self) -> Vec<f64> {
        headings_deg(self.layout.headings)
    }

    /// A map of heights (rows, columns), m, with its upper left corner at a place.
    fn _map(
        &self,
        py: Python<'_>,
        heights: PyReadonlyArray2<'_, f32>,
        upper_left_m: Option<(f64, f64)>,
        threads: usize,
    ) -> PyResult<SlipMap> {
        let [rows, columns] = [0, 1].map(|axis| heights.shape()[axis]);
        let mut layout = self.layout.clone();
        if !(2..=MAX_ROWS).contains(&rows) || !(2..=MAX_COLUMNS).contains(&columns) {
            let message = format!(
                "heights_m has {rows} rows and {columns} columns, but must have 2 to {MAX_ROWS} and 2 to {MAX_COLUMNS}"
            );
            let details = Details {
                value: Some((rows, columns).into_pyobject(py)?.into_any().unbind()),
                unit: Some("1"),
                ..Details::field("heights_m")
            };
            return Err(input_error(message, details));
        }
        layout.rows = u32::try_from(rows).unwrap_or(u32::MAX);
        layout.columns = u32::try_from(columns).unwrap_or(u32::MAX);
        let (left, top) = upper_left_m.unwrap_or((0.0, self.recipe.cell_m * rows as f64));
        layout.georeference = Georeference::of_grid(self.recipe.cell_m, [left, top]);
        // the caller gives a contiguous array; it is read while other threads may run
        let heights: Vec<f32> = heights.as_array().iter().copied().collect();
        let window = Window::new(layout.columns, &heights);
        let bands = layout.bands();
        let threads = workers::count(threads, rows * columns * layout.headings.count());
        let block = (threads * CELLS_PER_BLOCK).div_ceil(columns).max(threads);
        let mut cells = Vec::with_capacity(rows * columns * bands);
        for first in (0..rows).step_by(block) {
            let end = rows.min(first + block);
            let share = (end - first).div_ceil(threads);
            let jobs: Vec<_> = (first..end)
                .step_by(share)
                .map(|from| {
                    let own = u32::try_from(from).unwrap_or(u32::MAX)
                        ..u32::try_from(end.min(from + share)).unwrap_or(u32::MAX);
                    let (maker, window) = (&self.maker, &window);
                    move || maker.rows(window, own)
                })
                .collect();
            for part in workers::run(py, jobs) {
                cells.extend(raised(part)?);
            }
            py.check_signals()?;
        }
        Ok(SlipMap { layout, cells })
    }

    fn __repr__(&self) -> String {
        format!(
            "SlipMapper(robot={:?}, soil={:?}, cell_m={}, headings={})",
            self.layout.robot, self.layout.soils[0], self.recipe.cell_m, self.recipe.headings
        )
    }

    /// A mapper is pickled as what it was made of: the other process makes the tables anew.
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyDict>,))> {
        let recipe = &slf.get().recipe;
        let keys = PyDict::new(slf.py());
        keys.set_item("robot", &recipe.robot)?;
        keys.set_item("soil", recipe.soil.clone())?;
        keys.set_item("cell_m", recipe.cell_m)?;
        keys.set_item("headings", recipe.headings)?;
        keys.set_item("gravity_m_per_s2", recipe.gravity_m_per_s2)?;
        keys.set_item("max_pitch_deg", recipe.max_pitch_deg)?;
        keys.set_item("max_roll_deg", recipe.max_roll_deg)?;
        keys.set_item("soil_intervals", &recipe.soil_intervals)?;
        keys.set_item("soil_draws", recipe.soil_draws)?;
        keys.set_item("seed", recipe.seed)?;
        keys.set_item("cvar_level", recipe.cvar_level)?;
        Ok((slf.get_type().getattr("_remade")?, (keys,)))
    }

    #[classmethod]
    fn _remade<'py>(
        class: &Bound<'py, PyType>,
        keys: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, PyAny>> {
        class.call((), Some(keys))
    }
}

pub(crate) fn check(
    field: &'static str,
    value: f64,
    limits: (f64, f64),
    unit: &'static str,
) -> PyResult<()> {
    raised(terra::OutOfRange::check(field, value, limits, unit).map_err(terra::Error::from))
}

/// A keyword that may be left out.
fn given<T: TryFrom<i64>>(
    field: &'static str,
    value: Option<Bound<'_, PyAny>>,
    limits: (i64, i64),
    default: T,
) -> PyResult<T> {
    value.map_or(Ok(default), |value| whole(field, &value, limits))
}

/// A whole number within limits that its type holds.
fn whole<T: TryFrom<i64>>(
    field: &'static str,
    value: &Bound<'_, PyAny>,
    limits: (i64, i64),
) -> PyResult<T> {
    let wrong = || type_error(format!("{field} must be a whole number"), field);
    if value.is_instance_of::<PyBool>() {
        return Err(wrong());
    }
    let range = (limits.0 as f64, limits.1 as f64);
    let found = match value.extract::<i64>() {
        Ok(found) => found,
        Err(error) if error.is_instance_of::<PyOverflowError>(value.py()) => {
            check(field, f64::INFINITY, range, "1")?;
            return Err(wrong());
        }
        Err(_) => return Err(wrong()),
    };
    check(field, found as f64, range, "1")?;
    T::try_from(found).map_err(|_| wrong())
}

pub(crate) fn headings_deg(headings: Headings) -> Vec<f64> {
    (0..headings.count())
        .map(|heading| headings.angle(heading).to_degrees())
        .collect()
}
