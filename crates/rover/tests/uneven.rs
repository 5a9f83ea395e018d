//! Robots at rest on uneven ground against closed forms and against the simulated machine.

use std::fmt::Write as _;
use std::path::Path;

use grouser_files::Document;
use grouser_rover::dynamics::Vehicle;
use grouser_rover::ground::{Ground, HeightMap};
use grouser_rover::robot::RobotModel;
use grouser_rover::statics::{Footing, stability_margins, stance, wheel_loads};
use grouser_terra::EARTH_GRAVITY_M_PER_S2;
use grouser_terra::catalogue;

/// Ground that hardly yields: what remains of its spring is 1e-6 of a wheel's load.
const ROCK: f64 = 1e8;

fn robot(name: &str) -> RobotModel {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots");
    RobotModel::read(&root.join(format!("{name}.toml"))).unwrap()
}

/// Chassis and two rockers on a differential, four wheels: wheelbase 0.6 m, stance 0.5 m, pivots at the height of the
/// wheels' centres. All of its mass is in the chassis but 1e-3 kg for each other part.
fn rockers(cg: [f64; 3]) -> RobotModel {
    let mut text = format!(
        "format = 1\nname = \"rockers\"\n[estimator]\nreference = \"grip\"\n\
         [chassis]\nmass_kg = 10.0\ncg_x_m = {:?}\ncg_y_m = {:?}\ncg_z_m = {:?}\n\
         inertia_xx_kg_m2 = 0.1\ninertia_yy_kg_m2 = 0.1\ninertia_zz_kg_m2 = 0.1\n\
         [[motor]]\nname = \"drive\"\nresistance_ohm = 1.0\nconstant_nm_per_a = 0.03\nvoltage_v = 24.0\ncurrent_a = 5.0\n",
        cg[0], cg[1], cg[2]
    );
    for (side, y, other) in [("left", 0.25, "right"), ("right", -0.25, "left")] {
        let _ = write!(
            text,
            "[[link]]\nname = \"{side}\"\npivot_x_m = 0.0\npivot_y_m = {y:?}\npivot_z_m = 0.15\nmass_kg = 0.001\n\
             opposite = \"{other}\"\nrange_deg = 60.0\n"
        );
    }
    for (name, x, y, side) in [
        ("fl", 0.3, 0.25, "left"),
        ("fr", 0.3, -0.25, "right"),
        ("rl", -0.3, 0.25, "left"),
        ("rr", -0.3, -0.25, "right"),
    ] {
        let _ = write!(
            text,
            "[[wheel]]\nname = \"{name}\"\nx_m = {x:?}\ny_m = {y:?}\nradius_m = 0.15\nwidth_m = 0.1\nload_n = 25.0\n\
             drive = \"powered\"\nencoder_on = \"motor\"\ngear = 60.0\nticks_per_turn = 64\ncounter_bits = 32\n\
             on = \"{side}\"\nmass_kg = 0.001\nspin_inertia_kg_m2 = 0.001\nmotor = \"drive\"\n"
        );
    }
    RobotModel::parse(&Document::from_text("rockers.toml", text).unwrap()).unwrap()
}

fn on(model: &RobotModel, heights: &[f64]) -> grouser_rover::statics::Stance {
    let footing = Footing {
        heights,
        stiffness: ROCK,
    };
    let found = stance(model, &footing).unwrap();
    assert!(found.settled, "{found:?}");
    let sum: f64 = found.loads.iter().sum();
    assert!(
        (sum - model.weight()).abs() < 1e-6 * model.weight(),
        "{sum}"
    );
    found
}

/// On the level it is what the closed form of a plane says, margins included.
#[test]
fn on_the_level_the_loads_are_the_planes() {
    for name in ["five-wheel", "skid-steer", "rocker-bogie"] {
        let model = robot(name);
        let plane = wheel_loads(&model, 0.0, 0.0);
        let found = on(&model, &vec![0.0; model.wheels.len()]);
        for (load, plane) in found.loads.iter().zip(&plane.loads) {
            // the springs of the description hold its pose: no joint turns by more than the ground yields
            assert!(
                (load - plane).abs() < 1e-3 * model.weight(),
                "{name}: {load} {plane}"
            );
        }
        let margins = stability_margins(&model, 0.0, 0.0);
        assert!(
            (found.margins.tip_over - margins.tip_over).abs() < 1e-4,
            "{name}"
        );
        assert!(
            (found.margins.horizontal - margins.horizontal).abs() < 1e-4,
            "{name}"
        );
    }
}

