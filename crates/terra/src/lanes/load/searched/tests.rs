use std::vec::Vec;

use super::super::super::Lanes;
use super::super::super::plan::{Plan, SINGLE_STEP};
use super::super::*;
use super::*;
use crate::contact::ladder::LIMITS;
use crate::{Kinematics, RigidWheel, Settings, Slip, Soil, SoilParams, WheelOnSoil, catalogue};

/// Twelve lanes full.
const POINTS: usize = 96;

/// Wheels under loads on one soil, whose sinkages are known.
struct Problems {
    soil: Soil,
    prepared: Prepared,
    radius: [f64; POINTS],
    width: [f64; POINTS],
    slip: [f64; POINTS],
    load: [f64; POINTS],
    /// ln θ_1
    x: [f64; POINTS],
}

impl Problems {
    fn new(key: &str) -> Self {
        let soil = catalogue::find(key).unwrap().soil().unwrap();
        let mut problems = Self {
            soil,
            prepared: Prepared::new(&soil).unwrap(),
            radius: [0.0; POINTS],
            width: [0.0; POINTS],
            slip: [0.0; POINTS],
            load: [0.0; POINTS],
            x: [0.0; POINTS],
        };
        for i in 0..POINTS {
            let share = |factor: f64| ((i as f64 + 0.5) * factor).fract();
            problems.radius[i] = 0.03 * 20.0_f64.powf(share(0.618_034));
            problems.width[i] = 0.02 * 20.0_f64.powf(share(0.754_878));
            problems.slip[i] = share(0.569_840);
            let sinkage = problems.radius[i] * 1e-3 * 400.0_f64.powf(share(0.819_173));
            let (on_soil, motion) = problems.point(i);
            let forces = on_soil.forces_at(sinkage, &motion).unwrap();
            problems.load[i] = forces.vertical_force;
            problems.x[i] = on_soil.entry_angle(sinkage, &motion).unwrap().ln();
        }
        problems
    }

    fn point(&self, i: usize) -> (WheelOnSoil, Kinematics) {
        let wheel = RigidWheel::new(self.radius[i], self.width[i]).unwrap();
        let on_soil = WheelOnSoil::new(wheel, self.soil, Settings::default()).unwrap();
        (
            on_soil,
            Kinematics::straight(Slip::new(self.slip[i]).unwrap()),
        )
    }

    /// ln(W/load), DP/W and T/(r W) at ln θ_1 by the general kernel.
    fn found(&self, i: usize, x: f64) -> [f64; 3] {
        let (on_soil, motion) = self.point(i);
        let contact = on_soil.contact(x.exp(), &motion);
        let forces = contact.forces_by(on_soil.tables(), on_soil.order());
        let weight = forces.vertical_force;
        [
            (weight / self.load[i]).ln(),
            forces.drawbar_pull / weight,
            forces.torque / (self.radius[i] * weight),
        ]
    }

    fn inputs(&self) -> Inputs<'_> {
        Inputs {
            radius: &self.radius,
            width: &self.width,
            rebound: &[0.0; POINTS],
            slip: &self.slip,
            given: &self.load,
            soil: None,
        }
    }
}

/// How many errors lie in each power of ten: below 1e-11, 1e-10 … 1, and above.
fn by_size(errors: &[f64]) -> [u32; 13] {
    let mut counts = [0; 13];
    for error in errors {
        let above = (0..12).filter(|k| error.abs() >= 1e-11 * 10.0_f64.powi(*k));
        counts[above.count()] += 1;
    }
    counts
}

