//! What finds the slips: the filter, or means over windows.

use grouser_files::robot::RobotFile;
use grouser_slip::detect::Change;
use grouser_slip::filter::Learnt;
use grouser_slip::onboard::SoilEstimate;
use grouser_slip::window::{WindowBody, WindowEstimator, WindowMeans, WindowSettings};
use grouser_slip::{Measurement, Robot, Sample, Slip};

use crate::checks::WayCheck;
use crate::choice::Inputs;
use crate::error::{Error, Result};
use crate::fusion::Fusion;
use crate::method::Method;
use crate::moment::Moment;
use crate::offline::Offline;
use crate::options::Options;
use crate::reckoning::inconsistent;
use crate::record::Estimated;

/// What finds the slips. Beside the filter, ways and turns are counted over windows.
pub(crate) enum Slips {
    Filter(Box<Fusion>, Box<WindowMeans>),
    Window(Box<WindowEstimator>),
}

impl Slips {
    /// For means over windows by `settings`.
    pub(crate) fn new(
        file: &RobotFile,
        (settings, inputs): (WindowSettings, &Inputs),
        options: &Options,
        method: Method,
    ) -> Result<Self> {
        match method {
            Method::Filter => Ok(Self::Filter(
                Box::new(Fusion::new(file, &settings, inputs, options)?),
                Box::new(WindowMeans::new(&file.robot, settings)?),
            )),
            Method::Window if options.learn_soil.is_some() => Err(Error::NothingToLearnFrom),
            Method::Window => {
                let estimator = WindowEstimator::new(&file.robot, settings)?;
                Ok(Self::Window(Box::new(estimator)))
            }
        }
    }

    /// Was nothing of an absolute reference used so far?
    pub(crate) fn is_reference_unused(&self) -> bool {
        match self {
            Self::Filter(fusion, _) => fusion.is_reference_unused(),
            Self::Window(_) => false,
        }
    }

    /// What is learnt of the soil so far.
    pub(crate) fn soil(&self) -> Option<SoilEstimate> {
        match self {
            Self::Filter(fusion, _) => fusion.soil(),
            Self::Window(_) => None,
        }
    }

    /// A measurement as the sensor shows it, gravity's share included.
    pub(crate) fn learn(&mut self, raw: &Measurement) {
        if let Self::Filter(fusion, _) = self {
            fusion.learn(raw);
        }
    }

    pub(crate) fn update(&mut self, sample: Sample) {
        // A refused sample is counted; its wheel still gets its row.
        match self {
            Self::Filter(fusion, means) => {
                let _refused = means.update(sample);
                fusion.update(sample);
            }
            Self::Window(estimator) => {
                let _refused = estimator.update(sample);
            }
        }
    }

    /// Ways and means over windows; `None` before the first sample.
    pub(crate) fn body(&self) -> Option<WindowBody> {
        match self {
            Self::Filter(_, means) => means.latest().copied(),
            Self::Window(estimator) => Some(estimator.latest()?.body),
        }
    }

    /// The acceleration to the left by which a robot without sideways motion turns, m/s².
    pub(crate) fn turn_acceleration(&self) -> f64 {
        match self {
            Self::Filter(fusion, _) => fusion.turn_acceleration(),
            Self::Window(_) => 0.0,
        }
    }

    /// The common slip of the powered wheels by the filter.
    pub(crate) fn common_slip(&self) -> Option<Slip> {
        match self {
            Self::Filter(fusion, _) => fusion.common_slip(),
            Self::Window(_) => None,
        }
    }

    /// The mean rim speed of a wheel over the window, m/s.
    pub(crate) fn rim_speed(&self, wheel: usize) -> Option<f64> {
        let speed = match self {
            Self::Filter(_, means) => means.rim_speed(wheel),
            Self::Window(estimator) => estimator.latest()?.wheels.get(wheel)?.rim_speed,
        };
        Some(speed?.value)
    }

    /// Enters what is known at a time, at which the wheels `read` were read, into `moment`. The filter also finds the wheels that
    /// contradict the others, bit by bit.
    pub(crate) fn enter(
        &mut self,
        time: (i64, u64),
        body: &WindowBody,
        (moment, robot): (&mut Moment, &Robot),
    ) -> Option<u64> {
        match self {
            Self::Filter(fusion, means) => {
                fusion.close(time, body, moment);
                let left_out = inconsistent(&moment.wheels, robot);
                means.leave_out(left_out);
                Some(left_out)
            }
            Self::Window(estimator) => {
                let wheels = estimator.latest().map_or(&[][..], |output| output.wheels);
                moment.enter_window(time, wheels, body);
                None
            }
        }
    }

    /// Events of the time that was entered last.
    pub(crate) fn new_events(&self) -> &[Change] {
        match self {
            Self::Filter(fusion, _) => fusion.new_events(),
            Self::Window(_) => &[],
        }
    }

    /// What looks back, where smoothing is wanted.
    pub(crate) const fn smoother(&mut self) -> Option<&mut Offline> {
        match self {
            Self::Filter(fusion, _) => fusion.smoother(),
            Self::Window(_) => None,
        }
    }

    pub(crate) fn learnt(&self) -> Option<Learnt> {
        match self {
            Self::Filter(fusion, _) => Some(fusion.learnt()),
            Self::Window(_) => None,
        }
    }

    pub(crate) fn restore(&mut self, learnt: &Learnt) -> Result<()> {
        match self {
            Self::Filter(fusion, _) => Ok(fusion.restore(learnt)?),
            Self::Window(_) => Ok(()),
        }
    }

    /// The log is over: gives the moments that waited.
    pub(crate) fn finish(&mut self) -> Vec<Moment> {
        match self {
            Self::Filter(fusion, _) => fusion.finish(),
            Self::Window(_) => Vec::new(),
        }
    }

    /// What was estimated; `ways` are those of filter and reference.
    pub(crate) fn estimated(&self, ways: WayCheck) -> Estimated {
        let is_unused = self.is_reference_unused();
        match self {
            Self::Filter(fusion, _) => {
                let fused = fusion.summary(ways);
                Estimated {
                    method: Method::Filter,
                    rejected: fused.rejected,
                    fused: Some(fused),
                    soil: fusion.soil(),
                    is_unused,
                }
            }
            Self::Window(estimator) => Estimated {
                method: Method::Window,
                rejected: estimator.rejected(),
                fused: None,
                soil: None,
                is_unused,
            },
        }
    }
}
