//! Ways against a brute-force search that knows nothing of the planner's data: Bellman and Ford's relaxation over all
//! states, with moves written out from geometry.
#![allow(
    clippy::too_many_lines,
    reason = "all moves in one place, to be compared with the page"
)]

use grouser_rover::ground::Noise;
use grouser_terrain::plan::{Plan, PlanMap, PlanSettings, plan};
use grouser_terrain::{Error, Headings, MapLayout};

/// A map with random costs, risks and holes.
fn random_map(seed: u64, headings: u8, turning_radius: f64) -> PlanMap {
    let headings = Headings::new(headings).unwrap();
    let mut layout = MapLayout::plain(9, 7, 1.5, headings);
    layout.turning_radius = turning_radius;
    let mut map = PlanMap::unknown(layout);
    let mut noise = Noise::new(seed, 9);
    for cell in 0..map.cells() {
        let is_hole = noise.uniform() < 0.12;
        for heading in 0..headings.count() {
            let pose = cell * headings.count() + heading;
            if is_hole {
                continue;
            }
            #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
            let mut draw = |low: f64, high: f64| (low + (high - low) * noise.uniform()) as f32;
            map.pitch[pose] = draw(-20.0, 20.0);
            map.tip_over[pose] = draw(8.0, 60.0);
            map.risk[pose] = draw(0.0, 0.055);
            map.slip[pose] = draw(-0.2, 0.5);
            map.slip_high[pose] = draw(-0.3, 0.62);
            map.energy[pose] = draw(5.0, 80.0);
        }
    }
    let mut noise = Noise::new(seed, 10);
    for (cvar, energy) in map.energy_cvar.iter_mut().zip(&map.energy) {
        #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
        let factor = (1.0 + 2.0 * noise.uniform()) as f32;
        *cvar = energy * factor;
    }
    map
}

