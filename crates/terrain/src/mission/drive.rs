//! A simulated drive that plans its way, learns its soil and plans anew: the whole loop on full dynamics.
//!
//! The navigator knows the relief, the first soil of the scenario, and what the robot's own computer estimates: slips, motor
//! torques, attitude, and the place by odometry and fixes. It reads neither the regions nor the true state.

use grouser_rover::drive::{DriveResult, Frame, Outcome, Pilot, Scenario, Simulation};
use grouser_rover::ground::HeightMap;
use grouser_slip::control::{Decides, Mode, Request};
use grouser_slip::{Health, Measurement};

use super::believed_map::MissionSettings;
use super::navigator::{Navigator, Replanning};
use crate::error::{Error, Result};
use crate::headings::Headings;
use crate::learn::{LearnSettings, SoilObservation, TileSummary};
use crate::plan::PlanSettings;
use crate::table::Envelope;

/// Pitch and roll that are planned through, rad: 26° and 22°, within which the shipped robots keep their wheels loaded.
const MAX_ANGLES_RAD: (f64, f64) = (0.45, 0.38);
/// A reading is the mean over this way, m: a wheel of 0.15 m turns half around.
const READING_WAY_M: f64 = 0.4;
/// The point of the way that the robot heads for lies this far ahead, m: about twice its length.
const LOOK_AHEAD_M: f64 = 1.2;
/// The robot has arrived within this distance of the goal, m; if nothing holds it, it drives on until the goal lies abeam.
const GOAL_RADIUS_M: f64 = 0.5;
/// Further off its heading than this a robot turns rather than travels, rad: nothing is learnt then.
const ON_COURSE_RAD: f64 = 0.25;
/// How far it backs out, m, and how long it tries, s.
const BACK_LENGTH_M: f64 = 1.0;
/// Where no way leads on from there, it backs out further, to have room to turn, up to this length, m.
const MAX_BACK_LENGTH_M: f64 = 4.0;
const MAX_BACK_TIME_S: f64 = 30.0;
/// Before the filter has settled nothing counts, s.
const SETTLING_TIME_S: f64 = 3.0;
/// Part of the difference to a fix that corrects the place: fixes of 2 cm five times a second follow in a second.
const FIX_GAIN: f64 = 0.2;
/// Plans of one drive at most.
const MAX_PLANS: usize = 200;
/// How often a robot may be held before it stops.
const MAX_HELD: u32 = 12;
/// Ground that is soft or holds the robot weighs as much as this many metres of way.
const HELD_WEIGHT: f64 = 4.0;

/// What came of a drive that planned its way.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PlannedDrive {
    /// As of any drive.
    pub result: DriveResult,
    /// How planning went.
    pub planning: Replanning,
    /// What was learnt, by tile; empty where nothing is learnt.
    pub learnt: Vec<TileSummary>,
    /// How often the robot did not come on, or saw no way on, and backed out.
    pub held: u32,
    /// True distance to the goal at the end, m: for the reader; the robot does not know it.
    pub to_goal: f64,
    /// Where the robot believed to be less where it was, m.
    pub place_error: f64,
}

/// What the robot does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Follow,
    /// Backing out since a place and a time.
    BackOut {
        from: (f64, f64),
        since: f64,
        heading: f64,
        length: f64,
    },
}

/// Sums over the way of one reading.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    way: f64,
    time: f64,
    slip: f64,
    variance: f64,
    slips: f64,
    work: f64,
    pitch: f64,
    roll: f64,
}

/// The navigator aboard, with what it knows of the robot's motion.
struct Aboard {
    navigator: Navigator,
    learns: bool,
    /// Place by odometry and fixes, m, and the odometry behind it.
    place: (f64, f64),
    odometry: (f64, f64),
    start_heading: f64,
    front: f64,
    way: Vec<(f64, f64)>,
    next: usize,
    goal: (f64, f64),
    speed: f64,
    phase: Phase,
    sums: Sums,
    held: u32,
    /// The course on which the robot came within the goal's radius, rad: towards a point under the robot there is none.
    last_course: Option<f64>,
}

