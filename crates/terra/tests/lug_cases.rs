//! Lugs, the root norm of the slip velocity and slip-sinkage that levels off or ploughs against 30-digit quadrature of
//! the formulas as the documentation prints them (`oracle/law_cases.csv` and `oracle/ploughing_cases.csv`, mpmath with 40
//! digits: split at θ_m, at every sign change of the rim's speed and of the displacement, and at more places).

use grouser_real::Dual;
use grouser_terra::{
    Accuracy, Angle, DualInputs, GrouserRule, Grousers, Kinematics, LawChoice, RigidWheel,
    Settings, ShearLaw, Slip, SlipNorm, SlipSinkage, Soil, SoilParams, StressPosition, WheelOnSoil,
};

use crate::loaded::{duals, numbers};

struct Case {
    on_soil: WheelOnSoil,
    motion: Kinematics,
    sinkage: f64,
    /// Vertical force, pull, torque, side force by shear.
    expected: [f64; 4],
    name: String,
}

fn cases(accuracy: Accuracy) -> Vec<Case> {
    let laws = (SlipSinkage::Saturating, StressPosition::Sliding);
    let cases = read(include_str!("oracle/law_cases.csv"), laws, accuracy);
    assert_eq!(cases.len(), 22);
    cases
}

/// With slip-sinkage that ploughs and a place of the greatest stress that levels off; locked wheels among them.
fn ploughing_cases(accuracy: Accuracy) -> Vec<Case> {
    let laws = (SlipSinkage::Ploughing, StressPosition::Saturating);
    let cases = read(include_str!("oracle/ploughing_cases.csv"), laws, accuracy);
    assert_eq!(cases.len(), 15);
    cases
}

fn read(
    text: &str,
    (slip_sinkage, stress_position): (SlipSinkage, StressPosition),
    accuracy: Accuracy,
) -> Vec<Case> {
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let of = |name: &str| -> f64 {
                let place = header.iter().position(|column| *column == name).unwrap();
                cells[place].parse().unwrap()
            };
            let soil = SoilParams {
                n_1: of("n_1"),
                n_2: of("n_2"),
                rebound: of("rebound"),
                rear_driving: of("rear_driving"),
                rear_drift: of("rear_drift"),
                laws: LawChoice {
                    slip_norm: SlipNorm::Root,
                    slip_sinkage,
                    stress_position,
                    shear: Some(ShearLaw::SlipVelocity),
                    bulldozing: None,
                },
                ..Soil::bekker(
                    1e3 * of("k_c_kn_per_m_n1"),
                    1e3 * of("k_phi_kn_per_m_n2"),
                    of("n"),
                )
                .cohesion(1e3 * of("cohesion_kpa"))
                .phi(Angle::from_deg(of("phi_deg")))
                .k_shear(of("k_shear_m"))
                .stress_position(of("c_1"), of("c_2"))
                .params()
                .unwrap()
            };
            let rule = GrouserRule::Lugs {
                count: of("grouser_count"),
                thickness: of("grouser_thickness_m"),
            };
            let wheel = RigidWheel::new(of("radius_m"), of("width_m"))
                .unwrap()
                .with_grousers(Grousers {
                    height: of("grouser_height_m"),
                    rule,
                })
                .unwrap();
            let settings = Settings {
                accuracy,
                ..Settings::default()
            };
            Case {
                on_soil: WheelOnSoil::new(wheel, Soil::new(soil).unwrap(), settings).unwrap(),
                motion: Kinematics::from_speeds(of("v_x"), of("v_y"), of("rim")).unwrap(),
                sinkage: of("sinkage_m"),
                expected: [
                    of("vertical_force_n"),
                    of("drawbar_pull_n"),
                    of("torque_nm"),
                    of("side_shear_n"),
                ],
                name: line.to_owned(),
            }
        })
        .collect()
}

/// The worst error over all cases, over max(|W|, |DP|, |T|/r).
fn worst(cases: Vec<Case>) -> (f64, String) {
    let mut worst = (0.0, String::new());
    for case in cases {
        let forces = case.on_soil.forces_at(case.sinkage, &case.motion).unwrap();
        let radius = case.on_soil.wheel().radius();
        let got = [
            forces.vertical_force,
            forces.drawbar_pull,
            forces.torque / radius,
            forces.side_shear,
        ];
        let [w, pull, torque, side] = case.expected;
        let expected = [w, pull, torque / radius, side];
        let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (got, expected) in got.iter().zip(expected) {
            let off = (got - expected).abs() / size;
            if off > worst.0 {
                worst = (off, case.name.clone());
            }
        }
    }
    worst
}

#[test]
fn forces_are_those_of_the_quadrature() {
    for of in [cases, ploughing_cases] {
        let (off, name) = worst(of(Accuracy::Standard));
        assert!(off < 1e-9, "{off:e} {name}");
        let (off, name) = worst(of(Accuracy::Reference));
        assert!(off < 1e-12, "{off:e} {name}");
    }
}

