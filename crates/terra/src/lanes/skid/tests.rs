use core::cell::Cell;

use super::*;
use crate::catalogue;

#[test]
fn the_inverse_of_two_rows() {
    let rows = [[2.0, 3.0], [4.0, 7.0]];
    assert_eq!(inverse(rows), [[3.5, -1.5], [-2.0, 1.0]]);
    assert_eq!(times(&rows, [5.0, -11.0]), [-23.0, -57.0]);
}

const WIDE: [(f64, f64); 2] = [(-9.0, 9.0); 2];

/// The root of residuals, and how often they were computed.
fn root_of(
    start: (Pair, [Pair; 2]),
    within: [(f64, f64); 2],
    off: impl Fn(bool, Pair) -> Pair,
) -> (Option<Pair>, u32) {
    let count = Cell::new(0);
    let root = broyden(start, within, |is_rough, place| {
        count.set(count.get() + 1);
        for (x, (low, high)) in place.into_iter().zip(within) {
            assert!(low <= x && x <= high, "{place:?}");
        }
        Some(off(is_rough, place))
    });
    (root.map(|(place, _)| place), count.get())
}

fn assert_close(root: Option<Pair>, expected: Pair) {
    let root = root.unwrap();
    assert!(
        (root[0] - expected[0]).abs() < 1e-11 && (root[1] - expected[1]).abs() < 1e-11,
        "{root:?}"
    );
}

/// Source: Gay, *Some convergence properties of Broyden's method* (1979): on n straight residuals it ends after 2 n steps.
#[test]
fn straight_residuals_take_four_steps_from_any_slopes() {
    let off = |_: bool, [x, y]: Pair| {
        let (x, y) = (x - 0.3, y + 0.7);
        [2.0 * x + 0.5 * y, -0.4 * x + 1.1 * y]
    };
    let right = inverse([[2.0, 0.5], [-0.4, 1.1]]);
    // the first place, the root by rough and by exact residuals
    let (root, count) = root_of(([1.0, 1.0], right), WIDE, off);
    assert_close(root, [0.3, -0.7]);
    assert!(count <= 3, "{count}");
    for (i, wrong) in [
        [[1.0, 0.0], [0.0, 1.0]],
        [[0.2, 0.1], [-0.3, 0.5]],
        [[0.7, -0.4], [0.1, 0.3]],
    ]
    .into_iter()
    .enumerate()
    {
        let (root, count) = root_of(([1.0, 1.0], wrong), WIDE, off);
        assert_close(root, [0.3, -0.7]);
        // four steps, and one that sees that it is there
        assert!(count <= 6, "{i}: {count}");
    }
}

#[test]
fn the_exact_residuals_have_the_last_word() {
    // x = 2, y = 3; the rough ones are off by 1e-5
    let rough = Cell::new(0);
    let off = |is_rough: bool, [x, y]: Pair| {
        let shift = if is_rough { 1e-5 } else { 0.0 };
        rough.set(rough.get() + u32::from(is_rough));
        [x * y - 6.0 + shift, x + 0.1 * y * y - 2.9 - shift]
    };
    let slopes = inverse([[3.0, 2.0], [1.0, 0.6]]);
    let (root, count) = root_of(([2.01, 2.98], slopes), WIDE, off);
    assert_close(root, [2.0, 3.0]);
    assert!((2..=4).contains(&rough.get()), "{rough:?}");
    assert!(count <= 9, "{count}");
    // both residuals have to be small before the rough ones end
    for at in [0, 1] {
        let is_exact = Cell::new(false);
        let (_, count) = root_of(([0.0; 2], [[0.0; 2]; 2]), WIDE, |is_rough, _| {
            is_exact.set(is_exact.get() || !is_rough);
            let mut off = [5e-5; 2];
            off[at] = 2e-4;
            off
        });
        assert!(!is_exact.get() && count == MAX_EVALUATIONS);
    }
    // a step of the one or the other unknown that is not small goes on
    for at in [0, 1] {
        let mut inverse = [[0.0; 2]; 2];
        inverse[at][0] = 1.0;
        let (root, count) = root_of(([0.0; 2], inverse), WIDE, |_, _| [5e-5, 0.0]);
        assert_eq!((root, count), (None, MAX_EVALUATIONS));
    }
}

#[test]
fn a_step_ends_at_the_bounds() {
    let off = |_: bool, [x, y]: Pair| [x - 0.5, y + 0.25];
    let long = [[3.0, 0.0], [0.0, 3.0]];
    // three times too far: the root itself lies inside
    let within = [(0.2, 0.8), (-0.4, 0.1)];
    let (root, count) = root_of(([0.3, 0.0], long), within, off);
    assert_close(root, [0.5, -0.25]);
    assert!(count <= 7, "{count}");
    // and a root outside is none
    let (root, count) = root_of(([0.3, 0.0], long), [(0.2, 0.4), (-0.4, 0.1)], off);
    assert_eq!((root, count), (None, MAX_EVALUATIONS));
    assert!(broyden(([0.0; 2], long), within, |_, _| None).is_none());
}

