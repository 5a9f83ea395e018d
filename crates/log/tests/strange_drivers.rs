//! Recordings as drivers and recorders leave them: compressed as a whole, stamps of 0, arrays without numbers, a sensor away from the
//! robot's origin, files of other programs, tables of other layouts.

use std::fs;

use grouser_files::Document;
use grouser_files::columns::Meaning;
use grouser_log::message::{Value, build};
use grouser_log::{Error, Log, Sheet, suggest_for_sheets};
use grouser_slip::Measurement;

use crate::carts::{Message, log, readings, robot};
use crate::choosing::fix;
use crate::recordings::write;
use crate::scratch::Folder;

const JOINTS: &str = "sensor_msgs/JointState";

fn joints(stamp_ns: i64, time_ns: i64, parts: [f64; 2]) -> Message {
    let [angle, rate] = parts;
    let value = build::joint_state(
        build::header(stamp_ns, ""),
        &["left"],
        [&[angle], &[rate], &[]],
    );
    ("/joint_states", JOINTS, time_ns, value)
}

#[test]
fn a_recording_compressed_as_a_whole_is_read() {
    let folder = Folder::new("whole-zstd");
    let messages: Vec<Message> = (1..300)
        .map(|k| joints(k * 1000, k * 1000, [0.1, 1.0]))
        .collect();
    let plain = write(&folder.0.join("run_0.mcap"), &messages);
    let bytes = fs::read(&plain).unwrap();
    let level = ruzstd::encoding::CompressionLevel::Fastest;
    let packed = ruzstd::encoding::compress_to_vec(bytes.as_slice(), level);
    let whole = folder.file("run_0.mcap.zstd", &packed);
    let read = |path| readings(&Log::find_any(&[path], None, &robot("").topics).unwrap());
    assert_eq!(read(whole), read(plain));
    // a recorder that was killed
    let cut = folder.file("run_1.mcap.zstd", &packed[..packed.len() / 2]);
    if let Ok(log) = Log::find_any(&[cut], None, &robot("").topics) {
        assert!(log.samples(&[]).unwrap().count() <= 2 * messages.len());
    }
}

#[test]
fn a_lone_stamp_of_zero_is_at_its_place_by_the_others() {
    let folder = Folder::new("lone-zero");
    // a simulated clock that began at 5 s; the recorder's is another
    let (start, recorder) = (5_000_000_000, 1_700_000_000_000_000_000);
    let at = |k: i64| k * 50_000_000;
    let messages: Vec<Message> = (0..100)
        .map(|k| {
            joints(
                if k == 40 { 0 } else { start + at(k) },
                recorder + at(k),
                [0.1, 1.0],
            )
        })
        .collect();
    let log = log(&folder, "", &messages);
    let times: Vec<i64> = readings(&log).iter().map(|sample| sample.time_ns).collect();
    assert_eq!(times.len(), 200);
    assert_eq!((times[80], times[199]), (start + at(40), start + at(99)));
}

#[test]
fn arrays_without_numbers_or_without_change_are_not_the_wheels() {
    for (angle, note) in [(f64::NAN, "no numbers"), (0.0, "show no motion")] {
        let folder = Folder::new("unmeasured");
        let messages: Vec<Message> = (1..60)
            .map(|k| joints(k * 1000, k * 1000, [angle, 0.01 * k as f64]))
            .collect();
        let log = log(&folder, "", &messages);
        assert!(!log.measures(Meaning::WheelAngle) && log.measures(Meaning::WheelRate));
        assert!(
            log.notes().iter().any(|own| own.contains(note)),
            "{:?}",
            log.notes()
        );
    }
}

#[test]
fn a_field_leaves_the_other_contents_of_its_topic_free() {
    let folder = Folder::new("field-leaves");
    let messages: Vec<Message> = (1..60)
        .map(|k| joints(k * 1000, k * 1000, [0.01 * k as f64, 0.5]))
        .collect();
    let field = "[[topics.field]]\ntopic = \"/joint_states\"\nfield = \"position[0]\"\nmeaning = \"wheel_steering\"\n\
        wheel = \"left\"\nunit = \"rad\"\n";
    let log = log(&folder, field, &messages);
    assert!(log.measures(Meaning::WheelSteering) && log.measures(Meaning::WheelRate));
}

