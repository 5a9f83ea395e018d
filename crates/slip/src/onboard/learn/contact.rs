//! How deep the wheels stand in the ground, by sensors of sinkage and of entry angles.
//!
//! Both measure one thing, the depth over the radius: 1 − cos θ₁ by an entry angle θ₁. Only wheels that lead count, since a
//! wheel in another one's rut sinks into soil that is pressed already.

use alloc::{boxed::Box, vec::Vec};

use grouser_real::Real;

use super::settings::SoilLearnSettings;
use crate::fault::Fault;
use crate::robot::{Robot, Wheel};

/// A sensor's noise takes readings this many standard deviations below 0 or beyond the limit.
const MAX_NOISE_SIGMA: f64 = 4.0;
/// The laws hold for sinkages up to the radius.
const MAX_ENTRY_ANGLE_RAD: f64 = core::f64::consts::FRAC_PI_2;
/// A sensor that shows exactly the same so often in a row is stuck: one that works has noise.
const STUCK_READINGS: u32 = 10;

/// Which of both a sensor measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ContactKind {
    /// Sinkage, m.
    Sinkage,
    /// Entry angle, rad.
    EntryAngle,
}

const KINDS: [ContactKind; 2] = [ContactKind::Sinkage, ContactKind::EntryAngle];

/// Sum of the readings of one sensor.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    value: f64,
    count: u32,
}

/// One sensor of one wheel.
#[derive(Clone, Copy, Debug, Default)]
struct Sensor {
    /// Since the last tick, and over the reading.
    new: Sum,
    sum: Sum,
    /// What it showed last, and how often it has done so in a row.
    last: f64,
    repeats: u32,
}

impl Sensor {
    fn add(&mut self, value: f64) {
        self.repeats = if value.to_bits() == self.last.to_bits() {
            self.repeats.saturating_add(1)
        } else {
            1
        };
        self.last = value;
        self.new.value += value;
        self.new.count += 1;
    }

    fn tick(&mut self, counts: bool) {
        let new = core::mem::take(&mut self.new);
        if counts {
            self.sum.value += new.value;
            self.sum.count += new.count;
        }
    }

    fn discard(&mut self) {
        (self.new, self.sum) = (Sum::default(), Sum::default());
    }

    const fn is_stuck(&self) -> bool {
        self.repeats >= STUCK_READINGS
    }
}

#[derive(Clone, Copy, Debug)]
struct ContactWheel {
    radius: f64,
    leads: bool,
    /// By kind.
    sensors: [Sensor; 2],
}

/// Sums sinkages and entry angles up to readings.
#[derive(Clone, Debug)]
pub(super) struct ContactReadings {
    wheels: Box<[ContactWheel]>,
    /// By kind: m and rad.
    sigmas: [f64; 2],
    /// Values that no wheel can have, and readings of sensors that are stuck.
    pub(super) refused: u32,
    pub(super) stuck: u32,
}

impl ContactReadings {
    pub(super) fn new(robot: &Robot, settings: &SoilLearnSettings) -> Self {
        let wheels = robot.wheels();
        let contact = wheels.iter().map(|wheel| ContactWheel {
            radius: wheel.radius,
            leads: leads(wheel, wheels),
            sensors: [Sensor::default(); 2],
        });
        Self {
            wheels: contact.collect::<Vec<_>>().into_boxed_slice(),
            sigmas: [settings.sinkage_sigma, settings.entry_angle_sigma],
            refused: 0,
            stuck: 0,
        }
    }

