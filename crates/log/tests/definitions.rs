//! Definitions, and messages by them: limits, names, and bytes that are put together by hand.

use std::collections::BTreeMap;

use grouser_log::container::{Channel, Encoding};
use grouser_log::message::{
    CdrWriter, Decoder, Definition, Header, JSON_LIMIT, MessageError, Trust, Value, View, build,
    known,
};
use grouser_log::{Clock, Messages};

use crate::scratch::Folder;
use crate::written::mcap;

fn decoder(encoding: Encoding, language: &str, text: &str) -> Decoder {
    Decoder::new(&Channel {
        topic: "/t".into(),
        type_name: "demo/msg/T".into(),
        encoding,
        encoding_name: "any".into(),
        definition_language: language.into(),
        definition: text.as_bytes().into(),
        metadata: BTreeMap::new(),
    })
    .unwrap()
}

fn cdr(text: &str) -> Decoder {
    decoder(Encoding::Cdr, "ros2msg", text)
}

/// A message of CDR, little-endian.
fn body(bytes: &[u8]) -> Vec<u8> {
    [&[0, 1, 0, 0], bytes].concat()
}

fn refused(text: &str) -> String {
    Definition::parse("demo/T", text).unwrap_err().to_string()
}

#[test]
fn an_empty_message_takes_a_byte_in_ros_2_alone() {
    let text = "Empty e\nuint8 a\n===\nMSG: demo/Empty\n";
    let value = cdr(text).decode(&body(&[9, 7])).unwrap();
    assert_eq!(value.number_at("a"), Some(7.0));
    let value = decoder(Encoding::Ros1, "ros1msg", text)
        .decode(&[7])
        .unwrap();
    assert_eq!(value.number_at("a"), Some(7.0));
}

#[test]
fn numbers_are_aligned_and_of_either_order() {
    let decoder = cdr("uint8 a\nuint16 b\nint32[2] c\nfloat32 d\nfloat64[] e\nstring f\n");
    let little = [
        &[
            1, 0, 2, 1, 3, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 0, 0x20, 0x40, 1, 0, 0, 0,
        ][..],
        &[0; 4],
        &1.5_f64.to_le_bytes(),
        &[3, 0, 0, 0, b'h', b'i', 0],
    ];
    let big = [
        &[
            1, 0, 1, 2, 0, 0, 0, 3, 0xff, 0xff, 0xff, 0xff, 0x40, 0x20, 0, 0, 0, 0, 0, 1,
        ][..],
        &[0; 4],
        &1.5_f64.to_be_bytes(),
        &[0, 0, 0, 3, b'h', b'i', 0],
    ];
    for bytes in [
        body(&little.concat()),
        [&[0; 4], &big.concat()[..]].concat(),
    ] {
        let value = decoder.decode(&bytes).unwrap();
        let found =
            ["a", "b", "c[0]", "c[1]", "d", "e[0]"].map(|path| value.number_at(path).unwrap());
        assert_eq!(found, [1.0, 258.0, 3.0, -1.0, 2.5, 1.5]);
        assert_eq!(value.at("f").and_then(Value::text), Some("hi"));
    }
    let why = decoder.decode(&[0, 2, 0, 0, 1]).unwrap_err().to_string();
    assert!(why.contains("encapsulation 0x0002"), "{why}");
    let why = decoder.decode(&[0, 1, 0]).unwrap_err().to_string();
    assert!(why.contains("within `the encapsulation`"), "{why}");
    // an empty array is not aligned
    let value = cdr("float64[] a\nuint8 b\n")
        .decode(&body(&[0, 0, 0, 0, 7]))
        .unwrap();
    assert_eq!(value.number_at("b"), Some(7.0));
}

