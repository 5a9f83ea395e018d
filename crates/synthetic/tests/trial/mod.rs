//! A run of the slip filter on the five-wheeled robot, with faults, against what is true.

use grouser_slip::filter::{FilterOutput, FilterSettings, SlipFilter};
use grouser_slip::{Health, Sample, WheelEstimate};
use grouser_synthetic::{Camera, Course, Event, Fault, FiveWheel, Sensors, WHEELS, inject};

/// Rows per second.
pub(crate) const RATE: u32 = 100;
/// The free wheel.
pub(crate) const FREE: usize = WHEELS - 1;

/// Faults that last to the end of a run end here, s.
pub(crate) const END_S: f64 = 26.0;

/// When a fault comes, s: at rest, while the speed rises, on the way, while it brakes.
pub(crate) const PHASES: [(&str, f64); 4] = [
    ("start", 0.5),
    ("converge", 2.5),
    ("steady", 9.0),
    ("stop", 21.0),
];

/// What is tried.
#[derive(Clone, Debug)]
pub(crate) struct Trial {
    pub(crate) robot: FiveWheel,
    pub(crate) sensors: Sensors,
    pub(crate) events: Vec<(Event, (f64, f64))>,
    pub(crate) faults: Vec<(Fault, (f64, f64))>,
    pub(crate) settings: FilterSettings,
    /// How much larger each configured radius is than the true one, as a share.
    pub(crate) radius_error: [f64; WHEELS],
}

impl Trial {
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            robot: FiveWheel::test_drive(seed),
            sensors: Sensors {
                seed: seed ^ 0x5eed,
                ..Sensors::default()
            },
            events: Vec::new(),
            faults: Vec::new(),
            settings: FilterSettings::default(),
            radius_error: [0.0; WHEELS],
        }
    }

    pub(crate) fn fault(mut self, fault: Fault, from: f64, to: f64) -> Self {
        self.faults.push((fault, (from, to)));
        self
    }

    pub(crate) fn event(mut self, event: Event, from: f64, to: f64) -> Self {
        self.events.push((event, (from, to)));
        self
    }

    /// The course as it was and what arrives of it.
    pub(crate) fn samples(&self) -> (Course, Vec<Sample>) {
        let run = self.robot.generate();
        let mut course = Course::new(&self.robot, &run);
        for &(event, span) in &self.events {
            course = course.with(event, span);
        }
        let mut samples = self.sensors.samples(&self.robot, &mut course);
        for (index, &(fault, span)) in self.faults.iter().enumerate() {
            samples = inject(&samples, fault, span, self.sensors.bits, index as u64 + 7);
        }
        (course, samples)
    }

    pub(crate) fn filter(&self) -> SlipFilter {
        let mut reported = self.robot.clone();
        for (wheel, error) in reported.wheels.iter_mut().zip(self.radius_error) {
            wheel.radius *= 1.0 + error;
        }
        SlipFilter::new(
            &reported.described(self.sensors.bits).unwrap(),
            self.settings,
        )
        .unwrap()
    }

    /// Runs it where a fault has changed the clocks of samples, but neither their number nor their order.
    pub(crate) fn run_by_true_time(&self) -> Outcome {
        let without = Self {
            faults: Vec::new(),
            ..self.clone()
        };
        let true_ns: Vec<i64> = without.samples().1.iter().map(|s| s.time_ns).collect();
        let (course, samples) = self.samples();
        self.follow_by(&course, &samples, Some(&true_ns))
    }

    /// Runs it; the moments are those of the filter's estimates, one a row.
    pub(crate) fn run(&self) -> Outcome {
        let (course, samples) = self.samples();
        self.follow(&course, &samples)
    }

    /// Runs it; `each` sees every sample and what is known after it, with the time of the estimate, s.
    pub(crate) fn watch(&self, mut each: impl FnMut(f64, &Sample, FilterOutput<'_>)) {
        let (_, samples) = self.samples();
        let mut filter = self.filter();
        for sample in &samples {
            let _ = filter.update(*sample);
            let known = filter.latest();
            let time = known.time_ns.wrapping_sub(self.sensors.start_ns) as f64 * 1e-9;
            each(time, sample, known);
        }
    }

    pub(crate) fn follow(&self, course: &Course, samples: &[Sample]) -> Outcome {
        self.follow_by(course, samples, None)
    }

    /// The same where the clocks are wrong: `true_ns` are the samples' true times, one each.
    pub(crate) fn follow_by(
        &self,
        course: &Course,
        samples: &[Sample],
        true_ns: Option<&[i64]>,
    ) -> Outcome {
        let mut filter = self.filter();
        let rate = f64::from(RATE);
        let mut out = Outcome {
            moments: Vec::with_capacity(course.steps.len()),
            refused: 0,
        };
        let mut last = None;
        let start = self.sensors.start_ns;
        for (index, sample) in samples.iter().enumerate() {
            out.refused += u64::from(filter.update(*sample).is_err());
            let known = filter.latest();
            for wheel in known.wheels {
                assert!(wheel.slip.is_none_or(|slip| slip.value().abs() <= 1.0));
                assert!(
                    wheel
                        .sigma
                        .is_none_or(|sigma| sigma.is_finite() && sigma > 0.0)
                );
            }
            assert!(known.body.forward.value.is_finite() && known.body.forward.variance > 0.0);
            if last == Some(known.time_ns) {
                continue;
            }
            last = Some(known.time_ns);
            let now_ns = match true_ns {
                Some(true_ns) => {
                    let lag = sample.time_ns.saturating_sub(known.time_ns);
                    if !(0..1_000_000_000).contains(&lag) {
                        continue;
                    }
                    true_ns[index] - lag
                }
                None => known.time_ns,
            };
            let time = now_ns.wrapping_sub(start) as f64 * 1e-9;
            let row = (time * rate).round();
            if !(row >= 0.0 && row < course.steps.len() as f64) {
                continue;
            }
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "checked above"
            )]
            let row = row as usize;
            // what the sensors tell of ends at the row
            let row = row.saturating_sub(1);
            let step = &course.steps[row];
            out.moments.push(Moment {
                time,
                wheels: std::array::from_fn(|i| known.wheels[i]),
                truth: std::array::from_fn(|i| course.slip(row, i)),
                speed: step.speed,
                known_speed: (known.body.forward.value, known.body.forward.sigma()),
            });
        }
        out
    }
}

