//! Forward and backward: what was known up to a time, joined with what was known from it on.

use std::collections::VecDeque;

use grouser_real::Real;
use grouser_slip::filter::{FilterSettings, SlipFilter};
use grouser_slip::window::WindowBody;
use grouser_slip::{BodyMotion, Health, Measured, Robot, Sample, Slip, WheelEstimate, WheelRole};

use crate::error::Result;
use crate::method::rotating_wheel;
use crate::moment::Moment;
use crate::path_smoother::LoggedPath;
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
/// Where the two sides are further apart over the log than P_f + P_b says, both variances grow by that factor.
/// Assumes: one number at a time, its covariance with the others aside.
#[derive(Debug)]
pub(crate) struct Smoother {
    robot: Robot,
    settings: FilterSettings,
    samples: Vec<Sample>,
    moments: VecDeque<Moment>,
    /// Is the common slip of the wheels smoothed by all positions at once? So it is for robots without a free wheel.
    is_by_positions: bool,
}

impl Smoother {
    pub(crate) fn new(robot: &Robot, settings: FilterSettings) -> Self {
        Self {
            robot: robot.clone(),
            settings,
            samples: Vec::new(),
            moments: VecDeque::new(),
            is_by_positions: robot
                .wheels()
                .iter()
                .all(|wheel| wheel.role == WheelRole::Powered),
        }
    }

    /// A sample that the forward filter took.
    pub(crate) fn add(&mut self, sample: Sample) {
        self.samples.push(sample);
    }

    /// What the forward filter knew; gives moments that are done.
    pub(crate) fn push(&mut self, mut moment: Moment) -> Result<Vec<Moment>> {
        // what the forward filter integrated is not smooth
        moment.odometry = None;
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
        let latency = latency_ns(&self.settings);
        let path = LoggedPath::of(&self.moments, &self.samples, latency);
        let path = path.filter(|_| self.is_by_positions);
        let settings = FilterSettings {
            reference_latency: 0.0,
            ..self.settings
        };
        let mut filter = SlipFilter::new(&self.robot, settings)?;
        let mut waiting = self.moments.iter_mut().rev().peekable();
        let mut pairs = Vec::with_capacity(waiting.len());
        for sample in reversed(&self.samples, end_ns, latency) {
            while let Some(moment) =
                waiting.next_if(|moment| end_ns.saturating_sub(moment.time_ns) <= sample.time_ns)
            {
                if moment.time_ns < until_ns {
                    pairs.push((moment, After::of(&filter)));
                }
            }
            let _refused = filter.update(sample);
        }
        let joint = Joint::new(&self.robot, &self.settings, path.is_some(), &pairs);
        for (moment, after) in &mut pairs {
            joint.join(moment, after);
        }
        if let Some(path) = path {
            path.smooth(pairs.into_iter().map(|(moment, _)| moment), &self.settings);
        }
        Ok(())
    }
}

/// What the backward filter knows at a moment.
struct After {
    wheels: Vec<WheelEstimate>,
    common_slip: Measured,
    speeds: [Measured; 3],
}

impl After {
    fn of(filter: &SlipFilter) -> Self {
        let known = filter.latest();
        let body = known.body;
        Self {
            wheels: known.wheels.to_vec(),
            common_slip: body.common_slip,
            speeds: [body.forward, body.left, body.yaw_rate],
        }
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a latency is at most a second"
)]
pub(crate) fn latency_ns(settings: &FilterSettings) -> i64 {
    (settings.reference_latency * 1e9).round() as i64
}

/// A robot at one time of its samples, by the filter alone and with what came later.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Smoothed {
    /// ns, on the samples' clock.
    pub time_ns: i64,
    /// Each wheel by the samples up to this time.
    pub forward: Vec<WheelEstimate>,
    /// Each wheel by all samples.
    pub wheels: Vec<WheelEstimate>,
    /// Speed forwards, to the left, and yaw rate by all samples.
    pub motion: Option<BodyMotion>,
}

/// Samples in order of time through the filter forward and backward: what `estimate --smooth` does with a log.
///
/// # Errors
/// [`Error::Settings`](crate::Error::Settings) for settings or a robot that the filter refuses.
pub fn smoothed(
    robot: &Robot,
    settings: FilterSettings,
    samples: &[Sample],
) -> Result<Vec<Smoothed>> {
    let settings = FilterSettings {
        horizon: 0.0,
        ..settings
    };
    let mut filter = SlipFilter::new(robot, settings)?;
    let mut smoother = Smoother::new(robot, settings);
    let (mut forward, mut done) = (Vec::new(), Vec::new());
    let mut read = 0;
    for (index, sample) in samples.iter().enumerate() {
        if filter.update(*sample).is_ok() {
            smoother.add(*sample);
        }
        if let Some(wheel) = rotating_wheel(&sample.measurement) {
            read |= 1 << wheel;
        }
        if samples
            .get(index + 1)
            .is_some_and(|next| next.time_ns == sample.time_ns)
        {
            continue;
        }
        let known = filter.latest();
        forward.push(known.wheels.to_vec());
        let nothing = WindowBody::default();
        let mut moment = Moment::default();
        let time = (sample.time_ns, std::mem::take(&mut read));
        moment.enter_filter(time, known.wheels, &known.body, &nothing);
        done.extend(smoother.push(moment)?);
    }
    done.extend(smoother.finish()?);
    let one = |(forward, moment): (Vec<WheelEstimate>, Moment)| Smoothed {
        time_ns: moment.time_ns,
        forward,
        wheels: moment.wheels,
        motion: moment.motion,
    };
    Ok(forward.into_iter().zip(done).map(one).collect())
}

