use super::super::tests::{
    DIRECTION_RAD, HEADING_RAD, MS, NOW_NS, PLACE_M, near, settings, started,
};
use super::*;

/// The standard deviation of a position, m.
const SIGMA_M: f64 = 0.001;

#[test]
fn a_slip_is_that_of_two_speeds_of_one_sign() {
    for (robot, rim, slip) in [
        (0.3, 0.4, Some(0.25)),
        (-0.3, -0.4, Some(0.25)),
        (0.5, 0.4, Some(-0.2)),
        (-0.5, -0.4, Some(-0.2)),
        (0.4, 0.4, Some(0.0)),
        (0.3, -0.4, None),
        (0.0, 0.4, None),
        (0.3, 0.0, None),
    ] {
        let is = slip_between(robot, rim);
        assert_eq!(is.is_some(), slip.is_some(), "{robot} {rim}");
        assert!(
            near(is.unwrap_or(0.0), slip.unwrap_or(0.0)),
            "{robot} {rim}"
        );
    }
}

/// A restart: the course since the first refused position, m and rad, the rims' way meanwhile, m, and the heading that was measured.
#[derive(Clone, Copy)]
struct Restart {
    course: f64,
    angle: f64,
    rim_way: f64,
    rim_speed: f64,
    yaw: Option<f64>,
    has_heading: bool,
}

const DRIVEN: Restart = Restart {
    course: 0.8,
    angle: 0.9,
    rim_way: 1.0,
    rim_speed: 0.5,
    yaw: None,
    has_heading: true,
};

impl Restart {
    /// Heading, its standard deviation, and slip after it, and by how much measured headings are off.
    fn after(self, position_sigma: f64) -> [f64; 4] {
        let mut ground = started();
        ground.rim_speed = self.rim_speed;
        ground.has_heading = self.has_heading;
        ground.refused_position = PLACE_M;
        ground.refused_way = ground.models.totals()[3] - self.rim_way;
        for _ in 0..6 {
            ground.refused.accepts(0.0);
        }
        let (sin, cos) = f64::sin_cos(self.angle);
        let place = [
            PLACE_M[0] + self.course * cos,
            PLACE_M[1] + self.course * sin,
        ];
        let settings = FilterSettings {
            position_sigma,
            ..settings()
        };
        ground.heading_offset = 0.25;
        ground.restart_along_course((NOW_NS - MS, NOW_NS), place, self.yaw, &settings);
        let motion = ground.models.motion().unwrap();
        assert!(near(motion.place[0], place[0]) && near(motion.place[1], place[1]));
        assert_eq!(
            (ground.restarts, ground.readmitted_ns, ground.refused.len()),
            (1, Some(NOW_NS), 0)
        );
        [
            motion.heading,
            ground.models.heading_sigma(),
            motion.slip,
            ground.heading_offset - 0.25,
        ]
    }

    fn is(self, position_sigma: f64, expected: [f64; 4]) {
        let after = self.after(position_sigma);
        for (a, b) in after.into_iter().zip(expected) {
            assert!((a - b).abs() < 1e-9, "{after:?} {expected:?}");
        }
    }
}

