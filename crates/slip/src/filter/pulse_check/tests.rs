use super::*;

/// A counter that is known to miss this share.
pub(crate) fn known(share: f64) -> PulseCheck {
    PulseCheck {
        share,
        seen: LOSS_KNOWN_TIME_S,
        ..PulseCheck::new(1.0, 960.0)
    }
}

type Change = fn(&mut PulseCheck);

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
}

/// A counter at `speed` ticks a reading, which loses ticks by `lost`.
fn run(speed: f64, mut lost: impl FnMut(i64) -> bool) -> PulseCheck {
    let mut pulses = PulseCheck::new(1.0, 960.0);
    let (mut true_ticks, mut shown) = (0, 0_i64);
    for row in 0..6000_i64 {
        let now = whole(speed * row as f64 + 0.1234);
        while true_ticks < now {
            true_ticks += 1;
            shown += i64::from(!lost(true_ticks));
        }
        pulses.update(row * 10_000_000, shown as f64);
    }
    pulses
}

#[test]
fn the_variance_of_whole_ticks_is_that_of_counting() {
    for alpha in [12.1, 12.25, 12.5, 12.618_034, 12.9] {
        // over all phases of the first tick
        let count = 20_000;
        let mut sum = 0.0;
        for i in 0..count {
            let phase = (f64::from(i) + 0.5) / f64::from(count);
            let s = |k: f64| (alpha * (k + 1.0) + phase).floor() - (alpha * k + phase).floor();
            let bent = s(1.0) - 0.5 * (s(0.0) + s(2.0));
            sum += bent * bent;
        }
        let seen = sum / f64::from(count);
        assert!(
            (seen - by_whole_ticks(alpha)).abs() < 2e-3,
            "{alpha}: {seen}"
        );
    }
    near(fraction(-2.25), 0.75);
    near(fraction(3.25), 0.25);
    near(fraction(-2.0), 0.0);
}

#[test]
fn whole_counters_are_whole_at_any_speed() {
    for speed in [0.8, 1.5, 2.5, 4.6, 4.75, 5.0, 5.5, 11.97, 30.0] {
        let mut pulses = run(speed, |_| false);
        assert!(!pulses.misses(0.0), "{speed}: {:?}", pulses.share());
        assert!(!pulses.has_broken_slot(), "{speed}");
    }
}

#[test]
fn a_slot_that_lacks_its_tick_is_found() {
    assert!(run(4.617, |tick| tick % 960 == 17).has_broken_slot());
    let mut state = 1_u64;
    let mut chance = |_| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) % 100 < 5
    };
    let mut lossy = run(4.617, &mut chance);
    assert!(lossy.misses(0.0), "{:?}", lossy.share());
    // rough ground would show in all wheels
    assert!(!lossy.misses(0.04));
}

/// A counter between windows of 10 readings, which has seen two windows.
fn between(s_1: f64, t_1: f64, s_2: f64, t_2: f64) -> PulseCheck {
    PulseCheck {
        readings: 10.0,
        before: [Some((s_1, t_1)), Some((s_2, t_2))],
        usual: 12.3,
        share: 0.04,
        seen: 2.0,
        so_far: 10.0,
        ..PulseCheck::new(0.5, 961.0)
    }
}

fn ended(mut pulses: PulseCheck, ticks: f64, seconds: f64) -> PulseCheck {
    (pulses.ticks, pulses.seconds) = (ticks, seconds);
    pulses.end_window();
    assert_eq!(
        (pulses.ticks, pulses.seconds, pulses.so_far),
        (0.0, 0.0, 0.0)
    );
    pulses
}

#[test]
fn a_share_that_is_lost_is_what_whole_ticks_do_not_explain() {
    for (s_1, s_2, ticks, seen) in [
        (12.0, 15.0, 13.0, 2.0),
        (-12.0, -15.0, -13.0, 2.0),
        // at most 6 (1 + 0.3 α)
        (12.0, 25.0, 13.0, 2.0),
        // the first ones are their mean, later ones one of 3 s
        (12.0, 15.0, 13.0, 0.0),
        (12.0, 15.0, 13.0, 9.0),
    ] {
        let mut pulses = between(s_1, 0.5, s_2, 0.5);
        pulses.seen = seen;
        let found = ended(pulses, ticks, 0.5);
        let usual = 12.3 + 0.15 * (ticks - 12.3);
        let bent: f64 = s_2 - 0.5 * (s_1 + ticks);
        let square = f64::min(bent * bent, 6.0 * (1.0 + 0.3 * 13.0));
        let beyond = (square - by_whole_ticks(usual)) / (1.5 * 13.0);
        let weight = f64::max(0.5 / 3.0, 0.5 / (seen + 0.5));
        near(found.share, 0.04 + weight * (beyond - 0.04));
        near(found.seen, seen + 0.5);
        near(found.usual, usual);
        assert_eq!(found.before, [Some((s_2, 0.5)), Some((ticks, 0.5))]);
    }
    // a window that is longer than the memory
    let found = ended(between(12.0, 4.0, 15.0, 4.0), 13.0, 4.0);
    let usual = 12.3 + 0.15 * 0.7;
    near(
        found.share,
        (2.5 * 2.5 - by_whole_ticks(usual)) / (1.5 * 13.0),
    );
}

