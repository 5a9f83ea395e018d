//! Recordings that are read while they are written: by a writer that appends, is killed, and begins again.

use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use grouser_files::topics::{Joint, Topics};
use grouser_log::Log;
use grouser_log::container::{Channel, Encoding, Format};
use grouser_log::write::{Times, Writer};
use grouser_slip::Sample;

use crate::written;

/// Messages at 50 Hz, ns.
const PERIOD_NS: u64 = 20_000_000;
const BEGIN_NS: u64 = 1_700_000_000_000_000_000;
/// Samples of a message: the rates of two wheels.
const SAMPLES: usize = 2;
const DEFINITION: &str = "Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n\
    float64[] effort\n================\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";

/// `sensor_msgs/JointState` of ROS 1 with the rates of two wheels.
fn joints(number: u64) -> Vec<u8> {
    let mut out = Vec::new();
    let u32 = |value: u64| u32::try_from(value).unwrap().to_le_bytes();
    let time_ns = BEGIN_NS + number * PERIOD_NS;
    out.extend(u32(number));
    out.extend(u32(time_ns / 1_000_000_000));
    out.extend(u32(time_ns % 1_000_000_000));
    out.extend(u32(0)); // frame
    out.extend(u32(2));
    for name in ["left", "right"] {
        out.extend(u32(name.len() as u64));
        out.extend(name.as_bytes());
    }
    out.extend(u32(0)); // positions
    out.extend(u32(2));
    for wheel in 0..2_u64 {
        // drawn, so that chunks do not pack to nothing
        let drawn = (number * 2 + wheel).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
        let rate = f64::from(u32::try_from(drawn).unwrap()) * 1e-6;
        out.extend(rate.to_le_bytes());
    }
    out.extend(u32(0)); // efforts
    out
}

/// A whole recording of these messages, in chunks of a second.
fn recording(format: Format, messages: impl IntoIterator<Item = u64>) -> Vec<u8> {
    let channel = Channel {
        topic: "/joint_states".to_owned(),
        type_name: "sensor_msgs/JointState".to_owned(),
        definition: DEFINITION.as_bytes().into(),
        definition_language: "ros1msg".to_owned(),
        encoding: Encoding::Ros1,
        encoding_name: "ros1".to_owned(),
        metadata: BTreeMap::new(),
    };
    let mut out = Cursor::new(Vec::new());
    let mut writer = Writer::new(&mut out, format, "ros1").unwrap();
    let channel = writer.channel(&channel).unwrap();
    for number in messages {
        let times = Times::at(BEGIN_NS + number * PERIOD_NS);
        writer.message(channel, times, &joints(number)).unwrap();
    }
    writer.finish().unwrap();
    out.into_inner()
}

/// What a writer has written so far.
#[derive(Clone, Default)]
struct Written(Arc<Mutex<Vec<u8>>>);

struct Reader {
    written: Written,
    at: u64,
}

impl Read for Reader {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let written = self.written.0.lock().unwrap();
        let mut rest = &written[usize::try_from(self.at).unwrap().min(written.len())..];
        let length = rest.read(buffer)?;
        self.at += length as u64;
        Ok(length)
    }
}

impl Seek for Reader {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.at = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::End(by) => {
                u64::try_from(self.written.0.lock().unwrap().len()).unwrap() - by.unsigned_abs()
            }
            SeekFrom::Current(by) => self.at.strict_add_signed(by),
        };
        Ok(self.at)
    }
}

/// Reads what `states` of a file follow each other, one for each time that the reader waits; how many samples were
/// there whenever it waited, all of them, and the damage.
fn read(states: Vec<Vec<u8>>) -> (Vec<usize>, Vec<Sample>, u64) {
    let written = Written::default();
    let count = Arc::new(AtomicUsize::new(0));
    let counts = Arc::new(Mutex::new(Vec::new()));
    let states = Mutex::new(states.into_iter());
    let wait = {
        let (written, count, counts) = (written.clone(), Arc::clone(&count), Arc::clone(&counts));
        move || {
            let next = states.lock().unwrap().next();
            *written.0.lock().unwrap() = next.expect("it waits for more than there ever is");
            counts.lock().unwrap().push(count.load(Ordering::Relaxed));
        }
    };
    let reader = Reader { written, at: 0 };
    let log = Log::growing("growing".as_ref(), reader, wait, None, &topics()).unwrap();
    let samples = log.samples(&[]).unwrap();
    let samples = samples.inspect(|_| {
        count.fetch_add(1, Ordering::Relaxed);
    });
    let samples = samples.collect::<Result<Vec<Sample>, _>>().unwrap();
    let counts = counts.lock().unwrap().clone();
    (counts, samples, log.left_out().damages)
}

fn topics() -> Topics {
    let joint = |wheel: &str| Joint {
        wheel: wheel.to_owned(),
        joint: None,
    };
    let mut topics = Topics::default();
    topics.joints = vec![joint("left"), joint("right")];
    topics
}

