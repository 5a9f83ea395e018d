//! The wheel.

use grouser::terra::{GrouserRule, Grousers, RigidWheel};
use pyo3::prelude::*;

use crate::argument;
use crate::error::{Details, input_error, raised};

/// A rigid wheel.
///
/// Parameters
/// ----------
/// radius_m : float
///     Radius of the rim, m, 0.001 to 100.
/// width_m : float
///     Width, m, 0.001 to 100.
/// grouser_height_m : float
///     Height of the grousers above the rim, m; 0 for a smooth wheel.
/// grouser_count : int or None
///     Number of grousers around the rim: they carry soil backwards and add thrust, and every law refers to the rim's
///     radius. The rule that was compared with measured wheels.
/// grouser_thickness_m : float
///     Thickness of a grouser along the rim, m; needs `grouser_count`.
/// grouser_tip_share : float or None
///     Instead of a count, the share of the surface that is grouser tip, 0 to 1: the normal stress is averaged by it.
///     Without either, closely spaced grousers act as a drum at the radius of their tips.
///
/// Raises
/// ------
/// InputError
///     A number outside its limits.
///
/// Examples
/// --------
/// >>> from grouser.wheel import Wheel
/// >>> Wheel(radius_m=0.125, width_m=0.1)
/// Wheel(radius_m=0.125, width_m=0.1)
#[pyclass(frozen, eq, from_py_object, module = "grouser._core")]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wheel(pub(crate) RigidWheel);

#[pymethods]
impl Wheel {
    #[new]
    #[pyo3(signature = (*, radius_m, width_m, grouser_height_m=0.0, grouser_count=None, grouser_thickness_m=0.0, grouser_tip_share=None))]
    fn new(
        #[pyo3(from_py_with = argument::number)] radius_m: f64,
        #[pyo3(from_py_with = argument::number)] width_m: f64,
        #[pyo3(from_py_with = argument::number)] grouser_height_m: f64,
        #[pyo3(from_py_with = argument::optional_count)] grouser_count: Option<u32>,
        #[pyo3(from_py_with = argument::number)] grouser_thickness_m: f64,
        #[pyo3(from_py_with = argument::optional_number)] grouser_tip_share: Option<f64>,
    ) -> PyResult<Self> {
        let wheel = raised(RigidWheel::new(radius_m, width_m))?;
        let rule = match (grouser_count, grouser_tip_share) {
            (Some(count), None) => GrouserRule::Lugs {
                count: f64::from(count),
                thickness: grouser_thickness_m,
            },
            (Some(_), Some(_)) => {
                return Err(input_error(
                    "`grouser_count` and `grouser_tip_share` exclude each other".to_owned(),
                    Details::field("grouser_count"),
                ));
            }
            (None, _) if grouser_thickness_m != 0.0 => {
                return Err(input_error(
                    "`grouser_thickness_m` needs `grouser_count`".to_owned(),
                    Details::field("grouser_thickness_m"),
                ));
            }
            (None, Some(tips)) => GrouserRule::AreaShare { tips },
            (None, None) if grouser_height_m == 0.0 => return Ok(Self(wheel)),
            (None, None) => GrouserRule::Tips,
        };
        raised(wheel.with_grousers(Grousers {
            height: grouser_height_m,
            rule,
        }))
        .map(Self)
    }

    /// Radius of the rim, m.
    #[getter]
    fn radius_m(&self) -> f64 {
        self.0.radius()
    }

    /// Width, m.
    #[getter]
    fn width_m(&self) -> f64 {
        self.0.width()
    }

    /// Height of the grousers, m; 0 for a smooth wheel.
    #[getter]
    fn grouser_height_m(&self) -> f64 {
        self.0.grousers().map_or(0.0, |grousers| grousers.height)
    }

    /// Number of grousers; `None` where they are not counted.
    #[getter]
    fn grouser_count(&self) -> Option<f64> {
        match self.0.grousers()?.rule {
            GrouserRule::Lugs { count, .. } => Some(count),
            GrouserRule::Tips | GrouserRule::AreaShare { .. } => None,
        }
    }

    /// Thickness of a grouser along the rim, m; 0 where they are not counted.
    #[getter]
    fn grouser_thickness_m(&self) -> f64 {
        match self.0.grousers().map(|grousers| grousers.rule) {
            Some(GrouserRule::Lugs { thickness, .. }) => thickness,
            Some(GrouserRule::Tips | GrouserRule::AreaShare { .. }) | None => 0.0,
        }
    }

    /// The share of the surface that is grouser tip; `None` where the grousers are counted or act as a drum.
    #[getter]
    fn grouser_tip_share(&self) -> Option<f64> {
        match self.0.grousers()?.rule {
            GrouserRule::AreaShare { tips } => Some(tips),
            GrouserRule::Tips | GrouserRule::Lugs { .. } => None,
        }
    }

    fn __repr__(&self) -> String {
        let mut text = format!(
            "Wheel(radius_m={}, width_m={}",
            self.radius_m(),
            self.width_m()
        );
        if self.0.grousers().is_some() {
            text += &format!(", grouser_height_m={}", self.grouser_height_m());
            if let Some(count) = self.grouser_count() {
                text += &format!(
                    ", grouser_count={count:.0}, grouser_thickness_m={}",
                    self.grouser_thickness_m()
                );
            }
            if let Some(share) = self.grouser_tip_share() {
                text += &format!(", grouser_tip_share={share}");
            }
        }
        text + ")"
    }

    fn __getnewargs_ex__(&self, py: Python<'_>) -> PyResult<((), Py<pyo3::types::PyDict>)> {
        let keys = pyo3::types::PyDict::new(py);
        keys.set_item("radius_m", self.radius_m())?;
        keys.set_item("width_m", self.width_m())?;
        keys.set_item("grouser_height_m", self.grouser_height_m())?;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the constructor takes a whole number"
        )]
        let count = self.grouser_count().map(|count| count as u32);
        keys.set_item("grouser_count", count)?;
        keys.set_item("grouser_thickness_m", self.grouser_thickness_m())?;
        keys.set_item("grouser_tip_share", self.grouser_tip_share())?;
        Ok(((), keys.unbind()))
    }
}