/// Of ordinary wheels the table decides nearly all, as the general search does.
#[test]
fn the_table_decides_as_the_general_search() {
    let mut counts = [0; 3];
    for key in ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"] {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        for (radius, width) in [(0.05, 0.03), (0.3, 0.2)] {
            let wheel = RigidWheel::new(radius, width).unwrap();
            let on_soil = WheelOnSoil::new(wheel, soil, Settings::default()).unwrap();
            let table = SkidTable::new(&on_soil);
            for i in 0..4 {
                let load = 1500.0 * radius * width * 3.0_f64.powi(i);
                for share in [0.0, 0.03, 0.15, 0.5] {
                    let bearing_torque = share * load * radius;
                    let end = table.skid(load, bearing_torque);
                    let alone = on_soil.free_slip(load, bearing_torque).unwrap();
                    let what = std::format!("{key} {radius} {load} {bearing_torque} {alone:?}");
                    match end {
                        End::Found(slip) => {
                            counts[0] += 1;
                            let off = (slip - alone.unwrap().value()).abs();
                            assert!(off < 1e-9, "{what} {off:e}");
                        }
                        End::NoSolution => {
                            counts[1] += 1;
                            assert!(alone.is_none(), "{what}");
                        }
                        End::Unsure => counts[2] += 1,
                    }
                }
            }
        }
    }
    assert_eq!(counts, [129, 7, 24]);
}

#[test]
fn soil_that_springs_back_has_no_table() {
    let on_soil = sand();
    assert!(SkidTable::serving(&on_soil).is_some());
    let soil = on_soil.soil().with_rebound(0.1).unwrap();
    let rising = WheelOnSoil::new(*on_soil.wheel(), soil, Settings::default()).unwrap();
    assert!(SkidTable::serving(&rising).is_none());
}

/// Forces in closed form, W and T/r by row, column and ln θ_1, in place of a soil's.
fn table_of(on_soil: &WheelOnSoil, force: impl Fn(usize, usize, f64) -> Pair) -> SkidTable<'_> {
    let mut table = SkidTable::new(on_soil);
    for (k, row) in table.rows.iter_mut().enumerate() {
        for (i, node) in row.iter_mut().enumerate() {
            *node = force(k, i, table.first + i as f64 * table.step);
        }
    }
    table
}

fn sand() -> WheelOnSoil {
    let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
    let wheel = RigidWheel::new(0.1, 0.05).unwrap();
    WheelOnSoil::new(wheel, soil, Settings::default()).unwrap()
}

/// ln W = 2 ln θ_1 + 5 and T/(r W) = 0.3 s + 0.01 ln θ_1: where a load is carried, and the slopes there.
#[test]
fn where_the_table_carries_a_load() {
    let on_soil = sand();
    let turn = |k: usize, x: f64| 0.3 * (k as f64 / 8.0 - 1.0) + 0.01 * x;
    let table = table_of(&on_soil, |k, _, x| {
        let force = (2.0 * x + 5.0).exp();
        [force, force * turn(k, x)]
    });
    let at = |k: usize, load: f64| {
        let samples = (table.first, 3.1 * table.step);
        table.carried(
            k,
            &Wanted {
                load,
                turn: 0.0,
                samples,
            },
        )
    };
    assert!((table.first - 0.01_f64.ln()).abs() < 1e-15);
    let last = table.first + 31.0 * table.step;
    // the hub reaches the ground
    assert!((last - (core::f64::consts::PI / 2.0).ln()).abs() < 1e-9);
    for k in [0, 3, 8] {
        for x in [-4.2_f64, -3.0, -1.234, -0.3] {
            let load = (2.0 * x + 5.0).exp();
            let Carrying::At(carried) = at(k, load) else {
                panic!("{x} is carried");
            };
            assert_eq!(carried.slip, k as f64 / 8.0 - 1.0);
            let below = ((x - table.first) / table.step).floor();
            assert_eq!(carried.below as f64, below);
            assert!(carried.is_only);
            // the torque is taken as straight in the force, between neighbours that differ by 40 %
            assert!((carried.turn - turn(k, x)).abs() < 3e-4);
            let (place, slopes) = table.place(&carried, load);
            assert!((place - x).abs() < 1e-12, "{place} {x}");
            assert!((slopes[0] - 2.0).abs() < 1e-9 && (slopes[1] - 0.01).abs() < 1e-9);
        }
    }
    // more than any node, and far more
    let top = (2.0 * last + 5.0).exp();
    assert!(matches!(at(4, 1.05 * top), Carrying::Unsure));
    assert!(matches!(at(4, 1.11 * top), Carrying::Not));
    // less than the first node
    let least = (2.0 * table.first + 5.0).exp();
    assert!(matches!(at(4, 0.9 * least), Carrying::Unsure));
}

