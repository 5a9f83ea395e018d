use std::vec::Vec;

use super::*;
use crate::catalogue::tests::dry_sand_with;
use crate::{Bekker, Reece, RigidWheel, Settings, Slip, SoilParams};

const RADIUS_M: f64 = 0.125;
const WIDTH_M: f64 = 0.1;

fn on(change: impl Fn(&mut SoilParams)) -> WheelOnSoil {
    let wheel = RigidWheel::new(RADIUS_M, WIDTH_M).unwrap();
    WheelOnSoil::new(wheel, dry_sand_with(change), Settings::default()).unwrap()
}

fn at(slip: f64) -> Kinematics {
    Kinematics::straight(Slip::new(slip).unwrap())
}

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-11, "{found} {expected}");
}

/// z = [3 W/((3 − n) b k √(2r))]^(2/(2n + 1)), and cos θ_1 = 1 − z/r.
#[test]
fn a_search_begins_with_bekkers_closed_form() {
    let bekker = Pressure::Bekker(Bekker {
        k_c: 2e3,
        k_phi: 9e5,
    });
    let reece = Pressure::Reece(Reece {
        k_c_prime: 3.0,
        k_phi_prime: 400.0,
    });
    for (pressure, n, shape) in [(bekker, 0.8, 2.2), (bekker, 2.8, 0.5), (reece, 1.1, 1.9)] {
        let on_soil = on(|params| {
            (params.pressure, params.n, params.unit_weight) = (pressure, n, Some(15e3));
        });
        let modulus = on_soil.laws().modulus(WIDTH_M, n);
        for z in [0.001, 0.02, 0.05] {
            let per = shape * WIDTH_M * modulus * (2.0 * RADIUS_M).sqrt() / 3.0;
            let load = per * f64::powf(z, n + 0.5);
            near(on_soil.bekker_start(load), f64::acos(1.0 - z / RADIUS_M));
        }
        // at least 1e-9, at most a sinkage of the radius, and 0.9 of the greatest
        assert_eq!(on_soil.bekker_start(1e-300), 1e-9);
        near(
            on_soil.bekker_start(1e12),
            0.9 * core::f64::consts::FRAC_PI_2,
        );
        near(on_soil.scan_start(1e12, 0.4), 0.02);
    }
    // a search ends where the hub, or the soil behind the wheel, is reached
    for (rebound, share) in [(0.0_f64, 1.0_f64), (0.5, 1.0), (1.0, 1.0), (2.0, 0.5)] {
        let on_soil = on(|params| params.rebound = rebound);
        let limit = on_soil.entry_limit(&at(0.1));
        near(limit, f64::acos(1.0 - share));
        // just below
        assert!(limit < f64::acos(1.0 - share));
    }
}

/// Eleven entry angles in equal ratios, from a tenth of the expected one to the limit.
#[test]
fn a_scan_brackets_the_load() {
    let on_soil = on(|_| ());
    let motion = at(0.1);
    let top = on_soil.entry_limit(&motion);
    let new = || Search {
        low: 0.0,
        high: top,
        proven: false,
        evaluations: 0,
    };
    let force = |theta_1: f64| {
        let contact = on_soil.contact(theta_1, &motion);
        contact
            .forces_by(on_soil.tables(), on_soil.order())
            .vertical_force
    };
    let scan = |search: &mut Search, load: f64| {
        let ladder = Ladder::new(on_soil.scan_start(load, top), top);
        search.scan(load, (&ladder, [None; Ladder::COUNT]), None, &force)
    };
    let load = 60.0;
    let least = on_soil.scan_start(load, top);
    let ratio = (top / least).powf(0.1);
    let mut search = new();
    assert_eq!(scan(&mut search, load), Ok(false));
    assert!(search.proven && search.evaluations == 11);
    near(search.high / search.low, ratio);
    let steps = (search.low / least).ln() / ratio.ln();
    assert!((steps - steps.round()).abs() < 1e-9, "{steps}");
    assert!(force(search.low) < load && load <= force(search.high));
    // between the last two of great loads, and more than any
    let ratio = 20.0_f64.powf(0.1);
    let second = force(top / ratio);
    for share in [0.001, 0.999] {
        let load = second + share * (force(top) - second);
        near(on_soil.scan_start(load, top), 0.05 * top);
        let mut search = new();
        scan(&mut search, load).unwrap();
        assert_eq!(search.high, top);
        near(search.low, top / ratio);
    }
    let greatest = force(top);
    assert_eq!(scan(&mut new(), 1.001 * greatest), Err(greatest));
}

