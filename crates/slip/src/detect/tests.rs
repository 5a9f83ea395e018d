use super::*;
use crate::robot::Wheel;
use crate::speed::Measured;
use crate::state::Invalid;
use grouser_terra::Slip;

/// Binary fractions, so that a test can meet each limit exactly; every event is called at once.
const SETTINGS: DetectSettings = DetectSettings {
    certainty: 2.0,
    high_slip: 0.5,
    high_slip_time: 0.0,
    dig_in: 0.5,
    dig_in_time: 0.0,
    immobilised: 0.25,
    immobilised_time: 0.0,
    release: 0.5,
    stall_torque: 16.0,
    stall_time: 0.0,
    lift_off: 0.25,
    lift_off_time: 0.0,
    standstill_speed: 0.007_812_5,
};
/// Of a slip, 1: a binary fraction too.
const SLIP_SIGMA: f64 = 0.125;
/// Ticks of a quarter of a second.
const TICK_NS: i64 = 250_000_000;

fn estimate(slip: f64) -> WheelEstimate {
    moving(slip, 0.0, (1.0, 0.0), 1.0)
}

/// A wheel with a slip and its sigma, a speed over ground and its sigma, and a rim.
fn moving(slip: f64, sigma: f64, forward: (f64, f64), rim: f64) -> WheelEstimate {
    let speed = |value: f64, sigma: f64| {
        let variance = sigma * sigma;
        Some(Measured { value, variance })
    };
    WheelEstimate {
        slip: Some(Slip::new(slip).unwrap()),
        sigma: Some(sigma),
        forward_speed: speed(forward.0, forward.1),
        rim_speed: speed(rim, 0.0),
        health: Health::Ok,
        ..WheelEstimate::NOTHING
    }
}

/// A detector of a robot with powered wheels and a free one behind them, with the time that it is.
struct Fed {
    detector: Detector,
    time_ns: i64,
}

impl Fed {
    fn new(powered: usize, settings: DetectSettings) -> Self {
        let mut wheels: Vec<Wheel> = (0..powered)
            .map(|index| Wheel::powered(format!("wheel {index}")))
            .collect();
        if powered > 1 {
            wheels.push(Wheel::free("free"));
        }
        let robot = Robot::new("cart".into(), wheels).unwrap();
        Self {
            detector: Detector::new(&robot, settings).unwrap(),
            time_ns: 0,
        }
    }

    /// The events that begin and end with these estimates and torques.
    fn take(&mut self, wheels: &[WheelEstimate], torques: &[f64]) -> Vec<(Event, bool)> {
        let torques: Vec<_> = torques.iter().map(|torque| Some(*torque)).collect();
        let changes = self.detector.update(self.time_ns, wheels, &torques);
        let found = changes
            .map(|change| (change.event, change.begins))
            .collect();
        self.time_ns += TICK_NS;
        found
    }

    fn is_on(&self, event: Event) -> bool {
        self.detector.is_on(event)
    }
}

/// After a second of a torque of 8 N m at a slip of `slip`.
fn usual(powered: usize, slip: f64) -> Fed {
    let mut fed = Fed::new(powered, SETTINGS);
    for _ in 0..5 {
        let found = fed.take(&vec![estimate(slip); powered], &vec![8.0; powered]);
        assert_eq!(found, []);
    }
    fed
}

const LIFT: Event = Event::LiftOff { wheel: 0 };
const HIGH: Event = Event::HighSlip { wheel: 0 };
const STALL: Event = Event::Stall { wheel: 0 };

