//! Soils: of the catalogue, of a file, of keywords.

use std::path::PathBuf;

use grouser::files::{Document, soil as soil_file};
use grouser::terra::catalogue::{self, Completion};
use grouser::terra::{self, Pressure};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyType};

use crate::argument;
use crate::error::{Details, input_error, raised};
use crate::settings_text::{document, without_place};

/// A soil whose every number was checked.
///
/// The keywords are the keys of a soil file, with the same units: `name`, `n`, `k_c_kn_per_m_n1`,
/// `k_phi_kn_per_m_n2`, `cohesion_kpa`, `phi_deg`, `k_shear_m`, `c_1`, `c_2`; optional are `source`, `note`,
/// `key`, `n_1`, `n_2`, `unit_weight_n_per_m3`, `rebound`, `k_shear_1_m_per_rad`, `k_shear_side_m`,
/// `k_shear_side_1_m_per_rad`, `rear_driving`, `rear_drift`, `transport_layer_m`, `sideways_support` and the laws
/// `slip_sinkage`, `stress_position`, `shear`, `bulldozing`.
///
/// Raises
/// ------
/// InputError
///     A number outside its limits, a missing or unknown key.
/// InputTypeError
///     A value that is no number or no text where one is needed.
///
/// Examples
/// --------
/// >>> from grouser.soils import Soil
/// >>> sand = Soil(name="test bed", n=1.1, k_c_kn_per_m_n1=0.9, k_phi_kn_per_m_n2=1528.4,
/// ...             cohesion_kpa=1.0, phi_deg=30.0, k_shear_m=0.025, c_1=0.18, c_2=0.32)
/// >>> sand.cohesion_kpa
/// 1.0
#[pyclass(frozen, eq, from_py_object, module = "grouser._core")]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Soil {
    file: soil_file::SoilFile,
    pub(crate) soil: terra::Soil,
}

impl Soil {
    fn from_document(document: &Document, completion: &Completion) -> PyResult<Self> {
        let file = raised(soil_file::parse(document))?;
        let soil = raised(file.completed(completion))?;
        Ok(Self::with_file(&file, soil))
    }

    fn with_file(file: &soil_file::SoilFile, soil: terra::Soil) -> Self {
        let mut own = soil_file::SoilFile::new(&file.name, &file.source, *soil.params());
        own.key.clone_from(&file.key);
        own.note.clone_from(&file.note);
        Self { file: own, soil }
    }

    fn of_catalogue(entry: &catalogue::Entry, soil: terra::Soil) -> Self {
        let mut file = soil_file::SoilFile::new(entry.name, entry.source, *soil.params());
        file.key = Some(entry.key.to_owned());
        file.note = entry.note.to_owned();
        Self { file, soil }
    }

    fn params(&self) -> &terra::SoilParams {
        self.soil.params()
    }

    fn bekker(&self) -> (f64, f64) {
        match self.params().pressure {
            Pressure::Bekker(law) => (law.k_c, law.k_phi),
            Pressure::Reece(_) => (f64::NAN, f64::NAN),
        }
    }
}

#[pymethods]
impl Soil {
    #[new]
    #[pyo3(signature = (**keys))]
    fn new(py: Python<'_>, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let document = document("Soil", keys)?;
        Self::from_document(&document, &Completion::default())
            .map_err(|error| without_place(py, document.name(), error))
    }

    /// A soil of the catalogue. Numbers that its source does not give have to be given; what is given
    /// goes before the source.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     An unknown key, a number that is missing, or one outside its limits.
    ///
    /// Examples
    /// --------
    /// >>> from grouser.soils import Soil
    /// >>> Soil.find("lunar").phi_deg
    /// 30.0
    #[staticmethod]
    #[pyo3(signature = (key, *, k_shear_m=None, c_1=None, c_2=None, unit_weight_n_per_m3=None))]
    fn find(
        #[pyo3(from_py_with = argument::text)] key: String,
        #[pyo3(from_py_with = argument::optional_number)] k_shear_m: Option<f64>,
        #[pyo3(from_py_with = argument::optional_number)] c_1: Option<f64>,
        #[pyo3(from_py_with = argument::optional_number)] c_2: Option<f64>,
        #[pyo3(from_py_with = argument::optional_number)] unit_weight_n_per_m3: Option<f64>,
    ) -> PyResult<Self> {
        let Some(entry) = catalogue::find(&key) else {
            let keys: Vec<&str> = catalogue::entries().iter().map(|entry| entry.key).collect();
            let message = format!("key is `{key}`, but must be one of {}", keys.join(", "));
            let value = Python::attach(|py| PyString::new(py, &key).into_any().unbind());
            let details = Details {
                value: Some(value),
                ..Details::field("key")
            };
            return Err(input_error(message, details));
        };
        let soil = raised(entry.completed(&Completion {
            k_shear: k_shear_m,
            c_1,
            c_2,
            unit_weight: unit_weight_n_per_m3,
        }))?;
        Ok(Self::of_catalogue(entry, soil))
    }

