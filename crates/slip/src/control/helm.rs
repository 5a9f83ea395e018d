//! Where the robot goes: forward, across a slope, back, or nowhere any more.

use grouser_real::Real;

use super::decision::{Action, Ending, Mode, Pending, Reason};
use super::detour::Detour;
use super::settings::ControlSettings;
use super::wrapped;
use crate::filter::SlipPrior;

/// The slip that decisions look at is smoothed over this, s.
const SMOOTHING: f64 = 1.0;
/// And over this, to see whether it rises, s.
const SLOW: f64 = 4.0;
/// A slip that stands within this band of its slow mean is steady.
const STEADY_BAND: f64 = 0.03;
/// A slip that has been steady for this long is what the ground demands, s.
const STEADY_TIME: f64 = 2.5;
/// An accepted slip leaves this much room for more.
const ROOM: f64 = 0.06;
/// No slip above this is accepted.
const MOST_ACCEPTED: f64 = 0.92;
/// Headings that differ by less than this count as steered, rad.
const ON_COURSE: f64 = 0.35;
/// A turn may take this long before it is given up, s.
const TURN_TIME: f64 = 12.0;
/// A traverse turns away from the asked heading by at most this, rad.
const WIDEST: f64 = 0.8;
/// A robot that does not come back for this long is stuck, s. While it comes slowly more slip is allowed, 1/s.
const IDLE: f64 = 10.0;
const PUSH: f64 = 0.1;
/// A robot slower than this stands, m/s; the soil is sheared once it has rolled this far, m.
const STANDS: f64 = 0.02;
const SHEARED: f64 = 0.25;
/// Soft ground is forgotten after this much progress, m.
const FORGOTTEN: f64 = 4.0;
/// Backing out for longer than its length over its speed times this has failed.
const BACK_PATIENCE: f64 = 8.0;

/// The robot as a whole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// Slip of the powered wheels, weighed by load.
    pub(crate) slip: Option<f64>,
    /// How much softer the ground is on the left than on the right: slip and firmness, 1.
    pub(crate) lean: f64,
    /// Firmness of the ground: the least under any powered wheel, that the next one does not deny.
    pub(crate) firmness: f64,
    /// What soil and slope demand.
    pub(crate) demanded: Option<SlipPrior>,
    pub(crate) speed: Option<f64>,
    /// Mean speed of the powered rims, m/s.
    pub(crate) rim: f64,
    pub(crate) heading: Option<f64>,
    pub(crate) pitch: Option<f64>,
    pub(crate) roll: Option<f64>,
    pub(crate) asked_speed: f64,
    pub(crate) asked_heading: f64,
    /// Seconds without slip or speed.
    pub(crate) blind: f64,
}

impl Seen {
    /// Angle of the robot's deck against the level, rad.
    fn tilt(&self) -> Option<f64> {
        let (pitch, roll) = (self.pitch?, self.roll?);
        Some(Real::acos((pitch.cos() * roll.cos()).clamp(-1.0, 1.0)))
    }
}

/// −1 where the drive asks for backwards.
const fn sense(asked_speed: f64) -> f64 {
    if asked_speed < 0.0 { -1.0 } else { 1.0 }
}

/// What the wheels are to do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course {
    pub(crate) speed: f64,
    pub(crate) turn: f64,
    pub(crate) heading: f64,
    pub(crate) slip_matters: bool,
    pub(crate) stopped: bool,
    /// The slip to run at: the optimum, or what the ground demands.
    pub(crate) target: f64,
    /// The share of its speed that a rim runs at least.
    pub(crate) creep: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Helm {
    /// Turning rate per speed that the robot can drive, 1/m; infinite where it turns on the spot.
    pub(crate) sharpest: f64,
    mode: Mode,
    slip: f64,
    /// The same over `SLOW` seconds: between the two stands how it changes.
    slow: f64,
    /// The slip that the ground demands and that was accepted; 0: none.
    accepted: f64,
    /// How long slip has stood steadily above its optimum, or below it (negative), s.
    steady: f64,
    /// Smoothed tilt, rad, and over `SLOW` seconds.
    tilt: f64,
    slow_tilt: f64,
    /// How long slip has been high, and so high that the wheels dig in, and without progress, s.
    high: f64,
    dig: f64,
    stuck: f64,
    tilted: f64,
    /// How long and how far it has been in this mode, s and m.
    time: f64,
    way: f64,
    /// Progress along the asked heading since the last time of backing out, m.
    progress: f64,
    attempts: u32,
    /// Side of the traverse: +1 left, −1 right, 0 not chosen yet.
    side: f64,
    /// How far the traverse turns away, rad.
    angle: f64,
    /// How long it has been turning, s.
    turning: f64,
    /// The heading that it holds while it backs out, rad.
    held: f64,
    /// How long it has not come back while it backs out, s; and how much more slip that is allowed for it.
    idle: f64,
    pushed: f64,
    /// How far it has rolled since it stood or changed its mode, m.
    rolled: f64,
    detour: Detour,
    /// How far it backs out to go round soft ground, m; 0: it does not.
    rounds: f64,
}

