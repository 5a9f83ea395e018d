//! What was seen on the way: for the report, and as a log that `estimate` reads.

use std::fmt::Write as _;

use grouser_rover::drive::{Frame, Scenario};
use grouser_rover::sensors::Reading;
use grouser_slip::Measurement;

use crate::number::exact;

/// Frames kept a second: enough for a figure.
const KEPT: f64 = 10.0;

/// A wheel at a moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct WheelPoint {
    pub(super) slip: Option<f64>,
    pub(super) seen: Option<f64>,
    pub(super) torque: f64,
}

/// A moment.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub(super) time: f64,
    pub(super) place: [f64; 3],
    pub(super) energy: f64,
    pub(super) wheels: Vec<WheelPoint>,
}

/// One line of the log: what arrived in one period of the control loop.
#[derive(Clone, Debug, Default)]
struct Row {
    time_ns: i64,
    counts: Vec<Option<u64>>,
    yaw_rate: Option<f64>,
}

/// What was seen of one drive.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pub(super) points: Vec<Point>,
    rows: Vec<Row>,
    wheels: usize,
}

impl Track {
    pub(super) fn new(scenario: &Scenario) -> Self {
        Self {
            points: Vec::new(),
            rows: Vec::new(),
            wheels: scenario.robot.wheels.len(),
        }
    }

    pub(super) fn add(&mut self, frame: &Frame<'_>) {
        let due = self
            .points
            .last()
            .is_none_or(|last| frame.time - last.time >= 1.0 / KEPT - 1e-9);
        if due {
            self.points.push(Point {
                time: frame.time,
                place: frame.place,
                energy: frame.energy,
                wheels: frame
                    .wheels
                    .iter()
                    .map(|wheel| WheelPoint {
                        slip: wheel.slip,
                        seen: wheel.seen.slip,
                        torque: wheel.torque,
                    })
                    .collect(),
            });
        }
        self.read(frame);
    }

    fn read(&mut self, frame: &Frame<'_>) {
        let mut row = Row {
            counts: vec![None; self.wheels],
            ..Row::default()
        };
        for reading in frame.readings {
            let Reading::Sample(sample) = reading else {
                continue;
            };
            match sample.measurement {
                Measurement::WheelCount { wheel, raw } => {
                    if let Some(slot) = row.counts.get_mut(wheel) {
                        *slot = Some(raw);
                    }
                }
                // a table holds numbers; what a broken sensor shows instead is an empty cell
                Measurement::YawRate { rate } => {
                    row.yaw_rate = Some(rate).filter(|r| r.is_finite());
                }
                _ => continue,
            }
            row.time_ns = row.time_ns.max(sample.time_ns);
        }
        let follows = self
            .rows
            .last()
            .is_none_or(|last| last.time_ns < row.time_ns);
        if row.time_ns > 0 && follows {
            self.rows.push(row);
        }
    }
}

/// The log: `time_ms`, the counter of each wheel with an encoder, the gyro.
pub(super) fn log(scenario: &Scenario, track: &Track) -> String {
    let mut out = String::from("time_ms");
    for wheel in scenario.robot.robot.wheels() {
        let _ = write!(out, ",{}_ticks", wheel.name);
    }
    out.push_str(",gyro_z_rad_per_s\n");
    for row in &track.rows {
        let _ = write!(out, "{}", row.time_ns / 1_000_000);
        for count in &row.counts {
            match count {
                Some(count) => {
                    let _ = write!(out, ",{count}");
                }
                None => out.push(','),
            }
        }
        let _ = writeln!(out, ",{}", row.yaw_rate.map(exact).unwrap_or_default());
    }
    out
}