#[test]
fn the_middle_of_a_bracket() {
    let middle = |low: f64, high: f64| {
        let (proven, evaluations) = (true, 0);
        Search {
            low,
            high,
            proven,
            evaluations,
        }
        .middle()
    };
    near(middle(0.1, 0.4), 0.2);
    near(middle(0.0, 0.4), 0.04);
}

/// A bracket in which the load may be, and where the force was looked at.
fn looks<T>(
    (low, high): (f64, f64),
    force: &dyn Fn(f64) -> f64,
    by: impl Fn(&mut Search, &dyn Fn(f64) -> f64) -> T,
) -> (T, Vec<f64>) {
    let seen = core::cell::RefCell::new(Vec::new());
    let mut search = Search {
        low,
        high,
        proven: low > 0.0,
        evaluations: 0,
    };
    let found = by(&mut search, &|theta_1| {
        seen.borrow_mut().push(theta_1);
        force(theta_1)
    });
    let seen = seen.take();
    assert_eq!(seen.len(), search.evaluations as usize);
    (found, seen)
}

/// A force that rises by 1 N/rad, falls between 0.2 and 0.4 rad and rises again carries 0.15 N at three entry angles.
#[test]
fn a_scan_finds_other_crossings() {
    let force = |theta_1: f64| {
        if theta_1 < 0.4 {
            theta_1.min(0.3 - 0.5 * theta_1)
        } else {
            theta_1 - 0.3
        }
    };
    for (load, several, at) in [(0.08, false, 0.08), (0.15, true, 0.15), (0.5, false, 0.8)] {
        let (found, seen) = looks((0.0, 1.0), &force, |search, force| {
            (
                search.scan(
                    load,
                    (&Ladder::new(0.05, search.high), [None; Ladder::COUNT]),
                    None,
                    &force,
                ),
                (search.low, search.high),
            )
        });
        assert_eq!(found.0, Ok(several), "{load}");
        // hardly more than the eleven: the corners may hide a turn
        assert!((11..=16).contains(&seen.len()), "{load} {}", seen.len());
        let (low, high) = found.1;
        assert!(low < at && at <= high, "{load}: {low} {high}");
    }
}

/// A top between two of the eleven angles, which lies above the load, is found where the samples beside it show it.
#[test]
fn a_scan_finds_a_top_between_its_samples() {
    let top = 0.33_f64;
    let force = |theta_1: f64| {
        let place = (theta_1 / top).ln();
        0.5 * theta_1 + 0.25 * (-(place * place) / 0.03).exp()
    };
    // 0.4 N are reached before the top, 0.5 N and more only behind it
    for (load, several) in [(0.40, true), (0.45, false)] {
        let (found, seen) = looks((0.0, 1.4), &force, |search, force| {
            (
                search.scan(
                    load,
                    (&Ladder::new(0.05, search.high), [None; Ladder::COUNT]),
                    None,
                    &force,
                ),
                search.low,
                search.high,
            )
        });
        let (found, low, high) = found;
        assert_eq!(found, Ok(several), "{load}");
        assert_eq!(high < 0.5, several, "{load} {low} {high}");
        assert!(seen.len() <= 40, "{}", seen.len());
    }
}

