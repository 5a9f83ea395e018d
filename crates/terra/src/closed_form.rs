//! Forces in closed form by linear stresses: Shibly, Iagnemma and Dubowsky.

use crate::caution::Caution;
use crate::error::Result;
use crate::kinematics::Kinematics;
use crate::wheel_on_soil::WheelOnSoil;
use grouser_real::Real;

/// Forces by linearised stresses, and how far they are from the integral.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ClosedForm {
    /// Vertical force, N.
    pub vertical_force: f64,
    /// Drawbar pull, N.
    pub drawbar_pull: f64,
    /// Torque, N m.
    pub torque: f64,
    /// Greatest of the errors of vertical force, drawbar pull and torque/r against the integral, N.
    pub error: f64,
    /// Does the shear change its sign in the contact? Then a straight line cannot follow it.
    pub reverses: bool,
}

/// One straight piece of stress between two angles, with its moments in closed form.
struct Straight {
    from: (f64, f64),
    to: (f64, f64),
}

impl Straight {
    /// ∫ y, ∫ y cos θ and ∫ y sin θ over the piece.
    fn moments(&self) -> [f64; 3] {
        let ((a, y_a), (b, y_b)) = (self.from, self.to);
        let length = b - a;
        if !(length > 0.0) {
            return [0.0; 3];
        }
        let slope = (y_b - y_a) / length;
        let ((sin_a, cos_a), (sin_b, cos_b)) = (Real::sin_cos(a), Real::sin_cos(b));
        [
            0.5 * (y_a + y_b) * length,
            y_b * sin_b - y_a * sin_a + slope * (cos_b - cos_a),
            y_a * cos_a - y_b * cos_b + slope * (sin_b - sin_a),
        ]
    }
}

impl WheelOnSoil {
    /// Vertical force, drawbar pull and torque with σ and τ taken as straight lines from the exit by θ_m to
    /// the entry, at the sinkage (m) given.
    ///
    /// σ: 0 at θ_2, σ(θ_m), 0 at θ_1. τ: c at θ_2, τ(θ_m), 0 at θ_1. Source: Shibly, Iagnemma & Dubowsky,
    /// J. Terramechanics 42 (2005) \[Shibly05\], who take θ_2 = 0 and θ_m = θ_1/2; here both are the model's
    /// own. Assumes: driving, shear saturated at the exit. A rough law: see its `error`.
    ///
    /// # Errors
    /// As [`WheelOnSoil::forces_at`].
    pub fn closed_form_shibly(&self, sinkage: f64, kinematics: &Kinematics) -> Result<ClosedForm> {
        let point = self.at_sinkage(sinkage, &Kinematics::straight(kinematics.slip()))?;
        let angles = point.angles;
        let (sigma_m, tau_m) = (
            point.normal_stress(angles.theta_m),
            point.shear_stress(angles.theta_m).0,
        );
        let lines = |at_exit: f64, at_m: f64| {
            let exit = (angles.theta_2, at_exit);
            let top = (angles.theta_m, at_m);
            let rear = Straight {
                from: exit,
                to: top,
            }
            .moments();
            let front = Straight {
                from: top,
                to: (angles.theta_1, 0.0),
            }
            .moments();
            [rear[0] + front[0], rear[1] + front[1], rear[2] + front[2]]
        };
        let [_, sigma_cos, sigma_sin] = lines(0.0, sigma_m);
        let [tau, tau_cos, tau_sin] = lines(self.laws().strength.cohesion, tau_m);
        let (r, b) = (self.size().radius, self.size().width);
        let vertical_force = r * b * (sigma_cos + tau_sin);
        let drawbar_pull = r * b * (tau_cos - sigma_sin);
        let torque = r * r * b * tau;
        let f = point.forces;
        Ok(ClosedForm {
            vertical_force,
            drawbar_pull,
            torque,
            error: (vertical_force - f.vertical_force)
                .abs()
                .max((drawbar_pull - f.drawbar_pull).abs())
                .max((torque - f.torque).abs() / r),
            reverses: point.cautions.contains(Caution::ShearReversal),
        })
    }
}
