//! How well a soil is known, and what that does to a slip.

use grouser_real::Real;
use grouser_terra::{Angle, Bekker, Pressure, Reece, Soil, SoilParams};

use crate::filter::SlipPrior;

/// How well a soil's parameters are known, as shares of them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SoilDoubt {
    /// Of the pressure-sinkage moduli, together.
    pub moduli: f64,
    /// Of the exponent n.
    pub exponent: f64,
    /// Of the cohesion.
    pub cohesion: f64,
    /// Of tan φ.
    pub friction: f64,
    /// Of the shear modulus K.
    pub k_shear: f64,
}

impl Default for SoilDoubt {
    /// A soil of the catalogue for a ground of its name: 30 % in the moduli, the cohesion and K, 15 % in tan φ, 10 % in n.
    fn default() -> Self {
        Self {
            moduli: 0.3,
            exponent: 0.1,
            cohesion: 0.3,
            friction: 0.15,
            k_shear: 0.3,
        }
    }
}

/// A soil with each parameter greater and smaller by its doubt.
pub(super) type Neighbours = [[Option<Soil>; 2]; 5];

impl SoilDoubt {
    /// The same share for all of them but n.
    ///
    /// ```
    /// use grouser_slip::prior::SoilDoubt;
    ///
    /// assert_eq!(SoilDoubt::of(0.2).cohesion, 0.2);
    /// ```
    #[must_use]
    pub const fn of(share: f64) -> Self {
        Self {
            moduli: share,
            exponent: 0.0,
            cohesion: share,
            friction: share,
            k_shear: share,
        }
    }

    /// `soil` with each parameter in turn greater and smaller by its doubt; what leaves the laws' ranges is left out.
    pub(super) fn neighbours(&self, soil: &Soil) -> Neighbours {
        let p = *soil.params();
        let vary = |share: f64, with: fn(SoilParams, f64) -> SoilParams| {
            [1.0 + share, 1.0 - share].map(|factor| Soil::new(with(p, factor)).ok())
        };
        [
            vary(self.moduli, |p, f| SoilParams {
                pressure: match p.pressure {
                    Pressure::Bekker(law) => Pressure::Bekker(Bekker {
                        k_c: f * law.k_c,
                        k_phi: f * law.k_phi,
                    }),
                    Pressure::Reece(law) => Pressure::Reece(Reece {
                        k_c_prime: f * law.k_c_prime,
                        k_phi_prime: f * law.k_phi_prime,
                    }),
                    other => other,
                },
                ..p
            }),
            vary(self.exponent, |p, f| SoilParams { n: f * p.n, ..p }),
            vary(self.cohesion, |p, f| SoilParams {
                cohesion: f * p.cohesion,
                ..p
            }),
            vary(self.friction, |p, f| SoilParams {
                phi: Angle::from_rad(Real::atan(f * Real::tan(p.phi.rad()))),
                ..p
            }),
            vary(self.k_shear, |p, f| SoilParams {
                k_shear: f * p.k_shear,
                ..p
            }),
        ]
    }
}

/// The slip that `of` gives on `soil`, with the doubt in it; `None` where the soil itself gives none. A neighbour that
/// gives none adds half of what lies between the slip and `end`. `of` receives a slip that is nearly right, where one is
/// known: `near`, and for the neighbours the soil's own.
pub(super) fn spread(
    (soil, neighbours): (&Soil, &Neighbours),
    (end, near): (f64, Option<f64>),
    of: impl Fn(&Soil, Option<f64>) -> Option<f64>,
) -> Option<SlipPrior> {
    let mean = of(soil, near)?;
    let mut variance = 0.0;
    for pair in neighbours {
        let off = pair.each_ref().map(|soil| {
            let slip = soil.as_ref().and_then(|soil| of(soil, Some(mean)));
            slip.map_or(0.5 * (end - mean), |slip| slip - mean)
        });
        variance += 0.5 * (off[0] * off[0] + off[1] * off[1]);
    }
    Some(SlipPrior {
        mean,
        sigma: Real::sqrt(variance).max(1e-4),
    })
}
