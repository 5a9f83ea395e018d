//! Slip maps of elevation models, and ways over them.

use std::path::PathBuf;

use grouser::files::Document;
use grouser::files::gravity::GRAVITY_LIMITS_M_PER_S2;
use grouser::rover::ground::Georeference;
use grouser::rover::robot::RobotModel;
use grouser::terra;
use grouser::terrain::plan::{self, Plan, PlanMap, PlanSettings, Route};
use grouser::terrain::raster::Window;
use grouser::terrain::{
    self, Band, DemandSolver, Envelope, Headings, MapLayout, MapSettings, Quantity, SlipTable,
    SoilIntervals,
};
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyOverflowError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyType};
use rayon::prelude::*;

use crate::argument;
use crate::error::{Details, input_error, raised, type_error};
use crate::soil::Soil;
use crate::workers;

/// Cells that each thread computes between two looks at signals.
const CELLS_PER_BLOCK: usize = 4096;

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
        robot: PathBuf,
        #[pyo3(from_py_with = argument::object)] soil: Soil,
        #[pyo3(from_py_with = argument::number)] cell_m: f64,
        headings: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = argument::optional_number)] gravity_m_per_s2: Option<f64>,
        #[pyo3(from_py_with = argument::number)] max_pitch_deg: f64,
        #[pyo3(from_py_with = argument::number)] max_roll_deg: f64,
        soil_intervals: Option<PathBuf>,
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
        check("rows", rows as f64, (2.0, f64::from(1 << 24)), "1")?;
        check("columns", columns as f64, (2.0, f64::from(1 << 16)), "1")?;
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

fn check(field: &'static str, value: f64, limits: (f64, f64), unit: &'static str) -> PyResult<()> {
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

fn headings_deg(headings: Headings) -> Vec<f64> {
    (0..headings.count())
        .map(|heading| headings.angle(heading).to_degrees())
        .collect()
}

/// A pickled map.
#[derive(FromPyObject, IntoPyObject)]
#[pyo3(from_item_all)]
struct State<'py> {
    /// Rows, columns, headings.
    size: (u32, u32, usize),
    /// Cell (m), turning radius (m), gravity (m/s²), level of the CVaR.
    numbers: (f64, f64, f64, f64),
    scale: Vec<f64>,
    tie_points: Vec<f64>,
    transformation: Vec<f64>,
    keys: Vec<u16>,
    key_doubles: Vec<f64>,
    key_texts: String,
    draws: u32,
    robot: String,
    soils: Vec<String>,
    job: String,
    cells: Bound<'py, PyArray1<f32>>,
}

/// A slip map: what `SlipMapper` computed or `grouser map` wrote.
#[pyclass(frozen, module = "grouser._core")]
pub(crate) struct SlipMap {
    layout: MapLayout,
    cells: Vec<f32>,
}

#[pymethods]
impl SlipMap {
    /// Reads the GeoTIFF that `grouser map` wrote.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     The file cannot be read.
    /// InputError
    ///     A damaged file, or another GeoTIFF.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let (layout, cells) = raised(py.detach(|| plan::read_map(&path)))?;
        Ok(Self { layout, cells })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (State<'py>,))> {
        let Self { layout, cells } = slf.get();
        let place = &layout.georeference;
        let state = State {
            size: (layout.rows, layout.columns, layout.headings.count()),
            numbers: (
                layout.cell,
                layout.turning_radius,
                layout.gravity,
                layout.cvar_level,
            ),
            scale: place.scale.clone(),
            tie_points: place.tie_points.clone(),
            transformation: place.transformation.clone(),
            keys: place.keys.clone(),
            key_doubles: place.key_doubles.clone(),
            key_texts: place.key_texts.clone(),
            draws: layout.draws,
            robot: layout.robot.clone(),
            soils: layout.soils.clone(),
            job: layout.job.clone(),
            cells: PyArray1::from_slice(slf.py(), cells),
        };
        Ok((slf.get_type().getattr("_again")?, (state,)))
    }

    #[staticmethod]
    fn _again(state: State<'_>) -> PyResult<Self> {
        let (rows, columns, headings) = state.size;
        let headings = raised(Headings::new(u8::try_from(headings).unwrap_or(u8::MAX)))?;
        let mut layout = MapLayout::plain(columns, rows, state.numbers.0, headings);
        (_, layout.turning_radius, layout.gravity, layout.cvar_level) = state.numbers;
        let place = &mut layout.georeference;
        place.scale = state.scale;
        place.tie_points = state.tie_points;
        place.transformation = state.transformation;
        place.keys = state.keys;
        place.key_doubles = state.key_doubles;
        place.key_texts = state.key_texts;
        layout.draws = state.draws;
        layout.robot = state.robot;
        layout.soils = state.soils;
        layout.job = state.job;
        let cells = state.cells.to_vec()?;
        let (found, expected) = (
            cells.len() as f64,
            f64::from(rows) * f64::from(columns) * layout.bands() as f64,
        );
        check("cells", found, (expected, expected), "1")?;
        Ok(Self { layout, cells })
    }

    /// Headings, rows and columns.
    #[getter]
    fn shape(&self) -> (usize, usize, usize) {
        let MapLayout { rows, columns, .. } = self.layout;
        (
            self.layout.headings.count(),
            rows as usize,
            columns as usize,
        )
    }

    /// Size of a cell, m.
    #[getter]
    fn cell_m(&self) -> f64 {
        self.layout.cell
    }

