//! What is simulated: the robot, what pushes it, what it stands on.

use std::path::Path;

use grouser_rover::body::{BodyState, Linkage};
use grouser_rover::robot::RobotModel;
use grouser_rover::vector::{Attitude, Vector};

/// A scene.
pub struct Scene {
    pub about: &'static str,
    pub model: RobotModel,
    /// s.
    pub duration: f64,
    /// Force (N) and moment (N m) on the chassis in the world's frame, for so long, s.
    pub push: (Vector, Vector, f64),
    /// Springs and dampers under the wheels' centres: N/m, N s/m; the centres rest at their heights of the
    /// description.
    pub springs: Option<(f64, f64)>,
}

/// Where everything is at the end.
#[derive(Clone, Debug)]
pub struct Positions {
    pub place: [f64; 3],
    /// x, y, z, w.
    pub attitude: [f64; 4],
    /// The centre of all masses, m.
    pub centre: [f64; 3],
    /// Angle of each link against what carries it, rad.
    pub joints: Vec<f64>,
}

impl Scene {
    pub fn all() -> Vec<Self> {
        let push = |force: [f64; 3], moment: [f64; 3], time| {
            let vector = |[x, y, z]: [f64; 3]| Vector::new(x, y, z);
            (vector(force), vector(moment), time)
        };
        vec![
            Self {
                about: "five wheels, tumbling in free fall for 1 s",
                model: robot("five-wheel"),
                duration: 1.0,
                push: push([40.0, -20.0, 150.0], [6.0, -9.0, 4.0], 0.2),
                springs: None,
            },
            Self {
                about: "rocker-bogie, tumbling in free fall for 1 s",
                model: robot("rocker-bogie"),
                duration: 1.0,
                push: push([40.0, -20.0, 150.0], [6.0, -9.0, 4.0], 0.2),
                springs: None,
            },
            Self {
                about: "five wheels on springs under the wheels, pushed, 1.5 s",
                model: robot("five-wheel"),
                duration: 1.5,
                push: push([10.0, 15.0, 60.0], [4.0, 6.0, 0.0], 0.2),
                springs: Some((3000.0, 120.0)),
            },
        ]
    }
}

impl Scene {
    /// Where the centre of mass is at the end of a free flight, in closed form.
    pub fn parabola(&self) -> [f64; 3] {
        let (force, _, time) = self.push;
        let linkage = &self.model.linkage;
        let begun = linkage.centre(&linkage.pose(&start()));
        let way = force * ((0.5 * time * time + time * (self.duration - time)) / linkage.mass());
        let fall = 0.5 * grouser_terra::EARTH_GRAVITY_M_PER_S2 * self.duration * self.duration;
        [begun.x + way.x, begun.y + way.y, begun.z + way.z - fall]
    }
}

/// A shipped robot whose rockers turn each for itself: rapier has no differential. Its own is held by closed forms
/// (`crates/rover/tests/uneven.rs`).
fn robot(name: &str) -> RobotModel {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots");
    let mut model = RobotModel::read(&path.join(format!("{name}.toml"))).expect("a shipped robot");
    let old = &model.linkage;
    let mut links = old.links().to_vec();
    let mut holds = Vec::new();
    for (index, link) in links.iter_mut().enumerate() {
        holds.push(old.holds()[link.freedom]);
        link.freedom = index;
        link.sign = 1.0;
    }
    // free rockers need something that holds them
    for hold in &mut holds {
        hold.stiffness = hold.stiffness.max(8.0);
        hold.damping = hold.damping.max(0.05);
    }
    model.linkage = Linkage::new(old.bodies().to_vec(), links, holds);
    model
}

/// At rest at the world's origin.
pub fn start() -> BodyState {
    BodyState::at(Vector::ZERO, Attitude::LEVEL)
}
