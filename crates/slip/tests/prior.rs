//! What the soil model says beforehand, and what it takes away from the fifth wheel's bias.

use std::time::Instant;

use grouser_slip::filter::{FilterSettings, SlipFilter, SlipPrior};
use grouser_slip::prior::{FreeWheelSkid, SlipDemand, SoilDoubt, scaled_soil};
use grouser_terra::{
    Angle, Bekker, Pressure, Reece, RigidWheel, Settings, Slip, SlopeOutcome, Soil, SoilParams,
    WheelOnSoil, catalogue,
};

use crate::world::World;

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

/// A filter believes in every slip.
fn any_slip() -> Settings {
    Settings {
        max_slip: 1.0,
        ..Settings::default()
    }
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
    let pair = WheelOnSoil::new(wheel, sand(), any_slip()).unwrap();
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

/// The tables trace each soil from place to place; whole searches at each place give the same.
#[test]
fn tables_are_those_of_whole_searches() {
    let share = 0.2;
    for key in ["dry-sand", "lunar"] {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let p = *soil.params();
        let Pressure::Bekker(bekker) = p.pressure else {
            panic!("Bekker's soils")
        };
        // moduli, cohesion, tan φ and K in turn greater and smaller
        let neighbours: Vec<Soil> = [1.0 + share, 1.0 - share]
            .into_iter()
            .flat_map(|f| {
                let (k_c, k_phi) = (f * bekker.k_c, f * bekker.k_phi);
                [
                    SoilParams {
                        pressure: Pressure::Bekker(Bekker { k_c, k_phi }),
                        ..p
                    },
                    SoilParams {
                        cohesion: f * p.cohesion,
                        ..p
                    },
                    SoilParams {
                        phi: Angle::from_rad((f * p.phi.rad().tan()).atan()),
                        ..p
                    },
                    SoilParams {
                        k_shear: f * p.k_shear,
                        ..p
                    },
                ]
            })
            .map(|params| Soil::new(params).unwrap())
            .collect();
        let prior = |end: f64, of: &dyn Fn(&Soil) -> Option<f64>| {
            let mean = of(&soil)?;
            let squares: f64 = neighbours
                .iter()
                .map(|soil| of(soil).map_or(0.5 * (end - mean), |slip| slip - mean))
                .map(|off| 0.5 * off * off)
                .sum();
            Some((mean, squares.sqrt()))
        };
        let wheel = RigidWheel::new(0.15, 0.12).unwrap();
        let on = |soil: &Soil| WheelOnSoil::new(wheel, *soil, any_slip()).unwrap();
        let limit = Angle::from_deg(24.0);
        let limits = (Angle::from_rad(-limit.rad()), limit);
        let demand = SlipDemand::new(wheel, &soil, 45.0, limits, SoilDoubt::of(share)).unwrap();
        let mut held = 0;
        for place in 0..17 {
            let slope = Angle::from_deg(-24.0 + 3.0 * f64::from(place));
            let end = if slope.rad() < 0.0 { -1.0 } else { 1.0 };
            let truth = prior(
                end,
                &|soil| match on(soil).slip_demand(45.0, slope).unwrap() {
                    SlopeOutcome::Holds { slip } => Some(slip.value()),
                    _ => None,
                },
            );
            let point = demand
                .points()
                .iter()
                .find(|point| (point.0 - slope.rad()).abs() < 1e-9);
            assert_eq!(point.is_some(), truth.is_some(), "{key} {}°", slope.deg());
            if let (Some((_, found)), Some((mean, sigma))) = (point, truth) {
                held += 1;
                let off = (found.mean - mean).abs().max((found.sigma - sigma).abs());
                assert!(
                    off < 1e-10,
                    "{key} {}°: {found:?} {mean} {sigma}",
                    slope.deg()
                );
            }
        }
        assert!((8..17).contains(&held), "{held} slopes are held");
        let free = RigidWheel::new(0.08, 0.05).unwrap();
        let skid = FreeWheelSkid::new(free, &soil, 0.01, (10.0, 10.0), SoilDoubt::of(share));
        let found = skid.unwrap().at(10.0).unwrap();
        let (mean, sigma) = prior(-1.0, &|soil| {
            let pair = WheelOnSoil::new(free, *soil, Settings::default()).unwrap();
            pair.free_slip(10.0, 0.01).unwrap().map(Slip::value)
        })
        .unwrap();
        assert!((found.mean - mean).abs() < 1e-10 && (found.sigma - sigma).abs() < 1e-10);
    }
}

/// Dry sand or snow with tan φ as it is, greater and smaller by `share`.
fn frictions(key: &str, share: f64) -> [Soil; 3] {
    let soil = catalogue::find(key).unwrap().soil().unwrap();
    let p = *soil.params();
    [1.0, 1.0 + share, 1.0 - share].map(|factor| {
        let phi = Angle::from_rad((factor * p.phi.rad().tan()).atan());
        Soil::new(SoilParams { phi, ..p }).unwrap()
    })
}

fn friction_alone(share: f64) -> SoilDoubt {
    let mut doubt = SoilDoubt::of(0.0);
    doubt.friction = share;
    doubt
}

/// The mean, and a soil without a slip half way to `end`.
fn spread([own, more, less]: [Option<f64>; 3], end: f64) -> Option<(f64, f64)> {
    let mean = own?;
    let off = [more, less].map(|slip| slip.map_or(0.5 * (end - mean), |slip| slip - mean));
    Some((
        mean,
        (0.5 * (off[0] * off[0] + off[1] * off[1])).sqrt().max(1e-4),
    ))
}

/// Slopes that some of the soils do not hold.
#[test]
fn a_soil_that_holds_no_slope_counts_half_way_to_the_end() {
    let wheel = RigidWheel::new(0.15, 0.12).unwrap();
    let (key, share, weight, from, to) = ("dry-sand", 0.15, 500.0, -10.0, 10.0);
    let soils = frictions(key, share);
    let slopes = (Angle::from_deg(from), Angle::from_deg(to));
    let doubt = friction_alone(share);
    let demand = SlipDemand::new(wheel, &soils[0], weight, slopes, doubt).unwrap();
    let (mut points, mut alone) = (0, 0);
    for place in 0..9 {
        let slope = slopes.0.rad() + (slopes.1.rad() - slopes.0.rad()) * f64::from(place) / 8.0;
        let slips = soils.map(|soil| {
            let pair = WheelOnSoil::new(wheel, soil, any_slip()).unwrap();
            match pair.slip_demand(weight, Angle::from_rad(slope)).unwrap() {
                SlopeOutcome::Holds { slip } => Some(slip.value()),
                _ => None,
            }
        });
        let end = if slope < 0.0 { -1.0 } else { 1.0 };
        let found = demand
            .points()
            .iter()
            .find(|point| (point.0 - slope).abs() < 1e-9);
        let truth = spread(slips, end);
        println!("{key} {:.1}: {slips:?} {found:?}", slope.to_degrees());
        assert_eq!(found.is_some(), truth.is_some());
        if let (Some((_, found)), Some((mean, sigma))) = (found, truth) {
            points += 1;
            alone += usize::from(slips.iter().any(Option::is_none));
            assert!((found.mean - mean).abs() < 1e-9 && (found.sigma - sigma).abs() < 1e-9);
        }
    }
    assert!(points > 2 && alone > 0, "{key}: {points} {alone}");
}

/// A bearing that stops the wheel on the weaker soil alone.
#[test]
fn a_soil_that_does_not_turn_the_wheel_counts_half_way_to_a_locked_one() {
    let share = 0.3;
    let soils = frictions("dry-sand", share);
    let mut alone = 0;
    for step in 1..12 {
        let torque = 0.05 * f64::from(step);
        let slips = soils.map(|soil| {
            let pair = WheelOnSoil::new(fifth(), soil, Settings::default()).unwrap();
            pair.free_slip(10.0, torque).unwrap().map(Slip::value)
        });
        let loads = (10.0, 10.0);
        let skid = FreeWheelSkid::new(fifth(), &soils[0], torque, loads, friction_alone(share));
        let found = skid.unwrap().at(10.0);
        let truth = spread(slips, -1.0);
        println!("{torque:.2} N m: {slips:?} {found:?}");
        assert_eq!(found.is_some(), truth.is_some());
        if let (Some(found), Some((mean, sigma))) = (found, truth) {
            alone += usize::from(slips.iter().any(Option::is_none));
            assert!((found.mean - mean).abs() < 1e-9 && (found.sigma - sigma).abs() < 1e-9);
        }
    }
    assert!(alone > 0);
}

#[test]
fn a_skid_over_the_laws_is_that_of_each() {
    use grouser_terra::ShearLaw::{Coupled, SlipVelocity, TowedRestart};
    let (loads, doubt) = ((4.0, 6.0), SoilDoubt::of(0.1));
    let all = FreeWheelSkid::over_laws(fifth(), &sand(), 0.0, loads, doubt).unwrap();
    let each: Vec<SlipPrior> = [Coupled, SlipVelocity, TowedRestart]
        .into_iter()
        .filter_map(|law| {
            let mut params = *sand().params();
            params.laws.shear = Some(law);
            let soil = Soil::new(params).unwrap();
            let skid = FreeWheelSkid::new(fifth(), &soil, 0.0, loads, doubt).ok()?;
            skid.at(4.0)
        })
        .collect();
    assert_eq!(each.len(), 3);
    let mean = each.iter().map(|prior| prior.mean).sum::<f64>() / 3.0;
    let square = |prior: &SlipPrior| prior.sigma.powi(2) + prior.mean.powi(2);
    let square = each.iter().map(square).sum::<f64>() / 3.0;
    let found = all.at(4.0).unwrap();
    assert!((found.mean - mean).abs() < 1e-9);
    assert!((found.sigma - (square - mean * mean).sqrt()).abs() < 1e-9);
}

#[test]
fn ready_made_points_are_checked() {
    let of = |points: &[(f64, f64, f64)]| {
        let point = |&(slope, mean, sigma): &(f64, f64, f64)| (slope, SlipPrior { mean, sigma });
        let points: Vec<_> = points.iter().map(point).collect();
        SlipDemand::from_points(&points)
    };
    let demand = of(&[(-0.1, 0.02, 0.1), (0.1, 0.22, 0.3)]).unwrap();
    let level = demand.at(Angle::from_rad(0.0)).unwrap();
    assert!((level.mean - 0.12).abs() < 1e-12 && (level.sigma - 0.2).abs() < 1e-12);
    for bad in [
        [(0.1, 0.2, 0.1), (-0.1, 0.0, 0.1)],
        [(-1.6, 0.0, 0.1), (0.1, 0.0, 0.1)],
        [(-0.1, 0.0, 0.1), (1.6, 0.0, 0.1)],
        [(-0.1, -1.1, 0.1), (0.1, 0.0, 0.1)],
        [(-0.1, 0.0, 0.1), (0.1, 1.1, 0.1)],
        [(-0.1, 0.0, 0.0), (0.1, 0.0, 0.1)],
        [(-0.1, 0.0, 0.1), (0.1, f64::NAN, 0.1)],
    ] {
        assert!(of(&bad).is_err(), "{bad:?}");
    }
}

/// How long the tables of a drive take: `cargo test --release -p grouser-slip --test all prior:: -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn time_of_the_tables() {
    for key in ["dry-sand", "sandy-loam", "lunar"] {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let slopes = [-0.35, 0.35].map(Angle::from_rad);
        let mut least = [f64::INFINITY; 2];
        for _ in 0..10 {
            let wheel = RigidWheel::new(0.15, 0.12).unwrap();
            let begun = Instant::now();
            let doubt = SoilDoubt::default();
            SlipDemand::new(wheel, &soil, 45.0, (slopes[0], slopes[1]), doubt).unwrap();
            least[0] = begun.elapsed().as_secs_f64().min(least[0]);
            let wheel = RigidWheel::new(0.08, 0.05).unwrap();
            let begun = Instant::now();
            FreeWheelSkid::over_laws(wheel, &soil, 0.0, (10.0, 10.0), doubt).unwrap();
            least[1] = begun.elapsed().as_secs_f64().min(least[1]);
        }
        let [demand, skid] = least.map(|seconds| 1e3 * seconds);
        println!("{key}: slip demand {demand:.1} ms, skid {skid:.1} ms");
    }
}

