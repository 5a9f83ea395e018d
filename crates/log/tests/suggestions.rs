//! What is proposed for a log is a robot file that is read, whatever the names in the log are.

use std::fs::File;
use std::sync::atomic::{AtomicUsize, Ordering};

use grouser_files::{Document, Error, robot};
use grouser_log::message::{Value, build};
use grouser_log::write::McapWriter;
use grouser_log::{Log, Sheet, Survey, suggest_for_sheets, suggest_for_survey};
use proptest::prelude::*;

use crate::scratch::Folder;
use crate::written::mcap;

/// Each case has a folder of its own.
static CASE: AtomicUsize = AtomicUsize::new(0);

fn folder() -> Folder {
    Folder::new(&format!("suggest{}", CASE.fetch_add(1, Ordering::Relaxed)))
}

/// The file as it is proposed is refused; with numbers in place of the placeholders it is read.
fn read(text: &str) -> Result<robot::RobotFile, TestCaseError> {
    let proposed =
        Document::from_text("robot.toml", text.to_owned()).and_then(|d| robot::parse(&d));
    prop_assert!(
        matches!(&proposed, Err(Error::Placeholder { key, .. }) if key == "radius_m"),
        "{proposed:?}"
    );
    let text = text.replace("= \"measure\"", "= 2.0");
    let shown = text.clone();
    Document::from_text("robot.toml", text)
        .and_then(|document| robot::parse(&document))
        .map_err(|error| TestCaseError::fail(format!("{error}\n{shown}")))
}

/// Names as robots have them, and as nobody should.
fn names() -> impl Strategy<Value = Vec<String>> {
    let name = prop_oneof![
        "(front|rear|free)_(left|right)_wheel(_joint)?",
        "(wheel|joint|left|arm)",
        "\\PC{0,12}",
        "[\"\\\\\n\r\t\u{7f}a]{0,6}",
    ];
    prop::collection::vec(name, 0..20)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn for_any_joints(joints in names(), topic in "\\PC{1,20}") {
        let folder = folder();
        let path = folder.0.join("log.mcap");
        let mut writer = McapWriter::new(File::create(&path).unwrap(), "ros2").unwrap();
        let mut to = writer.topic(&topic, "sensor_msgs/JointState").unwrap();
        let given: Vec<&str> = joints.iter().map(String::as_str).collect();
        let angles = vec![0.5; given.len()];
        let message = build::joint_state(build::header(5, ""), &given, [&angles, &[], &[]]);
        writer.send(&mut to, 5, &message).unwrap();
        writer.finish().unwrap();
        let file = read(&suggest_for_survey(&Survey::read(&path, |_| ()).unwrap()))?;
        // And where there are wheels, the log is read with it.
        if joints.iter().any(|joint| !joint.is_empty()) {
            let log = Log::find_any(&[path], None, &file.topics);
            prop_assert!(log.unwrap().samples(&[]).unwrap().count() > 0);
        }
    }

    #[test]
    fn for_any_columns(mut columns in names(), file in "[^/\0]{1,12}") {
        columns.retain(|name| !name.contains(['\n', '\r', ',', '"', '\0']));
        let folder = folder();
        let mut text = ["time"].into_iter().chain(columns.iter().map(String::as_str)).collect::<Vec<_>>().join(",");
        for row in ["0", "1", "2", "3"] {
            text.push('\n');
            text.push_str(&[row].repeat(1 + columns.len()).join(","));
        }
        let path = folder.file("log.csv", text.as_bytes());
        if let Ok(sheet) = Sheet::read(&path, |_| ()) {
            read(&suggest_for_sheets([(&sheet, file.as_str())]))?;
        }
    }

    #[test]
    fn any_bytes_are_a_table_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let folder = folder();
        for start in [&b""[..], b"time,left_ticks,yaw_rate\n0,1,2\n"] {
            let path = folder.file("log.csv", &[start, &bytes].concat());
            if let Ok(sheet) = Sheet::read(&path, |_| ()) {
                read(&suggest_for_sheets([(&sheet, "log.csv")]))?;
            }
        }
    }
}

/// What is proposed for messages (topic, type, fields).
fn for_messages(messages: &[(&str, &str, Value)]) -> String {
    let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
    for (name, type_name, value) in messages {
        let mut topic = writer.topic(name, type_name).unwrap();
        writer.send(&mut topic, 5, value).unwrap();
    }
    let folder = folder();
    let path = folder.file("log.mcap", &writer.finish().unwrap());
    let text = suggest_for_survey(&Survey::read(&path, |_| ()).unwrap());
    read(&text).unwrap();
    text
}

