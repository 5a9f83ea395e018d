//! Shibly, Iagnemma & Dubowsky 2005: forces in closed form by linear stresses.

use grouser_terra::{Kinematics, RigidWheel, Settings, Slip, WheelOnSoil, catalogue};

/// ∫ f over [a, b] by the midpoint rule: error O(h²), 1e-8 of the integral at 20 000 steps.
fn integral(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let steps = 20_000;
    let h = (b - a) / f64::from(steps);
    (0..steps)
        .map(|i| f(a + (f64::from(i) + 0.5) * h) * h)
        .sum()
}

#[test]
fn the_closed_form_is_the_integral_of_its_straight_lines() {
    for (key, slip) in [("dry-sand", 0.2), ("lunar", 0.5)] {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let (r, b) = (0.125, 0.1);
        let contact =
            WheelOnSoil::new(RigidWheel::new(r, b).unwrap(), soil, Settings::default()).unwrap();
        let motion = Kinematics::straight(Slip::new(slip).unwrap());
        let closed = contact.closed_form_shibly(0.015, &motion).unwrap();
        let point = contact.at_sinkage(0.015, &motion).unwrap();
        let (m, one) = (point.angles.theta_m, point.angles.theta_1);
        let line = |at_exit: f64, at_m: f64, theta: f64| {
            if theta < m {
                at_exit + (at_m - at_exit) * theta / m
            } else {
                at_m * (one - theta) / (one - m)
            }
        };
        let sigma = |theta| line(0.0, point.normal_stress(m), theta);
        let tau = |theta| line(soil.params().cohesion, point.shear_stress(m).0, theta);
        // the pieces apart, so that the midpoint rule keeps its order
        let whole = |f: &dyn Fn(f64) -> f64| integral(0.0, m, f) + integral(m, one, f);
        let force = r * b * whole(&|t| sigma(t) * t.cos() + tau(t) * t.sin());
        let pull = r * b * whole(&|t| tau(t) * t.cos() - sigma(t) * t.sin());
        let torque = r * r * b * whole(&tau);
        assert!((closed.vertical_force / force - 1.0).abs() < 1e-7, "{key}");
        assert!((closed.drawbar_pull - pull).abs() < 1e-7 * force, "{key}");
        assert!((closed.torque / torque - 1.0).abs() < 1e-7, "{key}");
        // and it says how far it is from the stresses as they are
        let off = (closed.vertical_force - point.forces.vertical_force)
            .abs()
            .max((closed.drawbar_pull - point.forces.drawbar_pull).abs())
            .max((closed.torque - point.forces.torque).abs() / r);
        assert_eq!(closed.error, off);
        assert!(
            closed.error < 0.25 * point.forces.vertical_force,
            "{key}: {}",
            closed.error
        );
    }
}