impl Default for Helm {
    fn default() -> Self {
        Self {
            sharpest: f64::INFINITY,
            mode: Mode::Forward,
            slip: 0.0,
            slow: 0.0,
            accepted: 0.0,
            steady: 0.0,
            tilt: 0.0,
            slow_tilt: 0.0,
            high: 0.0,
            dig: 0.0,
            stuck: 0.0,
            tilted: 0.0,
            time: 0.0,
            way: 0.0,
            progress: 0.0,
            attempts: 0,
            side: 0.0,
            angle: 0.0,
            turning: 0.0,
            held: 0.0,
            idle: 0.0,
            pushed: 0.0,
            rolled: 0.0,
            detour: Detour::default(),
            rounds: 0.0,
        }
    }
}

impl Helm {
    pub(crate) const fn mode(&self) -> Mode {
        self.mode
    }

    pub(crate) const fn slip(&self) -> f64 {
        self.slip
    }

    fn enter(&mut self, mode: Mode) {
        self.mode = mode;
        self.time = 0.0;
        self.way = 0.0;
        self.high = 0.0;
        self.dig = 0.0;
        self.stuck = 0.0;
        self.turning = 0.0;
        self.rounds = 0.0;
        self.rolled = 0.0;
        self.idle = 0.0;
        self.pushed = 0.0;
    }

    fn heading(&self, seen: &Seen) -> f64 {
        match self.mode {
            Mode::Traverse => wrapped(seen.asked_heading + self.side * self.angle),
            Mode::BackOut => self.held,
            Mode::Detour => wrapped(seen.asked_heading + self.detour.angle()),
            Mode::Forward | Mode::Stopped => seen.asked_heading,
        }
    }

    /// How far it is off its heading, rad; 0 where the heading is not measured.
    fn off(&self, seen: &Seen) -> f64 {
        seen.heading
            .map_or(0.0, |now| wrapped(self.heading(seen) - now))
    }

    /// Watches and decides.
    pub(crate) fn steer(
        &mut self,
        settings: &ControlSettings,
        seen: &Seen,
        step: f64,
        pending: &mut Pending,
    ) {
        if self.mode == Mode::Stopped {
            return;
        }
        self.watch(settings, seen, step);
        if !settings.decides {
            return;
        }
        if self.tilted > 0.2 {
            let values = (self.tilt, settings.most_tilt);
            self.end(Ending::Tipping, Reason::TiltHigh, values, pending);
            return;
        }
        if seen.blind > settings.blind_time {
            let values = (seen.blind, settings.blind_time);
            self.end(Ending::SensorsLost, Reason::Blind, values, pending);
            return;
        }
        self.accept(settings, pending);
        match self.mode {
            Mode::Forward => self.forward(settings, pending),
            Mode::Traverse => self.traverse(settings, pending),
            Mode::BackOut => self.back_out(settings, seen, pending),
            Mode::Detour => self.go_round(settings, seen, step, pending),
            Mode::Stopped => {}
        }
    }

