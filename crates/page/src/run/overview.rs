//! A whole log at a glance: the rim speeds of its wheels, before the estimator has run.

use grouser_files::robot::RobotFile;
use grouser_log::Log;
use grouser_replay::RobotSamples;
use grouser_slip::{Measurement, Wheel};
use serde_json::json;

use super::part;

/// Moments that are kept; a longer log has fewer for each second.
const MAX_MOMENTS: usize = 8192;
/// First time between two moments, ns.
const FIRST_INTERVAL_NS: i64 = 50_000_000;

/// The mean rim speed of each wheel between moments, as a part of a run: the log is read once, nothing is estimated.
///
/// # Errors
/// What is wrong with the log, or a wheel that the robot does not have.
///
/// ```
/// use grouser_files::{columns, robot};
/// use grouser_log::Log;
/// use grouser_page::run::overview;
///
/// let example = std::path::Path::new("../../examples/five-wheel");
/// let robot = robot::read(&example.join("robot.toml"))?;
/// let map = columns::read(&example.join("columns.toml"))?;
/// let log = Log::find(&[example.join("log.csv")], map)?;
/// let part = overview(&log, &robot)?;
/// assert!(part.len() > 8 * 6 * 500); // time and five speeds at 20 Hz for 40 s, less those at its ends
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn overview(log: &Log, robot: &RobotFile) -> grouser_replay::Result<Vec<u8>> {
    let log = &log.of_wheels();
    let mut samples = RobotSamples::new(log, robot)?;
    let wheels = robot.robot.wheels();
    let mut ways: Vec<Way> = wheels.iter().map(|_| Way::default()).collect();
    let mut moments = Moments::new(wheels.len());
    for sample in log.samples(&[])? {
        let sample = samples.convert(sample?);
        if let Some(wheel) = sample.measurement.wheel()
            && let (Some(way), Some(of)) = (ways.get_mut(wheel), wheels.get(wheel))
        {
            way.take(&sample.measurement, of, sample.time_ns);
        }
        moments.take(sample.time_ns, &ways);
    }
    Ok(moments.part())
}

/// How far a rim went.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    travelled_m: f64,
    is_read: bool,
    count: Option<u64>,
    angle: Option<f64>,
    time_ns: Option<i64>,
}

impl Way {
    fn take(&mut self, measurement: &Measurement, wheel: &Wheel, time_ns: i64) {
        let step = match *measurement {
            Measurement::WheelCount { raw, .. } => {
                let last = self.count.replace(raw).unwrap_or(raw);
                let ticks = wheel.encoder.counter.step(last, raw);
                wheel
                    .travel_per_tick()
                    .map_or(0.0, |travel| travel * ticks as f64)
            }
            Measurement::WheelAngle { angle, .. } => {
                wheel.travel_per_radian() * (angle - self.angle.replace(angle).unwrap_or(angle))
            }
            Measurement::WheelRate { rate, .. } => {
                let last = self.time_ns.replace(time_ns).unwrap_or(time_ns);
                wheel.travel_per_radian() * rate * time_ns.saturating_sub(last) as f64 * 1e-9
            }
            _ => return,
        };
        self.is_read = true;
        self.travelled_m += step;
    }
}

struct Moments {
    interval_ns: i64,
    start_ns: Option<i64>,
    times: Vec<f64>,
    ways: Vec<Vec<f64>>,
    end_s: f64,
}

impl Moments {
    fn new(wheels: usize) -> Self {
        Self {
            interval_ns: FIRST_INTERVAL_NS,
            start_ns: None,
            times: Vec::new(),
            ways: vec![Vec::new(); wheels],
            end_s: 0.0,
        }
    }

    fn take(&mut self, time_ns: i64, ways: &[Way]) {
        let start = *self.start_ns.get_or_insert(time_ns);
        let time_s = time_ns.saturating_sub(start) as f64 * 1e-9;
        self.end_s = self.end_s.max(time_s);
        let due = self
            .times
            .last()
            .is_none_or(|last| time_s - last >= self.interval_ns as f64 * 1e-9);
        if !due {
            return;
        }
        self.times.push(time_s);
        for (column, way) in self.ways.iter_mut().zip(ways) {
            column.push(if way.is_read {
                way.travelled_m
            } else {
                f64::NAN
            });
        }
        if self.times.len() >= MAX_MOMENTS {
            self.interval_ns *= 2;
            for column in std::iter::once(&mut self.times).chain(&mut self.ways) {
                let mut i = 0;
                column.retain(|_| {
                    i += 1;
                    i % 2 == 1
                });
            }
        }
    }

    fn part(self) -> Vec<u8> {
        let times: Vec<f64> = self
            .times
            .windows(2)
            .map(|pair| 0.5 * (pair[0] + pair[1]))
            .collect();
        let speeds: Vec<Vec<f64>> = self
            .ways
            .iter()
            .map(|way| {
                let steps = way.windows(2).zip(self.times.windows(2));
                steps
                    .map(|(way, time)| (way[1] - way[0]) / (time[1] - time[0]))
                    .collect()
            })
            .collect();
        let named = speeds
            .iter()
            .enumerate()
            .map(|(i, speeds)| (format!("rim_speed_m_per_s {i}"), speeds.as_slice()));
        let columns: Vec<(String, &[f64])> =
            std::iter::once(("time_s".to_owned(), times.as_slice()))
                .chain(named)
                .collect();
        part::bytes(json!({ "overview": { "end_s": self.end_s } }), &columns)
    }
}