/// Drives a scenario that has a plan; `sink` gets every frame and ends the drive by returning false.
///
/// # Errors
/// [`Error::NoPlan`] for a scenario without one; [`Error::Place`] for a start or a goal that cannot be one; as
/// [`Simulation::new`].
pub fn drive(
    scenario: &Scenario,
    optimum: f64,
    seed: u64,
    mut sink: impl FnMut(&Frame<'_>) -> bool,
) -> Result<PlannedDrive> {
    let plan = scenario.plan.ok_or(Error::NoPlan)?;
    let mut own = scenario.clone();
    // which way leads on is the navigator's to decide
    own.control.decides = Decides::BacksOut;
    let mut simulation = Simulation::new(&own, Pilot::Controller, optimum, seed)?;
    let mut aboard = Aboard::new(scenario, simulation.ground().map())?;
    let start = (scenario.start.0, scenario.start.1);
    let found = aboard
        .navigator
        .set_out(start, scenario.start.2, plan.goal)?;
    if found {
        aboard.take_way();
        let mut fix = None;
        let mut now = 0.0;
        while simulation.period(&mut |frame: &Frame<'_>| {
            fix = frame
                .samples
                .iter()
                .rev()
                .find_map(|sample| match sample.measurement {
                    Measurement::Pose { x, y, .. } => Some((x, y)),
                    _ => None,
                });
            now = frame.time;
            sink(frame)
        }) {
            if let Some(end) = aboard.tick(&mut simulation, now, fix)? {
                simulation.end(end);
                break;
            }
        }
    } else {
        simulation.end(Outcome::NoWay);
    }
    let result = simulation.result();
    let off = |to: (f64, f64)| (to.0 - result.end.0).hypot(to.1 - result.end.1);
    Ok(PlannedDrive {
        to_goal: off(plan.goal),
        place_error: off(aboard.place),
        planning: aboard.navigator.planning().clone(),
        learnt: if aboard.learns {
            aboard.navigator.tiles().learnt()
        } else {
            Vec::new()
        },
        held: aboard.held,
        result,
    })
}

impl Aboard {
    fn new(scenario: &Scenario, relief: &HeightMap) -> Result<Self> {
        let plan = scenario.plan.ok_or(Error::NoPlan)?;
        let model = &scenario.robot;
        let mut learn = LearnSettings::default();
        if let Some(spec) = &scenario.learn {
            learn.tile = spec.tile;
            learn.hysteresis = spec.hysteresis;
        }
        let settings = MissionSettings {
            headings: Headings::new(plan.headings)?,
            cell: plan.cell,
            envelope: Envelope::within(model, MAX_ANGLES_RAD.0, MAX_ANGLES_RAD.1)?,
            plan: PlanSettings {
                max_risk: plan.max_risk,
                turn_energy: plan.turn_energy,
                rim_speed: plan.speed,
                ..PlanSettings::default()
            },
            learn,
        };
        let start = (scenario.start.0, scenario.start.1);
        let ((left, bottom), (right, top)) = relief.extent();
        let area = (
            (
                (start.0.min(plan.goal.0) - plan.margin).max(left),
                (start.1.min(plan.goal.1) - plan.margin).max(bottom),
            ),
            (
                (start.0.max(plan.goal.0) + plan.margin).min(right),
                (start.1.max(plan.goal.1) + plan.margin).min(top),
            ),
        );
        let soil = &scenario.ground.soils[0].soil;
        Ok(Self {
            navigator: Navigator::new(relief, (area, [start, plan.goal]), model, soil, &settings)?,
            learns: scenario.learn.is_some(),
            place: start,
            odometry: (0.0, 0.0),
            start_heading: scenario.start.2,
            front: crate::pose::WheelPlane::new(model).front(),
            way: Vec::new(),
            next: 0,
            goal: plan.goal,
            speed: plan.speed,
            phase: Phase::Follow,
            sums: Sums::default(),
            held: 0,
            last_course: None,
        })
    }

    /// Takes up the way that was planned.
    fn take_way(&mut self) {
        let points = self.navigator.route().map(|route| route.waypoints.iter());
        let places = points.into_iter().flatten().map(|point| (point.x, point.y));
        self.way = places.collect();
        // a turn repeats its place
        self.way.dedup();
        self.way.push(self.goal);
        self.next = 0;
    }

