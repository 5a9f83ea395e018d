//! A log as robots write them, by the writer of the `mcap` crate: wheels, IMU, odometry, scans and, where
//! it is to be large, a camera. Every number has noise in its last digits.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use grouser_log::message::{Definition, Value, build, known};
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const SCAN: &str = "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n\
    float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n\
    float32[] intensities\n";
const IMAGE: &str = "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n\
    uint32 step\nuint8[] data\n";
const RAYS: usize = 720;
const PIXELS: (usize, usize) = (640, 480);
pub const WHEELS: [&str; 5] = [
    "front_left_wheel",
    "front_right_wheel",
    "rear_left_wheel",
    "rear_right_wheel",
    "fifth_wheel",
];

struct Noise(ChaCha8Rng);

impl Noise {
    /// About zero, with this half width.
    fn within(&mut self, half: f64) -> f64 {
        half * (f64::from(self.0.next_u32()) / f64::from(u32::MAX) * 2.0 - 1.0)
    }
}

struct Topic {
    id: u16,
    definition: Definition,
    sent: u32,
}

struct Out {
    writer: Writer<BufWriter<File>>,
    bytes: u64,
}

impl Out {
    fn topic(&mut self, topic: &str, type_name: &str, own: Option<&str>) -> Topic {
        let text = match own {
            None => known::definition(type_name).expect("a known type"),
            Some(own) => {
                let rule = "=".repeat(80);
                let header = known::definition("std_msgs/Header").expect("a known type");
                format!("{own}{rule}\nMSG: std_msgs/Header\n{header}")
            }
        };
        let name = known::ros2_name(type_name);
        let schema = self.writer.add_schema(&name, "ros2msg", text.as_bytes());
        let schema = schema.expect("a schema");
        let id = self
            .writer
            .add_channel(schema, topic, "cdr", &Default::default());
        Topic {
            id: id.expect("a channel"),
            definition: Definition::parse(&name, &text).expect("a definition"),
            sent: 0,
        }
    }

    fn send(&mut self, topic: &mut Topic, time_ns: i64, value: &Value) {
        let data = topic.definition.encode(value).expect("a message");
        topic.sent += 1;
        self.bytes += data.len() as u64;
        let header = MessageHeader {
            channel_id: topic.id,
            sequence: topic.sent,
            log_time: time_ns as u64,
            publish_time: time_ns as u64,
        };
        self.writer
            .write_to_known_channel(&header, &data)
            .expect("written");
    }
}

pub fn joint_state(time_ns: i64, mut number: impl FnMut() -> f64) -> Value {
    let mut five = || build::numbers(&std::array::from_fn::<f64, 5, _>(|_| number()));
    build::message([
        ("header", build::header(time_ns, "base_link")),
        ("name", build::texts(&WHEELS)),
        ("position", five()),
        ("velocity", five()),
        ("effort", five()),
    ])
}

/// Writes at least `bytes` of messages.
pub fn write(path: &Path, bytes: u64, camera: bool) {
    let file = BufWriter::new(File::create(path).expect("a file"));
    let options = WriteOptions::new()
        .profile("ros2")
        .compression(Some(Compression::Zstd));
    let mut out = Out {
        writer: options.create(file).expect("a writer"),
        bytes: 0,
    };
    let mut joints = out.topic("/joint_states", "sensor_msgs/JointState", None);
    let mut imu = out.topic("/imu/data", "sensor_msgs/Imu", None);
    let mut odometry = out.topic("/odom", "nav_msgs/Odometry", None);
    let mut scan = out.topic("/scan", "sensor_msgs/LaserScan", Some(SCAN));
    let mut image = out.topic("/camera/image_raw", "sensor_msgs/Image", Some(IMAGE));
    let mut noise = Noise(ChaCha8Rng::seed_from_u64(5));
    let start = 1_700_000_000_000_000_000_i64;
    let mut tick = 0_i64;
    while out.bytes < bytes {
        let time = start + tick * 10_000_000;
        let t = tick as f64 * 0.01;
        out.send(
            &mut joints,
            time,
            &joint_state(time, || 3.0 * t + noise.within(0.01)),
        );
        let mut three = |half| build::vector([(); 3].map(|()| noise.within(half)));
        let diagonal = |x: f64| build::numbers(&[x, 0.0, 0.0, 0.0, x, 0.0, 0.0, 0.0, x]);
        let reading = build::message([
            ("header", build::header(time, "imu_link")),
            ("orientation", build::turn(0.1 * t.sin())),
            ("orientation_covariance", diagonal(1e-3)),
            ("angular_velocity", three(0.02)),
            ("angular_velocity_covariance", diagonal(4e-6)),
            ("linear_acceleration", three(0.3)),
            ("linear_acceleration_covariance", diagonal(1e-4)),
        ]);
        out.send(&mut imu, time, &reading);
        if tick % 2 == 0 {
            let covariance = build::numbers(&std::array::from_fn::<f64, 36, _>(|i| {
                if i % 7 == 0 { 1e-3 } else { 0.0 }
            }));
            let pose = build::message([
                ("position", three(0.001)),
                ("orientation", build::turn(0.1 * t.sin())),
            ]);
            let twist = build::message([("linear", three(0.01)), ("angular", three(0.01))]);
            let with = |name: &'static str, value: Value| {
                build::message([(name, value), ("covariance", covariance.clone())])
            };
            let message = build::message([
                ("header", build::header(time, "odom")),
                ("child_frame_id", Value::Text("base_link".into())),
                ("pose", with("pose", pose)),
                ("twist", with("twist", twist)),
            ]);
            out.send(&mut odometry, time, &message);
        }
        if tick % 10 == 0 {
            let ranges: Vec<f64> = (0..RAYS)
                .map(|ray| 3.0 + (ray as f64 * 0.02).sin() + noise.within(0.01))
                .collect();
            let number = Value::Float;
            let message = build::message([
                ("header", build::header(time, "laser")),
                ("angle_min", number(-2.35)),
                ("angle_max", number(2.35)),
                ("angle_increment", number(4.7 / RAYS as f64)),
                ("time_increment", number(0.0)),
                ("scan_time", number(0.1)),
                ("range_min", number(0.1)),
                ("range_max", number(30.0)),
                ("ranges", build::numbers(&ranges)),
                ("intensities", build::numbers(&[])),
            ]);
            out.send(&mut scan, time, &message);
        }
        if camera && tick % 4 == 0 {
            let (width, height) = PIXELS;
            let mut data = vec![0; width * height];
            noise.0.fill_bytes(&mut data);
            let message = build::message([
                ("header", build::header(time, "camera")),
                ("height", Value::UInt(height as u64)),
                ("width", Value::UInt(width as u64)),
                ("encoding", Value::Text("mono8".into())),
                ("is_bigendian", Value::UInt(0)),
                ("step", Value::UInt(width as u64)),
                ("data", Value::Bytes(data)),
            ]);
            out.send(&mut image, time, &message);
        }
        tick += 1;
    }
    out.writer.finish().expect("finished");
}
