//! The robot's motion over the ground by an absolute reference: the rims' way and the reference's positions in the
//! multiple-model estimator, for robots without a free wheel.

mod heading;
mod place;
mod place_frame;
mod refused_series;
mod restart;
mod slide;
mod speed;

use alloc::boxed::Box;

use grouser_real::Real;

use super::MAX_FILTER_WHEELS;
use super::force_integral::ForceIntegral;
use super::mean_rims::{RimStep, mean_rims};
use super::multiple_model::reference_noise::{Errors, ReferenceNoise};
use super::multiple_model::{
    ModelMotion, MultipleModel, Rim, TURNING_SPEED_M_PER_S, TurnError, WheelStep,
};
use super::output::RimPath;
use super::reference_sensor::ReferenceMotion;
use super::settings::FilterSettings;
use super::wheel_bank::WheelBank;
use super::wheel_channel::WheelChannel;
use crate::history::{History, seconds_between};
use crate::sample::Measurement;

use place_frame::PlaceFrame;
use refused_series::{RefusedSeries, is_accepted};

/// The models are predicted this often, s: rims and slips change slowly against it.
const STEP_S: f64 = 0.005;
/// Positions are used at most this often, s: errors of faster ones are correlated.
const POSITION_PERIOD_S: f64 = 0.1;
/// Without a reference for this long the slip may be another one, s, and a place that returns begins anew.
const MAX_PREDICTION_S: f64 = 5.0;
/// A reference that was refused or silent is readmitted with a reservation for this long, and one that starts for this
/// long, s.
const READMITTED_S: f64 = 5.0;
const STARTED_S: f64 = 2.0;
/// A reference is silent after this many of its periods.
const SILENT_PERIODS: f64 = 2.5;
/// Standard deviation of a heading, rad: measured, where its own readings do not show a larger one, and summed from
/// displacements.
const MEASURED_HEADING_SIGMA_RAD: f64 = 0.01;
const SUMMED_HEADING_SIGMA_RAD: f64 = 1e-3;
/// A measured heading that was wrong this often is not used beside a gyro: many poses have none.
const MAX_HEADING_RESTARTS: u32 = 2;
/// After an outage, a heading with a larger standard deviation is estimated from the course again, rad.
const MAX_HEADING_SIGMA_RAD: f64 = 0.3;
/// The rims' change within their lag is at most this multiple of their speed's difference from that of about the lag before, which
/// shows it late: errors on random logs differ by 1 % between 1.5 and 6.
const RISE_FACTOR: f64 = 3.0;
/// Readings of the reference that wait for the rims at most: those at 20 Hz between rims read at 3 Hz.
const MAX_AWAITING: usize = 6;
/// A reading that comes after this many periods may be the first of several that were held up.
const LATE_PERIODS: f64 = 1.3;
/// Places that are stamped within this share of their period come from one queue.
const QUEUE_SHARE: f64 = 0.1;
/// Entries of the history at most, and its time, s: the longest delay and a window of the rims.
const MAX_HISTORY_ENTRIES: usize = 512;
const HISTORY_S: f64 = MAX_DELAY_S + 0.5;
/// The longest delay of a reading that is still used, s.
pub(super) const MAX_DELAY_S: f64 = 1.0;

/// The inertial measurements of a step.
#[derive(Clone, Copy)]
pub(super) struct Inertial {
    pub(super) yaw_rate: f64,
    /// As the sensor has it that the error is of, rad/s.
    pub(super) turn_rate: f64,
    pub(super) turn_error: TurnError,
    /// Turn per way forwards, rad/m, of a robot that turns as it is steered.
    pub(super) curvature: Option<f64>,
}

/// What became of a reading of the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// It changed nothing: the first, a repeated one, or one too soon after the last.
    Unused,
    Refused,
    Accepted,
}

/// A reading of the reference that waits for the rims: its stamp, itself, and the motion since the one before.
pub(super) type Awaiting = (i64, Measurement, Option<ReferenceMotion>);