/// The sizes of lugs as dual numbers: height, count and thickness, in every force under a load, where shear turns
/// within the contact too.
#[test]
fn derivatives_in_the_lugs_agree_with_differences() {
    let sizes = [0.005, 24.0, 0.0015];
    let on = |sizes: [f64; 3]| {
        let [height, count, thickness] = sizes;
        let rule = GrouserRule::Lugs { count, thickness };
        let wheel = RigidWheel::new(0.058, 0.05)
            .unwrap()
            .with_grousers(Grousers { height, rule })
            .unwrap();
        let soil = *cases(Accuracy::Standard)[0].on_soil.soil();
        WheelOnSoil::new(wheel, soil, Settings::default()).unwrap()
    };
    for (v_x, v_y, rim) in [(1.0, 0.0, 1.5), (0.8, 0.6, 1.5), (1.0, 0.0, 0.75)] {
        let motion = Kinematics::from_speeds(v_x, v_y, rim).unwrap();
        let wheel_on_soil = on(sizes);
        let mut inputs = DualInputs::<3>::new(&wheel_on_soil, &motion);
        let size = grouser_terra::WheelSize::smooth(Dual::constant(0.058), Dual::constant(0.05));
        inputs.size = size.with_lugs(
            Dual::variable(sizes[0], 0),
            Dual::variable(sizes[1], 1),
            Dual::variable(sizes[2], 2),
        );
        let exact = duals(&inputs, (&wheel_on_soil, &motion), Dual::constant(22.0));
        for column in 0..3 {
            let step = 1e-4 * sizes[column];
            let at = |change: f64| {
                let mut moved = sizes;
                moved[column] += change;
                numbers(&on(moved), 22.0, &motion)
            };
            let (high, low) = (at(step), at(-step));
            for (row, dual) in exact.iter().enumerate() {
                let difference = (high[row] - low[row]) / (2.0 * step);
                let slack = 1e-9 * 22.0 / step + 1e-6 * difference.abs();
                let off = (dual.gradient[column] - difference).abs();
                assert!(off < slack, "{rim} {row} {column}: {off:e} {slack:e}");
            }
        }
    }
}

/// What lugs do and do not: nothing when braking straight ahead behind the turning point, more pull and more
/// sinkage when driving, and no height is no lug.
#[test]
fn lugs_add_pull_and_sinkage_when_driving() {
    let all = cases(Accuracy::Standard);
    let bare = |case: &Case| {
        let (r, b) = (case.on_soil.wheel().radius(), case.on_soil.wheel().width());
        WheelOnSoil::new(
            RigidWheel::new(r, b).unwrap(),
            *case.on_soil.soil(),
            Settings::default(),
        )
        .unwrap()
    };
    let lugged = all
        .iter()
        .find(|case| case.on_soil.wheel().grousers().unwrap().height > 0.0)
        .unwrap();
    let at = |on: &WheelOnSoil, slip: f64| {
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let solved = on.under_load(24.0, &motion).unwrap();
        solved.point().unwrap()
    };
    let smooth = bare(lugged);
    let (with, without) = (at(&lugged.on_soil, 0.5), at(&smooth, 0.5));
    assert!(with.sinkage > without.sinkage + 1e-3);
    assert!(with.forces.drawbar_pull > without.forces.drawbar_pull + 0.5);
    assert!(with.forces.lost_work > 0.0);
    let (with, without) = (at(&lugged.on_soil, -0.6), at(&smooth, -0.6));
    assert!((with.sinkage - without.sinkage).abs() < 1e-12);
    // steps in time know lugs too
    let mut params = *lugged.on_soil.soil().params();
    params.laws.shear = Some(ShearLaw::Coupled);
    let soil = Soil::new(params).unwrap();
    let settings = Settings {
        accuracy: Accuracy::Simulation,
        ..Settings::default()
    };
    let quick = WheelOnSoil::new(*lugged.on_soil.wheel(), soil, settings).unwrap();
    let exact = quick.with_accuracy(Accuracy::Reference);
    for slip in [0.5, 0.05, -0.03, -0.4] {
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let at = |on_soil: &WheelOnSoil| on_soil.forces_at(0.01, &motion).unwrap();
        let (quick, exact) = (at(&quick), at(&exact));
        let off = (quick.drawbar_pull - exact.drawbar_pull).abs();
        assert!(
            off < 1e-6 * exact.vertical_force.abs().max(exact.drawbar_pull.abs()),
            "{slip} {off:e}"
        );
    }
    // the mean of the passage over one spacing is what the rim carries spread out
    let passage = lugged
        .on_soil
        .lug_passage(&at(&lugged.on_soil, 0.5))
        .unwrap();
    assert!(passage.pull > 0.0 && passage.torque > 0.0 && passage.in_soil > 1.0);
    assert!(smooth.lug_passage(&at(&smooth, 0.5)).is_none());
}

