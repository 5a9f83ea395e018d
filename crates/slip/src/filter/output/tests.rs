use super::*;
use crate::filter::recovery::tests::{MS, NOW_NS, core};
use crate::sample::{Measurement, Sample};

#[test]
fn an_output_is_that_of_the_state() {
    let mut core = core(false);
    let numbers = [FORWARD, LEFT, YAW, PLACE[0], PLACE[1], HEADING, COMMON_SLIP];
    let value = |i: usize| 0.3 + 0.1 * i as f64;
    let covariance = |i: usize, j: usize| {
        if i == j {
            3.0 + i as f64
        } else {
            0.01 * (1 + i * j) as f64
        }
    };
    for i in numbers {
        core.state.set_mean(i, value(i));
        for j in numbers {
            core.state.set_covariance(i, j, covariance(i, j));
        }
    }
    core.nis = 1.25;
    (core.output.distance, core.output.distance_of_wheels) = (2.5, 3.5);
    (
        core.output.reference_readings,
        core.output.reference_refused,
    ) = (7, 2);
    core.speed_known_ns = Some(NOW_NS - 250 * MS);
    let mut input = Input::new(2, &core.settings);
    let newest = Sample {
        time_ns: NOW_NS + 500 * MS,
        measurement: Measurement::YawRate { rate: 0.0 },
    };
    assert!(input.offer(newest));
    (input.clocks.dropped, input.clocks.steps) = (11, 3);
    let output = core.output(&input);
    let known = |i: usize| Measured {
        value: value(i),
        variance: covariance(i, i),
    };
    let all = |of: [usize; 3]| of.map(|i| of.map(|j| covariance(i, j)));
    let body = output.body;
    assert_eq!(
        [body.forward, body.left, body.yaw_rate],
        [FORWARD, LEFT, YAW].map(known)
    );
    assert_eq!(body.velocity_covariance, all([FORWARD, LEFT, YAW]));
    assert_eq!(body.common_slip, known(COMMON_SLIP));
    let Odometry {
        x,
        y,
        yaw,
        covariance,
    } = body.odometry;
    assert_eq!([x, y, yaw], [PLACE[0], PLACE[1], HEADING].map(value));
    assert_eq!(covariance, all([PLACE[0], PLACE[1], HEADING]));
    assert_eq!(
        (body.distance, body.distance_of_wheels, body.nis),
        (2.5, 3.5, 1.25)
    );
    assert_eq!(body.rim_path, None);
    assert_eq!(
        (output.time_ns, output.time_slip, output.reference_age),
        (NOW_NS, 0.5, Some(0.25))
    );
    assert_eq!(
        (output.reference_readings, output.reference_refused),
        (7, 2)
    );
    assert_eq!((output.dropped, output.clock_steps), (11, 3));
    assert_eq!((output.wheels.len(), output.checks.len()), (2, 2));
    // behind the newest, never before it
    core.now_ns = Some(NOW_NS + 900 * MS);
    assert_eq!(core.output(&input).time_slip, 0.0);
    (core.now_ns, core.speed_known_ns) = (None, None);
    let none = core.output(&input);
    assert_eq!(
        (none.time_ns, none.time_slip, none.reference_age),
        (0, 0.0, None)
    );
}