/// Models, rims and the reference's own state.
#[derive(Clone, Debug)]
pub(super) struct GroundTrack {
    models: MultipleModel,
    history: History<4>,
    stepped_ns: Option<i64>,
    /// Travel of each rim at the last step, m.
    travels: [f64; MAX_FILTER_WHEELS],
    direction: f64,
    rim_speed: f64,
    /// Has the rims' motion been measured? Models that start without it would start at rest.
    has_rims: bool,
    pub(super) force: ForceIntegral,
    heading_noise: ReferenceNoise<1>,
    speed_noise: ReferenceNoise<1>,
    /// By how much the middle of the rims' windows lies behind, s, and their speed about as much before, m/s.
    rim_lag: f64,
    slow_rim_speed: f64,
    /// Readings of the reference that wait for the next reading of the rims, which shows their way until then.
    awaiting: [Option<Awaiting>; MAX_AWAITING],
    /// A speed that waits until the rims' windows around it have ended: its time, and itself, m/s.
    awaited_speed: Option<(i64, f64)>,
    /// Sum of displacements: place and heading.
    summed: [f64; 3],
    position: [f64; 2],
    /// The first position of those that are refused, and the rims' way until then, m; or the last position that showed a slide.
    refused_position: [f64; 2],
    refused_way: f64,
    refused_ns: i64,
    refused_speeds: RefusedSeries,
    /// The robot's speed while its rims stand, m/s, and when it was shown last.
    slide: Option<(f64, i64)>,
    heading_offset: f64,
    places: PlaceFrame,
    /// The first heading that was measured, and whether it has changed since.
    first_heading: Option<f64>,
    has_heading: bool,
    used_ns: Option<i64>,
    received_ns: Option<i64>,
    accepted_ns: Option<i64>,
    period_s: f64,
    repeats_at_rest: bool,
    /// Positions and headings that contradict the models one after the other.
    refused: RefusedSeries,
    refused_headings: RefusedSeries,
    /// Headings in a row that agreed with the turn rate.
    agreed_headings: u32,
    /// How often the models restarted along the course.
    restarts: u32,
    started_ns: Option<i64>,
    readmitted_ns: Option<i64>,
}

impl GroundTrack {
    /// Not inlined: its 17 kB would be on the stack also where a robot has a free wheel instead.
    #[inline(never)]
    pub(super) fn boxed(settings: &FilterSettings) -> Box<Self> {
        Box::new(Self {
            models: MultipleModel::new([settings.slip.mean, settings.slip.sigma]),
            history: History::of_rate(HISTORY_S, settings.max_rate, MAX_HISTORY_ENTRIES),
            stepped_ns: None,
            travels: [0.0; MAX_FILTER_WHEELS],
            direction: 0.0,
            rim_speed: 0.0,
            has_rims: false,
            force: ForceIntegral::new(settings.max_rate),
            heading_noise: ReferenceNoise::new(),
            speed_noise: ReferenceNoise::new(),
            rim_lag: 0.0,
            slow_rim_speed: 0.0,
            awaiting: [None; MAX_AWAITING],
            awaited_speed: None,
            summed: [0.0; 3],
            position: [0.0; 2],
            refused_position: [0.0; 2],
            refused_way: 0.0,
            refused_ns: i64::MIN,
            refused_speeds: RefusedSeries::default(),
            slide: None,
            heading_offset: 0.0,
            places: PlaceFrame::default(),
            first_heading: None,
            has_heading: false,
            used_ns: None,
            received_ns: None,
            accepted_ns: None,
            period_s: 0.0,
            repeats_at_rest: false,
            refused: RefusedSeries::default(),
            refused_headings: RefusedSeries::default(),
            agreed_headings: 0,
            restarts: 0,
            started_ns: None,
            readmitted_ns: None,
        })
    }

    /// The clock was set: times are forgotten, and the place may have changed.
    pub(super) fn restart_clock(&mut self) {
        self.models.restart();
        self.history.clear();
        self.stepped_ns = None;
        self.has_rims = false;
        self.force.restart_clock();
        self.used_ns = None;
        self.received_ns = None;
        self.accepted_ns = None;
        self.started_ns = None;
        self.readmitted_ns = None;
        self.refused_ns = i64::MIN;
        self.refused.end();
        self.awaiting = [None; MAX_AWAITING];
        self.awaited_speed = None;
    }

