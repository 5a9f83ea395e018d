//! The soil beside a wheel that drifts far: passive pressure on its leading side, with friction.

use grouser_real::{Real, Scalar};

use crate::contact::{Motion, WheelSize};
use crate::quadrature::{LEGENDRE_6, LEGENDRE_16, LEGENDRE_32};
use crate::shear::MohrCoulomb;
use crate::soil::SoilLaws;

/// Angle of the friction between soil and wheel over φ: the customary two thirds for steel in sand (earth-pressure tables,
/// unverified).
const WALL_FRICTION_SHARE: f64 = 2.0 / 3.0;

/// Speed over the travel speed below which the soil's friction on the side is not fully mobilised: the soil then slides
/// less than a quarter of the way that the wheel moves, about K along a chord.
const FULL_SLIDING: f64 = 0.25;

/// Greatest rim speed over the travel speed at which sixteen nodes a part give 1e-9 of the side force.
const MAX_COARSE_RIM: f64 = 1.5;

/// Weight of the soil beside the wheel below which it changes no digit of 1e-11, and up to which six nodes a part do for 1e-10.
const WEIGHTS: (f64, f64) = (1e-12, 1e-6);

/// Greatest angle of friction, rad, for which Coulomb's plane wedge exists with margin (φ + 2φ/3 < 90°).
pub(crate) const MAX_FRICTION_RAD: f64 = core::f64::consts::FRAC_PI_4;

/// sin²⁴|β|: how far the laws for a wheel that moves sideways replace those of a drifting wheel; 0.03 at 60°, 0.43 at 75°.
///
/// Source: ours. The power was chosen on trials at 60 and 90° (2 to 48 were tried); between them it is not tested.
pub(crate) fn sideways_weight<R: Real>(motion: &Motion<R>) -> R {
    let sine = motion.slip_angle.sin();
    let fourth = (sine * sine) * (sine * sine);
    let eighth = fourth * fourth;
    eighth * eighth * eighth
}

/// Coulomb's coefficient of passive earth pressure on a vertical wall under level ground, for a soil that slides up the
/// wall with the tangent `t` of the mobilised wall friction: K_p = cos²φ √(1 + t²)/(1 − √((sin φ + t cos φ) sin φ))².
///
/// Source: Coulomb 1776, as in texts on earth pressure. Valid range: the plane wedge overestimates K_p beyond
/// δ = φ/2 by up to a third at δ = 2φ/3 and φ = 30°. Sign: t > 0 where the soil rises past the wall; t = 0 is Rankine's
/// (1 + sin φ)/(1 − sin φ).
///
/// ```
/// use grouser_terra::passive_pressure_coulomb;
/// let phi = 30_f64.to_radians();
/// assert!((passive_pressure_coulomb(phi, 0.0) - 3.0).abs() < 1e-12);
/// // δ = 20°: 6.105 in tables
/// assert!((passive_pressure_coulomb(phi, 20_f64.to_radians().tan()) - 6.105).abs() < 1e-3);
/// ```
pub fn passive_pressure_coulomb<R: Scalar>(phi: R, t: R) -> R {
    let (sine, cosine) = phi.sin_cos();
    if sine.value() == 0.0 {
        return (R::ONE + t * t).sqrt();
    }
    let rest = R::ONE - ((sine + t * cosine) * sine).sqrt();
    cosine * cosine * (R::ONE + t * t).sqrt() / (rest * rest)
}

/// What the soil beside the wheel does to it, before the sign of the drift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SideDisc<R> {
    /// Force upwards, N.
    pub(crate) lift: R,
    /// Force forwards, N.
    pub(crate) pull: R,
    /// Torque that drives against it, N m.
    pub(crate) torque: R,
    /// Force against the drift, N.
    pub(crate) side: R,
    /// Work lost as in [`Forces`](crate::Forces), N m.
    pub(crate) lost: R,
}