#[test]
fn a_soil_by_reece_has_the_priors_of_the_same_soil_by_bekker() {
    let p = *sand().params();
    let Pressure::Bekker(Bekker { k_c, k_phi }) = p.pressure else {
        panic!("{:?}", p.pressure);
    };
    // of one width: (c k_c' + γ b k_phi')/bⁿ = k_c/b + k_phi, a third of it by cohesion
    let (width, unit_weight) = (fifth().width(), 15_000.0);
    let modulus = (k_c / width + k_phi) * width.powf(p.n);
    let by_reece = Soil::new(SoilParams {
        unit_weight: Some(unit_weight),
        pressure: Pressure::Reece(Reece {
            k_c_prime: modulus / 3.0 / p.cohesion,
            k_phi_prime: 2.0 * modulus / 3.0 / (unit_weight * width),
        }),
        ..p
    })
    .unwrap();
    // cohesion and n are in both laws, but not alike
    let mut doubt = SoilDoubt::of(0.3);
    (doubt.cohesion, doubt.exponent) = (0.0, 0.0);
    let skid = |soil: &Soil| FreeWheelSkid::new(fifth(), soil, 0.0, (5.0, 5.0), doubt).unwrap();
    for stiffness in [0.3, 1.0, 2.0] {
        let [bekker, reece] = [sand(), by_reece].map(|soil| {
            let scaled = scaled_soil(&soil, 1.0, stiffness).unwrap();
            skid(&scaled).at(5.0).unwrap()
        });
        assert!(
            (bekker.mean - reece.mean).abs() < 1e-6,
            "{bekker:?} {reece:?}"
        );
        assert!(
            (bekker.sigma - reece.sigma).abs() < 1e-5,
            "{bekker:?} {reece:?}"
        );
    }
}
