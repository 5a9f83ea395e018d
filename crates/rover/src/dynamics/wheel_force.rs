//! The force between a wheel and the ground at one moment.
//!
//! The laws of [`grouser_terra`] hold for a wheel that moves steadily. What happens between steady states:
//!
//! - *Shear* needs travel to build up. With u the mean shear displacement of the contact of length L,
//!   `u̇ = (r ω − v) − max(|r ω|, |v|) u/L`, whose steady state is u/L = s, driving and braking alike. At rest
//!   nothing is forgotten: u is a spring, the wheel holds a slope without creeping, and no speed is ever
//!   divided by. The same for the drift sideways. The laws are evaluated at s = (u + τ u̇)/L: the τ damps and
//!   vanishes in every steady state.
//! - *Direction*: the shear turns round with the direction of rolling d, the resistance of the soil in front with the
//!   direction of travel; either needs half a contact length of way to do so. A wheel that spins in its hole is thus
//!   held by as much of the resistance as its thrust needs, and never driven by it.
//! - *Digging* needs way over the ground: where the ground has a settling way L_w, the exponent n(s) and the layer that
//!   lugs carry follow the slip s by ṡ_d = (s − s_d) max(|v|, |r ω|/10)/L_w. Measured: a lugged wheel of 58 mm whose slip
//!   jumps from 0 to 0.75 and 0.9 sinks to its new depth over 50 mm of travel in both cases, which is 0.55 and 1.4 turns
//!   (`tests/settling.rs`). Beyond that slip nothing is measured, and a wheel that spins on the spot must dig: the share
//!   of the rim's way is that of s = 0.9.
//! - *Unloading*: soil that was pressed to z_p gives back along a line `unloading` times as steep as the load's
//!   own; rolling forgets z_p over L.

use grouser_real::Real;
use grouser_terra::{Entry, Kinematics, SideForce, Slip, SoilHistory, WheelOnSoil};

/// The shear is evaluated this much ahead in time, s. It damps a robot at rest with about 0.3 of the critical damping at a
/// few kilogrammes a wheel.
pub(super) const SHEAR_LEAD_S: f64 = 0.015;
/// The sinkage is evaluated this much ahead, s, which damps heave likewise.
pub(super) const SINKAGE_LEAD_S: f64 = 0.006;
/// Slope of unloading: relative load per relative sinkage, 1. Sands have 5 to 50; beyond about 10 it no longer matters.
pub(super) const UNLOADING_SLOPE: f64 = 6.0;
/// A wheel sunk deeper than this share of its radius is buried: the laws end at 1.
pub(super) const MAX_SINKAGE_SHARE: f64 = 0.9;
/// Greatest drift over rolling speed at which the laws are evaluated: the shear is saturated there.
const MAX_DRIFT_RATIO: f64 = 4.0;
/// Drift over rolling speed below which a wheel runs straight, so that it is solved without a slip
/// angle.
const MIN_DRIFT_RATIO: f64 = 1e-7;
/// Drift over rolling speed from which bulldozing counts: κ = |sin β| leaves 1 % of it there.
const MIN_BULLDOZING_RATIO: f64 = 0.01;

/// Least way over the ground by which digging settles, per way of the rim: 1 − s at the highest slip that is measured.
const MIN_DIGGING_SHARE: f64 = 0.1;

/// The soil under a wheel at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoilUnder {
    /// Factor of modulus and cohesion, hence of every stress.
    pub strength: f64,
    /// Factor of the shear deformation modulus.
    pub k_shear: f64,
    /// Way over which slip-sinkage follows a change of slip, m; 0: with the shear.
    pub settling_way: f64,
}

impl Default for SoilUnder {
    /// Undisturbed.
    fn default() -> Self {
        Self {
            strength: 1.0,
            k_shear: 1.0,
            settling_way: 0.0,
        }
    }
}

/// What a wheel remembers of its contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelContact {
    /// Mean shear displacement along and across, m.
    shear: [f64; 2],
    /// Its motion at the last step.
    before: Option<WheelMotionNow>,
    /// Slip and drift that slip-sinkage has settled to.
    dug: [f64; 2],
    /// Direction of rolling, −1 to 1.
    direction: f64,
    /// Direction of travel, −1 to 1.
    travel: f64,
    /// Sinkage to which the soil under it was pressed.
    pressed: Entry,
}

/// How a wheel stands and moves in its contact plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelMotionNow {
    /// Sinkage below the ground in front of it, m; negative in the air.
    pub sinkage: f64,
    /// How fast it sinks, m/s.
    pub sinking: f64,
    /// Speed of its centre forwards and to the left, m/s.
    pub velocity: [f64; 2],
    /// Speed of its rim, m/s.
    pub rim: f64,
}

