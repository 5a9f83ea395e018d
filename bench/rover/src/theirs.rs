//! The scene by rapier: a multibody in reduced coordinates, its joints' springs as moments on the two bodies.

use rapier3d_f64::prelude::*;

use crate::scene::{Positions, Scene};

type Ours = grouser_rover::vector::Vector;

fn glam(v: Ours) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

pub fn run(scene: &Scene, step: f64) -> Positions {
    let linkage = &scene.model.linkage;
    let (mut bodies, mut joints) = (RigidBodySet::new(), MultibodyJointSet::new());
    // Every body's frame stands in its own centre of mass, with the robot's axes. With frames in the robot's origin
    // the root of a multibody falls beside the path of its centre of mass: 0.18 m in a second of free fall.
    let handles: Vec<RigidBodyHandle> = linkage
        .bodies()
        .iter()
        .map(|body| {
            let column = |axis: usize| glam(body.inertia.times(Ours::AXES[axis]));
            let inertia = Matrix::from_cols(column(0), column(1), column(2));
            let mass = MassProperties::with_inertia_matrix(Vector::ZERO, body.mass, inertia);
            let built = RigidBodyBuilder::dynamic()
                .translation(glam(body.centre))
                .additional_mass_properties(mass)
                .can_sleep(false)
                .build();
            bodies.insert(built)
        })
        .collect();
    // bodies stand as chassis, then one for each link
    let number_of = |link: Option<usize>| link.map_or(0, |link| link + 1);
    let carried = |link: Option<usize>| handles[number_of(link)];
    // a point of the description in a body's own frame
    let local = |link: Option<usize>, at: Ours| glam(at - linkage.bodies()[number_of(link)].centre);
    for (index, link) in linkage.links().iter().enumerate() {
        let joint = RevoluteJointBuilder::new(Vector::Y)
            .local_anchor1(local(link.on, link.pivot))
            .local_anchor2(local(Some(index), link.pivot))
            .build();
        let handle = joints.insert(carried(link.on), carried(Some(index)), joint, true);
        let (multibody, _) = joints
            .get_mut(handle.expect("a tree"))
            .expect("it was put in");
        multibody.damping_mut().fill(0.0);
    }
    for (_, body) in bodies.iter_mut() {
        body.enable_gyroscopic_forces(true);
    }
    let parameters = IntegrationParameters {
        dt: step,
        ..IntegrationParameters::default()
    };
    let mut world = World::default();
    let gravity = Vector::new(0.0, 0.0, -grouser_terra::EARTH_GRAVITY_M_PER_S2);
    let steps = (scene.duration / step).round() as u64;
    let (force, moment, time) = scene.push;
    let pushed = (time / step).round() as u64;
    for number in 0..steps {
        for (_, body) in bodies.iter_mut() {
            body.reset_forces(true);
            body.reset_torques(true);
        }
        if number < pushed {
            bodies[handles[0]].add_force(glam(force), true);
            bodies[handles[0]].add_torque(glam(moment), true);
        }
        if let Some((stiffness, damping)) = scene.springs {
            for wheel in &scene.model.wheels {
                let body = &mut bodies[carried(wheel.link)];
                let at = body
                    .position()
                    .transform_point(local(wheel.link, wheel.centre));
                let rising = body.velocity_at_point(at).z;
                let up = -(stiffness * (at.z - wheel.centre.z) + damping * rising);
                body.add_force_at_point(Vector::new(0.0, 0.0, up), at, true);
            }
        }
        for (index, link) in linkage.links().iter().enumerate() {
            let (below, above) = (carried(link.on), carried(Some(index)));
            let angle = angle(&bodies[below], &bodies[above]);
            let axis = *bodies[above].rotation() * Vector::Y;
            let rate = (bodies[above].angvel() - bodies[below].angvel()).dot(axis);
            let turn = axis * linkage.holds()[link.freedom].moment(angle, rate);
            bodies[above].add_torque(turn, true);
            bodies[below].add_torque(-turn, true);
        }
        world.step(gravity, &parameters, &mut bodies, &mut joints);
    }
    let mut centre = Vector::ZERO;
    for (_, body) in bodies.iter() {
        centre += body.center_of_mass() * body.mass();
    }
    let centre = centre * (1.0 / linkage.mass());
    let chassis = &bodies[handles[0]];
    let place = chassis.position().transform_point(local(None, Ours::ZERO));
    let turned = *chassis.rotation();
    let sign = if turned.w < 0.0 { -1.0 } else { 1.0 };
    Positions {
        centre: [centre.x, centre.y, centre.z],
        place: [place.x, place.y, place.z],
        attitude: [turned.x, turned.y, turned.z, turned.w].map(|part| sign * part),
        joints: linkage
            .links()
            .iter()
            .enumerate()
            .map(|(index, link)| angle(&bodies[carried(link.on)], &bodies[carried(Some(index))]))
            .collect(),
    }
}

/// How far one body is turned against another about their common y axis, rad.
fn angle(below: &RigidBody, above: &RigidBody) -> f64 {
    let turn = below.rotation().inverse() * *above.rotation();
    2.0 * turn.y.atan2(turn.w)
}

/// What rapier needs besides bodies and joints: nothing touches here.
#[derive(Default)]
struct World {
    pipeline: PhysicsPipeline,
    islands: IslandManager,
    broad: BroadPhaseBvh,
    narrow: NarrowPhase,
    colliders: ColliderSet,
    impulse: ImpulseJointSet,
    soft: SoftBodySet,
    ccd: CCDSolver,
}

impl World {
    fn step(
        &mut self,
        gravity: Vector,
        parameters: &IntegrationParameters,
        bodies: &mut RigidBodySet,
        joints: &mut MultibodyJointSet,
    ) {
        self.pipeline.step(
            gravity,
            parameters,
            &mut self.islands,
            &mut self.broad,
            &mut self.narrow,
            bodies,
            &mut self.colliders,
            &mut self.impulse,
            joints,
            &mut self.soft,
            &mut self.ccd,
            &(),
            &(),
        );
    }
}
