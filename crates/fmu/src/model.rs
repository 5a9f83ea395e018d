//! A wheel on a soil as a function of the unit's inputs.

use grouser_real::{Dual, Real};
use grouser_terra::{
    Angle, Cautions, DualInputs, Kinematics, LoadOutcome, RigidWheel, Settings, Slip, Soil,
    SolveStatus, WheelOnSoil,
};

use crate::error::Result;
use crate::variables::{INPUTS, OUTPUTS};

/// Load (N), slip and slip angle (degrees), in the order of [`VARIABLES`](crate::VARIABLES).
pub type Inputs = [f64; INPUTS];

/// Slip angle in degrees at which the derivatives of a wheel that runs straight ahead are taken: the side force changes its
/// sign at 0. The derivatives differ by that of 2e-11 rad, less than the rounding of the forces.
const STRAIGHT_DEG: f64 = 1e-9;

/// The outputs at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Outputs {
    /// Sinkage (m), drawbar pull (N), side force (N) and torque (N m), in the order of [`VARIABLES`](crate::VARIABLES); NaN
    /// unless the status is `Solved`.
    pub numbers: [f64; OUTPUTS],
    /// How the solve ended.
    pub status: SolveStatus,
    /// What to keep in mind.
    pub cautions: Cautions,
}

/// One wheel on one soil, with the inputs that it starts with.
///
/// ```
/// use grouser_fmu::Model;
/// use grouser_terra::{RigidWheel, catalogue};
///
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let model = Model::new(RigidWheel::new(0.125, 0.1)?, soil, [80.0, 0.2, 0.0])?;
/// let [_, pull, ..] = model.outputs(&model.start).numbers;
/// let [_, by_slip, ..] = model.derivatives(&model.start).expect("solved")[1];
/// let ahead = model.outputs(&[80.0, 0.2 + 1e-6, 0.0]).numbers[1];
/// assert!((pull + 1e-6 * by_slip - ahead).abs() < 1e-8);
/// # Ok::<(), grouser_fmu::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Model {
    /// The inputs at the start.
    pub start: Inputs,
    pair: WheelOnSoil,
}

impl Model {
    /// A wheel on a soil.
    ///
    /// # Errors
    /// What [`WheelOnSoil::new`] refuses, and a start outside the limits of the inputs.
    pub fn new(wheel: RigidWheel, soil: Soil, start: Inputs) -> Result<Self> {
        let pair = WheelOnSoil::new(wheel, soil, Settings::default())?;
        motion(&start)?;
        pair.under_load(start[0], &motion(&start)?)?;
        Ok(Self { start, pair })
    }

    /// The wheel on the soil.
    #[must_use]
    pub const fn pair(&self) -> &WheelOnSoil {
        &self.pair
    }

    /// The outputs: those of the verb `wheel`, bit for bit.
    #[must_use]
    pub fn outputs(&self, inputs: &Inputs) -> Outputs {
        let solved = motion(inputs)
            .and_then(|motion| self.pair.under_load(inputs[0], &motion))
            .map(|solution| solution.outcome);
        match solved {
            Ok(LoadOutcome::Solved(point)) => Outputs {
                numbers: [
                    point.sinkage,
                    point.forces.drawbar_pull,
                    point.side_force,
                    point.forces.torque,
                ],
                status: SolveStatus::Solved,
                cautions: point.cautions,
            },
            Ok(other) => unsolved(other.status()),
            Err(_) => unsolved(SolveStatus::BadInput),
        }
    }

    /// The derivatives of each output in each input, exact to the rounding of the forces; `None` where there is no solution, for
    /// a load of 0, at which the sinkage has no derivative, and for a locked wheel, which has no speed ratio.
    #[must_use]
    pub fn derivatives(&self, inputs: &Inputs) -> Option<[[f64; INPUTS]; OUTPUTS]> {
        let [load, slip, degrees] = *inputs;
        let degrees = if degrees == 0.0 {
            STRAIGHT_DEG
        } else {
            degrees
        };
        let kinematics = motion(&[load, slip, degrees]).ok()?;
        let ratio = kinematics.slip().speed_ratio();
        if !ratio.is_finite() {
            return None;
        }
        let mut dual = DualInputs::<INPUTS>::new(&self.pair, &kinematics);
        let angle = Dual::variable(degrees.to_radians(), 2);
        // q of the slip, and q_y = q tan β
        let per_slip = if slip >= 0.0 { -1.0 } else { -ratio * ratio };
        let mut q = Dual::<INPUTS>::constant(ratio);
        q.gradient[1] = per_slip;
        dual.motion.slip = Dual::variable(slip, 1);
        dual.motion.slip_angle = angle;
        dual.motion.q_y = q * Real::tan(angle);
        let solved = dual
            .under_load(&self.pair, &kinematics, Dual::variable(load, 0))
            .ok()??;
        let numbers = [
            solved.sinkage,
            solved.forces.drawbar_pull,
            solved.side_force,
            solved.forces.torque,
        ];
        let radians_per_degree = 1.0_f64.to_radians();
        Some(numbers.map(|number| {
            let [by_load, by_slip, by_angle] = number.gradient;
            [by_load, by_slip, by_angle * radians_per_degree]
        }))
    }
}

fn unsolved(status: SolveStatus) -> Outputs {
    Outputs {
        numbers: [f64::NAN; OUTPUTS],
        status,
        cautions: Cautions::default(),
    }
}

/// The motion of inputs.
fn motion([_, slip, degrees]: &Inputs) -> grouser_terra::Result<Kinematics> {
    let slip = Slip::new(*slip)?;
    if *degrees == 0.0 {
        return Ok(Kinematics::straight(slip));
    }
    Kinematics::with_slip_angle(slip, Angle::from_deg(*degrees))
}