#[test]
fn the_usual_is_a_mean_and_then_one_over_two_seconds() {
    let mut fed = Fed::new(1, SETTINGS);
    let learnt = |fed: &Fed| {
        let wheel = &fed.detector.wheels[0];
        (wheel.usual_torque, wheel.usual_slip)
    };
    // the first reading lasts no time yet
    for (torque, slip, mean_torque, mean_slip) in [
        (100.0, 0.4, 0.0, 0.0),
        (4.0, 0.125, 4.0, 0.125),
        (-8.0, 0.375, 6.0, 0.25),
        (9.0, 0.4, 7.0, 0.3),
        (7.0, 0.3, 7.0, 0.3),
    ] {
        fed.take(&[estimate(slip)], &[torque]);
        let (usual_torque, usual_slip) = learnt(&fed);
        assert!((usual_torque - mean_torque).abs() < 1e-12, "{usual_torque}");
        assert!((usual_slip - mean_slip).abs() < 1e-12, "{usual_slip}");
    }
    for _ in 0..6 {
        fed.take(&[estimate(0.3)], &[7.0]);
    }
    // a tick is an eighth of two seconds
    fed.take(&[estimate(0.46)], &[15.0]);
    let (torque, slip) = learnt(&fed);
    assert!((torque - 8.0).abs() < 1e-12 && (slip - 0.32).abs() < 1e-12);
    // a slip that cannot be trusted is none, and neither wheels that stand nor light ones are usual
    let untrusted = WheelEstimate {
        sigma: Some(f64::INFINITY),
        ..estimate(0.9)
    };
    fed.take(&[untrusted], &[8.0]);
    fed.take(&[moving(0.9, 0.0, (0.0, 0.0), 0.0)], &[1.0]);
    fed.take(&[estimate(0.9)], &[1.0]);
    let (torque, slip) = learnt(&fed);
    assert!((torque - 8.0).abs() < 1e-12 && (slip - 0.32).abs() < 1e-12);
}

#[test]
fn a_light_wheel_is_off_the_ground_once_its_torque_is_known() {
    // a quarter of 8 N m
    assert_eq!(usual(1, 0.25).take(&[estimate(0.25)], &[2.0]), []);
    assert_eq!(
        usual(1, 0.25).take(&[estimate(0.25)], &[1.9]),
        [(LIFT, true)]
    );
    assert_eq!(
        usual(1, 0.25).take(&[moving(0.25, 0.0, (0.0, 0.0), 0.0)], &[1.9]),
        []
    );
    // a second is needed
    let mut fed = Fed::new(1, SETTINGS);
    for _ in 0..4 {
        fed.take(&[estimate(0.25)], &[8.0]);
    }
    assert_eq!(fed.take(&[estimate(0.25)], &[1.9]), []);
    assert_eq!(fed.take(&[estimate(0.25)], &[8.0]), []);
    assert_eq!(fed.take(&[estimate(0.25)], &[1.9]), [(LIFT, true)]);
    // the ground eases a wheel that slips two sigma less than usual, but for the exact limit
    for (slip, is_lifted) in [(0.25, true), (0.24, false)] {
        let mut fed = usual(1, 0.5);
        let found = fed.take(&[moving(slip, SLIP_SIGMA, (1.0, 0.0), 1.0)], &[0.0]);
        assert_eq!(!found.is_empty(), is_lifted, "{slip}");
    }
    // back on the ground: more than half the usual torque, a rim that stands, or no torque at all
    let lifted = || {
        let mut fed = usual(1, 0.25);
        fed.take(&[estimate(0.25)], &[0.0]);
        assert_eq!(fed.take(&[estimate(0.25)], &[0.0]), []);
        assert!(fed.is_on(LIFT));
        fed
    };
    assert_eq!(lifted().take(&[estimate(0.25)], &[4.0]), []);
    assert_eq!(lifted().take(&[estimate(0.25)], &[4.1]), [(LIFT, false)]);
    assert_eq!(
        lifted().take(&[moving(0.25, 0.0, (0.0, 0.0), 0.0)], &[0.0]),
        [(LIFT, false)]
    );
    assert_eq!(lifted().take(&[estimate(0.25)], &[]), [(LIFT, false)]);
}

