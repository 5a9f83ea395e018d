//! The distance by the reference compared with that by the wheels: y(t) = a x(t − δ) over blocks of a few seconds.
//!
//! Slip makes a less than 1 and different from block to block, and a sensor of the ground has noise. A wrong radius, gear or number of
//! ticks makes a wrong everywhere. A reference that is derived from the wheels has neither noise nor slip.

use crate::reference_delay::{Delays, Kind, Tracks, blocks_of, range};

/// Fewer blocks in which the robot moves show no scale. Limit.
const MIN_BLOCKS: usize = 4;
/// A shorter distance in a block is no motion, m: ten times the noise of a position of 2 cm. Sensor noise.
const MIN_DISTANCE_M: f64 = 0.2;
/// Delays that are tried: filters follow their wheels by up to 0.4 s. Prior.
const DELAYS: Delays = Delays {
    min_s: -0.05,
    max_s: 0.4,
    step_s: 0.025,
    max_readings: usize::MAX,
};

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

/// The multiple of a reference that is derived from the wheels is near 1 and the same in half of the blocks, within this: with motion
/// capture the quartiles differ by 0.003 to 0.008, with satellites on grass by 0.0011, of a filter over wheels by 0.0007: a choice between
/// the last two, made on these logs. Limits.
const DERIVED_SCALES: std::ops::RangeInclusive<f64> = 0.97..=1.03;
const DERIVED_SPREAD: f64 = 0.0008;
/// One block in ten with a smaller multiple shows slip, which no odometry of the wheels does. Limit: filters lag by some hundredths.
const MIN_DERIVED_SCALE: f64 = 0.9;
/// And its residual is below this, m: that of motion capture is 0.3 to 0.7 mm, that of a filter over wheels up to 0.2 mm. Sensor noise.
const DERIVED_NOISE_M: f64 = 2.5e-4;

/// The multiple of a block, the standard deviation of its residual, m, and its mean step, m.
type Scale = [f64; 3];

impl DistanceCheck {
    /// Does the reference follow the wheels everywhere?
    pub(crate) fn is_derived(&self) -> bool {
        let [low, high] = self.quartiles;
        let is_even = high - low < DERIVED_SPREAD && DERIVED_SCALES.contains(&self.scales[1]);
        let shows_slip = self.scales[0] < MIN_DERIVED_SCALE;
        is_even && !shows_slip && self.noise_m < DERIVED_NOISE_M
    }

    /// What tracks show; `None` of a robot that hardly moves, or whose wheels point in several directions.
    pub(crate) fn of(tracks: &Tracks) -> Option<Self> {
        let blocks = blocks_of(Kind::Way, &tracks.rims.track, &tracks.ways, 0.0, DELAYS);
        let at = |delay_s: f64| {
            let scales = blocks.iter().filter_map(|block| {
                let (sums, count) = (block.sums(delay_s), block.count());
                let scale = sums.fy / sums.ff;
                let residual = (sums.yy - scale * sums.fy).max(0.0) / (count - 1.0);
                let distance = (sums.ff * count).sqrt();
                let moves = distance > MIN_DISTANCE_M && scale.is_finite();
                moves.then_some([scale, residual.sqrt(), distance / count])
            });
            let scales: Vec<Scale> = scales.collect();
            (scales.len() >= MIN_BLOCKS).then_some(scales)
        };
        let sorted = |scales: &[Scale], part: usize| {
            let mut all: Vec<f64> = scales.iter().map(|scale| scale[part]).collect();
            all.sort_by(f64::total_cmp);
            move |twentieths: usize| all[all.len() * twentieths / 20]
        };
        let delays_s = range(DELAYS.min_s, DELAYS.max_s, DELAYS.step_s).into_iter();
        let checks = delays_s.filter_map(|delay_s| {
            let scales = at(delay_s)?;
            let scale = sorted(&scales, 0);
            Some(Self {
                scales: [2, 10, 18].map(&scale),
                quartiles: [5, 15].map(&scale),
                noise_m: sorted(&scales, 1)(10),
                step_m: sorted(&scales, 2)(10),
            })
        });
        checks.min_by(|a, b| a.noise_m.total_cmp(&b.noise_m))
    }
}
