//! Decoded messages: their order, what is left out, and what their fields and views say.

use grouser_log::message::{Value, View, build};
use grouser_log::write::McapWriter;
use grouser_log::{Clock, Messages};

use crate::scratch::Folder;
use crate::written::mcap;

/// A file of messages `uint8[] a` with the given sizes (bytes) and times.
fn bytes(messages: &[(u64, usize)]) -> Vec<u8> {
    let mut file = mcap::MAGIC.to_vec();
    mcap::schema(&mut file, 1, b"a/A", b"uint8[] a\n");
    mcap::channel(&mut file, 1, 1, b"/a", b"ros1");
    for (time, size) in messages {
        let count = u32::try_from(size - 4).unwrap().to_le_bytes();
        let data = [&count[..], &vec![0; size - 4]].concat();
        mcap::message(&mut file, 1, *time, &data);
    }
    file
}

fn read(file: &[u8], clock: Clock) -> (Vec<i64>, Messages) {
    let folder = Folder::new("messages");
    let path = folder.file("log.mcap", file);
    let mut messages = Messages::open(&path, clock, |_| true).unwrap();
    let times = messages.by_ref().map(|message| message.time_ns).collect();
    (times, messages)
}

#[test]
fn a_mebibyte_of_messages_is_held_back() {
    let limit = 1 << 20;
    // as much as that is held, whatever went before
    let pairs = [(5, limit), (4, 4), (9, limit), (8, 4)];
    let (times, messages) = read(&bytes(&pairs), Clock::Recorder);
    assert_eq!((times, messages.left_out().late), (vec![4, 5, 8, 9], 0));
    let pairs = [(5, limit + 1), (9, limit), (8, 4)];
    let (times, messages) = read(&bytes(&pairs), Clock::Recorder);
    assert_eq!((times, messages.left_out().late), (vec![5, 8, 9], 0));
    let pairs = [(5, limit + 1), (4, 4), (3, 4), (9, limit + 1), (8, 4)];
    let (times, messages) = read(&bytes(&pairs), Clock::Recorder);
    assert_eq!((times, messages.left_out().late), (vec![5, 9], 3));
}

#[test]
fn what_is_left_out_is_counted() {
    let mut file = bytes(&[(1, 8), (2, 8)]);
    let length = file.len() as u64;
    // two that cannot be decoded, and two places that cannot be read: 12 bytes each
    mcap::message(&mut file, 1, 3, &[9, 0, 0, 0]);
    mcap::message(&mut file, 1, 4, &[1]);
    mcap::record(&mut file, 5, &[1, 0, 0]);
    mcap::record(&mut file, 5, &[1, 0, 0]);
    let (times, messages) = read(&file, Clock::Recorder);
    let left_out = messages.left_out();
    assert_eq!(times, [1, 2]);
    // and the end that is missing
    assert_eq!(
        (left_out.damages, left_out.bytes_lost, left_out.undecoded),
        (3, 24, 2)
    );
    assert!(left_out.problem.as_ref().unwrap().contains("within `a`"));
    assert_eq!(messages.offset(), file.len() as u64);
    assert!(length < messages.offset());
    assert_eq!(messages.channels().len(), 1);
    assert_eq!(messages.channels()[0].topic, "/a");
}

#[test]
fn the_stamp_of_the_header_is_the_time_where_it_has_one() {
    let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
    let mut topic = writer.topic("/imu", "sensor_msgs/Imu").unwrap();
    for (stamp, recorded) in [(0, 70), (50, 71), (1, 72)] {
        let value = build::planar_imu(build::header(stamp, "imu"), Some(0.1), None);
        writer.send(&mut topic, recorded, &value).unwrap();
    }
    let file = writer.finish().unwrap();
    assert_eq!(read(&file, Clock::Header).0, [1, 50, 70]);
    assert_eq!(read(&file, Clock::Recorder).0, [70, 71, 72]);
    let folder = Folder::new("views");
    let path = folder.file("log.mcap", &file);
    let mut messages = Messages::open(&path, Clock::Header, |_| true).unwrap();
    let message = messages.next().unwrap();
    assert!(matches!(messages.view(&message), Some(View::Imu(_))));
}

