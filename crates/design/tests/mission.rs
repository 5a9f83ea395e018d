//! The wheel of a mission against searches that share nothing with it: a grid over radius and width in the exact solver.

use std::ops::ControlFlow;

use grouser_design::Error;
use grouser_design::mission::{
    Choice, FrontSettings, MissionFront, MissionParams, MissionProfile, MissionWheel, SlopeShare,
    SoilMeasure, SoilShare, Standing, WheelDesign, WheelRanges,
};
use grouser_terra::{
    Angle, Kinematics, RigidWheel, Settings, SlopeOutcome, WheelOnSoil, catalogue,
};

const SLOPES: [SlopeShare; 2] = [
    SlopeShare {
        slope_deg: 0.0,
        share: 0.75,
    },
    SlopeShare {
        slope_deg: 5.0,
        share: 0.25,
    },
];
const SOILS: [&str; 2] = ["dry-sand", "sandy-loam"];
const WHEELS: usize = 4;
/// Without wheels, N.
const BARE_WEIGHT: f64 = 200.0;
const GRAVITY_M_PER_S2: f64 = 9.81;
const MASS: &str = "30 * radius_m * width_m + 20 * radius_m^2";

fn mass(radius: f64, width: f64) -> f64 {
    30.0 * radius * width + 20.0 * radius * radius
}

/// Four wheels that carry alike.
fn mission(measure: SoilMeasure, ranges: WheelRanges) -> MissionProfile {
    let soils = SOILS.map(|name| SoilShare {
        name: name.to_owned(),
        soil: catalogue::find(name).unwrap().soil().unwrap(),
        share: 0.5,
    });
    let wheels = vec![MissionWheel::designed(); WHEELS];
    let mut params = MissionParams::new(wheels, soils.to_vec(), SLOPES.to_vec(), ranges);
    MASS.clone_into(&mut params.mass_formula);
    params.measure = measure;
    MissionProfile::new(params, |_, mass, _| {
        let weight = BARE_WEIGHT + WHEELS as f64 * GRAVITY_M_PER_S2 * mass;
        let carried = |slope: &SlopeShare| weight * slope.slope_deg.to_radians().cos() / 4.0;
        let loads = SLOPES.iter().map(|slope| vec![carried(slope); WHEELS]);
        Ok::<_, Error>(Standing {
            weight,
            loads: loads.collect(),
        })
    })
    .unwrap()
}

fn smooth() -> WheelRanges {
    let wheel = WheelDesign {
        radius: 0.15,
        width: 0.1,
        ..WheelDesign::default()
    };
    WheelRanges {
        radius: (0.08, 0.25),
        width: (0.04, 0.2),
        ..WheelRanges::fixed(&wheel)
    }
}

fn front(mission: &MissionProfile, choice: Choice, points: usize) -> MissionFront {
    let mut settings = FrontSettings::default();
    settings.choice = choice;
    settings.points = points;
    mission
        .front(&settings, &mut |_| ControlFlow::Continue(()))
        .unwrap()
}

/// Energy per metre on each soil and the least reserve, by the slip demand of one wheel and the law's own reserve at 0.6: none of
/// this is the code of a mission.
fn by_one_wheel(radius: f64, width: f64) -> Option<([f64; 2], f64)> {
    let weight = BARE_WEIGHT / WHEELS as f64 + GRAVITY_M_PER_S2 * mass(radius, width);
    let (mut energies, mut reserve) = ([0.0; 2], f64::INFINITY);
    for (energy, name) in energies.iter_mut().zip(SOILS) {
        let soil = catalogue::find(name).unwrap().soil().unwrap();
        let wheel = RigidWheel::new(radius, width).unwrap();
        let contact = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
        for slope in SLOPES {
            let angle = Angle::from_deg(slope.slope_deg);
            let demand = contact.slip_demand(weight, angle).unwrap();
            let SlopeOutcome::Holds { slip } = demand else {
                return None;
            };
            if slip.value() > 0.6 {
                return None;
            }
            let load = weight * angle.cos();
            let at = |slip| {
                let solved = contact.under_load(load, &Kinematics::straight(slip));
                solved.unwrap().point().unwrap()
            };
            *energy += WHEELS as f64 * slope.share * at(slip).energy_per_metre().unwrap();
            // These soils have no slip-sinkage: the pull grows with slip.
            let most = at(grouser_terra::Slip::new(0.6).unwrap());
            let left = most.forces.drawbar_pull - weight * angle.sin();
            reserve = reserve.min(left / weight);
        }
    }
    Some((energies, reserve))
}