    /// One period: where the robot is, what it learns, and what it requests next; the end, if this is it.
    fn tick(
        &mut self,
        simulation: &mut Simulation,
        now: f64,
        fix: Option<(f64, f64)>,
    ) -> Result<Option<Outcome>> {
        let on_board = simulation.on_board();
        let heading = on_board.attitude().heading();
        let step = self.advance(&on_board.body().odometry, fix);
        // ground that is soft or holds the robot: the controller drives back the way the robot came
        let is_held = on_board.mode() == Mode::BackOut;
        let request = match &mut self.phase {
            Phase::Follow if is_held => {
                if self.last_course.is_some() {
                    return Ok(Some(Outcome::Arrived));
                }
                self.learn(true, heading)?;
                self.back_out(now, heading);
                self.request(heading)
            }
            Phase::Follow => {
                let course = self.course();
                let course = if distance(self.place, self.goal) < GOAL_RADIUS_M {
                    *self.last_course.get_or_insert(course)
                } else {
                    self.last_course = None;
                    course
                };
                if self.last_course.is_some() && self.is_abeam(course) {
                    return Ok(Some(Outcome::Arrived));
                }
                let is_on_course = turn(course - heading).abs() < ON_COURSE_RAD;
                self.look(simulation, step, is_on_course && now > SETTLING_TIME_S)?;
                // where no way leads on, the robot goes back to where it has room to turn
                if self.learns
                    && self.navigator.has_changed()
                    && self.replan(heading, false)?.is_some()
                {
                    self.back_out(now, heading);
                }
                self.request(course)
            }
            Phase::BackOut { since, heading, .. } if is_held => {
                *since = now;
                let heading = *heading;
                self.request(heading)
            }
            Phase::BackOut {
                from,
                since,
                heading,
                length,
            } => {
                let heading = *heading;
                if distance(self.place, *from) >= *length {
                    self.sums = Sums::default();
                    if !self.learns || self.held > MAX_HELD {
                        return Ok(Some(Outcome::NoWay));
                    }
                    let is_last = *length >= MAX_BACK_LENGTH_M;
                    (*since, *length) = (now, *length + BACK_LENGTH_M);
                    match self.replan(heading, true)? {
                        None => self.phase = Phase::Follow,
                        Some(end) if is_last => return Ok(Some(end)),
                        Some(_) => {}
                    }
                } else if now - *since > MAX_BACK_TIME_S {
                    return Ok(Some(Outcome::Immobilised));
                }
                Request {
                    speed: -self.speed,
                    heading,
                    yaw_rate: None,
                }
            }
        };
        simulation.set_request(request)?;
        Ok(None)
    }

    /// The way on is barred: back, to plan anew from there.
    fn back_out(&mut self, since: f64, heading: f64) {
        self.held += 1;
        self.phase = Phase::BackOut {
            from: self.place,
            since,
            heading,
            length: BACK_LENGTH_M,
        };
    }

    /// Ahead on a heading, rad.
    const fn request(&self, heading: f64) -> Request {
        Request {
            speed: self.speed,
            heading,
            yaw_rate: None,
        }
    }

    /// Moves the place by odometry, and towards a fix; gives the way since the last period, m.
    fn advance(
        &mut self,
        odometry: &grouser_slip::filter::Odometry,
        fix: Option<(f64, f64)>,
    ) -> f64 {
        let (x, y) = (odometry.x - self.odometry.0, odometry.y - self.odometry.1);
        self.odometry = (odometry.x, odometry.y);
        let (sin, cos) = self.start_heading.sin_cos();
        self.place.0 += x * cos - y * sin;
        self.place.1 += x * sin + y * cos;
        if let Some(fix) = fix {
            self.place.0 += FIX_GAIN * (fix.0 - self.place.0);
            self.place.1 += FIX_GAIN * (fix.1 - self.place.1);
        }
        x.hypot(y)
    }