#[test]
fn wheels_whose_torques_fall_together_have_not_left_the_ground() {
    let lift = |wheel| (Event::LiftOff { wheel }, true);
    let found = |powered: usize, torques: &[f64]| {
        usual(powered, 0.25).take(&vec![estimate(0.25); powered], torques)
    };
    assert_eq!(found(2, &[1.0, 8.0]), [lift(0)]);
    assert_eq!(found(2, &[8.0, 1.0]), [lift(1)]);
    // exactly a quarter has not fallen
    assert_eq!(found(2, &[1.0, 2.0]), [lift(0)]);
    assert_eq!(found(2, &[1.0, 1.0]), []);
    assert_eq!(found(3, &[1.0, 1.0, 8.0]), []);
    assert_eq!(found(4, &[1.0, 1.0, 8.0, 8.0]), [lift(0), lift(1)]);
    assert_eq!(found(4, &[1.0, 1.0, 1.0, 8.0]), []);
}

#[test]
fn a_high_slip_is_one_beyond_its_noise_on_the_ground() {
    let at = |slip: f64| moving(slip, SLIP_SIGMA, (1.0, 0.0), 1.0);
    let mut fed = usual(1, 0.25);
    assert_eq!(fed.take(&[at(0.75)], &[8.0]), []);
    assert!(fed.take(&[at(0.76)], &[8.0]).contains(&(HIGH, true)));
    // it ends below half of it
    fed.take(&[at(0.25)], &[8.0]);
    assert!(fed.is_on(HIGH));
    assert!(fed.take(&[at(0.24)], &[8.0]).contains(&(HIGH, false)));
    // the free wheel's slip is no event
    let mut fed = Fed::new(2, SETTINGS);
    assert_eq!(
        fed.take(&[estimate(0.0), estimate(0.0), estimate(0.9)], &[]),
        []
    );
    // a wheel in the air slips as it likes, from the first tick on
    let mut fed = usual(1, 0.25);
    let found = fed.take(&[estimate(0.9)], &[0.0]);
    assert!(
        found.contains(&(LIFT, true)) && !found.contains(&(HIGH, true)),
        "{found:?}"
    );
    fed.take(&[estimate(0.9)], &[3.0]);
    assert!(fed.is_on(LIFT) && !fed.is_on(HIGH));
    // but whether one is light is not known before a second
    let mut fed = Fed::new(1, SETTINGS);
    fed.take(&[estimate(0.25)], &[8.0]);
    fed.take(&[estimate(0.25)], &[8.0]);
    assert!(fed.take(&[estimate(0.9)], &[0.0]).contains(&(HIGH, true)));
}

#[test]
fn a_wheel_that_stands_under_full_torque_is_stalled() {
    let rim = |rim| [moving(0.0, 0.0, (0.0, 0.0), rim)];
    let mut fed = Fed::new(1, SETTINGS);
    assert_eq!(fed.take(&rim(0.0), &[15.9]), []);
    assert_eq!(fed.take(&rim(0.0079), &[16.0]), []);
    assert_eq!(fed.take(&[WheelEstimate::NOTHING], &[16.0]), []);
    assert!(fed.detector.feels_the_ground(0));
    assert_eq!(fed.take(&rim(0.007_812_5), &[-16.0]), [(STALL, true)]);
    assert!(!fed.detector.feels_the_ground(0));
    assert_eq!(fed.detector.motion(0, None), Some(Motion::Stall));
    assert_eq!(fed.take(&rim(0.0), &[16.0]), []);
    assert_eq!(fed.take(&rim(0.0), &[15.9]), [(STALL, false)]);
    assert_eq!(fed.take(&rim(0.0), &[16.0]), [(STALL, true)]);
    assert_eq!(fed.take(&rim(0.0079), &[16.0]), [(STALL, false)]);
}

