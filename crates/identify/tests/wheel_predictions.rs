//! Residuals and predictions of wheel tests against the wheel on the soil itself.

use grouser_identify::Parameter;
use grouser_identify::wheel::{
    Fixed, Quantity, Scatter, Support, WheelModel, WheelTest, fitted_range, predict,
};
use grouser_opt::{Jacobian, Model};
use grouser_terra::{
    Angle, Kinematics, OpenSoil, RigidWheel, Settings, ShearLaw, Slip, WheelOnSoil, catalogue,
};

const SCATTER: Scatter = Scatter {
    pull: 0.5,
    side: 0.25,
    torque: 0.05,
    sinkage: 7e-4,
};

fn fixed(shear: ShearLaw, k_shear_side: Option<f64>) -> Fixed {
    let sand = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let mut soil = OpenSoil::from(*sand.params());
    (soil.k_shear_side, soil.unit_weight) = (k_shear_side, Some(15e3));
    soil.laws.shear = Some(shear);
    Fixed {
        wheel: RigidWheel::new(0.125, 0.1).unwrap(),
        soil,
        scatter: SCATTER,
    }
}

/// Loads that are carried, one that buries the hub, sinkages at which the wheel is held; straight ahead and adrift.
fn tests() -> Vec<WheelTest> {
    let supports = [
        Support::Load(60.0),
        Support::Load(1e7),
        Support::Sinkage(0.02),
        Support::Sinkage(0.2),
        Support::Sinkage(0.125),
    ];
    let motion = |slip, degrees| {
        Kinematics::with_slip_angle(Slip::new(slip).unwrap(), Angle::from_deg(degrees)).unwrap()
    };
    supports
        .into_iter()
        .zip([
            motion(0.2, 0.0),
            motion(0.1, 20.0),
            motion(0.3, -15.0),
            motion(0.1, 0.0),
            motion(0.1, 75.0),
        ])
        .map(|(support, kinematics)| WheelTest {
            kinematics,
            support,
            pull: Some(1.0),
            side: Some(2.0),
            torque: Some(0.5),
            sinkage: matches!(support, Support::Load(_)).then_some(0.01),
        })
        .collect()
}

#[test]
fn a_prediction_is_the_wheel_on_its_soil_with_the_datums() {
    let (fixed, tests) = (fixed(ShearLaw::Coupled, None), tests());
    let parameters = [
        Parameter::PullDatum,
        Parameter::SinkageDatum,
        Parameter::named("c_1").unwrap(),
        Parameter::SideDatum,
    ];
    let x = [3.0, 0.004, 0.3, -7.0];
    let said = predict(&fixed, &tests, &parameters, &x).unwrap();
    let mut soil = fixed.soil;
    soil.c_1 = Some(0.3);
    let wheel = WheelOnSoil::new(fixed.wheel, soil.soil().unwrap(), Settings::default()).unwrap();
    for (test, said) in tests.iter().zip(&said) {
        let (point, buried) = match test.support {
            Support::Load(load) => {
                match wheel.under_load(load, &test.kinematics).unwrap().point() {
                    Some(point) => (point, false),
                    None => (
                        wheel
                            .at_sinkage(0.125 * (1.0 - 1e-6), &test.kinematics)
                            .unwrap(),
                        true,
                    ),
                }
            }
            Support::Sinkage(z) if z < 0.125 => {
                (wheel.at_sinkage(z, &test.kinematics).unwrap(), false)
            }
            Support::Sinkage(_) => (
                wheel
                    .at_sinkage(0.125 * (1.0 - 1e-6), &test.kinematics)
                    .unwrap(),
                true,
            ),
        };
        assert_eq!(said.hub_buried, buried);
        for (quantity, wanted) in Quantity::ALL.into_iter().zip([
            point.forces.drawbar_pull + 3.0,
            point.side_force - 7.0,
            point.forces.torque,
            point.sinkage + 0.004,
        ]) {
            let found = said.of(quantity);
            assert!(
                (found - wanted).abs() < 1e-6 * wanted.abs().max(1.0),
                "{quantity:?}: {found} {wanted}"
            );
        }
    }
}

