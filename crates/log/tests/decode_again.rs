//! Decoding into the value of the message before: the same as anew, whatever stood there, and without
//! allocation where the message is like it.

use grouser_log::container::{Channel, Encoding};
use grouser_log::message::{Decoder, Definition, Value, build, known};
use proptest::prelude::*;

fn decoder(type_name: &str) -> (Decoder, Definition) {
    let text = known::definition(type_name).unwrap();
    let definition = Definition::parse(type_name, &text).unwrap();
    let channel = Channel {
        topic: "/t".into(),
        type_name: type_name.into(),
        encoding: Encoding::Cdr,
        encoding_name: "cdr".into(),
        definition_language: "ros2msg".into(),
        definition: text.into_bytes().into(),
        metadata: std::collections::BTreeMap::new(),
    };
    (Decoder::new(&channel).unwrap(), definition)
}

fn joints(names: &[String], numbers: &[f64]) -> Value {
    build::message([
        ("header", build::header(7, "base_link")),
        ("name", build::texts(names)),
        ("position", build::numbers(numbers)),
        ("velocity", build::numbers(&[])),
        (
            "effort",
            build::numbers(&numbers[..numbers.len().min(names.len())]),
        ),
    ])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn the_same_as_anew_whatever_stood_there(
        messages in prop::collection::vec(
            (prop::collection::vec(".{0,9}", 0..6), prop::collection::vec(-1e9..1e9, 0..9)), 1..9,
        ),
        cut in any::<prop::sample::Index>(),
    ) {
        let (decoder, definition) = decoder("sensor_msgs/JointState");
        let (odometry, _) = self::decoder("tf2_msgs/TFMessage");
        let mut value = Value::Null;
        for (names, numbers) in &messages {
            let data = definition.encode(&joints(names, numbers)).unwrap();
            decoder.decode_into(&data, &mut value).unwrap();
            prop_assert_eq!(&value, &decoder.decode(&data).unwrap());
            let again = definition.encode(&value).unwrap();
            prop_assert_eq!(&again, &data);
            // a message that ends too early, and one of another type, in between
            let short = &data[..cut.index(data.len())];
            prop_assert_eq!(decoder.decode_into(short, &mut value), decoder.decode(short).map(|_| ()));
            let _ = odometry.decode_into(&data, &mut value);
        }
    }
}

#[test]
fn a_message_like_the_one_before_allocates_nothing() {
    let (decoder, definition) = decoder("sensor_msgs/JointState");
    let names: Vec<String> = (0..5).map(|i| format!("wheel_{i}")).collect();
    let data = |x: f64| definition.encode(&joints(&names, &[x; 5])).unwrap();
    let (first, second) = (data(1.0), data(2.0));
    let mut value = Value::Null;
    decoder.decode_into(&first, &mut value).unwrap();
    let used = allocation_counter::measure(|| decoder.decode_into(&second, &mut value).unwrap());
    assert_eq!(used.count_total, 0);
    assert_eq!(value.at("position[4]"), Some(&Value::Float(2.0)));
}