/// By hand, in logarithms: a force of θ_1^p takes one secant, and a step that would leave the bracket takes its middle.
#[test]
fn a_load_is_sought_by_secants_in_logarithms() {
    const LOAD_N: f64 = 8.0;
    let seek = |bracket: (f64, f64), start: (f64, f64), force: &dyn Fn(f64) -> f64| {
        let (found, seen) = looks(bracket, force, |search, force| {
            search.secant(LOAD_N, start, &force)
        });
        let LoadOutcome::Solved(theta_1) = found else {
            panic!("{found:?}");
        };
        near(theta_1, 0.3);
        seen
    };
    let same = |seen: &[f64], expected: &[f64]| {
        assert_eq!(seen.len(), expected.len(), "{seen:?}");
        seen.iter()
            .zip(expected)
            .for_each(|(seen, expected)| near(*seen, *expected));
    };
    let open = (0.0, 1.5);
    for power in [1.0, 2.5, 0.3] {
        let force = |theta_1: f64| LOAD_N * f64::powf(theta_1 / 0.3, power);
        same(&seek(open, (0.1, power), &force), &[0.1, 0.3]);
        // ln θ_1 moves by a share of what it lacks
        let short = 0.1 * f64::powf(3.0, 1.0 / 1.3);
        same(&seek(open, (0.1, 1.3 * power), &force), &[0.1, short, 0.3]);
        // below the bracket, above it
        let middle = f64::sqrt(0.2 * 0.5);
        same(&seek((0.2, 0.5), (0.1, power), &force), &[middle, 0.3]);
        let middle = f64::sqrt(0.25 * 0.5);
        same(
            &seek((0.2, 0.5), (0.25, 0.05 * power), &force),
            &[0.25, middle, 0.3],
        );
    }
    // without a force there is no slope: the middle of the bracket, before its end is looked at
    let lifted = |theta_1: f64| LOAD_N * (theta_1 - 0.2) / 0.1;
    let seen = seek(open, (0.1, 1.0), &lifted);
    near(seen[1], f64::sqrt(0.1 * 1.5));
    // a force that jumps over the load
    let jump = 1e-3;
    let (found, _) = looks(
        open,
        &|theta_1| if theta_1 < jump { 4.0 } else { 16.0 },
        |search, force| search.secant(LOAD_N, (0.1, 1.0), &force),
    );
    let LoadOutcome::Solved(theta_1) = found else {
        panic!("{found:?}");
    };
    assert!((0.0..1e-18).contains(&(theta_1 - jump)), "{theta_1:e}");
    // it ends where two steps in turn leave 1e-14: quadratic in the logarithm
    for (bend, looked) in [(0.1, 6), (-0.2, 7)] {
        let force = |theta_1: f64| {
            let place = f64::ln(theta_1 / 0.3);
            LOAD_N * f64::exp(place + bend * place * place)
        };
        let seen = seek(open, (0.1, 1.0), &force);
        assert_eq!(seen.len(), looked, "{bend}");
    }
}

/// Rough forces of eight entry angles against those of the search, over soils, motions and laws without a restart.
#[test]
fn rough_forces_are_as_good_as_a_scan_takes_them() {
    let mut state = 7_u64;
    let mut draw = |low: f64, high: f64| {
        // splitmix64
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    let laws = [
        crate::ShearLaw::Coupled,
        crate::ShearLaw::Independent,
        crate::ShearLaw::SlipVelocity,
        crate::ShearLaw::SlipVelocityRegular,
    ];
    let (mut worst, mut count) = (0.0_f64, 0);
    for i in 0..4000 {
        let numbers = [
            draw(0.3, 2.0),
            draw(0.0, 5e3),
            10_f64.powf(draw(-3.0, -1.3)),
            draw(-0.4, 0.4).max(0.0),
        ];
        let soil = dry_sand_with(|params| {
            [params.n, params.cohesion, params.k_shear, params.rebound] = numbers;
        });
        let wheel = RigidWheel::new(10_f64.powf(draw(-1.5, -0.4)), 0.1).unwrap();
        let settings = Settings {
            shear: laws[i % laws.len()],
            ..Settings::default()
        };
        let on_soil = WheelOnSoil::new(wheel, soil, settings).unwrap();
        let (slip, drift) = (draw(-1.0, 1.0), draw(-0.3, 0.3));
        let motion = Kinematics::with_slip_angle(
            Slip::new(slip).unwrap(),
            crate::Angle::from_rad(if i % 2 == 0 { 0.0 } else { drift }),
        )
        .unwrap();
        let contact = on_soil.contacts(&motion);
        let top = on_soil.entry_limit(&motion);
        let places = [0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0].map(|share| share * top);
        let contacts = places.map(&contact);
        for (contact, rough) in contacts.iter().zip(EightNodes::best().rough(&contacts)) {
            let exact = contact.forces_by(on_soil.tables(), on_soil.order());
            let most = contact.most_force(&rough);
            let rough = contact.assemble(&rough);
            let off = (rough.vertical_force - exact.vertical_force).abs() / most;
            worst = worst.max(off);
            count += 1;
        }
    }
    assert!(worst < ROUGH_ERROR && count == 32_000, "{worst}");
}