/// The least energy from a cell to another, by relaxing every move until nothing changes.
fn brute_force(map: &PlanMap, from: usize, to: usize, settings: &PlanSettings) -> Option<f64> {
    let layout = &map.layout;
    let (columns, rows, count) = (
        i64::from(layout.columns),
        i64::from(layout.rows),
        layout.headings.count(),
    );
    let angle = |h: usize| layout.headings.angle(h % count);
    let between = |a: usize, b: usize| {
        let off = (angle(a) - angle(b)).abs();
        off.min(std::f64::consts::TAU - off)
    };
    let step = |h: usize| layout.headings.step(h);
    let length = |h: usize| {
        let (x, y) = step(h);
        layout.cell * f64::from(x * x + y * y).sqrt()
    };
    // metres that must be driven straight between two corners
    let straight = |h: usize| {
        let sharpest = between(h, h + 1).max(between(h, h + count - 1));
        2.0 * layout.turning_radius * (sharpest / 2.0).tan()
    };
    let minimised = if settings.by_cvar {
        &map.energy_cvar
    } else {
        &map.energy
    };
    let may = |cell: i64, h: usize| {
        let pose = usize::try_from(cell).unwrap() * count + h;
        map.energy[pose].is_finite()
            && f64::from(map.risk[pose]) <= settings.max_risk
            && f64::from(map.slip_high[pose].abs()) <= settings.max_slip
            && f64::from(map.tip_over[pose]) >= settings.min_tip_over_deg
    };
    let at = |x: i64, y: i64| {
        ((0..columns).contains(&x) && (0..rows).contains(&y)).then_some(y * columns + x)
    };
    // straight metres since the last turn, in steps; more than enough
    let layers = 8_usize;
    let cells = usize::try_from(columns * rows).unwrap();
    let mut cost = vec![f64::INFINITY; cells * count * layers];
    let state = |cell: i64, h: usize, run: usize| {
        (usize::try_from(cell).unwrap() * count + h) * layers + run
    };
    let is = |wanted: Option<usize>, h: usize| wanted.is_none_or(|wanted| wanted == h);
    for h in 0..count {
        if is(settings.start_heading, h) && may(from.try_into().unwrap(), h) {
            cost[state(from.try_into().unwrap(), h, layers - 1)] = 0.0;
        }
    }
    let enough =
        |h: usize, run: usize| run == layers - 1 || run as f64 * length(h) >= straight(h) - 1e-9;
    loop {
        let mut changed = false;
        for cell in 0..columns * rows {
            for h in 0..count {
                for run in 0..layers {
                    let here = cost[state(cell, h, run)];
                    if !here.is_finite() {
                        continue;
                    }
                    let mut relax = |next: usize, value: f64| {
                        if value < cost[next] - 1e-12 {
                            cost[next] = value;
                            changed = true;
                        }
                    };
                    if enough(h, run) {
                        for turned in [(h + 1) % count, (h + count - 1) % count] {
                            if may(cell, turned) {
                                relax(state(cell, turned, 0), here + settings.turn_energy);
                            }
                        }
                    }
                    let (right, up) = step(h);
                    let (x, y) = (cell % columns, cell / columns);
                    let Some(next) = at(x + i64::from(right), y - i64::from(up)) else {
                        continue;
                    };
                    // cells whose square the straight line touches, besides both ends
                    let passed: Vec<Option<i64>> = match (right.abs(), up.abs()) {
                        (1, 1) => vec![at(x + i64::from(right), y), at(x, y - i64::from(up))],
                        (2, 1) => vec![
                            at(x + i64::from(right / 2), y),
                            at(x + i64::from(right / 2), y - i64::from(up)),
                        ],
                        (1, 2) => vec![
                            at(x, y - i64::from(up / 2)),
                            at(x + i64::from(right), y - i64::from(up / 2)),
                        ],
                        _ => Vec::new(),
                    };
                    if !may(next, h) || passed.iter().any(|c| c.is_none_or(|c| !may(c, h))) {
                        continue;
                    }
                    let ends = [cell, next];
                    let mut samples: Vec<i64> = ends.to_vec();
                    if passed.len() == 2 && (right.abs() == 2 || up.abs() == 2) {
                        samples.extend(passed.iter().flatten());
                    }
                    let mean = |value: &dyn Fn(usize) -> f64| {
                        samples
                            .iter()
                            .map(|c| value(usize::try_from(*c).unwrap() * count + h))
                            .sum::<f64>()
                            / samples.len() as f64
                    };
                    let energy = mean(&|pose| f64::from(minimised[pose]))
                        * length(h)
                        * mean(&|pose| 1.0 / f64::from(map.pitch[pose]).to_radians().cos());
                    let run = (run + 1).min(layers - 1);
                    relax(state(next, h, run), here + energy);
                }
            }
        }
        if !changed {
            break;
        }
    }
    let mut best = f64::INFINITY;
    for h in 0..count {
        for run in 0..layers {
            if is(settings.goal_heading, h) && enough(h, run) {
                best = best.min(cost[state(to.try_into().unwrap(), h, run)]);
            }
        }
    }
    best.is_finite().then_some(best)
}

