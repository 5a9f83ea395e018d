//! The soil learner, fed by hand, against closed forms: soils whose pull, torque and sinkage are straight lines over slip.
//! Families, settings, beliefs and readings are drawn from all that is legal.

#![allow(
    clippy::cast_possible_truncation,
    reason = "numbers of readings and of soils"
)]

use grouser_slip::control::WheelObservation;
use grouser_slip::onboard::{
    LEVELS, SLIP_POINTS, SoilBelief, SoilFamily, SoilLearnSettings, SoilLearner, SoilMember,
    WheelSetup,
};
use grouser_slip::prior::{STIFFNESSES, STRENGTHS};
use grouser_slip::{Health, Measurement, Motion, Robot, Wheel};

use crate::noise::Noise;

/// Powers of two, so that means are exact.
const RADIUS_M: f64 = 0.125;
const LOAD_N: f64 = 64.0;
const STEP_S: f64 = 0.125;
const SPEED_M_PER_S: f64 = 1.0;
/// A rim that turns by exactly half a turn a tick, m/s: each tick is a reading once the soil is sheared, by 0.25 m.
const RIM_SPEED_M_PER_S: f64 = std::f64::consts::PI;
/// Beliefs that a learner keeps at most, and the number of readings before ground is compared with one.
const MAX_LAG: usize = 8;
const MIN_READINGS: usize = 3;

/// Value at slip 0, and rise by slip.
type Line = (f64, f64);

fn at((value, rise): Line, slip: f64) -> f64 {
    value + rise * slip
}

/// One soil: pull and torque over the load, sinkage over the radius.
#[derive(Clone, Copy)]
struct Soil {
    pull: Line,
    torque: Line,
    sinkage: Line,
}

const fn level(index: usize) -> (f64, f64) {
    (
        STRENGTHS[index / STIFFNESSES.len()],
        STIFFNESSES[index % STIFFNESSES.len()],
    )
}

/// Slips −0.4, −0.35, … 1.
fn slip_at(point: usize) -> f64 {
    -0.4 + 0.05 * point as f64
}

fn family(soils: &[Soil; LEVELS]) -> SoilFamily {
    let member = |index: usize| {
        let table = |line| core::array::from_fn(|point| at(line, slip_at(point)));
        SoilMember {
            strength: level(index).0,
            stiffness: level(index).1,
            pulls: table(soils[index].pull),
            torques: table(soils[index].torque),
            sinkages: table(soils[index].sinkage),
        }
    };
    let members: Vec<SoilMember> = (0..LEVELS).map(member).collect();
    SoilFamily::from_members(&members, 0.6).unwrap()
}

fn wheel(name: &str, x: f64) -> Wheel {
    Wheel::powered(name).at(x, 0.0).radius(RADIUS_M)
}

fn learner_of(wheels: Vec<Wheel>, family: SoilFamily, settings: SoilLearnSettings) -> SoilLearner {
    let robot = Robot::new("cart".into(), wheels).unwrap();
    let mut setup = WheelSetup::default();
    (setup.load, setup.max_torque) = (LOAD_N, Some(10.0));
    let setups = vec![setup; robot.wheels().len()];
    SoilLearner::new(&robot, &setups, family, settings).unwrap()
}

fn learner(soils: &[Soil; LEVELS], settings: SoilLearnSettings) -> SoilLearner {
    learner_of(vec![wheel("wheel", 0.0)], family(soils), settings)
}

fn with_belief(learner: &SoilLearner, weights: [f64; LEVELS], error_scale: f64) -> SoilBelief {
    let mut belief = *learner.belief();
    (belief.weights, belief.error_scale) = (weights, error_scale);
    belief
}

/// What half a turn of the wheels shows.
#[derive(Clone, Copy, Default)]
struct Reading {
    slip: f64,
    sigma: f64,
    /// Over the load.
    pull: f64,
    torque: Option<f64>,
    /// Over the radius.
    sinkage: Option<f64>,
}

