//! Kane's equations of the linkage, assembled and solved.

use super::{BodyState, Linkage, MAX_FREEDOMS, MAX_SPEEDS, Pose, Speeds, pitched};
use crate::vector::{Tensor, Vector};

/// Rows of the equations that are left once the velocity's are solved.
const MAX_ROWS: usize = 3 + MAX_FREEDOMS;

impl Linkage {
    /// Accelerations under `forces` and gravity, with `added` inertia (kg m²) on the freedoms.
    ///
    /// With h = Σ m r, J = Σ (I + m r²) about the origin and L_k, A_k the momentum and the angular momentum that the rate of
    /// freedom k gives, the rows of the chassis' velocity are m v̇ + ω̇ × h + Σ L_k q̈_k = F. They are solved for v̇ first, which
    /// leaves three rows about the centre of gravity and one for each freedom.
    #[must_use]
    pub fn accelerate(
        &self,
        state: &BodyState,
        pose: &Pose,
        forces: &Speeds,
        added: &[f64; MAX_FREEDOMS],
    ) -> Speeds {
        let freedoms = self.freedoms();
        let (turning, velocity) = (state.turning(), state.velocity());
        let down = state.attitude.to_robot(Vector::AXES[2] * -self.gravity);
        let free = down - turning.cross(velocity);
        let mut right = [0.0; MAX_ROWS];
        let mut matrix = [[0.0; MAX_ROWS]; MAX_ROWS];
        let mut columns = [(Vector::ZERO, Vector::ZERO); MAX_FREEDOMS];
        let (mut first, mut second) = (Vector::ZERO, Tensor::default());
        let mut force = Vector::new(forces[3], forces[4], forces[5]);
        let mut moment = Vector::new(forces[0], forces[1], forces[2]);
        right[3..].copy_from_slice(&forces[6..]);
        for body in &self.joined {
            let at = self.point(pose, body.link, body.centre);
            let mut inertia = body.inertia;
            let mut spin = turning;
            let mut bias = turning.cross(turning.cross(at));
            let mut turn_bias = Vector::ZERO;
            if let Some(index) = body.link {
                let link = &pose.links[index];
                inertia = pitched(&body.inertia, link.trigonometry);
                let about = Vector::AXES[1] * link.rate;
                spin += about;
                turn_bias = turning.cross(about);
                bias += turning.cross(link.velocity_at(at)) * 2.0 + link.acceleration_at(at);
            }
            let own_force = (free - bias) * body.mass;
            let own_moment = -(inertia.times(turn_bias) + spin.cross(inertia.times(spin)));
            first += at * body.mass;
            second = second
                .plus(inertia, 1.0)
                .plus(Tensor::of_point(body.mass, at), 1.0);
            force += own_force;
            moment += at.cross(own_force) + own_moment;
            let about_y = Vector::new(inertia.products.z, inertia.diagonal.y, inertia.products.x);
            for (i, (freedom, linear, sign)) in self.chain(pose, body.link, at).enumerate() {
                right[3 + freedom] += linear.dot(own_force) + sign * own_moment.y;
                let heavy = linear * body.mass;
                columns[freedom].0 += heavy;
                columns[freedom].1 += at.cross(heavy) + about_y * sign;
                let chain = self.chain(pose, body.link, at).take(i + 1);
                for (j, (other, also, other_sign)) in chain.enumerate() {
                    let value = heavy.dot(also) + sign * other_sign * about_y.y;
                    let (low, high) = (freedom.min(other), freedom.max(other));
                    // a differential may join links of one chain: both orders of the pair count then
                    let times = if other == freedom && j < i { 2.0 } else { 1.0 };
                    matrix[3 + high][3 + low] += times * value;
                }
            }
        }
        let per_mass = 1.0 / self.mass;
        let centre = first * per_mass;
        let about_centre = second.plus(Tensor::of_point(self.mass, centre), -1.0);
        let (d, p) = (about_centre.diagonal, about_centre.products);
        matrix[0][0] = d.x;
        (matrix[1][0], matrix[1][1]) = (p.z, d.y);
        (matrix[2][0], matrix[2][1], matrix[2][2]) = (p.y, p.x, d.z);
        let moment = moment - centre.cross(force);
        (right[0], right[1], right[2]) = (moment.x, moment.y, moment.z);
        for i in 0..freedoms {
            let (linear, angular) = columns[i];
            let angular = angular - centre.cross(linear);
            let row = &mut matrix[3 + i];
            (row[0], row[1], row[2]) = (angular.x, angular.y, angular.z);
            for j in 0..=i {
                row[3 + j] -= linear.dot(columns[j].0) * per_mass;
            }
            row[3 + i] += added[i];
            right[3 + i] -= linear.dot(force) * per_mass;
        }
        solve(&mut matrix, &mut right, 3 + freedoms);
        let turned = Vector::new(right[0], right[1], right[2]);
        let mut moved = force * per_mass - turned.cross(centre);
        for i in 0..freedoms {
            moved += columns[i].0 * (-right[3 + i] * per_mass);
        }
        let mut rates = [0.0; MAX_SPEEDS];
        for axis in 0..3 {
            rates[axis] = turned[axis];
            rates[3 + axis] = moved[axis];
        }
        rates[6..].copy_from_slice(&right[3..]);
        rates
    }
}

/// Solves a symmetric positive definite system in place by elimination without square roots; the lower triangle is given.
#[allow(
    clippy::needless_range_loop,
    reason = "indices name rows and columns of one matrix"
)]
pub(crate) fn solve<const N: usize>(matrix: &mut [[f64; N]; N], right: &mut [f64; N], size: usize) {
    let mut per_pivot = [0.0; N];
    for k in 0..size.min(N) {
        // masses are positive, so that only rounding could bring it to 0
        per_pivot[k] = 1.0 / matrix[k][k].max(f64::MIN_POSITIVE);
        for i in k + 1..size.min(N) {
            let factor = matrix[i][k] * per_pivot[k];
            for j in k + 1..=i {
                matrix[i][j] -= factor * matrix[j][k];
            }
            right[i] -= factor * right[k];
        }
    }
    for k in (0..size.min(N)).rev() {
        let mut sum = right[k];
        for i in k + 1..size.min(N) {
            sum -= matrix[i][k] * right[i];
        }
        right[k] = sum * per_pivot[k];
    }
}
