use super::model::tests::{assert_near, correlated, mixture};
use super::*;

const ROUNDING: f64 = 1e-9;
const PLACE_M: [f64; 2] = [1.5, -2.5];
const SLIP_PRIOR: [f64; 2] = [0.15, 0.2];

/// A change of all groups, and the same of one model.
type Change = (fn(&mut MultipleModel), fn(&mut Model));

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < ROUNDING, "{found} {expected}");
}

fn wheels(by_gyro: bool, acceleration: Option<(f64, f64)>) -> WheelStep {
    WheelStep {
        dt: 0.1,
        rim_way: 0.06,
        direction: 0.3,
        turn: 0.04,
        turn_error: TurnError {
            by_gyro,
            removed: 0.02,
            sigma: 0.05,
            memory: 30.0,
        },
        curvature: None,
        acceleration,
        rim: Rim {
            speed: 0.6,
            variance: 1e-3,
            lag: 0.025,
            rise: 0.01,
            gained: 0.02,
        },
        max_slip: MAX_SLIP,
    }
}

/// Groups that have gone some way, by wheels or with an accelerometer, and have been weighed by positions.
fn under_way(acceleration: Option<(f64, f64)>) -> MultipleModel {
    let mut models = MultipleModel::new(SLIP_PRIOR);
    models.advance(&wheels(true, acceleration));
    models.start(PLACE_M, 0.5, 0.3, 0.1);
    for i in 0..3 {
        models.advance(&wheels(true, acceleration));
        let ahead = 0.05 * f64::from(i) + 0.01 * f64::from(i * i);
        let place = [PLACE_M[0] + ahead, PLACE_M[1] + 0.5 * ahead];
        models.update_position(place, ([0.0; 4], 0.0), (Errors::Independent, 0.05, 0.0));
    }
    models
}

fn assert_same(found: &[Group], expected: &[Group]) {
    for (found, expected) in found.iter().zip(expected) {
        near(found.log_evidence, expected.log_evidence);
        for ((model, weight), (of, is)) in found.models().zip(expected.models()) {
            assert_near(model, of.mean, &of.covariance);
            near(weight, is);
        }
    }
}

/// The mean over all groups, and a variance with the least shares that are given.
fn moments(models: &MultipleModel, least: impl Fn(&Group) -> f64) -> ([f64; STATES], Vec<f64>) {
    let all = |share: &dyn Fn(&Group, f64) -> f64| -> (Vec<Model>, Vec<f64>) {
        let of = |(group, own): (&Group, f64)| {
            let share = share(group, own);
            let parts: Vec<_> = group
                .models()
                .map(|(model, weight)| (*model, share * weight))
                .collect();
            parts
        };
        models.groups.iter().zip(models.shares).flat_map(of).unzip()
    };
    let (of, shares) = all(&|_, share| share);
    let (mean, _) = mixture(&of, &shares);
    let (of, shares) = all(&|group, share| f64::max(share, least(group)));
    let total: f64 = shares.iter().sum();
    let square = |i: usize| {
        let about = |model: &Model| model.covariance[i][i] + (model.mean[i] - mean[i]).powi(2);
        of.iter()
            .zip(&shares)
            .map(|(model, share)| share * about(model))
            .sum::<f64>()
            / total
    };
    (mean, (0..STATES).map(square).collect())
}

#[test]
fn a_start_begins_each_model_at_the_place() {
    let mut models = MultipleModel::new([0.9, 0.9]);
    models.set_slip_prior(SLIP_PRIOR);
    models.advance(&wheels(true, None));
    assert!(!models.has_started() && models.motion().is_none());
    models.start(PLACE_M, 0.5, 0.3, 0.1);
    assert!(models.has_started());
    let mut expected = Model::new(0.0, 0.0);
    expected.start(PLACE_M, 0.5, [0.3, 0.1, 0.05], 0.6, SLIP_PRIOR);
    for group in &models.groups {
        for (model, _) in group.models() {
            assert_near(model, expected.mean, &expected.covariance);
        }
    }
    assert_eq!(models.totals(), [0.0; 4]);
    near(models.shares.iter().sum(), 1.0);
    for (found, is) in models.mean.into_iter().zip(expected.mean) {
        near(found, is);
    }
    // from a place to another without a motion that could be
    models.advance(&WheelStep {
        rim_way: f64::NAN,
        ..wheels(true, None)
    });
    assert!(!models.has_started());
}

