//! A plate test recorded by two computers, made here with its clocks, its zero and its contact known.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use grouser_identify::plate::{
    BagSource, DepthColumn, Plate, PlateRecord, PlateSettings, fit_plates, read_bag,
};
use grouser_identify::{Error, Result};
use grouser_log::message::build;
use grouser_log::write::McapWriter;

/// A test that is removed with its folder. Force 20 times a second for 18 s, height 25 times for 20 s.
struct Recorded {
    folder: PathBuf,
    source: BagSource,
    depth: DepthColumn,
}

const START_S: f64 = 1_700_000_000.0;
const START_NS: i64 = 1_700_000_000_000_000_000;
/// The plate meets the ground here, m and s.
const SURFACE: (f64, f64) = (0.004, 5.0);
/// k A zⁿ, N and m.
const LAW: (f64, f64) = (5e4, 1.2);
/// What the cell reads without load, N; pressed in it reads less.
const ZERO_N: f64 = 12.0;

/// Height of the plate at a time: down by fits and starts to 20 mm under the surface at 15 s, a rest, up again; once the
/// force is no longer recorded, far down.
fn height(t: f64) -> f64 {
    if t > 19.1 {
        return -0.05;
    }
    let down = t.min(15.0) - SURFACE.1;
    let depth = 2e-3 * down - 2e-3 * (std::f64::consts::PI * down).sin() / std::f64::consts::PI;
    SURFACE.0 - depth + 0.01 * (t - 17.0).max(0.0)
}

fn force(t: f64) -> f64 {
    let pressed = if t < 17.0 {
        LAW.0 * (SURFACE.0 - height(t)).max(0.0).powf(LAW.1)
    } else {
        0.0
    };
    // a shock while the plate hangs free, shorter than any contact
    let shock = if (3.5..3.8).contains(&t) { 9.0 } else { 0.0 };
    pressed + shock
}

impl Recorded {
    fn new(name: &str, clocks: (f64, f64), topics: &[&str]) -> Self {
        Self::with(name, clocks, topics, (360, 50_000_000))
    }

