//! The tip-over margin over pitch and roll.

use grouser_rover::robot::RobotModel;
use grouser_rover::statics::stability_margins;

use crate::table::Envelope;

/// Cells a side: a margin of the least of several edges has kinks, between which it is nearly linear.
const CELLS: u32 = 64;

/// Margins on an even grid, bilinear between the nodes.
#[derive(Clone, Debug)]
pub(crate) struct TipOverTable {
    envelope: Envelope,
    margins: Vec<f64>,
    /// The greatest difference from the exact margin in the middle of the cells, rad.
    pub(crate) error: f64,
}

impl TipOverTable {
    pub(crate) fn new(model: &RobotModel, envelope: Envelope) -> Self {
        let exact = |i: f64, j: f64| {
            let share = |place: f64| 2.0 * place / f64::from(CELLS) - 1.0;
            stability_margins(
                model,
                share(i) * envelope.max_pitch,
                share(j) * envelope.max_roll,
            )
            .tip_over
        };
        let nodes = (0..=CELLS).flat_map(|i| (0..=CELLS).map(move |j| (i, j)));
        let margins = nodes
            .map(|(i, j)| exact(f64::from(i), f64::from(j)))
            .collect();
        let mut out = Self {
            envelope,
            margins,
            error: 0.0,
        };
        for i in 0..CELLS {
            for j in 0..CELLS {
                let place = [i, j].map(|cell| f64::from(cell) + 0.5);
                let off = (out.at(place) - exact(place[0], place[1])).abs();
                out.error = out.error.max(off);
            }
        }
        out
    }

    /// The margin, rad.
    pub(crate) fn margin(&self, pitch: f64, roll: f64) -> f64 {
        let place = |angle: f64, max: f64| 0.5 * f64::from(CELLS) * (angle / max + 1.0);
        self.at([
            place(pitch, self.envelope.max_pitch),
            place(roll, self.envelope.max_roll),
        ])
    }

    fn at(&self, place: [f64; 2]) -> f64 {
        let last = f64::from(CELLS - 1);
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the grid, as just clamped"
        )]
        let [i, j] = place.map(|x| x.floor().clamp(0.0, last) as usize);
        let (u, v) = (place[0] - i as f64, place[1] - j as f64);
        let side = CELLS as usize + 1;
        let node = |i: usize, j: usize| self.margins[i * side + j];
        (1.0 - u) * ((1.0 - v) * node(i, j) + v * node(i, j + 1))
            + u * ((1.0 - v) * node(i + 1, j) + v * node(i + 1, j + 1))
    }
}