/// From a node that carries nothing the force is taken as straight in ln θ_1.
#[test]
fn where_a_force_begins() {
    let on_soil = sand();
    // W = 40 (i − begin) N, T/r = −2 W + 30 N
    for begin in [6.0, 6.25] {
        let table = table_of(&on_soil, |_, i, _| {
            let force = 40.0 * (i as f64 - begin);
            [force, -2.0 * force + 30.0]
        });
        let (load, turn) = (10.0, 0.0);
        let samples = (table.first, 3.1 * table.step);
        let wanted = Wanted {
            load,
            turn,
            samples,
        };
        let Carrying::At(carried) = table.carried(5, &wanted) else {
            panic!("10 N are carried");
        };
        assert_eq!((carried.below, carried.slip), (6, -0.375));
        assert!((carried.turn - 1.0).abs() < 1e-12);
        let (place, slopes) = table.place(&carried, load);
        assert!((place - (table.first + (begin + 0.25) * table.step)).abs() < 1e-12);
        // d(W/load) = 4 a step, and d(T/(r W)) = (−80/10 − 1 · 4) a step
        assert!((slopes[0] * table.step - 4.0).abs() < 1e-9);
        assert!((slopes[1] * table.step + 12.0).abs() < 1e-9);
    }
}

/// A vertical force that falls again: whether a sample of the general search lies where it exceeds the load.
#[test]
fn where_a_force_rises_and_falls_again() {
    let on_soil = sand();
    // greatest at node 10, and rising again from node 20 on
    let table = table_of(&on_soil, |_, i, _| {
        let i = i as f64;
        let force = if i < 20.0 {
            100.0 - (i - 10.0).powi(2)
        } else {
            5.0 * (i - 20.0)
        };
        [force, -0.1 * force]
    });
    let at = |load: f64, samples: (f64, f64)| match table.carried(
        2,
        &Wanted {
            load,
            turn: 0.0,
            samples,
        },
    ) {
        Carrying::At(carried) => Some((carried.below, carried.is_only)),
        Carrying::Not => panic!("{load} is carried"),
        Carrying::Unsure => None,
    };
    // of 70 N the nodes 5 to 15 carry more
    let node = |i: f64| table.first + i * table.step;
    let far = 100.0 * table.step;
    assert_eq!(at(70.0, (node(5.001), far)), Some((4, false)));
    assert_eq!(at(70.0, (node(14.999), far)), Some((4, false)));
    assert_eq!(at(70.0, (node(4.999), far)), None);
    assert_eq!(at(70.0, (node(15.001), far)), None);
    // the last of ten samples
    assert_eq!(at(70.0, (node(-3.999), table.step)), Some((4, false)));
    assert_eq!(at(70.0, (node(-4.001), table.step)), None);
    // of 40 N the last nodes carry more too, but not all behind the first
    assert_eq!(at(40.0, (node(5.001), far)), Some((2, false)));
}

/// With ln W = 2.3 x + 0.7 s + 5 and T/(r W) = −0.02 x + 0.4 s + 0.03, x = ln θ_1, all is straight: the search begins where it ends.
#[test]
fn where_a_search_for_a_skid_begins() {
    let on_soil = sand();
    let table = SkidTable::new(&on_soil);
    let (load, share) = (30.0_f64, 0.3);
    let x = |slip: f64| (load.ln() - 0.7 * slip - 5.0) / 2.3;
    let turn = |slip: f64, x: f64| -0.02 * x + 0.4 * slip + 0.03;
    let carried = |k: i32| {
        let slip = f64::from(k) / 8.0 - 1.0;
        let place = |i: usize| table.first + i as f64 * table.step;
        let below = (0..ANGLES).rfind(|i| place(*i) <= x(slip)).unwrap();
        let node = |i: usize| {
            let at = place(i);
            let force = (2.3 * at + 0.7 * slip + 5.0).exp();
            [force, force * turn(slip, at)]
        };
        Carried {
            slip,
            below,
            nodes: [node(below), node(below + 1)],
            turn: turn(slip, x(slip)),
            is_only: true,
        }
    };
    let (low, high) = (carried(5), carried(6));
    let slip = low.slip + share * 0.125;
    let samples = (0.0, 1.0);
    let turn = turn(slip, x(slip));
    let Start {
        place,
        slopes,
        within,
    } = table.start(
        (&low, &high),
        &Wanted {
            load,
            turn,
            samples,
        },
    );
    let near =
        |found: f64, expected: f64| assert!((found - expected).abs() < 1e-11, "{found} {expected}");
    near(place[0], slip);
    near(place[1], x(slip));
    for (found, expected) in slopes.as_flattened().iter().zip([0.7, 2.3, 0.4, -0.02]) {
        near(*found, expected);
    }
    let ends = [
        (low.slip - 0.0125, high.slip + 0.0125),
        (x(high.slip) - table.step, x(low.slip) + table.step),
    ];
    for (found, expected) in within.into_iter().zip(ends) {
        near(found.0, expected.0);
        near(found.1, expected.1);
    }
    // what is wanted: eleven samples from a tenth of the expected entry angle to the hub, and −M/(W r)
    let wanted = table.wanted(load, 0.6);
    near(wanted.turn, -0.2);
    let hub = core::f64::consts::FRAC_PI_2;
    near(wanted.samples.0, on_soil.scan_start(load, hub).ln());
    near(wanted.samples.0 + 10.0 * wanted.samples.1, hub.ln());
}

