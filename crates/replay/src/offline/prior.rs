//! What is believed before a log.

use grouser_files::robot::RobotFile;
use grouser_slip::Reference;
use grouser_slip::motion::{Belief, HEADING, KINDS, Levels, Noise, Step, Value, X, Y, start};

use crate::choice::Inputs;

/// What robot file and inputs say of the noise.
#[derive(Debug)]
pub(super) struct Prior {
    position_sigma: f64,
    yaw_sigma: f64,
    speed_sigma: f64,
    reference: Reference,
    skid_sigma: f64,
}

impl Prior {
    pub(super) fn new(file: &RobotFile, inputs: &Inputs) -> Self {
        let settings = &file.settings;
        Self {
            position_sigma: inputs.position_sigma.unwrap_or(settings.position_sigma),
            yaw_sigma: settings.yaw_sigma,
            speed_sigma: settings.speed_sigma,
            reference: inputs.reference,
            skid_sigma: file.filter.skid().sigma,
        }
    }

    /// Sigma of the scale of all speeds: where a free wheel alone shows the speed over ground, that of its skid.
    pub(super) fn scale_sigma(&self) -> f64 {
        if self.reference == Reference::FreeWheel {
            self.skid_sigma
        } else {
            0.0
        }
    }

    /// Variances of the kinds of noise before the log, and which of them the log teaches.
    pub(super) fn levels(&self, steps: &[Step]) -> (Levels, [bool; KINDS]) {
        let by_displacement = self.reference == Reference::Displacement;
        // a cheap gyro's, or what differential wheels make of a turn
        let (turn, turn_bias) = if has_gyro(steps) {
            (2e-3, 2e-4)
        } else {
            (0.05, 0.05)
        };
        // a sum of displacements wanders, a pose does not
        let (wander, place) = if by_displacement {
            (1e-3, 1e-3)
        } else {
            (1e-5, self.position_sigma)
        };
        let sigmas = [
            0.03, // the logarithmic slip's walk, 1/√s
            0.03, // the drift's
            0.03, // the speed's next to an accelerometer, m/s/√s
            turn,
            turn_bias,
            3e-3, // the accelerometer's bias, m/s²/√s
            wander,
            place,
            self.yaw_sigma,
            self.speed_sigma,
            1.0,
        ];
        let mut learn = [true; KINDS];
        learn[Noise::Wheel as usize] = false;
        learn[Noise::Wander as usize] = by_displacement;
        (Levels(sigmas.map(|sigma| sigma * sigma)), learn)
    }
}

fn has_gyro(steps: &[Step]) -> bool {
    steps.iter().any(|step| step.turn.is_some())
}

/// The belief before the first step: at the first place, with the first heading.
pub(super) fn begin(steps: &[Step]) -> Belief {
    let values = || (steps.iter().flat_map(|step| &step.readings)).map(|of| of.value);
    let place = values().find_map(|value| match value {
        Value::Place(place) => Some(place),
        Value::Heading(_) | Value::Speed(_) => None,
    });
    let heading = values().find_map(|value| match value {
        Value::Heading(heading) => Some(heading),
        Value::Place(_) | Value::Speed(_) => None,
    });
    let mut belief = start(
        place.unwrap_or_default(),
        heading.unwrap_or_default(),
        has_gyro(steps),
    );
    // without a reading of them the start is where it is
    let known = [
        (X, place.is_none()),
        (Y, place.is_none()),
        (HEADING, heading.is_none() && place.is_none()),
    ];
    for (index, _) in known.into_iter().filter(|of| of.1) {
        belief.covariance[index][index] = 0.0;
    }
    belief
}
