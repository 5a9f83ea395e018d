//! A log from its end to its beginning.

use grouser_slip::{MAX_WHEELS, Measurement, Sample};

/// The samples as a robot would give them that drives the same way back: times count from the end (`end_ns`), speeds and
/// turns have the other sign, accelerations, slips and places the same. What measures the time since the reading
/// before it (rates, displacements) takes that reading's time; `latency_ns` is how late measured motions come.
pub(crate) fn reversed(samples: &[Sample], end_ns: i64, latency_ns: i64) -> Vec<Sample> {
    let mut last_rate = [None; MAX_WHEELS];
    let mut last_displacement = None;
    let mut out = Vec::with_capacity(samples.len());
    for sample in samples {
        let mut time_ns = sample.time_ns;
        let measurement = match sample.measurement {
            Measurement::WheelEdge { wheel, forward } => Measurement::WheelEdge {
                wheel,
                forward: !forward,
            },
            Measurement::WheelRate { wheel, rate } => {
                let Some(before) = last_rate.get_mut(wheel).and_then(|l| l.replace(time_ns)) else {
                    continue;
                };
                time_ns = before;
                Measurement::WheelRate { wheel, rate: -rate }
            }
            Measurement::YawRate { rate } => Measurement::YawRate { rate: -rate },
            Measurement::Displacement {
                forward,
                left,
                turn,
            } => {
                let Some(before) = last_displacement.replace(time_ns) else {
                    continue;
                };
                time_ns = before - latency_ns;
                Measurement::Displacement {
                    forward: -forward,
                    left: -left,
                    turn: turn.map(|turn| -turn),
                }
            }
            Measurement::Pose { x, y, yaw } => {
                time_ns -= latency_ns;
                Measurement::Pose { x, y, yaw }
            }
            Measurement::Position { x, y } => {
                time_ns -= latency_ns;
                Measurement::Position { x, y }
            }
            Measurement::Speed { forward, left } => {
                time_ns -= latency_ns;
                Measurement::Speed {
                    forward: -forward,
                    left: left.map(|left| -left),
                }
            }
            Measurement::Carrier {
                wheel,
                turn,
                forward,
                up,
            } => Measurement::Carrier {
                wheel,
                turn: -turn,
                forward: -forward,
                up: -up,
            },
            same => same,
        };
        out.push(Sample {
            time_ns: end_ns.saturating_sub(time_ns),
            measurement,
        });
    }
    out.reverse();
    out.sort_by_key(|sample| sample.time_ns);
    out
}
