//! What slopes cost a robot, against the wheel alone and against the balance of forces.

use std::path::Path;

use grouser_rover::robot::RobotModel;
use grouser_rover::statics::wheel_loads;
use grouser_terra::{
    Kinematics, MOON_GRAVITY_M_PER_S2, Settings, Slip, Soil, WheelOnSoil, catalogue,
};
use grouser_terrain::{ClimbStep, Demand, DemandSolver, Envelope, SlipTable, climb};

fn named(name: &str) -> RobotModel {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots");
    RobotModel::read(&root.join(format!("{name}.toml"))).unwrap()
}

fn robot() -> RobotModel {
    named("skid-steer")
}

fn climbed(model: &RobotModel, soil: &Soil, slope: f64) -> ClimbStep {
    let solver = DemandSolver::new(model.clone(), *soil).unwrap();
    climb(&solver, &[slope]).unwrap()[0]
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
        let step = climbed(&model, &soil, slope);
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
    let steep = climbed(&model, &soil, 0.6);
    assert!(steep.slip.is_none() && steep.reserve < 0.0 && steep.energy_per_metre.is_none());
    let light = robot().under_gravity(MOON_GRAVITY_M_PER_S2);
    assert!((light.weight() / model.weight() - MOON_GRAVITY_M_PER_S2 / 9.806_65).abs() < 1e-12);
    let level = |model: &RobotModel| wheel_loads(model, 0.1, 0.0).loads;
    for (heavy, light) in level(&model).iter().zip(level(&light)) {
        assert!((light / heavy - MOON_GRAVITY_M_PER_S2 / 9.806_65).abs() < 1e-9);
    }
    let sinkage = |model: &RobotModel| climbed(model, &soil, 0.05).sinkage.unwrap();
    assert!(sinkage(&light) < sinkage(&model));
}

/// The pull of all wheels at a slip less what the slope takes, N, free wheels at their skid: none of this is the code of a solver.
fn surplus(model: &RobotModel, soil: &Soil, slope: f64, slip: f64) -> f64 {
    let loads = wheel_loads(model, slope, 0.0).loads;
    let pulls = model.wheels.iter().zip(loads).map(|(mount, load)| {
        let pair = WheelOnSoil::new(mount.wheel, *soil, Settings::default()).unwrap();
        let slip = match mount.motor {
            Some(_) => Slip::new(slip).unwrap(),
            None => pair.free_slip(load, mount.bearing).unwrap().unwrap(),
        };
        let solved = pair.under_load(load, &Kinematics::straight(slip)).unwrap();
        solved.point().unwrap().forces.drawbar_pull
    });
    pulls.sum::<f64>() - model.weight() * slope.sin()
}

/// The steepest slope is the one at which the greatest surplus up to the greatest slip vanishes; `climb`, the demand and the
/// table of a map agree on it.
#[test]
fn one_steepest_slope() {
    for (name, key) in [
        ("five-wheel", "dry-sand"),
        ("rocker-bogie", "sandy-loam"),
        ("skid-steer", "lunar"),
        ("skid-steer", "dry-sand"),
    ] {
        let (model, soil) = (named(name), catalogue::find(key).unwrap().soil().unwrap());
        for max_slip in [0.6, 0.3] {
            let solver = DemandSolver::new(model.clone(), soil).unwrap();
            let solver = solver.with_max_slip(max_slip).unwrap();
            let (slope, slip) = solver.steepest().unwrap().unwrap();
            let case = format!("{name} {key} {max_slip}: {} at {slip}", slope.to_degrees());
            assert!(slip <= max_slip, "{case}");
            let greatest = (0..=30)
                .map(|i| surplus(&model, &soil, slope, max_slip * f64::from(i) / 30.0))
                .fold(f64::NEG_INFINITY, f64::max);
            assert!(greatest.abs() < 1e-6 * model.weight(), "{case}: {greatest}");
            let drives = |slope: f64| {
                let demand = solver.demand(slope, 0.0).unwrap();
                let step = climb(&solver, &[slope]).unwrap()[0];
                assert_eq!(step.slip.is_some(), step.reserve >= 0.0, "{case}");
                assert_eq!(matches!(demand, Demand::Drives(_)), step.slip.is_some());
                step.slip.is_some()
            };
            assert!(drives(slope - 1e-7) && !drives(slope + 1e-7), "{case}");
            let envelope = Envelope::within(&model, 0.5, 0.3).unwrap();
            for table in [
                SlipTable::coarse(&solver, envelope).unwrap(),
                SlipTable::new(&solver, envelope).unwrap(),
            ] {
                assert!((table.steepest() - slope).abs() < 1e-8, "{case}");
            }
        }
    }
}

/// A robot that tips over before the soil gives way climbs as far as it stands.
#[test]
fn the_steepest_slope_is_one_on_which_the_robot_stands() {
    let mut model = named("skid-steer");
    for wheel in &mut model.wheels {
        wheel.centre.x *= 0.15;
    }
    let (slope, _) = DemandSolver::new(model.clone(), sand())
        .unwrap()
        .steepest()
        .unwrap()
        .unwrap();
    assert!(wheel_loads(&model, slope - 1e-9, 0.0).stands, "{slope}");
    assert!(!wheel_loads(&model, slope + 1e-9, 0.0).stands, "{slope}");
}