    fn watch(&mut self, settings: &ControlSettings, seen: &Seen, step: f64) {
        let share = step / (SMOOTHING + step);
        if let Some(slip) = seen.slip {
            self.slip += share * (slip - self.slip);
            self.slow += step / (SLOW + step) * (slip - self.slow);
        }
        if let Some(tilt) = seen.tilt() {
            self.tilt += share * (tilt - self.tilt);
            self.slow_tilt += step / (SLOW + step) * (tilt - self.slow_tilt);
            let over = tilt > settings.most_tilt;
            self.tilted = if over { self.tilted + step } else { 0.0 };
        }
        let speed = seen.speed.unwrap_or(0.0);
        self.time += step;
        // where it is to go back, only that counts
        self.way += match self.mode {
            Mode::BackOut => step * (-speed * sense(seen.asked_speed)),
            _ => step * speed.abs(),
        };
        if self.mode == Mode::BackOut {
            let back = -speed * sense(seen.asked_speed);
            let wanted = settings.back_speed * seen.asked_speed.abs();
            self.idle = if back < 0.25 * STANDS {
                self.idle + step
            } else {
                0.0
            };
            if back < 0.5 * wanted {
                self.pushed = (self.pushed + step * PUSH).min(MOST_ACCEPTED - settings.optimum);
            }
        }
        let on_course = self.off(seen).abs() < ON_COURSE;
        self.turning = if on_course { 0.0 } else { self.turning + step };
        let asked = seen.asked_speed.abs();
        // What happens while it turns on the spot, or while nothing is asked of it, says nothing.
        // a robot that steers travels while it turns; one that turns on the spot says nothing of the ground ahead
        let on_course = on_course || self.sharpest.is_finite();
        let driving = asked != 0.0 && on_course && self.time >= SMOOTHING;
        let level = self.tilt.max(self.slow_tilt) < settings.steep;
        // soil under a wheel that starts is not sheared yet
        self.rolled = if speed.abs() < STANDS {
            0.0
        } else {
            self.rolled + step * speed.abs()
        };
        let counts = driving && level && self.rolled > SHEARED && self.mode != Mode::BackOut;
        self.detour.watch(settings, seen, counts, step);
        if !driving {
            self.high = 0.0;
            self.dig = 0.0;
            self.stuck = 0.0;
            self.steady = 0.0;
            return;
        }
        let count = |past: f64, now: bool| if now { past + step } else { 0.0 };
        self.high = count(self.high, self.slip > settings.high_slip);
        // On a slope that steepens the slip rises without digging.
        let rises = self.slip > self.slow + STEADY_BAND && self.tilt < settings.steep;
        let spins = self.slip > 1.0 - settings.stuck_share;
        self.dig = count(self.dig, self.slip > settings.dig_slip && (rises || spins));
        let above = self.slip > settings.optimum.max(self.accepted) + 0.02;
        let still = (self.slip - self.slow).abs() < STEADY_BAND;
        self.steady = if above && still && speed > 0.0 {
            self.steady.max(0.0) + step
        } else if self.slip < settings.optimum {
            self.steady.min(0.0) - step
        } else {
            0.0
        };
        let stands = speed.abs() < settings.stuck_share * seen.rim.max(settings.creep * asked);
        self.stuck = count(self.stuck, stands && seen.speed.is_some());
        if self.mode != Mode::BackOut {
            let ahead = seen
                .heading
                .map_or(1.0, |now| wrapped(now - seen.asked_heading).cos());
            self.progress += step * speed.max(0.0) * ahead;
            if self.progress > settings.progress {
                self.attempts = 0;
            }
            if self.progress > FORGOTTEN {
                self.detour.forget();
            }
        }
    }

    /// A slip that stays above its optimum however slowly the rims run is what slope and soil demand. As long as it
    /// is steady the wheels do not dig, and creeping only costs time: it is accepted until it is no longer needed.
    fn accept(&mut self, settings: &ControlSettings, pending: &mut Pending) {
        if self.mode == Mode::BackOut {
            return;
        }
        if self.steady > STEADY_TIME && self.slip < MOST_ACCEPTED {
            let values = (self.slip, settings.optimum.max(self.accepted));
            self.accepted = (self.slip + ROOM).min(MOST_ACCEPTED + ROOM);
            self.steady = 0.0;
            pending.push(Action::AcceptSlip, Reason::Demanded, None, values);
        } else if self.accepted > 0.0 && self.steady < -STEADY_TIME {
            self.accepted = 0.0;
            let values = (self.slip, settings.optimum);
            pending.push(Action::Resume, Reason::SlipRegained, None, values);
        }
    }

    fn end(&mut self, ending: Ending, reason: Reason, values: (f64, f64), pending: &mut Pending) {
        self.enter(Mode::Stopped);
        pending.push(Action::End(ending), reason, None, values);
    }

