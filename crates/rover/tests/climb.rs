//! What slopes cost a robot, against the wheel alone and against the balance of forces.

use std::path::Path;

use grouser_rover::robot::RobotModel;
use grouser_rover::statics::{climb, wheel_loads};
use grouser_terra::{
    Kinematics, MOON_GRAVITY_M_PER_S2, Settings, Slip, Soil, WheelOnSoil, catalogue,
};

fn robot() -> RobotModel {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots/skid-steer.toml");
    RobotModel::read(&file).unwrap()
}

fn sand() -> Soil {
    catalogue::find("dry-sand").unwrap().soil().unwrap()
}

/// At the slip found, the pulls of the wheels under their loads on the slope add up to the weight along it, and
/// energy per metre is Σ T/(q r).
#[test]
fn forces_balance_at_the_slip_found() {
    let (model, soil) = (robot(), sand());
    for slope in [0.02_f64, 0.1] {
        let step = climb(&model, &soil, &[slope]).unwrap()[0];
        let slip = step.slip.unwrap();
        let loads = wheel_loads(&model, slope, 0.0).loads;
        let (mut pull, mut energy) = (0.0, 0.0);
        for (mount, load) in model.wheels.iter().zip(loads) {
            let pair = WheelOnSoil::new(mount.wheel, soil, Settings::default()).unwrap();
            let motion = Kinematics::straight(Slip::new(slip).unwrap());
            let point = pair.under_load(load, &motion).unwrap().point().unwrap();
            pull += point.forces.drawbar_pull;
            energy += point.forces.torque / ((1.0 - slip) * mount.wheel.radius());
        }
        let needed = model.weight() * slope.sin();
        assert!(
            (pull - needed).abs() < 1e-6 * model.weight(),
            "{pull} {needed}"
        );
        assert!((energy - step.energy_per_metre.unwrap()).abs() < 1e-6 * energy);
        assert!(step.reserve > 0.0);
    }
}

/// A slope that is too steep has no slip and a negative reserve; less gravity lightens the robot in proportion.
#[test]
fn steep_slopes_and_less_gravity() {
    let (model, soil) = (robot(), sand());
    let steep = climb(&model, &soil, &[1.0]).unwrap()[0];
    assert!(steep.slip.is_none() && steep.reserve < 0.0 && steep.energy_per_metre.is_none());
    let light = robot().under_gravity(MOON_GRAVITY_M_PER_S2);
    assert!((light.weight() / model.weight() - MOON_GRAVITY_M_PER_S2 / 9.806_65).abs() < 1e-12);
    let level = |model: &RobotModel| wheel_loads(model, 0.1, 0.0).loads;
    for (heavy, light) in level(&model).iter().zip(level(&light)) {
        assert!((light / heavy - MOON_GRAVITY_M_PER_S2 / 9.806_65).abs() < 1e-9);
    }
    let sinkage = |model: &RobotModel| climb(model, &soil, &[0.05]).unwrap()[0].sinkage.unwrap();
    assert!(sinkage(&light) < sinkage(&model));
}
