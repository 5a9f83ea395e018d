//! How well a soil is known, and what that does to a slip.

use alloc::vec;
use alloc::vec::Vec;

use grouser_real::Real;
use grouser_terra::{Angle, Result, RigidWheel, Settings, Soil, SoilParams, WheelOnSoil};

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
type Neighbours = [[Option<Soil>; 2]; 5];

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
    fn neighbours(&self, soil: &Soil) -> Neighbours {
        let p = *soil.params();
        let vary = |share: f64, with: fn(SoilParams, f64) -> SoilParams| {
            [1.0 + share, 1.0 - share].map(|factor| Soil::new(with(p, factor)).ok())
        };
        [
            vary(self.moduli, |p, f| SoilParams {
                pressure: p.pressure.scaled(f),
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

/// A wheel on a soil and on its neighbours; `None` where the laws refuse one.
pub(super) struct Family {
    own: WheelOnSoil,
    neighbours: Vec<Option<WheelOnSoil>>,
}

/// What is known of the family at the place before.
pub(super) struct Traced {
    /// Each member's slip there, and whether it has none from there on.
    slips: Vec<Option<f64>>,
    ended: Vec<bool>,
    /// The soil's own slips at the last two places.
    before: [Option<f64>; 2],
}

impl Family {
    pub(super) fn new(wheel: RigidWheel, soil: &Soil, doubt: &SoilDoubt) -> Result<Self> {
        // a wheel that spins on the spot has a slip too: the filter's prior covers every slip
        let settings = Settings {
            max_slip: 1.0,
            ..Settings::default()
        };
        let on = |soil| WheelOnSoil::new(wheel, soil, settings);
        let neighbours = doubt.neighbours(soil).into_iter().flatten();
        Ok(Self {
            own: on(*soil)?,
            neighbours: neighbours
                .map(|soil| soil.and_then(|soil| on(soil).ok()))
                .collect(),
        })
    }

    /// The soil itself.
    pub(super) const fn own(&self) -> &WheelOnSoil {
        &self.own
    }

    /// Nothing is traced yet; the soil's own slip at the first place is known, if it has one.
    pub(super) fn traced(&self, first: Option<f64>) -> Traced {
        Traced {
            slips: vec![None; self.neighbours.len() + 1],
            ended: vec![false; self.neighbours.len() + 1],
            before: [first, None],
        }
    }

    /// The slip that `of` gives on the soil, with the doubt in it; `None` where the soil itself gives none. A neighbour
    /// that gives none adds half of what lies between the slip and `end`. `of` receives a slip that is nearly right,
    /// where one is known: that of the place before, moved by what the soil's own slip has moved.
    ///
    /// Where `ends` is set, a member without a slip is left out of the places that follow, since they demand more.
    pub(super) fn spread(
        &self,
        traced: &mut Traced,
        (end, ends): (f64, bool),
        of: impl Fn(&WheelOnSoil, Option<f64>) -> Option<f64>,
    ) -> Option<SlipPrior> {
        let near = match traced.before {
            [Some(last), Some(before)] => Some((2.0 * last - before).clamp(-1.0, 1.0)),
            [last, _] => last,
        };
        let known: Vec<Option<f64>> = traced.slips.clone();
        let Traced { slips, ended, .. } = traced;
        let mut slip = |member: usize, near: Option<f64>| {
            if ended[member] {
                return None;
            }
            let found = match member {
                0 => Some(&self.own),
                _ => self.neighbours[member - 1].as_ref(),
            };
            let found = found.and_then(|pair| of(pair, near));
            slips[member] = found;
            ended[member] = ends && found.is_none();
            found
        };
        let mean = slip(0, near)?;
        let moved = known[0].map(|last| mean - last);
        let mut variance = 0.0;
        for pair in 0..self.neighbours.len() / 2 {
            let off = [2 * pair + 1, 2 * pair + 2].map(|member| {
                let traced = known[member].zip(moved).map(|(last, moved)| last + moved);
                let near = traced.map_or(mean, |near| near.clamp(-1.0, 1.0));
                slip(member, Some(near)).map_or(0.5 * (end - mean), |slip| slip - mean)
            });
            variance += 0.5 * (off[0] * off[0] + off[1] * off[1]);
        }
        traced.before = [Some(mean), traced.before[0]];
        Some(SlipPrior {
            mean,
            sigma: Real::sqrt(variance).max(1e-4),
        })
    }
}
