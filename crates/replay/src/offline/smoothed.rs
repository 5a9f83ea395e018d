//! The smoothed steps, as what is known at any time between them.

use std::array;

use grouser_slip::modes::body_motion;
use grouser_slip::motion::Step;
use grouser_slip::smooth::{Fit, wheel_slips};
use grouser_slip::{BodyMotion, Health, Invalid, Slip};

use crate::moment::Moment;
use crate::odometry::Odometry;

/// What the steps of a block say; each holds in its middle.
pub(super) struct Smoothed {
    /// Middle and length of the step, s; the robot's motion over it.
    motions: Vec<([f64; 2], BodyMotion)>,
    /// End and length of the step, s; the path there.
    path: Vec<([f64; 2], Odometry)>,
    /// For each wheel middle and length of the step, s, slip and its variance.
    slips: Vec<Vec<([f64; 2], [f64; 2])>>,
}

impl Smoothed {
    /// `path` is where the robot was after each step that is used; `scale_sigma` is that of the scale which all speeds over ground share.
    pub(super) fn new(
        found: &Fit,
        steps: &[Step],
        path: Vec<Option<Odometry>>,
        scale_sigma: f64,
    ) -> Self {
        let middle = |step: &Step| [step.time - 0.5 * step.dt, step.dt];
        let motions = steps.iter().zip(&found.smoothed).zip(&found.common);
        let motions = motions
            .map(|((step, belief), common)| (middle(step), body_motion(belief, common, step.dt)));
        let path = steps.iter().zip(path);
        let path = path.filter_map(|(step, at)| Some(([step.time, step.dt], at?)));
        let wheels = steps.first().map_or(0, |step| step.wheels.len());
        let slips = (0..wheels).map(|wheel| {
            let slips = wheel_slips(found, steps, wheel).into_iter();
            let other = found.other.as_ref().map(|of| wheel_slips(of, steps, wheel));
            slips
                .enumerate()
                .map(|(i, of)| {
                    let of_scale = scale_sigma * (1.0 - of.slip.abs());
                    // how the slip changes is not known: what both priors differ by is not either
                    let off = other.as_ref().map_or(0.0, |other| other[i].slip - of.slip);
                    let variance = of.variance + of_scale * of_scale + off * off;
                    (middle(&steps[of.step]), [of.slip, variance])
                })
                .collect()
        });
        Self {
            motions: motions.collect(),
            path: path.collect(),
            slips: slips.collect(),
        }
    }

    /// Enters what is known at a time.
    pub(super) fn enter(&self, time: f64, moment: &mut Moment) {
        for (wheel, slips) in moment.wheels.iter_mut().zip(&self.slips) {
            if matches!(
                wheel.health,
                Health::Invalid(Invalid::Dropout | Invalid::Inconsistent)
            ) {
                continue;
            }
            if let Some((a, b, share)) = between(slips, time) {
                let [slip, variance] = [0, 1].map(|i| a[i] + share * (b[i] - a[i]));
                if let Ok(slip) = Slip::new(slip.clamp(-1.0, 1.0)) {
                    (wheel.slip, wheel.sigma) = (Some(slip), Some(variance.max(0.0).sqrt()));
                }
            }
        }
        if let Some((a, b, share)) = between(&self.motions, time) {
            let blend = |a: f64, b: f64| a + share * (b - a);
            moment.motion = Some(BodyMotion {
                velocity: array::from_fn(|i| blend(a.velocity[i], b.velocity[i])),
                covariance: array::from_fn(|i| {
                    array::from_fn(|j| blend(a.covariance[i][j], b.covariance[i][j]))
                }),
            });
        }
        let path = between(&self.path, time).map(|(a, b, share)| a.towards(&b, share));
        moment.odometry = path.zip(moment.motion).map(|(path, motion)| Odometry {
            velocity: motion.velocity,
            velocity_covariance: motion.covariance,
            ..path
        });
    }
}

/// What lies before and after a time, and how far it lies between them; the nearest one where the other is more than its step away.
fn between<T: Copy>(series: &[([f64; 2], T)], time: f64) -> Option<(T, T, f64)> {
    let next = series.partition_point(|of| of.0[0] < time);
    let is_near = |of: &([f64; 2], T)| (time - of.0[0]).abs() <= of.0[1];
    let before = next.checked_sub(1).map(|i| series[i]).filter(is_near);
    let after = series.get(next).copied().filter(is_near);
    match (before, after) {
        (Some(([from, _], a)), Some(([to, _], b))) if to > from => {
            Some((a, b, (time - from) / (to - from)))
        }
        (Some((_, a)), _) => Some((a, a, 0.0)),
        (None, Some((_, b))) => Some((b, b, 0.0)),
        (None, None) => None,
    }
}