    /// A reading of a sensor, m or rad.
    pub(super) fn add(
        &mut self,
        wheel: usize,
        kind: ContactKind,
        value: f64,
    ) -> core::result::Result<(), Fault> {
        let wheels = self.wheels.len();
        let own = self.wheels.get_mut(wheel).ok_or(Fault::UnknownWheel {
            index: wheel,
            wheels,
        })?;
        let noise = MAX_NOISE_SIGMA * self.sigmas[kind as usize];
        let checked = match kind {
            ContactKind::Sinkage => {
                Fault::check_range("sinkage", value, -noise, own.radius + noise, "m")
            }
            ContactKind::EntryAngle => {
                let most = MAX_ENTRY_ANGLE_RAD + noise;
                Fault::check_range("entry angle", value, -noise, most, "rad")
            }
        };
        if checked.is_err() {
            self.refused = self.refused.saturating_add(1);
        } else {
            own.sensors[kind as usize].add(value);
        }
        checked
    }

    /// One tick: what has come since the last one counts or not.
    pub(super) fn tick(&mut self, counts: bool) {
        for sensor in self.wheels.iter_mut().flat_map(|wheel| &mut wheel.sensors) {
            sensor.tick(counts);
        }
    }

    /// What was begun is no reading.
    pub(super) fn discard(&mut self) {
        for sensor in self.wheels.iter_mut().flat_map(|wheel| &mut wheel.sensors) {
            sensor.discard();
        }
    }

    /// Sinkage of the leading wheels over their radius with its standard deviation, where it was measured. A sensor's error
    /// is taken for one that lasts: it does not average out over readings and wheels.
    pub(super) fn take(&mut self) -> Option<(f64, f64)> {
        let (mut sum, mut weight) = (0.0, 0.0);
        for kind in KINDS {
            let (mut depths, mut variances, mut count) = (0.0, 0.0, 0.0);
            for wheel in &mut self.wheels {
                let sensor = &mut wheel.sensors[kind as usize];
                let own = core::mem::take(&mut sensor.sum);
                if !wheel.leads || own.count == 0 {
                    continue;
                }
                if sensor.is_stuck() {
                    self.stuck = self.stuck.saturating_add(1);
                    continue;
                }
                let mean = own.value / f64::from(own.count);
                let sigma = self.sigmas[kind as usize];
                let (depth, sigma) = match kind {
                    ContactKind::Sinkage => (mean / wheel.radius, sigma / wheel.radius),
                    ContactKind::EntryAngle => {
                        let (sin, cos) = Real::sin_cos(mean);
                        // the second term where the first vanishes
                        (1.0 - cos, sin.abs() * sigma + 0.5 * sigma * sigma)
                    }
                };
                depths += depth;
                variances += sigma * sigma;
                count += 1.0;
            }
            if count > 0.0 {
                // the mean of the variances: the wheels' sensors err alike
                let own = count / variances;
                sum += own * depths / count;
                weight += own;
            }
        }
        (weight > 0.0).then(|| (sum / weight, Real::sqrt(1.0 / weight)))
    }
}

