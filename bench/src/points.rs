//! The operating points that every rival gets: seeded, over the catalogue's first five soils.

use grouser_terra::{
    Accuracy, Kinematics, Pressure, RigidWheel, Settings, Slip, Soil, WheelOnSoil, catalogue,
};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

pub const SOILS: [&str; 5] = ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"];

/// Points on one soil.
pub struct Points {
    pub key: &'static str,
    pub soil: Soil,
    pub radius: Vec<f64>,
    pub width: Vec<f64>,
    pub rebound: Vec<f64>,
    pub slip: Vec<f64>,
    pub sinkage: Vec<f64>,
}

/// `count` points in all, as many on each soil: r 0.05-0.35 m, b 0.05-0.3 m, z/r 0.01-0.35, s 0-0.9.
pub fn points(count: usize) -> Vec<Points> {
    let mut rng = ChaCha8Rng::seed_from_u64(2012);
    let mut uniform = move |low: f64, high: f64| {
        low + (high - low) * (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    };
    let share = |i: usize| (count * (i + 1)) / SOILS.len() - (count * i) / SOILS.len();
    SOILS
        .iter()
        .enumerate()
        .map(|(i, &key)| {
            let n = share(i);
            let mut column = |low, high| (0..n).map(|_| uniform(low, high)).collect::<Vec<f64>>();
            let radius = column(0.05, 0.35);
            let width = column(0.05, 0.3);
            let slip = column(0.0, 0.9);
            let depth = column(0.01, 0.35);
            let sinkage = radius.iter().zip(&depth).map(|(r, d)| r * d).collect();
            Points {
                key,
                soil: catalogue::find(key)
                    .expect("in the catalogue")
                    .soil()
                    .expect("complete"),
                rebound: vec![0.0; n],
                radius,
                width,
                slip,
                sinkage,
            }
        })
        .collect()
}

/// The points as CSV, with the soil's parameters in SI units and the forces by the reference mode, for
/// rivals in other languages.
pub fn print(count: usize) {
    println!(
        "soil,k_c,k_phi,n,c,phi,k_shear,c_1,c_2,radius_m,width_m,slip,sinkage_m,load_n,w,pull,torque"
    );
    for set in points(count) {
        let p = set.soil.params();
        let Pressure::Bekker(law) = p.pressure else {
            unreachable!("the catalogue's law")
        };
        let exact = Settings {
            accuracy: Accuracy::Reference,
            ..Settings::default()
        };
        for i in 0..set.slip.len() {
            let wheel = RigidWheel::new(set.radius[i], set.width[i]).expect("a wheel");
            let contact = WheelOnSoil::new(wheel, set.soil, exact).expect("a wheel on its soil");
            let motion = Kinematics::straight(Slip::new(set.slip[i]).expect("a slip"));
            let f = contact.forces_at(set.sinkage[i], &motion).expect("forces");
            let w = f.vertical_force;
            let numbers = [
                law.k_c,
                law.k_phi,
                p.n,
                p.cohesion,
                p.phi.rad(),
                p.k_shear,
                p.c_1,
                p.c_2,
                set.radius[i],
                set.width[i],
                set.slip[i],
                set.sinkage[i],
                w,
                w,
                f.drawbar_pull,
                f.torque,
            ];
            println!(
                "{},{}",
                set.key,
                numbers.map(|x| format!("{x:?}")).join(",")
            );
        }
    }
}
