//! Many drives side by side, for learning: commands in and observations out as arrays.

use grouser::rover::drive::{self, Frame, Outcome, Pilot};
use grouser::slip::control::WheelCommand;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray3};
use pyo3::prelude::*;

use crate::drive::Scenario;
use crate::error::raised;
use crate::workers;

/// Columns of an observation that belong to the robot.
const ROBOT_COLUMNS: usize = 6;
/// Columns of each wheel.
const WHEEL_COLUMNS: usize = 6;

/// One drive and what was read of it last.
struct Place {
    drive: drive::Simulation,
    distance: f64,
    energy: f64,
    outcome: Option<Outcome>,
}

impl Place {
    fn new(scenario: &Scenario, seed: u64) -> grouser::rover::Result<Self> {
        Ok(Self {
            drive: scenario.simulation(Pilot::OpenLoop, seed)?,
            distance: 0.0,
            energy: 0.0,
            outcome: None,
        })
    }

    /// Some periods with the same commands; a drive that has ended rests.
    fn advance(&mut self, commands: &[WheelCommand], periods: usize) -> grouser::rover::Result<()> {
        for _ in 0..periods {
            if self.outcome.is_some() {
                break;
            }
            self.drive.set_commands(commands)?;
            let (mut distance, mut energy) = (self.distance, self.energy);
            let goes_on = self.drive.period(&mut |frame: &Frame<'_>| {
                (distance, energy) = (frame.distance, frame.energy);
                true
            });
            (self.distance, self.energy) = (distance, energy);
            if !goes_on {
                self.outcome = Some(self.drive.result().outcome);
            }
        }
        Ok(())
    }

    fn observe(&self, out: &mut Vec<f64>) {
        let computer = self.drive.on_board();
        let request = self.drive.request();
        let attitude = computer.attitude();
        let speed = computer.speed();
        out.extend([
            request.speed,
            request.heading - attitude.heading(),
            attitude.pitch(),
            attitude.roll(),
            speed.unwrap_or(0.0),
            f64::from(u8::from(speed.is_some())),
        ]);
        for wheel in computer.observations() {
            out.extend([
                wheel.slip.unwrap_or(0.0),
                wheel.sigma.unwrap_or(0.0),
                f64::from(u8::from(wheel.slip.is_some())),
                wheel.rim_speed.unwrap_or(0.0),
                wheel.torque_share.unwrap_or(0.0),
                wheel.load,
            ]);
        }
    }
}

/// Drives of one scenario side by side; each is the one that `Simulation` makes of its seed and commands.
#[pyclass(module = "grouser._core")]
pub(crate) struct Fleet {
    scenario: Scenario,
    places: Vec<Place>,
    wheels: usize,
    threads: usize,
}

type Step<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Vec<Option<&'static str>>,
);

#[pymethods]
impl Fleet {
    #[new]
    fn new(py: Python<'_>, scenario: Scenario, seeds: Vec<u64>, threads: usize) -> PyResult<Self> {
        let mut fleet = Self {
            wheels: scenario.wheel_count(),
            scenario,
            places: Vec::new(),
            threads: workers::at_most(threads, seeds.len()),
        };
        fleet.places = fleet.made(py, &seeds)?;
        Ok(fleet)
    }

    /// Begins some of the drives anew.
    fn reset(&mut self, py: Python<'_>, indices: Vec<usize>, seeds: Vec<u64>) -> PyResult<()> {
        let made = self.made(py, &seeds)?;
        for (index, place) in indices.into_iter().zip(made) {
            self.places[index] = place;
        }
        Ok(())
    }

    /// Rim speed (m/s), traction and steering angle (rad) of every wheel of every drive, for some periods of those that
    /// `moves` says.
    fn advance(
        &mut self,
        py: Python<'_>,
        commands: PyReadonlyArray3<'_, f64>,
        periods: usize,
        moves: Vec<bool>,
    ) -> PyResult<()> {
        let commands: Vec<Vec<WheelCommand>> = commands
            .as_array()
            .outer_iter()
            .map(|robot| {
                let wheels = robot.outer_iter();
                wheels
                    .map(|wheel| WheelCommand {
                        rim_speed: wheel[0],
                        traction: wheel[1],
                        steering_angle: wheel[2],
                    })
                    .collect()
            })
            .collect();
        let share = self.places.len().div_ceil(self.threads);
        let jobs: Vec<_> = self
            .places
            .chunks_mut(share)
            .zip(commands.chunks(share).zip(moves.chunks(share)))
            .map(|(places, (commands, moves))| {
                move || {
                    let mut pairs = places.iter_mut().zip(commands).zip(moves);
                    pairs.try_for_each(|((place, commands), moves)| {
                        place.advance(commands, if *moves { periods } else { 0 })
                    })
                }
            })
            .collect();
        for done in workers::run(py, jobs) {
            raised(done)?;
        }
        Ok(())
    }

    /// Observations (one row a drive), progress (m), energy (J) and outcomes so far.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Step<'py>> {
        let columns = ROBOT_COLUMNS + WHEEL_COLUMNS * self.wheels;
        let mut rows = Vec::with_capacity(self.places.len() * columns);
        for place in &self.places {
            place.observe(&mut rows);
        }
        let rows = rows
            .into_pyarray(py)
            .reshape([self.places.len(), columns])?;
        let column = |value: fn(&Place) -> f64| {
            let values: Vec<f64> = self.places.iter().map(value).collect();
            values.into_pyarray(py)
        };
        let outcomes = self
            .places
            .iter()
            .map(|place| place.outcome.map(Outcome::name));
        Ok((
            rows,
            column(|place| place.distance),
            column(|place| place.energy),
            outcomes.collect(),
        ))
    }
}

impl Fleet {
    fn made(&self, py: Python<'_>, seeds: &[u64]) -> PyResult<Vec<Place>> {
        let share = seeds.len().div_ceil(self.threads).max(1);
        let jobs: Vec<_> = seeds
            .chunks(share)
            .map(|seeds| {
                || {
                    let places = seeds.iter().map(|seed| Place::new(&self.scenario, *seed));
                    places.collect::<grouser::rover::Result<Vec<_>>>()
                }
            })
            .collect();
        let mut out = Vec::with_capacity(seeds.len());
        for made in workers::run(py, jobs) {
            out.extend(raised(made)?);
        }
        Ok(out)
    }
}
