//! Latitudes and longitudes in the columns of a table, beside the same fixes of a satellite receiver in a bag.

use std::fmt::Write as _; // writing to a string cannot fail
use std::io::Cursor;

use grouser_files::Document;
use grouser_files::columns::{self, Meaning};
use grouser_files::topics::Topics;
use grouser_log::message::{Value, build};
use grouser_log::write::McapWriter;
use grouser_log::{Log, Sheet, suggest_for_sheets};
use grouser_slip::{Measurement as M, Sample};

use crate::choosing::topics;
use crate::scratch::Folder;

/// A fix: latitude and longitude, deg, altitude, kind (0: none), and standard deviation, m.
type Fix = (f64, f64, f64, i64, f64);

/// A bend to the left in the Alps, at 5 Hz, with a gyro at 50 Hz; the receiver changes its kind of solution on the way.
fn drive() -> Vec<(i64, f64, Option<Fix>)> {
    let (rate, speed, ahead) = (0.2_f64, 0.8, 0.4);
    let rows = 0..600_i64;
    rows.map(|row| {
        let time = 0.02 * row as f64;
        let yaw = 0.5 + rate * time;
        let (sin, cos) = yaw.sin_cos();
        // of the antenna, ahead of the origin
        let (east, north) = (
            speed / rate * sin + ahead * cos,
            -speed / rate * cos + ahead * sin,
        );
        let fix = (
            46.5 + north / 111_165.0,
            8.1 + east / 76_800.0,
            1800.0 + 0.1 * time,
            3,
            if row < 400 { 0.02 } else { 0.3 },
        );
        (20 * row, rate, (row % 10 == 0).then_some(fix))
    })
    .collect()
}

const COLUMNS: &str = "{ column = \"g\", meaning = \"yaw_rate\", unit = \"rad/s\" },\
    { column = \"lat\", meaning = \"latitude\", unit = \"deg\" },\
    { column = \"lon\", meaning = \"longitude\", unit = \"deg\" },\
    { column = \"alt\", meaning = \"altitude\", unit = \"m\" },\
    { column = \"kind\", meaning = \"fix_type\", unit = \"1\" },\
    { column = \"acc\", meaning = \"fix_sigma\", unit = \"m\" }";

fn table(columns: &str, text: String, topics: &Topics) -> Log {
    let map = format!(
        "format = 1\n[[table]]\ntime = {{ column = \"t\", unit = \"ms\" }}\ncolumns = [{columns}]\n"
    );
    let map = columns::parse(&Document::from_text("columns.toml", map).unwrap()).unwrap();
    Log::over("run.csv".as_ref(), Cursor::new(text), Some(map), topics).unwrap()
}

fn as_table(drive: &[(i64, f64, Option<Fix>)]) -> String {
    let mut text = "t,g,lat,lon,alt,kind,acc\n".to_owned();
    for (time, rate, fix) in drive {
        let fix = fix.map_or(",,,,".to_owned(), |(lat, lon, alt, kind, acc)| {
            format!("{lat:?},{lon:?},{alt:?},{kind},{acc:?}")
        });
        writeln!(text, "{time},{rate:?},{fix}").unwrap();
    }
    text
}

fn as_bag(drive: &[(i64, f64, Option<Fix>)], topics: &Topics) -> Log {
    let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
    let mut imu = writer.topic("/imu", "sensor_msgs/Imu").unwrap();
    let mut fixes = writer.topic("/fix", "sensor_msgs/NavSatFix").unwrap();
    for (time, rate, fix) in drive {
        let time_ns = 1_000_000 * time;
        let header = || build::header(time_ns, "");
        let value = build::planar_imu(header(), Some(*rate), None);
        writer.send(&mut imu, time_ns, &value).unwrap();
        let Some((lat, lon, alt, kind, acc)) = *fix else {
            continue;
        };
        let mut covariance = [0.0; 9];
        (covariance[0], covariance[4]) = (acc * acc, acc * acc);
        let status = Value::Int(if kind > 0 { 0 } else { -1 });
        let value = build::message([
            ("header", header()),
            (
                "status",
                build::message([("status", status), ("service", Value::UInt(1))]),
            ),
            ("latitude", Value::Float(lat)),
            ("longitude", Value::Float(lon)),
            ("altitude", Value::Float(alt)),
            ("position_covariance", build::numbers(&covariance)),
            ("position_covariance_type", Value::UInt(2)),
        ]);
        writer.send(&mut fixes, time_ns, &value).unwrap();
    }
    let bytes = writer.finish().unwrap();
    Log::over("run.mcap".as_ref(), Cursor::new(bytes), None, topics).unwrap()
}