#[test]
fn elements_have_a_limit() {
    let limit = 1 << 18;
    let decoder = cdr("int8[] a\n");
    let of = |count: usize| {
        let count = u32::try_from(count).unwrap().to_le_bytes();
        body(&[&count[..], &vec![1; limit + 1]].concat())
    };
    let value = decoder.decode(&of(limit)).unwrap();
    assert_eq!(value.at("a").unwrap().elements().unwrap().len(), limit);
    let error = decoder.decode(&of(limit + 1)).unwrap_err();
    assert!(matches!(error, MessageError::TooMany { .. }), "{error}");
    // each of these counts as one, and as its field and one more
    let decoder = cdr("One[] a\n===\nMSG: demo/One\nint8 b\n");
    assert!(decoder.decode(&of(limit / 3)).is_ok());
    assert!(decoder.decode(&of(limit / 3 + 1)).is_err());
}

#[test]
fn a_value_is_used_again_where_its_fields_are_the_same() {
    let (a, b) = (cdr("int8 a\n"), cdr("int8 b\n"));
    let mut value = a.decode(&body(&[1])).unwrap();
    b.decode_into(&body(&[2]), &mut value).unwrap();
    assert_eq!(
        (value.number_at("a"), value.number_at("b")),
        (None, Some(2.0))
    );
    let both = cdr("int8 a\nint8 c\n");
    both.decode_into(&body(&[3, 4]), &mut value).unwrap();
    assert_eq!(
        (value.number_at("a"), value.number_at("c")),
        (Some(3.0), Some(4.0))
    );
    a.decode_into(&body(&[5]), &mut value).unwrap();
    assert_eq!(
        (value.number_at("a"), value.number_at("c")),
        (Some(5.0), None)
    );
}

#[test]
fn definitions_have_limits() {
    let fields = |count: usize| "int8 a\n".repeat(count);
    assert!(Definition::parse("demo/T", &fields(4096)).is_ok());
    assert!(refused(&fields(4097)).contains("more than 4096 fields in a type"));
    let types = |count: usize, text: &str| {
        let other = |number: usize| format!("===\nMSG: demo/T{number}\n{text}");
        text.to_owned() + &(1..count).map(other).collect::<String>()
    };
    assert!(Definition::parse("demo/T", &types(4096, "")).is_ok());
    assert!(refused(&types(4097, "")).contains("more than 4096 types"));
    let all = types(8, &fields(4096));
    assert!(Definition::parse("demo/T", &all).is_ok());
    assert!(refused(&format!("{all}===\nMSG: demo/Last\nint8 a\n")).contains("32768 in all"));
    let chain = |depth: usize| {
        let own = |number: usize| format!("===\nMSG: demo/T{number}\nT{} a\n", number + 1);
        let links: String = (1..depth).map(own).collect();
        format!("T1 a\n{links}===\nMSG: demo/T{depth}\nint8 a\n")
    };
    assert!(Definition::parse("demo/T", &chain(32)).is_ok());
    assert!(refused(&chain(33)).contains("32 deep"));
    assert!(refused("T a\n").contains("`demo/T` holds itself"));
}

#[test]
fn types_are_found_by_their_package() {
    let stamped = cdr("Header header\n===\nMSG: std_msgs/Header\nuint8 x\n");
    assert_eq!(
        stamped.decode(&body(&[7])).unwrap().number_at("header.x"),
        Some(7.0)
    );
    // a header of its own
    let own =
        cdr("Header header\n===\nMSG: demo/Header\nuint8 x\n===\nMSG: std_msgs/Header\nuint16 y\n");
    assert_eq!(
        own.decode(&body(&[7])).unwrap().number_at("header.x"),
        Some(7.0)
    );
    assert!(refused("Header header\n").contains("std_msgs/Header"));
    // what ROS 2 has built in
    let built = cdr("builtin_interfaces/Time a\nbuiltin_interfaces/Duration b\nuint8 c\n");
    let bytes = [
        (-2_i32).to_le_bytes(),
        5_u32.to_le_bytes(),
        (-3_i32).to_le_bytes(),
        6_u32.to_le_bytes(),
    ]
    .concat();
    let value = built.decode(&body(&[&bytes[..], &[9]].concat())).unwrap();
    let found = ["a.sec", "a.nanosec", "b.sec", "b.nanosec", "c"].map(|path| value.number_at(path));
    assert_eq!(found, [-2.0, 5.0, -3.0, 6.0, 9.0].map(Some));
    // two signs are no rule
    assert!(refused("int8 a\n==\n").contains("`==`"));
}