#[test]
fn a_wheel_feels_the_ground_unless_it_lifts() {
    let settings = DetectSettings {
        lift_off_time: 0.5,
        ..SETTINGS
    };
    let mut fed = Fed::new(2, settings);
    for _ in 0..5 {
        fed.take(&[estimate(0.25); 2], &[8.0; 2]);
    }
    let feels = |fed: &Fed| [0, 1, 2, 3].map(|wheel| fed.detector.feels_the_ground(wheel));
    assert_eq!(feels(&fed), [true, true, false, false]);
    for _ in 0..4 {
        // as soon as it may have lifted
        fed.take(&[estimate(0.25); 2], &[0.0, 8.0]);
        assert_eq!(feels(&fed), [false, true, false, false]);
    }
    assert!(fed.is_on(LIFT));
}

#[test]
fn a_robot_digs_in_by_the_mean_of_its_wheels() {
    let dig = |begins| [(Event::DigIn, begins)];
    // no wheel's own slip is high
    let settings = DetectSettings {
        high_slip: 0.999,
        immobilised: 0.001,
        ..SETTINGS
    };
    let at = |slips: [f64; 2]| slips.map(|slip| moving(slip, SLIP_SIGMA, (1.0, 0.0), 1.0));
    let mut fed = Fed::new(2, settings);
    assert_eq!(fed.take(&at([0.875, 0.625]), &[]), []);
    assert_eq!(fed.take(&at([0.875, 0.63]), &[]), dig(true));
    assert_eq!(fed.take(&at([0.125, 0.375]), &[]), []);
    assert_eq!(fed.take(&at([0.125, 0.37]), &[]), dig(false));
    // no wheel to be trusted: nothing is known of it any more
    fed.take(&at([0.9, 0.9]), &[]);
    let untrusted = [Health::Invalid(Invalid::Dropout), Health::Uninitialised];
    let untrusted = untrusted.map(|health| WheelEstimate {
        health,
        ..estimate(0.9)
    });
    assert!(fed.is_on(Event::DigIn));
    assert_eq!(fed.take(&untrusted, &[]), dig(false));
    assert_eq!(fed.take(&untrusted, &[]), []);
}

/// Two wheels of 1 m/s at the rim: the robot is stuck below 0.25 m/s each, with the noise of both speeds.
#[test]
fn a_robot_is_immobilised_where_its_way_is_less_than_its_rims_by_its_noise() {
    /// Of a speed over ground: a binary fraction, as all limits here.
    const WAY_SIGMA_M_PER_S: f64 = 0.007_812_5;
    let settings = DetectSettings {
        high_slip: 0.999,
        dig_in: 0.999,
        ..SETTINGS
    };
    let held = |begins| [(Event::Immobilised, begins)];
    let at = |slip: f64, way: f64| [moving(slip, SLIP_SIGMA, (-way, WAY_SIGMA_M_PER_S), -1.0); 2];
    let mut fed = Fed::new(2, settings);
    // 0.25 m/s with two sigma of the way on the one side, and of a rim that stands on the other
    assert_eq!(fed.take(&at(0.8, 0.25), &[]), []);
    // s - 2 sigma of exactly 1 - 2.5 x 0.25
    assert_eq!(fed.take(&at(0.625, 0.24), &[]), []);
    assert_eq!(fed.take(&at(0.63, 0.24), &[]), held(true));
    // free at 0.25/0.5 of the rims' and the noise
    assert_eq!(fed.take(&at(0.63, 0.515_625), &[]), []);
    assert_eq!(fed.take(&at(0.63, 0.52), &[]), held(false));
    fed.take(&at(0.63, 0.24), &[]);
    // rims that turn exactly as one that stands
    let standing = moving(0.63, SLIP_SIGMA, (0.0, WAY_SIGMA_M_PER_S), 0.007_812_5);
    assert_eq!(fed.take(&[standing; 2], &[]), held(false));
    fed.take(&at(0.63, 0.24), &[]);
    assert!(fed.is_on(Event::Immobilised));
    let unknown = [WheelEstimate::NOTHING; 2];
    assert_eq!(fed.take(&unknown, &[]), held(false));
}
