//! What is counted of a run and handed to its sink.

use grouser_doctor::{Findings, KnownStep};
use grouser_files::robot::RobotFile;
use grouser_slip::onboard::SoilEstimate;
use grouser_slip::{
    Health, Invalid, Measurement, Motion, Reference, Robot, Sample, SensorSettings, Slip, WheelRole,
};

use crate::checks::{Doubt, WayCheck};
use crate::choice::Inputs;
use crate::error::Result;
use crate::ground_watch::GroundWatch;
use crate::moment::{Moment, side_slip_angle};
use crate::odometry::Odometry;
use crate::options::Options;
use crate::sink::{Row, Sink, Step};
use crate::summary::{FusedSummary, Status, Summary};
use crate::tally::Tally;
use crate::ways::Ways;

/// The record of a run.
pub(crate) struct Record {
    robot: Robot,
    inputs: Inputs,
    low_speed: f64,
    interval_factor: f64,
    span: (f64, f64),
    start_ns: Option<i64>,
    end_ns: Option<i64>,
    longest_gap_s: f64,
    tallies: Vec<Tally>,
    ways: Ways,
    ground: GroundWatch,
    /// Was the place measured without a heading?
    has_places: bool,
    /// Where the span began, and the last path since then.
    origin: Option<Odometry>,
    odometry: Option<Odometry>,
    /// Cosine and sine of each wheel's heading.
    headings: Vec<(f64, f64)>,
}

impl Record {
    pub(crate) fn new(
        file: &RobotFile,
        inputs: Inputs,
        settings: &SensorSettings,
        options: &Options,
    ) -> Self {
        let wheels = file.robot.wheels();
        let heading = |wheel: &grouser_slip::Wheel| (wheel.heading.cos(), wheel.heading.sin());
        Self {
            inputs,
            low_speed: settings.low_speed,
            // it was found of online slips
            interval_factor: if options.offline {
                1.0
            } else {
                file.corrections.interval_factor
            },
            span: (
                options.from_s.unwrap_or(f64::NEG_INFINITY),
                options.to_s.unwrap_or(f64::INFINITY),
            ),
            start_ns: None,
            end_ns: None,
            longest_gap_s: 0.0,
            tallies: vec![Tally::new(); wheels.len()],
            ways: Ways::new(settings, wheels.len()),
            ground: GroundWatch::new(&file.robot, settings.low_speed),
            has_places: false,
            origin: None,
            odometry: None,
            headings: wheels.iter().map(heading).collect(),
            robot: file.robot.clone(),
        }
    }

    /// Time has come to that of the next sample.
    pub(crate) fn reach(&mut self, time_ns: i64) {
        self.start_ns.get_or_insert(time_ns);
        if let Some(last) = self.end_ns.replace(time_ns) {
            let gap_s = time_ns.saturating_sub(last) as f64 * 1e-9;
            self.longest_gap_s = self.longest_gap_s.max(gap_s);
        }
    }

    /// Takes a sample that is used.
    pub(crate) fn take(&mut self, sample: &Sample) {
        self.ground.take(sample);
        self.has_places |= matches!(sample.measurement, Measurement::Position { .. });
    }

    /// Does the reference measure a heading?
    pub(crate) fn has_heading(&self) -> bool {
        !(self.has_places && self.inputs.reference == Reference::Displacement)
    }

    /// Seconds from the log's start, and whether they lie in the span.
    pub(crate) fn when(&self, time_ns: i64) -> (f64, bool) {
        let start_ns = self.start_ns.unwrap_or(time_ns);
        let time_s = time_ns.saturating_sub(start_ns) as f64 * 1e-9;
        (time_s, time_s >= self.span.0 && time_s <= self.span.1)
    }

    /// Takes a step of the online filter, of which the ground is judged.
    pub(crate) fn judge_ground(&mut self, end_ns: i64, known: &KnownStep<'_>) {
        let (time_s, is_wanted) = self.when(end_ns);
        let wheels = known.step.wheels.iter().filter(|wheel| !wheel.is_free);
        let distances = wheels.filter_map(|wheel| wheel.distance);
        let (sum, count) =
            distances.fold((0.0, 0.0), |(sum, count), of| (sum + of.abs(), count + 1.0));
        if is_wanted && count > 0.0 {
            let speed = sum / (count * known.step.dt);
            self.ground.step(end_ns, time_s, speed);
        }
    }