#[test]
fn only_equal_windows_at_a_steady_speed_are_compared() {
    for (s_1, t_1, t_2, ticks, seconds, counts) in [
        (12.0, 0.5, 0.5, 12.0, 0.5, true),
        // a tenth of the time, either way
        (12.0, 11.0, 10.0, 12.0, 10.0, true),
        (12.0, 0.56, 0.5, 12.0, 0.5, false),
        (12.0, 10.0, 10.0, 12.0, 9.0, true),
        (12.0, 0.5, 0.5, 12.0, 0.44, false),
        // one tick and a quarter of them
        (8.0, 0.5, 0.5, 12.0, 0.5, true),
        (7.9, 0.5, 0.5, 12.0, 0.5, false),
        (16.0, 0.5, 0.5, 12.0, 0.5, true),
        (16.1, 0.5, 0.5, 12.0, 0.5, false),
    ] {
        let found = ended(between(s_1, t_1, 12.0, t_2), ticks, seconds);
        assert_eq!(found.seen > 2.0, counts, "{s_1} {t_1} {ticks} {seconds}");
    }
    // from 4 to 60 ticks
    for (readings, ticks, counts) in [
        (50.0, 4.0, true),
        (50.0, -3.9, false),
        (1.0, -60.0, true),
        (1.0, 60.5, false),
    ] {
        let mut pulses = between(ticks, 0.5, ticks, 0.5);
        pulses.readings = readings;
        assert_eq!(ended(pulses, ticks, 0.5).seen > 2.0, counts, "{ticks}");
    }
    // the second of three is not there
    let mut pulses = between(12.0, 0.5, 12.0, 0.5);
    pulses.before[0] = None;
    assert_eq!(ended(pulses, 12.0, 0.5).seen, 2.0);
}

#[test]
fn windows_take_as_many_readings_as_have_twelve_ticks() {
    for (ticks, readings) in [
        (12.0, 10.0),
        // half as many and twice as many are near enough
        (24.0, 10.0),
        (6.0, 10.0),
        (25.0, 5.0),
        (-5.9, 20.0),
        (48.0, 3.0),
        // from 1 to 50
        (500.0, 1.0),
        (0.0, 50.0),
        (0.01, 50.0),
    ] {
        let found = ended(between(12.0, 0.5, 12.0, 0.5), ticks, 0.5);
        near(found.readings, readings);
        let has_changed = readings != 10.0;
        assert_eq!(found.before == [None; 2], has_changed);
        assert_eq!(found.usual == 0.0, has_changed);
    }
    let mut first = between(12.0, 0.5, 12.0, 0.5);
    first.usual = 0.0;
    near(ended(first, 12.5, 0.5).usual, 12.5);
    // readings of half a metre a tick: 7 and 5 ticks are a window
    let mut pulses = PulseCheck::new(0.5, 961.0);
    pulses.readings = 2.0;
    for (ms, travel) in [
        (0, 1.0),
        (100, 4.5),
        (100, 9.0),
        (90, 9.0),
        (250, f64::NAN),
        (250, 9.0),
        (250, 1e9),
    ] {
        pulses.update(1_000_000 * ms, travel);
    }
    near(pulses.ticks, 7.0);
    near(pulses.seconds, 0.1);
    near(pulses.so_far, 1.0);
    pulses.last = Some((100_000_000, 4.5));
    pulses.update(250_000_000, 7.0);
    assert_eq!(pulses.before[1].map(|(ticks, _)| ticks), Some(12.0));
    near(pulses.before[1].unwrap().1, 0.25);
    near(pulses.so_far, 0.0);
    pulses.restart_clock();
    assert_eq!((pulses.last, pulses.before), (None, [None; 2]));
    near(pulses.tick, 0.5);
    near(pulses.turn, 961.0);
}