/// A sensor 0.4 m to the left of the origin that looks to the left.
fn offset_sensor(frame: &str) -> Message {
    let transform = build::message([
        ("header", build::header(5, "base_link")),
        ("child_frame_id", Value::Text(frame.into())),
        (
            "transform",
            build::message([
                ("translation", build::vector([0.0, 0.4, 0.2])),
                ("rotation", build::turn(std::f64::consts::FRAC_PI_2)),
            ]),
        ),
    ]);
    let transforms = build::message([("transforms", Value::Array(vec![transform]))]);
    ("/tf_static", "tf2_msgs/TFMessage", 5, transforms)
}

#[test]
fn the_speed_of_a_mounted_sensor_is_along_the_robots_axes() {
    for (keys, place, along) in [
        ("", [0.0, 0.4], [0.5, 0.1]),
        // the robot file outranks the transforms
        (
            "[estimator]\nreference_x_m = 0.1\n",
            [0.0, 0.0],
            [0.1, -0.5],
        ),
    ] {
        let folder = Folder::new("mounted-speed");
        let speed = |k: i64| {
            let value = build::twist_stamped(build::header(k, "radar"), [0.1, -0.5, 0.0], [0.0; 3]);
            ("/radar/speed", "geometry_msgs/TwistStamped", k, value)
        };
        let mut messages = vec![offset_sensor("radar")];
        for k in 1..=5 {
            messages.extend([speed(1000 * k), joints(1000 * k, 1000 * k, [0.1, 1.0])]);
        }
        let log = log(
            &folder,
            &format!("{keys}[topics]\nspeed = \"/radar/speed\""),
            &messages,
        );
        assert_eq!(grouser_log::Measures::speed_place(&log), place);
        let mut count = 0;
        for sample in readings(&log) {
            if let Measurement::Speed { forward, left } = sample.measurement {
                count += 1;
                let error = (forward - along[0]).abs() + (left.unwrap() - along[1]).abs();
                assert!(error < 1e-12, "{sample:?}");
            }
        }
        assert_eq!(count, 5);
    }
}

/// An antenna away from the origin needs a gyro; the note shows that its position is known.
#[test]
fn the_place_of_an_antenna_is_that_of_the_transforms() {
    for (frame, is_offset) in [("gps", true), ("other", false)] {
        let folder = Folder::new("mounted-antenna");
        let messages = [offset_sensor(frame), fix("/fix", 1e-4)];
        let log = log(&folder, "", &messages);
        let has_note = |note: &String| note.contains("the antenna is not above");
        assert_eq!(
            log.notes().iter().any(has_note),
            is_offset,
            "{:?}",
            log.notes()
        );
    }
}

/// A camera 0.4 m to the left of the origin that looks to the left: its odometry becomes that of the robot.
#[test]
fn the_pose_of_a_mounted_sensor_is_that_of_the_robot() {
    let folder = Folder::new("mounted");
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut messages = vec![offset_sensor("camera")];
    // the robot turns on the spot at (2, 1)
    for k in 1..=20_i64 {
        let yaw = 0.1 * k as f64;
        let (sin, cos) = yaw.sin_cos();
        let place = [2.0 - 0.4 * sin, 1.0 + 0.4 * cos];
        let covariance = || ("covariance", build::numbers(&[0.0; 36]));
        let pose = build::pose(place[0], place[1], yaw + quarter);
        let twist = build::twist([0.0; 3], [0.0; 3]);
        let value = build::message([
            ("header", build::header(k * 1000, "map")),
            ("child_frame_id", Value::Text("camera".into())),
            ("pose", build::message([("pose", pose), covariance()])),
            ("twist", build::message([("twist", twist), covariance()])),
        ]);
        messages.push(("/camera/odometry", "nav_msgs/Odometry", k * 1000, value));
        messages.push(joints(k * 1000, k * 1000, [0.1, 1.0]));
    }
    let log = log(&folder, "[topics]\npose = \"/camera/odometry\"", &messages);
    let mut poses = 0;
    for sample in readings(&log) {
        if let Measurement::Pose { x, y, yaw } = sample.measurement {
            poses += 1;
            let error = f64::hypot(x - 2.0, y - 1.0) + (yaw - 0.1 * f64::from(poses)).abs();
            assert!(error < 1e-9, "{sample:?}");
        }
    }
    assert_eq!(poses, 20);
    assert!(
        log.topics()
            .any(|topic| topic.used_for.contains("whose mounting"))
    );
}

