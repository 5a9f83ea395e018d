//! A plate test recorded as a force in a bag and a depth in a text file, each by its own clock.

use std::path::PathBuf;

use grouser_log::container::{Container, Event};
use grouser_log::csv::Lines;
use grouser_log::message::{Decoder, Value};
use grouser_real::{Real, median};

use super::align::{at, straightened, time_zone};
use super::test::{Plate, PlateTest};
use crate::error::{Error, Result};
use crate::least_squares::solve_damped;
use crate::table::TABLE_LIMIT;

/// How far above the noise the force must be for the plate to have met the ground, N and deviations.
const CONTACT: (f64, f64) = (0.5, 6.0);
/// For how long it must stay there, s.
const CONTACT_TIME_S: f64 = 0.5;
/// How much of the record's beginning shows the force without contact, s.
const QUIET_TIME_S: f64 = 3.0;
/// How close to its deepest place the plate still counts as being pressed in, m.
const STROKE_END_M: f64 = 3e-4;
/// Down to this depth the surface's own roughness rules, m.
const ROUGH_DEPTH_M: f64 = 1e-3;
/// Clock offsets beyond the time zone that are tried, s, and their step.
const OFFSETS: (f64, f64) = (1.0, 0.01);

/// The source of the force.
#[derive(Clone, Debug, PartialEq)]
pub struct BagSource {
    /// The bag (or MCAP file).
    pub bag: PathBuf,
    /// The topic; the only one of the file unless given.
    pub topic: Option<String>,
    /// The field of the force, N: `wrench.wrench.force.z`.
    pub force: String,
    /// The field of its stamp: `wrench.header.stamp`; the time of recording where there is none.
    pub stamp: Option<String>,
    /// +1 where the force reads positive when the plate is pressed in, −1 where negative.
    pub sign: f64,
}

/// The source of the depth: fields of each line of a text file, counted from 1.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthColumn {
    /// The file.
    pub file: PathBuf,
    /// The field of the height, upwards.
    pub height: usize,
    /// Metres per unit of the height.
    pub height_unit: f64,
    /// The field of the system's clock, s.
    pub clock: usize,
    /// The field of the controller's own clock, and s per unit of it, where it has one.
    pub controller: Option<(usize, f64)>,
    /// The height of the ground's surface, m, where it was measured; where the force begins otherwise.
    pub surface: Option<f64>,
}

/// A plate test as it was read, and what was found out on the way.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlateRecord {
    /// Force against depth from contact to the deepest place.
    pub test: PlateTest,
    /// What was added to the depth's clock: whole quarters of an hour between time zones, s.
    pub zone_s: f64,
    /// What was added besides, s: the offset at which force is most nearly a function of depth.
    pub offset_s: f64,
    /// Force read without contact, N.
    pub zero_n: f64,
    /// Height at which the plate met the ground, m.
    pub contact_height: f64,
}

/// Reads a plate test out of a bag and a text file.
///
/// The force's zero is its median before contact; contact is where it leaves its noise for good, and the
/// height there is depth 0. Clocks: local times are brought together by whole quarters of an hour, then by the
/// offset within a second at which force and depth agree best with one rising curve.
///
/// # Errors
/// [`Error::Log`] for a bag that cannot be read, [`Error::Content`] for a topic, field or number that is not
/// there, and where no contact is found.
pub fn read_bag(
    name: &str,
    plate: Plate,
    source: &BagSource,
    depth: &DepthColumn,
) -> Result<PlateRecord> {
    let (times, mut force) = read_force(source)?;
    let (own, height) = read_heights(depth)?;
    let wrong = |message: &str| Error::Content {
        path: source.bag.clone(),
        message: message.to_owned(),
    };
    if times.len() < 20 || own.len() < 20 {
        return Err(wrong("a plate test of fewer than 20 readings"));
    }
    let start = times[0];
    let mut quiet: Vec<f64> = times
        .iter()
        .zip(&force)
        .take_while(|(t, _)| **t - start <= QUIET_TIME_S)
        .map(|(_, f)| *f)
        .collect();
    let zero = median(&mut quiet).unwrap_or(f64::NAN);
    let mut apart: Vec<f64> = quiet.iter().map(|f| (f - zero).abs()).collect();
    let noise = 1.4826 * median(&mut apart).unwrap_or(f64::NAN);
    for f in &mut force {
        *f = source.sign * (*f - zero);
    }
    let threshold = CONTACT.0.max(CONTACT.1 * noise);
    let first = contact(&times, &force, threshold)
        .ok_or_else(|| wrong("the force never leaves its noise: no contact"))?;
    let zone = time_zone(&times, &own);
    let (offset, _) = (0..=2 * steps())
        .map(|step| -OFFSETS.0 + OFFSETS.1 * step as f64)
        .map(|offset| {
            (
                offset,
                roughness(&times, &force, (&own, &height), (first, zone + offset)),
            )
        })
        .fold((0.0, f64::INFINITY), |best, now| {
            if now.1 < best.1 { now } else { best }
        });
    let shifted: Vec<f64> = own.iter().map(|t| t + zone + offset).collect();
    let contact_height = depth
        .surface
        .unwrap_or_else(|| at(&shifted, &height, times[first]));
    let (depths, forces) = loading(&times, &force, (&shifted, &height), (first, contact_height));
    Ok(PlateRecord {
        test: PlateTest {
            name: name.to_owned(),
            plate,
            depth: depths,
            force: forces,
        },
        zone_s: zone,
        offset_s: offset,
        zero_n: zero,
        contact_height,
    })
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a quotient of two small positive constants"
)]
fn steps() -> usize {
    (OFFSETS.0 / OFFSETS.1).round() as usize
}

