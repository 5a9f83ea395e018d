//! Wheels of another simulator on this soil: the forces of all wheels at a step in time.

use grouser::rover::dynamics::{
    CONTACT_REACH_SHARE, ContactFrame, SoilUnder, WheelContact, WheelMotionNow,
};
use grouser::rover::vector::Vector;
use grouser::terra::{Accuracy, Settings, WheelOnSoil};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::argument;
use crate::error::raised;
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Numbers of a wheel's state: centre, axle, velocity of the centre (x, y, z each), spin.
const STATE: usize = 10;
/// Heights at the places under a wheel: before, behind, left and right of its centre.
const HEIGHTS: usize = 4;
/// Height where there is no ground, m: below every wheel.
const NO_GROUND_M: f64 = -1e9;

/// The contacts of several wheels with one soil over time, by the laws of `grouser drive`.
///
/// The public class is `grouser.mujoco.SoftGround`.
#[pyclass(module = "grouser._core")]
#[derive(Debug)]
pub(crate) struct GroundContacts {
    wheels: Vec<(WheelOnSoil, WheelContact)>,
}

#[pymethods]
impl GroundContacts {
    #[new]
    fn new(
        #[pyo3(from_py_with = argument::object)] soil: Soil,
        wheels: Vec<Wheel>,
    ) -> PyResult<Self> {
        let settings = Settings {
            accuracy: Accuracy::Simulation,
            ..Settings::default()
        };
        let on = |wheel: Wheel| raised(WheelOnSoil::new(wheel.0, soil.soil, settings));
        let fresh = |pair| (pair, WheelContact::default());
        let wheels = wheels.into_iter().map(|wheel| on(wheel).map(fresh));
        let wheels = wheels.collect::<PyResult<_>>()?;
        Ok(Self { wheels })
    }

    /// Forgets what the contacts remember.
    fn reset(&mut self) {
        for (_, contact) in &mut self.wheels {
            *contact = WheelContact::default();
        }
    }

    /// The places at which `step` needs the height of the ground, x and y of each.
    fn places<'py>(
        &self,
        py: Python<'py>,
        states: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let states = states.as_slice()?.as_chunks::<STATE>().0;
        let places = self
            .wheels
            .iter()
            .zip(states)
            .flat_map(|((pair, _), state)| {
                let [x, y, _, across_x, across_y, ..] = *state;
                let (cos, sin) = course(across_x, across_y);
                let reach = CONTACT_REACH_SHARE * pair.wheel().running_radius();
                let aside = 0.5 * pair.wheel().width();
                let (a, b) = ([reach * cos, reach * sin], [-aside * sin, aside * cos]);
                let (fore, aft) = ([x + a[0], y + a[1]], [x - a[0], y - a[1]]);
                let (left, right) = ([x + b[0], y + b[1]], [x - b[0], y - b[1]]);
                [fore, aft, left, right].into_iter().flatten()
            });
        Ok(PyArray1::from_iter(py, places))
    }

    /// Moves all contacts on by `step_s`; `heights` are those of the ground at the places, NaN where there is none. Fifteen
    /// numbers of each wheel: force and moment about the centre (x, y, z each), sinkage, normal force, pull, side force, torque,
    /// speed forwards, speed to the left, wheel speed, and 1 where the hub is about to be buried.
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        states: PyReadonlyArray1<'py, f64>,
        heights: PyReadonlyArray1<'py, f64>,
        step_s: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let states = states.as_slice()?.as_chunks::<STATE>().0;
        let heights = heights.as_slice()?.as_chunks::<HEIGHTS>().0;
        let inputs = states.iter().zip(heights);
        let results = self.wheels.iter_mut().zip(inputs);
        let results = results.flat_map(|((pair, contact), (state, heights))| {
            let is_ground = heights.iter().all(|height| height.is_finite());
            let heights = if is_ground {
                *heights
            } else {
                [NO_GROUND_M; HEIGHTS]
            };
            advance(pair, contact, state, heights, step_s)
                .into_iter()
                .flatten()
        });
        Ok(PyArray1::from_vec(py, results.collect()))
    }
}

/// The direction along a wheel on the level, by its axle: cosine and sine.
fn course(across_x: f64, across_y: f64) -> (f64, f64) {
    let per_level = 1.0 / grouser::real::Real::hypot(across_x, across_y).max(f64::MIN_POSITIVE);
    (across_y * per_level, -across_x * per_level)
}

/// Moves one contact on.
fn advance(
    pair: &WheelOnSoil,
    contact: &mut WheelContact,
    state: &[f64; STATE],
    [fore, aft, left, right]: [f64; HEIGHTS],
    step_s: f64,
) -> [[f64; 3]; 5] {
    let [_, _, z, axle_x, axle_y, axle_z, v_x, v_y, v_z, spin] = *state;
    let (axle, velocity) = (
        Vector::new(axle_x, axle_y, axle_z),
        Vector::new(v_x, v_y, v_z),
    );
    let radius = pair.wheel().running_radius();
    let along = (fore - aft) / (2.0 * CONTACT_REACH_SHARE * radius);
    let across = (left - right) / pair.wheel().width();
    let (cos, sin) = course(axle_x, axle_y);
    let (slope_x, slope_y) = (along * cos - across * sin, along * sin + across * cos);
    let frame = ContactFrame::new(axle, Vector::new(-slope_x, -slope_y, 1.0).unit());
    let height = (z - 0.25 * (fore + aft + left + right)) * frame.up.z * frame.per_lean;
    let motion = WheelMotionNow {
        sinkage: radius - height,
        sinking: -velocity.dot(frame.up) * frame.per_lean,
        velocity: [velocity.dot(frame.forward), velocity.dot(frame.left)],
        rim: radius * spin,
    };
    let load = contact.step(pair, &SoilUnder::default(), &motion, step_s);
    let (force, moment) = frame.force_and_moment(&load, height, radius);
    let moment = moment - axle * load.torque;
    let buried = f64::from(u8::from(load.buried));
    [
        [force.x, force.y, force.z],
        [moment.x, moment.y, moment.z],
        [motion.sinkage, load.normal, load.along],
        [load.across, load.torque, motion.velocity[0]],
        [motion.velocity[1], motion.rim, buried],
    ]
}