/// At 60° of drift nothing has an edge where the rim turns as fast as the wheel travels: the second difference of
/// the sinkage over rω/V is no greater there than beside it, and without the root norm it is.
#[test]
fn no_edge_where_the_rim_is_as_fast_as_the_wheel() {
    let soil = *cases(Accuracy::Standard)[0].on_soil.soil();
    let with = |norm: SlipNorm| {
        let params = SoilParams {
            laws: LawChoice {
                slip_norm: norm,
                ..soil.params().laws
            },
            ..*soil.params()
        };
        WheelOnSoil::new(
            RigidWheel::new(0.058, 0.05).unwrap(),
            Soil::new(params).unwrap(),
            Settings::default(),
        )
        .unwrap()
    };
    let bend = |norm: SlipNorm, ratio: f64| {
        let on_soil = with(norm);
        let sinkage = |ratio: f64| {
            let (v_y, v_x) = 60_f64.to_radians().sin_cos();
            let motion = Kinematics::from_speeds(v_x, v_y, ratio).unwrap();
            on_soil
                .sinkage_under(21.0, &motion)
                .unwrap()
                .sinkage()
                .unwrap()
        };
        let step = 0.01;
        (sinkage(ratio + step) - 2.0 * sinkage(ratio) + sinkage(ratio - step)).abs() / step
    };
    // change of slope in m per unit of rω/V
    assert!(
        bend(SlipNorm::Root, 1.0) < 1e-3,
        "{}",
        bend(SlipNorm::Root, 1.0)
    );
    assert!(
        bend(SlipNorm::Greater, 1.0) > 5e-3,
        "{}",
        bend(SlipNorm::Greater, 1.0)
    );
}

/// A side force does not vanish at once where the wheel stops travelling: it is continuous at s = 1.
#[test]
fn the_side_force_is_continuous_at_full_slip() {
    let soil = SoilParams {
        unit_weight: Some(13e3),
        ..*cases(Accuracy::Standard)[0].on_soil.soil().params()
    };
    let wheel = RigidWheel::new(0.058, 0.05).unwrap();
    let on_soil = WheelOnSoil::new(wheel, Soil::new(soil).unwrap(), Settings::default()).unwrap();
    let side = |slip: f64| {
        let slip = Slip::new(slip).unwrap();
        let motion = Kinematics::with_slip_angle(slip, Angle::from_deg(30.0)).unwrap();
        on_soil.at_sinkage(0.02, &motion).unwrap().side_force
    };
    assert!(side(1.0) < -0.5, "{}", side(1.0));
    assert!((side(1.0) - side(1.0 - 1e-9)).abs() < 1e-6);
}

/// Shear along the slip velocity, regularised: no jump of the pull at s = 0 with its slope in slip finite, a side
/// force in proportion to a small slip angle, and otherwise the law that it regularises.
#[test]
fn the_regular_slip_velocity_has_finite_stiffness() {
    let with = |law: ShearLaw| {
        let soil = *cases(Accuracy::Standard)[0].on_soil.soil().params();
        let params = SoilParams {
            laws: LawChoice {
                shear: Some(law),
                ..soil.laws
            },
            ..soil
        };
        WheelOnSoil::new(
            RigidWheel::new(0.058, 0.05).unwrap(),
            Soil::new(params).unwrap(),
            Settings::default(),
        )
        .unwrap()
    };
    let (regular, sharp) = (
        with(ShearLaw::SlipVelocityRegular),
        with(ShearLaw::SlipVelocity),
    );
    let at = |on: &WheelOnSoil, slip: f64, beta_deg: f64| {
        let slip = Slip::new(slip).unwrap();
        let motion = Kinematics::with_slip_angle(slip, Angle::from_deg(beta_deg)).unwrap();
        on.forces_at(0.015, &motion).unwrap()
    };
    // linear in a small slip angle at s = 0, where the sharp law rises like its root
    let ratio = |on: &WheelOnSoil| at(on, 0.0, 0.02).side_shear / at(on, 0.0, 0.01).side_shear;
    assert!((ratio(&regular) - 2.0).abs() < 0.02, "{}", ratio(&regular));
    assert!(ratio(&sharp) < 1.9, "{}", ratio(&sharp));
    // pull per unit of slip below 0: the same from 1e-5 as from 1e-4
    let slope = |on: &WheelOnSoil, slip: f64| {
        (at(on, 0.0, 0.0).drawbar_pull - at(on, -slip, 0.0).drawbar_pull) / slip
    };
    assert!((slope(&regular, 1e-5) / slope(&regular, 1e-4) - 1.0).abs() < 0.05);
    assert!(slope(&sharp, 1e-5) / slope(&sharp, 1e-4) > 2.0);
    for (slip, beta) in [(0.4, 20.0), (-0.5, 20.0), (0.5, 0.0)] {
        let (a, b) = (at(&regular, slip, beta), at(&sharp, slip, beta));
        assert!((a.torque - b.torque).abs() < 0.03 * b.torque.abs().max(0.1));
        assert!(a.lost_work >= 0.0);
    }
}
