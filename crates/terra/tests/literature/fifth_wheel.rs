//! The skid of a free wheel, solved elsewhere from the same equations at torque 0 (three digits).

use grouser_terra::{RigidWheel, Settings, ShearLaw, WheelOnSoil, catalogue};

#[test]
fn a_free_wheel_skids() {
    for (soil, radius, width, load, skid) in [
        ("dry-sand", 0.05, 0.03, 5.0, -0.095),
        ("dry-sand", 0.05, 0.03, 15.0, -0.1895),
        ("dry-sand", 0.10, 0.05, 30.0, -0.085),
        ("sandy-loam", 0.05, 0.03, 15.0, -0.041),
        ("lunar", 0.05, 0.03, 5.0, -0.126),
    ] {
        let soil = catalogue::find(soil).unwrap().soil().unwrap();
        let wheel = RigidWheel::new(radius, width).unwrap();
        let contact = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        let slip = contact.free_slip(load, 0.0).unwrap().unwrap().value();
        assert!(
            (slip - skid).abs() < 5.1e-4,
            "{radius} {load}: {slip} for {skid}"
        );
        // friction in the bearing makes it lag more
        let rubbing = contact
            .free_slip(load, 0.01 * load * radius)
            .unwrap()
            .unwrap()
            .value();
        assert!(rubbing < slip);
    }
}

/// The same wheel by other published laws, solved elsewhere: slip velocity −0.027, and Wong-Reece II with its own
/// displacement and θ_m = θ_0 −0.163.
#[test]
fn the_skid_depends_on_the_law() {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let wheel = RigidWheel::new(0.05, 0.03).unwrap();
    for (law, skid) in [
        (ShearLaw::SlipVelocity, -0.027),
        (ShearLaw::TowedWongReece, -0.163),
    ] {
        let settings = Settings {
            shear: law,
            ..Settings::default()
        };
        let contact = WheelOnSoil::new(wheel, soil, settings).unwrap();
        let slip = contact.free_slip(5.0, 0.0).unwrap().unwrap().value();
        assert!((slip - skid).abs() < 1e-3, "{law:?}: {slip} for {skid}");
    }
}
