//! Whole drives: shipped scenarios with the filter and the controller in the loop, held against what is true.

use std::path::Path;

use grouser_rover::Error;
use grouser_rover::drive::{
    DriveResult, Outcome, Pilot, Scenario, Simulation, SlipScore, equal_speed_share, read_scenario,
};
use grouser_slip::Measurement;
use grouser_slip::control::{Action, Ending, Reason};
use grouser_terra::{Angle, Kinematics, Settings, ShearLaw, Slip, Soil, SoilParams, WheelOnSoil};

/// Near the slip of the greatest efficiency of the robot on dry sand.
const RUNNING_SLIP: f64 = 0.39;

fn scenario(name: &str) -> Scenario {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenarios");
    read_scenario(&folder.join(name).with_extension("toml")).unwrap()
}

fn drive(scenario: &Scenario, pilot: Pilot, seed: u64) -> DriveResult {
    let result = Simulation::new(scenario, pilot, RUNNING_SLIP, seed)
        .unwrap()
        .run(|_| true);
    println!(
        "{} {} {seed}: {} after {:.2} m, slip rmse {:.4}, without starts {:.4}, squared error over variance {:.2}, longest wrong {:.2} s",
        scenario.name,
        pilot.name(),
        result.outcome.name(),
        result.distance,
        result.slip.rmse.unwrap_or(0.0),
        result.slip.settled.unwrap_or(0.0),
        result.slip.nees.unwrap_or(0.0),
        result.slip.longest_wrong,
    );
    result
}

/// A drive without a setpoint of its own runs at the slip of the greatest tractive efficiency, or says that there is none.
#[test]
fn the_setpoint_is_the_scenario_s_or_that_of_the_greatest_efficiency() {
    let mut sandbox = scenario("sandbox");
    let slip = sandbox.slip_setpoint().unwrap();
    let (wheel, load) = sandbox.typical_wheel().unwrap();
    let contact = WheelOnSoil::new(
        sandbox.robot.wheels[wheel].wheel,
        sandbox.ground.soils[0].soil,
        Settings::default(),
    )
    .unwrap();
    let efficiency = |slip: f64| {
        let at = Kinematics::straight(Slip::new(slip).unwrap());
        let point = contact.under_load(load, &at).unwrap().point().unwrap();
        point.tractive_efficiency().unwrap_or(0.0)
    };
    assert!(efficiency(slip) > 0.1);
    for other in 1..80 {
        assert!(efficiency(0.01 * f64::from(other)) <= efficiency(slip) + 1e-12);
    }
    sandbox.ground.soils[0].soil = Soil::new(SoilParams {
        phi: Angle::from_deg(0.0),
        cohesion: 0.0,
        ..*sandbox.ground.soils[0].soil.params()
    })
    .unwrap();
    assert!(matches!(
        sandbox.slip_setpoint(),
        Err(Error::NoSlipSetpoint { .. })
    ));
    sandbox.optimum = Some(0.25);
    assert_eq!(
        sandbox.slip_setpoint().unwrap().to_bits(),
        0.25_f64.to_bits()
    );
}

/// Many robots at once, on threads of their own and with one table of the soil, drive as each does alone, to the bit.
#[test]
fn robots_side_by_side_drive_as_each_does_alone() {
    let mut soft = scenario("soft-patch");
    soft.duration = 3.0;
    let tables = Simulation::soil_tables(&soft).unwrap();
    let alone = |seed| {
        let mut drive = Simulation::new(&soft, Pilot::Controller, RUNNING_SLIP, seed).unwrap();
        drive.run(|_| true)
    };
    let beside = |seed| {
        let mut drive =
            Simulation::with_tables(&soft, Pilot::Controller, RUNNING_SLIP, seed, &tables).unwrap();
        drive.run(|_| true)
    };
    let (alone, beside) = (&alone, &beside);
    std::thread::scope(|scope| {
        let drives: Vec<_> = (0..8)
            .map(|seed| scope.spawn(move || beside(seed)))
            .collect();
        let mut ends = Vec::new();
        for (seed, drive) in (0..8).zip(drives) {
            let found = drive.join().unwrap();
            assert_eq!(found, alone(seed), "seed {seed}");
            ends.push(found.end);
        }
        ends.dedup();
        assert_eq!(ends.len(), 8, "seeds differ");
    });
}

