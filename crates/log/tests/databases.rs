//! Databases of rosbag2 (`interop/write_rosbag2.py`), whole and broken, and messages that rosbag2 compressed one by one.

use std::io::Cursor;
use std::path::Path;

use grouser_log::container::{Container, Event};
use grouser_log::message::build;
use grouser_log::write::{McapWriter, Times};
use grouser_log::{Error, Log};

use crate::others_files::shipped;
use crate::scratch::Folder;

/// Topic, time and bytes of a message.
type Row = (String, u64, Vec<u8>);

/// Every message, and what is damaged.
fn read(bytes: Vec<u8>) -> Result<(Vec<Row>, Vec<String>), Error> {
    let length = bytes.len();
    let mut container = Container::over(Path::new("run.db3"), Cursor::new(bytes))?;
    let (mut rows, mut damages) = (Vec::new(), Vec::new());
    while let Some(event) = container.next() {
        assert!(rows.len() <= length && damages.len() <= length, "no end");
        match event {
            Event::Message(message) => rows.push((
                message.of.topic.clone(),
                message.log_time_ns,
                message.data.to_vec(),
            )),
            Event::Damage(damage) => {
                assert!(damage.offset + damage.bytes <= length as u64, "{damage:?}");
                damages.push(damage.what);
            }
        }
    }
    Ok((rows, damages))
}

fn database() -> Vec<u8> {
    std::fs::read(shipped("joints.db3")).unwrap()
}

/// The same messages as those of an MCAP file that another library wrote, and a text over six pages.
#[test]
fn a_database_holds_what_the_recording_holds() {
    let mcap = std::fs::read(shipped("joints_none.mcap")).unwrap();
    let (joints, _) = read(mcap).unwrap();
    let (rows, damages) = read(database()).unwrap();
    assert!(damages.is_empty(), "{damages:?}");
    let (own, notes): (Vec<Row>, Vec<Row>) =
        rows.into_iter().partition(|row| row.0 == "/joint_states");
    assert_eq!(own, joints);
    let [(topic, time_ns, note)] = &notes[..] else {
        panic!("{notes:?}");
    };
    assert_eq!((&**topic, *time_ns), ("/notes", joints[20].1));
    assert_eq!(
        &note[8..note.len() - 1],
        "soft ground. ".repeat(200).as_bytes()
    );
}

#[test]
fn wheels_of_a_database_are_samples() {
    let robot = "format = 1\nname = \"cart\"\n[[wheel]]\nname = \"left\"\nx_m = 0.0\ny_m = 0.2\nradius_m = 0.1\ndrive = \"powered\"\n\
                 [[wheel]]\nname = \"right\"\nx_m = 0.0\ny_m = -0.2\nradius_m = 0.1\ndrive = \"powered\"\n";
    let document = grouser_files::Document::from_text("robot.toml", robot.into()).unwrap();
    let robot = grouser_files::robot::parse(&document).unwrap();
    let log = Log::find_any(&[shipped("joints.db3")], None, &robot.topics).unwrap();
    assert_eq!(log.wheels(), ["left", "right"]);
    assert!(log.samples(&[]).unwrap().count() >= 80);
}

#[test]
fn a_truncated_database_gives_the_beginning_or_is_refused() {
    let bytes = database();
    let (whole, _) = read(bytes.clone()).unwrap();
    for cut in (16..bytes.len()).step_by(61) {
        if let Ok((rows, damages)) = read(bytes[..cut].to_vec()) {
            assert_eq!(rows, whole[..rows.len()], "{cut}");
            assert!(
                rows.len() == whole.len() || !damages.is_empty(),
                "{cut}: silent"
            );
        }
    }
}

/// A database has no checksums: a flipped bit may be a different value, but reading ends, within the file.
#[test]
fn reading_ends_whatever_bits_are_flipped() {
    let bytes = database();
    for bit in (0..bytes.len() * 8).step_by(7) {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        let _ = read(flipped);
    }
}

#[test]
fn other_databases_and_open_changes_are_named() {
    let folder = Folder::new("databases");
    let mut other = database();
    let at = other.windows(6).position(|word| word == b"topics").unwrap();
    let tables = [
        at,
        at + 6
            + other[at + 6..]
                .windows(6)
                .position(|word| word == b"topics")
                .unwrap(),
    ];
    for at in tables {
        other[at..at + 6].copy_from_slice(b"tropic");
    }
    let path = folder.file("other.db3", &other);
    let error = Container::open(&path).err().unwrap();
    assert!(
        error.to_string().contains("without the tables of rosbag2"),
        "{error}"
    );
    let path = folder.file("run.db3", &database());
    folder.file("run.db3-wal", b"7");
    let error = Container::open(&path).err().unwrap();
    assert!(error.hint().unwrap().contains("wal_checkpoint"), "{error}");
}

/// A frame of one block that is stored (RFC 8878, section 3.1.1).
fn frame(content: &[u8]) -> Vec<u8> {
    let length = u8::try_from(content.len()).unwrap();
    let block = u32::from(length) << 3 | 1;
    let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0x20, length];
    frame.extend_from_slice(&block.to_le_bytes()[..3]);
    frame.extend_from_slice(content);
    frame
}

#[test]
fn messages_that_are_compressed_one_by_one_are_expanded() {
    let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
    let mut topic = writer.topic("/cmd_vel", "geometry_msgs/Twist").unwrap();
    writer
        .send(&mut topic, 1000, &build::twist([0.2, 0.0, 0.0], [0.0; 3]))
        .unwrap();
    let (plain, _) = read(writer.finish().unwrap()).unwrap();
    let channel = grouser_log::message::known::channel("/cmd_vel", "geometry_msgs/Twist").unwrap();
    let mut writer = McapWriter::new(Vec::new(), "ros2").unwrap();
    let number = writer.channel(&channel).unwrap();
    for _ in 0..3 {
        let times = Times::at(1000);
        writer.message(number, times, &frame(&plain[0].2)).unwrap();
    }
    let mut cut = frame(&plain[0].2);
    cut.truncate(30);
    writer.message(number, Times::at(2000), &cut).unwrap();
    let (rows, damages) = read(writer.finish().unwrap()).unwrap();
    assert_eq!(rows, vec![plain[0].clone(); 3]);
    assert!(damages[0].contains("a message"), "{damages:?}");
}