#[test]
fn one_wheel_is_evaluated_as_by_the_laws_alone() {
    let mission = mission(SoilMeasure::Worst, smooth());
    for (radius, width) in [(0.1, 0.05), (0.15, 0.1), (0.22, 0.18)] {
        let wheel = WheelDesign {
            radius,
            width,
            ..WheelDesign::default()
        };
        let point = mission.evaluate(&wheel).unwrap();
        assert!((point.wheel_mass - mass(radius, width)).abs() < 1e-12);
        let Some((energies, reserve)) = by_one_wheel(radius, width) else {
            assert!(point.energy.is_none());
            continue;
        };
        for (ours, theirs) in point.soil_energies.iter().zip(energies) {
            assert!(
                (ours.unwrap() / theirs - 1.0).abs() < 1e-9,
                "{radius} {width}"
            );
        }
        assert!((point.least_reserve() - reserve).abs() < 1e-9);
    }
}

/// 35 x 17 wheels: no one of them is better than the front, and beside each point of the front there is one nearly as good.
#[test]
fn no_wheel_of_a_grid_beats_the_front() {
    let mission = mission(SoilMeasure::Worst, smooth());
    let front = front(&mission, Choice::Knee, 7);
    assert!(front.points.len() >= 6 && front.unsolved == 0, "{front:?}");
    let mut grid = Vec::new();
    for i in 0..=34 {
        for j in 0..=16 {
            let (radius, width) = (0.08 + 0.005 * f64::from(i), 0.04 + 0.01 * f64::from(j));
            if let Some((energies, reserve)) = by_one_wheel(radius, width)
                && reserve >= mission.params().min_reserve
            {
                grid.push((mass(radius, width), energies[0].max(energies[1])));
            }
        }
    }
    assert!(grid.len() > 150);
    let mut closest = Vec::new();
    for point in &front.points {
        let (limit, energy) = (point.wheel_mass * (1.0 + 1e-6), point.energy.unwrap());
        let lighter = grid.iter().filter(|(mass, _)| *mass <= limit);
        let best = lighter
            .map(|(_, energy)| *energy)
            .fold(f64::INFINITY, f64::min);
        assert!(energy <= best * (1.0 + 1e-6), "{point:?} {best}");
        closest.push(best / energy - 1.0);
    }
    // The lightest wheels lie between the nodes of the grid; the others are met to its step.
    let met: Vec<f64> = closest.into_iter().filter(|off| off.is_finite()).collect();
    assert!(met.len() + 2 >= front.points.len(), "{met:?}");
    assert!(met.iter().all(|off| *off < 0.03), "{met:?}");
    let lightest = grid
        .iter()
        .map(|(mass, _)| *mass)
        .fold(f64::INFINITY, f64::min);
    assert!(front.points[0].wheel_mass <= lightest * (1.0 + 1e-6));
    assert!(front.points[0].wheel_mass > 0.9 * lightest);
}

#[test]
fn the_front_falls_and_a_limit_of_the_mass_is_met() {
    let mission = mission(SoilMeasure::Mean, smooth());
    let limited = front(&mission, Choice::MaxMass(1.0), 5);
    let chosen = &limited.points[limited.chosen.unwrap()];
    assert!((chosen.wheel_mass - 1.0).abs() < 1e-4, "{chosen:?}");
    assert!(
        chosen.held_by.contains(&"wheel mass".to_owned()),
        "{chosen:?}"
    );
    // The price of the mass is the slope of the front.
    let price = chosen.energy_per_mass.unwrap();
    let near = front(&mission, Choice::MaxMass(1.02), 5);
    let beside = &near.points[near.chosen.unwrap()];
    let slope = (chosen.energy.unwrap() - beside.energy.unwrap()) / (beside.wheel_mass - 1.0);
    assert!((slope / price - 1.0).abs() < 0.05, "{slope} {price}");
    for pair in limited.points.windows(2) {
        assert!(pair[1].wheel_mass > pair[0].wheel_mass && pair[1].energy < pair[0].energy);
    }
}

