//! How rockers and arms carry the wheels, from their angles and the gyro.

use alloc::{boxed::Box, vec};

use grouser_real::Real;

use crate::history::seconds_between;
use crate::sample::{Measurement, Sample};

/// Greatest number of joints that a robot may measure.
pub const MAX_JOINTS: usize = 6;
/// A wheel is carried by at most this many links, one on the other.
pub const MAX_CARRIER_LINKS: usize = 3;

/// Gains of an α-β filter on a joint's angle and rate, over the residual. They damp it critically: with g the pole,
/// α = 1 − g² and β = (1 − g)², here g = 0.7, a memory of about six readings.
const ANGLE_GAIN: f64 = 0.51;
const RATE_GAIN: f64 = 0.09;
/// Readings further apart than this begin anew, s.
const MAX_GAP_S: f64 = 0.25;

/// One link between the chassis and a wheel; it turns about an axis across the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CarrierLink {
    /// Which measured joint turns it.
    pub joint: usize,
    /// +1 where the joint's angle turns it nose down, −1 for the other side of a differential.
    pub sign: f64,
    /// Its pivot at rest in the robot's frame: forwards and up, m.
    pub pivot: [f64; 2],
}

/// What carries one wheel: its centre and the links between it and the chassis.
///
/// ```
/// use grouser_slip::onboard::{CarrierLink, WheelCarrier};
/// let rocker = CarrierLink { joint: 0, sign: 1.0, pivot: [0.0, 0.22] };
/// let carrier = WheelCarrier::on_chassis([0.3, 0.15]).with_link(rocker);
/// assert_eq!(carrier.links().len(), 1);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelCarrier {
    centre: [f64; 2],
    links: [CarrierLink; MAX_CARRIER_LINKS],
    count: usize,
}

impl WheelCarrier {
    /// A wheel that the chassis carries; its centre is forwards and up in the robot's frame at rest, m.
    #[must_use]
    pub const fn on_chassis(centre: [f64; 2]) -> Self {
        Self {
            centre,
            links: [CarrierLink {
                joint: 0,
                sign: 1.0,
                pivot: [0.0; 2],
            }; MAX_CARRIER_LINKS],
            count: 0,
        }
    }

    /// The same wheel on one link more; links are added from the chassis outwards. Beyond [`MAX_CARRIER_LINKS`] nothing
    /// changes.
    #[must_use]
    pub const fn with_link(mut self, link: CarrierLink) -> Self {
        if self.count < MAX_CARRIER_LINKS {
            self.links[self.count] = link;
            self.count += 1;
        }
        self
    }

    /// The links from the chassis outwards.
    #[must_use]
    pub fn links(&self) -> &[CarrierLink] {
        &self.links[..self.count]
    }

    /// Turning about the axle beside the chassis (rad/s), and the velocity of the wheel's centre forwards and up (m/s), while
    /// the chassis pitches at `pitch_rate` (rad/s).
    fn motion(&self, joints: &[Joint; MAX_JOINTS], pitch_rate: f64) -> (f64, [f64; 2]) {
        let rotated =
            |[x, z]: [f64; 2], (sin, cos): (f64, f64)| [cos * x + sin * z, cos * z - sin * x];
        let minus = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
        let plus = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        // pivots as they are now, and how fast each link turns
        let mut pivots = [([0.0; 2], 0.0); MAX_CARRIER_LINKS];
        let (mut angle, mut rate) = (0.0, 0.0);
        let mut turn = (0.0, 1.0);
        let mut end = self.centre;
        for (index, link) in self.links().iter().enumerate() {
            let pivot = if index == 0 {
                link.pivot
            } else {
                let arm = minus(link.pivot, self.links[index - 1].pivot);
                plus(pivots[index - 1].0, rotated(arm, turn))
            };
            let joint = joints.get(link.joint).copied().unwrap_or_default();
            angle += link.sign * joint.angle;
            rate += link.sign * joint.rate;
            turn = Real::sin_cos(angle);
            pivots[index] = (pivot, rate);
            end = plus(pivot, rotated(minus(self.centre, link.pivot), turn));
        }
        let mut velocity = [0.0; 2];
        let mut outer = end;
        for (pivot, rate) in pivots[..self.count].iter().rev() {
            let arm = minus(outer, *pivot);
            velocity = plus(velocity, [arm[1] * rate, -arm[0] * rate]);
            outer = *pivot;
        }
        (
            rate,
            plus([pitch_rate * end[1], -(pitch_rate * end[0])], velocity),
        )
    }
}