fn samples(log: &Log) -> Vec<Sample> {
    log.samples(&[]).unwrap().map(Result::unwrap).collect()
}

fn assert_same(table: &Log, bag: &Log) {
    let start = |samples: &[Sample]| samples[0].time_ns;
    let (ours, theirs) = (samples(table), samples(bag));
    assert_eq!(ours.len(), theirs.len());
    for (a, b) in ours.iter().zip(&theirs) {
        assert_eq!(a.time_ns - start(&ours), b.time_ns - start(&theirs));
        let is_close = |a: f64, b: f64| (a - b).abs() < 1e-7;
        let is_same = match (a.measurement, b.measurement) {
            (M::YawRate { rate: a }, M::YawRate { rate: b }) => a == b,
            (M::Position { x, y }, M::Position { x: b_x, y: b_y }) => {
                is_close(x, b_x) && is_close(y, b_y)
            }
            (
                M::Displacement {
                    forward,
                    left,
                    turn,
                },
                M::Displacement {
                    forward: b_forward,
                    left: b_left,
                    turn: b_turn,
                },
            ) => is_close(forward, b_forward) && is_close(left, b_left) && turn == b_turn,
            _ => false,
        };
        assert!(is_same, "{a:?} and {b:?}");
    }
    assert!(
        ours.iter()
            .any(|sample| matches!(sample.measurement, M::Displacement { .. }))
    );
    assert_eq!(table.position_sigma(), bag.position_sigma());
    let counts = |log: &Log| (log.left_out().excluded, log.left_out().exclusion);
    assert_eq!(counts(table), counts(bag));
}

#[test]
fn fixes_of_a_table_are_those_of_a_bag() {
    let antenna = topics("antenna_x_m = 0.4");
    let all = drive();
    assert_same(
        &table(COLUMNS, as_table(&all), &antenna),
        &as_bag(&all, &antenna),
    );
    // bad ones between them, of each kind
    for bad in [
        (91.0, 8.1, 1800.0, 3, 0.02),
        (46.5, 181.0, 1800.0, 3, 0.02),
        (46.5, 8.1, 1800.0, 0, 0.02),
        (46.5, 8.1, 1800.0, -1, 0.02),
        (0.0, 0.0, 0.0, 3, 0.02),
        (46.5, 8.1, 1800.0, 3, 12.0),
        (46.5, 8.1, 1800.0, 3, 0.6),
        // without a standard deviation: that of satellites alone, beside better ones
        (46.5, 8.1, 1800.0, 3, 0.0),
    ] {
        let mut all = all.clone();
        for row in all.iter_mut().step_by(50) {
            row.2 = Some(bad);
        }
        let (ours, theirs) = (
            table(COLUMNS, as_table(&all), &antenna),
            as_bag(&all, &antenna),
        );
        assert_same(&ours, &theirs);
        assert_eq!(ours.left_out().excluded, 12, "{bad:?}");
        // and nothing else
        for row in &mut all {
            row.2 = row.2.map(|_| bad);
        }
        let (ours, theirs) = (
            table(COLUMNS, as_table(&all), &antenna),
            as_bag(&all, &antenna),
        );
        assert_eq!(
            ours.measures(Meaning::DisplacementForward),
            theirs.measures(Meaning::DisplacementForward)
        );
        let of_file = |log: &Log, name: &str| log.notes().join("\n").replace(name, "");
        assert_eq!(
            of_file(&ours, "`run.csv`"),
            of_file(&theirs, "`/fix`"),
            "{bad:?}"
        );
        assert!(!of_file(&ours, "").is_empty());
    }
}

