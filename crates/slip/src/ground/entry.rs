//! Sinkage and entry angle, each from the other as it was measured.

use grouser_real::{Dual, Real};
use grouser_terra::{entry_angle, sinkage_from_entry_angle};

use crate::fault::Fault;

/// A number with the standard deviation of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertain {
    /// The value.
    pub value: f64,
    /// Standard deviation of its error, in the value's unit.
    pub sigma: f64,
}

impl Uncertain {
    /// Checks that the value lies in [low, high] and that the sigma is finite and not negative.
    pub(crate) fn check(
        self,
        field: &'static str,
        sigma_field: &'static str,
        (low, high): (f64, f64),
        unit: &'static str,
    ) -> Result<(), Fault> {
        Fault::check_range(field, self.value, low, high, unit)?;
        Fault::check_range(sigma_field, self.sigma, 0.0, f64::MAX, unit)
    }

    fn through(self, f: impl Fn(Dual<2>, Dual<2>) -> Dual<2>, radius: Self) -> Self {
        let result = f(
            Dual::variable(self.value, 0),
            Dual::variable(radius.value, 1),
        );
        let [by_value, by_radius] = result.gradient;
        Self {
            value: result.value,
            sigma: Real::hypot(by_value * self.sigma, by_radius * radius.sigma),
        }
    }
}

/// Sinkage (m) under a wheel whose entry angle (rad) a camera measures: z = r (1 − cos θ_1).
///
/// Source: \[Ani2012\], section 5. Valid range: 0 ≤ θ_1 < π/2. Sign: as [`grouser_terra::entry_angle`].
/// Assumes: the errors of angle and radius are independent and small.
///
/// # Errors
/// [`Fault::OutOfRange`] or [`Fault::NotFinite`], by field.
///
/// ```
/// use grouser_slip::ground::{Uncertain, sinkage_from_camera};
/// let angle = Uncertain { value: 0.5, sigma: 0.02 }; // rad
/// let radius = Uncertain { value: 0.1, sigma: 0.0 }; // m
/// let z = sinkage_from_camera(angle, radius)?;
/// assert!((z.value - 0.1 * (1.0 - 0.5_f64.cos())).abs() < 1e-16);
/// assert!((z.sigma - 0.1 * 0.5_f64.sin() * 0.02).abs() < 1e-15);
/// # Ok::<(), grouser_slip::Fault>(())
/// ```
pub fn sinkage_from_camera(angle: Uncertain, radius: Uncertain) -> Result<Uncertain, Fault> {
    angle.check(
        "entry angle",
        "sigma of the entry angle",
        (0.0, core::f64::consts::FRAC_PI_2),
        "rad",
    )?;
    radius.check("radius", "sigma of the radius", (1e-3, 10.0), "m")?;
    Ok(angle.through(sinkage_from_entry_angle, radius))
}

/// Entry angle (rad) of a wheel whose sinkage (m) a displacement sensor measures:
/// θ_1 = 2 arcsin √(z/2r), with σ_θ = σ_z/(r sin θ_1).
///
/// Near z = 0 the angle hangs on the root of z: below z = σ_z its sigma is that of z = σ_z, for which
/// the first derivative still means something.
///
/// Source: \[Ani2012\], section 5 and (P18). Valid range: 0 ≤ z < r.
///
/// # Errors
/// [`Fault::OutOfRange`] or [`Fault::NotFinite`], by field; the radius is the sinkage's limit.
///
/// ```
/// use grouser_slip::ground::{Uncertain, entry_angle_from_sinkage};
/// let radius = Uncertain { value: 0.1, sigma: 0.0 };
/// let angle = entry_angle_from_sinkage(Uncertain { value: 0.01, sigma: 0.001 }, radius)?;
/// assert!((angle.value - 0.451_026_8).abs() < 1e-7);
/// assert!((angle.sigma - 0.001 / (0.1 * angle.value.sin())).abs() < 1e-12);
/// # Ok::<(), grouser_slip::Fault>(())
/// ```
pub fn entry_angle_from_sinkage(sinkage: Uncertain, radius: Uncertain) -> Result<Uncertain, Fault> {
    radius.check("radius", "sigma of the radius", (1e-3, 10.0), "m")?;
    sinkage.check("sinkage", "sigma of the sinkage", (0.0, radius.value), "m")?;
    let value = entry_angle(sinkage.value, radius.value);
    let steady = Uncertain {
        value: sinkage
            .value
            .max(sinkage.sigma.min(0.5 * radius.value))
            .max(1e-12 * radius.value),
        ..sinkage
    };
    Ok(Uncertain {
        value,
        sigma: steady.through(entry_angle, radius).sigma,
    })
}
