//! The analytical slip model of \[Ani2012\]: the slip that mobilises a share of the soil's strength.
//!
//! With T(θ) = c + σ(θ) tan φ (P7) and x = τ/T, (P8)…(P16) invert (P1); x = 0 is (P17)/(P19):
//!
//! S(θ, x) = 1 − [θ_1 − θ + (K/r) ln(1 − x)]/(sin θ_1 − sin θ), cos θ_1 = 1 − z/r (P18)
//!
//! What it means:
//! - This S is 1 − q, the driving formula continued below zero. As a [`Slip`], s = S for S ≥ 0 and
//!   s = S/(1 − S) for S < 0.
//! - S_0 = 1 − sec ξ with ξ between θ and θ_1 is never positive: it is the slip at which the shear
//!   displacement returns to zero at θ. The paper apparently prints magnitudes, |S_0|.
//! - S_0 depends on (θ, z/r) alone: no soil parameter can move it. Where θ → θ_1 it tends to −z/(r − z).
//! - θ = 32° lies outside the contact at z = 10 mm for every radius in the paper, and in all of its Fig. 10.

use grouser_real::OutOfRange;
use grouser_real::{Real, Scalar};

use crate::angle::Angle;
use crate::contact::entry_angle;
use crate::error::{Error, Result};
use crate::slip::Slip;

/// S_0(θ, z/r) of (P17)/(P19) at the angle `theta` and the entry angle `theta_1` (rad): a pure number,
/// never positive.
///
/// Written as 1 − 1/(sinc((θ_1 − θ)/2) cos((θ_1 + θ)/2)) with sinc a = sin a/a, which has no singularity at
/// θ = θ_1. Over any kind of number, so that it has exact derivatives.
///
/// Source: \[Ani2012\] (P17)-(P19). Valid range: |θ| ≤ θ_1, 0 < θ_1 < π/2; outside the contact it is
/// computed all the same.
///
/// ```
/// use grouser_terra::{entry_angle, slip_ani};
/// // θ = 32°, z = 30 mm, r = 100 mm
/// let s_0 = slip_ani(32_f64.to_radians(), entry_angle(0.030, 0.100));
/// assert!((s_0 + 0.2859).abs() < 5e-5);
/// ```
pub fn slip_ani<R: Real>(theta: R, theta_1: R) -> R {
    let half = R::from_f64(0.5);
    R::ONE - R::ONE / (sinc(half * (theta_1 - theta)) * (half * (theta_1 + theta)).cos())
}

/// sin a/a, 1 at 0. The series below 0.01 is good to a⁶/5040 < 2e-16.
fn sinc<R: Real>(a: R) -> R {
    let small = a.abs().lt(R::from_f64(0.01));
    let y = a * a;
    let series = R::ONE - y * R::from_f64(1.0 / 6.0) * (R::ONE - y * R::from_f64(1.0 / 20.0));
    R::select(small, series, a.sin() / R::select(small, R::ONE, a))
}

/// A slip that the analytical model gives.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ModelSlip {
    /// S = 1 − v/(r ω), the driving formula for driving and braking alike.
    pub driving_formula: f64,
    /// The same as a slip.
    pub slip: Slip,
    /// Entry angle.
    pub theta_1: Angle,
    /// Does the angle lie in the contact, |θ| ≤ θ_1? Outside it the number has no meaning under a wheel.
    pub in_contact: bool,
}

/// How the model's question ended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ModelOutcome {
    /// There is such a slip.
    Slip(ModelSlip),
    /// The share cannot be mobilised at this angle: even a wheel that spins on the spot reaches only
    /// `max_share`, 1 − e^(−r (θ_1 − θ)/K).
    Unreachable {
        /// The greatest share that can be mobilised there.
        max_share: f64,
    },
}

/// What share of the strength is to be mobilised, and how stiff the soil is in shear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mobilised {
    /// x = τ/T, in [0, 1).
    pub share: f64,
    /// Shear deformation modulus K, m.
    pub k_shear: f64,
}

/// S(θ, x): the slip at which the soil at `theta` under a wheel of `radius` sunk by `sinkage` (m)
/// mobilises the share x of its strength; without `mobilised`, S_0.
///
/// # Errors
/// [`Error::OutOfRange`] and [`Error::HubBuried`] for what no wheel can do; at θ = θ_1 with x > 0 there is
/// a pole, which is out of range too.
///
/// ```
/// use grouser_terra::{Angle, ModelOutcome, slip_model};
/// // the free test: S_0 depends on z/r alone
/// let at = |z, r| match slip_model(Angle::from_deg(10.0), z, r, None)? {
///     ModelOutcome::Slip(found) => Ok::<f64, grouser_terra::Error>(found.driving_formula),
///     _ => unreachable!("S_0 always exists"),
/// };
/// assert!((at(0.020, 0.10)? - at(0.014, 0.07)?).abs() < 1e-15);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
pub fn slip_model(
    theta: Angle,
    sinkage: f64,
    radius: f64,
    mobilised: Option<Mobilised>,
) -> Result<ModelOutcome> {
    let right = core::f64::consts::FRAC_PI_2;
    Error::check_above("radius", radius, 0.0, "m")?;
    Error::check_finite("radius", radius, "m")?;
    Error::check_above("sinkage", sinkage, 0.0, "m")?;
    if !(sinkage < radius) {
        return Err(Error::HubBuried { sinkage, radius });
    }
    Error::check_range("theta", theta.rad(), -right, right, "rad")?;
    let theta_1 = entry_angle(sinkage, radius);
    let s = match mobilised {
        None | Some(Mobilised { share: 0.0, .. }) => slip_ani(theta.rad(), theta_1),
        Some(Mobilised { share, k_shear }) => {
            Error::check_range("mobilised", share, 0.0, 1.0, "1")?;
            Error::check_above("k_shear", k_shear, 0.0, "m")?;
            Error::check_finite("k_shear", k_shear, "m")?;
            let s = slip_mobilised(theta.rad(), theta_1, share, k_shear / radius)?;
            if !(s <= 1.0) {
                let max_share = -Real::exp_m1(-radius * (theta_1 - theta.rad()) / k_shear);
                return Ok(ModelOutcome::Unreachable {
                    max_share: max_share.max(0.0),
                });
            }
            s
        }
    };
    Ok(ModelOutcome::Slip(ModelSlip {
        driving_formula: s,
        slip: Slip::from_driving_formula(s)?,
        theta_1: Angle::from_rad(theta_1),
        in_contact: theta.rad().abs() <= theta_1,
    }))
}

/// S(θ, x) for x > 0, from S_0 plus −(K/r) ln(1 − x)/(sin θ_1 − sin θ).
fn slip_mobilised<R: Scalar>(theta: R, theta_1: R, share: R, k_over_r: R) -> Result<R> {
    let limits = (-core::f64::consts::FRAC_PI_2, theta_1.value());
    OutOfRange::check("theta", theta.value(), limits, "rad")?;
    let half = R::from_f64(0.5);
    let difference =
        R::from_f64(2.0) * (half * (theta_1 + theta)).cos() * (half * (theta_1 - theta)).sin();
    Ok(slip_ani(theta, theta_1) - k_over_r * (-share).ln_1p() / difference)
}
