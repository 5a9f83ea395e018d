//! What the soil model says beforehand, and what it takes away from the fifth wheel's bias.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking and may say what it measured"
)]

mod noise;
mod world;

use grouser_slip::filter::{FilterSettings, SlipFilter, SlipPrior};
use grouser_slip::prior::{FreeWheelSkid, SlipDemand, SoilDoubt};
use grouser_terra::{
    Angle, Bekker, Pressure, RigidWheel, Settings, SlopeOutcome, Soil, SoilParams, WheelOnSoil,
    catalogue,
};
use world::World;

fn sand() -> Soil {
    catalogue::find("dry-sand").unwrap().soil().unwrap()
}

/// The project's knowledge of the fifth wheel: r .05, b .03.
fn fifth() -> RigidWheel {
    RigidWheel::new(0.05, 0.03).unwrap()
}

fn skid_on(soil: &Soil, load: f64) -> f64 {
    let pair = WheelOnSoil::new(fifth(), *soil, Settings::default()).unwrap();
    pair.free_slip(load, 0.0).unwrap().unwrap().value()
}

#[test]
fn the_tables_are_what_the_model_solves() {
    let skid =
        FreeWheelSkid::new(fifth(), &sand(), 0.0, (2.0, 20.0), SoilDoubt::default()).unwrap();
    for i in 0..60 {
        let load = 2.0 + 0.3 * f64::from(i);
        let off = skid.at(load).unwrap().mean - skid_on(&sand(), load);
        // nine points linear in √W: the second difference's eighth
        assert!(off.abs() < 1e-3, "{load} N: {off}");
    }
    assert!(skid.at(1.9).is_none() && skid.at(20.1).is_none() && skid.at(f64::NAN).is_none());
    let wheel = RigidWheel::new(0.125, 0.1).unwrap();
    let slopes = (Angle::from_deg(-10.0), Angle::from_deg(15.0));
    let demand = SlipDemand::new(wheel, &sand(), 80.0, slopes, SoilDoubt::default()).unwrap();
    let pair = WheelOnSoil::new(wheel, sand(), Settings::default()).unwrap();
    for degrees in [-9.0, -3.0, 1.0, 5.0, 11.0] {
        let slope = Angle::from_deg(degrees);
        if let SlopeOutcome::Holds { slip } = pair.slip_demand(80.0, slope).unwrap() {
            let off = demand.at(slope).unwrap().mean - slip.value();
            assert!(off.abs() < 5e-3, "{degrees}°: {off}");
        }
    }
}

/// Mean error of the powered wheels' slip and their mean sigma, on ground where the free wheel skids by `skid`.
fn bias(skid: f64, believed: SlipPrior, seed: u64) -> (f64, f64) {
    let world = World {
        seed,
        skid,
        slip: (0.15, 0.15),
        ..World::default()
    };
    let settings = FilterSettings {
        free_slip: believed,
        ..FilterSettings::default()
    };
    let mut filter = SlipFilter::new(&world.robot(), settings).unwrap();
    let (mut errors, mut sigmas, mut count) = (0.0, 0.0, 0.0);
    world.run(|truth, samples| {
        for sample in samples {
            filter.update(*sample).unwrap();
        }
        if truth.time > 6.0 && truth.time < 24.0 {
            for (wheel, truth) in filter.latest().wheels.iter().zip(&truth.slips).take(4) {
                if let (Some(slip), Some(sigma), Some(truth)) = (wheel.slip, wheel.sigma, truth) {
                    errors += slip.value() - truth;
                    sigmas += sigma;
                    count += 1.0;
                }
            }
        }
    });
    (errors / count, sigmas / count)
}

#[test]
fn the_skid_of_the_fifth_wheel_is_taken_out() {
    let doubt = SoilDoubt::of(0.3);
    let table = FreeWheelSkid::new(fifth(), &sand(), 0.0, (2.0, 20.0), doubt).unwrap();
    for load in [5.0, 10.0, 15.0] {
        let skid = skid_on(&sand(), load);
        let rolls = SlipPrior {
            mean: 0.0,
            sigma: 0.01,
        };
        // what the accelerometer says of each start differs from run to run; the bias is what does not
        let over = |believed: SlipPrior| {
            let runs: Vec<_> = (1..=8).map(|seed| bias(skid, believed, seed)).collect();
            let mean = |of: fn(&(f64, f64)) -> f64| runs.iter().map(of).sum::<f64>() / 8.0;
            (mean(|run| run.0), mean(|run| run.1))
        };
        let (without, _) = over(rolls);
        let (with, sigma) = over(table.at(load).unwrap());
        println!(
            "{load} N: skid {skid:.3}, bias {without:+.3} without, {with:+.4} ± {sigma:.3} with"
        );
        assert!(without > 0.07 && without < 0.2);
        assert!(with.abs() <= 0.02);
    }
}

#[test]
fn a_soil_thirty_percent_wrong_is_within_the_interval() {
    let p = *sand().params();
    let moduli = |f: f64| SoilParams {
        pressure: Pressure::Bekker(Bekker {
            k_c: f * 0.9e3,
            k_phi: f * 1528.4e3,
        }),
        ..p
    };
    let table = FreeWheelSkid::new(fifth(), &sand(), 0.0, (2.0, 20.0), SoilDoubt::of(0.3)).unwrap();
    let mut worst: f64 = 0.0;
    for f in [0.7, 1.3] {
        let friction = (f * p.phi.rad().tan()).atan();
        for wrong in [
            moduli(f),
            SoilParams {
                cohesion: f * p.cohesion,
                ..p
            },
            SoilParams {
                phi: Angle::from_rad(friction),
                ..p
            },
            SoilParams {
                k_shear: f * p.k_shear,
                ..p
            },
        ] {
            for load in [5.0, 15.0] {
                let skid = skid_on(&Soil::new(wrong).unwrap(), load);
                let (off, sigma) = bias(skid, table.at(load).unwrap(), 1);
                worst = worst.max(off.abs() / sigma);
                assert!(
                    off.abs() < 2.0 * sigma,
                    "{wrong:?} at {load} N: {off} ± {sigma}"
                );
            }
        }
    }
    println!("greatest error {worst:.2} sigma");
}