/// What the filter calls Ok is never off by more than four sigma for a second, and its sigmas are not too small.
#[test]
fn slips_called_ok_hold() {
    // pooled RMSE of more drives, without and with their starts: 0.040 on the sandbox, 0.012, 0.024 (`pooled_drives`)
    for (name, most) in [("sandbox", 0.032), ("slope", 0.012), ("dunes", 0.026)] {
        let scenario = scenario(name);
        let (mut settled, mut squares, mut count) = (0.0, 0.0, 0.0);
        for seed in scenario.seed..scenario.seed + 3 {
            let result = drive(&scenario, Pilot::Controller, seed);
            assert_eq!(result.outcome, Outcome::Arrived);
            assert!(result.slip.longest_wrong < 1.2);
            assert!(result.energy_error.abs() < 0.01);
            // a start from standstill is another matter: the soil is not sheared yet
            assert!(result.slip.rmse.unwrap() < 3.0 * most);
            let weight = result.slip.count as f64;
            settled += weight * result.slip.settled.unwrap().powi(2);
            squares += weight * result.slip.nees.unwrap();
            count += weight;
        }
        let (settled, nees) = ((settled / count).sqrt(), squares / count);
        println!("{name}: {settled:.4}, {nees:.2}");
        // over crests sigmas are small until the slope is learnt as a bias of the accelerometer
        let most_nees = if name == "dunes" { 2.6 } else { 1.2 };
        assert!(
            settled < most && nees < most_nees,
            "{name}: {settled} {nees}"
        );
    }
}

/// The simulated ground obeys other published laws of shear than those by which the robot estimates: its free wheel skids
/// otherwise, and its sigmas must cover that.
#[test]
fn slips_called_ok_hold_under_foreign_laws() {
    for law in [ShearLaw::SlipVelocity, ShearLaw::TowedRestart] {
        for name in ["sandbox", "dunes"] {
            let mut scenario = scenario(name);
            scenario.ground.world_laws = Some(law);
            let result = drive(&scenario, Pilot::Controller, scenario.seed);
            println!("{law:?}: bias {:.4}", result.slip.bias.unwrap());
            assert!(result.slip.longest_wrong < 1.2);
            assert!(result.slip.nees.unwrap() < 3.0);
        }
    }
}

/// The soft patch pulls less than it resists at any slip: who drives into it with all wheels stays there.
#[test]
fn the_controller_goes_round_the_soft_patch() {
    let scenario = scenario("soft-patch");
    for seed in [scenario.seed, 46] {
        let open = drive(&scenario, Pilot::OpenLoop, seed);
        assert_eq!(open.outcome, Outcome::Immobilised);
        let controlled = drive(&scenario, Pilot::Controller, seed);
        assert_eq!(controlled.outcome, Outcome::Arrived);
        assert!(controlled.distance > 2.0 * open.distance);
        let tells = |reason: Reason| {
            controlled
                .decisions
                .iter()
                .any(|named| named.decision.reason == reason)
        };
        assert!(tells(Reason::SoftGround) && tells(Reason::ClearedSoftGround));
    }
}

/// The sandbox's last leg leads back, up or down its dunes: with the slope counted the wrong way round these ended off the map.
#[test]
fn the_way_back_over_known_ground_is_no_soft_ground() {
    let scenario = scenario("sandbox");
    for seed in [1, 2, 13, 14] {
        let result = drive(&scenario, Pilot::Controller, seed);
        assert_eq!(result.outcome, Outcome::Arrived, "{result:?}");
    }
}

/// At 50 s everything falls silent: within the time without sight that its settings give it, it ends the drive and says why.
#[test]
fn it_stops_when_its_sensors_fall_silent() {
    let scenario = scenario("faults");
    let result = drive(&scenario, Pilot::Controller, scenario.seed);
    assert_eq!(result.outcome, Outcome::SensorsLost);
    let last = result.decisions.last().unwrap();
    assert_eq!(last.decision.action, Action::End(Ending::SensorsLost));
    assert_eq!(last.decision.reason, Reason::SensorTimeout);
    let silent = scenario
        .faults
        .windows()
        .iter()
        .map(|window| window.from)
        .fold(0.0, f64::max);
    let after = last.time - silent;
    assert!(after > 0.0 && after < scenario.control.blind_time + 0.3);
}