impl WheelMotionNow {
    fn mean(&self, other: &Self) -> Self {
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        Self {
            sinkage: mean(self.sinkage, other.sinkage),
            sinking: mean(self.sinking, other.sinking),
            velocity: std::array::from_fn(|i| mean(self.velocity[i], other.velocity[i])),
            rim: mean(self.rim, other.rim),
        }
    }

    /// The faster of rim and centre, m/s, forwards or backwards.
    fn dominant(&self) -> f64 {
        if self.rim.abs() >= self.velocity[0].abs() {
            self.rim
        } else {
            self.velocity[0]
        }
    }

    /// max(|r ω|, |v|), m/s.
    fn rolling(&self) -> f64 {
        self.dominant().abs()
    }

    /// The speed at which the rim shears the soil, along and across, m/s.
    fn slip_velocity(&self) -> [f64; 2] {
        [self.rim - self.velocity[0], self.velocity[1]]
    }
}

/// What the ground does to the wheel, in the contact plane's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct WheelLoad {
    /// Away from the ground, N.
    pub normal: f64,
    /// Forwards, N.
    pub along: f64,
    /// To the left, N.
    pub across: f64,
    /// The torque with which the soil loads the motor, N m.
    pub torque: f64,
    /// Sinkage to which the soil is pressed, m.
    pub pressed: f64,
    /// Is the hub about to be buried, so that the laws end?
    pub buried: bool,
}

impl WheelContact {
    /// Slip and drift that slip-sinkage has settled to.
    #[must_use]
    pub const fn dug(&self) -> [f64; 2] {
        self.dug
    }

    /// Moves on by `step` s and returns the forces.
    #[inline]
    pub fn step(
        &mut self,
        pair: &WheelOnSoil,
        soil: &SoilUnder,
        motion: &WheelMotionNow,
        step: f64,
    ) -> WheelLoad {
        let radius = pair.wheel().running_radius();
        let before = self.before.replace(*motion).unwrap_or(*motion);
        let amid = before.mean(motion);
        let limit = MAX_SINKAGE_SHARE * radius;
        let buried = motion.sinkage > limit;
        let before_step = self.pressed.sinkage();
        let deepest = if motion.sinkage > before_step {
            Entry::new(motion.sinkage.min(limit), radius)
        } else {
            self.pressed
        };
        let length = contact_length(radius, deepest.theta_1());
        let per_length = 1.0 / length;
        // what rolling leaves of the past, by the trapezoidal rule
        let half = 0.5 * step * amid.rolling() * per_length;
        let per_sum = 1.0 / (1.0 + half);
        let kept = (1.0 - half) * per_sum;
        let forgotten = motion.sinkage + (before_step - motion.sinkage) * kept;
        let pressed = motion.sinkage.max(forgotten).clamp(0.0, limit);
        if pressed <= 0.0 {
            *self = Self::default();
            return WheelLoad::default();
        }
        self.pressed = if pressed == deepest.sinkage() {
            deepest
        } else {
            Entry::new(pressed, radius)
        };
        let gained = step * per_sum;
        let limits = [1.0, MAX_DRIFT_RATIO];
        let (slipping_amid, slipping) = (amid.slip_velocity(), motion.slip_velocity());
        let forgetting = motion.rolling() * per_length;
        let slips = std::array::from_fn(|i| {
            let most = limits[i] * length;
            let shear = (self.shear[i] * kept + gained * slipping_amid[i]).clamp(-most, most);
            self.shear[i] = shear;
            let ahead = shear + SHEAR_LEAD_S * (slipping[i] - forgetting * shear);
            (ahead * per_length).clamp(-limits[i], limits[i])
        });
        let per_speed = 2.0 * step * per_length;
        let turned = |way: f64, speed: f64| (way + per_speed * speed).clamp(-1.0, 1.0);
        self.direction = turned(self.direction, amid.dominant());
        self.travel = turned(self.travel, amid.velocity[0]);
        self.dig(&amid, soil.settling_way, slips, step);
        let mut load = self.steady(pair, soil, slips);
        // W − k (z_p − z), the line of unloading, with its damping
        let gap = (pressed - motion.sinkage.min(limit)) - SINKAGE_LEAD_S * motion.sinking;
        let share = (1.0 - UNLOADING_SLOPE * gap / pressed).clamp(0.0, 3.0);
        let scale = soil.strength * share;
        load.normal *= scale;
        load.along *= scale;
        load.across *= scale;
        load.torque *= scale;
        load.pressed = pressed;
        load.buried = buried;
        load
    }

