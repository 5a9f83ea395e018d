//! The laws for soil that is dug, pushed and ploughed: against an independent program, against differences,
//! and that they are off by default.

use grouser_real::{Dual, Real};
use grouser_terra::{
    Angle, Bulldozing, DualInputs, Kinematics, LawChoice, RigidWheel, Settings, ShearLaw, Slip,
    SlipNorm, SlipSinkage, Soil, SoilParams, StressPosition, WheelOnSoil,
};

use crate::loaded::{duals, numbers};

fn sand() -> SoilParams {
    SoilParams {
        n_1: 0.2,
        n_2: 0.29,
        rebound: 0.25,
        unit_weight: Some(13e3),
        rear_driving: 0.4,
        rear_drift: 1.0,
        transport_layer: 0.001,
        laws: LawChoice {
            slip_norm: SlipNorm::Greater,
            slip_sinkage: SlipSinkage::Whole,
            stress_position: StressPosition::Whole,
            shear: Some(ShearLaw::SlipVelocity),
            bulldozing: Some(Bulldozing::Chord),
        },
        ..Soil::bekker(0.0, 8e6, 1.46)
            .cohesion(50.0)
            .phi(Angle::from_deg(29.0))
            .k_shear(0.019)
            .stress_position(0.17, 0.49)
            .params()
            .unwrap()
    }
}

fn on(params: SoilParams) -> WheelOnSoil {
    let wheel = RigidWheel::new(0.058, 0.05).unwrap();
    WheelOnSoil::new(wheel, Soil::new(params).unwrap(), Settings::default()).unwrap()
}

/// Pull, torque, side force and sinkage under 22 N, by SciPy's adaptive quadrature and Brent's method on the
/// formulas as the documentation prints them.
#[test]
fn an_independent_program_finds_the_same() {
    let cosine = 30_f64.to_radians().cos();
    let cases = [
        (
            (cosine, 0.5, 0.5),
            [
                -16.479_822_894_3,
                -0.344_836_017_704,
                13.408_235_613_1,
                0.029_365_080_676_7,
            ],
        ),
        (
            (cosine, 0.5, 2.0),
            [
                -0.666_600_565_512,
                0.437_178_787_519,
                4.694_507_001_54,
                0.024_841_681_541_4,
            ],
        ),
        (
            (1.0, 0.0, 1.6),
            [
                0.779_974_824_884,
                0.378_234_830_272,
                0.0,
                0.018_894_503_404_2,
            ],
        ),
    ];
    for ((v_x, v_y, rim), [pull, torque, side, sinkage]) in cases {
        let motion = Kinematics::from_speeds(v_x, v_y, rim).unwrap();
        let point = on(sand())
            .under_load(22.0, &motion)
            .unwrap()
            .point()
            .unwrap();
        // 1e-9 of the forces, and what that makes of the sinkage
        assert!((point.forces.drawbar_pull - pull).abs() < 1e-7, "{point:?}");
        assert!((point.forces.torque - torque).abs() < 1e-8, "{point:?}");
        assert!((point.side_force + side).abs() < 1e-7, "{point:?}");
        assert!((point.sinkage - sinkage).abs() < 1e-10, "{point:?}");
        assert!(point.forces.lost_work >= 0.0);
    }
}

/// Drifting, and straight ahead braking, where shear along the slip velocity jumps within the contact.
#[test]
fn derivatives_agree_with_differences() {
    for (v_x, v_y, rim) in [(0.8, 0.6, 1.3), (1.0, 0.0, 0.75), (1.0, 0.0, 0.95)] {
        let motion = Kinematics::from_speeds(v_x, v_y, rim).unwrap();
        check_derivatives(sand, &motion);
        check_derivatives(ploughed_sand, &motion);
    }
}

/// The same sand under the laws that level off and plough.
fn ploughed_sand() -> SoilParams {
    SoilParams {
        laws: LawChoice {
            slip_norm: SlipNorm::Root,
            slip_sinkage: SlipSinkage::Ploughing,
            stress_position: StressPosition::Saturating,
            ..sand().laws
        },
        ..sand()
    }
}

/// Forces and sinkage in the slip angle: exact derivatives against differences, at rims slower and faster than the wheel.
#[test]
fn ploughing_has_its_derivative_in_the_slip_angle() {
    let on_soil = on(ploughed_sand());
    for rim in [0.4, 1.0, 4.0] {
        let at = |beta: f64| {
            let motion = Kinematics::from_speeds(beta.cos(), beta.sin(), rim).unwrap();
            let point = on_soil.under_load(22.0, &motion).unwrap().point().unwrap();
            [point.sinkage, point.forces.drawbar_pull, point.side_force]
        };
        let (beta, step) = (0.6_f64, 1e-5);
        let motion = Kinematics::from_speeds(beta.cos(), beta.sin(), rim).unwrap();
        let mut inputs = DualInputs::<1>::new(&on_soil, &motion);
        let turned = Dual::<1>::variable(beta, 0);
        let (forward, speed) = (turned.cos(), Dual::constant(rim));
        inputs.motion.slip_angle = turned;
        inputs.motion.q_y = turned.sin() / speed;
        inputs.motion.slip = if forward.value < rim {
            Dual::constant(1.0) - forward / speed
        } else {
            speed / forward - Dual::constant(1.0)
        };
        let exact = inputs
            .under_load(&on_soil, &motion, Dual::constant(22.0))
            .unwrap()
            .unwrap();
        let exact = [exact.sinkage, exact.forces.drawbar_pull, exact.side_force];
        let (high, low) = (at(beta + step), at(beta - step));
        for (row, dual) in exact.iter().enumerate() {
            let difference = (high[row] - low[row]) / (2.0 * step);
            let off = (dual.gradient[0] - difference).abs();
            let slack = 1e-9 * 22.0 / step + 1e-6 * difference.abs();
            assert!(off < slack, "{rim} {row}: {off} {slack}");
        }
    }
}