#[test]
fn files_of_other_programs_are_named_with_what_converts_them() {
    let folder = Folder::new("foreign");
    for (bytes, kind, advice) in [
        (&b"ULog\x01\x12\x35\x01"[..], "ULog", "ulog2csv"),
        (b"\xa3\x95\x80\x80\x59", "DataFlash", "mavlogdump"),
        (b"MATLAB 5.0 MAT-file, Platform", "MATLAB", "CSV"),
        (b"MATLAB 7.3 MAT-file, Platform", "HDF5", "CSV"),
        (b"\x89HDF\r\n\x1a\n\0\0", "HDF5", "h5dump"),
        (b"PAR1\x15\x04", "Parquet", "read_parquet"),
        (b"ARROW1\0\0\x10", "Arrow", "read_feather"),
        (b"\x93NUMPY\x01\0", "NumPy", "savetxt"),
        (b"\xb5\x62\x01\x07", "UBX", "CSV"),
        (b"PK\x03\x04\x14\0", "ZIP", "unzip"),
        (b"7z\xbc\xaf\x27\x1c\0\x04", "7z", "7z x"),
        (b"\xfd7zXZ\0\0\x04", "xz", "unxz"),
        (b"BZh91AY&SY\0\0", "bzip2", "bunzip2"),
        (b"\x04\x22\x4d\x18\x40", "LZ4", "lz4 -d"),
        (
            b"version https://git-lfs.github.com/spec/v1\n",
            "Git LFS",
            "git lfs pull",
        ),
        (b"<!DOCTYPE html>\n<html>", "web page", "raw file"),
    ] {
        let path = folder.file("run.log", bytes);
        let refused = [
            Log::needs_columns(std::slice::from_ref(&path)).unwrap_err(),
            Sheet::read(&path, |_| ()).unwrap_err(),
        ];
        for error in refused {
            assert!(matches!(error, Error::Foreign { .. }), "{error}");
            let hint = error.hint().unwrap();
            assert!(
                error.to_string().contains(kind) && hint.contains(advice),
                "{error}: {hint}"
            );
        }
    }
}

/// The robot file for a table.
fn suggested(text: &str) -> String {
    let folder = Folder::new("layout");
    let sheet = Sheet::read(&folder.file("log.csv", text.as_bytes()), |_| ()).unwrap();
    suggest_for_sheets([(&sheet, "log.csv")])
}

