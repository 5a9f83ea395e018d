//! By how much the stamps of a wheel's readings scatter about the moments at which it was read.
//!
//! A stamp that is wrong by τ moves the way u τ of the rim into the window before it, which the one after it lacks. The rim speeds
//! of three windows that follow each other show that: the product of their two differences has the mean −4 (u τ / T)², 0 where
//! the speed wanders, and more where it grows or falls steadily. Where stamps are true, however uneven, it finds none.

/// Weight of a new window in the means: 100 windows are 5 s at the default window. Stamps of a computer scatter alike for longer.
const NEW_WINDOW_WEIGHT: f64 = 0.01;
/// Differences between two speeds are limited to this multiple of the speed: a larger one is a jump of the counter, not of a stamp.
const MAX_DIFFERENCE_FACTOR: f64 = 4.0;
/// Variance of a count that is attributed to its ticks, ticks²: twice the 1/12 of a uniform remainder, so that the noise of the means
/// is not attributed to stamps (`stamps_that_scatter_are_no_slip`: with true stamps errors stay the same).
const TICKS_VARIANCE: f64 = 2.0 / 12.0;

/// The scatter of one counter's stamps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StampScatter {
    /// The two windows before: rim speed (m/s) and length (s).
    before: [Option<(f64, f64)>; 2],
    /// Means of the products (m²/s²), and of what they are for a variance of 1 s².
    product: f64,
    of_unit: f64,
}

impl StampScatter {
    /// Adds a window's rim speed (m/s) and length (s); `tick` is the way of a tick, m.
    pub(super) fn push(&mut self, speed: f64, length: f64, tick: f64) {
        let [first, second] = self.before;
        self.before = [second, Some((speed, length))];
        let (Some((first, first_length)), Some((second, second_length))) = (first, second) else {
            return;
        };
        let middle = second.abs();
        let most = MAX_DIFFERENCE_FACTOR * middle;
        let product = (speed - second).clamp(-most, most) * (second - first).clamp(-most, most);
        // of an error of 1 m in the place of the rim at each reading
        let unit = (1.0 / length + 2.0 / second_length + 1.0 / first_length) / second_length;
        let by_stamps = -product - TICKS_VARIANCE * tick * tick * unit;
        self.product += NEW_WINDOW_WEIGHT * (by_stamps - self.product);
        self.of_unit += NEW_WINDOW_WEIGHT * (middle * middle * unit - self.of_unit);
    }

    /// The variance of a stamp, s².
    pub(super) fn variance(&self) -> f64 {
        if self.product > 0.0 {
            self.product / self.of_unit
        } else {
            0.0
        }
    }

    /// The counter was reset: a window follows that does not continue the last.
    pub(super) fn interrupt(&mut self) {
        self.before = [None; 2];
    }
}

#[cfg(test)]
mod tests {
    use super::StampScatter;

    const TICK_M: f64 = 0.01;

    /// −(v₃ − v₂)(v₂ − v₁) less that of ticks, and what it is for a variance of 1 s².
    fn parts(speeds: [f64; 3], lengths: [f64; 3], tick: f64) -> (f64, f64) {
        let [first, middle, last] = speeds;
        let [l_1, l_2, l_3] = lengths;
        // an error of 1 m at the ends of the middle window: in its own speed and in those beside it
        let unit = ((1.0 / l_1 + 1.0 / l_2) + (1.0 / l_2 + 1.0 / l_3)) / l_2;
        let product = (last - middle) * (middle - first);
        (-product - tick * tick / 6.0 * unit, middle * middle * unit)
    }

    #[test]
    fn the_variance_of_stamps_is_that_of_three_windows() {
        let speeds = [0.25, -0.5, 0.3, 0.4];
        let lengths = [0.05, 0.0625, 0.04, 0.08];
        let mut scatter = StampScatter::default();
        assert_eq!(scatter.variance(), 0.0);
        for i in 0..4 {
            scatter.push(speeds[i], lengths[i], TICK_M);
        }
        let of = |i: usize| {
            let take = |all: [f64; 4]| [all[i], all[i + 1], all[i + 2]];
            parts(take(speeds), take(lengths), TICK_M)
        };
        // each counts a hundredth
        let ((product, unit), (next, next_unit)) = (of(0), of(1));
        let product = 0.01 * product * 0.99 + 0.01 * next;
        let unit = 0.01 * unit * 0.99 + 0.01 * next_unit;
        assert!((scatter.product - product).abs() < 1e-12);
        assert!((scatter.of_unit - unit).abs() < 1e-9);
        assert!((scatter.variance() - product / unit).abs() < 1e-15);
        // what does not continue the last
        let before = scatter.product;
        scatter.interrupt();
        scatter.push(0.9, 0.05, TICK_M);
        scatter.push(0.1, 0.05, TICK_M);
        assert_eq!(scatter.product, before);
    }

    #[test]
    fn jumps_count_up_to_four_times_the_speed_and_steady_growth_is_none() {
        for (first, last) in [(9.0, 9.0), (9.0, -9.0), (-9.0, 9.0), (-9.0, -9.0)] {
            let mut scatter = StampScatter::default();
            for speed in [first, -0.5, last] {
                scatter.push(speed, 0.05, 0.0);
            }
            let sign = if first == last { 1.0 } else { -1.0 };
            assert!((scatter.product - sign * 0.01 * 2.0 * 2.0).abs() < 1e-12);
            assert_eq!(scatter.variance() > 0.0, sign > 0.0);
        }
    }
}