    /// The heights' clock is behind by `zone_s` and `offset_s`; the bag has a number of messages, with this time between two, ns.
    fn with(
        name: &str,
        (zone_s, offset_s): (f64, f64),
        topics: &[&str],
        (messages, step_ns): (u32, i64),
    ) -> Self {
        let folder = std::env::temp_dir().join(format!("grouser-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
        let mut topics: Vec<_> = topics
            .iter()
            .map(|topic| writer.topic(topic, "geometry_msgs/TwistStamped").unwrap())
            .collect();
        for step in 0..messages {
            let stamp = START_NS + step_ns * i64::from(step);
            let t = 1e-9 * step_ns as f64 * f64::from(step);
            let noise = [0.0, 0.05, -0.05][step as usize % 3];
            let mut send = |newtons: f64| {
                // recorded half a second after it was measured
                for topic in &mut topics {
                    let value = build::twist_stamped(
                        build::header(stamp, "cell"),
                        [0.0, 0.0, newtons],
                        [0.0; 3],
                    );
                    writer.send(topic, stamp + 500_000_000, &value).unwrap();
                }
            };
            send(ZERO_N + noise - force(t));
            // a reading with the stamp of the one before, and one that is none
            if step == 200 {
                send(-500.0);
                send(f64::NAN);
            }
        }
        fs::write(folder.join("force.mcap"), writer.finish().unwrap()).unwrap();
        let mut text = String::new();
        for step in 0..500 {
            let t = 0.04 * f64::from(step);
            // the controller's clock began 100 s before and runs 0.1 % slow; its lines come late by up to 80 ms
            let (controller, late) = (100.0 + t / 1.001, 0.02 * f64::from(step % 5));
            let clock = START_S + t - zone_s - offset_s;
            writeln!(
                text,
                "{clock:.6}; {:.6} {:.5},{:.3}",
                clock + late,
                1e3 * height(t),
                1e3 * controller
            )
            .unwrap();
        }
        text.push('\n');
        fs::write(folder.join("height.txt"), text).unwrap();
        Self {
            source: BagSource {
                bag: folder.join("force.mcap"),
                topic: None,
                force: "twist.linear.z".into(),
                stamp: Some("header.stamp".into()),
                sign: -1.0,
            },
            depth: DepthColumn {
                file: folder.join("height.txt"),
                height: 3,
                height_unit: 1e-3,
                clock: 1,
                controller: None,
                surface: None,
            },
            folder,
        }
    }

    fn read(&self) -> Result<PlateRecord> {
        read_bag("disc", Plate::disc(0.1).unwrap(), &self.source, &self.depth)
    }

    fn refused(&self) -> String {
        self.read().unwrap_err().to_string()
    }
}

impl Drop for Recorded {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

fn check(record: &PlateRecord, zone_s: f64, offset_s: f64) {
    assert_eq!((record.zone_s, record.test.name.as_str()), (zone_s, "disc"));
    assert!(
        (record.offset_s - offset_s).abs() < 0.021,
        "{}",
        record.offset_s
    );
    assert!((record.zero_n - ZERO_N).abs() < 1e-9, "{}", record.zero_n);
    assert!(
        (record.contact_height - SURFACE.0).abs() < 2e-4,
        "{}",
        record.contact_height
    );
    let (depth, force) = (&record.test.depth, &record.test.force);
    // 0.5 N are reached at 0.07 mm, and 0.3 mm of the stroke are left out at its end
    assert!(
        depth[0].abs() < 2e-4 && force[0] > 0.5 && force[0] < 1.1,
        "{} {}",
        depth[0],
        force[0]
    );
    // 457 N at the end of the stroke
    assert!(force.iter().all(|force| *force < 470.0), "{force:?}");
    let deepest = depth[depth.len() - 1];
    assert!(deepest > 0.0193 && deepest < 0.0199, "{deepest}");
    let area = record.test.plate.area;
    let fit = fit_plates(
        std::slice::from_ref(&record.test),
        &PlateSettings::default(),
    )
    .unwrap();
    assert!(
        (fit.n - LAW.1).abs() < 0.02 && (fit.k_phi * area / LAW.0).ln().abs() < 0.08,
        "{} {}",
        fit.n,
        fit.k_phi * area
    );
}

#[test]
fn clocks_zero_and_contact_are_found() {
    let mut recorded = Recorded::new("two-clocks", (7200.0, 0.35), &["/cell"]);
    check(&recorded.read().unwrap(), 7200.0, 0.35);
    // messages are recorded 0.5 s after they were measured
    recorded.source.stamp = None;
    check(&recorded.read().unwrap(), 7200.0, 0.85);
    recorded.source.stamp = Some("header.stamp".into());
    recorded.source.topic = Some("/cell".into());
    recorded.depth.surface = Some(0.003);
    let lower = recorded.read().unwrap();
    assert_eq!(lower.contact_height, 0.003);
    assert!(
        (lower.test.depth[0] + 1e-3).abs() < 3e-4,
        "{}",
        lower.test.depth[0]
    );
}

#[test]
fn a_controllers_clock_undoes_late_lines() {
    let mut recorded = Recorded::new("controller", (-3600.0, -0.2), &["/cell"]);
    (recorded.depth.clock, recorded.depth.controller) = (2, Some((4, 1e-3)));
    check(&recorded.read().unwrap(), -3600.0, -0.2);
    // in another unit, it runs at another rate
    for (unit, rate) in [(1e-6, "1.001e3 s"), (1.0, "1.001e-3 s")] {
        recorded.depth.controller = Some((4, unit));
        let refused = recorded.refused();
        assert!(
            refused.contains(rate) && refused.contains("`controller_unit`"),
            "{refused}"
        );
    }
    // and the height is no clock
    recorded.depth.controller = Some((3, 1e-3));
    assert!(recorded.refused().contains("field 3"));
}

#[test]
fn what_is_missing_is_named() {
    let mut recorded = Recorded::new("missing", (0.0, 0.0), &["/cell", "/other"]);
    assert!(recorded.refused().contains("several topics"));
    recorded.source.topic = Some("/none".into());
    assert!(recorded.refused().contains("no message with the force"));
    recorded.source.topic = Some("/other".into());
    assert!(recorded.read().is_ok());
    recorded.source.force = "twist.linear.w".into();
    assert!(recorded.refused().contains("no number `twist.linear.w`"));
    recorded.source.force = "twist.linear.x".into(); // always 0
    assert!(recorded.refused().contains("no contact"));
    recorded.source.force = "twist.linear.z".into();
    recorded.source.sign = 1.0; // pulled, never pressed
    assert!(recorded.refused().contains("no contact"));
    recorded.source.sign = -1.0;
    for (field, named) in [(9, "line 1: field 9"), (0, "line 1: field 0")] {
        recorded.depth.height = field;
        assert!(recorded.refused().contains(named));
    }
    recorded.depth.height = 3;
    let file = recorded.depth.file.clone();
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, format!("{text}1;2 inf,4\n")).unwrap();
    assert!(
        recorded
            .refused()
            .contains("line 502: field 3 is no finite number")
    );
    for (lines, few) in [(19, true), (20, false)] {
        let first: String = text
            .lines()
            .map(|line| format!("{line}\n"))
            .take(lines)
            .collect();
        fs::write(&file, first).unwrap();
        let read = recorded.read();
        assert_eq!(
            read.is_err_and(|error| error.to_string().contains("fewer than 20")),
            few,
            "{lines}"
        );
    }
    fs::write(&file, b"1;2 \xff,4\n").unwrap();
    assert!(recorded.refused().contains("UTF-8"));
    recorded.depth.file = recorded.folder.join("none.txt");
    assert!(matches!(recorded.read(), Err(Error::Log(_))));
}

#[test]
fn a_record_of_few_readings_is_refused_or_keeps_its_clocks() {
    let few =
        |messages| Recorded::with("few", (0.0, 0.0), &["/cell"], (messages, 500_000_000)).read();
    assert!(few(19).unwrap_err().to_string().contains("fewer than 20"));
    assert!(!few(20).is_err_and(|error| error.to_string().contains("fewer than 20")));
    // fewer than twenty readings under load do not show an offset
    let coarse = Recorded::with("coarse", (0.0, 0.35), &["/cell"], (31, 600_000_000))
        .read()
        .unwrap();
    assert_eq!(coarse.offset_s, 0.0);
}

/// Half of a file of heights is not read as all of it.
#[test]
fn a_file_of_heights_beyond_the_limit_is_refused() {
    let mut recorded = Recorded::new("long", (0.0, 0.0), &["/cell"]);
    recorded.depth.file = recorded.folder.join("long.txt");
    let blank = " ".repeat((1 << 20) - 1) + "\n";
    for (end, message) in [
        ("", "fewer than 20 readings"),
        ("\n", "line 65: is beyond the limit"),
    ] {
        fs::write(&recorded.depth.file, blank.repeat(64) + end).unwrap();
        let refused = recorded.refused();
        assert!(refused.contains(message), "{refused}");
    }
}
