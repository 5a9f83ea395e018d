//! Where the ticks of an axis stand and what they say.

/// The ticks of one axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    /// The axis' range, widened to whole ticks where it was free.
    pub(super) range: [f64; 2],
    /// Value and label of each.
    pub(super) marks: Vec<(f64, String)>,
    /// The labels are in units of 10 to this power, which the axis title then says.
    pub(super) power: i32,
}

/// May an axis show more than its data?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Widen {
    /// No: its range was given.
    No,
    /// To whole ticks.
    ToTicks,
    /// To whole ticks, and by one more where the data would come near the frame (unless zero is there).
    ToTicksWithRoom,
}

/// Nearer to the frame than this share of the range is near.
const NEAR_FRAME_SHARE: f64 = 0.03;

/// Ticks of a scale that covers `range` with at most `most` intervals of 1, 2 or 5 times a power of ten.
pub(super) fn ticks(range: [f64; 2], widen: Widen, most: u8) -> Ticks {
    let [low, high] = sensible(range);
    let most = f64::from(most.max(1));
    let mut step = next_step((high - low) / most * 0.5);
    let (mut first, mut last) = whole_ticks([low, high], step, widen);
    // Two or three steps larger at most: widening adds a few intervals, not many.
    while last - first > most {
        step = next_step(step);
        (first, last) = whole_ticks([low, high], step, widen);
    }
    let range = match widen {
        Widen::No => [low, high],
        Widen::ToTicks | Widen::ToTicksWithRoom => [first * step, last * step],
    };
    let largest = range[0].abs().max(range[1].abs());
    let magnitude = decade(largest);
    let power = if (-3..5).contains(&magnitude) {
        0
    } else {
        magnitude
    };
    let scaled_step = step / 10_f64.powi(power);
    let decimals = usize::try_from(-decade(scaled_step * (1.0 + 1e-6))).unwrap_or(0);
    let mut marks = Vec::new();
    let mut number = first;
    while number <= last && marks.len() < 100 {
        let value = number * step;
        marks.push((value, label(number * scaled_step, decimals)));
        number += 1.0;
    }
    Ticks {
        range,
        marks,
        power,
    }
}

/// The first and the last tick, counted in steps from zero.
fn whole_ticks([low, high]: [f64; 2], step: f64, widen: Widen) -> (f64, f64) {
    // A hair of tolerance, so that 0.6000000000000001 counts as 0.6.
    let slack = 1e-6;
    let (mut first, mut last) = if widen == Widen::No {
        ((low / step - slack).ceil(), (high / step + slack).floor())
    } else {
        ((low / step + slack).floor(), (high / step - slack).ceil())
    };
    if widen == Widen::ToTicksWithRoom {
        let room = NEAR_FRAME_SHARE * (last - first);
        if last != 0.0 && last - high / step < room {
            last += 1.0;
        }
        if first != 0.0 && low / step - first < room {
            first -= 1.0;
        }
    }
    (first, last)
}

/// A number with a true minus sign; zero has none.
fn label(value: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", value.abs());
    let is_zero = digits.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    if value < 0.0 && !is_zero {
        format!("−{digits}")
    } else {
        digits
    }
}

/// The range in order, with some width, and finite.
fn sensible([a, b]: [f64; 2]) -> [f64; 2] {
    let (low, high) = if a.is_finite() && b.is_finite() {
        (a.min(b), a.max(b))
    } else {
        (0.0, 1.0)
    };
    let span = high - low;
    let size = low.abs().max(high.abs());
    // Narrower than the page or f64 could show, or at the ends of what f64 can hold.
    if span > size * 1e-9 && span > 1e-200 && span < 1e200 {
        [low, high]
    } else if size > 1e-200 && size < 1e200 {
        [low - 0.1 * size, high + 0.1 * size]
    } else {
        [0.0, 1.0]
    }
}

/// The least 1, 2 or 5 times a power of ten above `value`.
fn next_step(value: f64) -> f64 {
    let power = 10_f64.powi(decade(value));
    let steps = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power);
    let above = |step: &f64| *step > value * (1.0 + 1e-6);
    steps.into_iter().find(above).unwrap_or(20.0 * power)
}

/// The power of ten of the first digit.
fn decade(value: f64) -> i32 {
    if value > 0.0 {
        let decade = value.log10().floor().clamp(-300.0, 300.0);
        // It lies within ±300 after the clamp.
        #[allow(clippy::cast_possible_truncation, reason = "clamped just above")]
        let whole = decade as i32;
        whole
    } else {
        0
    }
}

/// Ticks for a scale from `low` to `high` in at most `most` intervals: value and label of each.
///
/// ```
/// let ticks = grouser_figure::even_ticks(0.0, 1.0, 4);
/// assert_eq!(ticks[1], (0.5, "0.5".to_owned()));
/// ```
#[must_use]
pub fn even_ticks(low: f64, high: f64, most: u8) -> Vec<(f64, String)> {
    ticks([low, high], Widen::No, most).marks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(range: [f64; 2], widen: Widen, most: u8) -> Vec<String> {
        ticks(range, widen, most)
            .marks
            .into_iter()
            .map(|(_, text)| text)
            .collect()
    }

    #[test]
    fn round_numbers_with_a_true_minus() {
        assert_eq!(
            labels([-5.2, 22.6], Widen::ToTicks, 6),
            ["−10", "0", "10", "20", "30"]
        );
        assert_eq!(
            labels([0.0, 1.0], Widen::No, 6),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(
            labels([-0.3, 0.3], Widen::No, 6),
            ["−0.3", "−0.2", "−0.1", "0.0", "0.1", "0.2", "0.3"]
        );
    }

    #[test]
    fn data_keeps_away_from_the_frame_but_not_from_zero() {
        let range = |range| ticks(range, Widen::ToTicksWithRoom, 6).range;
        assert_eq!(range([0.0, 15.03]), [0.0, 20.0]);
        assert_eq!(range([0.0, 15.0]), [0.0, 20.0]);
        assert_eq!(range([0.1, 15.0]), [0.0, 20.0]);
        assert_eq!(range([14.0, 26.5]), [10.0, 30.0]);
    }

    #[test]
    fn large_numbers_share_a_power_of_ten() {
        let axis = ticks([0.0, 3.1e6], Widen::ToTicks, 6);
        assert_eq!(axis.power, 6);
        assert_eq!(axis.marks.last().unwrap().1, "4");
    }

    #[test]
    fn no_range_hangs_or_overflows() {
        for range in [
            [0.0, 0.0],
            [5.0, 5.0],
            [f64::NAN, 1.0],
            [f64::NEG_INFINITY, f64::INFINITY],
            [-f64::MAX, f64::MAX],
            [1e15, 1e15 + 1e-3],
            [0.0, 5e-324],
            [3.0, -3.0],
        ] {
            let axis = ticks(range, Widen::ToTicks, 6);
            assert!(axis.range[1] > axis.range[0], "{range:?} {axis:?}");
            assert!(axis.marks.len() <= 100);
        }
    }
}
