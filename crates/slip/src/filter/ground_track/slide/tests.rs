use super::super::tests::{
    DIRECTION_RAD, HEADING_RAD, MS, NOW_NS, PLACE_M, near, settings, started,
};
use super::*;

#[test]
fn a_slide_lasts_for_fifteen_periods_while_the_rims_stand() {
    let mut ground = started();
    ground.slide = Some((0.07, NOW_NS));
    for (period_s, rim, passed_ms, is_slide) in [
        (0.0, 0.02, 1_500, true),
        (0.0, 0.02, 1_501, false),
        (0.2, -0.02, 3_000, true),
        (0.2, 0.02, 3_001, false),
        (0.2, 0.021, 0, false),
        (0.2, -0.021, 0, false),
    ] {
        (ground.period_s, ground.rim_speed) = (period_s, rim);
        let slide = ground.slide(NOW_NS + passed_ms * MS);
        assert_eq!(
            slide,
            is_slide.then_some(0.07),
            "{period_s} {rim} {passed_ms}"
        );
        ground.refused_ns = NOW_NS;
        let stands = rim.abs() < 0.021;
        for (passed_ns, is_soon) in [(3_000 * MS - 1, true), (3_000 * MS, false)] {
            assert_eq!(ground.may_slide_on(NOW_NS + passed_ns), stands && is_soon);
        }
    }
}

/// The part of the way along the course over the time, both since the first refused position.
#[test]
fn positions_that_move_on_beside_standing_rims_are_a_slide() {
    let least = SLIDING_SIGMAS * core::f64::consts::SQRT_2 * settings().position_sigma;
    let after = |rim: f64, [dx, dy]: [f64; 2]| {
        let mut ground = started();
        ground.rim_speed = rim;
        // both exact, so that the way is
        ground.refused_position = [0.0; 2];
        ground.refused_ns = NOW_NS - 400 * MS;
        let times = (NOW_NS, NOW_NS + 50 * MS);
        ground.show_slide([dx, dy], times, &settings());
        assert_eq!(ground.refused_ns == NOW_NS, ground.slide.is_some());
        assert_eq!(ground.refused_position == [dx, dy], ground.slide.is_some());
        ground.slide
    };
    let (speed, shown_ns) = after(0.01, [0.3, -0.2]).unwrap();
    let (sin, cos) = f64::sin_cos(HEADING_RAD + DIRECTION_RAD);
    assert!(near(speed, (0.3 * cos - 0.2 * sin) / 0.4) && shown_ns == NOW_NS + 50 * MS);
    assert_eq!(after(0.03, [0.3, -0.2]), None);
    assert_eq!(after(0.01, [least, 0.0]), None);
    assert!(after(0.01, [least.next_up(), 0.0]).is_some());
    // from a place that is not the origin
    let mut ground = started();
    ground.rim_speed = 0.0;
    ground.refused_position = PLACE_M;
    ground.refused_ns = NOW_NS - 400 * MS;
    ground.show_slide(
        [PLACE_M[0] + 0.3, PLACE_M[1] - 0.2],
        (NOW_NS, NOW_NS),
        &settings(),
    );
    assert!(near(ground.slide.unwrap().0, speed));
    ground.models.restart();
    ground.slide = None;
    ground.show_slide([9.0, 9.0], (NOW_NS, NOW_NS), &settings());
    assert_eq!(ground.slide, None);
}