/// The forces of sand, of which some rows have a torque T/(r W) = c throughout.
#[test]
fn what_the_samples_of_the_torque_decide() {
    let on_soil = sand();
    let real = SkidTable::new(&on_soil);
    let (load, bearing_torque) = (10.0, 0.01);
    // −M/(W r)
    let wanted = -0.01;
    let end = |turns: &[f64]| {
        let table = table_of(&on_soil, |k, i, _| {
            let [force, torque] = real.rows[k][i];
            [force, turns.get(k).map_or(torque, |turn| turn * force)]
        });
        match table.skid(load, bearing_torque) {
            End::Found(slip) => {
                let alone = on_soil.free_slip(load, bearing_torque).unwrap().unwrap();
                assert!((slip - alone.value()).abs() < 1e-9);
                "found"
            }
            End::NoSolution => "locked",
            End::Unsure => "unsure",
        }
    };
    // a torque that rises slowly up to just below the one that is wanted may have turned before
    let mut rising = [wanted - 0.5; 8];
    (rising[6], rising[7]) = (wanted - 0.005, wanted - 0.0049);
    let cases: [(&[f64], &str); 9] = [
        (&[], "found"),
        // the bearing holds the wheel at slip −1, by more than the margin of a hundredth
        (&[wanted + 0.011], "locked"),
        (&[wanted + 0.009], "unsure"),
        (&[wanted - 0.009; 8], "unsure"),
        (&[wanted - 0.011; 8], "unsure"),
        // a torque that falls between two samples by d may have been greater between them by 2 d and the margin
        (&[wanted - 0.5, wanted - 0.744], "found"),
        (&[wanted - 0.5, wanted - 0.746], "unsure"),
        (&rising, "unsure"),
        // it never suffices
        (&[wanted - 0.5; 9], "unsure"),
    ];
    let found = cases.map(|(turns, _)| end(turns));
    assert_eq!(found, cases.map(|(_, expected)| expected));
    // what the table does not know
    for (load, bearing_torque) in [
        (0.0, 0.1),
        (-10.0, 0.1),
        (f64::NAN, 0.1),
        (10.0, -0.1),
        (10.0, f64::NAN),
        (10.0, 1.1e9),
    ] {
        assert!(matches!(real.skid(load, bearing_torque), End::Unsure));
    }
    // a bearing that holds more than any soil
    assert!(matches!(real.skid(10.0, 1e9), End::NoSolution));
}

/// A locked wheel may sink where one that turns does not; several sinkages are for the general search.
#[test]
fn loads_that_are_not_carried_at_every_slip() {
    let on_soil = sand();
    let real = SkidTable::new(&on_soil);
    let is_found = |force: &dyn Fn(usize, usize, Pair) -> Pair| {
        let table = table_of(&on_soil, |k, i, _| force(k, i, real.rows[k][i]));
        match table.skid(10.0, 0.05) {
            End::Found(_) => true,
            End::Unsure => false,
            End::NoSolution => panic!("it turns"),
        }
    };
    let none = [0.1, 0.0];
    assert!(is_found(&|k, _, node| if k < 3 { none } else { node }));
    // where it is carried first, it turns
    assert!(!is_found(&|k, _, node| if k < 3 {
        none
    } else {
        [node[0], node[0]]
    }));
    assert!(!is_found(&|k, _, node| if k == 2 { none } else { node }));
    // close to the load
    assert!(!is_found(&|k, _, node| if k < 3 {
        [9.5, 0.0]
    } else {
        node
    }));
    assert!(!is_found(&|_, i, node| if i == 31 { none } else { node }));
    assert!(!is_found(&|k, i, node| if k == 8 && i == 31 {
        none
    } else {
        node
    }));
}
