//! What must hold for every wheel on every soil.

use grouser_terra::{
    Accuracy, Angle, Caution, Forces, Kinematics, RigidWheel, Settings, ShearLaw, Slip, Soil,
    SoilParams, WheelOnSoil,
};
use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::TestRunner;

#[derive(Clone, Debug)]
struct Any {
    radius: f64,
    width: f64,
    z_over_r: f64,
    slip: f64,
    soil: SoilParams,
}

fn any_wheel() -> impl Strategy<Value = Any> {
    let soil = (
        (0.0..50e3_f64, 5e4..3e6_f64, 0.1..2.5_f64),
        (
            prop_oneof![Just(0.0), 0.0..2e4_f64],
            1.0..45.0_f64,
            -4.0..-1.0_f64,
        ),
        (
            0.0..0.5_f64,
            0.0..0.5_f64,
            prop_oneof![Just(0.0), 0.0..1.0_f64],
        ),
    )
        .prop_map(
            |((k_c, k_phi, n), (cohesion, phi, log_k), (c_1, c_2, rebound))| SoilParams {
                rebound,
                ..Soil::bekker(k_c, k_phi, n)
                    .cohesion(cohesion)
                    .phi(Angle::from_deg(phi))
                    .k_shear(10_f64.powf(log_k))
                    .stress_position(c_1, c_2)
                    .params()
                    .unwrap()
            },
        );
    (
        (0.02..0.6_f64, 0.02..0.5_f64),
        (-3.0..-0.05_f64, -1.0..=1.0_f64),
        soil,
    )
        .prop_map(|((radius, width), (log_z, slip), soil)| Any {
            radius,
            width,
            z_over_r: 10_f64.powf(log_z),
            slip,
            soil,
        })
}

impl Any {
    fn contact(&self, settings: Settings) -> WheelOnSoil {
        let wheel = RigidWheel::new(self.radius, self.width).unwrap();
        WheelOnSoil::new(wheel, Soil::new(self.soil).unwrap(), settings).unwrap()
    }
    fn motion(&self) -> Kinematics {
        Kinematics::straight(Slip::new(self.slip).unwrap())
    }
    fn sinkage(&self) -> f64 {
        self.z_over_r * self.radius
    }
}

fn size(f: &Forces, radius: f64) -> f64 {
    f.vertical_force
        .abs()
        .max(f.drawbar_pull.abs())
        .max(f.torque.abs() / radius)
}

/// Cases a property, unless `PROPTEST_CASES` says otherwise.
fn cases() -> u32 {
    std::env::var("PROPTEST_CASES")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(1000)
}

/// Under a braked wheel the vertical force may rise, fall by a tenth or more, and rise again. The search follows it: of 735 loads it
/// takes the lowest sinkage of 734 and cautions 731.
#[test]
fn of_several_sinkages_it_takes_the_lowest_on_a_rising_branch_and_cautions() {
    let mut runner = TestRunner::deterministic();
    let (mut several, mut lowest, mut cautioned, mut single) = (0, 0, 0, 0);
    for _ in 0..4000 {
        let mut any = any_wheel().new_tree(&mut runner).unwrap().current();
        any.slip *= if any.slip < 0.0 { 0.3 } else { -0.3 };
        let (contact, motion) = (any.contact(Settings::default()), any.motion());
        let under = |load: f64| contact.under_load(load, &motion).unwrap().point();
        // no search: the force at 150 sinkages, and the deepest valley behind its first top
        let sampled = |count: i32| -> Vec<(f64, f64)> {
            (1..=count)
                .map(|i| 0.999 * any.radius * (f64::from(i) / f64::from(count)).powi(2))
                .map(|z| (z, contact.forces_at(z, &motion).unwrap().vertical_force))
                .collect()
        };
        let forces = sampled(150);
        let (mut top, mut valley) = (0.0_f64, f64::INFINITY);
        for &(_, force) in &forces {
            match valley.is_finite() || force.max(0.0) < 0.9 * top {
                false => top = top.max(force),
                true if force > top => break,
                true => valley = valley.min(force.max(0.0)),
            }
        }
        if !valley.is_finite() {
            let load = 0.5 * top;
            if let Some(point) = under(load) {
                if point.cautions.contains(Caution::SeveralSinkages) {
                    // a fall by less than a tenth, or between the samples
                    let fine = sampled(5000);
                    let falls = |pair: &[(f64, f64)]| pair[0].1 >= load && pair[1].1 < load;
                    assert!(fine.windows(2).any(falls), "{any:?} {load}");
                }
                single += 1;
            }
            continue;
        }
        for share in [0.1, 0.3, 0.5, 0.7, 0.9] {
            let load = valley + share * (top - valley);
            let (first, _) = forces.iter().find(|(_, force)| *force >= load).unwrap();
            several += 1;
            let Some(point) = under(load) else { continue };
            lowest += i32::from(point.sinkage <= 1.001 * first);
            cautioned += i32::from(point.cautions.contains(Caution::SeveralSinkages));
        }
    }
    println!(
        "{several} loads with several sinkages: the lowest {lowest}, cautioned {cautioned}; {single} with one"
    );
    assert!(several > 100 && single > 1000, "{several} {single}");
    let share = |count: i32| f64::from(count) / f64::from(several);
    assert!(share(lowest) > 0.99 && share(cautioned) > 0.99);
}