impl<R: Scalar> SideDisc<R> {
    /// At the entry angle `theta_1` (rad); `None` without drift, and below slip angles of 19°, where it is less than rounding.
    ///
    /// Soil is pushed up in front of the leading side along a plane at X_c = π/4 − φ/2, so that it rises at
    /// |v_y| tan X_c past the disc, which itself moves and turns. The pressure at the depth h is
    /// p = 2 c √K_p (1 + 2 h e) + K_p γ h (1 + h e), with the wedges beyond the ends of the chord w (the diameter, once the
    /// hub is buried) e = cot X_c/w, and the friction p tan δ acts along the sliding u, K_p with its share that rises:
    /// t = tan δ · (rise)/√(u² + (V/4)²). All of it times |sin β| sin²⁴β.
    pub(crate) fn new(
        size: &WheelSize<R>,
        soil: &SoilLaws<R>,
        motion: &Motion<R>,
        theta_1: R,
    ) -> Option<Self> {
        if motion.q_y.value() == 0.0 || !(theta_1.value() > 0.0) {
            return None;
        }
        let scale = motion.slip_angle.sin() * sideways_weight(motion);
        if scale.value() < WEIGHTS.0 {
            return None;
        }
        let half = R::from_f64(0.5);
        let MohrCoulomb { cohesion, phi } = soil.strength;
        let radius = size.radius;
        let friction = (R::from_f64(WALL_FRICTION_SHARE) * phi).tan();
        let rise = (half * (half * R::PI - phi)).tan(); // tan X_c
        let speeds = motion.speeds();
        let up = rise * speeds.sideways;
        let slow = R::from_f64(FULL_SLIDING) * speeds.travel;
        let (sin_1, cos_1) = theta_1.sin_cos();
        let buried = cos_1.value() < 0.0;
        let chord = R::from_f64(2.0) * radius * if buried { R::ONE } else { sin_1 };
        let ends = R::ONE / (rise * chord);
        // a rim that outruns the wheel turns the sliding within a smaller part of the disc
        let rule = if scale.value() < WEIGHTS.1 {
            LEGENDRE_6.view()
        } else if speeds.rim.value() <= MAX_COARSE_RIM * speeds.travel.value() {
            LEGENDRE_16.view()
        } else {
            LEGENDRE_32.view()
        };
        let mut sum = Self::zero();
        // rows at the angle a from the lowest point, cut where the disc does not slide forwards or upwards
        for (from, to) in parts(R::ZERO, theta_1, still_row(speeds.forward, speeds.rim)) {
            for (x, weight) in rule.iter() {
                let a = from + R::from_f64(x) * (to - from);
                let (sin_a, cos_a) = a.sin_cos();
                let depth = radius * (cos_a - cos_1);
                let area = R::from_f64(weight) * (to - from) * radius * sin_a * radius;
                let forward = speeds.forward - speeds.rim * cos_a;
                let cut = still_place(up, speeds.rim);
                for (left, right) in parts(-sin_a, sin_a, Some(cut)) {
                    for (y, weight) in rule.iter() {
                        let x = left + R::from_f64(y) * (right - left); // over the radius, forwards
                        let turning = -(speeds.rim * x);
                        let upward = turning - up;
                        let sliding = (forward * forward + upward * upward + slow * slow).sqrt();
                        let drag = friction / sliding;
                        let k_p = passive_pressure_coulomb(phi, -(drag * upward));
                        let by_cohesion = R::from_f64(2.0)
                            * cohesion
                            * k_p.sqrt()
                            * (R::ONE + R::from_f64(2.0) * depth * ends);
                        let by_weight = k_p * soil.unit_weight * depth * (R::ONE + depth * ends);
                        let force =
                            (by_cohesion + by_weight) * area * R::from_f64(weight) * (right - left);
                        let (pull, lift) = (-(force * drag * forward), -(force * drag * upward));
                        sum.lift += lift;
                        sum.pull += pull;
                        sum.torque += radius * (pull * cos_a + lift * x);
                        sum.side += force;
                        sum.lost +=
                            radius * (force * speeds.sideways - pull * forward - lift * turning);
                    }
                }
            }
        }
        Some(Self {
            lift: scale * sum.lift,
            pull: scale * sum.pull,
            torque: scale * sum.torque,
            side: scale * sum.side,
            lost: scale * sum.lost,
        })
    }

    fn zero() -> Self {
        Self {
            lift: R::ZERO,
            pull: R::ZERO,
            torque: R::ZERO,
            side: R::ZERO,
            lost: R::ZERO,
        }
    }
}

/// The angle from the lowest point at which the disc does not slide forwards, rad.
fn still_row<R: Scalar>(forward: R, rim: R) -> Option<f64> {
    let ratio = forward.value() / rim.value();
    (ratio < 1.0).then(|| Real::acos(ratio))
}

/// Where along a row the disc does not slide upwards, over the radius, forwards.
fn still_place<R: Scalar>(up: R, rim: R) -> f64 {
    -up.value() / rim.value()
}