#[test]
fn a_step_predicts_each_group_by_what_it_uses() {
    let force = Some((0.2, 0.03));
    let before = under_way(None);
    for (start, step, begins, removed) in [
        (under_way(None), wheels(true, force), true, Some(0.05)),
        (under_way(force), wheels(true, force), false, Some(0.05)),
        (under_way(force), wheels(false, None), false, None),
    ] {
        let mut step = step;
        step.turn_error.removed += removed.unwrap_or(0.0);
        let mut expected = start.groups.clone();
        for group in &mut expected {
            let uses = step.acceleration.is_some() && group.is_inertial;
            if begins {
                group.each(|model| model.follow_rim(step.rim));
            }
            if removed.is_none() {
                group.each(|model| model.restart_turn_error(0.05));
            }
            group.mix(step.dt);
            group.each(|model| {
                model.predict(&Step {
                    dt: step.dt,
                    rim_way: step.rim_way,
                    direction: step.direction,
                    turn: step.turn,
                    curvature: step.curvature,
                    turn_error: step.turn_error,
                    removed: removed.unwrap_or(0.0),
                    acceleration: if uses { step.acceleration } else { None },
                    max_slip: step.max_slip,
                });
            });
            if uses {
                group.weigh(|model| model.tie(step.rim));
            }
        }
        let mut found = start.clone();
        found.advance(&step);
        assert_same(&found.groups, &expected);
        assert_eq!(found.was_inertial, step.acceleration.is_some());
        assert_eq!(
            found.force_density,
            step.acceleration.map_or(0.0, |(_, density)| density)
        );
        // totals: by the rims in the middle of the turn, and by the estimate
        let course = start.mean[HEADING] + 0.3 + 0.02;
        let ways = [0.06 * course.cos(), 0.06 * course.sin(), 0.04, 0.06];
        for (i, way) in ways.into_iter().enumerate() {
            near(found.totals()[i] - start.totals()[i], way);
        }
        for axis in [X, Y] {
            near(
                found.path[axis] - start.path[axis],
                found.mean[axis] - start.mean[axis],
            );
        }
        near(found.since_reading_s - start.since_reading_s, 0.1);
    }
    // a restart keeps the totals and what is learnt
    let mut restarted = before.clone();
    restarted.period_s = 0.7;
    restarted.restart();
    assert_eq!(restarted.totals(), before.totals());
    assert_eq!((restarted.direction, restarted.period_s), (0.3, 0.7));
    assert_eq!(restarted.turn_error.sigma, 0.05);
    assert_eq!(restarted.slip_prior, SLIP_PRIOR);
    assert!(!restarted.has_started() && restarted.position_sigma() == before.position_sigma());
}

