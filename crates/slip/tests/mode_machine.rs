//! The mode machine, enumerated: every sequence of up to five behaviours of ground, robot and sensors out of sixteen, 1.1
//! million of them, each held for half a second or until a limit of time has passed.
//!
//! What is proved is bounded by that: five behaviours in a row, one robot, limits of time and length shortened so that each
//! limit is passed within a behaviour. Arbitrary numbers are the business of `tick_properties.rs`.

use std::collections::{BTreeMap, BTreeSet};

use grouser_slip::control::{
    Action, ControlInput, ControlSettings, Controller, Decides, Mode, Request, WheelObservation,
};

use crate::four_wheels::{driving, robot, yaw_rate};

/// The loop's period.
const PERIOD_S: f64 = 0.05;
const PERIOD_NS: i64 = 50_000_000;
/// The number of periods of a behaviour: longer than each shortened limit.
const HELD: usize = 10;
/// Sequences have at most this many behaviours.
const DEPTH: usize = 5;
const WHEELS: usize = 4;

/// What happens for a while. The first ones are of ground and robot, the last ones of sensors and requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Behaviour {
    /// The robot does what it is commanded, with a slip of 0.1.
    Follows,
    /// The same on a slope of 0.2 rad.
    Climbs,
    /// Wheels spin and the robot hardly moves.
    Digs,
    /// The same on a slope.
    DigsOnSlope,
    /// A steady slip of 0.6 on a slope: high, but it advances.
    Labours,
    /// Rims turn, slips are not estimated, the robot stands.
    Stands,
    /// The ground takes little torque.
    IsSoft,
    /// It heads 1 rad aside of every request.
    IsTurned,
    /// The same for longer than a turn may take.
    CannotTurn,
    /// It does not move for longer than backing out may take.
    IsHeld,
    /// It leans.
    Leans,
    /// No speed and no slip for less than the time that stops it.
    Blinks,
    /// The same for longer.
    IsBlind,
    /// The clock stands for longer than the time that stops it.
    ClockStands,
    /// Nothing is requested.
    Rests,
    /// Backwards is requested.
    Reverses,
}

impl Behaviour {
    const ALL: [Self; 16] = [
        Self::Follows,
        Self::Climbs,
        Self::Digs,
        Self::DigsOnSlope,
        Self::Labours,
        Self::Stands,
        Self::IsSoft,
        Self::IsTurned,
        Self::CannotTurn,
        Self::IsHeld,
        Self::Leans,
        Self::Blinks,
        Self::IsBlind,
        Self::ClockStands,
        Self::Rests,
        Self::Reverses,
    ];

    /// For how many periods it is held.
    const fn periods(self) -> usize {
        match self {
            // turns are given up after 12 s, backing out after 10 s without movement
            Self::CannotTurn | Self::IsHeld => 250,
            Self::Blinks => 5,
            Self::IsBlind => 14,
            // by steps of 0.025 s
            Self::ClockStands => 26,
            _ => HELD,
        }
    }
}

fn settings() -> ControlSettings {
    let mut settings = ControlSettings::default();
    settings.high_slip_time = 0.1;
    settings.dig_time = 0.1;
    settings.soft_time = 0.1;
    settings.blind_time = 0.5;
    (settings.back_length, settings.traverse_length) = (0.05, 0.1);
    (settings.soft_back, settings.soft_across) = (0.05, 0.05);
    settings.progress = 0.1;
    settings.max_attempts = 2;
    settings
}

/// A controller with the robot about it.
#[derive(Clone)]
struct Drive {
    controller: Controller,
    time_ns: i64,
    heading: f64,
    rims: [f64; WHEELS],
    mode: Mode,
}

/// What all sequences passed through.
#[derive(Default)]
struct Seen {
    transitions: BTreeSet<(Mode, Mode)>,
    actions: BTreeMap<&'static str, usize>,
    steps: usize,
    slowest_stop_s: f64,
}

/// The modes that may follow each other.
fn is_allowed(decides: Decides, from: Mode, to: Mode) -> bool {
    use Mode::{BackOut, Detour, Forward, Stopped, Traverse};
    if decides == Decides::BacksOut {
        return matches!(
            (from, to),
            (Forward, BackOut | Stopped) | (BackOut, Forward | Stopped)
        );
    }
    matches!(
        (from, to),
        (Forward, Traverse | BackOut | Stopped)
            | (Traverse, Forward | Traverse | BackOut | Stopped)
            | (BackOut, Traverse | Detour | Stopped)
            | (Detour, Forward | BackOut | Stopped)
    )
}