proptest! {
    #![proptest_config(ProptestConfig {
        max_global_rejects: 1_000_000,
        ..ProptestConfig::with_cases(cases())
    })]

    #[test]
    fn the_standard_rule_is_good_to_1e_9(any in any_wheel()) {
        let exact = Settings { accuracy: Accuracy::Reference, ..Settings::default() };
        let point = any.contact(Settings::default()).at_sinkage(any.sinkage(), &any.motion()).unwrap();
        let f = any.contact(exact).forces_at(any.sinkage(), &any.motion()).unwrap();
        let off = (f.vertical_force - point.forces.vertical_force).abs()
            .max((f.drawbar_pull - point.forces.drawbar_pull).abs())
            .max((f.torque - point.forces.torque).abs() / any.radius);
        let size = size(&f, any.radius);
        prop_assert!(off <= 1e-9 * size, "{:e}", off / size);
        // what the solution says of its own error holds, up to rounding
        prop_assert!(off <= 1.5 * point.error_estimate() + 1e-12 * size);
    }

    #[test]
    fn energy_is_lost_and_the_balance_closes(any in any_wheel(), beta in -80.0..80.0_f64) {
        let motion = Kinematics::with_slip_angle(Slip::new(any.slip).unwrap(), Angle::from_deg(beta)).unwrap();
        for motion in [any.motion(), motion] {
            let f = any.contact(Settings::default()).forces_at(any.sinkage(), &motion).unwrap();
            let scale = (f.torque.abs() + f.drawbar_pull.abs() * any.radius + f.lost_work.abs())
                .max((f.thrust.abs() + f.compaction_resistance + f.side_shear) * any.radius);
            prop_assert!(f.energy_residual.abs() <= 1e-12 * scale, "{:e}", f.energy_residual / scale);
// A braked wheel on soil that springs back by most of its sinkage may gain work from the sign(j)
            // extension; that is a caution, below.
            if any.slip >= 0.0 || any.soil.rebound == 0.0 {
                prop_assert!(f.lost_work >= -1e-9 * scale, "{:e}", f.lost_work / scale);
            }
        }
    }

    #[test]
    fn a_load_is_carried_at_its_own_sinkage(any in any_wheel(), share in 0.01..0.9_f64) {
        let contact = any.contact(Settings::default());
        let force = contact.forces_at(any.sinkage(), &any.motion()).unwrap().vertical_force;
        prop_assume!(force > 1e-3);
        let load = share * force;
        let solution = contact.under_load(load, &any.motion()).unwrap();
        let point = solution.point().expect("less than the soil carries at a known sinkage");
        prop_assert!((point.forces.vertical_force / load - 1.0).abs() < 1e-9);
        prop_assert!(point.sinkage < any.sinkage());
        prop_assert!(solution.evaluations <= 40, "{}", solution.evaluations);
    }

    #[test]
    fn more_load_sinks_deeper(any in any_wheel(), more in 1.001..3.0_f64) {
        let any = Any { slip: any.slip.abs(), ..any };
        let contact = any.contact(Settings::default());
        let load = 0.3 * contact.forces_at(any.sinkage(), &any.motion()).unwrap().vertical_force;
        prop_assume!(load > 1e-6);
        let sinkage = |load| contact.sinkage_under(load, &any.motion()).unwrap().sinkage();
        if let (Some(light), Some(heavy)) = (sinkage(load), sinkage(load * more)) {
            prop_assert!(heavy > light);
        }
    }

    #[test]
    fn forces_scale_with_the_units(any in any_wheel(), metre in 0.5..2.0_f64, newton in 0.1..10.0_f64) {
        // The same wheel and soil in other units of length (1/metre) and force (1/newton).
        let n = any.soil.n;
        let mut scaled = any.clone();
        scaled.radius *= metre;
        scaled.width *= metre;
        let pascal = newton / (metre * metre);
        scaled.soil.cohesion *= pascal;
        scaled.soil.k_shear *= metre;
        if let grouser_terra::Pressure::Bekker(law) = &mut scaled.soil.pressure {
            law.k_c *= pascal / metre.powf(n - 1.0);
            law.k_phi *= pascal / metre.powf(n);
        }
        let a = any.contact(Settings::default()).forces_at(any.sinkage(), &any.motion()).unwrap();
        let b = scaled.contact(Settings::default()).forces_at(scaled.sinkage(), &scaled.motion()).unwrap();
        let size = size(&a, any.radius);
        // the stiffness that chooses the rule may round to the other side of its limit: then two rules of 1e-9
        prop_assert!((b.vertical_force / newton - a.vertical_force).abs() < 2e-9 * size);
        prop_assert!((b.drawbar_pull / newton - a.drawbar_pull).abs() < 2e-9 * size);
        prop_assert!((b.torque / (newton * metre) - a.torque).abs() < 2e-9 * size * any.radius);
    }

    #[test]
    fn left_and_right_are_mirror_images(any in any_wheel(), beta in 0.1..85.0_f64, law in 0..3_usize) {
        let shear = [ShearLaw::Coupled, ShearLaw::SlipVelocity, ShearLaw::Independent][law];
        let contact = any.contact(Settings { shear, ..Settings::default() });
        let slip = Slip::new(any.slip).unwrap();
        let at = |beta: f64| {
            let motion = Kinematics::with_slip_angle(slip, Angle::from_deg(beta)).unwrap();
            contact.at_sinkage(any.sinkage(), &motion).unwrap()
        };
        let (left, right) = (at(beta), at(-beta));
        prop_assert_eq!(left.forces, right.forces);
        prop_assert_eq!(left.side_force, -right.side_force);
        prop_assert!(left.side_force <= 0.0, "drifting to the left, the soil pushes to the right");
    }

    #[test]
    fn drifting_wheels_are_integrated_to_1e_9(any in any_wheel(), log_beta in -4.0..1.9_f64, law in 0..3_usize) {
        let shear = [ShearLaw::Coupled, ShearLaw::SlipVelocity, ShearLaw::Independent][law];
        let beta = Angle::from_deg(10_f64.powf(log_beta));
        let motion = Kinematics::with_slip_angle(Slip::new(any.slip).unwrap(), beta).unwrap();
        let exact = Settings { accuracy: Accuracy::Reference, shear, ..Settings::default() };
        let fast = any.contact(Settings { shear, ..Settings::default() }).forces_at(any.sinkage(), &motion).unwrap();
        let f = any.contact(exact).forces_at(any.sinkage(), &motion).unwrap();
        let size = size(&f, any.radius).max(f.side_shear);
        let off = (f.vertical_force - fast.vertical_force).abs()
            .max((f.drawbar_pull - fast.drawbar_pull).abs())
            .max((f.side_shear - fast.side_shear).abs());
        prop_assert!(off <= 1e-9 * size, "{:e}", off / size);
    }

    #[test]
    fn rolling_backwards_is_the_mirror_image(any in any_wheel()) {
        let speed = |q: f64| if q.is_finite() { (q, 1.0) } else { (1.0, 0.0) };
        let (v, rim) = speed(any.motion().slip().speed_ratio());
        let contact = any.contact(Settings::default());
        let at = |sign: f64| {
            let motion = Kinematics::from_speeds(sign * v, 0.0, sign * rim).unwrap();
            contact.at_sinkage(any.sinkage(), &motion).unwrap()
        };
        let (forwards, backwards) = (at(1.0), at(-1.0));
        prop_assert_eq!(forwards.forces.vertical_force, backwards.forces.vertical_force);
        prop_assert_eq!(forwards.forces.drawbar_pull, -backwards.forces.drawbar_pull);
        prop_assert_eq!(forwards.forces.torque, -backwards.forces.torque);
        prop_assert_eq!(forwards.angles.theta_1, -backwards.angles.theta_1);
        prop_assert_eq!(forwards.tractive_efficiency(), backwards.tractive_efficiency());
        prop_assert_eq!(forwards.energy_per_metre(), backwards.energy_per_metre());
    }
}