    /// Softer ground than is known: back before the wheels dig, and round it. Tells whether it decided.
    fn soft(&mut self, settings: &ControlSettings, pending: &mut Pending) -> bool {
        if !self.detour.is_soft(settings) {
            return false;
        }
        let values = self.detour.values(settings);
        if self.detour.choose() > settings.most_attempts {
            self.end(Ending::NoWay, Reason::SoftGround, values, pending);
            return true;
        }
        self.progress = 0.0;
        self.accepted = 0.0;
        self.enter(Mode::BackOut);
        self.rounds = self.detour.back(settings);
        pending.push(Action::BackOut, Reason::SoftGround, None, values);
        true
    }

    /// Across until the soft ground is passed.
    fn go_round(
        &mut self,
        settings: &ControlSettings,
        seen: &Seen,
        step: f64,
        pending: &mut Pending,
    ) {
        if self.soft(settings, pending) || self.stuck(settings, pending) {
            return;
        }
        let across = seen.heading.map_or(0.0, |now| {
            Real::sin(now - seen.asked_heading) * seen.speed.unwrap_or(0.0)
        });
        let aside = self.detour.go(across, step);
        let wanted = self.detour.across(settings);
        if aside >= wanted {
            self.enter(Mode::Forward);
            pending.push(Action::Resume, Reason::Aside, None, (aside, wanted));
        }
    }

    /// Digging in or standing still: back, if there are tries left. Tells whether it decided.
    fn stuck(&mut self, settings: &ControlSettings, pending: &mut Pending) -> bool {
        let (reason, values) = if self.dig >= settings.dig_time {
            (Reason::DiggingIn, (self.slip, settings.dig_slip))
        } else if self.stuck >= 2.0 * settings.dig_time {
            (Reason::NoProgress, (self.stuck, 2.0 * settings.dig_time))
        } else {
            return false;
        };
        if self.attempts >= settings.most_attempts {
            let values = (f64::from(self.attempts), f64::from(settings.most_attempts));
            self.end(Ending::Immobilised, Reason::AttemptsUsed, values, pending);
            return true;
        }
        self.attempts += 1;
        self.progress = 0.0;
        self.enter(Mode::BackOut);
        // on the level it is the soil that holds it
        if self.tilt < settings.steep {
            self.rounds = self.detour.back(settings);
            self.detour.choose();
        }
        pending.push(Action::BackOut, reason, None, values);
        true
    }

    fn forward(&mut self, settings: &ControlSettings, pending: &mut Pending) {
        if self.soft(settings, pending) {
            return;
        }
        // On a slope it turns away as long as it still comes on.
        let fails = self.dig >= settings.dig_time || self.stuck >= settings.dig_time;
        let high = self.slip > settings.high_slip;
        if fails && high && self.tilt > settings.steep && self.attempts == 0 {
            self.side = if self.side == 0.0 { 1.0 } else { self.side };
            self.angle = settings.traverse_angle.min(WIDEST);
            self.attempts = 1;
            self.progress = 0.0;
            self.enter(Mode::Traverse);
            let values = (self.slip, settings.dig_slip);
            pending.push(Action::Traverse, Reason::DiggingIn, None, values);
            return;
        }
        self.stuck(settings, pending);
    }

    fn traverse(&mut self, settings: &ControlSettings, pending: &mut Pending) {
        if self.soft(settings, pending) || self.stuck(settings, pending) {
            return;
        }
        if self.turning > TURN_TIME {
            // it cannot turn that far here: back, and the other way
            let values = (self.turning, TURN_TIME);
            if self.attempts >= settings.most_attempts {
                self.end(Ending::Immobilised, Reason::AttemptsUsed, values, pending);
            } else {
                self.attempts += 1;
                self.progress = 0.0;
                self.enter(Mode::BackOut);
                pending.push(Action::BackOut, Reason::NoProgress, None, values);
            }
            return;
        }
        let gentle = self.tilt < settings.level;
        if self.way >= settings.traverse_length {
            if gentle || self.tilt < settings.steep {
                let values = (self.tilt, settings.level);
                self.enter(Mode::Forward);
                pending.push(Action::Resume, Reason::SlopeGentle, None, values);
                return;
            }
            self.side = -self.side;
            let values = (self.way, settings.traverse_length);
            self.enter(Mode::Traverse);
            pending.push(Action::Tack, Reason::BoardDone, None, values);
        } else if gentle && self.way > 0.3 * settings.traverse_length {
            let values = (self.tilt, settings.level);
            self.enter(Mode::Forward);
            pending.push(Action::Resume, Reason::SlopeGentle, None, values);
        } else if self.high >= settings.high_slip_time
            && self.slip > 0.5 * (settings.high_slip + settings.dig_slip)
            && self.angle < WIDEST
        {
            self.angle = (self.angle + 0.25 * settings.traverse_angle).min(WIDEST);
            let values = (self.slip, 0.5 * (settings.high_slip + settings.dig_slip));
            self.high = 0.0;
            pending.push(Action::Traverse, Reason::SlipHigh, None, values);
        }
    }