/// A way to the north from 45°: one minute of a meridian is 1852.2 m there (Bomford, Geodesy; WGS 84: 111 131.78 m a degree).
#[test]
fn a_degree_has_its_length() {
    let columns = "{ column = \"lat\", meaning = \"latitude\", unit = \"1e-7 deg\" },\
                   { column = \"lon\", meaning = \"longitude\", unit = \"1e-7 deg\" }";
    let mut text = "t,lat,lon\n".to_owned();
    for row in 0..=10_i64 {
        writeln!(
            text,
            "{},{},{}",
            100 * row,
            450_000_000 + 100 * row,
            90_000_000
        )
        .unwrap();
    }
    let log = table(columns, text.clone(), &topics(""));
    let notes = log.notes().join("\n");
    assert!(
        notes.contains(
            "does not say how accurate its fixes are, assumed is a standard deviation of 2.5 m"
        ),
        "{notes}"
    );
    let places: Vec<[f64; 2]> = samples(&log)
        .iter()
        .filter_map(|sample| match sample.measurement {
            M::Position { x, y } => Some([x, y]),
            _ => None,
        })
        .collect();
    assert_eq!((places.len(), places[0]), (11, [0.0, 0.0]));
    let expected = 1e-4 * 111_131.78;
    assert!(
        places[10][0].abs() < 1e-6 && (places[10][1] - expected).abs() < 1e-5,
        "{places:?}"
    );
    // the robot file states it
    let mut stated = topics("");
    stated.position_sigma = Some(0.03);
    let log = table(columns, text, &stated);
    assert_eq!((log.position_sigma(), log.notes().len()), (Some(0.03), 0));
}

#[test]
fn a_status_is_that_of_a_bag() {
    let columns = "{ column = \"lat\", meaning = \"latitude\", unit = \"deg\" },\
                   { column = \"lon\", meaning = \"longitude\", unit = \"deg\" },\
                   { column = \"s\", meaning = \"fix_status\", unit = \"1\" }";
    let text =
        |status: i32| format!("t,lat,lon,s\n0,45,9,-1\n100,45,9,{status}\n200,45,9,{status}\n");
    for (status, sigma) in [(0, 2.5), (1, 1.0), (2, 0.02)] {
        let log = table(columns, text(status), &topics(""));
        assert_eq!(log.position_sigma(), Some(sigma));
        assert_eq!((samples(&log).len(), log.left_out().excluded), (2, 1));
    }
}

/// A drive to the north whose fixes are the fields of a message, with their standard deviations, mm; the last is none.
fn of_fields(sigma_mm: impl Fn(i64) -> f64) -> Log {
    let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
    let mut topic = writer.topic("/nav", "geometry_msgs/PointStamped").unwrap();
    let mut send = |row: i64, latitude: f64| {
        let time_ns = 1 + 100_000_000 * row;
        let value = build::message([
            ("header", build::header(time_ns, "")),
            ("point", build::vector([latitude, 9e7, sigma_mm(row)])),
        ]);
        writer.send(&mut topic, time_ns, &value).unwrap();
    };
    for row in 0..20 {
        send(row, 45e7 + 100.0 * row as f64);
    }
    send(20, 91e7);
    let field = |axis: &str, meaning: &str, unit: &str| {
        format!(
            "[[topics.field]]\ntopic = \"/nav\"\nfield = \"point.{axis}\"\nmeaning = \"{meaning}\"\nunit = \"{unit}\"\n"
        )
    };
    let wanted = field("x", "latitude", "1e-7 deg")
        + &field("y", "longitude", "1e-7 deg")
        + &field("z", "fix_sigma", "mm");
    let bytes = Cursor::new(writer.finish().unwrap());
    Log::over("run.mcap".as_ref(), bytes, None, &topics(&wanted)).unwrap()
}