/// An angle and its rate, filtered.
#[derive(Clone, Copy, Debug, Default)]
struct Joint {
    last_ns: Option<i64>,
    angle: f64,
    rate: f64,
}

impl Joint {
    fn update(&mut self, time_ns: i64, angle: f64) {
        if !angle.is_finite() {
            return;
        }
        let passed = self
            .last_ns
            .map_or(f64::INFINITY, |last| seconds_between(last, time_ns));
        if passed == 0.0 {
            return;
        }
        self.last_ns = Some(time_ns);
        if !(0.0..=MAX_GAP_S).contains(&passed) {
            self.angle = angle;
            self.rate = 0.0;
            return;
        }
        let residual = angle - self.angle - self.rate * passed;
        self.angle = angle - (1.0 - ANGLE_GAIN) * residual;
        self.rate += RATE_GAIN * residual / passed;
    }
}

/// The carriers of all wheels with the joints that move them.
///
/// ```
/// use grouser_slip::onboard::{CarrierLink, Carriers, WheelCarrier};
/// let rocker = CarrierLink { joint: 0, sign: 1.0, pivot: [0.0, 0.22] };
/// let wheel = WheelCarrier::on_chassis([0.3, 0.15]).with_link(rocker);
/// let mut carriers = Carriers::new([wheel].into_iter());
/// carriers.update(0, 0, 0.1);
/// assert_eq!(carriers.samples(0, 0.0).count(), 1);
/// ```
#[derive(Clone, Debug)]
pub struct Carriers {
    wheels: Box<[WheelCarrier]>,
    joints: [Joint; MAX_JOINTS],
}

impl Carriers {
    /// One for each wheel in the robot's order. This is the only place that allocates.
    #[must_use]
    pub fn new(wheels: impl ExactSizeIterator<Item = WheelCarrier>) -> Self {
        let mut carriers = vec![WheelCarrier::default(); wheels.len()].into_boxed_slice();
        for (slot, carrier) in carriers.iter_mut().zip(wheels) {
            *slot = carrier;
        }
        Self {
            wheels: carriers,
            joints: [Joint::default(); MAX_JOINTS],
        }
    }

    /// A joint's angle, rad. A joint that does not exist changes nothing.
    pub fn update(&mut self, time_ns: i64, joint: usize, angle: f64) {
        if let Some(joint) = self.joints.get_mut(joint) {
            joint.update(time_ns, angle);
        }
    }

