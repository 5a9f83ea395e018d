//! A robot in a [`World`]: where it is, what it has spent, how it ended.

use grouser_rover::ground::Noise;
use grouser_terrain::learn::SoilObservation;
use grouser_terrain::{Demand, Driving, Result, SurfacePose};

use super::world::{STEP_M, World};

/// The slip filter's error on powered wheels in foreign worlds, RMS (the table of pooled drives in RESULTS.md: 0.02 to
/// 0.04).
const SLIP_SIGMA: f64 = 0.03;
/// Error of the energy by motor currents, as a share.
const WORK_SIGMA: f64 = 0.05;
/// Error of pitch and roll, rad: half a degree.
const ANGLE_SIGMA_RAD: f64 = 0.009;

/// How a drive of a mission ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ended {
    /// At the goal.
    Arrived,
    /// On ground that it could leave, without a way on.
    Stopped,
    /// Where it moves neither forwards nor backwards, or slides.
    Immobilised,
}

/// What became of a step.
#[derive(Clone, Copy)]
pub(super) enum Moved {
    /// It is there.
    There,
    /// It does not come on.
    Blocked,
    /// It slides.
    Lost,
}

/// The robot.
pub(super) struct Robot {
    pub(super) place: (f64, f64),
    pub(super) heading: f64,
    /// J at the wheels.
    pub(super) energy: f64,
    /// m, forwards and back.
    pub(super) way: f64,
    /// Places where it came along, for the way back.
    trace: Vec<((f64, f64), f64)>,
    noise: Noise,
    turn_energy: f64,
}

impl Robot {
    pub(super) fn new(place: (f64, f64), heading: f64, turn_energy: f64, seed: u64) -> Self {
        Self {
            place,
            heading,
            energy: 0.0,
            way: 0.0,
            trace: vec![(place, heading)],
            noise: Noise::new(seed, 81),
            turn_energy,
        }
    }

    /// Turns to a heading; each 45° cost the same.
    pub(super) fn turn(&mut self, heading: f64) {
        let off = (heading - self.heading + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        self.energy += self.turn_energy * off.abs() / std::f64::consts::FRAC_PI_4;
        self.heading = heading;
    }

    /// Drives straight to a place, after turning there, and gives every reading on the way.
    pub(super) fn drive_to(
        &mut self,
        world: &World<'_>,
        to: (f64, f64),
        mut see: impl FnMut(&SoilObservation) -> Result<()>,
    ) -> Result<Moved> {
        let from = self.place;
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        if length < 1e-9 {
            return Ok(Moved::There);
        }
        self.turn((to.1 - from.1).atan2(to.0 - from.0));
        let steps = (length / STEP_M).ceil().max(1.0);
        let mut step = 1.0;
        while step <= steps {
            let share = step / steps;
            let place = (
                from.0 + share * (to.0 - from.0),
                from.1 + share * (to.1 - from.1),
            );
            let Some(taken) = world.take(place, self.heading, true)? else {
                return Ok(Moved::Blocked);
            };
            if matches!(taken.demand, Demand::Slides | Demand::Lifts) {
                return Ok(Moved::Lost);
            }
            let driving = taken.driving();
            let reading = self.reading(place, world.front(), (taken.pose, driving));
            see(&reading)?;
            // it has come as far as the place that holds it
            self.place = place;
            let Some(driving) = driving else {
                return Ok(Moved::Blocked);
            };
            self.spend(taken.pose.pitch, &driving, length / steps);
            self.trace.push((place, self.heading));
            step += 1.0;
        }
        Ok(Moved::There)
    }

    fn spend(&mut self, pitch: f64, driving: &Driving, flat: f64) {
        let way = flat / pitch.cos();
        self.energy += way * driving.energy_per_metre();
        self.way += way;
    }

    /// What its computer knows of a step: soft ground lies ahead of the middle, under the front wheels.
    fn reading(
        &mut self,
        place: (f64, f64),
        front: f64,
        (pose, driving): (SurfacePose, Option<Driving>),
    ) -> SoilObservation {
        let (sin, cos) = self.heading.sin_cos();
        let ahead = if driving.is_some() { 0.0 } else { front };
        let mut noisy = |value: f64, sigma: f64| value + sigma * self.noise.normal();
        SoilObservation {
            place: (place.0 + ahead * cos, place.1 + ahead * sin),
            pitch: noisy(pose.pitch, ANGLE_SIGMA_RAD),
            roll: noisy(pose.roll, ANGLE_SIGMA_RAD),
            slip: driving.map_or(1.0, |driving| {
                noisy(driving.slip, SLIP_SIGMA).clamp(-1.0, 1.0)
            }),
            slip_sigma: SLIP_SIGMA,
            work_per_metre: driving.map(|driving| {
                let energy = driving.energy_per_metre();
                noisy(energy, WORK_SIGMA * energy)
            }),
        }
    }

    /// Drives back along its own way; false where it does not move.
    pub(super) fn back_out(&mut self, world: &World<'_>, length: f64) -> Result<bool> {
        let mut gone = 0.0;
        // from where it was held, too
        while gone < length {
            let Some(taken) = world.take(self.place, self.heading, false)? else {
                return Ok(false);
            };
            let Demand::Drives(driving) = taken.demand else {
                return Ok(false);
            };
            let Some((place, heading)) = self.trace.pop() else {
                return Ok(true);
            };
            let flat = (self.place.0 - place.0).hypot(self.place.1 - place.1);
            if flat > 0.0 {
                self.turn(heading);
            }
            self.spend(taken.pose.pitch, &driving, flat);
            gone += flat;
            self.place = place;
        }
        self.trace.push((self.place, self.heading));
        Ok(true)
    }
}
