//! The way of a rim from one reading to the next.

use grouser_slip::{Measurement, Wheel};

/// The way of a rim between two readings, m; a rate counts as the mean since the reading before, as the filter takes it.
pub(crate) fn rim_way(wheel: &Wheel, last: &Measurement, now: &Measurement, passed_s: f64) -> f64 {
    match (last, now) {
        (Measurement::WheelCount { raw: from, .. }, Measurement::WheelCount { raw: to, .. }) => {
            let ticks = wheel.encoder.counter.step(*from, *to) as f64;
            ticks * wheel.travel_per_tick().unwrap_or(f64::NAN)
        }
        (
            Measurement::WheelAngle { angle: from, .. },
            Measurement::WheelAngle { angle: to, .. },
        ) => (to - from) * wheel.travel_per_radian(),
        (_, Measurement::WheelRate { rate, .. }) => rate * wheel.travel_per_radian() * passed_s,
        _ => f64::NAN,
    }
}