/// What the filter said at a moment, and what was true.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    pub(crate) time: f64,
    pub(crate) wheels: [WheelEstimate; WHEELS],
    pub(crate) truth: [Option<f64>; WHEELS],
    pub(crate) speed: f64,
    pub(crate) known_speed: (f64, f64),
}

impl Moment {
    /// Estimate less truth, and sigma, where both are.
    pub(crate) fn error(&self, wheel: usize) -> Option<(f64, f64)> {
        let estimate = &self.wheels[wheel];
        Some((estimate.slip?.value() - self.truth[wheel]?, estimate.sigma?))
    }
}

pub(crate) struct Outcome {
    pub(crate) moments: Vec<Moment>,
    pub(crate) refused: u64,
}

impl Outcome {
    pub(crate) fn between(&self, from: f64, to: f64) -> impl Iterator<Item = &Moment> {
        self.moments
            .iter()
            .filter(move |moment| moment.time >= from && moment.time < to)
    }

    /// Root mean square of the slips' errors over the powered wheels, above 0.05 m/s.
    pub(crate) fn rms(&self, from: f64, to: f64) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for moment in self.between(from, to).filter(|m| m.speed.abs() > 0.05) {
            for wheel in 0..FREE {
                if let Some((error, _)) = moment.error(wheel) {
                    sum += error * error;
                    count += 1.0;
                }
            }
        }
        (sum / count).sqrt()
    }

    /// Root mean square error of the robot's speed.
    pub(crate) fn speed_rms(&self, from: f64, to: f64) -> f64 {
        let errors: Vec<f64> = self
            .between(from, to)
            .map(|m| m.known_speed.0 - m.speed)
            .collect();
        (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
    }

    /// Mean squared error over variance of the powered wheels' slips.
    pub(crate) fn nees(&self, from: f64, to: f64) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for moment in self.between(from, to).filter(|m| m.speed.abs() > 0.05) {
            for wheel in 0..FREE {
                if let Some((error, sigma)) = moment.error(wheel) {
                    sum += (error / sigma) * (error / sigma);
                    count += 1.0;
                }
            }
        }
        sum / count
    }

    /// The longest time with health Ok and a slip more than four sigma off, of any powered wheel, s, and when it ended.
    pub(crate) fn silence(&self) -> (f64, f64, usize) {
        let mut worst = (0.0, 0.0, 0);
        for wheel in 0..FREE {
            let mut since: Option<f64> = None;
            for moment in &self.moments {
                let lies = moment.wheels[wheel].health == Health::Ok
                    && moment
                        .error(wheel)
                        .is_some_and(|(error, sigma)| error.abs() > 4.0 * sigma);
                if !lies {
                    since = None;
                    continue;
                }
                let lasted = moment.time - *since.get_or_insert(moment.time);
                if lasted > worst.0 {
                    worst = (lasted, moment.time, wheel);
                }
            }
        }
        worst
    }

    /// Share of the powered wheels' slips from `from` to `to` (s) that are Ok and more than four sigma off. Unlike
    /// [`Outcome::silence`] it counts a noisy slip that is within four sigma now and then.
    pub(crate) fn share_wrong(&self, from: f64, to: f64) -> f64 {
        let (mut wrong, mut count) = (0.0, 0.0);
        for moment in self.between(from, to) {
            for wheel in 0..FREE {
                let is_wrong = moment.wheels[wheel].health == Health::Ok
                    && moment
                        .error(wheel)
                        .is_some_and(|(error, sigma)| error.abs() > 4.0 * sigma);
                wrong += f64::from(u8::from(is_wrong));
                count += 1.0;
            }
        }
        wrong / count
    }

    /// Seconds from `from` until `wheel` first has a health for which `is` holds; `None` if never before `to`.
    pub(crate) fn delay(
        &self,
        wheel: usize,
        (from, to): (f64, f64),
        is: impl Fn(Health) -> bool,
    ) -> Option<f64> {
        self.between(from, to)
            .find(|moment| is(moment.wheels[wheel].health))
            .map(|moment| moment.time - from)
    }
}

/// A run with a camera beside the free wheel, 20 pictures a second.
pub(crate) fn with_camera(seed: u64) -> Trial {
    let mut trial = Trial::new(seed);
    trial.sensors.camera = Some(Camera {
        every: 5,
        sigma: 0.001,
        late: 0,
    });
    trial
}

/// No powered wheel lies for longer than a second.
pub(crate) fn honest(out: &Outcome, what: &str) {
    let (lasted, at, wheel) = out.silence();
    assert!(
        lasted <= 1.0,
        "{what}: wheel {wheel} Ok and wrong for {lasted:.2} s until {at:.2} s"
    );
}