#[test]
fn models_restart_along_the_course_that_the_robot_drove() {
    let by_course = DRIVEN.angle - DIRECTION_RAD;
    let prior = settings().slip.mean;
    // as a course is known no better than a measured heading
    DRIVEN.is(SIGMA_M, [by_course, MEASURED_HEADING_SIGMA_RAD, 0.2, 0.0]);
    let sigma = core::f64::consts::SQRT_2 * 0.02 / 0.8;
    DRIVEN.is(0.02, [by_course, sigma, 0.2, 0.0]);
    let stands = Restart {
        rim_speed: 0.0,
        ..DRIVEN
    };
    stands.is(SIGMA_M, [by_course, MEASURED_HEADING_SIGMA_RAD, 0.2, 0.0]);
    let braking = Restart {
        course: 1.5,
        rim_way: 1.2,
        ..DRIVEN
    };
    braking.is(SIGMA_M, [by_course, MEASURED_HEADING_SIGMA_RAD, -0.2, 0.0]);
    // backwards the heading is against the course
    let angle = DRIVEN.angle - core::f64::consts::PI;
    let back = Restart {
        angle,
        rim_way: -1.0,
        rim_speed: -0.5,
        ..DRIVEN
    };
    back.is(SIGMA_M, [by_course, MEASURED_HEADING_SIGMA_RAD, 0.2, 0.0]);
    // a course of 1.5 times the rims' way is a jump: the heading is the one before, and the slip along it
    let jump = Restart {
        course: 1.5,
        angle: 0.0,
        ..DRIVEN
    };
    let along = 1.5 * f64::cos(HEADING_RAD + DIRECTION_RAD);
    jump.is(
        SIGMA_M,
        [HEADING_RAD, MAX_HEADING_SIGMA_RAD, 1.0 - along, 0.0],
    );
    // so it is where the course is not known to 0.2 rad, and the slip then is its prior
    DRIVEN.is(0.12, [HEADING_RAD, MAX_HEADING_SIGMA_RAD, prior, 0.0]);
}

#[test]
fn a_measured_heading_is_overruled_by_a_long_course_that_contradicts_it() {
    let by_course = DRIVEN.angle - DIRECTION_RAD;
    let sigma = core::f64::consts::SQRT_2 * SIGMA_M / DRIVEN.course;
    let with = |yaw: f64| Restart {
        yaw: Some(yaw),
        ..DRIVEN
    };
    let measured = MEASURED_HEADING_SIGMA_RAD;
    for sign in [-1.0, 1.0] {
        // within three standard deviations and beyond, also round the circle
        let [near, far] = [2.99, 3.01].map(|sigmas| by_course + sign * sigmas * sigma);
        let slip = |heading: f64| 1.0 - 0.8 * f64::cos(DRIVEN.angle - heading - DIRECTION_RAD);
        with(near).is(SIGMA_M, [near, measured, slip(near), 0.0]);
        with(far).is(SIGMA_M, [by_course, measured, 0.2, by_course - far]);
        let round = near + core::f64::consts::TAU;
        with(round).is(SIGMA_M, [round, measured, slip(near), 0.0]);
    }
    // a short course overrules none, but where the heading never changed
    let yaw = 1.4;
    let short = Restart {
        course: 0.3,
        rim_way: 0.4,
        yaw: Some(yaw),
        ..DRIVEN
    };
    let along = 0.3 * f64::cos(DRIVEN.angle - yaw - DIRECTION_RAD);
    // 0.3 m to the rounding of its parts
    for course in [0.29, 0.31] {
        let restart = Restart { course, ..short };
        let is_course = (restart.after(SIGMA_M)[0] - by_course).abs() < 1e-9;
        assert_eq!(is_course, course > 0.3);
    }
    assert!(along > 0.0);
    let unchanged = Restart {
        course: 0.2,
        rim_way: 0.25,
        has_heading: false,
        ..short
    };
    unchanged.is(SIGMA_M, [by_course, measured, 0.2, by_course - yaw]);
}

#[test]
fn a_start_has_the_prior_of_the_settings() {
    let mut ground = started();
    ground.accepted_ns = None;
    ground.start(NOW_NS + MS, [3.0, 4.0], (0.9, 0.05), &settings());
    let motion = ground.models.motion().unwrap();
    let slip = settings().slip;
    let is = [
        motion.slip,
        motion.slip_sigma,
        motion.heading,
        ground.models.heading_sigma(),
    ];
    let expected = [slip.mean, slip.sigma, 0.9, 0.05];
    assert!(is.iter().zip(expected).all(|(a, b)| near(*a, b)), "{is:?}");
    assert!(near(motion.place[0], 3.0) && near(motion.place[1], 4.0));
    let times = [ground.accepted_ns, ground.started_ns];
    assert_eq!(times, [Some(NOW_NS + MS); 2]);
}
