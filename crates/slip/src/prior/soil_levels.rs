//! A soil at several strengths and stiffnesses: what a robot that learns its soil chooses between.

use grouser_real::Real;
use grouser_terra::{Angle, Result, Soil, SoilParams};

/// Cohesion and tan φ as multiples of the known soil's. The catalogue's tan φ lie between 0.23 and 0.76, dry sand's is 0.58.
pub const STRENGTHS: [f64; 4] = [0.45, 0.7, 1.0, 1.4];
/// Pressure-sinkage moduli as multiples of the known soil's. At 2 cm, snow of the catalogue has 0.02 of the pressure of dry
/// sand, sandy loam 4 times as much.
pub const STIFFNESSES: [f64; 4] = [0.05, 0.25, 1.0, 4.0];

/// The soil at another strength and stiffness, as multiples of its own.
///
/// Equation: cohesion ρ c, tan φ' = ρ tan φ, pressure-sinkage moduli κ k; n, K, c_1, c_2 and the laws are the soil's own.
///
/// ```
/// use grouser_slip::prior::scaled_soil;
/// use grouser_terra::catalogue;
///
/// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let weak = scaled_soil(&sand, 0.5, 1.0)?;
/// let ratio = weak.params().phi.rad().tan() / sand.params().phi.rad().tan();
/// assert!((ratio - 0.5).abs() < 1e-12);
/// # Ok::<(), grouser_terra::Error>(())
/// ```
///
/// # Errors
/// What [`Soil::new`] refuses.
pub fn scaled_soil(soil: &Soil, strength: f64, stiffness: f64) -> Result<Soil> {
    let p = *soil.params();
    Soil::new(SoilParams {
        cohesion: strength * p.cohesion,
        phi: Angle::from_rad(Real::atan(strength * Real::tan(p.phi.rad()))),
        pressure: p.pressure.scaled(stiffness),
        ..p
    })
}
