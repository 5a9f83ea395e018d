//! The scene by our linkage: the step of `Vehicle`, without its wheels.

use grouser_rover::body::Leapfrog;
use grouser_rover::vector::Vector;

use crate::scene::{Positions, Scene, start};

pub fn run(scene: &Scene, step: f64) -> Positions {
    let linkage = &scene.model.linkage;
    let mut state = start();
    let mut pose = linkage.pose(&state);
    let mut leapfrog = Leapfrog::default();
    let steps = (scene.duration / step).round() as u64;
    let (force, moment, time) = scene.push;
    let pushed = (time / step).round() as u64;
    for number in 0..steps {
        let mut forces = [0.0; grouser_rover::body::MAX_SPEEDS];
        if number <= pushed {
            // the push ends at this time: the mean of before and after
            let share = if number < pushed { 1.0 } else { 0.5 };
            // at the centre of the chassis' mass
            let at = linkage.bodies()[0].centre;
            let (force, moment) = (
                state.attitude.to_robot(force) * share,
                state.attitude.to_robot(moment) * share,
            );
            linkage.push(&pose, &mut forces, (None, at), force, moment);
        }
        if let Some((stiffness, damping)) = scene.springs {
            for wheel in &scene.model.wheels {
                let at = linkage.point(&pose, wheel.link, wheel.centre);
                let height = (state.position + state.attitude.to_world(at)).z - wheel.centre.z;
                let velocity = linkage.velocity(&state.speeds, &pose, wheel.link, at);
                let rising = state.attitude.to_world(velocity).z;
                let up = Vector::AXES[2] * -(stiffness * height + damping * rising);
                let force = state.attitude.to_robot(up);
                linkage.push(&pose, &mut forces, (wheel.link, at), force, Vector::ZERO);
            }
        }
        leapfrog.step(linkage, &mut state, &mut pose, forces, step);
    }
    let (x, y, z) = (Vector::AXES[0], Vector::AXES[1], Vector::AXES[2]);
    let turned = [x, y, z].map(|axis| state.attitude.to_world(axis));
    let place = state.position;
    let centre = place + state.attitude.to_world(linkage.centre(&pose));
    Positions {
        centre: [centre.x, centre.y, centre.z],
        place: [place.x, place.y, place.z],
        attitude: quaternion(turned),
        joints: state.joints[..linkage.freedoms()].to_vec(),
    }
}

/// Of the turned axes (columns of the rotation matrix); the sign is that of w.
fn quaternion([x, y, z]: [Vector; 3]) -> [f64; 4] {
    let rotation =
        rapier3d_f64::glamx::DMat3::from_cols_array(&[x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z]);
    let found = rapier3d_f64::glamx::DQuat::from_mat3(&rotation);
    let sign = if found.w < 0.0 { -1.0 } else { 1.0 };
    [found.x, found.y, found.z, found.w].map(|part| sign * part)
}
