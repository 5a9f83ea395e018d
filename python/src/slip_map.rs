//! A slip map, and ways over it.

use std::path::PathBuf;

use grouser::terrain::plan::{self, Plan, PlanMap, PlanSettings, Route};
use grouser::terrain::{self, Band, Headings, MapLayout, Quantity};
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument;
use crate::error::{Details, input_error, raised};
use crate::terrain::{check, headings_deg};
use crate::workers;

/// A pickled map.
#[derive(FromPyObject, IntoPyObject)]
#[pyo3(from_item_all)]
struct State<'py> {
    /// Rows, columns, headings.
    size: (u32, u32, usize),
    /// Cell (m), turning radius (m), gravity (m/s²), level of the CVaR, radius of the smallest wheel (m).
    numbers: (f64, f64, f64, f64, f64),
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
    pub(crate) layout: MapLayout,
    pub(crate) cells: Vec<f32>,
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
    fn read(
        py: Python<'_>,
        #[pyo3(from_py_with = argument::path)] path: PathBuf,
    ) -> PyResult<Self> {
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
                layout.wheel_radius,
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
        (
            _,
            layout.turning_radius,
            layout.gravity,
            layout.cvar_level,
            layout.wheel_radius,
        ) = state.numbers;
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
    dict.set_item("deep_share", route.deep_share)?;
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
