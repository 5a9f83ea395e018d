//! The tip-over margin over pitch and roll.

use grouser_rover::robot::RobotModel;
use grouser_rover::statics::{TipOverCone, stability_margins};
use grouser_rover::vector::{Attitude, Vector};

use crate::table::Envelope;

/// Cells a side: the cones of their corners hold for poses between them.
const CELLS: u32 = 8;
/// Nodes a side.
const SIDE: usize = CELLS as usize + 1;

/// The cone of the least margin at every node of an even grid; between the nodes the least of those of the cell's corners.
#[derive(Clone, Debug)]
pub(crate) struct TipOverTable {
    envelope: Envelope,
    cones: Vec<Option<TipOverCone>>,
    /// The greatest difference from the exact margin in the middle of the cells, rad.
    pub(crate) error: f64,
}

impl TipOverTable {
    /// With its error.
    pub(crate) fn new(model: &RobotModel, envelope: Envelope) -> Self {
        let pose = |i: f64, j: f64| {
            let share = |place: f64| 2.0 * place / f64::from(CELLS) - 1.0;
            (share(i) * envelope.max_pitch, share(j) * envelope.max_roll)
        };
        let middles = (0..CELLS).flat_map(|i| (0..CELLS).map(move |j| (i, j)));
        let middles = middles.map(|(i, j)| pose(f64::from(i) + 0.5, f64::from(j) + 0.5));
        let mut out = Self::of_poses(model, envelope, middles.clone());
        for (pitch, roll) in middles {
            let exact = stability_margins(model, pitch, roll).tip_over;
            let off = (out.margin(pitch, roll) - exact).abs();
            out.error = out.error.max(off);
        }
        out
    }

    /// For these poses (pitch and roll, rad): the nodes of the cells in which they lie, without the error.
    pub(crate) fn of_poses(
        model: &RobotModel,
        envelope: Envelope,
        poses: impl Iterator<Item = (f64, f64)>,
    ) -> Self {
        let mut out = Self {
            envelope,
            cones: vec![None; SIDE * SIDE],
            error: 0.0,
        };
        let share = |place: usize| 2.0 * place as f64 / f64::from(CELLS) - 1.0;
        for (pitch, roll) in poses {
            for node in out.corners(pitch, roll) {
                if out.cones[node].is_none() {
                    let (i, j) = (node / SIDE, node % SIDE);
                    let (pitch, roll) =
                        (share(i) * envelope.max_pitch, share(j) * envelope.max_roll);
                    let edges = stability_margins(model, pitch, roll).edges.into_iter();
                    let least = edges.min_by(|a, b| a.tip_over.total_cmp(&b.tip_over));
                    out.cones[node] = least.map(|edge| edge.cone);
                }
            }
        }
        out
    }

    /// The nodes around a pose.
    fn corners(&self, pitch: f64, roll: f64) -> [usize; 4] {
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
        let corner =
            SIDE * cell(pitch, self.envelope.max_pitch) + cell(roll, self.envelope.max_roll);
        [0, 1, SIDE, SIDE + 1].map(|on| corner + on)
    }

    /// The margin, rad.
    pub(crate) fn margin(&self, pitch: f64, roll: f64) -> f64 {
        let down = Attitude::from_angles(roll, -pitch, 0.0).to_robot(-Vector::AXES[2]);
        let corners = self.corners(pitch, roll).into_iter();
        corners
            .filter_map(|node| self.cones[node].as_ref())
            .map(|cone| cone.margin(down))
            .fold(f64::INFINITY, f64::min)
    }
}