/// [from, to], cut at `at` where that lies inside; the second part is empty where it does not.
fn parts<R: Scalar>(from: R, to: R, at: Option<f64>) -> impl Iterator<Item = (R, R)> {
    let cut = at.filter(|at| *at > from.value() && *at < to.value());
    let middle = cut.map_or(to, R::from_f64);
    [(from, middle), (middle, to)]
        .into_iter()
        .take(if cut.is_some() { 2 } else { 1 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Contact;
    use crate::{Angle, Bulldozing, Kinematics, Soil, SoilParams};

    /// By nested Gauss-Legendre quadrature over the angle of the depth and the forward place (mpmath with 34 digits, split
    /// where nothing slides and at nine more places; 18 and 26 nodes a part agree to 17 digits). r, z (m), φ (deg), c (Pa),
    /// γ (N/m³), slip angle (deg), rim over travel speed; lift, pull (N), torque (N m), side force (N).
    const CASES: [([f64; 7], [f64; 4]); 6] = [
        (
            [0.058, 0.035, 29.0, 220.0, 13e3, 60.0, 1.3],
            [
                0.034_271_778_291_967_3,
                0.031_373_607_290_810_77,
                0.002_070_182_728_483_671,
                0.170_624_657_597_703_43,
            ],
        ),
        (
            [0.058, 0.07, 29.0, 350.0, 13e3, 90.0, 4.0],
            [
                3.385_142_731_147_735,
                6.576_775_633_656_893,
                0.423_477_801_768_131_6,
                30.606_605_439_653_233,
            ],
        ),
        (
            [0.058, 0.062, 29.0, 350.0, 13e3, 85.0, 0.0],
            [
                9.390_865_617_217_145,
                -1.394_790_311_943_321_6,
                -0.042_792_099_658_015_27,
                29.364_426_010_065_753,
            ],
        ),
        (
            [0.058, 0.075, 29.0, 350.0, 13e3, 88.0, 9.0],
            [
                3.037_232_420_390_598,
                6.885_854_484_792_135,
                0.474_315_105_390_988_5,
                33.987_817_879_411_914,
            ],
        ),
        (
            [0.1, 0.09, 38.0, 0.0, 15e3, 75.0, 0.5],
            [
                21.720_025_080_784_108,
                3.345_467_900_411_94,
                0.600_731_608_909_984_1,
                55.335_755_365_823_395,
            ],
        ),
        (
            [0.157, 0.2, 20.0, 1000.0, 9e3, 80.0, 2.0],
            [
                30.008_850_909_201_954,
                31.001_401_738_936_707,
                6.554_561_393_100_064,
                294.697_601_253_491_2,
            ],
        ),
    ];

    /// The soil of a case: friction angle (°), cohesion (Pa) and unit weight (N/m³).
    fn soil_of(phi: f64, c: f64, gamma: f64) -> Soil {
        Soil::new(SoilParams {
            unit_weight: Some(gamma),
            ..Soil::bekker(0.0, 8e6, 1.3)
                .cohesion(c)
                .phi(Angle::from_deg(phi))
                .k_shear(0.02)
                .stress_position(0.3, 0.3)
                .params()
                .unwrap()
        })
        .unwrap()
    }

    #[test]
    fn the_quadrature_finds_the_same() {
        for ([r, z, phi, c, gamma, beta, rim], expected) in CASES {
            let soil = soil_of(phi, c, gamma);
            let forward = if beta == 90.0 {
                0.0
            } else {
                beta.to_radians().cos()
            };
            let motion = Kinematics::from_speeds(forward, beta.to_radians().sin(), rim).unwrap();
            let theta_1 = (1.0 - z / r).acos();
            let size = WheelSize::smooth(r, 0.05);
            let found = SideDisc::new(&size, &soil.laws(), &motion.motion(), theta_1).unwrap();
            let got = [found.lift, found.pull, found.torque, found.side];
            for (got, expected) in got.into_iter().zip(expected) {
                let off = (got - expected).abs() / found.side;
                assert!(off < 1e-9, "{beta}° {rim}: {got} {expected} {off:e}");
            }
        }
    }

    /// At small slip angles against sums over small squares: off by less than 1e-10 of what the disc would give with full weight.
    #[test]
    fn a_small_weight_needs_few_nodes() {
        const ROWS: u32 = 400;
        let mut worst = 0.0_f64;
        for beta in [20.0_f64, 25.0, 30.0, 34.0] {
            for rim in [0.3, 0.95, 1.05, 1.4, 3.0] {
                let (r, z, phi, gamma) = (0.1, 0.04, 32.0_f64, 15e3);
                let (sine, cosine) = beta.to_radians().sin_cos();
                let motion = Kinematics::from_speeds(cosine, sine, rim).unwrap();
                let theta_1 = (1.0_f64 - z / r).acos();
                let soil = soil_of(phi, 300.0, gamma);
                let size = WheelSize::smooth(r, 0.05);
                let found = SideDisc::new(&size, &soil.laws(), &motion.motion(), theta_1).unwrap();
                let phi = phi.to_radians();
                let rise = (0.5 * (0.5 * core::f64::consts::PI - phi)).tan();
                let (friction, up) = ((2.0 / 3.0 * phi).tan(), rise * sine);
                let ends = 1.0 / (rise * 2.0 * r * theta_1.sin());
                let mut lift = 0.0;
                for i in 0..ROWS {
                    let a = (f64::from(i) + 0.5) / f64::from(ROWS) * theta_1;
                    let depth = r * (a.cos() - theta_1.cos());
                    let forward = cosine - rim * a.cos();
                    for k in 0..ROWS {
                        let x = ((f64::from(k) + 0.5) / f64::from(ROWS) * 2.0 - 1.0) * a.sin();
                        let upward = -rim * x - up;
                        let sliding = (forward * forward + upward * upward + 0.0625).sqrt();
                        let drag = friction / sliding;
                        let k_p = passive_pressure_coulomb(phi, -drag * upward);
                        let pressure = 600.0 * k_p.sqrt() * (1.0 + 2.0 * depth * ends)
                            + k_p * gamma * depth * (1.0 + depth * ends);
                        let area =
                            theta_1 * r * a.sin() * r * 2.0 * a.sin() / f64::from(ROWS * ROWS);
                        lift -= pressure * area * drag * upward;
                    }
                }
                let weight = sine * sideways_weight(&motion.motion::<f64>());
                worst = worst.max((found.lift - weight * lift).abs() / (found.side / weight));
            }
        }
        assert!(worst < 1e-10, "{worst:e}");
    }

    /// What the disc adds to the forces of the rim.
    #[test]
    fn forces_of_rim_and_disc_add_up() {
        for ([r, z, phi, c, gamma, beta, rim], [lift, pull, torque, side]) in CASES {
            let mut laws = soil_of(phi, c, gamma).laws();
            let beta = beta.to_radians();
            let motion = Kinematics::from_speeds(beta.cos().max(1e-17), beta.sin(), rim).unwrap();
            let size = WheelSize::smooth(r, 0.05);
            let mut forces = |bulldozing| {
                laws.choice.bulldozing = Some(bulldozing);
                let law = crate::ShearLaw::Independent;
                let theta_1 = (1.0 - z / r).acos();
                Contact::new(&size, &laws, law, &motion.motion(), theta_1).forces()
            };
            let (with, without) = (forces(Bulldozing::Disc), forces(Bulldozing::Off));
            for (both, rim, disc) in [
                (with.vertical_force, without.vertical_force, lift),
                (with.drawbar_pull, without.drawbar_pull, pull),
                (with.thrust, without.thrust, pull),
                (with.torque, without.torque, torque),
            ] {
                let off = both - rim - disc;
                assert!(
                    off.abs() < 1e-8 * side + 1e-12 * rim.abs(),
                    "{off} {both} {rim} {disc}"
                );
            }
            assert_eq!(with.side_shear, without.side_shear);
            let scale = with.torque.abs() + with.drawbar_pull.abs() * r;
            assert!((with.energy_residual).abs() < 1e-10 * scale);
            // sliding soil takes work, and no more than the side and the rim do together
            let lost = with.lost_work - without.lost_work;
            let moved = motion.motion::<f64>().speeds();
            let work = torque * moved.rim - pull * r * moved.forward + side * r * moved.sideways;
            assert!((lost - work).abs() < 1e-8 * work, "{lost} {work}");
        }
    }

    /// forward = rim cos a, and rim x = −up.
    #[test]
    fn rows_are_cut_where_nothing_slides() {
        assert_eq!(still_row(0.3, 1.2), Some(f64::acos(0.25)));
        assert_eq!(still_row(-0.3, 1.2), Some(f64::acos(-0.25)));
        assert_eq!((still_row(1.0, 1.0), still_row(1.3, 1.2)), (None, None));
        assert_eq!(still_place(0.3, 1.2), -0.25);
        let of = |at: Option<f64>| parts(-0.5, 0.75, at).collect::<std::vec::Vec<_>>();
        assert_eq!(of(Some(0.25)), [(-0.5, 0.25), (0.25, 0.75)]);
        assert_eq!(of(Some(-0.25)), [(-0.5, -0.25), (-0.25, 0.75)]);
        for at in [None, Some(-0.6), Some(0.8), Some(f64::NAN)] {
            assert_eq!(of(at), [(-0.5, 0.75)]);
        }
    }

    #[test]
    fn without_drift_or_depth_there_is_no_disc() {
        let soil = Soil::bekker(0.0, 8e6, 1.3)
            .cohesion(200.0)
            .phi(Angle::from_deg(30.0))
            .k_shear(0.02)
            .stress_position(0.3, 0.3)
            .soil()
            .unwrap();
        let size = WheelSize::smooth(0.1, 0.05);
        let of = |v_y, theta_1| {
            let motion = Kinematics::from_speeds(0.5, v_y, 1.0).unwrap();
            SideDisc::new(&size, &soil.laws(), &motion.motion(), theta_1).is_some()
        };
        assert!(of(0.5, 0.4) && !of(0.0, 0.4) && !of(0.5, 0.0));
    }
}