#[test]
fn columns_of_public_layouts_are_read_or_asked_about() {
    for (text, wanted) in [
        (
            "elapsed time sensors,acc x (IMU),acc y (IMU),W (IMU),vel encoder,steering,vicon time,vicon x,vicon y,vicon yaw\n\
             0.0,0.1,0.0,0.01,0.5,0.1,0.0,1.0,2.0,0.1\n5.0,0.1,0.0,-0.02,0.6,0.1,4.9,1.1,2.0,0.2\n\
             5.1,0.1,0.0,0.02,0.7,0.1,5.0,1.2,2.0,0.2\n",
            &[
                "time = { column = \"elapsed time sensors\"",
                "# { column = \"acc x (IMU)\", meaning = \"acceleration_forward\"",
                "# { column = \"W (IMU)\", meaning = \"yaw_rate\"",
                "# { column = \"vel encoder\", meaning = \"\"",
                "# { column = \"steering\", meaning = \"steering_angle\"",
                "# \"vicon time\": another clock",
                "{ column = \"vicon x\", meaning = \"pose_x\"",
                "{ column = \"vicon yaw\", meaning = \"pose_yaw\"",
            ][..],
        ),
        (
            "Sec,NanoSec,0-ref Sec,w_left,w_right\n1700000000,500000000,0.0,1.5,2.5\n1700000000,600000000,0.1,1.5,2.5\n\
             1700000000,700000000,0.2,1.6,2.5\n",
            &[
                "time = { column = \"Sec\", unit = \"s\", nanoseconds = \"NanoSec\" }",
                "# { column = \"w_left\", meaning = \"\", wheel = \"left\"",
            ],
        ),
        (
            "Sec,NanoSec,Latitude,Longitude,w_z\n1700000000,500000000,46.1,8.1,0.1\n1700000000,600000000,nan,nan,0.1\n\
             1700000000,700000000,46.2,8.2,0.2\n",
            &[
                "missing = [\"nan\"]",
                "{ column = \"Latitude\", meaning = \"latitude\", unit = \"deg\" }",
                "# { column = \"w_z\", meaning = \"yaw_rate\"",
            ],
        ),
        (
            "timestamps,CAN2.gnss_pos.Latitude,CAN2.gnss_pos.Longitude,CAN1.CCVS1.WheelBasedVehicleSpeed,CAN2.gnss_speed.Speed\n\
             2026-03-02T09:15:30.25Z,46.1,8.1,10.5,10.4\n2026-03-02T09:15:30.35Z,46.1,8.1,10.5,10.4\n",
            &[
                "time = { column = \"timestamps\", unit = \"date\" }",
                "{ column = \"CAN2.gnss_pos.Latitude\", meaning = \"latitude\", unit = \"deg\" }",
                "# { column = \"CAN1.CCVS1.WheelBasedVehicleSpeed\", meaning = \"\"",
                "# { column = \"CAN2.gnss_speed.Speed\", meaning = \"speed_size\"",
            ],
        ),
        (
            "time,velL,velR,curL,curR,wz\n0.0,0.5,0.6,1,1,0.1\n0.1,0.5,0.6,1,1,0.1\n0.2,0.5,0.6,1,1,0.2\n",
            &[
                "# { column = \"velL\", meaning = \"\", wheel = \"l\"",
                "# { column = \"wz\", meaning = \"yaw_rate\"",
            ],
        ),
        (
            "0.05,-2.1e-04,1.8e-04,1.4e-04,12,11\n0.10,-2.2e-04,1.8e-04,1.4e-04,12,13\n",
            &[
                "# { column = \"2\", meaning = \"\"",
                "not the ticks since the row before",
            ],
        ),
        (
            "2024_01_01_12_15_29_873,103,98,0.11,0.42\n2024_01_01_12_15_29_923,105,99,0.11,0.43\n",
            &[
                "time = { column = \"1\", unit = \"date\" }",
                "# { column = \"2\", meaning = \"\"",
            ],
        ),
        (
            "2025/07/11/14:06:12.45,0.31,0.12\n2025/07/11/14:06:12.55,0.32,0.12\n",
            &["time = { column = \"1\", unit = \"date\" }"],
        ),
        (
            "t,x_m,y_m\n0.0,0.1,0.2\n0.1,0.1,0.3\n0.2,0.2,0.3\n",
            &[
                "{ column = \"x_m\", meaning = \"pose_x\", unit = \"m\" }",
                "{ column = \"y_m\", meaning = \"pose_y\", unit = \"m\" }",
            ],
        ),
        (
            "Date,Time,left_rad_s\n2026-03-02,09:15:00.000,0.1\n2026-03-02,09:15:00.050,0.1\n",
            &["time = { column = \"Date\", unit = \"date\", time_of_day = \"Time\" }"],
        ),
    ] {
        let found = suggested(text);
        for line in wanted {
            assert!(found.contains(line), "{line}\n{found}");
        }
        let states_unit = text.contains("rad_s");
        assert_eq!(
            found.contains("meaning = \"wheel_rate\""),
            states_unit,
            "{found}"
        );
    }
    let folder = Folder::new("tagged");
    let tagged = folder.file(
        "log.txt",
        b"odom2 12.31 0.41 0.40\npoint2 12.36 1.203 0.871\nodom2 12.41 0.41 0.40\n",
    );
    let error = Sheet::read(&tagged, |_| ()).unwrap_err().to_string();
    assert!(error.contains("grep"), "{error}");
}

#[test]
fn a_date_and_a_time_of_day_in_two_columns_are_one_time() {
    let folder = Folder::new("two-columns");
    let text = "Date,Time,left\n2026-03-02,23:59:59.950,0.1\n2026-03-03,00:00:00.000,0.1\n";
    let path = folder.file("log.csv", text.as_bytes());
    let table = "[[table]]\ntime = { column = \"Date\", unit = \"date\", time_of_day = \"Time\" }\ncolumns = [\n\
        { column = \"left\", meaning = \"wheel_angle\", wheel = \"left\", unit = \"rad\" }]\n";
    let map = Document::from_text("columns.toml", format!("format = 1\n{table}")).unwrap();
    let map = grouser_files::columns::parse(&map).unwrap();
    let times: Vec<i64> = readings(&Log::find(&[path], map).unwrap())
        .iter()
        .map(|sample| sample.time_ns)
        .collect();
    assert_eq!(times[1] - times[0], 50_000_000);
}