/// A robot that may be without slips for less time than it takes to its first ones would end every drive as one whose sensors are lost.
#[test]
fn the_time_without_sight_outlasts_the_start() {
    let mut short = scenario("sandbox");
    short.duration = 3.0;
    short.control.blind_time = 0.75;
    short.check().unwrap();
    let result = drive(&short, Pilot::Controller, short.seed);
    assert_eq!(result.outcome, Outcome::TimeOut);
    short.control.blind_time = 0.74;
    let refused = short.check().unwrap_err().to_string();
    assert!(
        refused.contains("blind_time")
            && refused.contains("0.74")
            && refused.contains("0.75")
            && refused.contains(" s"),
        "{refused}"
    );
}

#[test]
fn the_same_seed_drives_the_same_drive() {
    let mut short = scenario("sandbox");
    short.duration = 6.0;
    let first = drive(&short, Pilot::Controller, 1);
    assert_eq!(first, drive(&short, Pilot::Controller, 1));
    assert_ne!(first, drive(&short, Pilot::Controller, 2));
}

/// The baseline of a controller: the robot is as fast as with it. On a slope wheels then run faster than requested, and times
/// and energies of drives that arrive compare.
#[test]
fn open_loop_has_the_mean_speed_of_the_controllers_drive() {
    let mut slope = scenario("slope");
    slope.legs[0].distance = slope.legs[0].distance.map(|whole| 0.3 * whole);
    let controlled = drive(&slope, Pilot::Controller, 15);
    let open = |share: f64| drive(&slope.at_pace(share), Pilot::OpenLoop, 15);
    let share = equal_speed_share(&controlled, |share| Ok::<_, Error>(open(share))).unwrap();
    assert!(share > 1.5, "{share}");
    let fair = open(share);
    assert!(
        (fair.duration / controlled.duration - 1.0).abs() < 0.02,
        "{} s, {} s",
        fair.duration,
        controlled.duration
    );
    // at equal speed the controller saves no energy
    let ratio = controlled.energy_per_metre().unwrap() / fair.energy_per_metre().unwrap();
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    // where open loop digs in there is no such speed, and the search ends at once
    let mut drives = 0;
    let digs = |_| {
        drives += 1;
        Ok::<_, Error>(drive(&scenario("soft-patch"), Pilot::OpenLoop, 3))
    };
    let patch = drive(&scenario("soft-patch"), Pilot::Controller, 3);
    equal_speed_share(&patch, digs).unwrap();
    assert_eq!(drives, 1);
}

/// Free wheels that stamp their pulses are not counted: as many edges as ticks, in the order of time, to the clock's resolution.
#[test]
fn a_free_wheel_stamps_each_pulse() {
    let mut short = scenario("sandbox");
    short.duration = 4.0;
    let ticks = |clock: f64| {
        let mut own = short.clone();
        own.sensors.edge_clock = clock;
        let (mut edges, mut last_ns, mut counted) = (0_i64, 0, None);
        let mut drive = Simulation::new(&own, Pilot::OpenLoop, RUNNING_SLIP, 1).unwrap();
        drive.run(|frame| {
            for sample in frame.samples {
                match sample.measurement {
                    Measurement::WheelEdge { wheel, forward } => {
                        assert_eq!(wheel, 5);
                        assert!(sample.time_ns > last_ns);
                        last_ns = sample.time_ns;
                        edges += if forward { 1 } else { -1 };
                    }
                    Measurement::WheelCount { wheel: 5, raw } => counted = Some(raw),
                    _ => {}
                }
            }
            true
        });
        (edges, counted)
    };
    let (none, counted) = ticks(0.0);
    let (edges, uncounted) = ticks(1e-6);
    assert_eq!((none, uncounted), (0, None));
    // the counter is read every 20 ms, in which a wheel of this speed has seven edges
    let counted = i64::try_from(counted.unwrap()).unwrap();
    assert!(
        (0..=8).contains(&(edges - counted)) && edges > 100,
        "{edges} {counted}"
    );
}

/// Halving the step changes the drive less than its course: progress and energy within 2 %.
#[test]
fn halving_the_step_changes_little() {
    let mut whole = scenario("sandbox");
    whole.duration = 12.0;
    let mut half = whole.clone();
    half.step = Some(1.25e-3); // s; usual is twice as long
    let (a, b) = (
        drive(&whole, Pilot::OpenLoop, 1),
        drive(&half, Pilot::OpenLoop, 1),
    );
    assert!((a.distance - b.distance).abs() < 0.02 * a.distance);
    assert!((a.energy - b.energy).abs() < 0.02 * a.energy);
}