fn for_joints(joints: &[&str]) -> String {
    let header = build::header(5, "");
    let angles = vec![0.5; joints.len()];
    let value = build::joint_state(header, joints, [&angles, &[], &[]]);
    for_messages(&[("/joint_states", "sensor_msgs/JointState", value)])
}

/// What is proposed for a table.
fn for_table(name: &str, text: &str) -> String {
    let folder = folder();
    let path = folder.file("log.csv", text.as_bytes());
    let sheet = Sheet::read(&path, |_| ()).unwrap();
    let text = suggest_for_sheets([(&sheet, name)]);
    read(&text).unwrap();
    text
}

/// The values of a key in the order in which they stand.
fn values<'a>(text: &'a str, key: &str) -> Vec<&'a str> {
    let start = format!("{key} = ");
    let entries = text.lines().filter_map(|line| line.strip_prefix(&start));
    entries
        .map(|rest| rest.split('#').next().unwrap().trim())
        .collect()
}

const HEAD: &str = "# Proposed by `grouser log info --suggest-robot`: replace \"measure\" by numbers and check the others.\n\
    format = 1\nname = \"robot\"\n";
const REFERENCE: &str = "\n[estimator]\n# reference = \"speed\"  # or pose, displacement, free-wheel: nothing that surely measures the \
    ground was found, so only the wheels' differences of slip are observable\n";

/// The lines of a wheel; `joint` and `counter` are further ones.
fn wheel([name, joint, x, y, drive, counter]: [&str; 6]) -> String {
    format!(
        "\n[[wheel]]\nname = \"{name}\"\n{joint}x_m = {x:<16} # forwards of the robot's origin: measure\n\
         y_m = {y:<16} # to the left of it: measure\nradius_m = \"measure\"   # on which it rolls\ndrive = \"{drive}\"\n{counter}"
    )
}

#[test]
fn the_whole_file_for_topics() {
    let header = || build::header(5, "");
    let twist = build::twist([0.0; 3], [0.0; 3]);
    let covariance = || build::numbers(&[0.0; 36]);
    let pose = build::message([
        ("pose", build::pose(0.0, 0.0, 0.0)),
        ("covariance", covariance()),
    ]);
    let motion = build::message([("twist", twist.clone()), ("covariance", covariance())]);
    let odometry = build::message([
        ("header", header()),
        ("child_frame_id", Value::Text("base".into())),
        ("pose", pose),
        ("twist", motion),
    ]);
    let placed = build::message([("header", header()), ("pose", build::pose(0.0, 0.0, 0.0))]);
    let names = ["left_wheel_joint", "right_wheel_joint"];
    let all = [
        ("/odom", "nav_msgs/Odometry", odometry),
        ("/pose", "geometry_msgs/PoseStamped", placed),
        (
            "/wheel_ticks",
            "grouser_msgs/WheelTicks",
            build::wheel_ticks(header(), &names, &[1, 2]),
        ),
        (
            "/imu",
            "sensor_msgs/Imu",
            build::planar_imu(header(), Some(0.1), None),
        ),
        ("/cmd_vel", "geometry_msgs/Twist", twist),
    ];
    let suspect = |name: &str| {
        format!(
            "# pose = \"{name}\"  # if it measures the ground (camera, GNSS, lidar); not if it was made of the wheels\n"
        )
    };
    let counter = "ticks_per_turn = \"measure\" # of the wheel: look it up\n\
                   counter_bits = 64      # look it up, or wheels whose counter wraps jump\n";
    let expected = [
        HEAD,
        REFERENCE,
        "\n[topics]\nwheels = \"/wheel_ticks\"\nyaw_rate = \"/imu\"\ncommand = \"/cmd_vel\"\n",
        &suspect("/odom"),
        &suspect("/pose"),
        &wheel([
            "left",
            "joint = \"left_wheel_joint\"\n",
            "0.0",
            "0.2",
            "powered",
            counter,
        ]),
        &wheel([
            "right",
            "joint = \"right_wheel_joint\"\n",
            "0.0",
            "-0.2",
            "powered",
            counter,
        ]),
    ];
    assert_eq!(for_messages(&all), expected.concat());
    // without joints the odometry stands for the wheels
    let expected = [
        HEAD,
        REFERENCE,
        "\n[topics]\nwheel_odometry = \"/odom\"\nwheel_odometry_track_m = 0.4  # the distance of left and right wheels in \
         the driver that made it: look it up\n",
        &suspect("/pose"),
        &wheel(["left", "", "0.0", "0.2", "powered", ""]),
        &wheel(["right", "", "0.0", "-0.2", "powered", ""]),
    ];
    assert_eq!(for_messages(&all[..2]), expected.concat());
}

