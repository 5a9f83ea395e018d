//! The distance by the reference compared with that by the wheels: y(t) = a x(t − δ) over blocks of a few seconds.
//!
//! Slip makes a less than 1 and different from block to block, and a sensor of the ground has noise. A wrong radius, gear or number of
//! ticks makes a wrong everywhere. A reference that is derived from the wheels has neither noise nor slip.

use crate::reference_delay::{Passed, Tracks};

/// Blocks are this long, s, and have as many readings of the reference at least.
const BLOCK_S: f64 = 4.0;
const MIN_READINGS: usize = 6;
/// Fewer blocks in which the robot moves show no scale.
const MIN_BLOCKS: usize = 4;
/// A shorter distance in a block is no motion, m. A choice: ten times the noise of a position of 2 cm.
const MIN_DISTANCE_M: f64 = 0.2;
/// Delays that are tried, in steps of 25 ms. A choice: filters follow their wheels by up to 0.4 s.
const DELAYS_S: std::ops::RangeInclusive<i32> = -2..=16;
const DELAY_STEP_S: f64 = 0.025;

/// The distance by the reference as a multiple of that by the wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct DistanceCheck {
    /// The multiple below which one, five and nine of ten blocks are.
    pub scales: [f64; 3],
    /// The multiples below which a quarter and three quarters of the blocks are.
    pub quartiles: [f64; 2],
    /// Median deviation of the reference from the wheels' distance times the block's own multiple, m.
    pub noise_m: f64,
    /// The median distance by the wheels between two readings, m.
    pub step_m: f64,
}

/// One block: the multiple, the standard deviation of the residual, m, and the mean step, m.
type Block = [f64; 3];

fn block(tracks: &Tracks, passed: &[Passed], delay_s: f64) -> Option<Block> {
    let (mut ff, mut fy, mut yy, mut way) = (0.0, 0.0, 0.0, 0.0);
    for one in passed {
        let f = tracks
            .rims
            .track
            .between(one.from_s - delay_s, one.to_s - delay_s);
        ff += f * f;
        fy += f * one.amount;
        yy += one.amount * one.amount;
        way += f.abs();
    }
    let count = passed.len() as f64;
    let scale = fy / ff;
    let residual = (yy - scale * fy).max(0.0) / (count - 1.0);
    let moves = way > MIN_DISTANCE_M && scale.is_finite();
    moves.then_some([scale, residual.sqrt(), way / count])
}

impl DistanceCheck {
    /// What tracks show; `None` of a robot that hardly moves, or whose wheels point in several directions.
    pub(crate) fn of(tracks: &Tracks) -> Option<Self> {
        let at = |delay_s: f64| {
            let mut rest = tracks.ways.as_slice();
            let mut blocks = Vec::new();
            while let Some(first) = rest.first() {
                let in_time = rest.partition_point(|one| one.to_s < first.from_s + BLOCK_S);
                let count = in_time.max(MIN_READINGS);
                let Some((own, next)) = rest.split_at_checked(count) else {
                    break;
                };
                blocks.extend(block(tracks, own, delay_s));
                rest = next;
            }
            (blocks.len() >= MIN_BLOCKS).then_some(blocks)
        };
        let sorted = |blocks: &[Block], part: usize| {
            let mut all: Vec<f64> = blocks.iter().map(|block| block[part]).collect();
            all.sort_by(f64::total_cmp);
            move |twentieths: usize| all[all.len() * twentieths / 20]
        };
        let checks = DELAYS_S.filter_map(|step| {
            let blocks = at(f64::from(step) * DELAY_STEP_S)?;
            let scale = sorted(&blocks, 0);
            Some(Self {
                scales: [2, 10, 18].map(&scale),
                quartiles: [5, 15].map(&scale),
                noise_m: sorted(&blocks, 1)(10),
                step_m: sorted(&blocks, 2)(10),
            })
        });
        checks.min_by(|a, b| a.noise_m.total_cmp(&b.noise_m))
    }
}
