//! The moments of a log through the estimator, in columns, and the changes of its wheels' states.

use std::io;

use grouser_replay::{Row, Sink, Step};

/// Columns before those of the wheels, which have a slip and its sigma each.
pub(super) const BODY_COLUMNS: [&str; 5] = ["time_s", "x_m", "y_m", "heading_deg", "speed_m_per_s"];

/// A wheel has another motion or health from a time on.
#[derive(Clone, Debug)]
pub(super) struct Change {
    pub(super) kind: &'static str,
    pub(super) wheel: usize,
    pub(super) time_s: f64,
    pub(super) name: String,
}

/// What was found of a log; a number that is not there is NaN.
#[derive(Clone, Debug)]
pub(super) struct Moments {
    /// [`BODY_COLUMNS`], then slip and sigma of each wheel.
    pub(super) columns: Vec<Vec<f64>>,
    pub(super) changes: Vec<Change>,
    /// By the odometry, m.
    pub(super) distance: Option<f64>,
    /// Of each wheel: the motion and the health that hold.
    states: Vec<[String; 2]>,
}

impl Moments {
    pub(super) fn new(wheels: usize) -> Self {
        Self {
            columns: vec![Vec::new(); BODY_COLUMNS.len() + 2 * wheels],
            changes: Vec::new(),
            distance: None,
            states: vec![[const { String::new() }; 2]; wheels],
        }
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.columns[0].len()
    }

    /// Slip and sigma of a wheel.
    pub(super) fn wheel(&self, wheel: usize) -> [&[f64]; 2] {
        let first = BODY_COLUMNS.len() + 2 * wheel;
        [&self.columns[first], &self.columns[first + 1]]
    }
}

impl Sink for Moments {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        let motion = row.motion.map_or("", grouser_slip::Motion::name);
        let health = row.health.to_string();
        let states = self.states[row.wheel].iter_mut();
        for ((kind, now), held) in [("motion", motion), ("health", &health)]
            .into_iter()
            .zip(states)
        {
            if held != now {
                now.clone_into(held);
                self.changes.push(Change {
                    kind,
                    wheel: row.wheel,
                    time_s: row.time_s,
                    name: now.to_owned(),
                });
            }
        }
        Ok(())
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        let odometry = step.odometry.as_ref();
        self.distance = odometry.map(|odometry| odometry.distance).or(self.distance);
        let body = odometry.map_or([f64::NAN; 4], |odometry| {
            let [x, y, yaw] = odometry.pose;
            [x, y, yaw.to_degrees(), odometry.velocity[0]]
        });
        let of_wheels = step.wheels.iter().flat_map(|wheel| {
            let slip = wheel.slip.map(grouser_terra::Slip::value);
            [slip.unwrap_or(f64::NAN), wheel.sigma.unwrap_or(f64::NAN)]
        });
        let row = [step.time_s].into_iter().chain(body).chain(of_wheels);
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.push(value);
        }
        Ok(())
    }
}