#[test]
fn the_way_is_the_cheapest_that_brute_force_finds() {
    let (mut found, mut none) = (0, 0);
    for seed in 0..60 {
        for (headings, radius) in [(4, 0.0), (8, 0.0), (8, 2.5), (16, 0.0), (16, 6.0)] {
            // any heading, or one that is given: no two of them are the same
            let heading = |own: u8| (seed % 4 == u64::from(own)).then_some(usize::from(own));
            let both = seed % 8 == 4;
            let map = random_map(seed, headings, radius);
            let settings = PlanSettings {
                turn_energy: if seed % 2 == 0 { 0.0 } else { 12.0 },
                by_cvar: seed % 3 == 0,
                start_heading: heading(1).or(both.then_some(3)),
                goal_heading: heading(2).or(both.then_some(0)),
                ..PlanSettings::default()
            };
            let (from, to) = (0, map.cells() - 1);
            let expected = brute_force(&map, from, to, &settings);
            match (plan(&map, (from, to), &settings, 0), expected) {
                (Ok(Plan::Found { route, .. }), Some(expected)) => {
                    let minimised = if settings.by_cvar {
                        route.energy_cvar
                    } else {
                        route.energy
                    };
                    let off = (minimised / expected - 1.0).abs();
                    assert!(
                        off < 1e-9,
                        "{seed} {headings} {radius}: {minimised} {expected}"
                    );
                    assert!(route.risk <= settings.max_risk);
                    assert!(route.tip_over_deg >= settings.min_tip_over_deg);
                    let ends = [route.waypoints.first(), route.waypoints.last()];
                    for (end, wanted) in ends
                        .into_iter()
                        .zip([settings.start_heading, settings.goal_heading])
                    {
                        let heading = end.unwrap().heading;
                        assert!(wanted.is_none_or(|wanted| wanted == heading), "{seed}");
                    }
                    found += 1;
                }
                (Ok(Plan::NoWay { .. }) | Err(Error::Place { .. }), None) => none += 1,
                other => panic!("{seed} {headings} {radius}: {other:?}"),
            }
        }
    }
    assert!(found > 60 && none > 10, "{found} found, {none} not");
}

#[test]
fn where_no_way_keeps_the_bound_the_smallest_bound_that_one_keeps_is_named() {
    let mut named = 0;
    for seed in 0..200 {
        let map = random_map(seed, 8, 0.0);
        let strict = PlanSettings {
            max_risk: 0.01,
            ..PlanSettings::default()
        };
        let Ok(Plan::NoWay { least_risk }) = plan(&map, (0, map.cells() - 1), &strict, 0) else {
            continue;
        };
        let Some(least) = least_risk else { continue };
        named += 1;
        let at = |max_risk: f64| {
            let settings = PlanSettings { max_risk, ..strict };
            plan(&map, (0, map.cells() - 1), &settings, 0).unwrap()
        };
        assert!(matches!(at(least), Plan::Found { .. }));
        assert!(matches!(at(least - 1e-7), Plan::NoWay { .. }));
    }
    assert!(named > 50, "{named}");
}

#[test]
fn the_same_plan_is_the_same_way_and_alternatives_differ() {
    let mut several = 0;
    for seed in 0..20 {
        let map = random_map(seed, 8, 0.0);
        let run = || plan(&map, (0, map.cells() - 1), &PlanSettings::default(), 3);
        let (Ok(one), Ok(again)) = (run(), run()) else {
            continue;
        };
        assert_eq!(one, again);
        if let Plan::Found {
            route,
            alternatives,
        } = one
        {
            several += usize::from(!alternatives.is_empty());
            for other in &alternatives {
                assert!(other.energy >= route.energy);
                assert_ne!(other.waypoints, route.waypoints);
            }
        }
    }
    assert!(several > 3, "{several}");
}

#[test]
fn places_off_the_map_and_on_unknown_ground_are_refused() {
    let mut map = random_map(3, 8, 0.0);
    assert!(matches!(
        map.cell_at("the start", (-0.1, 1.0)),
        Err(Error::Place { .. })
    ));
    assert!(matches!(
        map.cell_at("the goal", (1.0, 10.6)),
        Err(Error::Place { .. })
    ));
    assert!(matches!(
        map.cell_at("the goal", (f64::NAN, 1.0)),
        Err(Error::Place { .. })
    ));
    // 9 by 7 cells of 1.5 m, with their edges
    for (place, cell) in [
        ((0.0, 10.5), 0),
        ((13.5, 10.5), 8),
        ((0.0, 0.0), 6 * 9),
        ((13.5, 0.0), 6 * 9 + 8),
        ((13.5, 5.3), 3 * 9 + 8),
    ] {
        assert_eq!(map.cell_at("the start", place).unwrap(), cell, "{place:?}");
    }
    for beyond in [(13.5 + 1e-9, 1.0), (1.0, -1e-9)] {
        let error = map.cell_at("the start", beyond).unwrap_err().to_string();
        assert!(
            error.contains("x from 0 to 13.5 m and y from 0 to 10.5 m"),
            "{error}"
        );
    }
    // a map of one column
    let headings = Headings::new(4).unwrap();
    let narrow = PlanMap::unknown(MapLayout::plain(1, 3, 2.0, headings));
    assert_eq!(narrow.cell_at("the start", (1.0, 3.0)).unwrap(), 1);
    // the lowest row's first cell
    assert_eq!(map.cell_at("the start", (0.1, 0.1)).unwrap(), 6 * 9);
    let (x, y) = map.place_of(6 * 9);
    assert!((x - 0.75).abs() < 1e-12 && (y - 0.75).abs() < 1e-12);
    for heading in 0..8 {
        map.pitch[heading] = f32::NAN;
        map.energy[heading] = f32::NAN;
    }
    let refused = plan(&map, (0, 20), &PlanSettings::default(), 0);
    let said = refused.unwrap_err().to_string();
    assert!(
        said.contains("the start (0.75, 9.75) lies on ground whose height is not known"),
        "{said}"
    );
}