#[test]
fn each_part_of_a_turn_has_the_ticks_beyond_its_own() {
    // 960 ticks a turn beside one that is missed: 30 of them a part
    let start = || {
        let mut pulses = between(12.0, 0.5, 13.0, 0.75);
        (pulses.part, pulses.passed[5], pulses.beyond[5]) = (5, 7.0, 3.0);
        pulses
    };
    // 12.3 ticks in 0.625 s
    let expected = |seconds: f64| 12.3 * seconds / 0.625;
    for (now, ticks, seconds, part, beyond) in [
        (
            960.0 * 3.0 + 30.0 * 5.5,
            2.0,
            0.125,
            5,
            2.0 - expected(0.125),
        ),
        (
            960.0 * 3.0 + 30.0 * 31.99,
            2.0,
            0.125,
            31,
            2.0 - expected(0.125),
        ),
        (-960.0 + 30.0 * 6.0, -2.0, 0.125, 6, 2.0 + expected(0.125)),
        (960.0 + 30.0 * 6.0, 50.0, 0.125, 6, 3.0),
        (960.0 + 30.0 * 6.0, 0.5, 5.0, 6, -3.0),
    ] {
        let mut pulses = start();
        pulses.by_part(now, ticks, seconds);
        let before = if part == 5 { 3.0 } else { 0.0 };
        let found = f64::from(pulses.beyond[part]);
        let is = before + f64::clamp(beyond, -3.0, 3.0);
        assert!((found - is).abs() < 1e-6, "{found} {is}");
        assert_eq!(pulses.part, part);
        assert_eq!(pulses.passed[5], if part == 5 { 7.0 } else { 8.0 });
        assert_eq!(pulses.passed.iter().sum::<f32>(), pulses.passed[5]);
    }
    // hardly before a whole turn
    let mut pulses = start();
    pulses.by_part(-1e-14, -2.0, 0.125);
    assert_eq!(pulses.part, 31);
    // by the way of the rim, half a metre a tick
    let (mut pulses, travel) = (start(), 0.5 * (960.0 * 3.0 + 30.0 * 6.5));
    pulses.last = Some((0, travel - 1.0));
    pulses.update(125_000_000, travel);
    assert_eq!(pulses.part, 6);
    // what is older than 64 turns counts half
    for (passed, kept, left) in [(63.0, 32.0, 1.5), (62.0, 63.0, 3.0)] {
        let mut pulses = start();
        pulses.passed[5] = passed;
        pulses.by_part(960.0, 2.0, 0.125);
        assert_eq!((pulses.passed[5], pulses.beyond[5]), (kept, left));
    }
    let cases: [(Change, bool); 10] = [
        (|_| (), true),
        (|pulses| pulses.usual = 0.0, false),
        (
            |pulses| (pulses.usual, pulses.before) = (0.0, [Some((0.0, 0.5)); 2]),
            false,
        ),
        (|pulses| pulses.turn = 65.0, true),
        (|pulses| pulses.turn = 64.5, false),
        (|pulses| pulses.before[0] = None, false),
        // a change of two ticks, and as many off the usual ones of both
        (
            |pulses| pulses.before = [Some((11.0, 0.5)), Some((13.0, 0.5))],
            true,
        ),
        (
            |pulses| pulses.before = [Some((11.0, 0.5)), Some((13.1, 0.5))],
            false,
        ),
        (
            |pulses| (pulses.usual, pulses.before) = (12.0, [Some((13.0, 0.5)); 2]),
            true,
        ),
        (
            |pulses| (pulses.usual, pulses.before) = (11.9, [Some((13.0, 0.5)); 2]),
            false,
        ),
    ];
    for (i, (change, counts)) in cases.into_iter().enumerate() {
        let mut pulses = start();
        change(&mut pulses);
        pulses.by_part(960.0, -2.0, 0.125);
        assert_eq!(pulses.passed[5] == 8.0, counts, "{i}");
    }
}

#[test]
fn a_part_that_lacks_a_tick_beyond_the_scatter_is_broken() {
    // the others lie ±0.125 about −0.25, one of them in the middle
    let of = |lacking: f32, passed: f32| {
        let mut pulses = PulseCheck::new(0.5, 961.0);
        pulses.passed = [passed; PARTS];
        for (i, slot) in pulses.beyond.iter_mut().enumerate() {
            let off = [0.125, -0.125][i % 2];
            *slot = passed * if i == 30 { -0.25 } else { off - 0.25 };
        }
        pulses.beyond[9] = passed * (-0.25 - lacking);
        pulses
    };
    // 6 times 0.125 √(30/31): 0.738
    for (lacking, passed, is_broken) in [
        (0.73, 8.0, false),
        (0.745, 8.0, true),
        (0.745, 7.0, false),
        (-0.745, 8.0, false),
    ] {
        assert_eq!(
            of(lacking, passed).has_broken_slot(),
            is_broken,
            "{lacking}"
        );
    }
    // even ones lack half a tick
    for (lacking, is_broken) in [(0.5, false), (0.51, true)] {
        let mut even = of(0.0, 8.0);
        even.beyond = [0.0; PARTS];
        even.beyond[31] = -8.0 * lacking;
        assert_eq!(even.has_broken_slot(), is_broken);
    }
    let mut one = of(0.745, 8.0);
    one.passed[3] = 7.5;
    assert!(!one.has_broken_slot());
}

#[test]
fn pulses_are_missed_from_a_share_to_a_smaller_one() {
    let mut pulses = known(0.02);
    assert_eq!(pulses.share(), Some(0.02));
    for (share, others, misses) in [
        (0.022, 0.0, false),
        (0.023, 0.0, true),
        (0.013, 0.0, true),
        (0.012, 0.0, false),
        (0.013, 0.0, false),
        // twice that of the others
        (0.06, 0.02, false),
        (0.063, 0.02, true),
        (0.023, -0.1, true),
    ] {
        pulses.share = share;
        assert_eq!(pulses.misses(others), misses, "{share} {others}");
    }
    pulses.seen = 1.49;
    assert!(!pulses.misses(0.0));
    assert_eq!(pulses.share(), None);
}