fn at_once(file: Vec<u8>) -> Vec<Sample> {
    let log = Log::over("whole".as_ref(), Cursor::new(file), None, &topics()).unwrap();
    let samples = log.samples(&[]).unwrap();
    let samples = samples.collect::<Result<Vec<Sample>, _>>().unwrap();
    assert!(!samples.is_empty(), "{:?}", log.left_out());
    samples
}

/// The file after each of its pieces.
fn pieces(file: &[u8], piece: usize) -> Vec<Vec<u8>> {
    let ends = (piece..file.len()).step_by(piece).chain([file.len()]);
    ends.map(|end| file[..end].to_vec()).collect()
}

/// The head of a bag, which says where the index is, is written when the bag is closed.
fn leave_open(states: &mut [Vec<u8>]) {
    let before = states.len() - 1;
    for state in &mut states[..before] {
        let at = state.windows(10).position(|field| field == b"index_pos=");
        if let Some(field) = at.and_then(|at| state.get_mut(at + 10..at + 18)) {
            field.fill(0);
        }
    }
}

#[test]
fn a_recording_in_pieces_is_the_whole_one() {
    for format in [Format::Mcap, Format::Bag] {
        let file = recording(format, 0..500);
        let whole = at_once(file.clone());
        assert_eq!(whole.len(), 500 * SAMPLES);
        for piece in [331, 1024, 4099, file.len()] {
            let mut states = pieces(&file, piece);
            if format == Format::Bag {
                leave_open(&mut states);
            }
            let (_, samples, damages) = read(states);
            assert!(samples == whole, "{format:?} in pieces of {piece} bytes");
            assert_eq!(damages, 0, "{format:?} in pieces of {piece} bytes");
        }
    }
}

#[test]
fn samples_come_when_their_chunk_is_there() {
    let file = recording(Format::Mcap, 0..500);
    let (counts, _, _) = read(pieces(&file, 512));
    // half a second is held back, and what a chunk of a second does not have yet
    let held = SAMPLES as u64 * (500_000_000 + 1_000_000_000) / PERIOD_NS;
    let share = |i: usize| (i * 512 * 500 * SAMPLES / file.len()) as u64;
    for (i, count) in counts.iter().enumerate().skip(counts.len() / 3) {
        let (count, due) = (*count as u64, share(i).saturating_sub(held + 20));
        assert!(count >= due, "{count} samples where {due} were due");
    }
}

#[test]
fn a_writer_that_is_killed_begins_again() {
    for piece in [331, 4099] {
        let (first, second) = (
            recording(Format::Mcap, 0..250),
            recording(Format::Mcap, 400..700),
        );
        // somewhere in its fourth second
        let cut = first.len() * 3 / 5;
        let cut_short = at_once(first[..cut].to_vec());
        let file = [&first[..cut], &second].concat();
        let (_, samples, damages) = read(pieces(&file, piece));
        let (before, after) = samples.split_at(samples.len() - 300 * SAMPLES);
        assert!(after == at_once(second), "the second file is whole");
        assert!(before.len() >= 100 * SAMPLES, "{}", before.len());
        assert!(
            before == &cut_short[..before.len()],
            "and what the first has"
        );
        assert_eq!(damages, 1, "the loss is reported");
    }
}

#[test]
fn a_chunk_of_a_bag_has_its_length_when_it_is_closed() {
    let file = recording(Format::Bag, 0..200);
    let whole = at_once(file.clone());
    let chunks: Vec<usize> = (0..file.len() - 8)
        .filter(|at| file[*at..].starts_with(b"size="))
        .map(|at| at + 9)
        .collect();
    assert!(chunks.len() >= 3, "{}", chunks.len());
    let mut states = Vec::new();
    for end in (300..file.len()).step_by(300).chain([file.len()]) {
        let mut state = file[..end].to_vec();
        for at in &chunks {
            let length = |at: usize| {
                let bytes = file[at..at + 4].try_into().unwrap();
                u32::from_le_bytes(bytes) as usize
            };
            if end > at + 4 && end < at + 4 + length(*at) {
                state[*at..at + 4].fill(0);
            }
        }
        states.push(state);
    }
    leave_open(&mut states);
    let (_, samples, _) = read(states);
    assert!(samples == whole, "{} of {}", samples.len(), whole.len());
}

/// The samples of a whole file, and how many places of it could not be read.
fn with_damages(file: Vec<u8>) -> (Vec<Sample>, u64) {
    let log = Log::over("whole".as_ref(), Cursor::new(file), None, &topics()).unwrap();
    let samples = log.samples(&[]).unwrap();
    let samples = samples.collect::<Result<Vec<Sample>, _>>().unwrap();
    (samples, log.left_out().damages)
}

#[test]
fn what_makes_no_sense_in_a_bag_is_not_waited_for() {
    let file = recording(Format::Bag, 0..200);
    let chunk = |from: usize| {
        let mut places = from..file.len();
        // behind the lengths of the header and of its first field
        places
            .find(|at| file[at + 8..].starts_with(b"op=\x05"))
            .unwrap()
    };
    let second = chunk(chunk(0) + 1);
    let noisy = [&file[..second], &[0xff; 40], &file[second..]].concat();
    let whole = with_damages(noisy.clone());
    assert_eq!((whole.0.len(), whole.1), (200 * SAMPLES, 1));
    let mut states = pieces(&noisy, 331);
    leave_open(&mut states);
    let (_, samples, damages) = read(states);
    assert!((samples, damages) == whole);
}

