//! A recorded log through the estimator: the rows of `grouser estimate -o`, and its doubts.

use std::io;

use grouser_replay::{Row, Sink, Step, Summary};
use serde_json::{Value, json};

use super::learnt;
use super::moments::{BODY_COLUMNS, Moments};

/// Most moments that are kept; a longer run is thinned to every k-th, and `every` says so.
const MAX_MOMENTS: usize = 40_000;

/// The rows of a log through the estimator, in columns.
///
/// ```
/// use grouser_page::run::LogRecorder;
///
/// let recorder = LogRecorder::new(4); // a sink of `grouser_replay::run_into`
/// # let _ = recorder;
/// ```
#[derive(Debug)]
pub struct LogRecorder {
    every: usize,
    count: usize,
    moments: Moments,
}

impl LogRecorder {
    /// Takes the rows of a robot of `wheels` wheels.
    #[must_use]
    pub fn new(wheels: usize) -> Self {
        Self {
            every: 1,
            count: 0,
            moments: Moments::new(wheels),
        }
    }

    /// The run as the page plays it; `title` names the log.
    #[must_use]
    pub fn object(&self, title: &str, summary: &Summary) -> Value {
        let doubts = [summary.doubts_in_words(), summary.reservations()].concat();
        let moments = &self.moments;
        let states = |wheel: usize, kind: &str| -> Value {
            let changes = moments.changes.iter();
            changes
                .filter(|change| change.wheel == wheel && change.kind == kind)
                .map(|change| json!([change.time_s, change.name]))
                .collect()
        };
        let wheel = |(i, whole): (usize, &grouser_replay::WheelSummary)| {
            let [slip, sigma] = moments.wheel(i);
            json!({
                "name": whole.name,
                "slip": slip,
                "slip_sigma": sigma,
                "motion": states(i, "motion"),
                "health": states(i, "health"),
                "median_slip": whole.slip.median,
                "is_reference": whole.is_reference,
            })
        };
        let wheels: Vec<Value> = summary.wheels.iter().enumerate().map(wheel).collect();
        let mut run = json!({
            "kind": "estimate",
            "title": title,
            "duration_s": moments.columns[0].last(),
            "distance_m": moments.distance,
            "doubts": doubts,
            "every": self.every,
            "soil": learnt::soil(summary.soil.as_ref()),
            "wheels": wheels,
        });
        for (name, column) in BODY_COLUMNS.iter().zip(&moments.columns) {
            run[name] = json!(column);
        }
        run
    }

    /// Drops every second moment.
    fn halve(&mut self) {
        self.every *= 2;
        for column in &mut self.moments.columns {
            let mut i = 0;
            column.retain(|_| {
                i += 1;
                i % 2 == 1
            });
        }
    }
}

impl Sink for LogRecorder {
    fn row(&mut self, row: &Row<'_>) -> io::Result<()> {
        self.moments.row(row)
    }

    fn step(&mut self, step: &Step<'_>) -> io::Result<()> {
        let due = self.count.is_multiple_of(self.every);
        self.count += 1;
        if due {
            self.moments.step(step)?;
        } else if let Some(odometry) = &step.odometry {
            self.moments.distance = Some(odometry.distance);
        }
        if self.moments.len() >= MAX_MOMENTS {
            self.halve();
        }
        Ok(())
    }
}
