//! Forward and backward: what was known up to a time, joined with what was known from it on.

use std::collections::VecDeque;

use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::{BodyMotion, Drive, Health, Robot, Sample, Slip, WheelEstimate};

use crate::error::Result;
use crate::moment::Moment;
use crate::reversed::reversed;

/// The backward pass works on this many samples at a time, and begins this many later: that is more than the slip
/// remembers. Memory is bounded by both: about 50 bytes a sample and 150 a wheel and time.
const BLOCK: usize = 1 << 19;
const BEYOND: usize = 1 << 17;

/// Two-filter smoothing of the slips and the robot's speeds (Fraser and Potter 1969).
///
/// A filter runs forwards, a second one backwards over the same samples; each knows x with variance P from its side, and
/// both have used the same prior (x_0, P_0), which therefore counts once:
///
/// ```text
/// 1/P = 1/P_f + 1/P_b − 1/P_0,   x = P (x_f/P_f + x_b/P_b − x_0/P_0)
/// ```
///
/// A slip's prior is a stationary Gauss-Markov process, the same from both sides. What both sides share (a wheel's
/// radius, a free wheel's skid) is no reason to be more certain: its variance P_c is taken out before and put back after.
/// Assumes: one number at a time, its covariance with the others aside.
#[derive(Debug)]
pub(crate) struct Smoother {
    robot: Robot,
    settings: FilterSettings,
    samples: Vec<Sample>,
    moments: VecDeque<Moment>,
}

impl Smoother {
    pub(crate) fn new(robot: &Robot, settings: FilterSettings) -> Self {
        Self {
            robot: robot.clone(),
            settings,
            samples: Vec::new(),
            moments: VecDeque::new(),
        }
    }

    /// A sample that the forward filter took.
    pub(crate) fn hear(&mut self, sample: Sample) {
        self.samples.push(sample);
    }

    /// What the forward filter knew; gives moments that are done.
    pub(crate) fn push(&mut self, moment: Moment) -> Result<Vec<Moment>> {
        self.moments.push_back(moment);
        if self.samples.len() < BLOCK + BEYOND {
            return Ok(Vec::new());
        }
        let until_ns = self.samples[BLOCK].time_ns;
        self.look_back()?;
        let done = self.moments.partition_point(|m| m.time_ns < until_ns);
        self.samples.drain(..BLOCK);
        Ok(self.moments.drain(..done).collect())
    }

    /// The log is over: gives what is left.
    pub(crate) fn finish(mut self) -> Result<Vec<Moment>> {
        self.look_back()?;
        Ok(self.moments.into())
    }

    /// Joins every moment at hand with what the samples after it say. A moment that is not given out yet stays as the
    /// forward filter left it.
    fn look_back(&mut self) -> Result<()> {
        let Some(end_ns) = self.samples.last().map(|sample| sample.time_ns) else {
            return Ok(());
        };
        let is_last = self.samples.len() < BLOCK + BEYOND;
        let until_ns = if is_last {
            i64::MAX
        } else {
            self.samples[BLOCK].time_ns
        };
        let latency = grouser_latency(&self.settings);
        let settings = FilterSettings {
            reference_latency: 0.0,
            ..self.settings
        };
        let mut filter = SlipFilter::new(&self.robot, settings)?;
        let joint = Joint::new(&self.robot, &self.settings);
        let mut waiting = self.moments.iter_mut().rev().peekable();
        for sample in reversed(&self.samples, end_ns, latency) {
            while let Some(moment) =
                waiting.next_if(|moment| end_ns.saturating_sub(moment.time_ns) <= sample.time_ns)
            {
                if moment.time_ns < until_ns {
                    joint.join(moment, &filter);
                }
            }
            let _refused = filter.update(sample);
        }
        Ok(())
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a latency is at most a second"
)]
fn grouser_latency(settings: &FilterSettings) -> i64 {
    (settings.reference_latency * 1e9).round() as i64
}

/// What is shared by both sides, and what was believed before either.
struct Joint<'a> {
    robot: &'a Robot,
    settings: &'a FilterSettings,
}

/// A number with its variance.
type Known = (f64, f64);

impl<'a> Joint<'a> {
    const fn new(robot: &'a Robot, settings: &'a FilterSettings) -> Self {
        Self { robot, settings }
    }

    fn join(&self, moment: &mut Moment, backward: &SlipFilter) {
        let known = backward.latest();
        let described = self.robot.wheels();
        for ((wheel, after), description) in
            moment.wheels.iter_mut().zip(known.wheels).zip(described)
        {
            if description.drive == Drive::Powered {
                self.join_wheel(wheel, after);
            }
        }
        if let Some(motion) = &mut moment.motion {
            let body = known.body;
            if known.wheels.iter().any(|wheel| wheel.health == Health::Ok) {
                self.join_motion(motion, [body.forward, body.left, body.yaw_rate]);
            }
        }
    }

    /// Both sides must be sure of themselves; else what one of them says stands alone.
    fn join_wheel(&self, before: &mut WheelEstimate, after: &WheelEstimate) {
        let of = |wheel: &WheelEstimate| Some((wheel.slip?.value(), wheel.sigma?.powi(2)));
        let (Some(forward), Some(backward)) = (of(before), of(after)) else {
            return;
        };
        if after.health != Health::Ok {
            return;
        }
        if before.health != Health::Ok {
            return;
        }
        let s = self.settings;
        let prior = (
            s.slip.mean,
            s.slip.sigma.powi(2) + s.wheel_slip_sigma.powi(2),
        );
        let shared =
            (s.radius_sigma.powi(2) + s.free_slip.sigma.powi(2)) * (1.0 - forward.0).powi(2);
        let (slip, variance) = joined(forward, backward, Some(prior), shared);
        before.slip = Slip::new(slip.clamp(-1.0, 1.0)).ok();
        before.sigma = Some(variance.sqrt());
    }

    fn join_motion(&self, motion: &mut BodyMotion, after: [grouser_slip::Measured; 3]) {
        for (i, after) in after.into_iter().enumerate() {
            let forward = (motion.velocity[i], motion.covariance[i][i]);
            // the way back has the other sign
            let backward = (-after.value, after.variance);
            let shared = if i == 0 {
                (self.settings.free_slip.sigma * forward.0).powi(2)
            } else {
                0.0
            };
            let (value, variance) = joined(forward, backward, None, shared);
            motion.velocity[i] = value;
            motion.covariance[i][i] = variance;
        }
    }
}

/// Two numbers that share a prior and an error of variance `shared`.
fn joined((x_f, p_f): Known, (x_b, p_b): Known, prior: Option<Known>, shared: f64) -> Known {
    const LEAST: f64 = 1e-10;
    let (w_f, w_b) = (
        1.0 / (p_f - shared).max(LEAST),
        1.0 / (p_b - shared).max(LEAST),
    );
    let (x_0, w_0) = prior.map_or((0.0, 0.0), |(x, p)| (x, 1.0 / p));
    let weight = w_f + w_b - w_0;
    // neither side is worse off for hearing the other
    if weight <= w_f.max(w_b) {
        return if p_f <= p_b { (x_f, p_f) } else { (x_b, p_b) };
    }
    let value = (w_f * x_f + w_b * x_b - w_0 * x_0) / weight;
    (value, 1.0 / weight + shared.min(p_f.min(p_b)))
}