    /// The heading to the point of the way that lies ahead, rad.
    fn course(&mut self) -> f64 {
        while self.next + 1 < self.way.len()
            && (distance(self.place, self.way[self.next]) < LOOK_AHEAD_M || self.has_passed())
        {
            self.next += 1;
        }
        let to = self.way.get(self.next).copied().unwrap_or(self.goal);
        (to.1 - self.place.1).atan2(to.0 - self.place.0)
    }

    /// Does the goal lie beside the robot or behind it, on this course (rad)?
    fn is_abeam(&self, course: f64) -> bool {
        let (sin, cos) = course.sin_cos();
        (self.goal.0 - self.place.0) * cos + (self.goal.1 - self.place.1) * sin <= 0.0
    }

    /// Is the point after the next one nearer than the next one?
    fn has_passed(&self) -> bool {
        distance(self.place, self.way[self.next + 1]) < distance(self.place, self.way[self.next])
    }

    /// Sums up a reading and learns from it, where the way of this period counts.
    fn look(&mut self, simulation: &Simulation, step: f64, counts: bool) -> Result<()> {
        if !counts {
            self.sums = Sums::default();
            return Ok(());
        }
        let on_board = simulation.on_board();
        let model = simulation.vehicle().model();
        let period = CONTROL_PERIOD_S;
        let sums = &mut self.sums;
        sums.time += period;
        sums.way += step;
        for (mount, seen) in model.wheels.iter().zip(on_board.observations()) {
            let Some(motor) = &mount.motor else { continue };
            if let (Some(slip), Some(sigma), Health::Ok) = (seen.slip, seen.sigma, seen.health) {
                sums.slip += slip;
                sums.variance += sigma * sigma;
                sums.slips += 1.0;
            }
            if let (Some(share), Some(rim)) = (seen.torque_share, seen.rim_speed) {
                sums.work += share * motor.max_torque() * rim / mount.wheel.radius() * period;
            }
        }
        // nose down is positive there
        sums.pitch -= period * on_board.attitude().pitch();
        sums.roll += period * on_board.attitude().roll();
        if self.sums.way >= READING_WAY_M {
            self.learn(false, on_board.attitude().heading())?;
        }
        Ok(())
    }

    /// One reading enters.
    fn learn(&mut self, is_held: bool, heading: f64) -> Result<()> {
        let sums = std::mem::take(&mut self.sums);
        if !self.learns || !(is_held || sums.slips > 0.0) || !(sums.time > 0.0) {
            return Ok(());
        }
        // ground that holds the robot lies under its front wheels; else the middle of the way of the reading counts
        let ahead = if is_held { self.front } else { -0.5 * sums.way };
        let (sin, cos) = heading.sin_cos();
        let clamped = |value: f64| value.clamp(-1.0, 1.0);
        let reading = SoilObservation {
            place: (self.place.0 + ahead * cos, self.place.1 + ahead * sin),
            pitch: clamped(sums.pitch / sums.time),
            roll: clamped(sums.roll / sums.time),
            slip: if is_held {
                1.0
            } else {
                clamped(sums.slip / sums.slips)
            },
            slip_sigma: if is_held {
                0.0
            } else {
                (sums.variance / sums.slips).sqrt().min(1.0)
            },
            work_per_metre: (!is_held).then(|| (sums.work / sums.way).max(0.0)),
        };
        let weight = if is_held {
            HELD_WEIGHT
        } else {
            sums.way.min(1.0)
        };
        self.navigator.observe(&reading, weight)
    }

    fn replan(&mut self, heading: f64, always: bool) -> Result<Option<Outcome>> {
        if self.navigator.planning().count >= MAX_PLANS {
            return Ok(Some(Outcome::NoWay));
        }
        match self.navigator.replan(self.place, heading, always) {
            Ok(true) => {
                self.take_way();
                Ok(None)
            }
            // a robot that got where no heading can be driven has no way on; that is no error of its scenario
            Ok(false) | Err(Error::Place { .. }) => Ok(Some(Outcome::NoWay)),
            Err(error) => Err(error),
        }
    }
}

/// The period of the simulation's control loop, s.
const CONTROL_PERIOD_S: f64 = 0.01;

fn distance(a: (f64, f64), b: (f64, f64)) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

/// An angle within ±π.
fn turn(angle: f64) -> f64 {
    (angle + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
}