    /// Moves slip-sinkage on, towards the slip of the motion or, without a settling way, to that of the shear.
    fn dig(&mut self, motion: &WheelMotionNow, way: f64, slips: [f64; 2], step: f64) {
        if !(way > 0.0) {
            self.dug = slips;
            return;
        }
        let [forward, left] = motion.velocity;
        let greater = motion.rolling();
        let speed = Real::hypot(forward, left).max(MIN_DIGGING_SHARE * motion.rim.abs());
        let share = step * speed / way;
        if !(greater > 0.0 && share > 0.0) {
            return;
        }
        let now = [
            ((motion.rim - forward) / greater).clamp(-1.0, 1.0),
            (left / greater).clamp(-MAX_DRIFT_RATIO, MAX_DRIFT_RATIO),
        ];
        self.dug = std::array::from_fn(|i| (self.dug[i] + share * now[i]) / (1.0 + share));
    }

    /// The steady forces at slip `s` (of forward rolling) and drift `w`, by the direction of rolling.
    fn steady(&self, pair: &WheelOnSoil, soil: &SoilUnder, [s, w]: [f64; 2]) -> WheelLoad {
        let travel = self.travel;
        let [dug, drift] = self.dug;
        // by the direction of rolling, as the slip
        let past = |sign: f64| Past {
            dug: [sign * dug, drift],
            k_shear: soil.k_shear,
        };
        if self.direction >= 1.0 {
            let (load, resistance) = one_way(pair, &self.pressed, [s, w], past(1.0));
            return WheelLoad {
                along: load.along - travel * resistance,
                ..load
            };
        }
        let (back, resistance) = one_way(pair, &self.pressed, [-s, w], past(-1.0));
        let mirrored = WheelLoad {
            along: -back.along - travel * resistance,
            torque: -back.torque,
            ..back
        };
        if self.direction <= -1.0 {
            return mirrored;
        }
        let (forth, resistance) = one_way(pair, &self.pressed, [s, w], past(1.0));
        let forth = WheelLoad {
            along: forth.along - travel * resistance,
            ..forth
        };
        let share = 0.5 * (1.0 + self.direction);
        let mix = |a: f64, b: f64| share * a + (1.0 - share) * b;
        WheelLoad {
            normal: mix(forth.normal, mirrored.normal),
            along: mix(forth.along, mirrored.along),
            across: mix(forth.across, mirrored.across),
            torque: mix(forth.torque, mirrored.torque),
            ..forth
        }
    }
}

/// Length of the contact, m: the arc in front of the wheel's lowest point, of a wheel of `radius` (m) from the entry angle
/// `theta_1` (rad) on.
pub(super) fn contact_length(radius: f64, theta_1: f64) -> f64 {
    radius * theta_1.max(0.05)
}

/// What the wheel's way and the wheels before it have made of the soil.
#[derive(Clone, Copy)]
struct Past {
    /// Slip and drift that slip-sinkage has settled to.
    dug: [f64; 2],
    k_shear: f64,
}

/// The motion at slip `s` of forward rolling and drift `w`.
fn motion_at([s, w]: [f64; 2]) -> grouser_terra::Result<Kinematics> {
    Kinematics::with_drift(Slip::new(s)?, w)
}

/// The laws at slip `s` and drift `w` = v_y over the faster of rim and travel, rolling forwards: the load with the thrust
/// alone along, and the resistance of the soil in front, N.
fn one_way(pair: &WheelOnSoil, entry: &Entry, [s, w]: [f64; 2], past: Past) -> (WheelLoad, f64) {
    let drift = if w.abs() < MIN_DRIFT_RATIO { 0.0 } else { w };
    let found = motion_at([s, drift]).and_then(|motion| {
        let dug_by = if past.dug == [s, w] {
            motion
        } else {
            motion_at(past.dug)?
        };
        let history = SoilHistory::steady(dug_by).with_k_shear_factor(past.k_shear);
        let side = if drift.abs() > MIN_BULLDOZING_RATIO {
            SideForce::Whole
        } else {
            SideForce::Shear
        };
        pair.forces_after(entry, &motion, &history, side)
    });
    // Soil, wheel and slip have been checked, so that nothing is left to refuse.
    let Ok((forces, across)) = found else {
        return (WheelLoad::default(), 0.0);
    };
    let load = WheelLoad {
        normal: forces.vertical_force.max(0.0),
        along: forces.thrust,
        across,
        torque: forces.torque,
        pressed: entry.sinkage(),
        buried: false,
    };
    (load, forces.thrust - forces.drawbar_pull)
}