#[test]
fn fixes_in_the_fields_of_a_message_are_fixes() {
    let ways = |log: &Log| -> Vec<[f64; 2]> {
        let ways = samples(log).into_iter();
        let way = |sample: Sample| match sample.measurement {
            M::Displacement { forward, left, .. } => Some([forward, left]),
            _ => None,
        };
        ways.filter_map(way).collect()
    };
    let log = of_fields(|_| 20.0);
    assert_eq!(log.position_sigma(), Some(0.02));
    let found = ways(&log);
    let expected = 1e-5 * 111_131.78;
    assert!(found.len() >= 18, "{found:?}");
    assert!(
        found
            .iter()
            .all(|[forward, left]| (forward - expected).abs() < 1e-6 && left.abs() < 1e-6)
    );
    assert_eq!(log.left_out().excluded, 1);
    assert!(log.left_out().exclusion.unwrap().contains("out of range"));
    // where the standard deviation grows tenfold the receiver changed its kind of solution: that way is none
    let changed = of_fields(|row| if row < 10 { 20.0 } else { 200.0 });
    assert_eq!(ways(&changed).len(), found.len() - 1);
}

#[test]
fn a_pose_and_fixes_are_two_places() {
    let both = "format = 1\n[[table]]\ntime = { column = \"t\", unit = \"ms\" }\ncolumns = [\
        { column = \"x\", meaning = \"pose_x\", unit = \"m\" }, { column = \"y\", meaning = \"pose_y\", unit = \"m\" },\
        { column = \"a\", meaning = \"latitude\", unit = \"deg\" }, { column = \"o\", meaning = \"longitude\", unit = \"deg\" }]\n";
    let error =
        columns::parse(&Document::from_text("c.toml", both.to_owned()).unwrap()).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("`pose_x` and `latitude` are places of one robot"),
        "{error}"
    );
}

/// What is proposed for a header and rows: each meaning with its column and unit.
fn proposed(header: &str, rows: &[&str]) -> Vec<(String, &'static str, &'static str)> {
    let folder = Folder::new("fix-columns");
    let text = format!("t,{header}\n0,{}\n0.1,{}\n", rows[0], rows[rows.len() - 1]);
    let path = folder.file("log.csv", text.as_bytes());
    let sheet = Sheet::read(&path, |_| ()).unwrap();
    let robot = suggest_for_sheets([(&sheet, "log.csv")]);
    // what is proposed is a column map
    Document::from_text("robot.toml", robot).unwrap();
    let found = sheet.columns.iter().filter_map(|column| {
        let guess = column.guess.as_ref()?;
        Some((column.name.clone(), guess.meaning.name(), guess.unit))
    });
    found.collect()
}

fn assert_proposed(header: &str, rows: &[&str], expected: &[&str]) {
    let found = proposed(header, rows);
    let found: Vec<String> = found
        .iter()
        .map(|(_, meaning, unit)| format!("{meaning} {unit}"))
        .collect();
    assert_eq!(found, expected, "{header}");
}