    /// The directions of the headings, degrees from x (columns) towards y (against the rows).
    #[getter]
    fn headings_deg(&self) -> Vec<f64> {
        headings_deg(self.layout.headings)
    }

    /// The robot's name.
    #[getter]
    fn robot(&self) -> &str {
        &self.layout.robot
    }

    /// The names of the soils, by the quantity `soil`.
    #[getter]
    fn soils(&self) -> Vec<String> {
        self.layout.soils.clone()
    }

    /// Soil draws behind the probabilities; 0: the soil is taken for exactly known.
    #[getter]
    fn soil_draws(&self) -> u32 {
        self.layout.draws
    }

    /// A quantity of `grouser.terrain.QUANTITIES`: an array (headings, rows, columns), NaN where the ground is unknown.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     Another name.
    fn quantity<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = argument::text)] name: String,
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let Some(quantity) = Quantity::ALL.into_iter().find(|own| own.key() == name) else {
            let names = Quantity::ALL.map(Quantity::key).join(", ");
            let message = format!("quantity is `{name}`, but must be one of {names}");
            return Err(input_error(message, Details::field("quantity")));
        };
        let (headings, rows, columns) = self.shape();
        let bands = self.layout.bands();
        let out = PyArray3::<f32>::zeros(py, [headings, rows, columns], false);
        {
            let mut writable = out.readwrite();
            let mut view = writable.as_array_mut();
            for (cell, values) in self.cells.chunks_exact(bands).enumerate() {
                for heading in 0..headings {
                    let band = Band { quantity, heading }.index(self.layout.headings);
                    view[[heading, cell / columns, cell % columns]] = values[band];
                }
            }
        }
        Ok(out)
    }

    #[allow(clippy::too_many_arguments, reason = "keywords of a Python function")]
    fn _plan<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        start_m: (f64, f64),
        goal_m: (f64, f64),
        max_risk: f64,
        max_slip: f64,
        min_tip_over_deg: f64,
        rim_speed_mps: f64,
        turn_energy_j: f64,
        by_cvar: bool,
        headings_deg: (Option<f64>, Option<f64>),
        alternatives: usize,
    ) -> PyResult<Bound<'py, PyDict>> {
        let headings = slf.get().layout.headings;
        let nearest = |angle: Option<f64>| angle.map(|deg| headings.nearest(deg.to_radians()));
        let settings = PlanSettings {
            max_risk,
            max_slip,
            min_tip_over_deg,
            rim_speed: rim_speed_mps,
            turn_energy: turn_energy_j,
            by_cvar,
            start_heading: nearest(headings_deg.0),
            goal_heading: nearest(headings_deg.1),
        };
        let own = slf.clone().unbind();
        let search = move || -> terrain::Result<Plan> {
            let Self { layout, cells } = own.get();
            let map = PlanMap::of_cells(layout.clone(), cells)?;
            let from = map.cell_at("the start", start_m)?;
            let to = map.cell_at("the goal", goal_m)?;
            plan::plan(&map, (from, to), &settings, alternatives)
        };
        let found = workers::interruptible(py, 0, search, || {})?;
        let dict = PyDict::new(py);
        match raised(found)? {
            Plan::Found {
                route,
                alternatives,
            } => {
                dict.set_item("route", route_dict(py, &route, headings)?)?;
                let others = alternatives
                    .iter()
                    .map(|other| route_dict(py, other, headings));
                dict.set_item("alternatives", others.collect::<PyResult<Vec<_>>>()?)?;
                dict.set_item("least_risk", py.None())?;
            }
            Plan::NoWay { least_risk } => {
                dict.set_item("route", py.None())?;
                dict.set_item("alternatives", Vec::<Py<PyAny>>::new())?;
                dict.set_item("least_risk", least_risk)?;
            }
            _ => return Err(PyRuntimeError::new_err("a plan of another kind")),
        }
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        let (headings, rows, columns) = self.shape();
        format!(
            "SlipMap({headings} headings, {rows} rows, {columns} columns, cell_m={}, robot={:?})",
            self.layout.cell, self.layout.robot
        )
    }
}

fn route_dict<'py>(
    py: Python<'py>,
    route: &Route,
    headings: Headings,
) -> PyResult<Bound<'py, PyDict>> {
    use numpy::IntoPyArray;
    let dict = PyDict::new(py);
    dict.set_item("energy_j", route.energy)?;
    dict.set_item("energy_cvar_j", route.energy_cvar)?;
    dict.set_item("time_s", route.time)?;
    dict.set_item("length_m", route.length)?;
    dict.set_item("risk", route.risk)?;
    dict.set_item("tip_over_deg", route.tip_over_deg)?;
    dict.set_item("turns", route.turns)?;
    let way = PyDict::new(py);
    type Value<'a> = &'a dyn Fn(&plan::Waypoint) -> f64;
    let columns: [(&str, Value<'_>); 8] = [
        ("x_m", &|point| point.x),
        ("y_m", &|point| point.y),
        ("heading_deg", &|point| {
            headings.angle(point.heading).to_degrees()
        }),
        ("energy_j", &|point| point.energy),
        ("time_s", &|point| point.time),
        ("length_m", &|point| point.length),
        ("slip", &|point| point.slip),
        ("risk", &|point| point.risk),
    ];
    for (name, value) in columns {
        let column: Vec<f64> = route.waypoints.iter().map(value).collect();
        way.set_item(name, column.into_pyarray(py))?;
    }
    dict.set_item("way", way)?;
    Ok(dict)
}