/// Both front wheels on a step of height h: rockers and chassis turn as one by asin(h/L), and the loads are those of
/// a rigid beam: front share = (x_g cos δ − z_g sin δ)/(L cos δ) + 1/2, z_g above the pivots' height.
#[test]
fn a_step_across_both_rockers_turns_the_whole_robot() {
    let (x_g, z_g) = (0.05, 0.12);
    let model = rockers([x_g, 0.0, 0.15 + z_g]);
    for h in [-0.2_f64, -0.05, 0.1, 0.25] {
        let found = on(&model, &[h, h, 0.0, 0.0]);
        let delta = (h / 0.6).asin();
        assert!(
            (found.pitch - delta).abs() < 1e-6,
            "{} {delta}",
            found.pitch
        );
        let arm = (x_g * delta.cos() - z_g * delta.sin()) / (0.6 * delta.cos());
        let weight = 10.0 * EARTH_GRAVITY_M_PER_S2;
        let expected =
            [0.5 + arm, 0.5 + arm, 0.5 - arm, 0.5 - arm].map(|share| 0.5 * share * weight);
        for (load, expected) in found.loads.iter().zip(expected) {
            // five parts of a gram aside
            assert!((load - expected).abs() < 0.03, "{h}: {load} {expected}");
        }
    }
}

/// One front wheel on a stone: that rocker turns by about h/L, the differential gives the chassis half of it, and the
/// roll is that of pivots h/2 apart. To second order in h, which is what the tolerance allows.
#[test]
fn the_differential_halves_what_one_wheel_climbs() {
    let (x_g, z_g) = (0.04, 0.10);
    let model = rockers([x_g, 0.0, 0.15 + z_g]);
    for h in [0.01, 0.02, 0.04] {
        let found = on(&model, &[h, 0.0, 0.0, 0.0]);
        assert!(
            (found.pitch - 0.5 * h / 0.6).abs() < 3.0 * h * h,
            "{h}: {}",
            found.pitch
        );
        let roll = 0.5 * h / 0.5;
        assert!(
            (found.roll - roll).abs() < 3.0 * h * h,
            "{h}: {}",
            found.roll
        );
        assert!(
            (found.joints[0].abs() - 0.5 * h / 0.6).abs() < 3.0 * h * h,
            "{h}: {:?}",
            found.joints
        );
        // the centre of gravity leans over by roll and pitch: the left side carries less, the front too
        let weight = 10.0 * EARTH_GRAVITY_M_PER_S2;
        let (aside, ahead) = (-z_g * roll, x_g - z_g * 0.5 * h / 0.6);
        let [left, right] = [0.5 + aside / 0.5, 0.5 - aside / 0.5].map(|share| share * weight);
        // the differential hands half of the moment about the pivots to each rocker
        let turn = 0.5 * weight * ahead / 0.6;
        let expected = [
            0.5 * left + turn,
            0.5 * right + turn,
            0.5 * left - turn,
            0.5 * right - turn,
        ];
        for (load, expected) in found.loads.iter().zip(expected) {
            assert!(
                (load - expected).abs() < 1.5 * weight * h * h + 0.05,
                "{h}: {load} {expected}"
            );
        }
    }
}

/// Four wheels on a rigid chassis whose weight lies behind, a front one over a hole: it hangs at its depth, and the
/// moments about the three others give their loads.
#[test]
fn a_rigid_robot_lifts_a_wheel() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots/skid-steer.toml");
    let text = std::fs::read_to_string(root).unwrap();
    let behind = text.replace("cg_x_m = 0.0", "cg_x_m = -0.08");
    assert_ne!(text, behind);
    let model = RobotModel::parse(&Document::from_text("skid.toml", behind).unwrap()).unwrap();
    let names: Vec<&str> = model
        .wheels
        .iter()
        .map(|wheel| wheel.name.as_str())
        .collect();
    assert_eq!(
        names,
        ["front_left", "front_right", "rear_left", "rear_right"]
    );
    let found = on(&model, &[-0.05, 0.0, 0.0, 0.0]);
    let weight = model.weight();
    let mass: f64 = model.linkage.bodies().iter().map(|body| body.mass).sum();
    let cg = model
        .linkage
        .bodies()
        .iter()
        .map(|b| b.mass * b.centre.x)
        .sum::<f64>()
        / mass;
    let [front, rear] = [1, 2].map(|wheel| model.wheels[wheel].centre.x);
    // about the rear axle, then about the robot's middle line
    let right = weight * (cg - rear) / (front - rear);
    let expected = [0.0, right, 0.5 * weight, 0.5 * weight - right];
    for (load, expected) in found.loads.iter().zip(expected) {
        assert!((load - expected).abs() < 1e-3, "{load} {expected}");
    }
    assert!((found.sinkages[0] + 0.05).abs() < 1e-5, "{found:?}");
    // three wheels carry, and the plumb line passes nearer to the edge beside the hole
    assert_eq!(found.margins.edges.len(), 3);
    assert!(found.margins.tip_over < stability_margins(&model, 0.0, 0.0).tip_over);
}