    fn back_out(&mut self, settings: &ControlSettings, seen: &Seen, pending: &mut Pending) {
        let speed = settings.back_speed * seen.asked_speed.abs();
        let rounds = self.rounds > 0.0;
        let length = if rounds {
            self.rounds
        } else {
            settings.back_length
        };
        let patience = BACK_PATIENCE * length / speed.max(1e-3);
        let idle = self.idle > IDLE;
        if self.way >= length && rounds {
            self.enter(Mode::Detour);
            let values = (self.detour.angle(), self.detour.across(settings));
            pending.push(Action::Detour, Reason::BackedOut, None, values);
        } else if self.way >= length {
            // another way: the other side, wider with every try
            self.side = if self.side == 0.0 { 1.0 } else { -self.side };
            let tries = f64::from(self.attempts.max(1) - 1);
            let angle = settings.traverse_angle * (0.75 + 0.25 * tries);
            self.angle = angle.min(WIDEST);
            let values = (self.way, length);
            self.enter(Mode::Traverse);
            pending.push(Action::Traverse, Reason::BackedOut, None, values);
        } else if idle || self.time > patience {
            let values = if idle {
                (self.idle, IDLE)
            } else {
                (self.time, patience)
            };
            self.end(Ending::Immobilised, Reason::NoProgress, values, pending);
        }
    }

    /// The slip that a slope of the known soil needs, with some room: less would only cost time.
    fn needed(&self, seen: &Seen) -> f64 {
        match seen.demanded {
            Some(demanded) if self.mode != Mode::BackOut => {
                (demanded.mean + ROOM).clamp(0.0, MOST_ACCEPTED)
            }
            _ => 0.0,
        }
    }

    /// Speed and turning rate for the mode.
    pub(crate) fn course(&mut self, settings: &ControlSettings, seen: &Seen) -> Course {
        let heading = self.heading(seen);
        if self.mode == Mode::Stopped {
            return Course {
                speed: 0.0,
                turn: 0.0,
                heading,
                slip_matters: false,
                stopped: true,
                target: settings.optimum,
                creep: 0.0,
            };
        }
        if self.mode != Mode::BackOut {
            self.held = seen.heading.unwrap_or(seen.asked_heading);
        }
        let off = self.off(seen);
        let most = settings.most_turn;
        let turn = (settings.turn_gain * off).clamp(-most, most);
        // far off its heading it turns rather than travels
        let on_course = off.abs() < ON_COURSE;
        let ahead = if on_course {
            1.0
        } else {
            (off.cos() - 0.5).clamp(0.2, 1.0)
        };
        let speed = match self.mode {
            Mode::BackOut => -settings.back_speed * seen.asked_speed,
            _ => ahead * seen.asked_speed,
        };
        let idle = seen.asked_speed == 0.0;
        let (speed, turn) = if self.sharpest.is_finite() {
            // a robot that steers turns as it travels
            let travel = if self.mode == Mode::BackOut {
                speed
            } else {
                seen.asked_speed
            };
            let most = travel.abs() * self.sharpest;
            (travel, turn.clamp(-most, most))
        } else {
            (speed, turn)
        };
        Course {
            speed,
            turn: if idle { 0.0 } else { turn },
            heading,
            slip_matters: (on_course || self.sharpest.is_finite()) && !idle,
            stopped: false,
            target: settings.optimum.max(self.accepted).max(self.needed(seen)) + self.pushed,
            creep: if self.tilt < settings.steep || self.mode == Mode::BackOut {
                settings.crawl
            } else {
                settings.creep
            },
        }
    }
}
