//! Many drives side by side, for learning: commands in and observations out as arrays.

use grouser::rover::drive::{self, Frame, Outcome, Pilot};
use grouser::slip::control::WheelCommand;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray3};
use pyo3::prelude::*;

use crate::argument;
use crate::drive::Scenario;
use crate::error::raised;
use crate::workers;

/// Columns of an observation that belong to the robot.
const ROBOT_COLUMNS: usize = 6;
/// Columns of each wheel.
const WHEEL_COLUMNS: usize = 6;

/// Periods of all drives between two looks at signals: of 64 robots 0.2 s of work.
const PERIODS_PER_BLOCK: usize = 10;
/// Drives that a thread begins between two looks at signals, 4 to 8 ms each.
const STARTS_PER_THREAD: usize = 16;

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
    fn new(
        py: Python<'_>,
        #[pyo3(from_py_with = argument::object)] scenario: Scenario,
        seeds: Vec<u64>,
        threads: usize,
    ) -> PyResult<Self> {
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
        let mut done = 0;
        while done < periods {
            let now = PERIODS_PER_BLOCK.min(periods - done);
            let jobs: Vec<_> = self
                .places
                .chunks_mut(share)
                .zip(commands.chunks(share).zip(moves.chunks(share)))
                .map(|(places, (commands, moves))| {
                    move || {
                        let mut pairs = places.iter_mut().zip(commands).zip(moves);
                        pairs.try_for_each(|((place, commands), moves)| {
                            place.advance(commands, if *moves { now } else { 0 })
                        })
                    }
                })
                .collect();
            for ended in workers::run(py, jobs) {
                raised(ended)?;
            }
            py.check_signals()?;
            done += now;
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
        let mut out = Vec::with_capacity(seeds.len());
        for block in seeds.chunks(self.threads * STARTS_PER_THREAD) {
            let jobs: Vec<_> = block
                .chunks(block.len().div_ceil(self.threads))
                .map(|seeds| {
                    || {
                        let places = seeds.iter().map(|seed| Place::new(&self.scenario, *seed));
                        places.collect::<grouser::rover::Result<Vec<_>>>()
                    }
                })
                .collect();
            for made in workers::run(py, jobs) {
                out.extend(raised(made)?);
            }
            py.check_signals()?;
        }
        Ok(out)
    }
}