#[test]
fn a_position_is_weighed_by_each_group_at_its_time() {
    let force = Some((0.2, 0.03));
    let (since, since_s) = ([0.09, 0.04, 0.06, 0.1], 0.15);
    let (prior_m, way_m) = (0.05, 0.03);
    for (start, rim) in [
        (under_way(None), 0.6),
        (under_way(force), 0.6),
        (under_way(force), 0.02),
    ] {
        let mut start = start;
        start.rim.speed = rim;
        start.noise = PositionNoise::new();
        let is_inertial = start.was_inertial;
        let place = [PLACE_M[0] + 0.2, PLACE_M[1] - 0.1];
        let (sin, cos) = f64::sin_cos(start.mean[HEADING] - 0.06 + 0.3);
        let course = Course {
            sin,
            cos,
            variances: [prior_m * prior_m + way_m * way_m; 2],
        };
        let stands = rim <= STANDING_RIM_M_PER_S;
        let mut expected = start.groups.clone();
        for group in &mut expected {
            let late = Since {
                time_s: if is_inertial && group.is_inertial {
                    0.0
                } else {
                    since_s
                },
                way: [since[0], since[1]],
            };
            if !stands {
                group.log_evidence *= f64::exp(-start.since_reading_s / 13.0);
            }
            group.weigh_and_score(stands, |model| model.update_position(place, &late, &course));
            group.pass_jump(&late);
        }
        let best = expected
            .iter()
            .map(|group| group.log_evidence)
            .fold(f64::MIN, f64::max);
        for group in &mut expected {
            group.log_evidence -= best;
        }
        // two degrees of freedom, along the course and across
        let share = 1.0 - start.mean[SLIP];
        let off = [X, Y].map(|axis| place[axis] - start.mean[axis] + since[axis] * share);
        near(start.place(since)[0], place[0] - off[0]);
        near(start.place(since)[1], place[1] - off[1]);
        let known = [X, Y].map(|axis| start.variance(axis));
        let nis = |sin: f64, cos: f64, variance: f64| {
            let of = |a: f64, b: f64| {
                let residual = a * off[0] + b * off[1];
                residual * residual / (a * a * known[0] + b * b * known[1] + variance)
            };
            of(cos, sin) + of(-sin, cos)
        };
        let mut found = start.clone();
        let agreement = found.update_position(
            place,
            (since, since_s),
            (Errors::Independent, prior_m, way_m),
        );
        near(agreement.nis, nis(sin, cos, course.variances[0]));
        near(agreement.inlier, model::inlier_probability(agreement.nis));
        near(
            start.position_agreement(place, since, 0.3),
            model::inlier_probability(nis(0.0, 1.0, 0.09)),
        );
        assert_same(&found.groups, &expected);
        near(found.shares.iter().sum(), 1.0);
    }
}

/// Positions less the way by the estimate have the second differences of their errors.
#[test]
fn the_noise_of_positions_is_that_about_the_way() {
    let mut models = under_way(None);
    models.noise = PositionNoise::new();
    for i in 0..12 {
        models.advance(&wheels(true, None));
        // ±0.02 m about the way of 0.06 m ago, on the axes of the reference's frame at rest
        let late = 0.05 + 2.0 * f64::from(i * i);
        let since = [late, 0.6 * late, 0.0, late];
        let share = 1.0 - models.mean[SLIP];
        let error = if i % 2 == 0 { 0.02 } else { -0.02 };
        let at = |axis: usize| models.path[axis] - since[axis] * share + error;
        let place = [at(0), at(1)];
        models.rim.speed = 0.6;
        // wide: the slip stays as it is
        models.update_position(place, (since, 0.0), (Errors::Independent, 50.0, 1e6));
    }
    let (sin, cos) = f64::sin_cos(models.mean[HEADING] + 0.3);
    let sizes = [0.08 * (cos + sin).abs(), 0.08 * (cos - sin).abs()];
    let learnt = models.position_sigma().unwrap() * f64::sqrt(6.0) * 0.674_489_75;
    assert!(
        sizes.iter().any(|size| (learnt / size - 1.0).abs() < 0.05),
        "{learnt} {sizes:?}"
    );
    // sums wander: each reading inflates the place
    let mut start = under_way(None);
    start.noise = PositionNoise::new();
    let mut found = start.clone();
    let mut inflated = start.clone();
    inflated.inflate(|model| model.inflate_position(0.04));
    let readings = ([0.0; 4], 0.0);
    found.update_position(PLACE_M, readings, (Errors::Summed, 0.2, 0.0));
    inflated.update_position(PLACE_M, readings, (Errors::Independent, 0.06, 0.0));
    assert_same(&found.groups, &inflated.groups);
}

#[test]
fn evidence_fades_and_periods_are_learnt() {
    for (since_s, rim, period, kept) in [
        (0.5, 0.6, 0.2 * 0.5 + 0.8 * 1.2, f64::exp(-0.5 / 13.0)),
        (7.0, -0.6, 0.2 * 2.0 + 0.8 * 1.2, f64::exp(-7.0 / 13.0)),
        (0.0, 0.6, 1.2, 1.0),
        // rims that stand do not show slip
        (0.5, 0.02, 0.2 * 0.5 + 0.8 * 1.2, 1.0),
    ] {
        let mut models = under_way(None);
        (models.since_reading_s, models.period_s, models.rim.speed) = (since_s, 1.2, rim);
        models.groups[2].log_evidence = -3.0;
        models.begin_reading();
        near(models.period_s, period);
        near(models.groups[2].log_evidence, -3.0 * kept);
        assert_eq!(models.since_reading_s, 0.0);
    }
}

