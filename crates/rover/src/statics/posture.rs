//! The chassis adjusted for a slope.

use grouser_real::Real;

use super::equations::Equations;
use crate::robot::RobotModel;

/// What may be adjusted, and how far.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PostureLimits {
    /// The chassis' centre of gravity slides forwards and back by up to this, m.
    pub slide: f64,
    /// And to either side, m.
    pub shift: f64,
    /// And down by up to this, m.
    pub lower: f64,
    /// The wheels of one side stand apart by up to this factor (wheelbase, with the rockers' length).
    pub lengthen: f64,
    /// And the two sides (stance).
    pub widen: f64,
}

impl Default for PostureLimits {
    /// A reconfigurable chassis of half a metre's wheelbase, as that of \[Ani2012\] (its figure 1 shows the adjustments and
    /// prints no sizes): a tenth of it for the centre of gravity, a fifth for wheelbase and stance.
    fn default() -> Self {
        Self {
            slide: 0.05,
            shift: 0.05,
            lower: 0.05,
            lengthen: 1.2,
            widen: 1.2,
        }
    }
}

/// A chassis adjusted for a slope.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Posture {
    /// The centre of gravity's way forwards, to the left and down, m.
    pub moved: [f64; 3],
    /// Factors of wheelbase and stance.
    pub factors: [f64; 2],
    /// Least angle to tipping over, rad, before and after.
    pub tip_over: [f64; 2],
    /// Standard deviation of the powered wheels' loads over their mean, before and after.
    pub unevenness: [f64; 2],
    /// The robot so adjusted.
    pub model: RobotModel,
}

/// The adjustment that stands best on a slope (`pitch` nose up, `roll` left side up, rad): the angle to tipping over
/// (rad) less half the unevenness of the loads is greatest.
///
/// A pattern search within the limits, from no adjustment; it never ends worse than it began.
///
/// ```
/// use grouser_rover::robot::RobotModel;
/// use grouser_rover::statics::{PostureLimits, adjusted_posture};
///
/// let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/robots/skid-steer.toml");
/// let model = RobotModel::read(file.as_ref())?;
/// let posture = adjusted_posture(&model, (0.35, 0.0), &PostureLimits::default());
/// let [before, after] = posture.tip_over;
/// assert!(after > before);
/// # Ok::<(), grouser_rover::Error>(())
/// ```
#[must_use]
pub fn adjusted_posture(
    model: &RobotModel,
    (pitch, roll): (f64, f64),
    limits: &PostureLimits,
) -> Posture {
    let value = |x: &[f64], at_best: f64| {
        let (tip_over, uneven) = quality(&adjusted(model, x), (pitch, roll), at_best);
        tip_over - 0.5 * uneven
    };
    let bounds = [
        (-limits.slide, limits.slide),
        (-limits.shift, limits.shift),
        (0.0, limits.lower),
        (1.0, limits.lengthen.max(1.0)),
        (1.0, limits.widen.max(1.0)),
    ];
    let mut best = [0.0, 0.0, 0.0, 1.0, 1.0];
    maximise(&mut best, &bounds, 1e-4, value);
    let after = adjusted(model, &best);
    let (tip_before, uneven_before) = quality(model, (pitch, roll), f64::NEG_INFINITY);
    let (tip_after, uneven_after) = quality(&after, (pitch, roll), f64::NEG_INFINITY);
    Posture {
        moved: [best[0], best[1], best[2]],
        factors: [best[3], best[4]],
        tip_over: [tip_before, tip_after],
        unevenness: [uneven_before, uneven_after],
        model: after,
    }
}

/// The angle to tipping over and the unevenness; the angle only as far as it shows that they are not better than `at_best`.
fn quality(model: &RobotModel, (pitch, roll): (f64, f64), at_best: f64) -> (f64, f64) {
    let equations = Equations::on_plane(model);
    let down = equations.down(pitch, roll);
    let (loads, _) = equations.loads(down);
    let powered: Vec<f64> = model.powered().map(|index| loads[index]).collect();
    let count = powered.len().max(1) as f64;
    let mean = powered.iter().sum::<f64>() / count;
    let square = powered.iter().map(|l| Real::powi(l - mean, 2)).sum::<f64>() / count;
    let uneven = square.sqrt() / mean.abs().max(1e-9);
    (equations.tip_over(down, at_best + 0.5 * uneven), uneven)
}

/// Raises the `value` of `best` within `bounds`: by steps along each axis, and along each pair of axes where none helps. Steps
/// are halved from half of the bounds down to a share `finest` where nothing helps; returns the value that is reached. `value`
/// receives the value to surpass: below it, any number below it will do.
///
/// The margin against tipping over is the least of several: its maximum lies on ridges, along which two axes move together.
pub(super) fn maximise(
    best: &mut [f64],
    bounds: &[(f64, f64)],
    finest: f64,
    mut value: impl FnMut(&[f64], f64) -> f64,
) -> f64 {
    /// Bounds the work; a search takes two or three passes for each size of step.
    const MAX_PASSES: usize = 100;
    const SENSES: [f64; 2] = [1.0, -1.0];
    let mut at_best = value(best, f64::NEG_INFINITY);
    let mut share = 0.5;
    for _ in 0..MAX_PASSES {
        if share <= finest {
            break;
        }
        let mut helps = |steps: &[(usize, f64)]| {
            let mut trial = best.to_vec();
            for (axis, sense) in steps {
                let (low, high) = bounds[*axis];
                trial[*axis] = (trial[*axis] + sense * share * (high - low)).clamp(low, high);
            }
            if trial == best {
                return false;
            }
            let at_trial = value(&trial, at_best);
            let is_better = at_trial > at_best + 1e-12;
            if is_better {
                best.copy_from_slice(&trial);
                at_best = at_trial;
            }
            is_better
        };
        let mut moved = false;
        for i in 0..bounds.len() {
            moved = SENSES
                .iter()
                .fold(moved, |moved, a| helps(&[(i, *a)]) || moved);
        }
        for (i, a) in (0..bounds.len()).flat_map(|i| SENSES.map(|a| (i, a))) {
            for (j, b) in (0..i).flat_map(|j| SENSES.map(|b| (j, b))) {
                moved = moved || helps(&[(i, a), (j, b)]);
            }
        }
        if !moved {
            share *= 0.5;
        }
    }
    at_best
}

fn adjusted(model: &RobotModel, x: &[f64]) -> RobotModel {
    let mut out = model.clone();
    let &[slide, shift, lower, lengthen, widen] = x else {
        return out;
    };
    out.linkage.adjust(
        crate::vector::Vector::new(slide, shift, -lower),
        (lengthen, widen),
    );
    for wheel in &mut out.wheels {
        wheel.centre.x *= lengthen;
        wheel.centre.y *= widen;
    }
    out
}
