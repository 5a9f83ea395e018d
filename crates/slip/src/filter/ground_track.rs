//! The robot's motion over the ground by an absolute reference: the rims' way and the reference's positions in the
//! multiple-model estimator, for robots without a free wheel.

use alloc::boxed::Box;

use grouser_real::Real;

use super::MAX_FILTER_WHEELS;
use super::force_integral::ForceIntegral;
use super::mean_rims::{RimStep, TURNING_SPEED_M_PER_S, mean_rims};
use super::multiple_model::reference_noise::{Errors, ReferenceNoise};
use super::multiple_model::{ModelMotion, MultipleModel, Rim, TurnError, WheelStep};
use super::output::RimPath;
use super::place_frame::PlaceFrame;
use super::reference_sensor::ReferenceMotion;
use super::settings::FilterSettings;
use super::wheel_bank::WheelBank;
use super::wheel_channel::WheelChannel;
use crate::history::{History, nanoseconds, seconds_between};
use crate::sample::Measurement;

/// The models are predicted this often, s: rims and slips change slowly against it.
const STEP_S: f64 = 0.005;
/// Positions are used at most this often, s: errors of faster ones are correlated.
const POSITION_PERIOD_S: f64 = 0.1;
/// A reading with a larger probability of being an outlier is refused.
const MAX_OUTLIER_PROBABILITY: f64 = 0.5;
/// Without a reference for this long the motion is no longer that of the models, s.
const MAX_PREDICTION_S: f64 = 5.0;
/// A reference that was refused or silent is readmitted with a reservation for this long, and one that starts for this
/// long, s.
const READMITTED_S: f64 = 5.0;
const STARTED_S: f64 = 2.0;
/// A reference is silent after this many of its periods.
const SILENT_PERIODS: f64 = 2.5;
/// Positions that are refused for this many readings restart the models: a steady reference is right, not the models.
const MAX_REFUSED: u32 = 6;
/// Standard deviation of the slip that a refused series of the reference shows beside the rims.
const SHOWN_SLIP_SIGMA: f64 = 0.1;
/// Rims slower than this stand, m/s, and a motion of the reference of so many standard deviations meanwhile is no noise.
const STANDING_RIM_M_PER_S: f64 = 0.02;
const SLIDING_SIGMAS: f64 = 4.0;
/// A slide is over where so many readings have not shown it: the models restart where one does, and take the next few.
const SLIDING_PERIODS: f64 = 15.0;
/// Standard deviation of a heading, rad: measured, where its own readings do not show a larger one, and summed from
/// displacements.
const MEASURED_HEADING_SIGMA_RAD: f64 = 0.01;
const SUMMED_HEADING_SIGMA_RAD: f64 = 1e-3;
/// Standard deviation of the error of a displacement's turn until it is learnt, rad.
const DISPLACEMENT_TURN_SIGMA_RAD: f64 = 2e-3;
/// A measured heading that was wrong this often is not used beside a gyro: many poses have none.
const MAX_HEADING_RESTARTS: u32 = 2;
/// A heading that is less certain than this after an outage is taken from the course anew, rad.
const MAX_HEADING_SIGMA_RAD: f64 = 0.3;
/// A measured heading that has changed by this much is one, rad; poses without a heading repeat a number.
const HEADING_CHANGE_RAD: f64 = 0.05;
/// A shorter course may be a step back or a rocking: it overrules no measured heading, m.
const MIN_COURSE_M: f64 = 0.3;
/// One longer than this multiple of the rims' way is no course but a position that jumped; braking wheels run slower than the robot.
const MAX_COURSE_PER_WAY: f64 = 1.5;
/// The rims' change within their lag is at most this multiple of their speed's difference from that of about the lag before, which
/// shows it late: errors on random logs differ by 1 % between 1.5 and 6.
const RISE_FACTOR: f64 = 3.0;
/// Readings of the reference that wait for the rims at most: those at 20 Hz between rims read at 3 Hz.
const MAX_AWAITING: usize = 6;
/// Entries of the history at most, and its time, s: the longest delay and a window of the rims.
const MAX_HISTORY_ENTRIES: usize = 512;
const HISTORY_S: f64 = MAX_DELAY_S + 0.5;
/// The longest delay of a reading that is still used, s.
pub(super) const MAX_DELAY_S: f64 = 1.0;