/// A robot without a free wheel knows its slip by a camera, whose pictures arrive late.
#[test]
fn a_camera_alone_gives_the_slip_of_a_skid_steer() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenarios");
    for (sensor, slope) in [("camera_rate_hz = 10.0", 3.0), ("gnss_rate_hz = 5.0", 3.0)] {
        let text = format!(
            r#"
format = 1
title = "A slope for a skid-steer"
robot = "../robots/skid-steer.toml"
seed = 3
duration_s = 120.0

[start]
x_m = 2.0

[ground]
kind = "slope"
slope_deg = {slope}
from_m = 3.0
size_x_m = 22.0
size_y_m = 12.0
soil = "dry-sand"

[sensors]
{sensor}

[[leg]]
speed_m_per_s = 0.25
distance_m = 12.0
"#
        );
        let robot =
            grouser_rover::robot::RobotModel::read(&folder.join("../robots/skid-steer.toml"))
                .unwrap();
        let document = grouser_files::Document::from_text("skid.toml", text).unwrap();
        let scenario = grouser_rover::drive::parse_scenario(&document, "skid", robot).unwrap();
        let results: Vec<_> = (3..19)
            .map(|seed| drive(&scenario, Pilot::Controller, seed))
            .collect();
        let median = |of: fn(&SlipScore) -> Option<f64>| {
            let mut values: Vec<f64> = results.iter().filter_map(|r| of(&r.slip)).collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        let (all, settled) = (median(|slip| slip.rmse), median(|slip| slip.settled));
        println!("{sensor}: {all:.3}, without starts {settled:.3}");
        assert!(all < 0.035 && settled < 0.03, "{sensor}: {all}, {settled}");
        for result in &results {
            assert!(result.slip.longest_wrong < 1.0, "{sensor}: {result:?}");
            // the ground is the known soil: a slip that is found too high at the start is no reason to go round it
            assert_eq!(result.outcome, Outcome::Arrived, "{sensor}: {result:?}");
            assert!(result.slip.rmse.unwrap() < 0.08, "{sensor}: {result:?}");
        }
    }
}

/// So slow that neither speed stands out of its noise where rims wait for the robot, and round a corner, for which a skid-steer
/// and a rocker-bogie slip: of eight seeds half arrive, within three times the time that they take without any control of slip. A
/// false "soft ground" after the corner makes the others back out until the time is over.
#[test]
fn slow_robots_with_a_camera_arrive() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots");
    for robot in ["skid-steer", "rocker-bogie"] {
        let text = format!(
            r#"
format = 1
title = "A slow corner"
robot = "{robot}.toml"
duration_s = 200.0

[start]
x_m = 4.0

[ground]
kind = "flat"
size_x_m = 30.0
size_y_m = 20.0
soil = "lunar"
scatter = 0.08

[sensors]
camera_rate_hz = 10.0

[[leg]]
speed_m_per_s = 0.09
distance_m = 2.5

[[leg]]
speed_m_per_s = 0.09
distance_m = 2.5
heading_deg = 40.0
"#
        );
        let model = folder.join(robot).with_extension("toml");
        let model = grouser_rover::robot::RobotModel::read(&model).unwrap();
        let document = grouser_files::Document::from_text("slow.toml", text).unwrap();
        let scenario = grouser_rover::drive::parse_scenario(&document, "slow", model).unwrap();
        let mut late = Vec::new();
        for seed in 1..=8 {
            let [open, own] =
                [Pilot::OpenLoop, Pilot::Controller].map(|pilot| drive(&scenario, pilot, seed));
            assert_eq!(open.outcome, Outcome::Arrived, "{robot} {seed}: {open:?}");
            let ratio = own.duration / open.duration;
            // at 0.09 m/s a camera of 10 Hz shows slip within half a minute
            if own.outcome != Outcome::Arrived || ratio > 3.0 {
                late.push((seed, own.outcome, ratio));
            }
        }
        println!("{robot}: {} of 8 late", late.len());
        assert!(late.len() <= 4, "{robot}: {late:?}");
    }
}
