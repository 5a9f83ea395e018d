//! The tables of a known soil beside the solvers of its parts, for robots and soils of any kind.

use grouser_slip::filter::FilterSettings;
use grouser_slip::onboard::{SoilTables, TORQUE_POINTS, WheelSetup};
use grouser_slip::prior::{FreeWheelSkid, SlipDemand, SoilDoubt};
use grouser_slip::{Robot, Wheel, WheelRole};
use grouser_terra::{Angle, Kinematics, RigidWheel, Settings, Slip, Soil, WheelOnSoil, catalogue};

use crate::noise::Noise;

fn soil(name: &str) -> Soil {
    catalogue::find(name).unwrap().soil().unwrap()
}

fn wheel(role: WheelRole, radius: f64, width: Option<f64>) -> Wheel {
    let wheel = match role {
        WheelRole::Free => Wheel::free("free"),
        WheelRole::Powered => Wheel::powered("powered"),
    };
    let wheel = wheel.radius(radius);
    width.map_or(wheel.clone(), |width| wheel.width(width))
}

/// A wheel without a width is as wide as its radius.
fn rigid(wheel: &Wheel) -> RigidWheel {
    RigidWheel::new(wheel.radius, wheel.width.unwrap_or(wheel.radius)).unwrap()
}

/// Tables of wheels with their loads (N), greatest torques and bearings' torques (N m).
fn solve(wheels: &[(Wheel, WheelSetup)], soil: &Soil, doubt: SoilDoubt) -> SoilTables {
    let names = wheels.iter().enumerate().map(|(index, (wheel, _))| {
        let mut wheel = wheel.clone();
        wheel.name = format!("wheel {index}");
        wheel
    });
    let robot = Robot::new("robot".into(), names.collect()).unwrap();
    let setups: Vec<WheelSetup> = wheels.iter().map(|wheel| wheel.1).collect();
    SoilTables::solve(&robot, &setups, soil, doubt).unwrap()
}

fn setup(load: f64, max_torque: Option<f64>, bearing_torque: f64) -> WheelSetup {
    WheelSetup {
        load,
        max_torque,
        bearing_torque,
        ..WheelSetup::default()
    }
}

fn between(noise: &mut Noise, low: f64, high: f64) -> f64 {
    low + (high - low) * noise.uniform()
}

#[test]
fn tables_are_those_of_the_wheels_under_their_loads() {
    let mut noise = Noise::new(1);
    for name in ["dry-sand", "sandy-loam", "clayey-soil", "snow"] {
        let soil = soil(name);
        let doubt = SoilDoubt::of(between(&mut noise, 0.1, 0.4));
        let mut wheels = Vec::new();
        for role in [
            WheelRole::Free,
            WheelRole::Powered,
            WheelRole::Free,
            WheelRole::Powered,
        ] {
            let radius = between(&mut noise, 0.05, 0.2);
            let width = (noise.uniform() < 0.7).then(|| between(&mut noise, 0.03, 0.15));
            // a load that lifts is none
            let load = between(&mut noise, -3.0, 60.0);
            let max_torque = (role == WheelRole::Powered).then_some(9.0);
            let bearing = between(&mut noise, 0.0, 0.02);
            wheels.push((wheel(role, radius, width), setup(load, max_torque, bearing)));
        }
        let tables = solve(&wheels, &soil, doubt);
        let mut skids = Vec::new();
        let mut loads = Vec::new();
        for ((wheel, setup), torques) in wheels.iter().zip(&tables.torques) {
            let load = setup.load.max(0.1);
            if wheel.role == WheelRole::Free {
                let skid = FreeWheelSkid::over_laws(
                    rigid(wheel),
                    &soil,
                    setup.bearing_torque,
                    (load, load),
                    doubt,
                );
                skids.extend(skid.unwrap().at(load));
                assert_eq!(*torques, None);
                continue;
            }
            loads.push(setup.load);
            let contact = WheelOnSoil::new(rigid(wheel), soil, Settings::default()).unwrap();
            for (index, torque) in torques.unwrap().into_iter().enumerate() {
                let slip = Slip::new(index as f64 / 20.0).unwrap();
                let point = contact
                    .under_load(load, &Kinematics::straight(slip))
                    .unwrap();
                let expected = point.point().map_or(0.0, |point| point.forces.torque);
                assert!(
                    (torque - expected).abs() <= 1e-12 * expected.abs(),
                    "{name} {index}"
                );
            }
        }
        assert_eq!(TORQUE_POINTS, 21);
        assert_eq!(skids.len(), 2, "{name}");
        let free = tables.free_slip.unwrap();
        assert!(
            (free.mean - 0.5 * (skids[0].mean + skids[1].mean)).abs() < 1e-12,
            "{name}"
        );
        let sigma = 0.5 * (skids[0].sigma + skids[1].sigma);
        let least = FilterSettings::default().free_slip.sigma;
        assert!((free.sigma - sigma.max(least)).abs() < 1e-12, "{name}");
        // the first powered wheel under the mean load, to 0.35 rad either way
        let steepest = [-0.35, 0.35].map(Angle::from_rad);
        let load = (0.5 * (loads[0] + loads[1])).max(0.1);
        let demand = SlipDemand::new(
            rigid(&wheels[1].0),
            &soil,
            load,
            (steepest[0], steepest[1]),
            doubt,
        )
        .unwrap();
        let found = tables.slip_demand.unwrap();
        for slope in [-0.35, -0.2, -0.01, 0.0, 0.05, 0.1, 0.3, 0.36] {
            let slope = Angle::from_rad(slope);
            assert_eq!(found.at(slope), demand.at(slope), "{name}");
        }
    }
}

#[test]
fn a_skid_is_no_surer_than_the_filter_and_no_standstill() {
    let least = FilterSettings::default().free_slip.sigma;
    let of = |bearing: f64, doubt: f64, count: usize| {
        let free = (
            wheel(WheelRole::Free, 0.1, Some(0.05)),
            setup(20.0, None, bearing),
        );
        let powered = (wheel(WheelRole::Powered, 0.1, None), setup(20.0, None, 0.0));
        let wheels: Vec<_> = [powered].into_iter().chain(vec![free; count]).collect();
        solve(&wheels, &soil("dry-sand"), SoilDoubt::of(doubt)).free_slip
    };
    // no free wheel, and none that the soil turns
    assert_eq!((of(0.0, 0.1, 0), of(50.0, 0.1, 2)), (None, None));
    // one whose bearing is so hard that the soil hardly turns it skids far, and how far is hardly known
    let skids = [0.0, 0.2, 0.5, 1.0].map(|bearing| of(bearing, 0.2, 3).unwrap());
    assert!(
        skids.windows(2).all(|pair| pair[1].mean < pair[0].mean),
        "{skids:?}"
    );
    assert!(
        skids[3].mean > -0.9 && skids[3].sigma > 2.0 * least,
        "{skids:?}"
    );
    // a soil that is known exactly leaves the doubt of the filter
    let exact = of(0.0, 1e-9, 1).unwrap();
    assert!(exact.sigma >= least, "{exact:?} {least}");
}
