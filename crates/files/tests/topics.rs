//! The section `[topics]` of robot files: what it says, and what is reported of mistakes.

use grouser_files::columns::Meaning;
use grouser_files::robot::{self, Revision, RobotFile};
use grouser_files::{Document, Error};

const WHEELS: &str = "[[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n\
     joint = \"l_wheel\"\n[[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nradius_m = 0.05\n\
     drive = \"powered\"\nreversed = true\n";

fn read(topics: &str) -> Result<RobotFile, Error> {
    let text = format!("format = 1\nname = \"cart\"\n{topics}\n{WHEELS}");
    robot::parse(&Document::from_text("robot.toml", text)?)
}

/// The message and the hint.
fn mistake(topics: &str) -> (String, Option<String>) {
    let error = read(topics).unwrap_err();
    (error.to_string(), error.hint())
}

#[test]
fn a_robot_file_without_topics_names_none() {
    let topics = read("").unwrap().topics;
    assert_eq!(topics.named().count(), 0);
    assert_eq!(topics.joints[0].joint.as_deref(), Some("l_wheel"));
    assert_eq!(topics.joints[1].joint, None);
}

#[test]
fn fields_are_read_with_their_units() {
    let field = "[[topics.field]]\ntopic = \"/mcu\"\nfield = \"rpm[0]\"\nmeaning = \"wheel_rate\"\nwheel = \"left\"\n\
                 unit = \"rpm\"\n[[topics.field]]\ntopic = \"/mcu\"\nfield = \"yaw\"\nmeaning = \"yaw_rate\"\n\
                 unit = \"deg/s\"\nscale = -1.0\n";
    let topics = read(field).unwrap().topics;
    assert_eq!(topics.fields.len(), 1);
    let [rate, yaw] = topics.fields[0].fields.as_slice() else {
        panic!("two fields")
    };
    assert_eq!(
        (rate.column.as_str(), rate.meaning),
        ("rpm[0]", Meaning::WheelRate)
    );
    // 1 rpm = 2π/60 rad/s; 1 deg/s = π/180 rad/s.
    assert!((rate.factor - 0.104_719_755_119_659_77).abs() < 1e-17);
    assert!((yaw.factor + 0.017_453_292_519_943_295).abs() < 1e-18);
}

#[test]
fn an_odometry_of_the_wheels_says_their_rates() {
    let topics = "[topics]\nwheel_odometry = \"/odom\"\nwheel_odometry_track_m = 0.5\n";
    let odometry = read(topics).unwrap().topics.wheel_odometry.unwrap();
    let [left, right] = odometry.wheels.as_slice() else {
        panic!("two wheels")
    };
    // The left rim runs v − Ω · 0.25; the right one, radius 0.05 and reversed, −(v + Ω · 0.25)/0.05.
    assert_eq!((left.per_speed, left.per_turn), (10.0, -2.5));
    assert_eq!((right.per_speed, right.per_turn), (-20.0, -5.0));
}

#[test]
fn mistakes_are_reported_with_their_place_and_what_was_meant() {
    let (message, hint) = mistake("[topics]\nyaw_rat = \"/imu\"\n");
    assert_eq!(
        message,
        "robot.toml:4:1: [topics] has no such key as `yaw_rat`"
    );
    assert_eq!(hint.unwrap(), "did you mean `yaw_rate`?");
    let (message, hint) = mistake("[topics]\nimu_up = \"+y\"\n");
    assert!(
        message.contains("`imu_up` is \"+y\", but must be one of \"x\", \"y\", \"z\""),
        "{message}"
    );
    assert!(hint.is_none_or(|hint| hint.contains('y')));
    let (message, _) = mistake("[topics]\nwheel_odometry = \"/odom\"\n");
    assert!(message.contains("`wheel_odometry` and `wheel_odometry_track_m` belong together"));
    let (message, _) = mistake("[topics]\npose = \"/odom\"\nignore = [\"/odom\"]\n");
    assert!(
        message.contains("`/odom` is named for a use and under `ignore`"),
        "{message}"
    );
    let (message, _) = mistake("[topics]\ntime = \"now\"\n");
    assert!(
        message.contains("must be one of \"header\", \"log\""),
        "{message}"
    );
    let field = "[[topics.field]]\ntopic = \"/t\"\nfield = \"n\"\nmeaning = \"wheel_count\"\nunit = \"tick\"\n";
    assert!(mistake(field).0.contains("`wheel_count` needs a `wheel`"));
    let field =
        "[[topics.field]]\ntopic = \"/t\"\nfield = \"x\"\nmeaning = \"pose_x\"\nunit = \"m\"\n";
    assert!(mistake(field).0.contains("`pose_x` needs `pose_y` too"));
}

#[test]
fn a_pose_by_transforms_has_frames() {
    let topics =
        "[topics]\npose = \"/tf\"\npose_frame = \"map\"\npose_child_frame = \"r1/base_link\"\n";
    let file = read(topics).unwrap();
    assert_eq!(file.topics.pose_frame.as_deref(), Some("map"));
    assert_eq!(
        file.topics.pose_child_frame.as_deref(),
        Some("r1/base_link")
    );
    let again = Document::from_text("again.toml", robot::to_toml(&file)).unwrap();
    assert_eq!(robot::parse(&again).unwrap(), file);
    let (message, _) = mistake("[topics]\npose_child_frame = \"base\"\n");
    assert!(
        message.contains("robot.toml:4")
            && message.contains("`pose_child_frame` belongs to a topic"),
        "{message}"
    );
}

#[test]
fn a_column_map_may_stand_in_the_robot_file() {
    let table = "[[table]]\ntime = { column = \"t\", unit = \"s\" }\n\
                 columns = [{ column = \"g\", meaning = \"yaw_rate\", unit = \"rad/s\" }]\n";
    let file = read(table).unwrap();
    assert_eq!(file.columns.unwrap().tables[0].time.column, "t");
    assert_eq!(read("").unwrap().columns, None);
    let text = format!("format = 1\nname = \"cart\"\n{table}\n[topics]\nwheels = \"/j\"\n{WHEELS}");
    let document = Document::from_text("robot.toml", text).unwrap();
    // Other radii, and the rest as it was.
    let half = Revision {
        radius: Some(0.5),
        ..Revision::default()
    };
    let scaled = robot::revised(&document, &half).unwrap();
    assert!(
        scaled.contains("radius_m = 0.050000") && scaled.contains("wheels = \"/j\""),
        "{scaled}"
    );
}