#[test]
fn what_a_field_does_not_hold_is_refused() {
    let encode = |field: &str, value: Value| {
        let definition = Definition::parse("demo/T", &format!("{field} a\n")).unwrap();
        definition.encode(&build::message([("a", value)]))
    };
    let bytes = |field: &str, value: Value| encode(field, value).unwrap()[4..].to_vec();
    assert_eq!(
        bytes("uint8[]", Value::Bytes(vec![7, 8])),
        [2, 0, 0, 0, 7, 8]
    );
    assert!(encode("uint16[]", Value::Bytes(vec![7])).is_err());
    assert_eq!(
        bytes("float32[]", Value::Floats(vec![2.5])),
        [1, 0, 0, 0, 0, 0, 0x20, 0x40]
    );
    assert!(encode("float64[]", Value::Floats(vec![2.5])).is_err());
    let array = |count: usize| Value::Array(vec![Value::Int(1); count]);
    assert_eq!(bytes("int8[2]", array(2)), [1, 1]);
    assert!(encode("int8[2]", array(1)).is_err() && encode("int8[2]", array(3)).is_err());
    assert_eq!(bytes("int16", Value::UInt(7)), [7, 0]);
    assert_eq!(bytes("int8", Value::Int(-128)), [0x80]);
    assert_eq!(bytes("int8", Value::Int(127)), [0x7f]);
    assert!(encode("int8", Value::Int(128)).is_err() && encode("int8", Value::Int(-129)).is_err());
    assert_eq!(
        bytes("int64", Value::Int(i64::MIN)),
        [0, 0, 0, 0, 0, 0, 0, 0x80]
    );
    assert!(encode("int64", Value::UInt(1 << 63)).is_err());
    assert_eq!(bytes("uint64", Value::UInt(u64::MAX)), [0xff; 8]);
    assert!(
        encode("uint8", Value::Int(-1)).is_err() && encode("uint16", Value::UInt(1 << 16)).is_err()
    );
    assert!(encode("bool", Value::Int(1)).is_err() && encode("string", Value::Int(1)).is_err());
}

#[test]
fn a_writer_of_fields_writes_what_the_definition_does() {
    let text = known::definition("std_msgs/Header").unwrap();
    let text = format!(
        "int32 a\nstd_msgs/Header header\nfloat64[2] b\nstring[] c\nfloat64[] d\nfloat64 e\n{}\nMSG: std_msgs/Header\n{text}",
        "=".repeat(80)
    );
    let definition = Definition::parse("demo/T", &text).unwrap();
    let value = build::message([
        ("a", Value::Int(-5)),
        ("header", build::header(-1_500_000_000, "map")),
        ("b", build::numbers(&[0.5, 0.25])),
        ("c", build::texts(&["one", "three"])),
        ("d", build::numbers(&[1.0, 2.0, 3.0])),
        ("e", Value::Float(-0.125)),
    ]);
    let mut bytes = vec![9; 3];
    let mut out = CdrWriter::new(&mut bytes);
    out.int32(-5);
    let header = Header {
        time_ns: -1_500_000_000,
        frame: "map",
    };
    out.header(header).unwrap();
    out.float64s([0.5, 0.25]);
    out.texts(["one", "three"].into_iter()).unwrap();
    out.numbers([1.0, 2.0, 3.0].into_iter()).unwrap();
    out.float64(-0.125);
    assert_eq!(bytes, definition.encode(&value).unwrap());
    let far = Header {
        time_ns: (1 << 31) * 1_000_000_000,
        frame: "",
    };
    assert!(CdrWriter::new(&mut bytes).header(far).is_err());
}

#[test]
fn json_has_a_limit() {
    let decoder = decoder(Encoding::Json, "", "");
    let json = |length: usize| format!("\"{}\"", "a".repeat(length - 2));
    assert!(decoder.decode(json(JSON_LIMIT).as_bytes()).is_ok());
    let error = decoder.decode(json(JSON_LIMIT + 1).as_bytes()).unwrap_err();
    assert!(matches!(error, MessageError::Long { .. }), "{error}");
}