/// What each stage of a search leaves of the error of ln θ_1, and what it knows of the slopes of ln W, DP/W and T/(r W): a snapshot
/// of 480 searches, and of the same that begin the fine rule 2 % deeper.
#[test]
fn every_stage_of_a_search_comes_closer() {
    /// Errors of ln θ_1 after the coarsest rule, after the coarse one, and in the end.
    const PLACES: [[u32; 13]; 3] = [
        [0, 0, 0, 0, 7, 52, 150, 105, 130, 36, 0, 0, 0],
        [94, 236, 119, 28, 3, 0, 0, 0, 0, 0, 0, 0, 0],
        [408, 72, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
    ];
    /// Of the slopes after the coarse rule.
    const SLOPES: [[u32; 13]; 3] = [
        [0, 5, 12, 94, 126, 68, 72, 92, 11, 0, 0, 0, 0],
        [0, 0, 1, 27, 105, 104, 61, 66, 57, 31, 28, 0, 0],
        [0, 0, 0, 14, 104, 112, 97, 62, 31, 32, 28, 0, 0],
    ];
    /// Of ln θ_1 and of the slopes where the fine rule began deeper.
    const DEEPER: [[u32; 13]; 4] = [
        [409, 71, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        [0, 0, 16, 127, 150, 138, 48, 1, 0, 0, 0, 0, 0],
        [1, 0, 9, 57, 146, 116, 59, 45, 46, 1, 0, 0, 0],
        [1, 6, 10, 66, 131, 132, 51, 36, 47, 0, 0, 0, 0],
    ];
    let mut places = [const { Vec::new() }; 3];
    let mut slopes = [const { Vec::new() }; 3];
    let mut deeper = [const { Vec::new() }; 4];
    for key in ["dry-sand", "sandy-loam", "clayey-soil", "snow", "lunar"] {
        let problems = Problems::new(key);
        let (prepared, inputs) = (&problems.prepared, problems.inputs());
        let (mut sheet, mut plan) = (LoadSheet::EMPTY, Plan::EMPTY);
        search::<Lanes>(prepared, &inputs, (&mut sheet, &mut plan));
        let mut exponents = prepared.exponents::<Lanes, ABREAST>(&inputs);
        for group in plan.groups() {
            let mut searched = Searched::<Lanes>::nothing();
            searched.begin((prepared, &inputs), &sheet, group);
            let lanes = group.places.into_iter().map(usize::from).enumerate();
            let lanes: Vec<(usize, usize)> = lanes.take(group.count).collect();
            let note = |errors: &mut Vec<f64>, x: Lanes| {
                errors.extend(lanes.iter().map(|&(k, i)| x.0[k] - problems.x[i]));
            };
            let note_slopes = |errors: &mut [Vec<f64>], searched: &Searched<Lanes>| {
                for &(k, i) in &lanes {
                    let [low, high] = [-1e-3, 1e-3].map(|dx| problems.found(i, problems.x[i] + dx));
                    let slope = |j: usize| (high[j] - low[j]) / 2e-3;
                    errors[0].push(searched.per_slope.0[k] * slope(0) - 1.0);
                    errors[1].push(searched.slopes[0].0[k] - slope(1));
                    errors[2].push(searched.slopes[1].0[k] - slope(2));
                }
            };
            note(&mut places[0], searched.x);
            searched.first(&mut exponents);
            searched.second(&mut exponents);
            note(&mut places[1], searched.x);
            note_slopes(&mut slopes, &searched);
            for shift in [0.0, 0.02] {
                let mut searched = searched;
                searched.x += Lanes([shift; 8]);
                searched.fine(&mut exponents);
                for &(k, i) in &lanes {
                    let expected = problems.found(i, searched.x.0[k]);
                    let Found { off, pull, turn } = searched.found;
                    // of the greatest of W, DP and T/r
                    let size = 1.0_f64.max(expected[1].abs()).max(expected[2].abs());
                    for (found, expected) in [off, pull, turn].iter().zip(expected) {
                        let off = (found.0[k] - expected).abs() / size;
                        assert!(off < 2e-9, "{key} {i} {off:e} {size}");
                    }
                }
                let before = searched.x;
                let mut columns = Columns::new();
                let by = (&inputs, &mut exponents);
                searched.finish(by, &mut columns.out());
                for &(k, i) in &lanes {
                    assert_eq!(columns.1[i], SolveStatus::Solved);
                    // only where the fine rule goes on is the place another
                    assert_eq!(before.0[k] != searched.x.0[k], shift != 0.0);
                }
                let last = searched.x - searched.found.off * searched.per_slope;
                if shift == 0.0 {
                    note(&mut places[2], last);
                } else {
                    note(&mut deeper[0], last);
                    note_slopes(&mut deeper[1..], &searched);
                }
            }
        }
    }
    let found = [&places[..], &slopes[..], &deeper[..]].concat();
    let found: Vec<_> = found.iter().map(|errors| by_size(errors)).collect();
    assert_eq!(found, [&PLACES[..], &SLOPES[..], &DEEPER[..]].concat());
}

/// Sinkage, vertical force, drawbar pull and torque of all points.
struct Columns([[f64; POINTS]; 4], [SolveStatus; POINTS]);

impl Columns {
    fn new() -> Self {
        Self([[0.0; POINTS]; 4], [SolveStatus::BadInput; POINTS])
    }

    fn out(&mut self) -> BatchColumns<'_> {
        let [sinkage, vertical_force, drawbar_pull, torque] = &mut self.0;
        BatchColumns {
            sinkage,
            vertical_force,
            drawbar_pull,
            torque,
            status: &mut self.1,
        }
    }
}

/// z = [3 W/((3 − n) b k √(2r))]^(2/(2n + 1)) by Bekker, and z = r θ_1²/2.
#[test]
fn a_search_begins_with_bekkers_closed_form() {
    for key in ["dry-sand", "lunar", "snow"] {
        let problems = Problems::new(key);
        let inputs = problems.inputs();
        let prepared = &problems.prepared;
        let params = problems.soil.params();
        let n = params.n;
        for at in [0, 40] {
            let soil = prepared.soil::<Lanes>(&inputs, at);
            let columns = [inputs.radius, inputs.width, inputs.rebound, inputs.given];
            let base = Base::<Lanes>::new(prepared, &soil, columns.map(|column| eight(column, at)));
            assert!((soil.per_slope.0[0] - 1.0 / (2.0 * n + 1.0)).abs() < 1e-15);
            for k in 0..8 {
                let (radius, width) = (inputs.radius[at + k], inputs.width[at + k]);
                let modulus = problems.soil.laws::<f64>().modulus(width, n);
                let per = (3.0 - n) * width * modulus * (2.0 * radius).sqrt();
                let sinkage = (3.0 * inputs.given[at + k] / per).powf(2.0 / (2.0 * n + 1.0));
                let x = 0.5 * (2.0 * sinkage / radius).ln();
                assert!((base.x.0[k] - x).abs() < 1e-13, "{} {x}", base.x.0[k]);
            }
        }
    }
}

/// Each lane lacks one thing that the lanes need, or none.
#[test]
fn which_points_lanes_serve() {
    let problems = Problems::new("dry-sand");
    let prepared = &problems.prepared;
    let soil = prepared.soil::<Lanes>(&problems.inputs(), 0);
    let sound = |radius: [f64; 8], width: [f64; 8], rebound: [f64; 8], load: [f64; 8]| {
        let columns = [radius, width, rebound, load].map(Lanes);
        Base::<Lanes>::new(prepared, &soil, columns).sound.0
    };
    let radius = [1e-3, 0.999e-3, 100.0, 100.1, 0.1, 0.1, 0.1, f64::NAN];
    let good = [true, false, true, false, true, true, true, false];
    assert_eq!(sound(radius, [0.1; 8], [0.0; 8], [9.0; 8]), good);
    assert_eq!(sound([0.1; 8], radius, [0.0; 8], [9.0; 8]), good);
    let rebound = [0.0, 1e-9, -0.0, 1.0, 0.0, 0.0, 0.0, f64::NAN];
    assert_eq!(sound([0.1; 8], [0.1; 8], rebound, [9.0; 8]), good);
    let load = [
        f64::MIN_POSITIVE,
        0.0,
        1e12,
        1.1e12,
        1.0,
        2.0,
        3.0,
        f64::NAN,
    ];
    assert_eq!(sound([0.1; 8], [0.1; 8], [0.0; 8], load), good);
    // a soil that does not carry a wheel so narrow: k_c/b + k_φ < 0
    let with = |change: fn(&mut SoilParams)| {
        let mut params = *problems.soil.params();
        change(&mut params);
        Prepared::new(&Soil::new(params).unwrap()).unwrap()
    };
    let weak = with(|params| {
        params.pressure = crate::Pressure::Bekker(crate::Bekker {
            k_c: -1e4,
            k_phi: 1e5,
        });
    });
    let soil = weak.soil::<Lanes>(&problems.inputs(), 0);
    let width = Lanes([0.101, 0.099, 0.11, 0.09, 1.0, 1.0, 1.0, 0.05]);
    let base = Base::<Lanes>::new(
        &weak,
        &soil,
        [Lanes([0.1; 8]), width, Lanes([0.0; 8]), Lanes([9.0; 8])],
    );
    assert_eq!(base.sound.0, good);
    // slips, and a front of 0.07 n of the entry angle: n 1.1
    let with_position = with(|params| (params.c_1, params.c_2) = (0.523, 0.5));
    let soil = with_position.soil::<Lanes>(&problems.inputs(), 0);
    let n = problems.soil.params().n;
    let limit = (1.0 - 0.07 * n - 0.523) / 0.5;
    let slip = Lanes([
        0.0,
        -1e-3,
        limit - 1e-9,
        limit + 1e-9,
        0.1,
        0.2,
        0.3,
        f64::NAN,
    ]);
    let base = Base::<Lanes>::new(
        &with_position,
        &soil,
        [0.1, 0.1, 0.0, 9.0].map(|x| Lanes([x; 8])),
    );
    assert_eq!(base.at(&with_position, &soil, slip).sound.0, good);
}

/// Stiffness and depth just inside and outside their limits, at a wheel of which q is 0.6.
#[test]
fn which_rule_serves_where_a_search_is() {
    /// 1 − s, q in the formulas: any wheel serves.
    const SPEED_PER_RIM: f64 = 0.6;
    let step = |x: f64, r_over_k: f64, sound: f64| {
        let (mut sheet, mut plan) = (LoadSheet::EMPTY, Plan::EMPTY);
        sheet.x.store(8, Lanes([x; 8]));
        for (column, value) in
            sheet
                .points
                .iter_mut()
                .zip([SPEED_PER_RIM, r_over_k, 0.7, 0.8, 0.9, sound])
        {
            column.store(8, Lanes([value; 8]));
        }
        choose::<Lanes>(&sheet, &mut plan, 8);
        assert_eq!(plan.steps[..8], [0.0; 8]);
        plan.steps[8]
    };
    // r θ_1 (1 − q cos θ_1)/K with r/K over ln 2, half a percent deeper
    let theta_1 = 0.7;
    let deeper = 1.005 * theta_1;
    for (k, limit) in LIMITS.into_iter().enumerate() {
        let r_over_k =
            limit / (core::f64::consts::LN_2 * deeper * (1.0 - SPEED_PER_RIM * deeper.cos()));
        let at = |factor: f64, sound: f64| step(theta_1.ln(), factor * r_over_k, sound);
        assert_eq!(at(1.0 - 1e-8, 1.0), k as f64);
        assert_eq!(at(1.0 + 1e-8, 1.0), k as f64 + 1.0);
        assert_eq!(at(1.0 - 1e-8, 0.0), SINGLE_STEP);
    }
    for (z_over_r, inside) in [(1.05 * 4.5e-4, 1.0 + 1e-8), (0.99 * 0.5, 1.0 - 1e-8)] {
        let x = |share: f64| (f64::acos(1.0 - share * z_over_r) / 1.005).ln();
        assert_eq!(step(x(inside), 1e-3, 1.0), 0.0);
        assert_eq!(step(x(2.0 - inside), 1e-3, 1.0), SINGLE_STEP);
    }
}

/// The stiffness is that of the general kernel's shear.
#[test]
fn the_stiffness_is_that_of_the_shear() {
    let problems = Problems::new("sandy-loam");
    for i in [0, 7, 31, 60] {
        let (on_soil, motion) = problems.point(i);
        let theta_1 = problems.x[i].exp().min(1.0);
        let contact = on_soil.contact(theta_1, &motion);
        let lanes = |x: f64| Lanes([x; 8]);
        let found = stiffness(
            lanes(theta_1),
            versine(lanes(theta_1)),
            lanes(1.0 - problems.slip[i]),
            lanes(problems.radius[i] * problems.prepared.per_k_shear),
        );
        let expected = contact.shear.stiffness(theta_1);
        assert!((found.0[4] / expected - 1.0).abs() < 1e-9, "{i}");
    }
}

/// A search that ended, by hand: DP/W = 0.3 and T/(r W) = 0.5 at x = ln 0.4 with ln(W/load) = off, and slopes 2, 3 and dx/d ln W = 0.25.
struct Ended {
    x: f64,
    off: f64,
    step: f64,
}

#[test]
fn what_a_search_hands_back() {
    let good = Ended {
        x: 0.4_f64.ln(),
        off: 1e-6,
        step: 1e-4,
    };
    let deep = (f64::acos(0.5) * 1.0001).ln();
    let flat = f64::acos(1.0 - 4.5e-4).ln() - 1e-5;
    // in order: good, off its load, above and below the depths of the lanes, at the ends of both, and two good ones
    let ended = [
        Ended { ..good },
        Ended {
            off: 1.001e-4,
            step: 1e-9,
            ..good
        },
        Ended { x: deep, ..good },
        Ended { x: flat, ..good },
        Ended {
            x: deep - 2e-4,
            ..good
        },
        Ended {
            x: flat + 2e-5,
            ..good
        },
        Ended {
            off: -0.999e-4,
            step: 1e-9,
            ..good
        },
        Ended { ..good },
    ];
    let mut problems = Problems::new("dry-sand");
    problems.slip = [0.4; POINTS];
    let (prepared, inputs) = (&problems.prepared, problems.inputs());
    let all = |of: fn(&Ended) -> f64| Lanes(core::array::from_fn(|k| of(&ended[k])));
    let places = [11, 3, 17, 2, 29, 30, 31, 40_u8];
    let finish = |step: usize, r_over_k: f64| {
        let mut searched = Searched::<Lanes>::nothing();
        searched.group = Group {
            step: Step::at(step),
            places,
            count: 7,
        };
        searched.loaded.q = Lanes([0.6; 8]);
        searched.loaded.r_over_k = Lanes([r_over_k; 8]);
        (searched.x, searched.step) = (all(|of| of.x), all(|of| of.step));
        searched.per_slope = Lanes([0.25; 8]);
        searched.slopes = [2.0, 3.0].map(|slope| Lanes([slope; 8]));
        searched.found = Found {
            off: all(|of| of.off),
            pull: Lanes([0.3; 8]),
            turn: Lanes([0.5; 8]),
        };
        let mut columns = Columns::new();
        let mut exponents = prepared.exponents::<Lanes, ABREAST>(&inputs);
        let by = (&inputs, &mut exponents);
        searched.finish(by, &mut columns.out());
        assert_eq!(searched.x, all(|of| of.x), "no step of the fine rule");
        columns
    };
    let columns = finish(0, 1e-3);
    let served = [true, false, false, false, true, true, true];
    for (k, is_served) in served.into_iter().enumerate() {
        let place = usize::from(places[k]);
        let Ended { x, off, .. } = ended[k];
        let dx = -0.25 * off;
        let found = columns.0.each_ref().map(|column| column[place]);
        if is_served {
            assert_eq!(columns.1[place], SolveStatus::Solved);
            let (radius, load) = (problems.radius[place], problems.load[place]);
            let sinkage = radius * (1.0 - (x + dx).exp().cos());
            assert!((found[0] / sinkage - 1.0).abs() < 1e-9);
            assert_eq!(found[1], load);
            assert!((found[2] / ((0.3 + 2.0 * dx) * load) - 1.0).abs() < 1e-14);
            assert!((found[3] / ((0.5 + 3.0 * dx) * load * radius) - 1.0).abs() < 1e-14);
        } else {
            assert_eq!(columns.1[place], SolveStatus::NotConverged);
            assert!(found.iter().all(|x| x.is_nan()));
        }
    }
    // the eighth does not count
    assert_eq!(columns.1[40], SolveStatus::BadInput);
    // a stiffness beyond the step's limit: of the first lane 0.4 (1 − 0.6 cos 0.4) r/K
    let per_r_over_k = core::f64::consts::LN_2 * 0.4 * (1.0 - 0.6 * 0.4_f64.cos());
    for (factor, expected) in [
        (0.999, SolveStatus::Solved),
        (1.001, SolveStatus::NotConverged),
    ] {
        let columns = finish(1, factor * LIMITS[1] / per_r_over_k);
        assert_eq!(columns.1[11], expected);
    }
}
