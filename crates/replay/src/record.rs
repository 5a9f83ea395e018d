//! What is counted of a run and handed to its sink.

use grouser_doctor::Findings;
use grouser_files::robot::RobotFile;
use grouser_slip::onboard::SoilEstimate;
use grouser_slip::window::{WindowBody, WindowSettings};
use grouser_slip::{
    Health, Invalid, Measurement, Motion, Reference, Rejected, Robot, Sample, Slip, WheelRole,
};

use crate::checks::WayCheck;
use crate::choice::Inputs;
use crate::error::Result;
use crate::ground_watch::GroundWatch;
use crate::method::Method;
use crate::moment::{Moment, side_slip_angle};
use crate::odometry::Odometry;
use crate::options::Options;
use crate::reckoning::Reckoning;
use crate::sink::{Row, Sink, Step};
use crate::summary::{FusedSummary, Status, Summary};
use crate::tally::Tally;
use crate::ways::Ways;

/// What was estimated by the end of a run.
pub(crate) struct Estimated {
    pub(crate) method: Method,
    pub(crate) fused: Option<FusedSummary>,
    pub(crate) rejected: Rejected,
    pub(crate) soil: Option<SoilEstimate>,
    /// Was nothing of an absolute reference used?
    pub(crate) is_unused: bool,
}

/// The record of a run.
pub(crate) struct Record {
    robot: Robot,
    inputs: Inputs,
    settings: WindowSettings,
    interval_factor: f64,
    span: (f64, f64),
    start_ns: Option<i64>,
    end_ns: Option<i64>,
    longest_gap_s: f64,
    tallies: Vec<Tally>,
    ways: Ways,
    ground: GroundWatch,
    reckoning: Reckoning,
    odometry: Option<Odometry>,
    /// Cosine and sine of each wheel's heading.
    headings: Vec<(f64, f64)>,
}

impl Record {
    pub(crate) fn new(
        file: &RobotFile,
        inputs: Inputs,
        (settings, options): (WindowSettings, &Options),
        reckoning: Reckoning,
    ) -> Self {
        let wheels = file.robot.wheels();
        let heading = |wheel: &grouser_slip::Wheel| (wheel.heading.cos(), wheel.heading.sin());
        Self {
            inputs,
            settings,
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
            ways: Ways::new(settings.low_speed, settings.window),
            ground: GroundWatch::new(&file.robot, settings.low_speed),
            reckoning,
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
        if let Measurement::Position { x, y } = sample.measurement {
            self.reckoning.take_place(sample.time_ns, [x, y]);
        }
    }

    /// Does the filter go by places without a heading?
    pub(crate) fn is_by_places(&self) -> bool {
        self.reckoning.is_by_places()
    }

    /// Seconds from the log's start, and whether they lie in the span.
    pub(crate) fn when(&self, time_ns: i64) -> (f64, bool) {
        let start_ns = self.start_ns.unwrap_or(time_ns);
        let time_s = time_ns.saturating_sub(start_ns) as f64 * 1e-9;
        (time_s, time_s >= self.span.0 && time_s <= self.span.1)
    }

    /// Counts the means over the window that ended last, the wheels' speeds over it, m/s, and the whole ways by wheels and
    /// reference, m.
    pub(crate) fn count(
        &mut self,
        now_ns: i64,
        body: &WindowBody,
        wheel_speeds: &[Option<f64>],
        travel: (f64, f64),
    ) {
        let (time_s, is_wanted) = self.when(now_ns);
        if is_wanted {
            let wheels = self.robot.wheels().iter().zip(wheel_speeds);
            let powered = wheels.filter(|(wheel, _)| wheel.role == WheelRole::Powered);
            let speeds = powered.filter_map(|(_, speed)| *speed);
            let count = speeds.clone().count();
            if count > 0 {
                let size: f64 = speeds.clone().map(f64::abs).sum();
                self.ground.step(now_ns, time_s, size / count as f64);
            }
            self.ways.count(body, speeds);
            self.ways.travel(travel);
        } else if time_s < self.span.0 {
            self.ways.wait(travel);
        }
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
        let low_speed = self.settings.low_speed;
        for (index, tally) in self.tallies.iter_mut().enumerate() {
            if moment.read >> index & 1 == 0 {
                continue;
            }
            let since = tally.read(now);
            if !is_wanted {
                continue;
            }
            let wheel = &moment.wheels[index];
            let row = Row {
                time_s,
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
            // A gap in the log is no time in a state.
            tally.add(&row, since.min(self.settings.window));
            sink.row(&row)?;
        }
        if moment.read != 0 && is_wanted {
            let odometry = self.reckoning.step(moment);
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

    /// The ways by filter and reference.
    pub(crate) fn way_check(&self) -> WayCheck {
        self.reckoning.ways()
    }

    /// Are the ways those by places without a heading?
    pub(crate) fn has_ways_by_places(&self) -> bool {
        self.reckoning.ways_by_places().is_some()
    }

    /// The summary of the run.
    pub(crate) fn summary(self, estimated: Estimated, findings: Findings) -> Summary {
        let Estimated {
            method,
            fused,
            rejected,
            soil,
            is_unused,
        } = estimated;
        let reference = self.inputs.reference;
        let by_places = self.reckoning.ways_by_places();
        let wheels = self.robot.wheels().iter().zip(&self.tallies);
        Summary {
            status: if self.tallies.iter().any(Tally::has_slip) {
                Status::Done
            } else {
                Status::NoSlip
            },
            method,
            window_s: self.settings.window,
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
            // Where nothing of an absolute reference was used, there is no way.
            along: (self.ways).along(
                reference != Reference::Grip && !is_unused,
                by_places.as_ref(),
            ),
            yaw: self.ways.yaw(),
            findings,
            ground_changes_s: self.ground.called_s().to_vec(),
            clock_offset_s: None,
            reference_delay: None,
            held_reference: None,
            odometry: self.odometry.filter(|_| !is_unused),
            fused,
            soil,
            rejected,
        }
    }
}