    /// A reading waits for the rims; `false` where no other can. Of places at one moment, which a stall of the network or a backlog had
    /// held up, the last is the youngest.
    pub(super) fn put_off(&mut self, reading: Awaiting) -> bool {
        if let Some(Some(last)) = self.awaiting.iter_mut().rfind(|place| place.is_some())
            && is_place(&last.1)
            && is_place(&reading.1)
            && seconds_between(last.0, reading.0) < QUEUE_SHARE * self.period_s
        {
            *last = reading;
            return true;
        }
        let mut places = self.awaiting.iter_mut().filter(|place| place.is_none());
        if let Some(place) = places.next() {
            *place = Some(reading);
        }
        places.next().is_some()
    }

    /// The stamp of the last reading that waits.
    pub(super) fn last_awaiting_ns(&self) -> Option<i64> {
        let last = self.awaiting.iter().rev().find_map(|place| place.as_ref());
        last.map(|(stamp_ns, ..)| *stamp_ns)
    }

    /// The first reading that waits.
    pub(super) fn next_awaiting(&mut self) -> Option<Awaiting> {
        let first = self.awaiting[0].take();
        self.awaiting.rotate_left(1);
        first
    }

    /// The motion by the models with its direction, once a reference was accepted. Without one they go on by the rims: the slip is the last
    /// one at first, and then fades into its prior.
    pub(super) fn motion(
        &self,
        now_ns: i64,
        settings: &FilterSettings,
    ) -> Option<(ModelMotion, f64, f64)> {
        let mut motion = self.fading_motion(now_ns, settings)?;
        if let Some(speed) = self.slide(now_ns) {
            (motion.speed, motion.slip) = (speed, -1.0);
        }
        Some((motion, self.direction, self.rim_speed))
    }

    fn fading_motion(&self, now_ns: i64, settings: &FilterSettings) -> Option<ModelMotion> {
        let outage = seconds_between(self.accepted_ns?, now_ns) - MAX_PREDICTION_S;
        let kept = Real::exp(-outage.max(0.0) / settings.slip_memory);
        self.models.fading_motion(kept)
    }

    /// Has the last heading shown that the turn rate is wrong?
    pub(super) const fn has_wrong_turn(&self) -> bool {
        self.has_heading && self.refused_headings.is_steady()
    }

    /// The rims' way, once the models have started.
    pub(super) fn rim_path(&self) -> Option<RimPath> {
        let [x, y, turned, way] = self.models.totals();
        self.models
            .has_started()
            .then_some(RimPath { x, y, turned, way })
    }

    /// Is a reading of this stamp so late that others may come with it?
    pub(super) fn is_late(&self, stamp_ns: i64) -> bool {
        let silence = |last_ns| seconds_between(last_ns, stamp_ns);
        self.period_s > 0.0
            && self
                .received_ns
                .is_some_and(|last_ns| silence(last_ns) > LATE_PERIODS * self.period_s)
    }

    /// The time without a reading after which the reference is silent, s.
    pub(super) fn silent_after(&self) -> f64 {
        SILENT_PERIODS * self.period_s.min(1.0)
    }

    /// Did the reference start or return a short time ago?
    pub(super) fn is_readmitted(&self, now_ns: i64) -> bool {
        let within = |since: Option<i64>, time| {
            since.is_some_and(|since| seconds_between(since, now_ns) < time)
        };
        within(self.readmitted_ns, READMITTED_S) || within(self.started_ns, STARTED_S)
    }

    /// The rims' mean speed over a window along their direction, less the present slip, forwards and to the left, m/s: the
    /// robot's motion if the slip did not change within it.
    pub(super) fn mean_motion(
        &self,
        (from_ns, to_ns): (i64, i64),
        settings: &FilterSettings,
    ) -> Option<[f64; 2]> {
        let to_ns = to_ns.min(self.stepped_ns?);
        let way = self.history.between(from_ns, to_ns)?[3];
        let window = seconds_between(from_ns, to_ns);
        let motion = self
            .fading_motion(to_ns, settings)
            .filter(|_| window > 0.0)?;
        let rim = way / window;
        let speed = rim * motion.rim_share;
        let (sin, cos) = Real::sin_cos(self.direction);
        let across = motion.drift * speed;
        Some([cos * speed - sin * across, sin * speed + cos * across])
    }

