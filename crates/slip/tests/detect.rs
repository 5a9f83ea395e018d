//! Events are called in the time stated, and not where nothing happens.

use grouser_slip::detect::{Change, DetectSettings, Detector, Event};
use grouser_slip::filter::{FilterSettings, SlipFilter};

use crate::world::{Truth, World};

/// Drives `world` through filter and detector; `torque` gives each powered wheel's.
fn changes(
    world: &World,
    settings: DetectSettings,
    torque: impl Fn(&Truth, usize) -> Option<f64>,
) -> Vec<Change> {
    let robot = world.robot();
    let mut filter = SlipFilter::new(&robot, FilterSettings::default()).unwrap();
    let mut detector = Detector::new(&robot, settings).unwrap();
    let mut found = Vec::new();
    let mut torques = vec![None; world.wheels()];
    world.run(|truth, samples| {
        for sample in samples {
            filter.update(*sample).unwrap();
        }
        for (wheel, slot) in torques.iter_mut().enumerate() {
            *slot = torque(truth, wheel);
        }
        let time_ns = samples[0].time_ns;
        found.extend(detector.update(time_ns, filter.latest().wheels, &torques));
    });
    found
}

fn begun(changes: &[Change], event: Event) -> Option<f64> {
    let first = changes.iter().find(|c| c.begins && c.event == event)?;
    Some(first.time_ns as f64 * 1e-9)
}

fn ended(changes: &[Change], event: Event) -> bool {
    changes.iter().any(|c| !c.begins && c.event == event)
}

/// The ground gets soft from 10 s to 15 s, within 0.3 s.
fn soft(slip: f64) -> World {
    World {
        slip: (0.08, slip),
        turn: 0.0,
        ..World::default()
    }
}

#[test]
fn high_slip_and_dig_in_are_called_in_time_and_end() {
    let found = changes(&soft(0.8), DetectSettings::default(), |_, _| None);
    let high = begun(&found, Event::HighSlip { wheel: 0 }).unwrap();
    let dig = begun(&found, Event::DigIn).unwrap();
    println!(
        "high slip after {:.2} s, dig-in after {:.2} s",
        high - 10.0,
        dig - 10.0
    );
    // the ground takes 0.2 s to reach the threshold; then persistence and the filter's delay
    assert!((10.3..10.8).contains(&high), "{high}");
    assert!((11.0..11.6).contains(&dig), "{dig}");
    assert!(begun(&found, Event::Immobilised).is_none());
    assert!(ended(&found, Event::DigIn) && ended(&found, Event::HighSlip { wheel: 0 }));
}

/// Wheels that run and a robot that stays.
#[test]
fn immobilised_is_called_within_a_second() {
    // the robot creeps at 12 mm/s; between 10 and 15 s its rims run fifty times as fast
    let stuck = World {
        slip: (0.08, 0.98),
        wander: 0.0,
        speed: 0.012,
        turn: 0.0,
        ..World::default()
    };
    let found = changes(&stuck, DetectSettings::default(), |_, _| None);
    let called = begun(&found, Event::Immobilised).unwrap();
    println!("immobilised after {:.2} s", called - 10.3);
    assert!((10.3..11.3).contains(&called), "{called}");
    assert!(ended(&found, Event::Immobilised));
}

#[test]
fn a_slip_below_the_threshold_calls_nothing() {
    for slip in [0.1, 0.35, 0.45] {
        let found = changes(&soft(slip), DetectSettings::default(), |_, _| None);
        assert_eq!(found, [], "{slip}");
    }
}

/// The torque of a lifted wheel falls away; it is not the ground that slips.
#[test]
fn a_lifted_wheel_is_called_so() {
    let world = soft(0.1);
    let torque = |truth: &Truth, wheel: usize| {
        let lifted = wheel == 1 && truth.time > 12.0 && truth.time < 14.0;
        Some(if lifted { 0.05 } else { 2.0 } * f64::from(u8::from(truth.speed > 0.0)))
    };
    let found = changes(&world, DetectSettings::default(), torque);
    let called = begun(&found, Event::LiftOff { wheel: 1 }).unwrap();
    assert!((12.1..12.2).contains(&called), "{called}");
    assert!(ended(&found, Event::LiftOff { wheel: 1 }));
    let others = found.iter().any(|c| c.event != Event::LiftOff { wheel: 1 });
    assert!(!others, "{found:?}");
}

/// Full torque on wheels that stand.
#[test]
fn a_stalled_wheel_is_called_so() {
    let settings = DetectSettings {
        stall_torque: 5.0,
        ..DetectSettings::default()
    };
    let world = World::default();
    // the robot has come to rest at 28 s; before it starts the motors push against a stone
    let torque = |truth: &Truth, _| {
        Some(if truth.time > 1.0 && truth.time < 1.5 {
            6.0
        } else {
            1.0
        })
    };
    let found = changes(&world, settings, torque);
    let called = begun(&found, Event::Stall { wheel: 0 }).unwrap();
    assert!((1.05..1.12).contains(&called), "{called}");
    assert!(ended(&found, Event::Stall { wheel: 0 }));
}

/// Straight drive, quantisation only. CI runs 15 minutes; `GROUSER_SOAK=100` runs 24 hours and more.
#[test]
fn nothing_is_called_where_nothing_happens() {
    let times: f64 = std::env::var("GROUSER_SOAK").map_or(1.0, |text| text.parse().unwrap());
    let mut hours = 0.0;
    for (seed, speed) in [(1, 0.3), (2, 0.05), (3, 0.02), (4, 1.0), (5, 0.1), (6, 0.2)] {
        let world = World {
            seed,
            speed,
            slip: (0.08, 0.08),
            wander: 0.0,
            turn: 0.0,
            legs: [2.0, 2.0, 150.0 * times, 2.0],
            ..World::default()
        };
        hours += world.duration() / 3600.0;
        let found = changes(&world, DetectSettings::default(), |_, _| Some(2.0));
        assert_eq!(found, [], "{speed} m/s");
    }
    println!("nothing in {hours:.2} hours");
}