/// The fit minimises what the soil that it writes predicts, whatever of the soil is stated.
#[test]
fn residuals_are_those_of_the_predictions() {
    for (shear, k_shear_side) in [
        (ShearLaw::Coupled, None),
        (ShearLaw::Independent, None),
        (ShearLaw::Independent, Some(0.004)),
    ] {
        let (fixed, tests) = (fixed(shear, k_shear_side), tests());
        let parameters: Vec<Parameter> = Parameter::all().collect();
        let x: Vec<f64> = parameters
            .iter()
            .map(|p| 1.1 * p.bounded(&fixed.soil).start + 1e-3)
            .collect();
        let model = WheelModel::new(fixed, &tests, &parameters);
        assert_eq!(model.count(), 17);
        let said = predict(&fixed, &tests, &parameters, &x).unwrap();
        let mut wanted = Vec::new();
        for (test, said) in tests.iter().zip(&said) {
            for quantity in Quantity::ALL {
                let read = test.read(quantity);
                wanted.extend(read.map(|read| (said.of(quantity) - read) / SCATTER.of(quantity)));
            }
        }
        let (mut values, mut again) = (vec![0.0; 17], vec![0.0; 17]);
        let mut jacobian = Jacobian::zeros(17, x.len());
        model.values(&x, &mut values);
        model.derivatives(&x, &mut again, &mut jacobian);
        for (row, wanted) in wanted.into_iter().enumerate() {
            let close = |found: f64| (found - wanted).abs() < 1e-9 * wanted.abs().max(1.0);
            assert!(
                close(values[row]) && close(again[row]),
                "{row}: {} {} {wanted}",
                values[row],
                again[row]
            );
        }
    }
}

#[test]
fn what_cannot_be_predicted_is_refused() {
    let phi = [Parameter::named("phi_deg").unwrap()];
    let (fixed, tests) = (fixed(ShearLaw::Coupled, None), tests());
    let refused = predict(&fixed, &tests, &phi, &[2.0])
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("predicting wheel tests: ") && refused.contains("phi"),
        "{refused}"
    );
    let model = WheelModel::new(fixed, &tests, &phi);
    let mut values = vec![0.0; model.count()];
    model.values(&[2.0], &mut values);
    assert!(values.iter().all(|value| value.is_nan()));
    let mut negative = tests[0];
    negative.support = Support::Load(-1.0);
    let refused = predict(&fixed, &[negative], &phi, &[0.5])
        .unwrap_err()
        .to_string();
    assert!(refused.contains("load"), "{refused}");
}

#[test]
fn the_fitted_range_spans_the_tests() {
    let wheel = RigidWheel::new(0.125, 0.1).unwrap();
    assert_eq!(fitted_range(&wheel, &[]), None);
    let mut tests = tests();
    let range = fitted_range(&wheel, &tests).unwrap();
    let close = |found: (f64, f64), low: f64, high: f64| {
        (found.0 - low).abs() < 1e-12 && (found.1 - high).abs() < 1e-12
    };
    assert!(close(range.slip, 0.1, 0.3) && close(range.slip_angle, 0.0, 75_f64.to_radians()));
    // held at a sinkage any load counts
    assert!(range.width == (0.1, 0.1) && range.load.0 == 0.0 && range.load.1 > 1e10);
    tests.truncate(2);
    assert_eq!(fitted_range(&wheel, &tests).unwrap().load, (60.0, 1e7));
}

#[test]
fn quantities_have_their_names_and_units() {
    let rows = Quantity::ALL.map(|q| (q.key(), q.unit(), q.scale(), SCATTER.of(q)));
    assert_eq!(
        rows,
        [
            ("pull", "N", 1.0, 0.5),
            ("side_force", "N", 1.0, 0.25),
            ("torque", "N m", 1.0, 0.05),
            ("sinkage", "mm", 1e-3, 7e-4)
        ]
    );
}
