//! The tip-over margin over pitch and roll.

use grouser_rover::robot::RobotModel;
use grouser_rover::statics::{TipOverCone, stability_margins};
use grouser_rover::vector::{Attitude, Vector};

use crate::table::Envelope;

/// Cells a side: the cones of their corners hold for poses between them.
const CELLS: u32 = 8;

/// The cone of the least margin at every node of an even grid; between the nodes the least of those of the cell's corners.
#[derive(Clone, Debug)]
pub(crate) struct TipOverTable {
    envelope: Envelope,
    cones: Vec<TipOverCone>,
    /// The greatest difference from the exact margin in the middle of the cells, rad.
    pub(crate) error: f64,
}

impl TipOverTable {
    pub(crate) fn new(model: &RobotModel, envelope: Envelope) -> Self {
        let pose = |i: f64, j: f64| {
            let share = |place: f64| 2.0 * place / f64::from(CELLS) - 1.0;
            (share(i) * envelope.max_pitch, share(j) * envelope.max_roll)
        };
        let nodes = (0..=CELLS).flat_map(|i| (0..=CELLS).map(move |j| (i, j)));
        let cones = nodes.filter_map(|(i, j)| {
            let (pitch, roll) = pose(f64::from(i), f64::from(j));
            let edges = stability_margins(model, pitch, roll).edges.into_iter();
            let least = edges.min_by(|a, b| a.tip_over.total_cmp(&b.tip_over));
            least.map(|edge| edge.cone)
        });
        let mut out = Self {
            envelope,
            cones: cones.collect(),
            error: 0.0,
        };
        for i in 0..CELLS {
            for j in 0..CELLS {
                let (pitch, roll) = pose(f64::from(i) + 0.5, f64::from(j) + 0.5);
                let exact = stability_margins(model, pitch, roll).tip_over;
                let off = (out.margin(pitch, roll) - exact).abs();
                out.error = out.error.max(off);
            }
        }
        out
    }

    /// The margin, rad.
    pub(crate) fn margin(&self, pitch: f64, roll: f64) -> f64 {
        let cell = |angle: f64, max: f64| {
            let place = 0.5 * f64::from(CELLS) * (angle / max + 1.0);
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "within the grid, as just clamped"
            )]
            let cell = place.clamp(0.0, f64::from(CELLS - 1)) as usize;
            cell
        };
        let side = CELLS as usize + 1;
        let corner =
            side * cell(pitch, self.envelope.max_pitch) + cell(roll, self.envelope.max_roll);
        let down = Attitude::from_angles(roll, -pitch, 0.0).to_robot(-Vector::AXES[2]);
        [0, 1, side, side + 1]
            .into_iter()
            .filter_map(|on| self.cones.get(corner + on))
            .map(|cone| cone.margin(down))
            .fold(f64::INFINITY, f64::min)
    }
}