#[test]
fn numbers_of_wheels_are_fields() {
    let proposed = |topics: &[(&str, &str)]| {
        let mut file = mcap::MAGIC.to_vec();
        for (id, (topic, type_name)) in (1..).zip(topics) {
            mcap::schema(&mut file, id, type_name.as_bytes(), b"");
            mcap::channel(&mut file, id, id, topic.as_bytes(), b"json");
            for time in 1..4 {
                mcap::message(&mut file, id, time, b"{\"data\":7}");
            }
        }
        let folder = folder();
        let path = folder.file("log.mcap", &file);
        let text = suggest_for_survey(&Survey::read(&path, |_| ()).unwrap());
        (read(&text).unwrap(), text)
    };
    let field = |topic: &str, meaning: &str, wheel: &str, unit: &str| {
        format!(
            "\n[[topics.field]]\ntopic = \"{topic}\"\nfield = \"data\"\nmeaning = \"{meaning}\"\nwheel = \"{wheel}\"\n\
             unit = \"{unit}\"\n"
        )
    };
    let (file, text) = proposed(&[
        ("/lwheel", "std_msgs/Int16"),
        ("/rwheel", "std_msgs/msg/Int16"),
        ("/battery", "std_msgs/Float32"),
        ("/left_wheel/all", "std_msgs/Int16MultiArray"),
    ]);
    let both = [
        field("/lwheel", "wheel_count", "l", "tick"),
        field("/rwheel", "wheel_count", "r", "tick"),
    ];
    assert!(both.iter().all(|one| text.contains(one)), "{text}");
    assert_eq!(file.topics.fields.len(), 2);
    assert!(
        text.contains("counter_bits = 16      # by the type of its topic"),
        "{text}"
    );
    let names = |text: &str| values(text, "name").join(" ");
    assert_eq!(names(&text), "\"robot\" \"l\" \"r\"");
    // one of each wheel
    let (file, text) = proposed(&[
        ("/left_ticks", "std_msgs/Int32"),
        ("/left_rpm", "std_msgs/Float32"),
        ("/yaw_rate", "std_msgs/Float64"),
    ]);
    assert_eq!(file.topics.fields.len(), 1);
    assert_eq!(names(&text), "\"robot\" \"left\"");
    let (_, text) = proposed(&[
        ("/left/rpm", "std_msgs/Float64"),
        ("/right/rpm", "std_msgs/Float64"),
    ]);
    assert!(
        text.contains(&field("/left/rpm", "wheel_rate", "left", "rpm")),
        "{text}"
    );
    // what is no number, and what the robot's computer sends, are no sensors
    let (_, text) = proposed(&[("/left_wheel_rpm", "std_msgs/String")]);
    assert!(!text.contains("[[topics.field]]"), "{text}");
    let (_, text) = proposed(&[("/left_wheel/cmd_vel", "std_msgs/Float64")]);
    assert!(!text.contains("[[topics.field]]"), "{text}");
    // a speed is a comment, which is a field without its marks
    let (file, text) = proposed(&[("/ground_speed", "std_msgs/Float32")]);
    assert_eq!(file.topics.fields.len(), 0);
    let field = "# [[topics.field]]  # if it is the speed over ground, in m/s; not if it was made of the wheels\n\
                 # topic = \"/ground_speed\"\n# field = \"data\"\n# meaning = \"speed_forward\"\n# unit = \"m/s\"\n";
    assert!(text.contains(field), "{text}");
    let file =
        read(&text.replace(field, &field.replace("\n# ", "\n").replacen("# ", "", 1))).unwrap();
    assert_eq!(file.topics.fields[0].topic, "/ground_speed");
}

