use super::super::tests::{
    DIRECTION_RAD, MS, NOW_NS, RIM_M_PER_S, near, settings, started, wheel_step,
};
use super::*;
use crate::filter::multiple_model::WheelStep;

/// By how much the rims' windows lag, and the measured speed.
const LAG_S: f64 = 0.03;
const SPEED_M_PER_S: f64 = 0.36;

/// Rims at 0.5 m/s until 40 ms before the last step, and at 0.6 m/s since.
fn ground() -> GroundTrack {
    let mut ground = started();
    ground.rim_lag = LAG_S;
    for (ago_ms, way) in [(200, 1.0), (40, 1.08), (0, 1.104)] {
        ground
            .history
            .push(NOW_NS - ago_ms * MS, [0.0, 0.0, 0.0, way]);
    }
    ground
}

/// Slip, its standard deviation and speed of the models.
fn motion(ground: &GroundTrack) -> [f64; 3] {
    let motion = ground.models.motion().unwrap();
    [motion.slip, motion.slip_sigma, motion.speed]
}

/// A speed is compared with the rims' mean speed from a lag before its time to a lag after it, along their direction.
#[test]
fn a_speed_is_used_beside_the_rims_of_its_time() {
    let along = SPEED_M_PER_S * f64::cos(DIRECTION_RAD);
    let sigma = settings().speed_sigma;
    // the time of the speed before the last step, ms; the rims' way over the time around it
    for (ago_ms, rim) in [
        (100, Some(0.5)),
        (50, Some((0.5 * 0.04 + 0.6 * 0.02) / 0.06)),
        (30, Some((0.5 * 0.02 + 0.6 * 0.04) / 0.06)),
        (29, None),
    ] {
        let mut ground = ground();
        // some of the models have a speed of their own, beside an accelerometer
        let acceleration = Some((0.3, 0.03));
        let step = wheel_step(0.005);
        ground.models.advance(&WheelStep {
            acceleration,
            ..step
        });
        let mut models = ground.models.clone();
        let taken_ns = NOW_NS - ago_ms * MS;
        let outcome = ground.update_speed((taken_ns, SPEED_M_PER_S), NOW_NS + MS, &settings());
        assert_eq!(
            (outcome, ground.accepted_ns),
            (Outcome::Accepted, Some(NOW_NS + MS))
        );
        assert_eq!(
            ground.awaited_speed,
            rim.is_none().then_some((taken_ns, SPEED_M_PER_S))
        );
        models.update_speed(along, sigma);
        if let Some(rim) = rim {
            models.update_share(along, rim, sigma);
        }
        let expected = GroundTrack {
            models: models.clone(),
            ..ground.clone()
        };
        let (is, expected) = (motion(&ground), motion(&expected));
        assert!(
            is.iter().zip(expected).all(|(a, b)| near(*a, b)),
            "{ago_ms} {is:?} {expected:?}"
        );
        if rim.is_some() {
            continue;
        }
        // the next one uses it at once, beside the rims until the last step
        ground.update_speed((taken_ns + MS, SPEED_M_PER_S), NOW_NS, &settings());
        let rim = (0.5 * 0.019 + 0.6 * 0.04) / 0.059;
        models.update_share(along, rim, sigma);
        models.update_speed(along, sigma);
        let expected = motion(&GroundTrack {
            models,
            ..ground.clone()
        });
        let is = motion(&ground);
        assert!(
            is.iter().zip(expected).all(|(a, b)| near(*a, b)),
            "{is:?} {expected:?}"
        );
        assert_eq!(ground.awaited_speed, Some((taken_ns + MS, SPEED_M_PER_S)));
    }
    // without a history or a lag the rims' present speed
    for has_history in [false, true] {
        let mut ground = ground();
        if has_history {
            ground.rim_lag = 0.0;
        } else {
            ground.history.clear();
        }
        let mut models = ground.models.clone();
        ground.update_speed((NOW_NS - 100 * MS, SPEED_M_PER_S), NOW_NS, &settings());
        models.update_share(along, RIM_M_PER_S, sigma);
        let expected = GroundTrack {
            models,
            ..ground.clone()
        };
        let (is, expected) = (motion(&ground), motion(&expected));
        assert!(
            is.iter().zip(expected).all(|(a, b)| near(*a, b)),
            "{is:?} {expected:?}"
        );
    }
}

/// Speeds that are the rims' less their slip have no noise, however uneven they are, and others theirs, however fast they are.
#[test]
fn the_noise_of_speeds_is_that_beside_the_rims_share() {
    let sigma = |scale: f64, noise: f64| {
        let mut ground = ground();
        ground.history.clear();
        for index in 0..90_i64 {
            let rim = scale * [0.5, 0.62, 0.41, 0.55][usize::try_from(index % 4).unwrap()];
            ground.rim_speed = rim;
            let share = ground.models.motion().unwrap().rim_share;
            let off = noise * [1.0, -1.0, 0.3, -0.7, 0.2][usize::try_from(index % 5).unwrap()];
            let forward = (share * rim + off) / f64::cos(DIRECTION_RAD);
            ground.update_speed((NOW_NS - 100 * MS, forward), NOW_NS, &settings());
        }
        ground.speed_noise.sigma(1.0)
    };
    assert!(sigma(1.0, 0.0) < 1e-3);
    let [slow, fast] = [1.0, 2.0].map(|scale| sigma(scale, 0.02));
    assert!((fast / slow - 1.0).abs() < 1e-6, "{slow} {fast}");
}

#[test]
fn speeds_that_contradict_the_rims_restart_the_slip_or_are_a_slide() {
    for rim_speed in [RIM_M_PER_S, 0.01] {
        let mut ground = ground();
        ground.rim_speed = rim_speed;
        ground.speed_noise = crate::filter::multiple_model::reference_noise::ReferenceNoise::new();
        for _ in 0..6 {
            ground.refused_speeds.accepts(0.0);
        }
        let slow = 0.1 / f64::cos(DIRECTION_RAD);
        ground.update_speed((NOW_NS - 100 * MS, slow), NOW_NS, &settings());
        if rim_speed < 0.02 {
            assert_eq!(ground.slide, Some((slow, NOW_NS)));
            assert!(ground.refused_speeds.is_steady());
        } else {
            // 0.1 m/s beside 0.5 m/s
            let [slip, sigma, _] = motion(&ground);
            assert!(
                near(slip, 0.8) && near(sigma, SHOWN_SLIP_SIGMA),
                "{slip} {sigma}"
            );
            assert!(ground.slide.is_none() && ground.refused_speeds.len() == 0);
        }
    }
    // a speed before any place starts the models at one of their own
    let mut ground = *GroundTrack::boxed(&settings());
    ground.update_speed((NOW_NS, SPEED_M_PER_S), NOW_NS, &settings());
    let motion = ground.models.motion().unwrap();
    assert_eq!((motion.place, motion.heading), ([0.0; 2], 0.0));
    assert_eq!(ground.started_ns, Some(NOW_NS));
    // one that has started keeps its place
    let mut ground = started();
    let before = ground.models.motion().unwrap().place;
    ground.update_speed((NOW_NS, SPEED_M_PER_S), NOW_NS + MS, &settings());
    assert_eq!(ground.models.motion().unwrap().place, before);
    assert_eq!(ground.started_ns, Some(NOW_NS));
}
