//! The surrogate against the direct kernel, and what it refuses.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use grouser_terra::{
    Accuracy, Error, Kinematics, RigidWheel, Settings, Slip, Surrogate, SurrogateBox, WheelOnSoil,
    catalogue,
};
use proptest::prelude::*;

const SOILS: [&str; 5] = ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"];

fn pair(key: &str, radius: f64, width: f64, accuracy: Accuracy) -> WheelOnSoil {
    let soil = catalogue::find(key).unwrap().soil().unwrap();
    let settings = Settings {
        accuracy,
        ..Settings::default()
    };
    WheelOnSoil::new(RigidWheel::new(radius, width).unwrap(), soil, settings).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(60) })]

    #[test]
    fn inside_its_box_it_keeps_its_bound(
        key in 0..5_usize, radius in 0.04..0.4_f64, width in 0.03..0.3_f64,
        slip in (0.0..0.4_f64, 0.45..=1.0_f64), depth in (0.005..0.05_f64, 0.1..0.45_f64),
        places in prop::collection::vec((0.0..=1.0_f64, 0.0..=1.0_f64), 40),
    ) {
        let sinkage = (depth.0 * radius, depth.1 * radius);
        let exact = pair(SOILS[key], radius, width, Accuracy::Reference);
        let fast = Surrogate::new(
            &pair(SOILS[key], radius, width, Accuracy::Standard),
            SurrogateBox { slip, sinkage },
        ).unwrap();
        let bounds = *fast.bounds();
        // rounding of the products of 256 terms is the floor; what is above a thousandth is no surrogate
        prop_assert!(bounds.forces < 1e-3 && bounds.theta_1 < 1e-3, "{:?}", bounds);
        let (least, greatest) = fast.loads();
        for (a, b) in places {
            let s = slip.0 + a * (slip.1 - slip.0);
            let z = sinkage.0 + b * (sinkage.1 - sinkage.0);
            let motion = Kinematics::straight(Slip::new(s).unwrap());
            let f = exact.forces_at(z, &motion).unwrap();
            let got = fast.forces(z, s).unwrap();
            let size = f.vertical_force.abs().max(f.drawbar_pull.abs()).max(f.torque.abs() / radius);
            let off = (f.vertical_force - got.vertical_force).abs()
                .max((f.drawbar_pull - got.drawbar_pull).abs())
                .max((f.torque - got.torque).abs() / radius);
            prop_assert!(off <= bounds.forces * size, "{:e} of {:e}", off / size, bounds.forces);
            if (least..=greatest).contains(&f.vertical_force) {
                let carried = fast.under_load(f.vertical_force, s).unwrap();
                let angle = |z: f64| grouser_terra::entry_angle(z, radius);
                let off = (angle(carried.sinkage) / angle(z) - 1.0).abs();
                prop_assert!(off <= bounds.theta_1, "{off:e} of {:e}", bounds.theta_1);
            }
        }
    }
}

#[test]
fn it_refuses_outside_its_box() {
    let fast = Surrogate::new(
        &pair("dry-sand", 0.1, 0.05, Accuracy::Standard),
        SurrogateBox {
            slip: (0.1, 0.6),
            sinkage: (0.002, 0.03),
        },
    )
    .unwrap();
    let refused = |found: Result<_, Error>| matches!(found, Err(Error::OutOfRange { .. }));
    for slip in [0.0999, 0.6001, -0.1, f64::NAN] {
        assert!(refused(fast.forces(0.01, slip).map(drop)));
        assert!(refused(fast.under_load(20.0, slip).map(drop)));
    }
    for sinkage in [0.00199, 0.0301, f64::NAN] {
        assert!(refused(fast.forces(sinkage, 0.3).map(drop)));
    }
    let (least, greatest) = fast.loads();
    for load in [0.999 * least, 1.001 * greatest, f64::NAN, -1.0] {
        assert!(refused(fast.under_load(load, 0.3).map(drop)));
    }
}

#[test]
fn it_is_not_built_where_it_would_be_wrong() {
    let sand = pair("dry-sand", 0.1, 0.05, Accuracy::Standard);
    let sound = SurrogateBox {
        slip: (0.1, 0.6),
        sinkage: (0.002, 0.03),
    };
    let refused = |pair: &WheelOnSoil, inside| Surrogate::new(pair, inside).is_err();
    assert!(!refused(&sand, sound));
    for slip in [(-0.1, 0.5), (0.5, 0.2), (0.2, 1.1), (f64::NAN, 0.5)] {
        assert!(refused(&sand, SurrogateBox { slip, ..sound }));
    }
    for sinkage in [(0.0, 0.03), (0.03, 0.01), (0.01, 0.2), (0.01, f64::NAN)] {
        assert!(refused(&sand, SurrogateBox { sinkage, ..sound }));
    }
    assert!(refused(
        &pair("dry-sand", 0.1, 0.05, Accuracy::Reference),
        sound
    ));
}