#[test]
fn the_whole_file_for_a_table() {
    let text = "a title\nt;front_left_ticks;caster_wheel_angle_deg;yaw_rate\n0,0;65530;0,5;0,1\n0,1;2;0,6;0,1\n";
    let counter = "ticks_per_turn = \"measure\" # of the wheel: look it up\n\
                   counter_bits = 16      # the counters wrap in this log\n";
    let expected = [
        HEAD,
        &wheel(["front_left", "", "0.2", "0.2", "powered", counter]),
        &wheel(["caster", "", "-0.2", "0.0", "free", counter]),
        "\n[[table]]\nfile = \"run*.csv\"\nseparator = \";\"\ndecimal = \",\"\nheader_lines = 2\nnames_line = 2\n\
         time = { column = \"t\", unit = \"s\" }\ncolumns = [\n",
        "    { column = \"front_left_ticks\", meaning = \"wheel_count\", wheel = \"front_left\", unit = \"tick\" },\n",
        "    { column = \"caster_wheel_angle_deg\", meaning = \"wheel_angle\", wheel = \"caster\", unit = \"deg\" },\n",
        "    { column = \"yaw_rate\", meaning = \"yaw_rate\", unit = \"rad/s\" },\n]\n",
    ];
    assert_eq!(for_table("run*.csv", text), expected.concat());
    // defaults are left out; a counter that does not wrap is stated
    let text = for_table("a", "t\tleft_ticks\n0\t1\n1\t2\n");
    assert_eq!(values(&text, "separator"), ["\"tab\""]);
    assert_eq!(values(&text, "counter_bits"), ["64"]);
    assert!(!text.contains("decimal") && !text.contains("header_lines"));
    let text = for_table("a", "t,left_angle\n0,1\n1,2\n");
    assert!(!text.contains("separator") && !text.contains("counter_bits"));
    assert!(text.contains(REFERENCE));
    // a pose measures the ground
    let text = for_table(
        "a",
        "t,left_angle,odom_x,odom_y,odom_yaw\n0,1,2,3,4\n1,2,3,4,5\n",
    );
    assert!(!text.contains("reference"));
    // names on the first of two lines
    let text = for_table("a", "t,left_angle,right_angle\ns,rad,rad\n0,1,2\n1,2,3\n");
    assert_eq!(
        [values(&text, "header_lines"), values(&text, "names_line")],
        [["2"], ["1"]]
    );
    // nothing was recognised
    let text = for_table("a", "who,what\nx,1\ny,2\n");
    let pattern = "\n# [[table]]\n# file = \"a\"\n# time = { column = \"time\", unit = \"s\" }  # not found: name it\n\
                   # columns = [\n# ]\n";
    assert!(text.ends_with(pattern), "{text}");
}

#[test]
fn units_in_names_and_columns_of_topics() {
    let text = for_table(
        "a",
        "t,fl_current_A,left_torque [Nm],x_mm,y_mm,yaw_deg,steering_angle_deg\n0,1,2,3,4,90,6\n1,1,2,3,4,180,6\n",
    );
    for line in [
        "{ column = \"fl_current_A\", meaning = \"motor_current\", wheel = \"fl\", unit = \"A\" },",
        "{ column = \"left_torque [Nm]\", meaning = \"wheel_torque\", wheel = \"left\", unit = \"N m\" },",
        "{ column = \"x_mm\", meaning = \"pose_x\", unit = \"mm\" },",
        "{ column = \"y_mm\", meaning = \"pose_y\", unit = \"mm\" },",
        "{ column = \"yaw_deg\", meaning = \"pose_yaw\", unit = \"deg\" },",
        "{ column = \"steering_angle_deg\", meaning = \"steering_angle\", unit = \"deg\" },",
    ] {
        assert!(text.contains(&format!("\n    {line}\n")), "{line}: {text}");
    }
    // beside places in another spelling; a speed that is negative has a sign
    let text = for_table(
        "a",
        "t,pos_x_mm,pos_y_mm,yaw_deg,gps_speed_kmh\n0,1,2,90,3\n1,1,2,180,-3\n",
    );
    for line in [
        "{ column = \"yaw_deg\", meaning = \"pose_yaw\", unit = \"deg\" },",
        "{ column = \"gps_speed_kmh\", meaning = \"speed_forward\", unit = \"km/h\" },",
    ] {
        assert!(text.contains(&format!("\n    {line}\n")), "{line}: {text}");
    }
    // an odometry of unknown origin is no reference, one that measures the ground is
    let of = |topic: &str| {
        let names = ["x", "y"].map(|axis| format!("/{topic}/pose/position/{axis}"));
        for_table(
            "a",
            &format!("t,left_angle,{}\n0,1,2,3\n1,1,2,3\n", names.join(",")),
        )
    };
    let text = of("odometry");
    let line = "\n    # { column = \"/odometry/pose/position/x\", meaning = \"pose_x\", unit = \"m\" },  # if it measures \
                the ground (camera, GNSS, lidar); not if it was made of the wheels\n";
    assert!(text.contains(line) && text.contains(REFERENCE), "{text}");
    assert!(of("vio").contains(
        "\n    { column = \"/vio/pose/position/x\", meaning = \"pose_x\", unit = \"m\" },\n"
    ));
}