/// CVaR by its definition as a minimum (Rockafellar and Uryasev 2002, theorem 10), which sorts nothing.
fn cvar(losses: &[f64], level: f64) -> f64 {
    let at = |t: f64| {
        let over = losses.iter().map(|loss| (loss - t).max(0.0)).sum::<f64>();
        t + over / losses.len() as f64 / (1.0 - level)
    };
    // the function of t is convex and has its corners at the losses
    losses.iter().map(|t| at(*t)).fold(f64::INFINITY, f64::min)
}

/// A small map of one heading's energy a cell, and the energies of its soil draws, by cell.
fn map_of_draws(seed: u64, draws: usize, is_ordered: bool, level: f64) -> (PlanMap, Vec<Vec<f64>>) {
    let headings = Headings::new(4).unwrap();
    let mut map = PlanMap::unknown(MapLayout::plain(4, 3, 2.0, headings));
    map.layout.cvar_level = level;
    let mut noise = Noise::new(seed, 11);
    let mut energies = Vec::new();
    for cell in 0..map.cells() {
        let mut of_draws: Vec<f64> = (0..draws).map(|_| 5.0 + 60.0 * noise.uniform()).collect();
        if is_ordered {
            of_draws.sort_by(f64::total_cmp);
        }
        for pose in 4 * cell..4 * cell + 4 {
            map.pitch[pose] = 0.0;
            map.tip_over[pose] = 40.0;
            map.risk[pose] = 0.0;
            map.slip[pose] = 0.1;
            map.slip_high[pose] = 0.1;
            #[allow(clippy::cast_possible_truncation, reason = "7 digits are enough")]
            let per_metre = [of_draws[draws / 2] as f32, cvar(&of_draws, level) as f32];
            [map.energy[pose], map.energy_cvar[pose]] = per_metre;
        }
        energies.push(of_draws);
    }
    (map, energies)
}

/// The energies of all draws on a way through these cells, the robot turning on the spot.
fn way_energies(cells: &[usize], energies: &[Vec<f64>], turn_energy: f64) -> Vec<f64> {
    let heading = |pair: &[usize]| match (pair[0], pair[1]) {
        (from, to) if to == from + 1 => 0_usize,
        (from, to) if from == to + 4 => 1,
        (from, to) if from == to + 1 => 2,
        _ => 3,
    };
    let headings: Vec<usize> = cells.windows(2).map(heading).collect();
    let turns = headings.windows(2).map(|pair| {
        let off = pair[0].abs_diff(pair[1]);
        off.min(4 - off) as f64
    });
    let turning = turn_energy * turns.sum::<f64>();
    (0..energies[0].len())
        .map(|draw| {
            let step = |pair: &[usize]| energies[pair[0]][draw] + energies[pair[1]][draw];
            turning + cells.windows(2).map(step).sum::<f64>() // half of both, times 2 m
        })
        .collect()
}