/// Is no wheel ahead of it in its track?
pub(super) fn leads(wheel: &Wheel, wheels: &[Wheel]) -> bool {
    let width = |wheel: &Wheel| wheel.width.unwrap_or(wheel.radius);
    !wheels.iter().any(|other| {
        let reach = 0.5 * (width(wheel) + width(other));
        other.x > wheel.x && (other.y - wheel.y).abs() < reach
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn readings() -> ContactReadings {
        let wheels = alloc::vec![
            Wheel::powered("front").at(0.3, 0.2).radius(0.1).width(0.1),
            Wheel::powered("rear").at(-0.3, 0.2).radius(0.1).width(0.1),
        ];
        let robot = Robot::new("cart".into(), wheels).expect("a robot");
        ContactReadings::new(&robot, &SoilLearnSettings::default())
    }

    #[test]
    fn a_sinkage_and_its_entry_angle_are_one_reading() {
        let mut both = readings();
        let angle = 0.5_f64;
        let depth = 0.1 * (1.0 - angle.cos());
        for (kind, value) in [
            (ContactKind::Sinkage, depth),
            (ContactKind::EntryAngle, angle),
        ] {
            both.add(0, kind, value).expect("possible");
        }
        both.tick(true);
        let (mean, sigma) = both.take().expect("a reading");
        assert!((mean - depth / 0.1).abs() < 1e-12);
        // two sensors know more than one
        let settings = SoilLearnSettings::default();
        let by_angle =
            angle.sin() * settings.entry_angle_sigma + 0.5 * settings.entry_angle_sigma.powi(2);
        let by_depth = settings.sinkage_sigma / 0.1;
        let expected = (by_angle.powi(-2) + by_depth.powi(-2)).powf(-0.5);
        assert!((sigma - expected).abs() < 1e-12);
        assert_eq!(both.take(), None);
    }

    #[test]
    fn what_no_wheel_can_have_is_refused_and_a_stuck_sensor_is_left_out() {
        let mut one = readings();
        let noise = MAX_NOISE_SIGMA * SoilLearnSettings::default().sinkage_sigma;
        for value in [f64::NAN, f64::INFINITY, -noise - 1e-6, 0.1 + noise + 1e-6] {
            assert!(one.add(0, ContactKind::Sinkage, value).is_err(), "{value}");
        }
        assert!(one.add(0, ContactKind::EntryAngle, 2.0).is_err());
        assert!(one.add(7, ContactKind::Sinkage, 0.01).is_err());
        assert_eq!(one.refused, 5);
        for index in 0..30 {
            one.add(0, ContactKind::Sinkage, 0.02).expect("possible");
            // a wheel in the rut of another one
            let depth = 0.001 * f64::from(index);
            one.add(1, ContactKind::Sinkage, depth).expect("possible");
            one.tick(true);
        }
        assert_eq!((one.take(), one.stuck), (None, 1));
        // a value that repeats a few times is no stuck sensor
        for _ in 0..STUCK_READINGS - 1 {
            one.add(0, ContactKind::Sinkage, 0.03).expect("possible");
            one.tick(true);
        }
        assert!(one.take().is_some());
        // one more is
        one.add(0, ContactKind::Sinkage, 0.03).expect("possible");
        one.tick(true);
        assert_eq!((one.take(), one.stuck), (None, 2));
        // what was begun and is discarded is no reading
        one.add(0, ContactKind::Sinkage, 0.05).expect("possible");
        one.tick(true);
        one.add(0, ContactKind::Sinkage, 0.06).expect("possible");
        one.discard();
        one.tick(true);
        assert_eq!(one.take(), None);
        // while the robot turns nothing counts
        one.add(0, ContactKind::Sinkage, 0.04).expect("possible");
        one.tick(false);
        assert_eq!(one.take(), None);
    }

    #[test]
    fn entry_angles_within_four_sigma_of_a_quarter_turn_are_readings() {
        let noise = MAX_NOISE_SIGMA * SoilLearnSettings::default().entry_angle_sigma;
        let mut one = readings();
        for (value, is_taken) in [
            (MAX_ENTRY_ANGLE_RAD + 0.99 * noise, true),
            (MAX_ENTRY_ANGLE_RAD + 1.01 * noise, false),
            (-0.99 * noise, true),
            (-1.01 * noise, false),
            (0.5 * noise, true),
        ] {
            let added = one.add(0, ContactKind::EntryAngle, value);
            assert_eq!(added.is_ok(), is_taken, "{value}");
        }
    }

    #[test]
    fn a_wheel_leads_unless_half_of_both_widths_lies_in_a_track_ahead() {
        let wheel = |x, y, width| Wheel::powered("wheel").at(x, y).width(width);
        let front = wheel(0.3, 0.2, 0.1);
        // 0.15 m between the middles of wheels of 0.1 and 0.2 m
        for (y, is_in_rut) in [
            (0.2, true),
            (0.349, true),
            (0.051, true),
            (0.351, false),
            (0.049, false),
        ] {
            let rear = wheel(-0.3, y, 0.2);
            let wheels = [front.clone(), rear.clone()];
            assert!(leads(&front, &wheels));
            assert_eq!(leads(&rear, &wheels), !is_in_rut, "{y}");
        }
    }
}