#[test]
fn several_tables_are_one_robot() {
    let folder = folder();
    let sheet =
        |name: &str, text: &str| Sheet::read(&folder.file(name, text.as_bytes()), |_| ()).unwrap();
    let first = sheet("a", "t,left_ticks,right_ticks\n0,250,0\n1,3,1\n");
    let second = sheet("b", "t,left_angle,dx,dy\n0,1,2,3\n1,1,2,3\n");
    let text = suggest_for_sheets([(&first, "a"), (&second, "b")]);
    assert_eq!(
        values(&text, "name"),
        ["\"robot\"", "\"left\"", "\"right\""]
    );
    assert_eq!(values(&text, "file"), ["\"a\"", "\"b\""]);
    assert_eq!(values(&text, "counter_bits"), ["8", "8"]);
    let third = sheet("c", "t,back_left_ticks\n0,5\n1,6\n");
    let counters = suggest_for_sheets([(&first, "a"), (&third, "c")]);
    assert_eq!(values(&counters, "counter_bits"), ["8", "8", "8"]);
    assert!(!text.contains("reference") && text.contains("]\n\n[[table]]\nfile = \"b\""));
}

#[test]
fn wheels_are_placed_by_their_names() {
    let placed = |joints: &[&str]| {
        let text = for_joints(joints);
        let [x, y] = ["x_m", "y_m"].map(|key| values(&text, key).join(" "));
        (values(&text, "name")[1..].join(" "), x, y)
    };
    let of = |names: &str, x: &str, y: &str| (names.to_owned(), x.to_owned(), y.to_owned());
    for (joints, expected) in [
        (
            &[
                "front_left_wheel",
                "front_right_wheel",
                "rear_left_wheel",
                "rear_right_wheel",
            ][..],
            of(
                "\"front_left\" \"front_right\" \"rear_left\" \"rear_right\"",
                "0.2 0.2 -0.2 -0.2",
                "0.2 -0.2 0.2 -0.2",
            ),
        ),
        (
            &["bl", "br", "fl", "fr"],
            of(
                "\"bl\" \"br\" \"fl\" \"fr\"",
                "-0.2 -0.2 0.2 0.2",
                "0.2 -0.2 0.2 -0.2",
            ),
        ),
        (
            &["a", "b", "caster"],
            of("\"a\" \"b\" \"caster\"", "0.0 0.0 -0.2", "0.2 -0.2 0.0"),
        ),
        (
            &["middle_l", "middle_r"],
            of("\"middle_l\" \"middle_r\"", "0.0 0.0", "0.2 -0.2"),
        ),
        // those that say so are wheels; each once, in order
        (
            &["left_wheel", "arm", "", "left_wheel"],
            of("\"left\"", "0.0", "0.2"),
        ),
        (&["wheel_joint"], of("\"wheel_joint\"", "0.0", "0.2")),
        // two of one short name
        (
            &["b_joint", "b_link"],
            of("\"b_joint\" \"b_link\"", "0.0 0.0", "0.2 -0.2"),
        ),
    ] {
        assert_eq!(placed(joints), expected);
    }
    let many: Vec<String> = (10..30).map(|number| format!("m{number}")).collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    assert_eq!(values(&for_joints(&many), "x_m").len(), 16);
    // a joint of the wheel's name is not repeated
    assert!(!for_joints(&["left"]).contains("joint ="));
    assert!(!for_joints(&["left", "free"]).contains("reference"));
    assert_eq!(
        values(&for_joints(&["left", "free"]), "drive"),
        ["\"free\"", "\"powered\""]
    );
}