/// Drives a robot of up to three wheels until the reading is taken; true where the belief in use has changed.
fn read(learner: &mut SoilLearner, reading: Reading) -> bool {
    let seen = WheelObservation {
        slip: Some(reading.slip),
        sigma: Some(reading.sigma),
        health: Health::Ok,
        motion: Some(Motion::Driving),
        rim_speed: Some(RIM_SPEED_M_PER_S),
        ..WheelObservation::unknown(LOAD_N)
    };
    let torque = reading.torque.map(|torque| torque * LOAD_N * RADIUS_M);
    let before = learner.estimate().readings;
    for _ in 0..2 {
        learner.add_force([reading.pull, 0.0, 1.0]);
        if let Some(sinkage) = reading.sinkage {
            let depth = sinkage * RADIUS_M;
            learner
                .add_contact(&Measurement::Sinkage { wheel: 0, depth })
                .unwrap();
        }
        let has_changed = learner.update(&[seen; 3], &[torque; 3], (SPEED_M_PER_S, 0.0), STEP_S);
        if learner.estimate().readings > before {
            return has_changed;
        }
    }
    panic!("no reading")
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * (1.0 + a.abs())
}

fn between(noise: &mut Noise, low: f64, high: f64) -> f64 {
    low + (high - low) * noise.uniform()
}

/// One in six times an end of the range, so that limits are met.
fn legal(noise: &mut Noise, (low, high): (f64, f64)) -> f64 {
    match noise.bits() % 12 {
        0 => low,
        1 => high,
        _ => between(noise, low, high),
    }
}

fn any_settings(noise: &mut Noise) -> SoilLearnSettings {
    let mut settings = SoilLearnSettings::default();
    settings.prior_sigma_ln = [legal(noise, (0.01, 2.0)), legal(noise, (0.01, 5.0))];
    settings.model_error = [legal(noise, (1e-3, 1.0)), legal(noise, (0.0, 1.0))];
    settings.sinkage_error = [legal(noise, (1e-3, 1.0)), legal(noise, (0.0, 1.0))];
    settings.sinkage_sigma = legal(noise, (1e-6, 1.0));
    settings.entry_angle_sigma = legal(noise, (1e-6, 1.0));
    settings.weight = legal(noise, (0.0, 1.0));
    settings.forget = legal(noise, (0.0, 0.5));
    settings.hysteresis = legal(noise, (0.0, 1.0));
    settings
}

fn any_soils(noise: &mut Noise) -> [Soil; LEVELS] {
    core::array::from_fn(|_| Soil {
        pull: (between(noise, -0.3, 0.3), between(noise, -0.2, 0.8)),
        torque: (between(noise, 0.05, 0.4), between(noise, -0.1, 0.8)),
        sinkage: (between(noise, 0.2, 0.5), between(noise, -0.2, 0.5)),
    })
}

