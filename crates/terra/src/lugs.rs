//! Lugs (grousers) across the rim of a wheel: what they add to sinkage, thrust and vibration.

use core::f64::consts::TAU;

use grouser_real::{Real, ResultField};

use crate::operating_point::OperatingPoint;
use crate::wheel::{GrouserRule, RigidWheel};
use crate::wheel_on_soil::WheelOnSoil;

/// Positions of the lugs, over one spacing, at which their forces are summed up: enough for the difference of
/// the extremes to 1 % (the sum is smooth but for lugs that enter and leave).
const PASSAGE_STEPS: u32 = 40;

/// Thickness δ of the layer of soil that lugs carry backwards, m: δ = h/2 (1 − N t/(2π r)).
///
/// Half the height of the lugs, less the share of the circumference that the lugs themselves take. A driving
/// wheel sinks deeper by δ (rω − v)/V ([`transport_depth_reece`](crate::transport_depth_reece)); a braking wheel
/// carries nothing. `height` h, `thickness` t and `radius` r of the rim in m, `count` N.
///
/// Source: after Reece's h s/(1 − s) (as restated in later texts, unverified). The factor ½ was chosen on the
/// sinkage of two lugged wheels: 24 lugs of 5 mm on r 58 mm, and 30 of 10 mm on r 157 mm.
/// Valid range: dry sand, h up to r/10, gaps between the lugs of one to four heights. Assumes: the gaps are full
/// of soil.
///
/// ```
/// use grouser_terra::lug_transport_layer;
/// let layer = lug_transport_layer(0.005_f64, 24.0, 0.0015, 0.058);
/// assert!((layer - 0.0025 * (1.0 - 0.036 / (std::f64::consts::TAU * 0.058))).abs() < 1e-15);
/// ```
pub fn lug_transport_layer<R: Real>(height: R, count: R, thickness: R, radius: R) -> R {
    let taken = count * thickness / (R::from_f64(TAU) * radius);
    R::from_f64(0.5) * height * (R::ONE - taken)
}

/// How much lugs add to the shear displacement where the wheel drives, per unit: j becomes (1 + a ρ) j, with
/// ρ = N h/(2π r), the area of the lugs' faces over the area of the rim, and a = 1.75.
///
/// Lugs do not multiply the strength of soil, they mobilise it sooner: straight ahead K is K/(1 + a ρ). Beside a drift
/// the slip speed along the wheel grows as the displacement does, so that shear turns into the wheel's plane. Where
/// soil is dragged forwards (j ≤ 0) lugs change nothing. `height` h and `radius` r of the rim in m, `count` N.
///
/// Source: ours; that faces of grousers shear soil in addition to the area between them is Bekker's for tracks
/// (\[Bekker69\]; for wheels unverified). The form was chosen on lugged wheels of three laboratories (24 lugs of 5 mm
/// on r 58 mm at slip angles 0 and 30°, 30 of 10 mm on r 157 mm, 24 of 25 mm on r 250 mm) against more thrust, a
/// larger radius of the lugs' tips and soil heaped up behind the wheel. a is the one number: the mean error of pull over
/// load is flat between 1.5 and 2.25; chosen on two of the laboratories it is 1.5, 2 and 2.5 (`docs/validate.md`). Valid range: dry sand, h up to
/// r/10, gaps between the lugs of one to four heights; beyond s = 0.75 measured pull still rises where this does not.
///
/// ```
/// use grouser_terra::lug_mobilisation;
/// assert!((lug_mobilisation(0.005_f64, 24.0, 0.058) - 0.576251).abs() < 1e-6);
/// ```
pub fn lug_mobilisation<R: Real>(height: R, count: R, radius: R) -> R {
    R::from_f64(1.75) * count * height / (R::from_f64(TAU) * radius)
}

/// The greatest angle between two lugs, rad, with which a lug enters the soil before the bare rim behind the
/// last one does: 1/(1 − s) [√((1 + h/r)² − (1 − z/r)²) − √(1 − (1 − z/r)²)].
///
/// The tip of a lug meets the ground √((r + h)² − (r − z)²) ahead of the axle, the rim √(r² − (r − z)²); from lug
/// to lug the wheel travels r (1 − s) times the angle between them. With wider spacing the rim pushes soil
/// forwards between the lugs, and pull is lost. All lengths in m; infinite at `slip` 1.
///
/// Source: Skonieczny, Moreland & Wettergreen 2012 (from memory; the derivation above is complete). Valid range:
/// 0 ≤ s ≤ 1, z < r.
///
/// ```
/// use grouser_terra::lug_spacing_skonieczny;
/// let spacing = lug_spacing_skonieczny(0.058, 0.005, 0.015, 0.2).to_degrees();
/// assert!((spacing - 8.793).abs() < 1e-3); // 24 lugs are 15° apart: too few at this slip
/// ```
#[must_use]
pub fn lug_spacing_skonieczny(radius: f64, height: f64, sinkage: f64, slip: f64) -> f64 {
    let hub = 1.0 - sinkage / radius;
    let tip = 1.0 + height / radius;
    let reach = |x: f64| Real::sqrt((x * x - hub * hub).max(0.0));
    (reach(tip) - reach(1.0)) / (1.0 - slip).max(0.0)
}

