//! Forces for steps in time against reference mode, over random contacts of every motion that a robot meets.

use grouser_terra::{
    Accuracy, Angle, Bulldozing, Entry, Forces, Kinematics, RigidWheel, Settings, ShearLaw,
    SideForce, Slip, Soil, SoilHistory, SoilParams, WheelOnSoil,
};

/// A stream of numbers in [0, 1) from a seed: SplitMix64.
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub(super) fn log(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }
}

fn error(found: &Forces, exact: &Forces, radius: f64) -> f64 {
    let size = |f: &Forces| {
        let torque = f.torque.abs() / radius;
        f.vertical_force.abs().max(f.drawbar_pull.abs()).max(torque)
    };
    let off = [
        found.vertical_force - exact.vertical_force,
        found.drawbar_pull - exact.drawbar_pull,
        (found.torque - exact.torque) / radius,
        found.side_shear - exact.side_shear,
    ];
    off.into_iter().map(f64::abs).fold(0.0, f64::max) / size(exact)
}

/// A wheel, a sinkage and a motion.
fn draw(random: &mut Random, shear: ShearLaw) -> (WheelOnSoil, WheelOnSoil, f64, Kinematics) {
    let radius = random.log(0.03, 0.4);
    let wheel = RigidWheel::new(radius, random.log(0.02, 0.4)).unwrap();
    let open = Soil::bekker(
        random.between(0.0, 5e4),
        random.log(5e4, 3e6),
        random.between(0.4, 1.6),
    )
    .cohesion(if random.next() < 0.3 {
        0.0
    } else {
        random.log(10.0, 1e4)
    })
    .phi(Angle::from_deg(random.between(15.0, 42.0)))
    .k_shear(random.log(0.004, 0.05))
    .stress_position(random.between(0.1, 0.6), random.between(0.0, 0.4));
    let rebound = if random.next() < 0.5 {
        0.0
    } else {
        random.between(0.0, 0.3)
    };
    let soil = open.soil().unwrap().with_rebound(rebound).unwrap();
    let at = |accuracy| {
        WheelOnSoil::new(
            wheel,
            soil,
            Settings {
                accuracy,
                shear,
                ..Settings::default()
            },
        )
        .unwrap()
    };
    let sinkage = radius * random.log(1e-3, 0.5);
    let slip = match random.next() {
        ..0.25 => random.between(-0.05, 0.05),
        ..0.5 => random.between(-0.5, 0.0),
        _ => random.between(0.0, 1.0),
    };
    let drift = match random.next() {
        ..0.25 => 0.0,
        ..0.5 => random.between(-0.5, 0.5),
        _ => random.log(1e-6, 1.0),
    };
    let (travel, rim) = if slip >= 0.0 {
        (1.0 - slip, 1.0)
    } else {
        (1.0, 1.0 + slip)
    };
    let motion = Kinematics::from_speeds(travel, drift, rim).unwrap();
    (
        at(Accuracy::Simulation),
        at(Accuracy::Reference),
        sinkage,
        motion,
    )
}

/// `GROUSER_SIMULATION_CASES=100000` in release found the limits of the quick kernel.
#[test]
fn forces_for_steps_in_time_are_good_to_1e_6() {
    let cases = std::env::var("GROUSER_SIMULATION_CASES");
    let count = cases.map_or(4000, |count| count.parse().unwrap());
    for (law, share) in [
        (ShearLaw::Coupled, 0.5),
        (ShearLaw::SlipVelocity, 0.25),
        (ShearLaw::SlipVelocityRegular, 0.25),
    ] {
        good_to_1e_6(law, count, share);
    }
}

/// The quick kernel has served more than a share of them.
fn good_to_1e_6(law: ShearLaw, count: u32, share: f64) {
    let mut random = Random(1);
    let mut worst = (0.0, String::new());
    let mut apart = 0;
    for _ in 0..count {
        let (quick, exact, sinkage, motion) = draw(&mut random, law);
        let found = quick.forces_at(sinkage, &motion).unwrap();
        let reference = exact.forces_at(sinkage, &motion).unwrap();
        let off = error(&found, &reference, quick.wheel().radius());
        apart += u32::from(off > 1e-11);
        if off > worst.0 {
            worst = (
                off,
                format!("{sinkage} {motion:?} {:?}", quick.soil().params()),
            );
        }
        let balance = found.energy_residual / quick.wheel().radius();
        assert!(balance.abs() <= 1e-12 * found.vertical_force.abs().max(found.drawbar_pull.abs()));
    }
    assert!(worst.0 <= 1e-6, "{law:?} {worst:?}");
    assert!(
        f64::from(apart) > share * f64::from(count),
        "{law:?} {apart}"
    );
}

/// Steps in time compute the slip angle only where a law takes it: they must find what the whole operating point finds.
#[test]
fn laws_that_take_the_slip_angle_have_it_in_steps_too() {
    let plain = Soil::bekker(1e3, 1.5e6, 1.1)
        .cohesion(300.0)
        .phi(Angle::from_deg(29.0))
        .k_shear(0.01)
        .stress_position(0.3, 0.2)
        .soil()
        .unwrap();
    let plain = SoilParams {
        unit_weight: Some(1.5e4),
        ..*plain.params()
    };
    let mut disc = plain;
    disc.laws.bulldozing = Some(Bulldozing::Disc);
    let mut apart = plain;
    (apart.k_shear_side, apart.k_shear_side_1) = (Some(0.01), 0.03);
    apart.laws.shear = Some(ShearLaw::Independent);
    let mut along = plain;
    along.k_shear_1 = 0.02;
    let mut unsupported = plain;
    unsupported.sideways_support = 0.3;
    let wheel = RigidWheel::new(0.1, 0.06).unwrap();
    for accuracy in [Accuracy::Simulation, Accuracy::Standard] {
        let settings = Settings {
            accuracy,
            ..Settings::default()
        };
        let numbers = |params: SoilParams, motion: &Kinematics| {
            let soil = Soil::new(params).unwrap();
            let on_soil = WheelOnSoil::new(wheel, soil, settings).unwrap();
            let steady = SoilHistory::steady(*motion);
            let (step, side) = on_soil
                .forces_after(&Entry::new(0.02, 0.1), motion, &steady, SideForce::Whole)
                .unwrap();
            let whole = on_soil.at_sinkage(0.02, motion).unwrap();
            [(step, side), (whole.forces, whole.side_force)]
                .map(|(f, side)| [f.vertical_force, f.drawbar_pull, f.torque, side])
        };
        for (slip, drift) in [(0.3, 1.4), (-0.4, -2.5), (0.95, 0.2)] {
            let motion = Kinematics::with_drift(Slip::new(slip).unwrap(), drift).unwrap();
            let [usual, _] = numbers(plain, &motion);
            for (law, params) in [plain, disc, apart, along, unsupported].iter().enumerate() {
                let [step, whole] = numbers(*params, &motion);
                for (a, b) in step.iter().zip(whole) {
                    assert!(
                        (a - b).abs() < 1e-9 * whole[0],
                        "law {law}: {step:?} {whole:?}"
                    );
                }
                let moved = step
                    .iter()
                    .zip(usual)
                    .any(|(a, b)| (a - b).abs() > 0.01 * usual[0]);
                assert_eq!(moved, law > 0, "law {law}");
            }
        }
    }
}
