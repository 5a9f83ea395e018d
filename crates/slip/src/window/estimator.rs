//! The estimator: one sample in, the slip of every wheel out.

use alloc::{boxed::Box, vec};

use super::means::WindowMeans;
use super::output::WindowOutput;
use super::settings::WindowSettings;
use crate::body::BodyMotion;
use crate::error::Result;
use crate::fault::{Fault, Rejected};
use crate::history::seconds_between;
use crate::measured_slip::MeasuredSlip;
use crate::reference::Reference;
use crate::robot::{Robot, WheelRole};
use crate::sample::Sample;
use crate::state::{Degraded, Health, Invalid, Motion};
use crate::wheel_estimate::WheelEstimate;

/// Slip of every wheel from a stream of samples, as means over a window of time.
///
/// Over the window it compares the way of each rim with the way of the wheel's centre along its heading by the
/// [`Reference`]: v_i = e_i · (v_body + Ω × p_i), s_i from v_i and r ω_i.
///
/// [`WindowEstimator::update`] uses one sample of one sensor. It never panics, allocates, blocks or reads a
/// clock; its cost is bounded by the number of wheels; a refused sample is counted and changes no estimate.
///
/// ```
/// use grouser_slip::window::{WindowEstimator, WindowSettings};
/// use grouser_slip::{Measurement, Reference, Robot, Sample, Wheel};
///
/// let wheels = vec![
///     Wheel::powered("drive").at(0.3, 0.0).radius(0.1).ticks_per_turn(1000),
///     Wheel::free("fifth").at(-0.3, 0.0).radius(0.1).ticks_per_turn(1000),
/// ];
/// let robot = Robot::new("bicycle".into(), wheels)?;
/// let settings = WindowSettings { reference: Reference::FreeWheel, ..WindowSettings::default() };
/// let mut estimator = WindowEstimator::new(&robot, settings)?;
/// for step in 0..200_u64 {
///     let time_ns = step as i64 * 10_000_000;
///     // The powered wheel turns 10 ticks a step, the free one 8: the robot travels at 80 % of the rim speed.
///     for (wheel, raw) in [(0, 10 * step), (1, 8 * step)] {
///         estimator.update(Sample { time_ns, measurement: Measurement::WheelCount { wheel, raw } })?;
///     }
///     estimator.update(Sample { time_ns, measurement: Measurement::YawRate { rate: 0.0 } })?;
/// }
/// let slip = estimator.latest().unwrap().wheels[0].slip.unwrap();
/// assert!((slip.value() - 0.2).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct WindowEstimator {
    means: WindowMeans,
    estimates: Box<[WheelEstimate]>,
    last_good_ns: Box<[Option<i64>]>,
}

impl WindowEstimator {
    /// An estimator for `robot`. This is the only place that allocates.
    ///
    /// # Errors
    /// [`Error::OutOfRange`](crate::Error::OutOfRange) for a setting outside its limits.
    pub fn new(robot: &Robot, settings: WindowSettings) -> Result<Self> {
        let wheels = robot.wheels().len();
        Ok(Self {
            means: WindowMeans::new(robot, settings)?,
            estimates: vec![WheelEstimate::NOTHING; wheels].into_boxed_slice(),
            last_good_ns: vec![None; wheels].into_boxed_slice(),
        })
    }