/// What the passage of lugs does to the forces of a wheel: greatest less least over one spacing.
///
/// Thrust that the law spreads over the rim acts in part on the faces of those lugs that are in the soil: by their
/// share ρ/(1 + ρ) of the area, h b τ(θ_k)/(1 + ρ) on the k-th. Its mean over a passage is the same; its fluctuation
/// is this.
///
/// Source: ours; that pull fluctuates with the passage of lugs was measured and modelled by Irani, Bauer &
/// Warkentin, J. Terramechanics 48 (2011), whose coefficients are not used (the paper was not seen).
/// Assumes: the wheel's speed and sinkage do not follow the fluctuation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LugPassage {
    /// Angle between two lugs, rad: the fluctuation repeats with it.
    pub spacing: f64,
    /// Of the drawbar pull, N.
    pub pull: f64,
    /// Of the torque, N m.
    pub torque: f64,
    /// How many lugs are in the soil on average.
    pub in_soil: f64,
}

type Own = ResultField<LugPassage>;

/// A further quantity does not build: it needs a row in the list below, or is none of the interfaces'.
const _: fn(LugPassage) = |LugPassage {
                               spacing: _,
                               pull: _,
                               torque: _,
                               in_soil: _,
                           }| ();

impl LugPassage {
    /// Its fields in all interfaces.
    pub const FIELDS: &'static [Own] = &[
        Own::number("grouser_spacing_deg", "angle between two lugs", |lugs| {
            lugs.spacing.to_degrees()
        })
        .shown("deg"),
        Own::number("grousers_in_soil", "lugs in the soil on average", |lugs| {
            lugs.in_soil
        })
        .shown(""),
        Own::number(
            "pull_fluctuation_n",
            "fluctuation of the pull as lugs pass (peak to peak)",
            |lugs| lugs.pull,
        )
        .shown("N"),
        Own::number(
            "torque_fluctuation_nm",
            "fluctuation of the torque as lugs pass (peak to peak)",
            |lugs| lugs.torque,
        )
        .shown("N m"),
    ];
}

impl RigidWheel {
    /// Are the lugs higher than a tenth of the radius?
    pub(crate) fn lugs_are_high(&self) -> bool {
        self.lugs()
            .is_some_and(|(_, height)| height > 0.1 * self.radius())
    }

    /// Number and height (m) of the lugs, if the wheel has lugs whose passage counts.
    fn lugs(&self) -> Option<(f64, f64)> {
        let grousers = self.grousers()?;
        match grousers.rule {
            GrouserRule::Tips | GrouserRule::AreaShare { .. } => None,
            GrouserRule::Lugs { count, .. } => {
                (grousers.height > 0.0).then_some((count, grousers.height))
            }
        }
    }
}

impl WheelOnSoil {
    /// Are the lugs of a driving wheel further apart than [`lug_spacing_skonieczny`]? Never without lugs.
    pub(crate) fn lugs_are_sparse(&self, sinkage: f64, slip: f64) -> bool {
        let Some((count, height)) = self.wheel().lugs() else {
            return false;
        };
        slip >= 0.0
            && TAU / count > lug_spacing_skonieczny(self.wheel().radius(), height, sinkage, slip)
    }

    /// The fluctuation of pull and torque at a solved point of this wheel; `None` for a wheel without
    /// [`GrouserRule::Lugs`].
    ///
    /// ```
    /// use grouser_terra::{GrouserRule, Grousers, Kinematics, RigidWheel, Settings, Slip, WheelOnSoil, catalogue};
    /// let rule = GrouserRule::Lugs { count: 24.0, thickness: 0.0015 };
    /// let wheel = RigidWheel::new(0.1, 0.05)?.with_grousers(Grousers { height: 0.005, rule })?;
    /// let sand = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
    /// let on_sand = WheelOnSoil::new(wheel, sand, Settings::default())?;
    /// let motion = Kinematics::straight(Slip::new(0.3)?);
    /// let point = on_sand.under_load(30.0, &motion)?.point().expect("30 N are carried");
    /// let passage = on_sand.lug_passage(&point).expect("the wheel has lugs");
    /// assert!(passage.pull > 0.0 && passage.pull < point.forces.thrust);
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    #[must_use]
    pub fn lug_passage(&self, point: &OperatingPoint) -> Option<LugPassage> {
        let (count, height) = self.wheel().lugs()?;
        let contact = &point.contact;
        let angles = contact.angles();
        let spacing = TAU / count;
        let radius = self.size().radius;
        let area_ratio = count * height / (TAU * radius);
        let face = height * self.wheel().width() / (1.0 + area_ratio);
        let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for step in 0..PASSAGE_STEPS {
            let phase = spacing * f64::from(step) / f64::from(PASSAGE_STEPS);
            let (mut pull, mut torque) = (0.0, 0.0);
            let mut theta = angles.theta_1 - phase;
            while theta > angles.theta_2 {
                let force = face * contact.shear_stress(theta).0.max(0.0);
                pull += force * Real::cos(theta);
                torque += force * radius;
                theta -= spacing;
            }
            for (k, x) in [pull, torque].into_iter().enumerate() {
                least[k] = least[k].min(x);
                most[k] = most[k].max(x);
            }
        }
        Some(LugPassage {
            spacing,
            pull: most[0] - least[0],
            torque: most[1] - least[1],
            in_soil: (angles.theta_1 - angles.theta_2) / spacing,
        })
    }
}