/// All ways without a loop.
fn all_ways(way: &mut Vec<usize>, to: usize, see: &mut impl FnMut(&[usize])) {
    let at = *way.last().unwrap();
    if at == to {
        see(way);
        return;
    }
    let (x, y) = (at % 4, at / 4);
    let next = [
        (x < 3).then(|| at + 1),
        (x > 0).then(|| at - 1),
        (y < 2).then(|| at + 4),
        (y > 0).then(|| at - 4),
    ];
    for cell in next.into_iter().flatten() {
        if !way.contains(&cell) {
            way.push(cell);
            all_ways(way, to, see);
            way.pop();
        }
    }
}

#[test]
fn the_way_of_least_cvar_is_the_one_that_counting_all_ways_and_draws_finds() {
    let mut differs = 0;
    for seed in 0..60 {
        for (draws, level) in [(10, 0.9), (7, 0.75), (20, 0.0), (16, 0.95)] {
            let (map, energies) = map_of_draws(seed, draws, true, level);
            let settings = PlanSettings {
                turn_energy: 15.0,
                by_cvar: true,
                ..PlanSettings::default()
            };
            let Ok(Plan::Found { route, .. }) = plan(&map, (0, 11), &settings, 0) else {
                panic!("all of it can be driven");
            };
            let (mut least, mut least_energy) = (f64::INFINITY, f64::INFINITY);
            let mut by_energy = f64::NAN;
            all_ways(&mut vec![0], 11, &mut |way| {
                let losses = way_energies(way, &energies, 15.0);
                least = least.min(cvar(&losses, level));
                if losses[draws / 2] < least_energy {
                    (least_energy, by_energy) = (losses[draws / 2], cvar(&losses, level));
                }
            });
            assert!(
                (route.energy_cvar / least - 1.0).abs() < 1e-6,
                "{seed} {draws} {level}: {} {least}",
                route.energy_cvar
            );
            differs += usize::from(by_energy > 1.001 * least);
        }
    }
    assert!(differs > 100, "the two aims must often differ: {differs}");
}

#[test]
fn the_cvar_of_a_way_is_a_bound_where_the_draws_have_no_order() {
    let mut looser = 0;
    for seed in 0..60 {
        let (map, energies) = map_of_draws(seed, 10, false, 0.8);
        let settings = PlanSettings {
            by_cvar: true,
            ..PlanSettings::default()
        };
        let Ok(Plan::Found { route, .. }) = plan(&map, (0, 11), &settings, 0) else {
            panic!("all of it can be driven");
        };
        let mut cells: Vec<usize> = route.waypoints.iter().map(|point| point.cell).collect();
        cells.dedup();
        let exact = cvar(&way_energies(&cells, &energies, 0.0), 0.8);
        assert!(exact <= route.energy_cvar * (1.0 + 1e-6), "{seed}");
        looser += usize::from(exact < 0.98 * route.energy_cvar);
    }
    assert!(looser > 30, "{looser}");
}

/// Every way passes a column of cells in which the robot brakes: it is closed where the braking slip is beyond the greatest one.
#[test]
fn braking_beyond_the_greatest_slip_closes_a_cell() {
    let headings = Headings::new(8).unwrap();
    let mut layout = MapLayout::plain(9, 7, 1.5, headings);
    layout.turning_radius = 0.0;
    let mut map = PlanMap::unknown(layout);
    let settings = PlanSettings {
        max_slip: 0.25,
        ..PlanSettings::default()
    };
    for (slip, is_open) in [(0.2, true), (0.3, false), (-0.2, true), (-0.3, false)] {
        for cell in 0..map.cells() {
            let own = if cell % 9 == 4 { slip } else { 0.1 };
            for pose in cell * headings.count()..(cell + 1) * headings.count() {
                map.pitch[pose] = 0.0;
                map.tip_over[pose] = 40.0;
                map.risk[pose] = 0.0;
                map.slip[pose] = own;
                map.slip_high[pose] = own;
                map.energy[pose] = 20.0;
                map.energy_cvar[pose] = 20.0;
            }
        }
        let found = plan(&map, (27, 35), &settings, 0).unwrap();
        assert_eq!(matches!(found, Plan::Found { .. }), is_open, "{slip}");
    }
}