/// What is shared by both sides, and what was believed before either.
struct Joint<'a> {
    robot: &'a Robot,
    settings: &'a FilterSettings,
    /// Are only the differences of the wheels from the common slip joined, which is smoothed by all positions?
    is_beside_common: bool,
    /// How much further apart the two sides are than they say, as a share of that variance, of each wheel.
    apart: Vec<f64>,
}

/// No side's own variance is taken for less.
const MIN_VARIANCE: f64 = 1e-10;

/// A number with its variance.
type Known = (f64, f64);

impl<'a> Joint<'a> {
    fn new(
        robot: &'a Robot,
        settings: &'a FilterSettings,
        is_beside_common: bool,
        pairs: &[(&mut Moment, After)],
    ) -> Self {
        let mut joint = Self {
            robot,
            settings,
            is_beside_common,
            apart: vec![1.0; robot.wheels().len()],
        };
        for index in 0..joint.apart.len() {
            let (mut sum, mut count) = (0.0, 0.0);
            for (moment, after) in pairs {
                if let Some((f, b)) = joint.both(moment, after, index) {
                    let shared = joint.shared(moment, index);
                    let said = (f.1 - shared).max(MIN_VARIANCE) + (b.1 - shared).max(MIN_VARIANCE);
                    sum += Real::powi(f.0 - b.0, 2) / said;
                    count += 1.0;
                }
            }
            if sum > count {
                joint.apart[index] = sum / count;
            }
        }
        joint
    }

    /// The slips of a wheel by both sides, where both are sure of themselves; or their differences from the common one.
    fn both(&self, moment: &Moment, after: &After, index: usize) -> Option<(Known, Known)> {
        let of = |wheel: &WheelEstimate, common: Known| {
            let known = (wheel.slip?.value(), Real::powi(wheel.sigma?, 2));
            let own = (known.0 - common.0, (known.1 - common.1).max(MIN_VARIANCE));
            Some(own).filter(|_| wheel.health == Health::Ok)
        };
        let before = of(&moment.wheels[index], self.common(moment.common_slip))?;
        let after = of(&after.wheels[index], self.common(Some(after.common_slip)))?;
        Some((before, after))
    }

    /// What is known of the wheels' common slip, where it is no part of what is joined; else 0.
    fn common(&self, slip: Option<Measured>) -> Known {
        let known = slip.filter(|_| self.is_beside_common);
        known.map_or((0.0, 0.0), |slip| (slip.value, slip.variance))
    }

    /// Variance that both sides have in common at this slip.
    fn shared(&self, moment: &Moment, index: usize) -> f64 {
        let s = self.settings;
        let slip = moment.wheels[index].slip.map_or(0.0, Slip::value);
        (Real::powi(s.radius_sigma, 2) + Real::powi(s.free_slip.sigma, 2))
            * Real::powi(1.0 - slip, 2)
    }

    fn join(&self, moment: &mut Moment, after: &After) {
        let described = self.robot.wheels().iter().zip(&self.apart);
        for (index, (wheel, apart)) in described.enumerate() {
            if wheel.role == WheelRole::Powered
                && let Some((f, b)) = self.both(moment, after, index)
            {
                let s = self.settings;
                let own = (0.0, Real::powi(s.wheel_slip_sigma, 2));
                let prior = if self.is_beside_common {
                    own
                } else {
                    (s.slip.mean, own.1 + Real::powi(s.slip.sigma, 2))
                };
                let shared = self.shared(moment, index);
                let scaled = |(slip, variance): Known| {
                    (slip, shared + apart * (variance - shared).max(MIN_VARIANCE))
                };
                let prior = (prior.0, apart * prior.1);
                let (slip, variance) = joined(scaled(f), scaled(b), Some(prior), shared);
                let common = self.common(moment.common_slip);
                let before = &mut moment.wheels[index];
                before.slip = Slip::new((common.0 + slip).clamp(-1.0, 1.0)).ok();
                before.sigma = Some((common.1 + variance).sqrt());
            }
        }
        if self.is_beside_common {
            return;
        }
        let sure = after.wheels.iter().any(|wheel| wheel.health == Health::Ok);
        if let Some(motion) = &mut moment.motion
            && sure
        {
            self.join_motion(motion, after.speeds);
        }
    }

    fn join_motion(&self, motion: &mut BodyMotion, after: [Measured; 3]) {
        for (i, after) in after.into_iter().enumerate() {
            let forward = (motion.velocity[i], motion.covariance[i][i]);
            // the way back has the other sign
            let backward = (-after.value, after.variance);
            let shared = if i == 0 {
                Real::powi(self.settings.free_slip.sigma * forward.0, 2)
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
    let (w_f, w_b) = (
        1.0 / (p_f - shared).max(MIN_VARIANCE),
        1.0 / (p_b - shared).max(MIN_VARIANCE),
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