/// The first reading from which the force stays above `threshold` for a while.
fn contact(times: &[f64], force: &[f64], threshold: f64) -> Option<usize> {
    let mut since = None;
    for (index, (t, f)) in times.iter().zip(force).enumerate() {
        if *f > threshold {
            let began = *since.get_or_insert(index);
            if t - times[began] >= CONTACT_TIME_S {
                return Some(began);
            }
        } else {
            since = None;
        }
    }
    None
}

/// Depth and force from contact until the plate is nearly at its deepest.
fn loading(
    times: &[f64],
    force: &[f64],
    (clock, height): (&[f64], &[f64]),
    (first, contact_height): (usize, f64),
) -> (Vec<f64>, Vec<f64>) {
    let end = times.last().copied().unwrap_or(f64::NAN);
    let lowest = clock
        .iter()
        .zip(height)
        .filter(|(t, _)| **t >= times[first] && **t <= end)
        .map(|(_, h)| *h)
        .fold(f64::INFINITY, f64::min);
    times[first..]
        .iter()
        .zip(&force[first..])
        .map(|(t, f)| (at(clock, height, *t), *f))
        .take_while(|(h, _)| *h > lowest + STROKE_END_M)
        .map(|(h, f)| (contact_height - h, f))
        .unzip()
}

/// How far force is from being a smooth function of depth when the depth's clock is shifted: the mean square of
/// ln force about its best quartic in ln depth. A plate that is pressed in by fits and starts shows the
/// offset: with a wrong one the force rises while the depth rests.
fn roughness(
    times: &[f64],
    force: &[f64],
    (own, height): (&[f64], &[f64]),
    (first, shift): (usize, f64),
) -> f64 {
    let clock: Vec<f64> = own.iter().map(|t| t + shift).collect();
    let contact_height = at(&clock, height, times[first]);
    let (depths, forces) = loading(times, force, (&clock, height), (first, contact_height));
    let points: Vec<(f64, f64)> = depths
        .iter()
        .zip(&forces)
        .filter(|(z, f)| **z > ROUGH_DEPTH_M && **f > 0.0)
        .map(|(z, f)| (Real::ln(*z), Real::ln(*f)))
        .collect();
    if points.len() < 20 {
        return f64::INFINITY;
    }
    let rows: Vec<Vec<f64>> = points
        .iter()
        .map(|(x, _)| (0..5).map(|power| Real::powi(*x, power)).collect())
        .collect();
    let right: Vec<f64> = points.iter().map(|(_, y)| -y).collect();
    let Some(found) = solve_damped(&rows, &right, &[1e-9; 5]) else {
        return f64::INFINITY;
    };
    let squares: f64 = rows
        .iter()
        .zip(&right)
        .map(|(row, y)| {
            let said: f64 = row.iter().zip(&found).map(|(a, b)| a * b).sum();
            Real::powi(said + y, 2)
        })
        .sum();
    squares / points.len() as f64
}