#[test]
fn plain_names_of_fixes_are_known() {
    for (header, rows, expected) in [
        (
            "lat,lon",
            ["46.5,8.1"; 2],
            vec!["latitude deg", "longitude deg"],
        ),
        (
            "latitude,longitude,altitude",
            ["46.5,8.1,400"; 2],
            vec!["latitude deg", "longitude deg", "altitude m"],
        ),
        (
            "gps_lat,gps_lng,gps_alt",
            ["46.5,8.1,400"; 2],
            vec!["latitude deg", "longitude deg", "altitude m"],
        ),
        (
            "Latitude [deg],Longitude [deg]",
            ["46.5,8.1"; 2],
            vec!["latitude deg", "longitude deg"],
        ),
        (
            "latitude_deg,longitude_deg",
            ["46.5,8.1"; 2],
            vec!["latitude deg", "longitude deg"],
        ),
        (
            "lat_e7,lon_e7,alt_mm",
            ["465000000,81000000,400123"; 2],
            vec!["latitude 1e-7 deg", "longitude 1e-7 deg", "altitude mm"],
        ),
        // as PX4 and ArduPilot write them, whatever the name
        (
            "lat,lon,fix_type,eph",
            ["465000000,81000000,3,0.8"; 2],
            vec![
                "latitude 1e-7 deg",
                "longitude 1e-7 deg",
                "fix_type 1",
                "fix_sigma m",
            ],
        ),
        (
            "GPS.Lat,GPS.Lng,GPS.Status",
            ["46.5,8.1,6"; 2],
            vec!["latitude deg", "longitude deg", "fix_type 1"],
        ),
        (
            "/gps/fix/latitude,/gps/fix/longitude,/gps/fix/status/status",
            ["46.5,8.1,-1", "46.5,8.1,0"],
            vec!["latitude deg", "longitude deg", "fix_status 1"],
        ),
        (
            "gps_status,lat,lon",
            ["0,46.5,8.1"; 2],
            vec!["latitude deg", "longitude deg"],
        ),
        (
            "lat,lon,hAcc_mm,fixType",
            ["46.5,8.1,14,3"; 2],
            vec![
                "latitude deg",
                "longitude deg",
                "fix_sigma mm",
                "fix_type 1",
            ],
        ),
        // millimetres, or metres?
        (
            "lat,lon,hAcc",
            ["46.5,8.1,14"; 2],
            vec!["latitude deg", "longitude deg"],
        ),
        (
            "lat,lon,hAcc",
            ["46.5,8.1,0"; 2],
            vec!["latitude deg", "longitude deg", "fix_sigma m"],
        ),
        // one alone; degrees and minutes; what is no place
        ("lat", ["46.5"; 2], vec![]),
        ("lat,lon", ["4630.123,00806.123"; 2], vec![]),
        ("lat_acc,long_acc,lateral,long_v", ["1,2,3,4"; 2], vec![]),
        // an odometry gives way, a pose does not
        (
            "odom_x,odom_y,lat,lon",
            ["1,2,46.5,8.1"; 2],
            vec!["latitude deg", "longitude deg"],
        ),
        (
            "vicon_x,vicon_y,lat,lon",
            ["1,2,46.5,8.1"; 2],
            vec!["pose_x m", "pose_y m"],
        ),
    ] {
        assert_proposed(header, &rows, &expected);
    }
}

#[test]
fn numbers_of_fixes_show_their_units_and_kinds() {
    for (header, rows, expected) in [
        // a kind of fix is a whole number; of one that is never above 0 none is a position, and a status up to 2 may be a kind
        (
            "lat,lon,fix_type",
            ["46.5,8.1,2"; 2],
            vec!["latitude deg", "longitude deg", "fix_type 1"],
        ),
        (
            "lat,lon,fix_type",
            ["46.5,8.1,0"; 2],
            vec!["latitude deg", "longitude deg"],
        ),
        (
            "lat,lon,fix_type",
            ["46.5,8.1,2.5"; 2],
            vec!["latitude deg", "longitude deg"],
        ),
        (
            "lat,lon,gps_status",
            ["46.5,8.1,0", "46.5,8.1,2"],
            vec!["latitude deg", "longitude deg"],
        ),
        // south of the equator and west of Greenwich
        (
            "lat,lon",
            ["-334500000,-705000000"; 2],
            vec!["latitude 1e-7 deg", "longitude 1e-7 deg"],
        ),
        (
            "lat,lon",
            ["46.5,-180.0"; 2],
            vec!["latitude deg", "longitude deg"],
        ),
        ("lat,lon", ["4630,806"; 2], vec![]),
        ("lat,lon", ["1000000,1000000"; 2], vec![]),
        ("lat,lon", ["46500000.5,8100000.5"; 2], vec![]),
    ] {
        assert_proposed(header, &rows, &expected);
    }
}