/// A drifting wheel ploughs over its way: nothing has an edge as the rim speeds up, slows down or stops, and a wheel that
/// spins on the spot or stands across has numbers.
#[test]
fn ploughing_is_continuous() {
    let soil = ploughed_sand();
    let n = |v_x: f64, v_y: f64, rim: f64| {
        let motion = Kinematics::from_speeds(v_x, v_y, rim).unwrap().motion();
        Soil::new(soil).unwrap().laws::<f64>().exponent_at(&motion)
    };
    for (v_x, v_y, rim) in [
        (0.8, 0.6, 0.0),
        (0.8, 0.6, 1.0),
        (1.0, 0.0, 1.0),
        (0.0, 1.0, 1.0),
    ] {
        let here = n(v_x, v_y, rim);
        for (a, b, c) in [(1e-9, 0.0, 0.0), (0.0, 1e-9, 0.0), (0.0, 0.0, 1e-9)] {
            assert!(
                (n(v_x + a, v_y + b, rim + c) - here).abs() < 1e-8,
                "{v_x} {v_y} {rim}"
            );
        }
    }
    let spinning = n(1e-12, 1e-12, 1.0);
    assert!((spinning - n(1e-15, 0.0, 1.0)).abs() < 1e-4, "{spinning}");
    assert!(n(0.0, 1.0, 10.0) > n(0.0, 1.0, 1e6));
}

/// A parameter's value and how to set it.
type Change = (f64, fn(&mut SoilParams, f64));

fn check_derivatives(sand: fn() -> SoilParams, motion: &Kinematics) {
    let at = |change: &dyn Fn(&mut SoilParams)| {
        let mut params = sand();
        change(&mut params);
        numbers(&on(params), 22.0, motion)
    };
    let changes: [Change; 6] = [
        (sand().n_1, |p, x| p.n_1 = x),
        (sand().n_2, |p, x| p.n_2 = x),
        (sand().c_2, |p, x| p.c_2 = x),
        (sand().rear_driving, |p, x| p.rear_driving = x),
        (sand().rear_drift, |p, x| p.rear_drift = x),
        (sand().transport_layer, |p, x| p.transport_layer = x),
    ];
    let wheel_on_soil = on(sand());
    let mut inputs = DualInputs::<6>::new(&wheel_on_soil, motion);
    inputs.soil.exponent.n_1 = Dual::variable(changes[0].0, 0);
    inputs.soil.exponent.n_2 = Dual::variable(changes[1].0, 1);
    inputs.soil.c_2 = Dual::variable(changes[2].0, 2);
    inputs.soil.rear_driving = Dual::variable(changes[3].0, 3);
    inputs.soil.rear_drift = Dual::variable(changes[4].0, 4);
    inputs.soil.transport_layer = Dual::variable(changes[5].0, 5);
    let exact = duals(&inputs, (&wheel_on_soil, motion), Dual::constant(22.0));
    for (column, (value, set)) in changes.into_iter().enumerate() {
        let step = 1e-4 * value;
        let high = at(&|p| set(p, value + step));
        let low = at(&|p| set(p, value - step));
        for (row, dual) in exact.iter().enumerate() {
            let difference = (high[row] - low[row]) / (2.0 * step);
            // the difference's own error: 1e-9 of a force over the step, and its square
            let slack = 1e-9 * 22.0 / step + 1e-6 * difference.abs();
            let off = (dual.gradient[column] - difference).abs();
            assert!(off < slack, "{row} {column}: {off} {slack}");
        }
    }
}

#[test]
fn straight_ahead_the_whole_slip_is_the_slip() {
    let plain = SoilParams {
        laws: LawChoice::default(),
        rear_drift: 0.0,
        ..sand()
    };
    let whole = SoilParams {
        laws: LawChoice {
            slip_norm: SlipNorm::Greater,
            slip_sinkage: SlipSinkage::Whole,
            stress_position: StressPosition::Whole,
            ..LawChoice::default()
        },
        ..sand()
    };
    for slip in [0.0, 0.2, 0.6] {
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let a = on(plain)
            .under_load(22.0, &motion)
            .unwrap()
            .point()
            .unwrap();
        let b = on(whole)
            .under_load(22.0, &motion)
            .unwrap()
            .point()
            .unwrap();
        assert!((a.sinkage - b.sinkage).abs() < 1e-14);
    }
}

#[test]
fn a_drifting_wheel_sinks_more_and_loses_its_rear() {
    let at = |beta: f64| {
        let (v_y, v_x) = beta.to_radians().sin_cos();
        let motion = Kinematics::from_speeds(v_x, v_y, 1.0).unwrap();
        on(sand())
            .under_load(22.0, &motion)
            .unwrap()
            .point()
            .unwrap()
    };
    let mut before = at(0.0);
    for beta in [10.0, 20.0, 30.0, 40.0] {
        let now = at(beta);
        assert!(now.sinkage > before.sinkage, "{beta}");
        assert!(now.side_force < before.side_force, "{beta}");
        let rear = |p: &grouser_terra::OperatingPoint| p.angles.theta_2 / p.angles.theta_1;
        assert!(rear(&now) > rear(&before), "{beta}");
        before = now;
    }
}

#[test]
fn bad_numbers_are_refused() {
    for bad in [-0.1, f64::NAN] {
        for params in [
            SoilParams {
                rear_driving: bad,
                ..sand()
            },
            SoilParams {
                rear_drift: bad,
                ..sand()
            },
            SoilParams {
                transport_layer: bad,
                ..sand()
            },
        ] {
            assert!(Soil::new(params).is_err());
        }
    }
}