/// The nearest `f64` of each text, as Python's `float` reads it, to the bit.
#[test]
fn numbers_of_json_are_the_nearest() {
    let decoder = decoder(Encoding::Json, "", "");
    let read = |text: &str| match decoder.decode(text.as_bytes()).unwrap() {
        Value::Float(number) => number,
        other => panic!("{text} is {other:?}"),
    };
    let known = [
        ("51.248178375505404", 0x4049_9fc4_4f1b_2f60_u64),
        ("-93.3113703768803", 0xc057_53ed_7e04_6939),
        ("-36.5739948427534", 0xc042_4978_a9ba_d969),
        ("52.31400820410624", 0x404a_2831_6bbb_a7ef),
        ("97.45365320034685", 0x4058_5d08_a76e_cdca),
    ];
    for (text, bits) in known {
        assert_eq!(read(text).to_bits(), bits, "{text}");
    }
    let mut state = 1_u64;
    for _ in 0..100_000 {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let number = f64::from_bits(state ^ (state >> 29));
        if number.is_finite() {
            // the shortest text of a number, and one of a time with six decimals
            for text in [
                format!("{number:e}"),
                format!("{}.{:06}", state >> 34, state % 1_000_000),
            ] {
                assert_eq!(
                    read(&text).to_bits(),
                    text.parse::<f64>().unwrap().to_bits(),
                    "{text}"
                );
            }
        }
    }
}

#[test]
fn trust_ends_at_its_limits() {
    assert_eq!(Trust::from_variance(1e300), Trust::Variance(1e300));
    let usable = [
        Trust::Unknown,
        Trust::Variance(1.0),
        Trust::Absent,
        Trust::DoNotUse,
    ];
    assert_eq!(usable.map(Trust::is_usable), [true, true, false, false]);
}

#[test]
fn elements_are_equal_by_what_they_hold() {
    let joints = |position: &[f64]| {
        build::joint_state(build::header(1, "base"), &["a"], [position, &[], &[]])
    };
    let (one, same, other) = (joints(&[0.5]), joints(&[0.5]), joints(&[0.75]));
    let view = |value| View::new("sensor_msgs/JointState", value);
    assert_eq!(view(&one), view(&same));
    assert_ne!(view(&one), view(&other));
    let Some(View::JointState(state)) = view(&one) else {
        panic!("it has all fields of its type")
    };
    let sizes = (
        state.position.len(),
        state.position.is_empty(),
        state.velocity.is_empty(),
    );
    assert_eq!(sizes, (1, false, true));
    let shown = format!("{:?}", view(&one));
    assert!(
        shown.contains("[\"a\"]") && shown.contains("[0.5]"),
        "{shown}"
    );
}

#[test]
fn channels_of_one_name_have_their_own_definitions() {
    let mut file = mcap::MAGIC.to_vec();
    mcap::schema(&mut file, 1, b"a/A", b"byte first\n");
    mcap::schema(&mut file, 2, b"a/A", b"byte second\n");
    // as the first, in another language, and of another name
    let mut content = 3_u16.to_le_bytes().to_vec();
    for part in [&b"a/A"[..], b"ros2msg", b"byte first\n"] {
        mcap::counted(&mut content, part);
    }
    mcap::record(&mut file, 3, &content);
    for id in 1..=3 {
        mcap::channel(&mut file, id, id, format!("/{id}").as_bytes(), b"ros1");
        mcap::message(&mut file, id, id.into(), &[0xff]);
    }
    // and as the first, by another encoding
    mcap::channel(&mut file, 4, 1, b"/4", b"cdr");
    mcap::message(&mut file, 4, 4, &[0, 1, 0, 0, 0xff]);
    let folder = Folder::new("names");
    let path = folder.file("log.mcap", &file);
    let messages = Messages::open(&path, Clock::Recorder, |_| true).unwrap();
    let values: Vec<Value> = messages.map(|message| message.value).collect();
    let byte = |name: &str, value| build::message([(name, value)]);
    let signed = |name| byte(name, Value::Int(-1));
    assert_eq!(
        values,
        [
            signed("first"),
            signed("second"),
            byte("first", Value::UInt(255)),
            signed("first")
        ]
    );
}
