//! The filter in the loop: what it is told, and what the loop needs of it.

use grouser_slip::control::WheelSeen;
use grouser_slip::detect::{DetectSettings, Detector};
use grouser_slip::filter::{FilterSettings, SlipFilter, SlipPrior};
use grouser_slip::prior::{FreeWheelSkid, SlipDemand, SoilDoubt};
use grouser_slip::{Health, Measurement, Sample, WheelRole};
use grouser_terra::{Angle, Soil};

use super::attitude_filter::AttitudeFilter;
use super::firmness::Firmness;
use super::suspension::Suspension;
use crate::error::{Error, Result};
use crate::robot::RobotModel;
use crate::sensors::{Reading, SensorSettings};

/// The soil's prior is asked this often, s.
const PRIOR_PERIOD: f64 = 0.1;
/// Slopes that its table holds, rad either way.
const PRIOR_SLOPE: f64 = 0.35;
/// No prior of the common slip is surer than this: ruts, rocks and bends are not in the soil's model.
const PRIOR_SIGMA: f64 = 0.1;
/// Share of a motor's greatest torque at which a standing wheel is stalled.
const STALL: f64 = 0.8;

/// What the robot's computer makes of its readings.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    filter: SlipFilter,
    detector: Detector,
    attitude: AttitudeFilter,
    suspension: Suspension,
    firmness: Firmness,
    demand: Option<SlipDemand>,
    demanded: Option<SlipPrior>,
    prior_due: f64,
    /// When it last looked, s.
    looked: f64,
    /// Greatest torque of each wheel's motor, N m, and the torque by its current.
    most_torque: Vec<f64>,
    torques: Vec<Option<f64>>,
    /// The newest stamp less the computer's own clock when it arrived, ns.
    ahead: Option<i64>,
    runs: bool,
    /// Are the camera's ways taken, or the fixes?
    camera: bool,
    window: f64,
    lag: f64,
}

impl Watch {
    /// What a robot knows that has been told the soil on which it starts, its heading (rad), and how good its sensors are.
    pub(super) fn new(
        model: &RobotModel,
        loads: &[f64],
        soil: &Soil,
        heading: f64,
        sensors: &SensorSettings,
    ) -> Result<Self> {
        let camera = sensors.camera_rate > 0.0;
        let doubt = SoilDoubt::default();
        let settings = FilterSettings {
            free_slip: skid(model, loads, soil, doubt)?,
            ..told(model, sensors)
        };
        let demand = demand(model, loads, soil, doubt)?;
        let most_torque: Vec<f64> = model
            .wheels
            .iter()
            .map(|mount| mount.motor.map_or(0.0, |motor| motor.most_torque()))
            .collect();
        let weakest = most_torque.iter().copied().filter(|t| *t > 0.0);
        let detect = DetectSettings {
            stall_torque: STALL * weakest.fold(f64::MAX, f64::min),
            ..DetectSettings::default()
        };
        Ok(Self {
            window: settings.wheel_window,
            lag: settings.horizon,
            filter: SlipFilter::new(&model.robot, settings)?,
            detector: Detector::new(&model.robot, detect)?,
            attitude: AttitudeFilter::new(heading),
            suspension: Suspension::new(model),
            firmness: Firmness::new(model, loads, soil)?,
            looked: 0.0,
            demand,
            demanded: None,
            prior_due: 0.0,
            torques: vec![None; most_torque.len()],
            most_torque,
            ahead: None,
            runs: false,
            camera,
        })
    }

    /// A wheel's speeds are means over so long, s, and so long ago, s.
    pub(super) const fn window_and_lag(&self) -> (f64, f64) {
        (self.window, self.lag)
    }

    /// A reading that arrives at `now_ns` by the computer's own clock. Until it `runs` the filter waits, and the attitude is
    /// a mean of what gravity shows.
    pub(super) fn take(&mut self, reading: &Reading, now_ns: i64, runs: bool) {
        self.runs = runs;
        self.ahead = Some(reading.time_ns().saturating_sub(now_ns));
        match *reading {
            Reading::Sample(sample) => {
                let pose = matches!(sample.measurement, Measurement::Pose { .. });
                if !(pose && self.camera) {
                    self.give(sample);
                }
            }
            Reading::Inertial {
                time_ns,
                force,
                turning,
            } => {
                self.attitude.take(time_ns, force, turning);
                for sample in self.suspension.carriers(time_ns, turning.y) {
                    if runs {
                        let _ = self.filter.update(sample);
                    }
                }
                let [forward, left] = self.attitude.without_gravity(force);
                self.give(Sample {
                    time_ns,
                    measurement: Measurement::Acceleration { forward, left },
                });
            }
            Reading::Joint {
                time_ns,
                freedom,
                angle,
            } => self.suspension.take(time_ns, freedom, angle),
            Reading::Current { wheel, share, .. } => {
                self.torques[wheel] = Some(share * self.most_torque[wheel]);
            }
        }
    }

    /// What is wrong with a sample the filter counts by itself.
    fn give(&mut self, sample: Sample) {
        if !self.runs {
            return;
        }
        let _ = self.filter.update(sample);
    }

    /// Samples that the filter refused.
    pub(super) fn refused(&self) -> u64 {
        self.filter.latest().rejected.total()
    }

