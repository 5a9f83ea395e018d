//! The soil on which a recorded robot drove, learnt as its own computer would.

use grouser_files::robot::RobotFile;
use grouser_slip::control::WheelObservation;
use grouser_slip::filter::BodyEstimate;
use grouser_slip::onboard::{SoilEstimate, SoilFamily, SoilLearnSettings, SoilLearner, WheelSetup};
use grouser_slip::{Measurement, Slip, WheelEstimate, WheelRole};
use grouser_terra::{EARTH_GRAVITY_M_PER_S2, Soil};

use crate::error::{Error, Result};

/// Which wheels have a motor is all that counts of this, N m.
const SOME_TORQUE_N_M: f64 = 1.0;
/// A gap in the log counts as at most this long, s.
const MAX_STEP_S: f64 = 0.1;
/// A logged robot does not stand steeper than 60°: a specific force along it of more than that is shaking.
const MIN_UPWARD_SHARE: f64 = 0.5;

/// Feeds a learner with what a log has.
#[derive(Debug)]
pub(crate) struct SoilLearning {
    learner: SoilLearner,
    observations: Vec<WheelObservation>,
    /// m/s².
    gravity: f64,
    /// Has a specific force come since the last tick?
    has_force: bool,
    last_ns: Option<i64>,
}

impl SoilLearning {
    /// For a robot that knows `soil`.
    pub(crate) fn new(file: &RobotFile, soil: &Soil) -> Result<Self> {
        let robot = &file.robot;
        let mut setups = Vec::with_capacity(robot.wheels().len());
        for wheel in robot.wheels() {
            let needs = |key| Error::NoWheelSize {
                wheel: wheel.name.clone(),
                key,
            };
            wheel.width.ok_or_else(|| needs("width_m"))?;
            let load = wheel.load.ok_or_else(|| needs("load_n"))?;
            setups.push(WheelSetup {
                load,
                max_torque: (wheel.role == WheelRole::Powered).then_some(SOME_TORQUE_N_M),
                ..WheelSetup::default()
            });
        }
        let mut settings = SoilLearnSettings::default();
        [settings.sinkage_sigma, settings.entry_angle_sigma] = file.contact_sigmas;
        let family = SoilFamily::solve(robot, &setups, soil)?;
        let loads = setups.iter().map(|setup| setup.load);
        Ok(Self {
            observations: loads.map(WheelObservation::unknown).collect(),
            learner: SoilLearner::new(robot, &setups, family, settings)?,
            gravity: file.gravity.unwrap_or(EARTH_GRAVITY_M_PER_S2),
            has_force: false,
            last_ns: None,
        })
    }

    /// A sample of the log.
    pub(crate) fn take(&mut self, measurement: &Measurement) {
        if let Measurement::Acceleration { forward, left } = *measurement {
            // upwards is what gravity leaves over, since a robot on wheels hardly accelerates upwards
            let along = forward * forward + left * left;
            let least = MIN_UPWARD_SHARE * self.gravity;
            let up = (self.gravity * self.gravity - along).max(least * least);
            let up = up.sqrt();
            self.learner.add_force([forward, left, up]);
            self.has_force = true;
        }
        // the learner counts what it refuses
        let _ = self.learner.add_contact(measurement);
    }

    /// The estimates of a moment at which a specific force was measured.
    pub(crate) fn step(
        &mut self,
        now_ns: i64,
        wheels: &[WheelEstimate],
        (body, torques): (&BodyEstimate, &[Option<f64>]),
    ) {
        if !std::mem::take(&mut self.has_force) {
            return;
        }
        let last_ns = self.last_ns.replace(now_ns).unwrap_or(now_ns);
        let step = (now_ns.saturating_sub(last_ns) as f64 * 1e-9).clamp(0.0, MAX_STEP_S);
        for (seen, wheel) in self.observations.iter_mut().zip(wheels) {
            *seen = WheelObservation {
                slip: wheel.slip.map(Slip::value),
                sigma: wheel.sigma,
                health: wheel.health,
                motion: wheel.motion,
                forward_speed: wheel.forward_speed.map(|speed| speed.value),
                rim_speed: wheel.rim_speed.map(|speed| speed.value),
                ..*seen
            };
        }
        let motion = (body.forward.value, body.yaw_rate.value);
        self.learner
            .update(&self.observations, torques, motion, step);
    }

    pub(crate) fn estimate(&self) -> SoilEstimate {
        self.learner.estimate()
    }
}
