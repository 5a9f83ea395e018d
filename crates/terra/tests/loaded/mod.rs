//! What a wheel does under a load that the soil carries: sinkage, drawbar pull, torque and side force.

use grouser_real::Dual;
use grouser_terra::{DualInputs, Kinematics, WheelOnSoil};

pub(crate) fn numbers(on_soil: &WheelOnSoil, load: f64, motion: &Kinematics) -> [f64; 4] {
    let solution = on_soil.under_load(load, motion).unwrap();
    let point = solution.point().unwrap();
    let forces = point.forces;
    [
        point.sinkage,
        forces.drawbar_pull,
        forces.torque,
        point.side_force,
    ]
}

/// With their derivatives in the variables of `inputs` and of `load`.
pub(crate) fn duals<const N: usize>(
    inputs: &DualInputs<N>,
    (on_soil, motion): (&WheelOnSoil, &Kinematics),
    load: Dual<N>,
) -> [Dual<N>; 4] {
    let solved = inputs.under_load(on_soil, motion, load).unwrap().unwrap();
    let forces = solved.forces;
    [
        solved.sinkage,
        forces.drawbar_pull,
        forces.torque,
        solved.side_force,
    ]
}
