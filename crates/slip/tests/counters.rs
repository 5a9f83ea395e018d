//! Counters roll over, both ways, at the exact boundary, and more than once between readings.

use grouser_slip::{Counter, CounterWidth, Error};
use proptest::prelude::*;

fn shown(true_count: i128, bits: u32) -> u64 {
    // The low bits of a two's complement number, by arithmetic rather than by shifts.
    u64::try_from(true_count.rem_euclid(1_i128 << bits)).unwrap()
}

fn follow(bits: u32, counts: &[i128]) {
    let width = CounterWidth::new(bits).unwrap();
    let mut counter = Counter::new(width);
    let mut last = counts[0];
    for &count in counts {
        let step = i128::from(width.step(shown(last, bits), shown(count, bits)));
        assert_eq!(step, count - last, "{bits} bits from {last} to {count}");
        last = count;
        counter.advance(shown(count, bits));
        assert_eq!(counter.total(), count - counts[0], "{bits} bits at {count}");
    }
}

#[test]
fn rollover_at_the_exact_boundary_both_ways() {
    for bits in [8, 16, 24, 31, 32, 63, 64] {
        let unsigned = 1_i128 << bits;
        let signed = 1_i128 << (bits - 1);
        for boundary in [unsigned, signed, 0, -signed, 5 * unsigned] {
            follow(bits, &[boundary - 1, boundary, boundary + 1]);
            follow(bits, &[boundary + 1, boundary, boundary - 1]);
            follow(bits, &[boundary - 50, boundary + 50, boundary - 50]);
        }
    }
}

#[test]
fn twice_in_one_step_with_a_prediction() {
    let width = CounterWidth::new(8).unwrap();
    // 600 ticks on a counter of 256: two whole turns and 88.
    assert_eq!(width.step_near(10, shown(610, 8), 590), 600);
    assert_eq!(width.step_near(10, shown(-590, 8), -620), -600);
    let mut counter = Counter::new(CounterWidth::new(16).unwrap());
    counter.advance(0);
    counter.advance_near(shown(150_000, 16), 149_000);
    assert_eq!(counter.total(), 150_000);
}

#[test]
fn raw_readings_beyond_the_width_count_by_their_low_bits() {
    // A signed 16-bit counter, sign-extended by its reader.
    let width = CounterWidth::new(16).unwrap();
    let sign_extended = i64::from(-3_i16).cast_unsigned();
    assert_eq!(width.step(sign_extended, 2), 5);
}

#[test]
fn widths_outside_8_to_64_are_refused() {
    for bits in 8..=64 {
        assert_eq!(CounterWidth::new(bits).map(CounterWidth::bits), Ok(bits));
    }
    for bits in [0, 7, 65, u32::MAX] {
        assert_eq!(CounterWidth::new(bits), Err(Error::CounterWidth { bits }));
    }
}

proptest! {
    #[test]
    fn any_walk_within_half_a_range_is_followed(
        bits in 8_u32..=64,
        start in any::<i64>(),
        shares in prop::collection::vec(-0.499_f64..0.499, 1..50),
    ) {
        let range = 2.0_f64.powi(i32::try_from(bits).unwrap());
        let mut counts = vec![i128::from(start)];
        for share in shares {
            let last = counts[counts.len() - 1];
            #[allow(clippy::cast_possible_truncation, reason = "far below 2^127")]
            counts.push(last + (share * range) as i128);
        }
        follow(bits, &counts);
    }

    #[test]
    fn a_prediction_within_half_a_range_finds_any_step(
        bits in 8_u32..=40,
        start in any::<u32>(),
        step in -(1_i64 << 45)..(1_i64 << 45),
        off in -0.499_f64..0.499,
    ) {
        let range = 2.0_f64.powi(i32::try_from(bits).unwrap());
        #[allow(clippy::cast_possible_truncation, reason = "far below 2^63")]
        let expected = step + (off * range) as i64;
        let width = CounterWidth::new(bits).unwrap();
        let to = shown(i128::from(start) + i128::from(step), bits);
        prop_assert_eq!(width.step_near(shown(i128::from(start), bits), to, expected), step);
    }
}