impl Drive {
    fn new(settings: &ControlSettings) -> Self {
        Self {
            controller: Controller::new(&robot(), *settings).unwrap(),
            time_ns: 0,
            heading: 0.0,
            rims: [0.0; WHEELS],
            mode: Mode::Forward,
        }
    }

    /// One period of a behaviour; what holds of every step is checked.
    fn step(&mut self, behaviour: Behaviour, seen: &mut Seen) {
        use Behaviour as B;
        let settings = *self.controller.settings();
        if behaviour != B::ClockStands {
            self.time_ns += PERIOD_NS;
        }
        let mean_rim = self.rims.iter().sum::<f64>() / WHEELS as f64;
        let slip = match behaviour {
            B::Digs | B::DigsOnSlope | B::IsHeld => 0.97,
            B::Labours => 0.6,
            _ => 0.1,
        };
        let speed = match behaviour {
            B::Stands | B::IsHeld => 0.0,
            _ => mean_rim * (1.0 - slip),
        };
        let is_blind = matches!(behaviour, B::Blinks | B::IsBlind);
        let wheels = self.rims.map(|rim| WheelObservation {
            slip: (behaviour != B::Stands).then_some(slip),
            sigma: Some(0.02),
            torque_share: Some(0.3 * rim.signum()),
            firmness: Some(if behaviour == B::IsSoft { 0.2 } else { 1.0 }),
            ..driving(slip, rim)
        });
        let request = Request {
            speed: match behaviour {
                B::Rests => 0.0,
                B::Reverses => -0.3,
                _ => 0.3,
            },
            heading: if matches!(behaviour, B::IsTurned | B::CannotTurn) {
                self.heading + 1.0
            } else {
                0.0
            },
            yaw_rate: None,
        };
        let pitch = match behaviour {
            B::Climbs | B::DigsOnSlope | B::Labours => -0.2,
            _ => 0.0,
        };
        let before = self.rims;
        let output = self.controller.step(&ControlInput {
            time_ns: self.time_ns,
            wheels: if is_blind { &[] } else { &wheels },
            speed: (!is_blind).then_some(speed),
            heading: Some(self.heading),
            pitch: Some(pitch),
            roll: Some(if behaviour == B::Leans { 0.8 } else { 0.0 }),
            slip_demand: None,
            request,
        });
        seen.steps += 1;
        let (mode, heading, decision) = (output.mode, output.heading, output.decision);
        // transitions, and a finite reason for each decision
        if mode != self.mode {
            let allowed = is_allowed(settings.decides, self.mode, mode);
            assert!(allowed, "{:?} to {mode:?}", self.mode);
            seen.transitions.insert((self.mode, mode));
        }
        if settings.decides == Decides::Stops {
            assert!(matches!(mode, Mode::Forward | Mode::Stopped));
        }
        self.mode = mode;
        assert!(heading.is_finite());
        if let Some(decision) = decision {
            assert!(decision.value.is_finite() && decision.limit.is_finite());
            *seen.actions.entry(decision.action.name()).or_default() += 1;
            if matches!(decision.action, Action::End(_)) {
                assert_eq!(mode, Mode::Stopped, "{decision:?}");
            }
        }
        for (rim, command) in self.rims.iter_mut().zip(output.commands) {
            assert!(command.rim_speed.abs() <= settings.max_rim_speed);
            assert!((0.0..=settings.max_traction).contains(&command.traction));
            *rim = command.rim_speed;
        }
        // rims accelerate within their limit, and a stopped robot only slows down
        for (rim, before) in self.rims.iter().zip(before) {
            let change = 2.0 * settings.max_acceleration * PERIOD_S + 1e-12;
            // without observations a wheel's command is the one of rest
            assert!(
                is_blind || (rim - before).abs() <= change,
                "{before} to {rim}"
            );
            if mode == Mode::Stopped {
                assert!(rim.abs() <= before.abs(), "{before} to {rim} while stopped");
            }
        }
        let turned = yaw_rate(self.rims);
        if !matches!(behaviour, B::CannotTurn | B::IsTurned) {
            self.heading += turned * PERIOD_S;
        }
    }

    fn hold(&mut self, behaviour: Behaviour, seen: &mut Seen) {
        for _ in 0..behaviour.periods() {
            self.step(behaviour, seen);
        }
    }