    /// Counts the distances of a step.
    pub(crate) fn count(&mut self, end_ns: i64, known: &KnownStep<'_>) {
        let (_, is_wanted) = self.when(end_ns);
        self.ways.take(known, is_wanted);
    }

    /// Distances so far by wheels and estimate, m.
    pub(crate) const fn travel(&self) -> [f64; 2] {
        self.ways.travel()
    }

    /// Counts a moment and hands it to the sink.
    pub(crate) fn deliver(
        &mut self,
        moment: &mut Moment,
        (is_unused, soil): (bool, Option<SoilEstimate>),
        sink: &mut impl Sink,
    ) -> Result<()> {
        let now = moment.time_ns;
        let (time_s, is_wanted) = self.when(now);
        let robot = self.robot.wheels();
        for (wheel, described) in moment.wheels.iter_mut().zip(robot) {
            if is_unused && wheel.slip.is_some() {
                (wheel.slip, wheel.sigma) = (None, None);
                wheel.health = Health::Invalid(Invalid::NoReference);
            }
            let factor = self.interval_factor;
            wheel.sigma = wheel.sigma.map(|sigma| factor * sigma);
            // against itself a reference does not slip
            if described.role == WheelRole::Free && self.inputs.reference == Reference::FreeWheel {
                (wheel.slip, wheel.sigma) = (None, None);
                if wheel.motion == Some(Motion::Braking) {
                    wheel.motion = Some(Motion::Driving);
                }
            }
        }
        let motion = moment.motion.as_ref().filter(|_| !is_unused);
        let low_speed = self.low_speed;
        for (index, tally) in self.tallies.iter_mut().enumerate() {
            if moment.read >> index & 1 == 0 {
                continue;
            }
            let lasts_s = tally.read(now);
            if !is_wanted {
                continue;
            }
            let wheel = &moment.wheels[index];
            let row = Row {
                time_s,
                lasts_s,
                wheel: index,
                name: &robot[index].name,
                slip: wheel.slip.map(Slip::value),
                slip_sigma: wheel.sigma,
                motion: wheel.motion,
                health: wheel.health,
                side_slip_angle: side_slip_angle(
                    &robot[index],
                    self.headings[index],
                    motion,
                    low_speed,
                ),
            };
            tally.add(&row);
            sink.row(&row)?;
        }
        if moment.read != 0 && is_wanted {
            let path = moment.odometry.as_ref();
            let odometry = path.map(|of| of.since(self.origin.get_or_insert(*of)));
            self.odometry = odometry.or(self.odometry);
            sink.step(&Step {
                time_ns: now,
                time_s,
                wheels: &moment.wheels,
                odometry,
                soil,
            })?;
        }
        Ok(())
    }

    /// The distances by wheels, estimate and reference.
    pub(crate) const fn way_check(&self) -> WayCheck {
        self.ways.check()
    }

    /// The summary of the run; the variance is that of the distance over ground, m².
    pub(crate) fn summary(
        self,
        fused: FusedSummary,
        soil: Option<SoilEstimate>,
        findings: Findings,
        travel_variance: Option<f64>,
    ) -> Summary {
        let is_unused = fused.doubts.contains(&Doubt::ReferenceUnused);
        let reference = self.inputs.reference;
        let wheels = self.robot.wheels().iter().zip(&self.tallies);
        Summary {
            status: if self.tallies.iter().any(Tally::has_slip) {
                Status::Done
            } else {
                Status::NoSlip
            },
            reference,
            wheel_sensor: self.inputs.wheel_sensor.name(),
            duration_s: match (self.start_ns, self.end_ns) {
                (Some(start), Some(end)) => end.saturating_sub(start) as f64 * 1e-9,
                _ => 0.0,
            },
            longest_gap_s: self.longest_gap_s,
            wheels: wheels
                .map(|(wheel, tally)| {
                    let is_free = wheel.role == WheelRole::Free;
                    tally.summary(wheel, is_free && reference == Reference::FreeWheel)
                })
                .collect(),
            // where nothing of an absolute reference was used, there is no distance
            along: (self.ways).along(reference != Reference::Grip && !is_unused, travel_variance),
            yaw: self.ways.yaw(),
            findings,
            ground_changes_s: self.ground.called_s().to_vec(),
            clock_offset_s: None,
            reference_delay: None,
            held_reference: None,
            odometry: self.odometry.filter(|_| !is_unused),
            rejected: fused.rejected,
            fused,
            soil,
        }
    }
}
