//! A controller of four powered wheels in an open loop: a test sets what it observes, step by step at 100 Hz, and so knows
//! what every rule must give in closed form.

use grouser_slip::control::{
    Action, ControlInput, ControlSettings, Controller, Decision, Reason, Request, WheelCommand,
    WheelObservation,
};
use grouser_slip::filter::SlipPrior;

use crate::four_wheels::{driving, robot};

/// The loop's period, s.
pub(crate) const STEP_S: f64 = 0.01;
/// The requested speed unless a test sets another, m/s.
pub(crate) const SPEED_M_PER_S: f64 = 0.2;

/// What the last step gave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Last {
    pub(crate) heading: f64,
    pub(crate) slip: f64,
    pub(crate) commands: [WheelCommand; 4],
    pub(crate) decision: Option<Decision>,
}

#[derive(Clone, Debug)]
pub(crate) struct OpenLoop {
    pub(crate) controller: Controller,
    pub(crate) time_ns: i64,
    pub(crate) period_ns: i64,
    pub(crate) wheels: [WheelObservation; 4],
    pub(crate) speed: Option<f64>,
    pub(crate) heading: Option<f64>,
    pub(crate) pitch: Option<f64>,
    pub(crate) roll: Option<f64>,
    pub(crate) slip_demand: Option<SlipPrior>,
    pub(crate) request: Request,
}

/// A wheel whose rim and hub run at the requested speed, with a slip of 0.1.
pub(crate) fn rolling() -> WheelObservation {
    WheelObservation {
        forward_speed: Some(SPEED_M_PER_S),
        ..driving(0.1, SPEED_M_PER_S)
    }
}

impl OpenLoop {
    pub(crate) fn new(settings: &ControlSettings) -> Self {
        Self::with(Controller::new(&robot(), *settings).unwrap())
    }

    pub(crate) fn with(controller: Controller) -> Self {
        Self {
            controller,
            time_ns: 0,
            period_ns: 10_000_000,
            wheels: [rolling(); 4],
            speed: Some(SPEED_M_PER_S),
            heading: Some(0.0),
            pitch: Some(0.0),
            roll: Some(0.0),
            slip_demand: None,
            request: Request {
                speed: SPEED_M_PER_S,
                ..Request::default()
            },
        }
    }

    pub(crate) fn each(&mut self, change: impl Fn(&mut WheelObservation)) {
        self.wheels.iter_mut().for_each(change);
    }

    /// One step `passed_ns` after the last one.
    pub(crate) fn after(&mut self, passed_ns: i64) -> Last {
        self.time_ns += passed_ns;
        let output = self.controller.step(&ControlInput {
            time_ns: self.time_ns,
            wheels: &self.wheels,
            speed: self.speed,
            heading: self.heading,
            pitch: self.pitch,
            roll: self.roll,
            slip_demand: self.slip_demand,
            request: self.request,
        });
        Last {
            heading: output.heading,
            slip: output.slip,
            commands: [0, 1, 2, 3].map(|index| output.commands[index]),
            decision: output.decision,
        }
    }

    /// One step after a period.
    pub(crate) fn step(&mut self) -> Last {
        self.after(self.period_ns)
    }

    /// Several steps; gives the last one.
    pub(crate) fn run(&mut self, steps: usize) -> Last {
        (0..steps).map(|_| self.step()).last().unwrap()
    }

    /// Steps until a decision comes: their number, and the decision. None may come of another kind.
    pub(crate) fn until(&mut self, action: Action, reason: Reason) -> (usize, Decision) {
        for step in 1..20_000 {
            if let Some(decision) = self.step().decision {
                assert_eq!(
                    (decision.action, decision.reason),
                    (action, reason),
                    "{decision} after {step} steps"
                );
                assert_eq!(decision.time_ns, self.time_ns);
                return (step, decision);
            }
        }
        panic!("no {action:?} in 200 s")
    }

    /// Steps without any decision.
    pub(crate) fn quiet(&mut self, steps: usize) -> Last {
        let mut last = None;
        for step in 0..steps {
            let now = self.step();
            assert_eq!(now.decision, None, "after {step} steps");
            last = Some(now);
        }
        last.unwrap()
    }
}

/// The output of a first-order filter of time constant `time_s` that begins at 0, after a number of steps with a constant
/// input: its pole is 1/(1 + Δt/T).
pub(crate) fn smoothed(input: f64, time_s: f64, steps: usize) -> f64 {
    input * (1.0 - (1.0 + STEP_S / time_s).powf(-(steps as f64)))
}

pub(crate) fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// Decisions look at how long something has lasted: sums of steps may miss the limit by rounding.
pub(crate) fn at(steps: usize, expected: usize) -> bool {
    steps == expected || steps == expected + 1
}
