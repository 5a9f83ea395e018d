//! Clocks of two recordings of one test.

/// Times of readings by a controller's own clock, put on a system clock that stamped them late and in bursts:
/// the straight line through (controller, system), shifted so that no reading was stamped before it was made. With them its rate, system
/// over controller.
///
/// Both in s. The controller's clock may run fast or slow against the system's; the least delay is taken
/// as none.
pub(super) fn straightened(controller: &[f64], system: &[f64]) -> (Vec<f64>, f64) {
    let (Some(&c_0), Some(&s_0)) = (controller.first(), system.first()) else {
        return (Vec::new(), 1.0);
    };
    let count = controller.len() as f64;
    let mean = controller.iter().map(|c| c - c_0).sum::<f64>() / count;
    let centred: Vec<f64> = controller.iter().map(|c| c - c_0 - mean).collect();
    let pairs = || centred.iter().zip(system);
    let top: f64 = pairs().map(|(c, s)| c * (s - s_0)).sum();
    let bottom: f64 = centred.iter().map(|c| c * c).sum();
    let rate = if bottom > 0.0 { top / bottom } else { 1.0 };
    let least = pairs()
        .map(|(c, s)| s - rate * c)
        .fold(f64::INFINITY, f64::min);
    (centred.iter().map(|c| rate * c + least).collect(), rate)
}

/// The difference between two clocks that show local times of different zones: the multiple of a quarter of an
/// hour nearest to how far the two recordings' middles lie apart, s.
pub(super) fn time_zone(one: &[f64], other: &[f64]) -> f64 {
    const TIME_ZONE_STEP_S: f64 = 900.0;
    let middle = |times: &[f64]| {
        let ends = times.first().zip(times.last());
        ends.map_or(0.0, |(a, b)| 0.5 * (a + b))
    };
    TIME_ZONE_STEP_S * ((middle(one) - middle(other)) / TIME_ZONE_STEP_S).round()
}

/// `values` at the time `t`, by straight lines between readings; held at the ends.
pub(super) fn at(times: &[f64], values: &[f64], t: f64) -> f64 {
    let next = times.partition_point(|time| *time < t);
    if next == 0 {
        return values.first().copied().unwrap_or(f64::NAN);
    }
    if next == times.len() {
        return values.last().copied().unwrap_or(f64::NAN);
    }
    let (a, b) = (times[next - 1], times[next]);
    let share = (t - a) / (b - a);
    values[next - 1] + share * (values[next] - values[next - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn late_stamps_are_straightened() {
        // a controller 1000 s behind that runs 0.1 % slow; stamps late by up to 50 ms
        let controller: Vec<f64> = (0..400).map(|i| 0.02 * f64::from(i)).collect();
        let truth: Vec<f64> = controller.iter().map(|c| 1000.0 + 1.001 * c).collect();
        let late: Vec<f64> = (0..400)
            .map(|i| truth[i] + 0.005 * f64::from(u32::try_from(i % 11).unwrap()))
            .collect();
        let (found, rate) = straightened(&controller, &late);
        assert!((rate - 1.001).abs() < 1e-4, "{rate}");
        for (a, b) in found.iter().zip(&truth) {
            assert!((a - b).abs() < 1e-3, "{a} {b}");
        }
        // a clock that stands has no rate: all readings are as old as the oldest
        assert_eq!(
            straightened(&[7.0; 3], &[3.0, 2.0, 4.0]),
            (vec![2.0; 3], 1.0)
        );
        assert_eq!(straightened(&[], &[]), (vec![], 1.0));
    }

    #[test]
    fn time_zones_and_lines() {
        assert_eq!(time_zone(&[18_000.3, 18_030.0], &[0.0, 30.0]), 18_000.0);
        assert_eq!(at(&[0.0, 1.0, 3.0], &[0.0, 10.0, 0.0], 1.5), 7.5);
        assert_eq!(at(&[0.0, 1.0], &[3.0, 4.0], 9.0), 4.0);
    }
}