    /// Predicts the models up to `now_ns` by rims and inertial sensors.
    pub(super) fn step(
        &mut self,
        now_ns: i64,
        wheels: &WheelBank,
        inertial: Inertial,
        settings: &FilterSettings,
    ) {
        let travels = core::array::from_fn(|i| {
            let wheel = wheels.channels.get(i);
            wheel.map_or(0.0, |wheel| travel_at(wheel, now_ns))
        });
        let Some(last_ns) = self.stepped_ns else {
            self.stepped_ns = Some(now_ns);
            self.travels = travels;
            return;
        };
        let dt = seconds_between(last_ns, now_ns);
        if dt < STEP_S {
            return;
        }
        self.stepped_ns = Some(now_ns);
        let before = core::mem::replace(&mut self.travels, travels);
        let ways = core::array::from_fn(|i| travels[i] - before[i]);
        let step = RimStep {
            now_ns,
            dt,
            ways,
            yaw_rate: inertial.yaw_rate,
            rim_share: self.models.motion().map_or(1.0, |motion| motion.rim_share),
            direction: self.direction,
        };
        let density = self.force.density(settings);
        let force = self
            .force
            .step(now_ns, self.direction, (dt, settings.dropout));
        let gained_since = |wheel: &WheelChannel| {
            let force = force?;
            let (from_ns, to_ns) = wheel.rim_span()?;
            let gained = self.force.gained_since(from_ns, to_ns);
            Some(gained.unwrap_or(wheel.rim_lag(now_ns) * force))
        };
        let Some(rims) = mean_rims(&step, wheels, gained_since) else {
            return;
        };
        self.direction = rims.direction;
        self.rim_speed = rims.speed;
        self.rim_lag = rims.lag;
        self.slow_rim_speed += dt / (dt + rims.lag) * (rims.speed - self.slow_rim_speed);
        self.has_rims = true;
        // windows overlap from step to step: their errors are the same
        let repeats = (settings.wheel_window / dt).max(1.0);
        self.models.advance(&WheelStep {
            dt,
            rim_way: rims.way,
            direction: rims.direction,
            turn: inertial.turn_rate * dt,
            turn_error: inertial.turn_error,
            curvature: (inertial.curvature).map(|curvature| curvature * Real::cos(rims.direction)),
            acceleration: force.map(|force| (force, density)),
            rim: Rim {
                speed: rims.speed,
                variance: rims.variance * repeats,
                lag: rims.lag,
                rise: RISE_FACTOR * (rims.speed - self.slow_rim_speed),
                gained: rims.gained,
            },
            max_slip: rims.max_slip,
        });
        self.history.push(now_ns, self.models.totals());
        self.use_awaited_speed(false, settings);
    }