/// The inertial measurements of a step.
#[derive(Clone, Copy)]
pub(super) struct Inertial {
    pub(super) yaw_rate: f64,
    pub(super) turn_error: TurnError,
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
    /// The first position of those that are refused, and the rims' way until then, m.
    refused_position: [f64; 2],
    refused_way: f64,
    refused_ns: i64,
    /// Speeds that were refused one after the other.
    refused_speeds: u32,
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
    refused: u32,
    /// Headings that were refused one after the other.
    refused_headings: u32,
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
            refused_ns: 0,
            refused_speeds: 0,
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
            refused: 0,
            refused_headings: 0,
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
        self.refused = 0;
        self.awaiting = [None; MAX_AWAITING];
        self.awaited_speed = None;
    }

    /// A reading waits for the rims; `false` where no other can.
    pub(super) fn put_off(&mut self, reading: Awaiting) -> bool {
        let mut places = self.awaiting.iter_mut().filter(|place| place.is_none());
        if let Some(place) = places.next() {
            *place = Some(reading);
        }
        places.next().is_some()
    }

    /// The first reading that waits.
    pub(super) fn next_awaiting(&mut self) -> Option<Awaiting> {
        let first = self.awaiting[0].take();
        self.awaiting.rotate_left(1);
        first
    }

    /// The motion by the models with its direction, while a reference was accepted not too long ago.
    pub(super) fn motion(&self, now_ns: i64) -> Option<(ModelMotion, f64, f64)> {
        let accepted = self.accepted_ns?;
        let is_known = seconds_between(accepted, now_ns) <= MAX_PREDICTION_S;
        let mut motion = self.models.motion().filter(|_| is_known)?;
        if let Some(speed) = self.slide(now_ns) {
            (motion.speed, motion.slip) = (speed, -1.0);
        }
        Some((motion, self.direction, self.rim_speed))
    }

    /// The robot's speed where it slides or is carried while its rims stand, m/s.
    pub(super) fn slide(&self, now_ns: i64) -> Option<f64> {
        let (speed, shown_ns) = self.slide?;
        let lasts = seconds_between(shown_ns, now_ns) <= SLIDING_PERIODS * self.period_s.max(0.1);
        (lasts && self.rims_stand()).then_some(speed)
    }

    fn rims_stand(&self) -> bool {
        self.rim_speed.abs() <= STANDING_RIM_M_PER_S
    }

    /// The rims' way, once the models have started.
    pub(super) fn rim_path(&self) -> Option<RimPath> {
        let [x, y, turned, way] = self.models.totals();
        self.models
            .has_started()
            .then_some(RimPath { x, y, turned, way })
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
    pub(super) fn mean_motion(&self, from_ns: i64, to_ns: i64) -> Option<[f64; 2]> {
        let to_ns = to_ns.min(self.stepped_ns?);
        let way = self.history.between(from_ns, to_ns)?[3];
        let window = seconds_between(from_ns, to_ns);
        let motion = self.models.motion().filter(|_| window > 0.0)?;
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
            turn: inertial.yaw_rate * dt,
            turn_error: inertial.turn_error,
            acceleration: force.map(|force| (force, density)),
            rim: Rim {
                speed: rims.speed,
                variance: rims.variance * repeats,
                lag: rims.lag,
                rise: RISE_FACTOR * (rims.speed - self.slow_rim_speed),
                gained: rims.gained,
            },
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
            self.models.inflate_position(passed * self.rim_speed.abs());
            self.readmitted_ns = Some(now_ns);
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
            self.refused_headings = 0;
        }
        if 1.0 - agreement.inlier <= MAX_OUTLIER_PROBABILITY {
            if f64::from(self.refused) * passed > settings.failure {
                self.readmitted_ns = Some(now_ns);
            }
            self.refused = 0;
            self.accepted_ns = Some(now_ns);
            return Outcome::Accepted;
        }
        if self.refused == 0 {
            self.refused_position = place;
            self.refused_way = now[3];
            self.refused_ns = taken_ns;
        }
        self.refused += 1;
        if errors == Errors::Summed {
            // the sum holds the outlier from now on: the next displacement starts where the models are
            let [x, y] = self.models.place(since);
            self.summed = [x, y, self.summed[2]];
        }
        if self.refused >= MAX_REFUSED {
            self.restart_along_course((taken_ns, now_ns), place, yaw, settings);
        }
        Outcome::Refused
    }

    /// The place (m), heading (rad) and its standard deviation in the models' frame by a measurement; `None` of one that has none, or
    /// none so far.
    fn place_by(
        &mut self,
        measurement: &Measurement,
        times_ns: (i64, i64),
        (now, since): ([f64; 4], [f64; 4]),
        settings: &FilterSettings,
    ) -> Option<([f64; 2], Option<f64>, f64)> {
        match *measurement {
            Measurement::Position { x, y } => {
                self.orient_places([x, y], times_ns, since, settings);
                let place = self.places.place([x, y])?;
                Some((place, None, MEASURED_HEADING_SIGMA_RAD))
            }
            // the same places, as displacements
            _ if self.places.has_begun() => None,
            Measurement::Pose { x, y, yaw } => {
                let first = *self.first_heading.get_or_insert(yaw);
                self.has_heading |= (yaw - first).abs() > HEADING_CHANGE_RAD;
                let heading = yaw + self.heading_offset;
                Some(([x, y], Some(heading), MEASURED_HEADING_SIGMA_RAD))
            }
            Measurement::Displacement {
                forward,
                left,
                turn,
            } => {
                let turn = turn.unwrap_or_else(|| now[2] - since[2] - self.summed[2]);
                let (sin, cos) = Real::sin_cos(self.summed[2] + 0.5 * turn);
                self.summed[0] += cos * forward - sin * left;
                self.summed[1] += sin * forward + cos * left;
                self.summed[2] += turn;
                let [x, y, heading] = self.summed;
                Some(([x, y], Some(heading), SUMMED_HEADING_SIGMA_RAD))
            }
            _ => None,
        }
    }

    /// Orients the models' frame in that of places without a heading: at the first one, and after an outage in which the heading was
    /// lost, the models start anew, and go by wheels and gyro until the course is known.
    fn orient_places(
        &mut self,
        place: [f64; 2],
        (taken_ns, now_ns): (i64, i64),
        since: [f64; 4],
        settings: &FilterSettings,
    ) {
        let outage = self
            .used_ns
            .map_or(0.0, |used| seconds_between(used, taken_ns));
        let is_lost =
            outage > MAX_PREDICTION_S && self.models.heading_sigma() > MAX_HEADING_SIGMA_RAD;
        if !self.places.has_begun() || !self.models.has_started() || is_lost {
            self.places.begin(place);
            self.models.restart();
            let sigma = SUMMED_HEADING_SIGMA_RAD;
            self.models
                .start([0.0; 2], 0.0, settings.position_sigma, sigma);
            self.accepted_ns = None;
            self.used_ns = None;
            return;
        }
        if self.places.place(place).is_some() {
            return;
        }
        let there = self.models.place(since);
        let Some(sigma) = self.places.compare(place, there, settings.position_sigma) else {
            return;
        };
        let heading = self.models.motion().map_or(0.0, |motion| motion.heading);
        if let Some(place) = self.places.place(place) {
            let readmitted = self.started_ns.is_some();
            self.start(now_ns, place, (heading, sigma), settings);
            self.used_ns = Some(taken_ns);
            if readmitted {
                self.readmitted_ns = Some(now_ns);
            }
        }
    }

    /// Updates the models by a heading, `turned` (rad) ago. Headings that contradict theirs one after the other are right, and the
    /// turn rate is not: a gyro whose bias or scale is another than was believed leads away from a heading, and no single
    /// reading brings it back.
    fn update_heading(&mut self, (yaw, turned): (f64, f64), sigma: f64, settings: &FilterSettings) {
        let inlier = self.models.heading_agreement(yaw, turned, sigma);
        if 1.0 - inlier <= MAX_OUTLIER_PROBABILITY || self.refused_headings >= MAX_REFUSED {
            self.refused_headings = 0;
        }
        self.refused_headings += u32::from(1.0 - inlier > MAX_OUTLIER_PROBABILITY);
        if self.has_wrong_turn() {
            self.models
                .restart_heading(yaw, turned, sigma, settings.gyro_bias);
        } else {
            self.models.update_heading(yaw, turned, sigma);
        }
    }

    /// Has the last heading shown that the turn rate is wrong?
    pub(super) const fn has_wrong_turn(&self) -> bool {
        self.has_heading && self.refused_headings == MAX_REFUSED
    }

    /// Learns the noise of headings from one less the turn by gyro or wheels, and returns the standard deviation of this one.
    fn heading_sigma(&mut self, (beside_turn, sigma): (f64, f64), errors: Errors) -> f64 {
        self.heading_noise.push([beside_turn]);
        if errors == Errors::Independent {
            return self.heading_noise.sigma(sigma).max(sigma);
        }
        let noise = self
            .heading_noise
            .noise(errors, DISPLACEMENT_TURN_SIGMA_RAD);
        self.models.inflate_heading(noise.wander);
        noise.reading.max(sigma)
    }

    /// Uses a speed (m/s) that was taken at `taken_ns`: at once where the models have a speed, and beside the rims of its time.
    fn update_speed(
        &mut self,
        (taken_ns, forward): (i64, f64),
        now_ns: i64,
        settings: &FilterSettings,
    ) -> Outcome {
        if !self.models.has_started() {
            self.start(now_ns, [0.0; 2], (0.0, SUMMED_HEADING_SIGMA_RAD), settings);
        }
        self.use_awaited_speed(true, settings);
        let speed = forward * Real::cos(self.direction);
        let sigma = self.speed_sigma(settings);
        self.models.update_speed(speed, sigma);
        self.awaited_speed = Some((taken_ns, forward));
        self.use_awaited_speed(false, settings);
        self.accepted_ns = Some(now_ns);
        Outcome::Accepted
    }

    /// Updates the models by the speed that waits, once the rims are known around its time, or `at_once`: a rim speed that lags
    /// behind turned each braking into slip.
    fn use_awaited_speed(&mut self, at_once: bool, settings: &FilterSettings) {
        let (Some((taken_ns, forward)), Some(stepped_ns)) = (self.awaited_speed, self.stepped_ns)
        else {
            return;
        };
        let half = nanoseconds(self.rim_lag);
        let to_ns = taken_ns.saturating_add(half);
        if to_ns > stepped_ns && !at_once {
            return;
        }
        self.awaited_speed = None;
        let (from_ns, to_ns) = (taken_ns.saturating_sub(half), to_ns.min(stepped_ns));
        let rim = self
            .history
            .between(from_ns, to_ns)
            .filter(|_| to_ns > from_ns)
            .map_or(self.rim_speed, |ways| {
                ways[3] / seconds_between(from_ns, to_ns)
            });
        let speed = forward * Real::cos(self.direction);
        let share = self.models.motion().map_or(1.0, |motion| motion.rim_share);
        self.speed_noise.push([speed - rim * share]);
        let sigma = self.speed_sigma(settings);
        let inlier = self.models.speed_agreement(speed, rim, sigma);
        self.slide = None;
        if 1.0 - inlier <= MAX_OUTLIER_PROBABILITY {
            self.refused_speeds = 0;
        } else {
            self.refused_speeds += 1;
        }
        if self.refused_speeds < MAX_REFUSED {
            self.models.update_share(speed, rim, sigma);
            return;
        }
        // a steady series of speeds is right, not the models
        if self.rims_stand() {
            self.slide = Some((forward, stepped_ns));
        } else if let Some(slip) = slip_between(speed, rim) {
            self.refused_speeds = 0;
            self.models
                .restart_slip(slip, SHOWN_SLIP_SIGMA, speed, sigma);
        }
    }

    /// Standard deviation of a speed, m/s: as learnt, and at least as stated.
    fn speed_sigma(&self, settings: &FilterSettings) -> f64 {
        let stated = settings.speed_sigma;
        self.speed_noise.sigma(stated).max(stated)
    }

    fn start(
        &mut self,
        now_ns: i64,
        place: [f64; 2],
        (heading, heading_sigma): (f64, f64),
        settings: &FilterSettings,
    ) {
        self.models
            .set_slip_prior([settings.slip.mean, settings.slip.sigma]);
        self.models
            .start(place, heading, settings.position_sigma, heading_sigma);
        self.accepted_ns = Some(now_ns);
        self.started_ns = Some(now_ns);
    }

    /// Restarts the models at a position, with the heading of the course since the first refused one where that is long
    /// enough: the frame, its heading or the motion are not what the models hold. From the accepted ones to that, the position
    /// may have jumped, which is no course.
    fn restart_along_course(
        &mut self,
        (taken_ns, now_ns): (i64, i64),
        place: [f64; 2],
        yaw: Option<f64>,
        settings: &FilterSettings,
    ) {
        let (dx, dy) = (
            place[0] - self.refused_position[0],
            place[1] - self.refused_position[1],
        );
        let course = Real::hypot(dx, dy);
        let known = self.models.motion().map(|motion| motion.heading);
        let sigma = self
            .models
            .position_sigma()
            .unwrap_or(settings.position_sigma);
        self.refused = 0;
        self.restarts += 1;
        self.readmitted_ns = Some(now_ns);
        let rim_way = self.models.totals()[3] - self.refused_way;
        let passed = seconds_between(self.refused_ns, taken_ns);
        self.models.restart();
        let uncertain = core::f64::consts::SQRT_2 * sigma / course.max(sigma);
        // a position that jumps is no course
        let is_driven = course < MAX_COURSE_PER_WAY * rim_way.abs();
        let overrules = is_driven && (!self.has_heading || course > MIN_COURSE_M);
        let (heading, heading_sigma) = if overrules && uncertain < 0.2 {
            let back = if self.rim_speed < 0.0 { -1.0 } else { 1.0 };
            let heading = Real::atan2(back * dy, back * dx) - self.direction;
            (heading, uncertain.max(MEASURED_HEADING_SIGMA_RAD))
        } else {
            match (yaw, known) {
                (Some(yaw), _) => (yaw, MEASURED_HEADING_SIGMA_RAD),
                (None, known) => (known.unwrap_or(0.0), MAX_HEADING_SIGMA_RAD),
            }
        };
        self.heading_offset += heading - yaw.unwrap_or(heading);
        let along =
            dx * Real::cos(heading + self.direction) + dy * Real::sin(heading + self.direction);
        if self.rims_stand() && course > SLIDING_SIGMAS * core::f64::consts::SQRT_2 * sigma {
            self.slide = Some((along / passed, now_ns));
        }
        // the rims' way beside that course shows the slip
        let prior = [settings.slip.mean, settings.slip.sigma];
        let shown = slip_between(along, rim_way).filter(|_| uncertain < 0.2);
        self.models
            .set_slip_prior(shown.map_or(prior, |slip| [slip, SHOWN_SLIP_SIGMA.min(prior[1])]));
        self.models.start(place, heading, sigma, heading_sigma);
        self.models.set_slip_prior(prior);
    }
}

/// The slip of a robot that goes one way or speed while its rims go another; `None` where they go apart or nowhere.
fn slip_between(robot: f64, rim: f64) -> Option<f64> {
    if robot * rim <= 0.0 {
        return None;
    }
    let share = robot / rim;
    Some(if share <= 1.0 {
        1.0 - share
    } else {
        1.0 / share - 1.0
    })
}

/// The travel of a rim at `now_ns`, m: that of its last reading, and its speed since.
fn travel_at(wheel: &WheelChannel, now_ns: i64) -> f64 {
    let since = wheel
        .silence(now_ns)
        .filter(|silence| (0.0..=wheel.track.gap()).contains(silence));
    let rim = wheel.rim.map_or(0.0, |(rim, _)| rim.value);
    wheel.track.travel() + since.unwrap_or(0.0) * rim
}