#[test]
fn shares_are_those_of_evidence_and_prior_odds() {
    // 0.03 |u| over the slip that the noise of the accelerometer makes in a period, squared: 1 to e⁶
    let gained = 0.04 * f64::sqrt(0.25);
    for (was_inertial, density, rim, odds) in [
        (true, 0.04, -2.0, 2.0 * f64::ln(0.03 * 2.0 / gained)),
        (true, 0.04, 0.1, 0.0),
        (true, 0.04, 0.0, 0.0),
        (true, 0.04, 90.0, 6.0),
        (true, 0.0, 2.0, 0.0),
        (false, 0.04, 2.0, 0.0),
    ] {
        let mut models = under_way(Some((0.2, 0.03)));
        (models.was_inertial, models.force_density) = (was_inertial, density);
        (models.rim.speed, models.period_s) = (rim, 0.25);
        let evidence = [-1.0, -2.5, -0.5, -3.0, -4.0, -0.25, -2.0, -1.5, -0.75];
        for (group, of) in models.groups.iter_mut().zip(evidence) {
            group.log_evidence = of;
        }
        models.reweigh();
        // the third, fifth, sixth and seventh use the accelerometer
        let uses = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0];
        let parts: [f64; GROUPS] = core::array::from_fn(|i| f64::exp(evidence[i] + uses[i] * odds));
        let total: f64 = parts.iter().sum();
        for (i, part) in parts.into_iter().enumerate() {
            near(models.shares[i], part / total);
            near(models.groups[i].log_evidence, evidence[i] + 0.25);
        }
        // a group without it counts little in the variance beside those with it
        let unaided = if was_inertial { 0.001 } else { 0.015 };
        models.shares = [0.3, 0.0, 0.0, 0.0005, 0.0, 0.4, 0.2, 0.0, 0.0995];
        models.average();
        let (mean, variances) = moments(
            &models,
            |group| if group.is_inertial { 0.015 } else { unaided },
        );
        for (i, variance) in variances.into_iter().enumerate() {
            near(models.mean[i], mean[i]);
            near(models.variance(i), variance);
        }
        near(models.heading_sigma().powi(2), models.variance(HEADING));
    }
}

#[test]
fn headings_and_speeds_are_weighed_by_those_that_can() {
    let force = Some((0.2, 0.03));
    for (start, rim) in [
        (under_way(None), 0.6),
        (under_way(force), 0.6),
        (under_way(force), 0.01),
    ] {
        let mut start = start;
        start.rim.speed = rim;
        let is_inertial = start.was_inertial;
        let stands = rim <= STANDING_RIM_M_PER_S;
        let scored = |take: &dyn Fn(&mut Group)| {
            let mut groups = start.groups.clone();
            groups.iter_mut().for_each(take);
            groups
        };
        let relative = |mut groups: [Group; GROUPS]| {
            let best = groups
                .iter()
                .map(|group| group.log_evidence)
                .fold(f64::MIN, f64::max);
            for group in &mut groups {
                group.log_evidence -= best;
            }
            groups
        };
        // at least 1e-3 rad
        for (sigma, is) in [(0.02, 0.02), (1e-5, 1e-3)] {
            let mut found = start.clone();
            found.update_heading(0.45, 0.07, sigma);
            let expected = scored(&|group| {
                group.weigh_and_score(stands, |model| model.update_heading(0.45, 0.07, is * is));
            });
            assert_same(&found.groups, &relative(expected));
        }
        let mut found = start.clone();
        found.update_speed(0.41, 0.05);
        let kept = if stands {
            1.0
        } else {
            f64::exp(-start.since_reading_s / 13.0)
        };
        let expected = scored(&|group| {
            group.log_evidence *= kept;
            if is_inertial && group.is_inertial {
                group.weigh_and_score(stands, |model| model.update_speed(0.41, 0.0025));
            }
        });
        assert_same(&found.groups, &expected);
        let mut found = start.clone();
        found.update_share(0.41, 0.55, 0.05);
        let expected = scored(&|group| {
            if !(is_inertial && group.is_inertial) {
                group.weigh_and_score(stands, |model| model.update_share(0.41, 0.55, 0.0025));
                group.pass_jump(&Since::NOW);
            }
        });
        assert_same(&found.groups, &relative(expected));

        let off: f64 = 0.45 + 0.07 - start.mean[HEADING];
        let nis = off * off / (start.variance(HEADING) + 0.25);
        let whole = core::f64::consts::TAU;
        near(
            start.heading_agreement(0.45 + whole, 0.07, 0.5),
            model::inlier_probability(nis),
        );
        // 1 − s of the rims
        let off = 0.81 - 0.55 * (1.0 - start.mean[SLIP]);
        let nis = off * off / (0.55 * 0.55 * start.variance(SLIP) + 0.01);
        near(
            start.speed_agreement(0.81, 0.55, 0.1),
            model::inlier_probability(nis),
        );
    }
}