#[test]
fn numbers_are_found_by_their_path() {
    let value = build::message([
        ("yes", Value::Bool(true)),
        ("less", Value::Int(-2)),
        ("more", Value::UInt(7)),
        ("part", Value::Float(0.5)),
        ("bytes", Value::Bytes(vec![8, 9])),
        ("text", Value::Text("x".into())),
        (
            "all",
            Value::Array(vec![Value::Array(vec![Value::UInt(3), Value::UInt(4)])]),
        ),
    ]);
    let numbers =
        ["yes", "less", "more", "part", "bytes[1]", "all[0][1]"].map(|path| value.number_at(path));
    assert_eq!(numbers, [1.0, -2.0, 7.0, 0.5, 9.0, 4.0].map(Some));
    let counts = ["less", "more", "bytes[0]", "all[0][0]"].map(|path| value.count_at(path));
    assert_eq!(counts, [u64::MAX - 1, 7, 8, 3].map(Some));
    for path in [
        "yes", "part", "text", "bytes", "none", "bytes[2]", "more[0]",
    ] {
        assert_eq!(value.count_at(path), None, "{path}");
    }
    for path in [
        "text",
        "bytes[2]",
        "bytes",
        "all",
        "all[1]",
        "all[0][2]",
        "less.part",
        "bytes[x]",
        "",
    ] {
        assert_eq!(value.number_at(path), None, "{path}");
    }
}

#[test]
fn times_have_their_names() {
    let time = |sec: &str, nanosec: &str| {
        let value = build::message([(sec, Value::Int(2)), (nanosec, Value::UInt(5))]);
        value.time_ns()
    };
    for (sec, nanosec) in [("sec", "nanosec"), ("secs", "nsecs"), ("sec", "nsec")] {
        assert_eq!(time(sec, nanosec), Some(2_000_000_005));
    }
    assert_eq!(time("s", "nanosec"), None);
    let text = build::message([("sec", Value::Float(2.0)), ("nanosec", Value::UInt(5))]);
    assert_eq!(text.time_ns(), None);
}

#[test]
fn views_are_of_known_types_and_whole_messages() {
    for name in ["sensor_msgs/msg/Image", "demo/Imu", ""] {
        assert!(!View::exists_for(name), "{name}");
    }
    assert!(View::exists_for("tf/tfMessage") && View::exists_for("grouser_msgs/msg/WheelTicks"));
    let ticks = build::message([
        ("name", build::texts(&["a", "b"])),
        ("ticks", Value::Array(vec![Value::Int(-2), Value::UInt(7)])),
    ]);
    let Some(View::WheelTicks { ticks, .. }) = View::new("grouser_msgs/WheelTicks", &ticks) else {
        panic!("it has all fields of its type")
    };
    assert_eq!(ticks.iter().collect::<Vec<u64>>(), [u64::MAX - 1, 7]);
    for (turn, expected) in [(None, None), (Some(0.5), Some(0.5))] {
        let way = build::displacement(build::header(1, ""), 1.0, 2.0, turn);
        let view = View::new("grouser_msgs/Displacement", &way);
        assert_eq!(
            view,
            Some(View::Displacement {
                forward: 1.0,
                left: 2.0,
                turn: expected
            })
        );
    }
}

#[test]
fn the_variance_of_a_fix_is_the_larger_where_it_is_known() {
    let fix = |status: i64, variances: [f64; 2], kind: u64| {
        let mut covariance = [0.0; 9];
        (covariance[0], covariance[4]) = (variances[0], variances[1]);
        let status = build::message([("status", Value::Int(status)), ("service", Value::UInt(1))]);
        let value = build::message([
            ("status", status),
            ("latitude", Value::Float(45.0)),
            ("longitude", Value::Float(9.0)),
            ("altitude", Value::Float(100.0)),
            ("position_covariance", build::numbers(&covariance)),
            ("position_covariance_type", Value::UInt(kind)),
        ]);
        let Some(View::NavSatFix(fix)) = View::new("sensor_msgs/NavSatFix", &value) else {
            panic!("it has all fields of its type")
        };
        (fix.is_fixed, fix.status, fix.variance)
    };
    assert_eq!(fix(0, [0.5, 0.25], 1), (true, 0, Some(0.5)));
    assert_eq!(fix(2, [0.25, 0.5], 2), (true, 2, Some(0.5)));
    assert_eq!(fix(-1, [0.25, 0.5], 0), (false, -1, None));
    assert_eq!(fix(0, [0.25, f64::MAX], 1).2, Some(f64::INFINITY));
    assert_eq!(fix(0, [0.25, 0.0], 1).2, None);
}