    /// Reads a soil file (TOML). K, c_1 and c_2 may be given where the file leaves them open.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     The file cannot be read.
    /// InputError
    ///     What the file lacks or has wrong, with its line.
    #[staticmethod]
    #[pyo3(signature = (path, *, k_shear_m=None, c_1=None, c_2=None, unit_weight_n_per_m3=None))]
    fn read(
        #[pyo3(from_py_with = argument::path)] path: PathBuf,
        #[pyo3(from_py_with = argument::optional_number)] k_shear_m: Option<f64>,
        #[pyo3(from_py_with = argument::optional_number)] c_1: Option<f64>,
        #[pyo3(from_py_with = argument::optional_number)] c_2: Option<f64>,
        #[pyo3(from_py_with = argument::optional_number)] unit_weight_n_per_m3: Option<f64>,
    ) -> PyResult<Self> {
        let completion = Completion {
            k_shear: k_shear_m,
            c_1,
            c_2,
            unit_weight: unit_weight_n_per_m3,
        };
        Self::from_document(&raised(Document::read(&path))?, &completion)
    }

    /// A soil from the text of a soil file.
    #[staticmethod]
    fn from_toml(#[pyo3(from_py_with = argument::text)] text: String) -> PyResult<Self> {
        let document = raised(Document::from_text("soil", text))?;
        Self::from_document(&document, &Completion::default())
    }

    /// The text of a soil file that reads back to the same numbers, bit for bit.
    fn to_toml(&self) -> PyResult<String> {
        raised(soil_file::to_toml(&self.file, &[]))
    }

    /// The same soil with another rebound ratio (0 to 100).
    #[pyo3(signature = (*, rebound))]
    fn with_rebound(
        &self,
        #[pyo3(from_py_with = argument::number)] rebound: f64,
    ) -> PyResult<Self> {
        let soil = raised(self.soil.with_rebound(rebound))?;
        Ok(Self::with_file(&self.file, soil))
    }

    /// The key in the catalogue, or of the file.
    #[getter]
    fn key(&self) -> Option<&str> {
        self.file.key.as_deref()
    }

    /// The name.
    #[getter]
    pub(crate) fn name(&self) -> &str {
        &self.file.name
    }

    /// Where the numbers come from; empty if unknown.
    #[getter]
    fn source(&self) -> &str {
        &self.file.source
    }

    /// What is doubtful or worth knowing; empty if nothing.
    #[getter]
    fn note(&self) -> &str {
        &self.file.note
    }

    /// Sinkage exponent without slip.
    #[getter]
    fn n(&self) -> f64 {
        self.params().n
    }

    /// Growth of the sinkage exponent with driving slip.
    #[getter]
    fn n_1(&self) -> f64 {
        self.params().n_1
    }

    /// Growth of the sinkage exponent with braking slip.
    #[getter]
    fn n_2(&self) -> f64 {
        self.params().n_2
    }

    /// Bekker's cohesive modulus, kN/m^(n+1).
    #[getter]
    fn k_c_kn_per_m_n1(&self) -> f64 {
        self.bekker().0 / 1e3
    }

    /// Bekker's frictional modulus, kN/m^(n+2).
    #[getter]
    fn k_phi_kn_per_m_n2(&self) -> f64 {
        self.bekker().1 / 1e3
    }

    /// Cohesion, kPa.
    #[getter]
    fn cohesion_kpa(&self) -> f64 {
        self.params().cohesion / 1e3
    }

    /// Angle of internal friction, degrees.
    #[getter]
    fn phi_deg(&self) -> f64 {
        // through the text of a file, which has the degrees that read back to the same radians
        let deg = self.params().phi.deg();
        let shorter = (deg * 1e9).round() / 1e9;
        let same = terra::Angle::from_deg(shorter).rad() == self.params().phi.rad();
        if same { shorter } else { deg }
    }

    /// Shear deformation modulus, m.
    #[getter]
    fn k_shear_m(&self) -> f64 {
        self.params().k_shear
    }

    /// The greatest stress is at (c_1 + c_2 s) times the entry angle.
    #[getter]
    fn c_1(&self) -> f64 {
        self.params().c_1
    }

    /// The greatest stress is at (c_1 + c_2 s) times the entry angle.
    #[getter]
    fn c_2(&self) -> f64 {
        self.params().c_2
    }

    /// Rebound ratio: the soil behind the wheel rises by this share of the sinkage.
    #[getter]
    fn rebound(&self) -> f64 {
        self.params().rebound
    }

    /// Unit weight, N/m³; `None` if unknown.
    #[getter]
    fn unit_weight_n_per_m3(&self) -> Option<f64> {
        self.params().unit_weight
    }

    fn __repr__(&self) -> String {
        format!(
            "Soil(name={:?}, n={}, cohesion_kpa={}, phi_deg={}, k_shear_m={})",
            self.file.name,
            self.n(),
            self.cohesion_kpa(),
            self.phi_deg(),
            self.k_shear_m()
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let read: Bound<'py, PyType> = slf.get_type();
        Ok((read.getattr("from_toml")?, (slf.get().to_toml()?,)))
    }
}

/// The keys of the catalogue.
#[pyfunction]
pub(crate) fn catalogue_keys() -> Vec<&'static str> {
    catalogue::entries().iter().map(|entry| entry.key).collect()
}