/// The simulated machine on plateaus of the same heights, at rest on sand: its sinkages taken from its wheels' ground,
/// so that the ground is the same for both.
#[test]
fn the_simulated_machine_rests_as_the_statics_say() {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let mut worst = 0.0_f64;
    for (name, heights) in [
        ("five-wheel", vec![0.06, 0.0, 0.0, 0.03, 0.0, 0.0]),
        ("five-wheel", vec![0.0, 0.05, 0.05, 0.0, 0.02, 0.0]),
        ("rocker-bogie", vec![0.05, 0.0, 0.0, 0.0, 0.0, 0.03]),
    ] {
        let model = robot(name);
        let at = (4.0, 0.0);
        let places: Vec<(f64, f64)> = model
            .wheels
            .iter()
            .map(|wheel| (at.0 + wheel.centre.x, at.1 + wheel.centre.y))
            .collect();
        // every node has the height of the nearest wheel's plateau
        let map = HeightMap::from_shape((8.0, 4.0), 0.02, |x, y| {
            let nearest = (0..places.len()).min_by(|a, b| {
                let far = |i: usize| (places[i].0 - x).hypot(places[i].1 - y);
                far(*a).total_cmp(&far(*b))
            });
            heights[nearest.unwrap()]
        })
        .unwrap();
        let mut ground = Ground::new(map, vec![soil]).unwrap();
        let mut vehicle = Vehicle::new(model.clone(), &ground, (at.0, at.1, 0.0), 1e-3).unwrap();
        for _ in 0..6000 {
            vehicle.advance(&mut ground);
        }
        let wheels = vehicle.wheels();
        let state = vehicle.state();
        // the ground as high as it is under the sunken wheels
        let lowest: Vec<f64> = wheels
            .iter()
            .zip(&model.wheels)
            .map(|(now, mount)| now.place.z - mount.wheel.radius())
            .collect();
        let found = on(&model, &lowest);
        for (index, (now, load)) in wheels.iter().zip(&found.loads).enumerate() {
            let off = (now.load.normal - load).abs();
            worst = worst.max(off / model.weight());
            // bearings brace each wheel by 0.02 N m over its radius, a thousandth of the weight
            assert!(
                off < 0.005 * model.weight(),
                "{name} wheel {index}: {} simulated, {load} by statics",
                now.load.normal
            );
        }
        let (roll, pitch, _) = state.attitude.angles();
        assert!((roll - found.roll).abs() < 0.01 && (-pitch - found.pitch).abs() < 0.01);
        assert!(
            (state.joints[0] - found.joints[0]).abs() < 0.01,
            "{:?} {:?}",
            state.joints,
            found.joints
        );
    }
    println!(
        "simulated and static loads differ by at most {:.2} % of the weight",
        100.0 * worst
    );
}

#[test]
fn footings_that_are_none_are_refused() {
    let model = robot("skid-steer");
    for heights in [
        vec![0.0; 3],
        vec![0.0, 0.0, f64::NAN, 0.0],
        vec![0.0, 0.0, 11.0, 0.0],
    ] {
        let footing = Footing {
            heights: &heights,
            stiffness: 1e5,
        };
        assert!(stance(&model, &footing).is_err(), "{heights:?}");
    }
    for stiffness in [0.0, f64::NAN, 1e12] {
        let footing = Footing {
            heights: &[0.0; 4],
            stiffness,
        };
        assert!(stance(&model, &footing).is_err(), "{stiffness}");
    }
}