    /// Silent sensors end in the safe stop within its time, and the rims come to rest.
    fn must_stop_when_blind(&self, seen: &mut Seen) {
        let mut drive = self.clone();
        let settings = *drive.controller.settings();
        let fastest = drive
            .rims
            .iter()
            .fold(0.0_f64, |most, rim| most.max(rim.abs()));
        let mut passed = 0.0;
        while drive.mode != Mode::Stopped {
            drive.step(Behaviour::IsBlind, seen);
            passed += PERIOD_S;
            // a period to notice it, and one because the limit must be passed
            assert!(passed < settings.blind_time + 2.5 * PERIOD_S, "{passed} s");
        }
        seen.slowest_stop_s = seen.slowest_stop_s.max(passed);
        let braking_s = fastest / (2.0 * settings.max_acceleration);
        let mut left = 2.0 + braking_s / PERIOD_S;
        while left > 0.0 {
            drive.step(Behaviour::IsBlind, seen);
            left -= 1.0;
        }
        assert_eq!(drive.rims, [0.0; WHEELS]);
        // for good, whatever comes
        for behaviour in Behaviour::ALL {
            drive.step(behaviour, seen);
            assert_eq!((drive.mode, drive.rims), (Mode::Stopped, [0.0; WHEELS]));
        }
    }

    /// No dead end: on good ground the robot drives ahead again, or its drive has ended.
    fn must_not_hang(&self, seen: &mut Seen) {
        let mut drive = self.clone();
        // a turn of 180° at 0.4 rad/s, and each leg, detour and way back at a fifth of the speed
        for _ in 0..1200 {
            if matches!(drive.mode, Mode::Forward | Mode::Stopped) {
                return;
            }
            drive.step(Behaviour::Follows, seen);
        }
        panic!("{:?} goes on for a minute on good ground", drive.mode);
    }
}

fn search(drive: &Drive, depth: usize, path: &mut Vec<Behaviour>, seen: &mut Seen) {
    if path.len() < 4 {
        drive.must_stop_when_blind(seen);
        drive.must_not_hang(seen);
    }
    if depth == 0 || drive.mode == Mode::Stopped {
        return;
    }
    for behaviour in Behaviour::ALL {
        let mut next = drive.clone();
        path.push(behaviour);
        next.hold(behaviour, seen);
        search(&next, depth - 1, path, seen);
        path.pop();
    }
}

#[test]
fn every_sequence_of_behaviours_keeps_the_promises_and_reaches_every_transition() {
    let mut seen = Seen::default();
    search(&Drive::new(&settings()), DEPTH, &mut Vec::new(), &mut seen);
    println!(
        "{} steps, {} transitions, slowest stop {:.2} s, {:?}",
        seen.steps,
        seen.transitions.len(),
        seen.slowest_stop_s,
        seen.actions
    );
    // every transition that is allowed between two modes occurs: the search does not miss a part of the machine
    for from in Mode::ALL.iter().copied() {
        let is_entered = seen.transitions.iter().any(|(_, to)| *to == from);
        assert!(is_entered, "{from:?} is never entered");
        for to in Mode::ALL.iter().copied() {
            let can = from != to && is_allowed(Decides::Everything, from, to);
            assert_eq!(
                seen.transitions.contains(&(from, to)),
                can,
                "{from:?} to {to:?}"
            );
        }
    }
}

#[test]
fn a_controller_that_decides_stops_alone_only_stops() {
    let mut settings = settings();
    settings.decides = Decides::Stops;
    let mut seen = Seen::default();
    search(&Drive::new(&settings), 3, &mut Vec::new(), &mut seen);
    assert_eq!(
        seen.transitions.into_iter().collect::<Vec<_>>(),
        [(Mode::Forward, Mode::Stopped)]
    );
}

#[test]
fn a_controller_that_only_backs_out_goes_on_as_requested() {
    let mut settings = settings();
    settings.decides = Decides::BacksOut;
    let mut seen = Seen::default();
    search(&Drive::new(&settings), 4, &mut Vec::new(), &mut seen);
    assert_eq!(
        seen.transitions.into_iter().collect::<Vec<_>>(),
        [
            (Mode::Forward, Mode::BackOut),
            (Mode::Forward, Mode::Stopped),
            (Mode::BackOut, Mode::Forward),
            (Mode::BackOut, Mode::Stopped),
        ]
    );
}