/// Times (s) and raw force of a bag.
fn read_force(source: &BagSource) -> Result<(Vec<f64>, Vec<f64>)> {
    let wrong = |message: String| Error::Content {
        path: source.bag.clone(),
        message,
    };
    let mut container = Container::open(&source.bag)?;
    let mut decoder: Option<(usize, Decoder)> = None;
    let (mut times, mut force) = (Vec::new(), Vec::new());
    while let Some(event) = container.next() {
        let Event::Message(message) = event else {
            continue;
        };
        let wanted = source.topic.as_ref();
        if wanted.is_some_and(|topic| *topic != message.of.topic) {
            continue;
        }
        if let Some((channel, _)) = &decoder {
            if *channel != message.channel {
                return Err(wrong(
                    "several topics: name the one with the force".to_owned(),
                ));
            }
        } else {
            let made = Decoder::new(message.of).map_err(|error| wrong(error.to_string()))?;
            decoder = Some((message.channel, made));
        }
        let Some((_, decoder)) = &decoder else {
            continue;
        };
        let value = decoder
            .decode(message.data)
            .map_err(|error| wrong(error.to_string()))?;
        let Some(number) = value.at(&source.force).and_then(Value::number) else {
            return Err(wrong(format!("messages have no number `{}`", source.force)));
        };
        let stamp = source.stamp.as_ref().and_then(|path| value.at(path));
        let stamp = stamp.and_then(Value::time_ns);
        let seconds = stamp.map_or(1e-9 * message.log_time_ns as f64, |ns| 1e-9 * ns as f64);
        if number.is_finite() && times.last().is_none_or(|last| seconds > *last) {
            times.push(seconds);
            force.push(number);
        }
    }
    if times.is_empty() {
        return Err(wrong("no message with the force".to_owned()));
    }
    Ok((times, force))
}

/// The system's clock over the controller's: units of time differ by 1000, and stamps of a short test are late by some of its time.
const CONTROLLER_RATES: (f64, f64) = (0.1, 10.0);

/// Times (s, by the system's clock) and heights (m) of a text file.
fn read_heights(depth: &DepthColumn) -> Result<(Vec<f64>, Vec<f64>)> {
    let mut lines = Lines::open(&depth.file)?;
    let (mut clock, mut controller, mut height) = (Vec::new(), Vec::new(), Vec::new());
    while lines.advance()? {
        let wrong = |message: String| Error::Content {
            path: depth.file.clone(),
            message: format!("line {}: {message}", lines.number()),
        };
        if lines.bytes() > TABLE_LIMIT {
            return Err(wrong(format!("is beyond the limit of {TABLE_LIMIT} bytes")));
        }
        let line = lines.text()?;
        if line.trim().is_empty() {
            continue;
        }
        let fields: Vec<&str> = line
            .split([',', ';', '\t', ' '])
            .filter(|field| !field.is_empty())
            .collect();
        let field = |place: usize| -> Result<f64> {
            let found = place.checked_sub(1).and_then(|place| fields.get(place));
            let number = found.and_then(|text| text.parse::<f64>().ok());
            number
                .filter(|value| value.is_finite())
                .ok_or_else(|| wrong(format!("field {place} is no finite number")))
        };
        clock.push(field(depth.clock)?);
        height.push(depth.height_unit * field(depth.height)?);
        if let Some((place, unit)) = depth.controller {
            controller.push(unit * field(place)?);
        }
    }
    let Some((place, unit)) = depth.controller else {
        return Ok((clock, height));
    };
    let (times, rate) = straightened(&controller, &clock);
    let (low, high) = CONTROLLER_RATES;
    if !(low..=high).contains(&rate) {
        return Err(Error::Content {
            path: depth.file.clone(),
            message: format!(
                "the system's clock, field {}, runs {rate:.3e} s in a second of the controller's, field {place} in units of {unit} s \
                 (`controller_unit`), but must run {low} to {high} s",
                depth.clock
            ),
        });
    }
    Ok((times, height))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plate that sinks by 0.1 m/s, with readings of 40 z² that scatter by 10 % of themselves, each of them `times` times.
    fn rough(times: usize) -> f64 {
        let read = |i: usize| f64::from(u32::try_from(i / times).unwrap()) * 1e-3;
        let clock: Vec<f64> = (0..300 * times).map(read).collect();
        let force: Vec<f64> = clock
            .iter()
            .map(|t| (0.1 * t).powi(2) * 40.0 * (1.0 + 0.1 * f64::sin(1e3 * t)))
            .collect();
        let height: Vec<f64> = clock.iter().map(|t| -0.1 * t).collect();
        roughness(&clock, &force, (&clock, &height), (0, 0.0))
    }

    #[test]
    fn a_record_is_as_rough_with_each_reading_twice() {
        let once = rough(1);
        // the mean square of 0.1 sin
        assert!((once / 0.005 - 1.0).abs() < 0.1, "{once}");
        let twice = rough(2);
        assert!((twice / once - 1.0).abs() < 0.05, "{twice} {once}");
    }
}