    /// How each wheel's carrier moves while the robot pitches at `pitch_rate` (rad/s, nose down positive).
    pub fn samples(&self, time_ns: i64, pitch_rate: f64) -> impl Iterator<Item = Sample> + '_ {
        self.wheels.iter().enumerate().map(move |(wheel, carrier)| {
            let (rate, [forward, up]) = carrier.motion(&self.joints, pitch_rate);
            Sample {
                time_ns,
                measurement: Measurement::Carrier {
                    wheel,
                    turn: pitch_rate + rate,
                    forward,
                    up,
                },
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;

    #[test]
    fn a_rocker_that_turns_moves_its_wheel_about_the_pivot() {
        let rocker = CarrierLink {
            joint: 0,
            sign: 1.0,
            pivot: [0.0, 0.2],
        };
        let carrier = WheelCarrier::on_chassis([0.3, 0.2]).with_link(rocker);
        let mut joints = [Joint::default(); MAX_JOINTS];
        joints[0].rate = 0.5;
        let (rate, velocity) = carrier.motion(&joints, 0.0);
        // nose down: the wheel in front goes down at ω · 0.3 m
        assert_eq!(rate, 0.5);
        assert!(velocity[0].abs() < 1e-12 && (velocity[1] + 0.15).abs() < 1e-12);
        // the chassis alone pitches: the wheel is 0.3 m before and 0.2 m above the origin
        let (_, velocity) = WheelCarrier::on_chassis([0.3, 0.2]).motion(&joints, 1.0);
        assert_eq!(velocity, [0.2, -0.3]);
    }

    /// Where three links put the wheel's centre, by complex numbers: a link's turn nose down turns all that it carries.
    fn centre(carrier: &WheelCarrier, angles: &[f64], pitch: f64) -> [f64; 2] {
        let turned = |[x, z]: [f64; 2], [px, pz]: [f64; 2], angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let (x, z) = (x - px, z - pz);
            [px + cos * x + sin * z, pz + cos * z - sin * x]
        };
        let mut place = carrier.centre;
        // from the wheel inwards each link turns about its pivot at rest
        for link in carrier.links().iter().rev() {
            place = turned(place, link.pivot, link.sign * angles[link.joint]);
        }
        turned(place, [0.0; 2], pitch)
    }

    #[test]
    fn wheels_on_several_links_move_as_their_places_do() {
        let link = |joint, sign, x, z| CarrierLink {
            joint,
            sign,
            pivot: [x, z],
        };
        let links = [
            link(0, 1.0, 0.05, 0.22),
            link(1, -1.0, -0.2, 0.15),
            link(3, 1.0, -0.3, 0.12),
        ];
        let (mut angles, rates) = ([0.3, -0.2, 0.0, 0.5], [0.4, 0.7, 0.0, -0.9]);
        angles[2] = 9.0;
        for count in 0..=3 {
            let mut carrier = WheelCarrier::on_chassis([-0.35, 0.1]);
            for link in &links[..count] {
                carrier = carrier.with_link(*link);
            }
            let mut joints = [Joint::default(); MAX_JOINTS];
            for (joint, (angle, rate)) in joints.iter_mut().zip(angles.into_iter().zip(rates)) {
                (joint.angle, joint.rate) = (angle, rate);
            }
            let (pitch_rate, h) = (0.6, 1e-6);
            let (turn, velocity) = carrier.motion(&joints, pitch_rate);
            let expected: f64 = links[..count]
                .iter()
                .map(|link| link.sign * rates[link.joint])
                .sum();
            assert!((turn - expected).abs() < 1e-12);
            // a central difference
            let at = |t: f64| {
                let moved: Vec<f64> = angles.iter().zip(rates).map(|(a, r)| a + r * t).collect();
                centre(&carrier, &moved, pitch_rate * t)
            };
            let (before, after) = (at(-h), at(h));
            for axis in 0..2 {
                let exact = (after[axis] - before[axis]) / (2.0 * h);
                assert!(
                    (velocity[axis] - exact).abs() < 1e-8,
                    "{count} links, axis {axis}"
                );
            }
        }
        // a fourth link changes nothing
        let full = links
            .into_iter()
            .fold(WheelCarrier::on_chassis([0.0; 2]), WheelCarrier::with_link);
        assert_eq!(full.with_link(links[0]), full);
    }

    /// A ramp is followed without an error, and the residual of a step falls by the critically damped pole 0.7.
    #[test]
    fn a_joint_s_rate_is_that_of_its_angle() {
        let mut carriers = Carriers::new([WheelCarrier::default()].into_iter());
        let joint = |carriers: &Carriers| (carriers.joints[2].angle, carriers.joints[2].rate);
        for step in 0..100 {
            carriers.update(step * 10_000_000, 2, 0.3 + 0.005 * step as f64);
        }
        let (angle, rate) = joint(&carriers);
        assert!((angle - 0.795).abs() < 1e-9 && (rate - 0.5).abs() < 1e-9);
        // the wheel turns with its link and with the chassis
        let rocker = CarrierLink {
            joint: 2,
            sign: 1.0,
            pivot: [0.0, 0.2],
        };
        carriers.wheels[0] = WheelCarrier::on_chassis([0.3, 0.2]).with_link(rocker);
        for sample in carriers.samples(7, 0.25) {
            let Measurement::Carrier { wheel: 0, turn, .. } = sample.measurement else {
                panic!("{sample:?}")
            };
            assert!(sample.time_ns == 7 && (turn - 0.75).abs() < 1e-9);
        }
        // a reading of the same time, one that is no number and a joint that does not exist change nothing
        carriers.update(990_000_000, 2, 7.0);
        carriers.update(1_000_000_000, 2, f64::NAN);
        carriers.update(1_000_000_000, 99, 7.0);
        assert_eq!(joint(&carriers), (angle, rate));
        // a step of 1 rad: α and β of it at once
        carriers.update(1_000_000_000, 2, 1.8);
        let (angle, rate) = joint(&carriers);
        assert!((angle - (0.8 + ANGLE_GAIN)).abs() < 1e-9);
        assert!((rate - (0.5 + RATE_GAIN / 0.01)).abs() < 1e-6);
        // after a gap, or back in time, it begins anew; at the gap's end not yet
        carriers.update(1_250_000_000, 2, 1.9);
        assert!(joint(&carriers).1 != 0.0);
        for time_ns in [1_500_000_001, 1_400_000_000] {
            carriers.update(time_ns, 2, -0.1);
            assert_eq!(joint(&carriers), (-0.1, 0.0));
            carriers.update(time_ns + 10_000_000, 2, 0.1);
            assert!(joint(&carriers).1 != 0.0);
        }
    }
}
