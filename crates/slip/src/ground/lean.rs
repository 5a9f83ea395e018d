//! Which way the ground leans under two wheels of one rigid link, from how fast the wheels run and the link turns.

use core::f64::consts::FRAC_PI_2;

use grouser_real::{Dual, Real};

use super::entry::Uncertain;
use crate::fault::Fault;

/// A sigma beyond this says nothing about an angle in [−π/2, π/2], rad.
const MAX_ANGLE_SIGMA_RAD: f64 = 0.35;

/// The ground's angle under two wheels, from the link that joins their centres, rad, positive uphill.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactLean {
    /// Under the front wheel.
    pub front: Uncertain,
    /// Under the rear wheel.
    pub rear: Uncertain,
}

/// What two speeds and a rate of turn say about the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LeanOutcome {
    /// Both angles.
    Measured(ContactLean),
    /// The link turns too slowly for its noise: on ground that leans alike under both wheels any common angle fits.
    NotObservable,
    /// No two angles fit: the wheels slip differently, or one is off the ground.
    Inconsistent,
}

/// Angles of the ground under the `front` and `rear` wheel of a rigid link of length `wheelbase` (m), from the
/// speeds of their centres (m/s, slip taken out) and the link's rate of turn (rad/s, positive front up).
///
/// With a = v_r/v_f and h = l α̇/v_f: sin β_f = (1 − a² + h²)/2h, sin β_r = (1 − a² − h²)/2ha; add the link's
/// pitch for the angle from the horizontal.
///
/// Source: Iagnemma & Dubowsky, ASME DETC 2000, MECH-14153. Assumes: both wheels keep to the ground and drive
/// forwards (|β| < π/2); errors independent and small. Sign: positive uphill.
///
/// # Errors
/// [`Fault::OutOfRange`] or [`Fault::NotFinite`], by field.
///
/// ```
/// use grouser_slip::ground::{LeanOutcome, Uncertain, contact_lean};
/// // the front wheel climbs 0.3 rad, the rear one is level: along the link both run at 0.1 m/s
/// let speed = |value| Uncertain { value, sigma: 1e-5 };
/// let front = 0.1 / 0.3_f64.cos();
/// let rate = front * 0.3_f64.sin() / 0.5;
/// match contact_lean(speed(front), speed(0.1), speed(rate), 0.5)? {
///     LeanOutcome::Measured(lean) => {
///         assert!((lean.front.value - 0.3).abs() < 1e-12);
///         assert!(lean.rear.value.abs() < 1e-12);
///     }
///     other => panic!("{other:?}"),
/// }
/// # Ok::<(), grouser_slip::Fault>(())
/// ```
pub fn contact_lean(
    front: Uncertain,
    rear: Uncertain,
    rate: Uncertain,
    wheelbase: f64,
) -> Result<LeanOutcome, Fault> {
    front.check(
        "front speed",
        "sigma of the front speed",
        (0.0, 100.0),
        "m/s",
    )?;
    rear.check("rear speed", "sigma of the rear speed", (0.0, 100.0), "m/s")?;
    rate.check(
        "rate of turn",
        "sigma of the rate of turn",
        (-1e3, 1e3),
        "rad/s",
    )?;
    Fault::check_range("wheelbase", wheelbase, 1e-3, 100.0, "m")?;
    let turned = wheelbase * rate.value;
    // the link turns within its noise, or nothing moves
    if turned.abs() <= 2.0 * wheelbase * rate.sigma
        || turned == 0.0
        || front.value <= 2.0 * front.sigma
        || rear.value <= 2.0 * rear.sigma
    {
        return Ok(LeanOutcome::NotObservable);
    }
    let v_f = Dual::<3>::variable(front.value, 0);
    let v_r = Dual::variable(rear.value, 1);
    let h = Dual::constant(wheelbase) * Dual::variable(rate.value, 2) / v_f;
    let a = v_r / v_f;
    let (one, two) = (Dual::ONE, Dual::constant(2.0));
    let sines = [
        (one - a * a + h * h) / (two * h),
        (one - a * a - h * h) / (two * h * a),
    ];
    let sigmas = [front.sigma, rear.sigma, rate.sigma];
    let [front, rear] = sines.map(|sine| angle(sine, sigmas));
    Ok(match (front, rear) {
        (Some(front), Some(rear)) if front.sigma.max(rear.sigma) <= MAX_ANGLE_SIGMA_RAD => {
            LeanOutcome::Measured(ContactLean { front, rear })
        }
        (Some(_), Some(_)) => LeanOutcome::NotObservable,
        _ => LeanOutcome::Inconsistent,
    })
}

/// The angle of a sine with its error; `None` where the sine is beyond ±1 by more than three sigma. The sigma
/// is that of the angle at the sine's edge where the angle's own derivative would be infinite.
fn angle(sine: Dual<3>, sigmas: [f64; 3]) -> Option<Uncertain> {
    let mut variance = 0.0;
    for (slope, sigma) in sine.gradient.iter().zip(sigmas) {
        variance += (slope * sigma) * (slope * sigma);
    }
    let sigma = Real::sqrt(variance);
    let excess = sine.value.abs() - 1.0;
    if !(excess <= 3.0 * sigma) {
        return None;
    }
    let held = sine.value.clamp(-1.0, 1.0);
    let value = Real::asin(held);
    // how far the angle moves when the sine moves by its sigma towards the middle
    let inner = Real::asin((held.abs() - sigma).clamp(-1.0, 1.0));
    Some(Uncertain {
        value,
        sigma: (value.abs() - inner).abs().min(FRAC_PI_2),
    })
}
