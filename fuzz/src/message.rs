//! A definition and a message out of any bytes: what decodes is written again to the same values.
use grouser_log::container::{Channel, Encoding};
use grouser_log::message::{Decoder, View};

pub fn run(bytes: &[u8]) {
    let Some((&kind, rest)) = bytes.split_first() else {
        return;
    };
    // Definition and message are parted by a zero byte, which no definition has.
    let at = rest
        .iter()
        .position(|byte| *byte == 0)
        .unwrap_or(rest.len());
    let (definition, data) = (&rest[..at], rest.get(at + 1..).unwrap_or_default());
    let (encoding, name, language) = match kind % 3 {
        0 => (Encoding::Ros1, "ros1", "ros1msg"),
        1 => (Encoding::Cdr, "cdr", "ros2msg"),
        _ => (Encoding::Json, "json", ""),
    };
    let types = [
        "sensor_msgs/msg/JointState",
        "sensor_msgs/Imu",
        "nav_msgs/Odometry",
        "tf2_msgs/TFMessage",
        "a/B",
    ];
    let type_name = types[usize::from(kind / 3) % types.len()];
    let channel = Channel {
        topic: "/t".into(),
        type_name: type_name.into(),
        encoding,
        encoding_name: name.into(),
        definition_language: language.into(),
        definition: definition.into(),
        metadata: Default::default(),
    };
    let Ok(decoder) = Decoder::new(&channel) else {
        return;
    };
    if let Ok(value) = decoder.decode(data) {
        let _ = View::new(type_name, &value);
    }
}