#[test]
fn what_restarts_and_grows_does_so_in_each_model() {
    let start = under_way(None);
    let changes: [Change; 4] = [
        (
            |all| all.restart_heading(0.9, 0.2, 0.3, 0.4),
            |model| model.restart_heading(1.1, 0.3, 0.4),
        ),
        (
            |all| all.restart_slip(0.4, 0.1, 0.7, 0.2),
            |model| model.restart_slip([0.4, 0.1], [0.7, 0.2]),
        ),
        (
            |all| all.inflate_position(0.3),
            |model| model.inflate_position(0.09),
        ),
        (
            |all| all.inflate_heading(0.3),
            |model| model.inflate_heading(0.09),
        ),
    ];
    for (all, one) in changes {
        let mut found = start.clone();
        let mut expected = start.groups.clone();
        all(&mut found);
        for group in &mut expected {
            group.each(one);
        }
        assert_same(&found.groups, &expected);
        let (mean, _) = moments(&found, |_| 0.0);
        near(found.mean[HEADING], mean[HEADING]);
        near(found.mean[SLIP], mean[SLIP]);
    }
    let mut found = start;
    found.restart_heading(0.9, 0.2, 0.3, 0.4);
    assert_eq!(found.turn_error.sigma, 0.4);
}

#[test]
fn a_motion_is_that_of_the_rims_less_the_slip_that_is_left() {
    let mut models = under_way(None);
    models.rim.speed = -0.5;
    let slip = models.mean[SLIP];
    let motion = models.motion().unwrap();
    near(motion.speed, -0.5 * (1.0 - slip));
    near(motion.rim_share, 1.0 - slip);
    near(motion.slip, slip);
    near(motion.slip_sigma.powi(2), models.variance(SLIP));
    near(motion.drift_sigma.powi(2), models.variance(DRIFT));
    near(motion.turn_error.variance, models.variance(TURN_ERROR));
    assert_eq!(motion.place, [models.mean[X], models.mean[Y]]);
    let of = [motion.heading, motion.drift, motion.turn_error.value];
    assert_eq!(of, [HEADING, DRIFT, TURN_ERROR].map(|i| models.mean[i]));
    // a quarter of the prior's variance at √3/2 of the slip
    let kept = f64::sqrt(0.75);
    let faded = models.fading_motion(kept).unwrap();
    let slip = 0.15 + kept * (motion.slip - 0.15);
    near(faded.slip, slip);
    near(faded.rim_share, 1.0 - slip);
    near(faded.speed, -0.5 * (1.0 - slip));
    near(
        faded.slip_sigma.powi(2),
        0.75 * motion.slip_sigma.powi(2) + 0.25 * 0.04,
    );
    assert_eq!(models.fading_motion(1.0), models.motion());
    // within ±1
    for (mean, expected) in [(1.5, 1.0), (-1.5, -1.0)] {
        models.mean[SLIP] = mean;
        let motion = models.motion().unwrap();
        assert_eq!((motion.slip, motion.slip_sigma), (expected, 1.0));
    }
    let mut other = models.clone();
    let of = correlated(0.1, 0.1);
    for group in &mut other.groups {
        group.each(|model| model.adopt(&of));
    }
    other.average();
    near(other.motion().unwrap().drift, 0.13);
}