    /// Takes one sample and gives what is known after it.
    ///
    /// # Errors
    /// A [`Fault`] refuses the sample: it is counted and enters no estimate.
    pub fn update(&mut self, sample: Sample) -> core::result::Result<WindowOutput<'_>, Fault> {
        let now = self.means.accept(sample)?;
        self.evaluate(now);
        Ok(self.estimate(now))
    }

    /// What is known now; `None` before the first sample.
    #[must_use]
    pub fn latest(&self) -> Option<WindowOutput<'_>> {
        self.means.now_ns().map(|now| self.estimate(now))
    }

    /// Samples refused so far.
    #[must_use]
    pub const fn rejected(&self) -> Rejected {
        self.means.rejected()
    }

    fn estimate(&self, now: i64) -> WindowOutput<'_> {
        WindowOutput {
            time_ns: now,
            wheels: &self.estimates,
            body: self.means.body(),
        }
    }

    fn evaluate(&mut self, now: i64) {
        let reference_until = self.means.reference_until(now);
        let reference_lost = reference_until.is_some_and(|until| self.means.is_silent(until, now));
        // Wheels that are read together share their window.
        let mut last: Option<(i64, Option<BodyMotion>)> = None;
        for index in 0..self.estimates.len() {
            let mut estimate = WheelEstimate::NOTHING;
            let own = self.means.wheels()[index].track.known_until(now);
            if own.is_some_and(|own| self.means.is_silent(own, now)) {
                estimate.health = Health::Invalid(Invalid::Dropout);
            } else if reference_lost {
                estimate.health = Health::Degraded(Degraded::ReferenceLost);
            } else if self.means.lacks_reference() {
                estimate.health = Health::Invalid(Invalid::NoReference);
            } else if let (Some(own), Some(reference)) = (own, reference_until) {
                let until = own.min(reference);
                let from = self.means.window_start(until);
                let body = match last {
                    Some((same, body)) if same == until => body,
                    _ => {
                        self.means.measure(from, until);
                        self.means.reference_motion()
                    }
                };
                last = Some((until, body));
                let found = body.and_then(|body| self.evaluate_wheel(index, &body, (from, until)));
                estimate = found.unwrap_or(estimate);
            }
            if estimate.health == Health::Ok {
                self.last_good_ns[index] = Some(now);
            }
            estimate.last_good_age =
                self.last_good_ns[index].map(|good| seconds_between(good, now));
            self.estimates[index] = estimate;
        }
        self.means
            .evaluate_body(now, reference_until.filter(|_| !reference_lost));
    }

    fn evaluate_wheel(
        &self,
        index: usize,
        body: &BodyMotion,
        (from, until): (i64, i64),
    ) -> Option<WheelEstimate> {
        let wheel = &self.means.wheels()[index];
        let settings = self.means.settings();
        let rim = self.means.speeds()[index]?;
        let forward = body.along(wheel.row());
        let measured = MeasuredSlip::from_speeds(forward, rim, &settings.limits());
        let mut estimate = WheelEstimate {
            slip: measured.slip,
            sigma: measured.sigma,
            forward_speed: Some(forward),
            rim_speed: Some(rim),
            motion: Some(measured.motion),
            health: measured.health,
            until_ns: Some(until),
            last_good_age: None,
        };
        if estimate.health == Health::Ok && measured.slip.is_some() {
            if settings.reference == Reference::Grip {
                estimate.health = Health::Degraded(Degraded::Relative);
            } else if self.means.yaw_rate(from, until).is_none() {
                estimate.health = Health::Degraded(Degraded::YawAssumed);
            }
        }
        if wheel.role == WheelRole::Free && settings.reference == Reference::FreeWheel {
            // It is what the others are measured against: by assumption it rolls without slip.
            estimate.slip = None;
            estimate.sigma = None;
            if estimate.motion != Some(Motion::Standstill) {
                estimate.motion = Some(Motion::Driving);
            }
        }
        Some(estimate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Wheel;
    use crate::sample::Measurement;
    use crate::speed::Measured;

    /// Two powered wheels and a free one on one axle, 0.1 m, that send angles.
    fn estimator(change: impl Fn(&mut WindowSettings)) -> WindowEstimator {
        let wheels = [
            Wheel::powered("left").at(0.0, 0.2),
            Wheel::powered("right").at(0.0, -0.2),
            Wheel::free("free"),
        ];
        let robot = Robot::new("cart".into(), wheels.to_vec()).unwrap();
        let mut settings = WindowSettings::default();
        change(&mut settings);
        WindowEstimator::new(&robot, settings).unwrap()
    }

    fn take(estimator: &mut WindowEstimator, ms: i64, measurement: Measurement) {
        let time_ns = ms * 1_000_000;
        let output = estimator
            .update(Sample {
                time_ns,
                measurement,
            })
            .unwrap();
        assert!(output.wheels.len() == 3 && output.time_ns >= time_ns);
    }

    /// A second of rims of these speeds, m/s.
    fn drive(estimator: &mut WindowEstimator, rims: [f64; 3]) -> [WheelEstimate; 3] {
        for ms in (0..=1000).step_by(20) {
            for (wheel, rim) in rims.into_iter().enumerate() {
                let angle = rim * 0.001 * ms as f64 / 0.1;
                take(estimator, ms, Measurement::WheelAngle { wheel, angle });
            }
        }
        let latest = estimator.latest().unwrap();
        [0, 1, 2].map(|wheel| latest.wheels[wheel])
    }

    #[test]
    fn health_names_what_a_slip_lacks() {
        let health = |reference, rims| {
            let estimates = drive(&mut estimator(|s| s.reference = reference), rims);
            (estimates[1].health, estimates[1].motion)
        };
        let degraded = |why| Health::Degraded(why);
        let driving = Some(Motion::Driving);
        for (reference, moving) in [
            (Reference::Grip, degraded(Degraded::Relative)),
            (Reference::FreeWheel, degraded(Degraded::YawAssumed)),
        ] {
            assert_eq!(health(reference, [0.3, 0.4, 0.3]), (moving, driving));
            // what is worse stays, and what has no slip lacks nothing
            let slow = degraded(Degraded::LowSpeed);
            assert_eq!(health(reference, [0.007, 0.009, 0.007]), (slow, driving));
            let standing = (Health::Ok, Some(Motion::Standstill));
            assert_eq!(health(reference, [0.0, 0.0, 0.0]), standing);
        }
        // with a gyro nothing is assumed
        let mut estimator = estimator(|_| ());
        for ms in 0..=1000 {
            let rate = 0.0;
            take(&mut estimator, ms, Measurement::YawRate { rate });
        }
        assert_eq!(drive(&mut estimator, [0.4; 3])[1].health, Health::Ok);
    }

    #[test]
    fn the_free_wheel_drives_or_stands_and_has_no_slip() {
        for (rim, motion) in [(0.3, Motion::Driving), (0.0, Motion::Standstill)] {
            let free = drive(&mut estimator(|_| ()), [0.4, 0.4, rim])[2];
            assert_eq!(
                (free.motion, free.slip, free.sigma),
                (Some(motion), None, None)
            );
        }
        // at what stands a setting decides
        let slow = drive(&mut estimator(|s| s.standstill_speed = 0.05), [0.04; 3]);
        assert!(
            slow.iter()
                .all(|wheel| wheel.motion == Some(Motion::Standstill))
        );
        let slow = drive(&mut estimator(|s| s.low_speed = 0.05), [0.045; 3])[0];
        assert_eq!(slow.health, Health::Degraded(Degraded::LowSpeed));
    }

    /// The right wheel's readings end 0.1 s before those of the left, while the ground and the left wheel get faster.
    #[test]
    fn each_wheel_has_its_own_window() {
        let mut estimator = estimator(|s| s.reference = Reference::Speed);
        for ms in (0..=1000).step_by(20) {
            let late = f64::from((i32::try_from(ms).unwrap() - 900).max(0)) * 0.001;
            let way = 0.3 * 0.001 * ms as f64 + late;
            let forward = if ms > 900 { 1.3 } else { 0.3 };
            let left = Some(0.0);
            take(&mut estimator, ms, Measurement::Speed { forward, left });
            take(&mut estimator, ms, Measurement::YawRate { rate: 0.0 });
            if ms <= 900 {
                let angle = way / 0.1;
                take(
                    &mut estimator,
                    ms,
                    Measurement::WheelAngle { wheel: 1, angle },
                );
            }
            let angle = way / 0.1;
            take(
                &mut estimator,
                ms,
                Measurement::WheelAngle { wheel: 0, angle },
            );
        }
        let latest = estimator.latest().unwrap();
        for (wheel, speed, until_ms) in [(0, 0.5, 1000), (1, 0.3, 900)] {
            let wheel = latest.wheels[wheel];
            let near = |seen: Option<Measured>| (seen.unwrap().value - speed).abs() < 1e-3;
            assert!(
                near(wheel.rim_speed) && near(wheel.forward_speed),
                "{wheel:?}"
            );
            assert_eq!(wheel.until_ns, Some(until_ms * 1_000_000));
        }
        assert_eq!(latest.time_ns, 1_000_000_000);
    }
}