/// Half of the weights are 0.
fn any_weights(noise: &mut Noise) -> [f64; LEVELS] {
    let mut weights = [0.0; LEVELS];
    weights[(noise.bits() % LEVELS as u64) as usize] = 0.1;
    for weight in &mut weights {
        *weight += noise.uniform() * (noise.bits() % 2) as f64;
    }
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

fn any_reading(noise: &mut Noise) -> Reading {
    Reading {
        slip: between(noise, -0.5, 1.0),
        sigma: noise.uniform(),
        pull: between(noise, -0.5, 0.8),
        torque: (noise.uniform() < 0.7).then(|| between(noise, -0.2, 1.0)),
        sinkage: (noise.uniform() < 0.5).then(|| noise.uniform()),
    }
}

/// Standard deviation of the model's own error.
fn own_sigma([part, share]: [f64; 2], value: f64) -> f64 {
    f64::hypot(part, share * value)
}

/// Mean and standard deviation of a mixture of parts with a weight, a mean and a standard deviation.
fn mixture(parts: &[(f64, f64, f64)]) -> (f64, f64) {
    let sum: f64 = parts.iter().map(|part| part.0).sum();
    let mean = parts.iter().map(|part| part.0 * part.1).sum::<f64>() / sum;
    let variance = |part: &(f64, f64, f64)| part.0 * ((part.1 - mean).powi(2) + part.2.powi(2));
    let variance = parts.iter().map(variance).sum::<f64>() / sum;
    (mean, variance.sqrt())
}

/// Logarithm of the normal density, but for its constant; no reading counts for more than `most` squared sigmas.
fn log_normal(squares: f64, most: f64, variance: f64) -> f64 {
    -0.5 * (squares.min(most) + variance.ln())
}

#[test]
fn a_reading_moves_the_belief_by_bayes_rule() {
    let mut noise = Noise::new(1);
    let (mut missed, mut held) = (0, 0);
    for case in 0..2000 {
        let (settings, soils) = (any_settings(&mut noise), any_soils(&mut noise));
        let mut learner = learner(&soils, settings);
        let prior = *learner.belief();
        let [strength, stiffness] = settings.prior_sigma_ln;
        let density: [f64; LEVELS] = core::array::from_fn(|index| {
            let (of_strength, of_stiffness) = level(index);
            let squares =
                (of_strength.ln() / strength).powi(2) + (of_stiffness.ln() / stiffness).powi(2);
            (-0.5 * squares).exp()
        });
        let sum: f64 = density.iter().sum();
        assert!(
            prior
                .weights
                .iter()
                .zip(density)
                .all(|(found, density)| close(*found, density / sum))
        );
        assert_eq!(prior.error_scale, 1.0);

        let before = with_belief(
            &learner,
            any_weights(&mut noise),
            legal(&mut noise, (0.2, 5.0)),
        );
        learner.restore(&before).unwrap();
        let mut reading = any_reading(&mut noise);
        let inside = reading.slip.clamp(-0.4, 1.0);
        let pulls = learner.predict_pull(reading.slip, reading.sigma);
        // the ends of the interval are within it
        match noise.bits() % 20 {
            0 => reading.pull = pulls.low.clamp(-10.0, 10.0),
            1 => reading.pull = pulls.high.clamp(-10.0, 10.0),
            _ => {}
        }
        let is_missed = !(pulls.low..=pulls.high).contains(&reading.pull);
        let counts = learner.estimate();
        read(&mut learner, reading);

        // the density of pull and torque, whose errors share that of the slip: the pull's, and the torque's given the pull
        let log = |soil: &Soil| {
            let (pull, torque) = (at(soil.pull, inside), at(soil.torque, inside));
            let slip_part = |line: Line| line.1 * reading.sigma;
            let a = own_sigma(settings.model_error, pull)
                .hypot(slip_part(soil.pull))
                .powi(2);
            let off = reading.pull - pull;
            let mut log = match reading.torque {
                None => log_normal(off * off / a, 18.0, a),
                Some(measured) => {
                    let b = own_sigma(settings.model_error, torque)
                        .hypot(slip_part(soil.torque))
                        .powi(2);
                    let c = slip_part(soil.pull) * slip_part(soil.torque);
                    let conditioned = b - c * c / a;
                    let rest = measured - torque - c / a * off;
                    log_normal(
                        off * off / a + rest * rest / conditioned,
                        18.0,
                        a * conditioned,
                    )
                }
            };
            if let Some(depth) = reading.sinkage {
                let expected = at(soil.sinkage, inside);
                let sensor = settings.sinkage_sigma / RADIUS_M;
                let variance = own_sigma(settings.sinkage_error, expected).powi(2)
                    + sensor.powi(2)
                    + slip_part(soil.sinkage).powi(2);
                log += log_normal((depth - expected).powi(2) / variance, 9.0, variance);
            }
            log
        };
        let logs = soils.map(|soil| log(&soil));
        let most = logs.iter().copied().fold(f64::MIN, f64::max);
        let expected: [f64; LEVELS] = core::array::from_fn(|index| {
            let forgotten = (1.0 - settings.forget) * before.weights[index]
                + settings.forget * prior.weights[index];
            forgotten * (settings.weight * (logs[index] - most)).exp()
        });
        let sum: f64 = expected.iter().sum();
        for (found, expected) in learner.belief().weights.iter().zip(expected) {
            // the determinant loses digits where the slip's error is most of both
            assert!(
                (found - expected / sum).abs() < 1e-6,
                "{case}: {found} {}",
                expected / sum
            );
        }
        // a miss of an interval of 90 % widens it
        let factor = (0.5 * if is_missed { 0.9 } else { -0.1_f64 }).exp();
        let scale = (before.error_scale * factor).clamp(0.2, 5.0);
        assert!(close(learner.belief().error_scale, scale), "{case}");
        missed += i32::from(is_missed);
        held += i32::from(scale == 0.2) + i32::from(scale == 5.0);
        let after = learner.estimate();
        assert_eq!(after.readings, counts.readings + 1);
        assert_eq!(after.contact_readings, u32::from(reading.sinkage.is_some()));
    }
    assert!(missed > 100 && held > 30, "{missed} {held}");
}

/// A learner whose belief in use is `weights`.
fn sure(
    soils: &[Soil; LEVELS],
    mut settings: SoilLearnSettings,
    weights: [f64; LEVELS],
    error_scale: f64,
) -> SoilLearner {
    settings.hysteresis = 0.0;
    let mut learner = learner(soils, settings);
    learner
        .restore(&with_belief(&learner, weights, error_scale))
        .unwrap();
    assert!(learner.is_settled() && learner.estimate().changes == 1);
    learner
}

#[test]
fn pull_and_demand_are_mixtures_over_the_soils() {
    let mut noise = Noise::new(2);
    let (mut holds, mut falls) = (0, 0);
    for case in 0..3000 {
        let (settings, mut soils) = (any_settings(&mut noise), any_soils(&mut noise));
        if case % 10 == 0 {
            // as steep as a table may be: slips that are known exactly
            soils = soils.map(|soil| Soil {
                pull: (soil.pull.0, 70.0),
                ..soil
            });
        }
        let (weights, scale) = (any_weights(&mut noise), legal(&mut noise, (0.2, 5.0)));
        let learner = sure(&soils, settings, weights, scale);
        let (slip, sigma) = (between(&mut noise, -0.5, 1.1), noise.uniform());
        let parts: [(f64, f64, f64); LEVELS] = core::array::from_fn(|index| {
            let line = soils[index].pull;
            let pull = at(line, slip.clamp(-0.4, 1.0));
            (
                weights[index],
                pull,
                own_sigma(settings.model_error, pull).hypot(line.1 * sigma),
            )
        });
        let (mean, spread) = mixture(&parts);
        let found = learner.predict_pull(slip, sigma);
        assert!(close(found.mean, mean), "{case}");
        assert!(close(found.high - mean, 1.645 * scale * spread), "{case}");
        assert!(close(mean - found.low, 1.645 * scale * spread), "{case}");

        let slope = between(&mut noise, -0.4, 0.6);
        let pull = slope.tan();
        let demand = learner.demand(slope).unwrap();
        let fails: f64 = (soils.iter().zip(weights))
            .map(|(soil, weight)| {
                let most = at(soil.pull, -0.4).max(at(soil.pull, 1.0));
                let sigmas = (pull - most) / (scale * own_sigma(settings.model_error, most));
                weight * 0.5 * (1.0 + (0.5 * 1.702 * sigmas).tanh())
            })
            .sum();
        assert!(
            close(demand.fails, fails),
            "{case}: {} {fails}",
            demand.fails
        );
        // the soils of which a slip gives the pull; less than the least has the least slip
        let holding: Vec<(f64, f64, f64)> = (soils.iter().zip(weights))
            .filter_map(|(soil, weight)| {
                let (value, rise) = soil.pull;
                let least = pull <= at(soil.pull, -0.4);
                let slip = if least { -0.4 } else { (pull - value) / rise };
                let sigma = own_sigma(settings.model_error, pull) / rise.max(0.05);
                (least || rise > 0.0 && slip <= 1.0).then_some((weight, slip, sigma.min(0.3)))
            })
            .collect();
        let held: f64 = holding.iter().map(|part| part.0).sum();
        if held > 0.5 {
            let found = demand.slip.unwrap();
            let (mean, spread) = mixture(&holding);
            assert!(close(found.mean, mean), "{case}: {found:?} {mean}");
            let spread = scale * spread.max(1e-4);
            assert!(
                (found.sigma - spread).abs() < 1e-6,
                "{case}: {found:?} {spread}"
            );
            holds += 1;
        } else {
            assert_eq!(demand.slip, None, "{case}");
            falls += 1;
        }
        assert_eq!(learner.demand_before(slope), Some(demand));
    }
    assert!(holds > 500 && falls > 500, "{holds} {falls}");
}

#[test]
fn torque_is_that_of_the_belief_over_the_known_soil_within_a_tenth_and_ten() {
    let known = (0..LEVELS)
        .find(|index| level(*index) == (1.0, 1.0))
        .unwrap();
    let mut noise = Noise::new(3);
    let mut ends = [0; 3];
    for case in 0..1000 {
        let mut soils = any_soils(&mut noise);
        soils[known].torque.0 *= [0.01, 1.0, 30.0][case % 3];
        let weights = any_weights(&mut noise);
        let learner = sure(&soils, any_settings(&mut noise), weights, 1.0);
        let slip = noise.uniform();
        let expected: f64 = (soils.iter().zip(weights))
            .map(|(soil, weight)| weight * at(soil.torque, slip))
            .sum();
        let ratio = (expected / at(soils[known].torque, slip)).clamp(0.1, 10.0);
        assert!(close(learner.torque_ratio(slip), ratio), "{case}");
        ends[0] += i32::from(ratio == 0.1);
        ends[1] += i32::from(ratio == 10.0);
        ends[2] += i32::from(ratio > 0.1 && ratio < 10.0);
    }
    assert!(ends.iter().all(|count| *count > 30), "{ends:?}");
    // a known soil that takes no torque is compared with nothing
    let mut soils = any_soils(&mut noise);
    soils[known].torque = (0.0, 0.0);
    assert_eq!(
        sure(
            &soils,
            SoilLearnSettings::default(),
            any_weights(&mut noise),
            1.0
        )
        .torque_ratio(0.3),
        1.0
    );
}

#[test]
fn it_runs_at_the_slip_of_the_greatest_efficiency() {
    let mut noise = Noise::new(4);
    let (mut nowhere, mut ends) = (0, [0; 2]);
    for case in 0..1000 {
        let mut soils = any_soils(&mut noise);
        if case % 5 == 0 {
            // no soil pulls until it slips far
            soils = soils.map(|soil| Soil {
                pull: (-0.6 - soil.pull.0.abs(), 0.9),
                ..soil
            });
        }
        if case % 10 == 1 {
            soils = soils.map(|soil| Soil {
                pull: (-0.3, 0.1),
                ..soil
            });
        }
        let weights = any_weights(&mut noise);
        let found = sure(&soils, SoilLearnSettings::default(), weights, 1.0).running_slip();
        let efficiency = |slip: f64| -> f64 {
            let of = |soil: &Soil| (1.0 - slip) * at(soil.pull, slip) / at(soil.torque, slip);
            let pulls = |soil: &Soil| {
                slip > 1e-9 && at(soil.pull, slip) > 0.0 && at(soil.torque, slip) > 0.0
            };
            (soils.iter().zip(weights))
                .filter(|(soil, _)| pulls(soil))
                .map(|(soil, weight)| weight * of(soil))
                .sum()
        };
        let efficiencies: [f64; SLIP_POINTS] =
            core::array::from_fn(|point| efficiency(slip_at(point)));
        let best = (0..SLIP_POINTS)
            .max_by(|a, b| efficiencies[*a].total_cmp(&efficiencies[*b]))
            .unwrap();
        if efficiencies[best] <= 0.0 {
            assert_eq!(found, None, "{case}");
            nowhere += 1;
            continue;
        }
        // where the derivative of the parabola through three points is 0
        let x = [best - 1, best, best + 1].map(slip_at);
        let y = [best - 1, best, best + 1].map(|point| efficiencies[point]);
        let slope = |i: usize, j: usize| (y[j] - y[i]) / (x[j] - x[i]);
        let bend = (slope(1, 2) - slope(0, 1)) / (x[2] - x[0]);
        let top = 0.5 * (x[0] + x[1]) - 0.5 * slope(0, 1) / bend;
        let expected = top.clamp(0.05, 0.8);
        ends[0] += i32::from(expected == 0.05);
        ends[1] += i32::from(expected == 0.8);
        let found = found.unwrap();
        assert!(
            (found - expected).abs() < 1e-7,
            "{case}: {found} {expected}"
        );
    }
    assert!(nowhere >= 100 && ends[1] > 10, "{nowhere} {ends:?}");
    // an efficiency of a known shape: 1 − (s − 0.23)²
    let line = (-0.05, 0.6);
    let torque = |slip: f64| (1.0 - slip) * at(line, slip) / (1.0 - (slip - 0.23).powi(2));
    let mut members = family(&any_soils(&mut noise)).members().to_vec();
    for member in &mut members {
        member.pulls = core::array::from_fn(|point| at(line, slip_at(point)));
        member.torques = core::array::from_fn(|point| torque(slip_at(point)));
    }
    let one = |members: &[SoilMember]| {
        let mut settings = SoilLearnSettings::default();
        settings.hysteresis = 0.0;
        let family = SoilFamily::from_members(members, 0.6).unwrap();
        let mut learner = learner_of(vec![wheel("wheel", 0.0)], family, settings);
        let mut weights = [0.0; LEVELS];
        weights[5] = 1.0;
        learner
            .restore(&with_belief(&learner, weights, 1.0))
            .unwrap();
        learner.running_slip()
    };
    assert!(close(one(&members).unwrap(), 0.23));
    // a soil that takes no torque has no efficiency
    members[5].torques[27] = 0.0;
    assert!(close(one(&members).unwrap(), 0.23));
    // an efficiency that no number holds has no parabola
    members[5].torques[20] = f64::MIN_POSITIVE * 1e-10;
    assert!(close(one(&members).unwrap(), 0.6));
}

/// Distance between beliefs: the most that a probability differs.
fn difference(a: &SoilBelief, b: &SoilBelief) -> f64 {
    a.weights
        .iter()
        .zip(&b.weights)
        .map(|(a, b)| (a - b).max(0.0))
        .sum()
}

#[test]
fn a_belief_is_taken_up_once_it_differs_and_compared_with_a_robots_length_later() {
    /// Any gentle slope: 3°.
    const SLOPE_RAD: f64 = 0.05;
    let mut noise = Noise::new(5);
    // half a turn of the greatest wheel is 0.393 m: readings until the last wheel stands where the first one stood
    let half_turn = std::f64::consts::PI * RADIUS_M;
    for (length, lag) in [
        (0.0, 2),
        (0.3, 2),
        (half_turn, 3),
        (0.4, 3),
        (0.9, 4),
        (2.0 * half_turn, 4),
        (1.9, 6),
        (9.0, MAX_LAG),
    ] {
        let mut kept = 0;
        for case in 0..40 {
            let soils = any_soils(&mut noise);
            let mut settings = SoilLearnSettings::default();
            settings.hysteresis = [0.0, 0.1, 0.3][case % 3];
            settings.weight = 1.0;
            let wheels = vec![
                wheel("front", 0.5 * length),
                wheel("middle", 0.0).radius(0.07),
                wheel("rear", -0.5 * length),
            ];
            let mut learner = learner_of(wheels, family(&soils), settings);
            let mut used = *learner.belief();
            let mut changes = 0;
            let mut demands = Vec::new();
            assert_eq!(
                (learner.demand(SLOPE_RAD), learner.demand_before(SLOPE_RAD)),
                (None, None)
            );
            assert_eq!(
                (learner.torque_ratio(0.3), learner.running_slip()),
                (1.0, None)
            );
            for count in 1..=20 {
                assert_eq!(learner.is_settled(), count > MIN_READINGS);
                let has_changed = read(
                    &mut learner,
                    Reading {
                        slip: 0.3,
                        sigma: 0.02,
                        pull: between(&mut noise, -0.2, 0.6),
                        ..Reading::default()
                    },
                );
                assert_eq!(
                    has_changed,
                    difference(learner.belief(), &used) > settings.hysteresis
                );
                if has_changed {
                    (used, changes) = (*learner.belief(), changes + 1);
                }
                kept += i32::from(!has_changed);
                let learnt = learner.estimate();
                assert_eq!(
                    (learnt.readings, learnt.changes, learnt.contact_readings),
                    (count as u32, changes, 0)
                );
                let expected = (changes > 0).then(|| {
                    sure(&soils, settings, used.weights, used.error_scale)
                        .demand(SLOPE_RAD)
                        .unwrap()
                });
                assert_eq!(learner.demand(SLOPE_RAD), expected);
                demands.push(expected);
                // before the third reading it was no more than a guess
                let then = (count - 1)
                    .saturating_sub(lag - 1)
                    .max(count.min(MIN_READINGS) - 1);
                assert_eq!(
                    learner.demand_before(SLOPE_RAD),
                    demands[then],
                    "{length} m, {count}"
                );
            }
        }
        assert!(kept > 50, "{kept}");
    }
}

#[test]
fn a_belief_that_does_not_move_is_not_taken_up_again() {
    let mut noise = Noise::new(6);
    let mut settings = SoilLearnSettings::default();
    (settings.weight, settings.forget) = (0.0, 0.0);
    let mut weights = [0.0; LEVELS];
    weights[7] = 1.0;
    let mut learner = sure(&any_soils(&mut noise), settings, weights, 1.0);
    for _ in 0..5 {
        assert!(!read(&mut learner, any_reading(&mut noise)));
    }
    assert_eq!(
        (learner.estimate().changes, learner.estimate().readings),
        (1, 8)
    );
    assert_eq!(learner.belief().weights, weights);
}

#[test]
fn a_belief_of_no_probabilities_is_refused_and_strength_is_also_an_angle() {
    let mut noise = Noise::new(7);
    let mut learner = sure(
        &any_soils(&mut noise),
        SoilLearnSettings::default(),
        any_weights(&mut noise),
        2.0,
    );
    let kept = *learner.belief();
    let learnt = learner.estimate();
    for (found, strength) in [
        (learnt.friction_angle.mean, learnt.strength.mean),
        (learnt.friction_angle.low, learnt.strength.low),
        (learnt.friction_angle.high, learnt.strength.high),
    ] {
        assert!(close(found.tan(), 0.6 * strength));
    }
    for (index, weight, scale) in [
        (3, f64::NAN, 1.0),
        (3, -0.1, 1.0),
        (3, 0.9, 1.0),
        (3, kept.weights[3], 0.19),
        (3, kept.weights[3], 5.1),
    ] {
        let mut broken = with_belief(&learner, kept.weights, scale);
        broken.weights[index] = weight;
        assert!(learner.restore(&broken).is_err(), "{weight} {scale}");
        assert_eq!(*learner.belief(), kept);
    }
}

#[test]
fn half_a_turn_is_a_reading_and_half_of_the_load_stands_for_the_rest() {
    let mut noise = Noise::new(8);
    let soils = any_soils(&mut noise);
    for (loads, counts) in [([64.0, 64.0, 0.0], true), ([64.0, 64.0, 1.0], false)] {
        let robot = Robot::new(
            "cart".into(),
            vec![wheel("a", 0.0), wheel("b", 0.1), wheel("c", 0.2)],
        );
        let setups = loads.map(|load| WheelSetup {
            load,
            max_torque: Some(10.0),
            ..WheelSetup::default()
        });
        let settings = SoilLearnSettings::default();
        let mut learner =
            SoilLearner::new(&robot.unwrap(), &setups, family(&soils), settings).unwrap();
        let seen = WheelObservation {
            slip: Some(0.2),
            sigma: Some(0.01),
            health: Health::Ok,
            motion: Some(Motion::Driving),
            rim_speed: Some(RIM_SPEED_M_PER_S),
            ..WheelObservation::unknown(LOAD_N)
        };
        let unknown = WheelObservation::unknown(LOAD_N);
        for tick in 1..10_u32 {
            learner.add_force([0.1, 0.0, 1.0]);
            learner.update(
                &[seen, unknown, unknown],
                &[None; 3],
                (SPEED_M_PER_S, 0.0),
                STEP_S,
            );
            let readings = if counts { tick - 1 } else { 0 };
            assert_eq!(learner.estimate().readings, readings, "{loads:?}");
        }
    }
}

#[test]
fn every_setting_has_its_limits() {
    type Field = fn(&mut SoilLearnSettings) -> &mut f64;
    let fields: [(Field, f64, f64); 11] = [
        (|s| &mut s.prior_sigma_ln[0], 0.01, 2.0),
        (|s| &mut s.prior_sigma_ln[1], 0.01, 5.0),
        (|s| &mut s.model_error[0], 1e-3, 1.0),
        (|s| &mut s.model_error[1], 0.0, 1.0),
        (|s| &mut s.sinkage_error[0], 1e-3, 1.0),
        (|s| &mut s.sinkage_error[1], 0.0, 1.0),
        (|s| &mut s.sinkage_sigma, 1e-6, 1.0),
        (|s| &mut s.entry_angle_sigma, 1e-6, 1.0),
        (|s| &mut s.weight, 0.0, 1.0),
        (|s| &mut s.forget, 0.0, 0.5),
        (|s| &mut s.hysteresis, 0.0, 1.0),
    ];
    let soils = any_soils(&mut Noise::new(9));
    let robot = Robot::new("cart".into(), vec![wheel("wheel", 0.0)]).unwrap();
    for (index, (field, low, high)) in fields.into_iter().enumerate() {
        for (value, is_legal) in [
            (low, true),
            (high, true),
            (low.next_down(), false),
            (high.next_up(), false),
            (f64::NAN, false),
        ] {
            let mut settings = SoilLearnSettings::default();
            *field(&mut settings) = value;
            let setups = [WheelSetup::default()];
            let learner = SoilLearner::new(&robot, &setups, family(&soils), settings);
            assert_eq!(
                (settings.check().is_ok(), learner.is_ok()),
                (is_legal, is_legal),
                "{index}: {value}"
            );
        }
    }
}

#[test]
fn what_was_begun_and_is_discarded_is_no_reading() {
    let mut noise = Noise::new(10);
    let soils = any_soils(&mut noise);
    let settings = SoilLearnSettings::default();
    let reading = Reading {
        slip: 0.3,
        sigma: 0.02,
        pull: 0.1,
        sinkage: Some(0.3),
        ..Reading::default()
    };
    let mut once = learner(&soils, settings);
    read(&mut once, reading);
    let mut twice = learner(&soils, settings);
    twice.add_force([0.9, 0.0, 1.0]);
    let depth = 0.9 * RADIUS_M;
    let contact = Measurement::Sinkage { wheel: 0, depth };
    twice.add_contact(&contact).unwrap();
    // rolls a step that is too short to shear the soil
    twice.update(
        &[WheelObservation::unknown(LOAD_N)],
        &[None],
        (SPEED_M_PER_S, 0.0),
        STEP_S,
    );
    twice.add_force([0.9, 0.0, 1.0]);
    twice.add_contact(&contact).unwrap();
    twice.discard();
    read(&mut twice, reading);
    assert_eq!(twice.belief(), once.belief());
    assert_eq!(twice.estimate(), once.estimate());
}
