//! A log of a robot with five joints, an IMU and a camera, written by the mcap crate.

use std::collections::BTreeMap;
use std::io::BufWriter;
use std::path::Path;

use grouser_log::container::{Channel, Encoding};

const JOINT_STATE: &str = "std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
";

/// Numbers of a run that nobody can compress to nothing.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// CDR: each number at a multiple of its size behind the head of four bytes.
struct Cdr(Vec<u8>);

impl Cdr {
    fn new() -> Self {
        Self(vec![0, 1, 0, 0])
    }

    fn align(&mut self, to: usize) {
        while !(self.0.len() - 4).is_multiple_of(to) {
            self.0.push(0);
        }
    }

    fn u32(&mut self, value: u32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    fn f64(&mut self, value: f64) {
        self.align(8);
        self.0.extend(value.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.u32(u32::try_from(text.len() + 1).expect("short"));
        self.0.extend(text.bytes());
        self.0.push(0);
    }
}

fn joints(k: u32, noise: &mut Noise) -> Vec<u8> {
    let mut cdr = Cdr::new();
    cdr.u32(1_700_000_000 + k / 100);
    cdr.u32(k % 100 * 10_000_000);
    cdr.text("base_link");
    cdr.u32(5);
    for joint in ["front_left", "front_right", "rear_left", "rear_right", "fifth"] {
        cdr.text(&format!("{joint}_wheel_joint"));
    }
    for scale in [1.0, 0.1, 3.0] {
        cdr.u32(5);
        for joint in 0..5 {
            // As a 12-bit encoder gives it.
            let angle = f64::from(k) * 0.01 * f64::from(joint + 1) + 0.01 * noise.next();
            cdr.f64(scale * (angle * 651.9).round() / 651.9);
        }
    }
    cdr.0
}

/// One message of five joints, with its channel.
pub fn joint_state() -> (Channel, Vec<u8>) {
    let channel = Channel {
        topic: "/joint_states".into(),
        type_name: "sensor_msgs/msg/JointState".into(),
        encoding: Encoding::Cdr,
        encoding_name: "cdr".into(),
        definition_language: "ros2msg".into(),
        definition: JOINT_STATE.as_bytes().into(),
        metadata: Default::default(),
    };
    (channel, joints(7, &mut Noise(1)))
}

/// Bytes as a chunk has them.
pub fn content(bytes: usize) -> Vec<u8> {
    let mut noise = Noise(1);
    let mut out = Vec::new();
    for k in 0.. {
        let data = joints(k, &mut noise);
        out.push(5);
        out.extend((data.len() as u64 + 22).to_le_bytes());
        out.extend([1, 0]);
        out.extend(k.to_le_bytes());
        out.extend([u64::from(k) * 10_000_000; 2].map(u64::to_le_bytes).concat());
        out.extend(data);
        if out.len() >= bytes {
            break;
        }
    }
    out.truncate(bytes);
    out
}

/// Writes so many MiB of messages: joints at 100 Hz, an IMU's 37 numbers at 200 Hz, an image of 60 KB at 5 Hz.
pub fn write(path: &Path, mib: u64) {
    let file = BufWriter::new(std::fs::File::create(path).expect("a file"));
    let options = mcap::WriteOptions::new()
        .compression(Some(mcap::Compression::Zstd))
        .chunk_size(Some(768 << 10))
        .profile("ros2");
    let mut writer = options.create(file).expect("a writer");
    let mut channel = |topic: &str, name: &str, text: &str| {
        let schema = writer.add_schema(name, "ros2msg", text.as_bytes()).expect("a schema");
        writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).expect("a channel")
    };
    let joint = channel("/joint_states", "sensor_msgs/msg/JointState", JOINT_STATE);
    let imu = channel("/imu", "a/msg/Imu", "float64[37] numbers\n");
    let image = channel("/camera", "a/msg/Image", "uint8[] data\n");
    let (mut noise, mut written) = (Noise(1), 0);
    for k in 0_u32.. {
        let time = 1_700_000_000_000_000_000 + 10_000_000 * u64::from(k);
        let mut put = |channel_id, data: &[u8]| {
            let header = mcap::records::MessageHeader {
                channel_id,
                sequence: k,
                log_time: time,
                publish_time: time,
            };
            writer.write_to_known_channel(&header, data).expect("written");
            written += data.len() as u64;
        };
        put(joint, &joints(k, &mut noise));
        for _ in 0..2 {
            let mut cdr = Cdr::new();
            for _ in 0..10 {
                cdr.f64((noise.next() * 4096.0).round() / 4096.0);
            }
            for _ in 0..27 {
                cdr.f64(0.0);
            }
            put(imu, &cdr.0);
        }
        if k % 20 == 0 {
            let mut cdr = Cdr::new();
            cdr.u32(60_000);
            let mut shade = 0.0;
            for _ in 0..60_000 {
                shade += 4.0 * (noise.next() - 0.5);
                cdr.0.push((128.0 + shade) as u8);
            }
            put(image, &cdr.0);
        }
        if written >= mib << 20 {
            break;
        }
    }
    writer.finish().expect("finished");
}