#[test]
fn lugs_are_whole_and_hold_the_slopes() {
    let ranges = WheelRanges {
        radius: (0.15, 0.15),
        width: (0.06, 0.14),
        grouser_height: (0.004, 0.015),
        grouser_count: (6.0, 30.0),
        grouser_thickness: (0.002, 0.002),
        mass_shift: (0.0, 0.0),
    };
    let mission = mission(SoilMeasure::Worst, ranges);
    let front = front(&mission, Choice::Lightest, 3);
    assert!(!front.points.is_empty(), "{front:?}");
    for point in &front.points {
        assert_eq!(point.wheel.grouser_count.fract(), 0.0, "{point:?}");
        assert!(
            point.least_reserve() >= mission.params().min_reserve - 1e-6,
            "{point:?}"
        );
    }
}

#[test]
fn what_no_wheel_holds_is_said_with_the_nearest() {
    let mut params = mission(SoilMeasure::Worst, smooth()).params().clone();
    params.slopes[1].slope_deg = 35.0;
    let slopes = params.slopes.clone();
    let mission = MissionProfile::new(params, |_, mass, _| {
        let weight = BARE_WEIGHT + WHEELS as f64 * GRAVITY_M_PER_S2 * mass;
        let carried = |slope: &SlopeShare| weight * slope.slope_deg.to_radians().cos() / 4.0;
        let loads = slopes.iter().map(|slope| vec![carried(slope); WHEELS]);
        Ok::<_, Error>(Standing {
            weight,
            loads: loads.collect(),
        })
    })
    .unwrap();
    let front = front(&mission, Choice::Knee, 4);
    assert!(front.points.is_empty() && front.chosen.is_none());
    let nearest = front.nearest.unwrap();
    assert!(nearest.least_reserve() < 0.0, "{nearest:?}");
    assert!(nearest.energy.is_none());
}

#[test]
fn a_search_that_is_stopped_keeps_what_it_has() {
    let mission = mission(SoilMeasure::Worst, smooth());
    let mut calls = 0;
    let front = mission
        .front(&FrontSettings::default(), &mut |_| {
            calls += 1;
            if calls > 60 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })
        .unwrap();
    assert!(front.stopped);
}

#[test]
fn what_a_mission_cannot_mean_is_refused() {
    let good = mission(SoilMeasure::Worst, smooth()).params().clone();
    let refused = |change: &dyn Fn(&mut MissionParams)| {
        let mut params = good.clone();
        change(&mut params);
        let stand = |_: f64, _: f64, _: f64| -> Result<Standing, Error> {
            Ok(Standing {
                weight: 100.0,
                loads: vec![vec![25.0; WHEELS]; 2],
            })
        };
        MissionProfile::new(params, stand).unwrap_err().to_string()
    };
    let sum = refused(&|params| params.slopes[0].share = 0.5);
    assert!(
        sum.contains("sum of the shares of slopes") && sum.contains("0.75"),
        "{sum}"
    );
    let steep = refused(&|params| params.slopes[0].slope_deg = 61.0);
    assert!(steep.contains("`slope_deg` is 61 deg"), "{steep}");
    let nan = refused(&|params| params.soils[0].share = f64::NAN);
    assert!(nan.contains("NaN"), "{nan}");
    let twice = refused(&|params| params.soils[1].name = SOILS[0].to_owned());
    assert!(twice.contains("named twice"), "{twice}");
    let inverted = refused(&|params| params.ranges.radius = (0.2, 0.1));
    assert!(inverted.contains("upper bound of radius_m"), "{inverted}");
    let light = refused(&|params| params.mass_formula = "radius_m - 0.2".to_owned());
    assert!(
        light.contains("wheel_mass_kg") && light.contains("kg"),
        "{light}"
    );
    let unknown = refused(&|params| params.mass_formula = "radius".to_owned());
    assert!(unknown.contains("radius"), "{unknown}");
    let lugs = refused(&|params| params.ranges.grouser_count = (0.0, 12.0));
    assert!(lugs.contains("at least 1"), "{lugs}");
    let fixed = refused(&|params| {
        params.ranges.radius = (0.1, 0.1);
        params.ranges.width = (0.1, 0.1);
    });
    assert!(fixed.contains("nothing is left to choose"), "{fixed}");
}