    /// Uses a measurement that was taken at `taken_ns` and arrives now.
    pub(super) fn update(
        &mut self,
        taken_ns: i64,
        measurement: &Measurement,
        (now_ns, has_gyro): (i64, bool),
        settings: &FilterSettings,
    ) -> Outcome {
        let then = self
            .history
            .at(taken_ns.min(self.stepped_ns.unwrap_or(taken_ns)));
        let now = self.models.totals();
        let since = then.map_or([0.0; 4], |then| core::array::from_fn(|i| now[i] - then[i]));
        if !self.has_rims {
            return Outcome::Unused;
        }
        if let Measurement::Speed { forward, .. } = *measurement {
            return self.update_speed((taken_ns, forward), now_ns, settings);
        }
        let Some((place, yaw, heading_sigma)) =
            self.place_by(measurement, (taken_ns, now_ns), (now, since), settings)
        else {
            return Outcome::Unused;
        };
        let turns = self.rim_speed.abs() > TURNING_SPEED_M_PER_S;
        let repeats = self.received_ns.is_some()
            && place[0].to_bits() == self.position[0].to_bits()
            && place[1].to_bits() == self.position[1].to_bits();
        self.position = place;
        self.received_ns = Some(taken_ns);
        if repeats && turns && !self.repeats_at_rest {
            return Outcome::Unused;
        }
        // places are repeated between their readings
        let is_reading = !matches!(measurement, Measurement::Position { .. });
        self.repeats_at_rest |= repeats && !turns && is_reading;
        if self.started_ns.is_none() || !self.models.has_started() {
            let heading = yaw.unwrap_or(0.0);
            self.start(now_ns, place, (heading, heading_sigma), settings);
            self.used_ns = Some(taken_ns);
            return Outcome::Accepted;
        }
        let passed = self
            .used_ns
            .map_or(POSITION_PERIOD_S, |used| seconds_between(used, taken_ns));
        if passed < POSITION_PERIOD_S - 0.5 * STEP_S {
            return Outcome::Unused;
        }
        self.used_ns = Some(taken_ns);
        let silent = self.period_s > 0.0 && passed > SILENT_PERIODS * self.period_s;
        if silent && passed > settings.dropout + settings.failure {
            self.end_outage((passed, now_ns), place, since, settings);
        } else if self.period_s > 0.0 {
            self.period_s += 0.2 * (passed - self.period_s);
        } else {
            self.period_s = passed;
        }
        let errors = Errors::of(measurement);
        let heading_sigma = yaw.map_or(heading_sigma, |yaw| {
            let turned = now[2] - since[2];
            self.heading_sigma((yaw - turned, heading_sigma), errors)
        });
        // between two rows of the wheels their way is not known better than by its bend
        let [bend_x, bend_y, ..] = self.history.bend_at(taken_ns);
        let agreement = self.models.update_position(
            place,
            (since, seconds_between(taken_ns, now_ns)),
            (errors, settings.position_sigma, Real::hypot(bend_x, bend_y)),
        );
        if let Some(yaw) = yaw.filter(|_| !has_gyro || self.restarts < MAX_HEADING_RESTARTS) {
            self.update_heading((yaw, since[2]), heading_sigma, settings);
        } else {
            self.refused_headings.end();
        }
        let refused = self.refused.len();
        if self.refused.accepts(agreement.inlier) {
            if f64::from(refused) * passed > settings.failure {
                self.readmitted_ns = Some(now_ns);
            }
            self.accepted_ns = Some(now_ns);
            if self.slide(now_ns).is_some() {
                self.show_slide(place, (taken_ns, now_ns), settings);
            }
            return Outcome::Accepted;
        }
        if refused == 0 && !self.may_slide_on(taken_ns) {
            self.refused_position = place;
            self.refused_way = now[3];
            self.refused_ns = taken_ns;
        }
        if errors == Errors::Summed {
            // the sum holds the outlier from now on: the next displacement starts where the models are
            let [x, y] = self.models.place(since);
            self.summed = [x, y, self.summed[2]];
        }
        if self.refused.is_steady() {
            self.restart_along_course((taken_ns, now_ns), place, yaw, settings);
        }
        Outcome::Refused
    }

    /// The reference returns with a place after `passed` seconds. Where the models had predicted it, nothing is in doubt; where not,
    /// robot or frame may have moved by any part of the rims' way.
    fn end_outage(
        &mut self,
        (passed, now_ns): (f64, i64),
        place: [f64; 2],
        since: [f64; 4],
        settings: &FilterSettings,
    ) {
        let sigma = self.models.position_sigma();
        let sigma = sigma.unwrap_or(settings.position_sigma);
        let inlier = self.models.position_agreement(place, since, sigma);
        if passed <= MAX_PREDICTION_S && is_accepted(inlier) {
            self.models.inflate_position(0.0);
            return;
        }
        self.models.inflate_position(passed * self.rim_speed.abs());
        self.readmitted_ns = Some(now_ns);
    }
}

/// Does it say where the robot is? A displacement adds to those before.
const fn is_place(measurement: &Measurement) -> bool {
    matches!(
        measurement,
        Measurement::Pose { .. } | Measurement::Position { .. }
    )
}

/// The travel of a rim at `now_ns`, m: that of its last reading, and its speed since.
fn travel_at(wheel: &WheelChannel, now_ns: i64) -> f64 {
    let since = wheel
        .silence(now_ns)
        .filter(|silence| (0.0..=wheel.track.gap()).contains(silence));
    let rim = wheel.rim.map_or(0.0, |(rim, _)| rim.value);
    wheel.track.travel() + since.unwrap_or(0.0) * rim
}

#[cfg(test)]
pub(super) mod tests;