#[test]
fn the_longest_header_of_a_bag_is_waited_for() {
    let file = recording(Format::Bag, 0..200);
    // behind two seconds, by which the topics are chosen
    let chunks = (0..file.len() - 16).filter(|at| file[at + 8..].starts_with(b"op=\x05"));
    let behind = chunks.take(3).last().unwrap();
    let padding = vec![b' '; (1 << 20) - (4 + 4) - (4 + 18) - (4 + 4)];
    let mut long = Vec::new();
    let fields: [(&str, &[u8]); 3] = [("op", &[3]), ("index_pos", &[9; 8]), ("pad", &padding)];
    written::bag::record(&mut long, &fields, &[]);
    assert_eq!(long.len(), 8 + (1 << 20));
    let file = [&file[..behind], &long, &file[behind..]].concat();
    let mut states = vec![file[..behind + 500_000].to_vec(), file.clone()];
    leave_open(&mut states);
    let (_, samples, damages) = read(states);
    assert!((samples, damages) == with_damages(file));
    assert_eq!(damages, 0);
}

#[test]
fn a_table_is_read_as_it_grows_until_it_is_begun_anew() {
    let text = "t,n,g\n0,,0.5\n1,,0.25\n2,,0.125\n3,,1.5\n";
    let states = [
        &text[..3],
        &text[..12],
        &text[..12],
        &text[..20],
        text,
        "t,n,g\n",
    ];
    let states = Mutex::new(states.map(|state| state.as_bytes().to_vec()).into_iter());
    let written = Written::default();
    let reader = Reader {
        written: written.clone(),
        at: 0,
    };
    let wait = move || {
        let next = states.lock().unwrap().next();
        *written.0.lock().unwrap() = next.expect("it waits for more than there ever is");
    };
    let map = Some(crate::scratch::map(""));
    let log = Log::growing("log.csv".as_ref(), reader, wait, map, &topics()).unwrap();
    let samples = log
        .samples(&[])
        .unwrap()
        .collect::<Result<Vec<_>, _>>()
        .unwrap();
    let rates: Vec<_> = samples.iter().map(|sample| sample.measurement).collect();
    let expected = [0.5, 0.25, 0.125, 1.5].map(|rate| grouser_slip::Measurement::YawRate { rate });
    assert_eq!(rates, expected);
}

/// All samples of a recording in numbered files, one of which gets its next content for each time that the reader waits.
fn follow(folder: PathBuf, steps: Vec<(PathBuf, Vec<u8>)>) -> (Vec<Sample>, u64) {
    fs::remove_dir_all(&folder).ok();
    fs::create_dir_all(&folder).unwrap();
    let steps = Mutex::new(steps.into_iter());
    let step = move || {
        let (path, content) = steps
            .lock()
            .unwrap()
            .next()
            .expect("it waits for more than there ever is");
        fs::write(path, content).unwrap();
    };
    step();
    let log = Log::following(&folder, step, None, &topics()).unwrap();
    let samples = log.samples(&[]).unwrap().collect::<Result<_, _>>().unwrap();
    fs::remove_dir_all(folder).unwrap();
    (samples, log.left_out().damages)
}

#[test]
fn a_recording_in_numbered_files_is_one() {
    for (format, ending) in [(Format::Mcap, "mcap"), (Format::Bag, "bag")] {
        // the first messages of a file may be earlier than the last ones before it
        let parts = [
            (0..50).collect::<Vec<u64>>(),
            (50..200).filter(|number| *number != 195).collect(),
            [195].into_iter().chain(200..400).collect(),
        ];
        let whole = at_once(recording(format, parts.concat()));
        assert_eq!(whole.len(), 400 * SAMPLES);
        let name = format!("grouser-follow-{ending}-{}", std::process::id());
        let folder = env::temp_dir().join(name);
        let path = |number: usize| folder.join(format!("run_{number}.{ending}"));
        let mut steps = Vec::new();
        for (number, part) in parts.into_iter().enumerate() {
            let mut states = pieces(&recording(format, part), 1501);
            if format == Format::Bag {
                leave_open(&mut states);
            }
            let complete = states.pop().unwrap();
            steps.extend(states.into_iter().map(|state| (path(number), state)));
            // the next file is there, empty, before this one is complete
            if number < 2 {
                steps.push((path(number + 1), Vec::new()));
            }
            steps.push((path(number), complete));
        }
        steps.push((folder.join("metadata.yaml"), Vec::new()));
        let (samples, damages) = follow(folder.clone(), steps);
        assert_eq!(samples.len(), whole.len(), "{format:?}, {damages} damages");
        assert!(samples == whole, "{format:?}");
        assert_eq!(damages, 0, "{format:?}");
    }
}
