//! A `sensor_msgs/JointState` of five wheels out of its bytes, by its definition.

use std::hint::black_box;
use std::time::Instant;

use grouser_log::container::{Channel, Encoding};
use grouser_log::message::{Decoder, Definition, Value, known};

use crate::sample::joint_state;

const MESSAGES: usize = 1000;
const ROUNDS: usize = 201;

fn median(mut round: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            round();
            start.elapsed().as_secs_f64() * 1e9 / MESSAGES as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[ROUNDS / 2]
}

pub fn run() {
    let name = "sensor_msgs/msg/JointState";
    let text = known::definition("sensor_msgs/JointState").expect("a known type");
    let definition = Definition::parse(name, &text).expect("a definition");
    let messages: Vec<(Value, Vec<u8>)> = (0..MESSAGES)
        .map(|i| {
            let value = joint_state(i as i64 * 10_000_000, || i as f64 * 0.1);
            let data = definition.encode(&value).expect("a message");
            (value, data)
        })
        .collect();
    let decoder = Decoder::new(&Channel {
        topic: "/joint_states".into(),
        type_name: name.into(),
        encoding: Encoding::Cdr,
        encoding_name: "cdr".into(),
        definition_language: "ros2msg".into(),
        definition: text.into_bytes().into(),
        metadata: Default::default(),
    })
    .expect("a decoder");
    let mut value = Value::Null;
    for (expected, data) in &messages {
        decoder.decode_into(data, &mut value).expect("decoded");
        for field in ["name", "position", "velocity", "effort"] {
            assert_eq!(value.at(field), expected.at(field));
        }
        assert_eq!(decoder.decode(data).expect("decoded"), value);
    }
    let into = median(|| {
        for (_, data) in &messages {
            decoder
                .decode_into(black_box(data), &mut value)
                .expect("decoded");
            black_box(&value);
        }
    });
    let anew = median(|| {
        for (_, data) in &messages {
            black_box(decoder.decode(black_box(data)).expect("decoded"));
        }
    });
    println!(
        "\nA JointState of five wheels, {} bytes, by its definition; medians of {ROUNDS} rounds",
        messages[0].1.len()
    );
    println!("{:28} {into:8.0} ns", "into the value before");
    println!("{:28} {anew:8.0} ns", "as a new value");
}