#[test]
fn names_that_leave_it_open_are_asked_about() {
    let rows = |header: &str, rows: &[&str]| format!("{header}\n{}\n", rows.join("\n"));
    // places of wheels: counters where their numbers are whole
    let whole = for_table(
        "log.csv",
        &rows(
            "t_ms,wheel_FL,wheel_FR",
            &["0,10,10", "20,11,12", "40,12,14"],
        ),
    );
    for line in [
        "time = { column = \"t_ms\", unit = \"ms\" }",
        "    { column = \"wheel_FL\", meaning = \"wheel_count\", wheel = \"fl\", unit = \"tick\" },",
    ] {
        assert!(whole.lines().any(|own| own == line), "{line}\n{whole}");
    }
    assert_eq!(values(&whole, "name"), ["\"robot\"", "\"fl\"", "\"fr\""]);
    let open = for_table(
        "log.csv",
        &rows(
            "datetime,wheel_FL,wheel_FR,x,y,theta,gyro",
            &[
                "2026-03-02T09:15:30.25Z,0.5,0.5,0.1,0.2,0.3,0.01",
                "2026-03-02T09:15:30.27Z,0.6,0.7,0.1,0.2,0.3,0.02",
                "2026-03-02T09:15:30.29Z,0.6,0.7,0.1,0.2,0.3,0.02",
            ],
        ),
    );
    for line in [
        "time = { column = \"datetime\", unit = \"date\" }",
        "    # { column = \"wheel_FL\", meaning = \"\", wheel = \"fl\", unit = \"\" },  # `wheel_angle`, `wheel_rate` or \
         `wheel_speed`? its name does not say",
        "    { column = \"x\", meaning = \"pose_x\", unit = \"m\" },",
        "    { column = \"y\", meaning = \"pose_y\", unit = \"m\" },",
        "    { column = \"theta\", meaning = \"pose_yaw\", unit = \"rad\" },",
        "    { column = \"gyro\", meaning = \"yaw_rate\", unit = \"rad/s\" },",
    ] {
        assert!(open.lines().any(|own| own == line), "{line}\n{open}");
    }
    assert_eq!(values(&open, "name"), ["\"robot\"", "\"fl\"", "\"fr\""]);
    // speeds of a rim are as large as rates; larger numbers are rates, and a unit decides
    let question = "`wheel_rate` in rad/s or `wheel_speed` in m/s? its numbers may be either";
    for (header, number, meaning) in [
        ("left_vel", "3.0", None),
        (
            "left_vel",
            "3.1",
            Some("\"wheel_rate\", wheel = \"left\", unit = \"rad/s\""),
        ),
        (
            "left_vel",
            "-3.1",
            Some("\"wheel_rate\", wheel = \"left\", unit = \"rad/s\""),
        ),
        (
            "left_vel_rad_s",
            "0.5",
            Some("\"wheel_rate\", wheel = \"left\", unit = \"rad/s\""),
        ),
        (
            "left_vel_mps",
            "0.5",
            Some("\"wheel_speed\", wheel = \"left\", unit = \"m/s\""),
        ),
        (
            "left_omega",
            "0.5",
            Some("\"wheel_rate\", wheel = \"left\", unit = \"rad/s\""),
        ),
    ] {
        let table = rows(
            &format!("t,yaw_rate,{header}"),
            &["0,0.1,0.1", &format!("1,0.1,{number}")],
        );
        let text = for_table("log.csv", &table);
        let expected = match meaning {
            Some(meaning) => format!("    {{ column = \"{header}\", meaning = {meaning} }},"),
            None => format!(
                "    # {{ column = \"{header}\", meaning = \"\", wheel = \"left\", unit = \"\" }},  # {question}"
            ),
        };
        assert!(
            text.lines().any(|own| own == expected),
            "{expected}\n{text}"
        );
        assert!(text.contains("name = \"left\""));
    }
    // a heading of more than a turn may be in degrees
    let table = rows("t,x,y,theta", &["0,0.1,0.2,6.5", "1,0.1,0.2,6.5"]);
    assert!(!for_table("log.csv", &table).contains("pose_x"));
}