    /// Forward speed of the robot, m/s.
    pub(super) fn speed(&self) -> Option<f64> {
        let known = self.filter.latest();
        let fresh = known.wheels.iter().any(|wheel| {
            !matches!(wheel.health, Health::Invalid(_) | Health::Uninitialised)
                && wheel.forward_speed.is_some()
        });
        fresh.then_some(known.body.forward.value)
    }

    pub(super) const fn attitude(&self) -> &AttitudeFilter {
        &self.attitude
    }

    /// Looks at what is known at `time` (s) by the computer's clock with the wheels steered by `steers` (rad), and
    /// fills in what it knows of the wheels.
    pub(super) fn look(
        &mut self,
        time: f64,
        steers: impl Iterator<Item = f64>,
        seen: &mut [WheelSeen],
    ) {
        let step = (time - self.looked).clamp(0.0, 0.1);
        self.looked = time;
        for (wheel, steer) in steers.enumerate() {
            let _ = self.filter.set_steering_angle(wheel, steer);
        }
        if time >= self.prior_due {
            self.prior_due = time + PRIOR_PERIOD;
            self.believe();
        }
        // Silence is measured by the computer's clock: the sensors' one may have been set
        let Some(ahead) = self.ahead else { return };
        let now_ns = crate::sensors::to_ns(time).saturating_add(ahead);
        let wheels = self.filter.estimate_at(now_ns).wheels;
        let _ = self.detector.update(now_ns, wheels, &self.torques).count();
        for ((index, wheel), seen) in wheels.iter().enumerate().zip(seen) {
            seen.slip = wheel.slip.map(grouser_slip::Slip::value);
            seen.sigma = wheel.sigma;
            seen.health = wheel.health;
            seen.motion = self.detector.motion(index, wheel.motion);
            seen.forward_speed = wheel.forward_speed.map(|speed| speed.value);
            seen.rim_speed = wheel.rim_speed.map(|speed| speed.value);
            seen.firmness = self
                .firmness
                .take(index, self.torques[index], seen.slip, step);
        }
    }

    /// The slip that the soil demands where it stands; `None` where no slip holds the slope.
    pub(super) const fn demanded(&self) -> Option<SlipPrior> {
        self.demanded
    }

    /// What the soil demands on the slope that it stands on.
    fn believe(&mut self) {
        let (Some(demand), Some(pitch)) = (&self.demand, self.attitude.pitch()) else {
            return;
        };
        // nose down is downhill
        self.demanded = demand.at(Angle::from_rad(-pitch));
        if let Some(prior) = self.demanded {
            let sigma = prior.sigma.max(PRIOR_SIGMA);
            // the table holds slips only
            let _ = self.filter.set_slip_prior(SlipPrior { sigma, ..prior });
        }
    }
}

/// What the robot's file and the sensors' data sheets say.
fn told(model: &RobotModel, sensors: &SensorSettings) -> FilterSettings {
    let file = model.settings;
    let standard = FilterSettings::default();
    let (sigma, latency) = if sensors.camera_rate > 0.0 {
        (sensors.camera_sigma, sensors.camera_latency)
    } else {
        (sensors.gnss_sigma, sensors.gnss_latency)
    };
    FilterSettings {
        max_sigma: file.max_sigma,
        max_speed: file.max_speed,
        lateral_sigma: file.lateral_sigma,
        yaw_rate_sigma: file.yaw_rate_sigma,
        position_sigma: sigma.max(1e-6),
        reference_latency: latency.min(1.0),
        ..standard
    }
}

/// The skid of the free wheels on the soil under their load; of several the mean.
fn skid(model: &RobotModel, loads: &[f64], soil: &Soil, doubt: SoilDoubt) -> Result<SlipPrior> {
    let standard = FilterSettings::default().free_slip;
    let mut found: Vec<SlipPrior> = Vec::new();
    for (index, wheel) in model.robot.wheels().iter().enumerate() {
        let mount = &model.wheels[index];
        let load = loads[index].max(0.1);
        if wheel.role != WheelRole::Free {
            continue;
        }
        let of = |source| Error::Law {
            of: format!("wheel \"{}\"", wheel.name),
            source,
        };
        let table = FreeWheelSkid::new(mount.wheel, soil, mount.bearing, (load, load), doubt)
            .map_err(of)?;
        found.extend(table.at(load));
    }
    let count = found.len() as f64;
    if found.is_empty() {
        return Ok(standard);
    }
    let mean = |of: fn(&SlipPrior) -> f64| found.iter().map(of).sum::<f64>() / count;
    Ok(SlipPrior {
        mean: mean(|skid| skid.mean).clamp(-0.9, 0.9),
        sigma: mean(|skid| skid.sigma).max(standard.sigma),
    })
}

/// The slip that the soil demands of the typical wheel, over the slope; `None` for a robot without a powered wheel.
fn demand(
    model: &RobotModel,
    loads: &[f64],
    soil: &Soil,
    doubt: SoilDoubt,
) -> Result<Option<SlipDemand>> {
    let powered: Vec<usize> = model.powered().collect();
    let Some(first) = powered.first() else {
        return Ok(None);
    };
    let load = powered.iter().map(|index| loads[*index]).sum::<f64>() / powered.len() as f64;
    let slopes = (Angle::from_rad(-PRIOR_SLOPE), Angle::from_rad(PRIOR_SLOPE));
    let mount = &model.wheels[*first];
    SlipDemand::new(mount.wheel, soil, load.max(0.1), slopes, doubt)
        .map(Some)
        .map_err(|source| Error::Law {
            of: format!("wheel \"{}\"", mount.name),
            source,
        })
}