/// Columns as loggers of robots name them: what is known is a line, what is probable a comment with its condition.
#[test]
fn ways_poses_and_rates_as_they_are_logged() {
    let ground =
        "# if it measures the ground (camera, GNSS, lidar); not if it was made of the wheels";
    let way = "# if it is the distance driven by the wheels since some start: `wheel` names one";
    let yaw = "# if it is the heading of the pose and counts to the left; `scale = -1.0` if it counts to the right";
    let too_fast = "# its numbers are more than a robot turns in rad/s";
    let rim = "# `wheel_distance`, if it is the distance driven by a wheel since some start, and its unit?";
    for (header, numbers, line) in [
        (
            "WENC.Dist0",
            [0.1, 0.2],
            "{ column = \"WENC.Dist0\", meaning = \"wheel_distance\", wheel = \"wheel_0\", unit = \"m\" },",
        ),
        (
            "odo_left_m",
            [0.1, 0.2],
            "{ column = \"odo_left_m\", meaning = \"wheel_distance\", wheel = \"left\", unit = \"m\" },",
        ),
        (
            "left_distance_mm",
            [100.0, 200.0],
            &format!(
                "# {{ column = \"left_distance_mm\", meaning = \"\", wheel = \"left\", unit = \"\" }},  {rim}"
            ),
        ),
        (
            "distance_m",
            [0.1, 0.2],
            &format!(
                "# {{ column = \"distance_m\", meaning = \"wheel_distance\", wheel = \"wheels\", unit = \"m\" }},  {way}"
            ),
        ),
        (
            "RPM_FL",
            [0.0, 20.0],
            "{ column = \"RPM_FL\", meaning = \"wheel_rate\", wheel = \"fl\", unit = \"rpm\" },",
        ),
        (
            "TY_mm,RZ_deg,TX_mm",
            [0.0, 20.0],
            "{ column = \"TX_mm\", meaning = \"pose_x\", unit = \"mm\" },",
        ),
        (
            "TX_mm,TY_mm,RZ_deg",
            [0.0, 20.0],
            "{ column = \"RZ_deg\", meaning = \"pose_yaw\", unit = \"deg\" },",
        ),
        (
            "posX,posY,heading",
            [0.0, 20.0],
            &format!(
                "# {{ column = \"heading\", meaning = \"pose_yaw\", unit = \"deg\" }},  {yaw}"
            ),
        ),
        (
            "posX,posY,heading",
            [0.0, 2.0],
            &format!(
                "# {{ column = \"heading\", meaning = \"pose_yaw\", unit = \"rad\" }},  {yaw}"
            ),
        ),
        (
            "vel_m_s",
            [0.0, 2.0],
            &format!(
                "# {{ column = \"vel_m_s\", meaning = \"speed_size\", unit = \"m/s\" }},  {ground}"
            ),
        ),
        (
            "vel_m_s",
            [-0.1, 2.0],
            &format!(
                "# {{ column = \"vel_m_s\", meaning = \"speed_forward\", unit = \"m/s\" }},  {ground}"
            ),
        ),
        (
            "gyroZ",
            [-17.0, 17.0],
            &format!(
                "{{ column = \"gyroZ\", meaning = \"yaw_rate\", unit = \"deg/s\" }},  {too_fast}"
            ),
        ),
        (
            "gyroZ",
            [-6.0, 6.0],
            "{ column = \"gyroZ\", meaning = \"yaw_rate\", unit = \"rad/s\" },",
        ),
    ] {
        let columns = 1 + header.matches(',').count();
        let row = |time: usize, number: f64| {
            format!("{time},{}", vec![number.to_string(); columns].join(","))
        };
        let table = [row(0, numbers[0]), row(1, numbers[1]), row(2, numbers[0])].join("\n");
        let text = for_table("log.csv", &format!("time,{header}\n{table}\n"));
        assert!(
            text.lines()
                .any(|own| own.strip_prefix("# ").unwrap_or(own).trim_start() == line),
            "{line}\n{text}"
        );
    }
}

/// One wrong reading of 200 is no unit; a heading without a place is none of a pose.
#[test]
fn units_and_headings_are_not_guessed_from_little() {
    let rates = (0..200).map(|row| format!("{row},{}\n", if row == 7 { 50.0 } else { 0.5 }));
    let text = for_table(
        "log.csv",
        &format!("time,gyroZ\n{}", rates.collect::<String>()),
    );
    assert!(
        text.contains("meaning = \"yaw_rate\", unit = \"rad/s\" },\n"),
        "{text}"
    );
    let text = for_table("log.csv", "time,heading,left_ticks\n0,1,2\n1,2,3\n");
    assert!(!text.contains("heading"), "{text}");
}
