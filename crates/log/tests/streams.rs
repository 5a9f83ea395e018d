//! Compressed logs, several files, and rows out of order.

use std::fmt::Write as _;
use std::io::Write as _;

use flate2::{Compression, write::GzEncoder};
use grouser_files::{Document, columns};
use grouser_log::{Error, Log};
use grouser_slip::{Measurement, Sample};

use crate::scratch::{Folder, map, read};

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn rows(times: impl IntoIterator<Item = u64>) -> String {
    let mut out = String::from("t,n,g\n");
    for time in times {
        let _ = writeln!(out, "{time}e-3,{time},0");
    }
    out
}

#[test]
fn gzip_is_read_by_its_content_and_in_several_members() {
    let text = rows(0..100);
    let plain = read("plain", "", text.as_bytes()).unwrap();
    assert_eq!(read("gzip", "", &gzip(text.as_bytes())).unwrap(), plain);
    let (a, b) = text.split_at(text.len() / 2);
    let members = [gzip(a.as_bytes()), gzip(b.as_bytes())].concat();
    assert_eq!(read("members", "", &members).unwrap(), plain);
}

#[test]
fn gzip_cut_anywhere_is_an_error() {
    let whole = gzip(rows(0..100).as_bytes());
    for length in 2..whole.len() {
        assert!(read("gzcut", "", &whole[..length]).is_err(), "{length}");
    }
}

#[test]
fn gzip_with_a_flipped_bit_is_an_error_or_the_same() {
    let text = rows(0..50);
    let plain = read("flipplain", "", text.as_bytes()).unwrap();
    let whole = gzip(text.as_bytes());
    for bit in 0..whole.len() * 8 {
        let mut flipped = whole.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        if let Ok(records) = read("flip", "", &flipped) {
            assert_eq!(records, plain, "bit {bit}");
        }
    }
}

#[test]
fn a_bomb_is_read_in_constant_memory() {
    // 64 MiB of one line, some 64 KiB compressed: refused at the limit of a line.
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(b"t,n,g\n").unwrap();
    let zeros = vec![b'0'; 1 << 20];
    for _ in 0..64 {
        encoder.write_all(&zeros).unwrap();
    }
    let bomb = encoder.finish().unwrap();
    let folder = Folder::new("bomb");
    let log = Log::find(&[folder.file("log.csv", &bomb)], map("")).unwrap();
    let used = allocation_counter::measure(|| {
        let error = log.samples(&[]).unwrap().find_map(Result::err).unwrap();
        assert!(matches!(error, Error::LongLine { .. }));
    });
    assert!(used.bytes_max < 8 << 20, "{}", used.bytes_max);
}

#[test]
fn memory_does_not_grow_with_the_log() {
    let used = |count: u64| {
        let folder = Folder::new(&format!("grow{count}"));
        let file = folder.file("log.csv", rows(0..count).as_bytes());
        let log = Log::find(&[file], map("")).unwrap();
        let used = allocation_counter::measure(|| {
            let records = log.samples(&[]).unwrap();
            assert_eq!(records.map(Result::unwrap).count() as u64, 2 * count);
        });
        used.bytes_max
    };
    let (small, large) = (used(5_000), used(100_000));
    assert!(large < small + small / 10, "{small} {large}");
}

#[test]
fn rows_find_their_place_within_the_look_ahead() {
    // Blocks of 1000 rows, each backwards.
    let times = (0..5).flat_map(|block| (0..1000_u64).rev().map(move |i| block * 1000 + i));
    let records = read("order", "", rows(times).as_bytes()).unwrap();
    assert_eq!(records.len(), 10_000);
    assert!(
        records
            .windows(2)
            .all(|pair| pair[0].time_ns <= pair[1].time_ns)
    );
    // Further out of place: an error that says by how much.
    let late = (1000..4000).chain([0]);
    match read("late", "", rows(late).as_bytes()).unwrap_err() {
        Error::OutOfOrder { at, by_s, .. } => {
            assert_eq!(at.line, 3002);
            assert!(by_s > 1.9 && by_s < 3.0, "{by_s}");
        }
        other => panic!("{other}"),
    }
}

fn two_tables() -> columns::ColumnMap {
    let text = "format = 1\n\
        [[table]]\nfile = \"*wheels*\"\ntime = { column = \"t\", unit = \"s\" }\n\
        columns = [{ column = \"n\", meaning = \"wheel_count\", wheel = \"w\", unit = \"tick\" }]\n\
        [[table]]\nfile = \"*imu*\"\ntime = { column = \"t\", unit = \"ms\" }\n\
        columns = [{ column = \"g\", meaning = \"yaw_rate\", unit = \"deg/s\" }]\n";
    columns::parse(&Document::from_text("map.toml", text.into()).unwrap()).unwrap()
}

#[test]
fn several_files_are_one_log_by_folder_by_name_or_by_beginning() {
    let folder = Folder::new("several");
    let wheels = folder.file("run7_wheels.csv", b"t,n\n0,1\n0.2,2\n");
    let imu = folder.file("run7_imu.csv", b"t,g\n100,180\n300,0\n");
    let notes = folder.file("run7_notes.txt", b"windy");
    for paths in [
        vec![folder.0.clone()],
        vec![wheels, imu],
        vec![folder.0.join("run7_")],
        vec![folder.0.join("run7")],
    ] {
        let log = Log::find(&paths, two_tables()).unwrap();
        let records: Vec<Sample> = log.samples(&[]).unwrap().map(Result::unwrap).collect();
        let times: Vec<i64> = records
            .iter()
            .map(|record| record.time_ns / 1_000_000)
            .collect();
        assert_eq!(times, [0, 100, 200, 300]);
        let Measurement::YawRate { rate } = records[1].measurement else {
            panic!("{records:?}");
        };
        assert!((rate - std::f64::consts::PI).abs() < 1e-15);
        let unused: Vec<_> = log.unused().to_vec();
        assert_eq!(
            unused,
            if paths.len() == 2 {
                vec![]
            } else {
                vec![notes.clone()]
            }
        );
    }
    // A second run beside it is not mixed in.
    folder.file("run8_imu.csv", b"t,g\n100,180\n");
    let error = Log::find(std::slice::from_ref(&folder.0), two_tables()).unwrap_err();
    assert!(matches!(error, Error::TwoFiles { .. }));
    assert!(Log::find(&[folder.0.join("run7")], two_tables()).is_ok());
    // And what is not there is said to be not there.
    for absent in [folder.0.join("run9"), folder.0.join("no/such")] {
        assert!(matches!(
            Log::find(&[absent], two_tables()),
            Err(Error::File(_))
        ));
    }
    let error = Log::find(&[notes], two_tables()).unwrap_err();
    assert!(matches!(error, Error::NoTable { .. }));
}

#[cfg(unix)]
#[test]
fn logs_that_are_no_files() {
    let folder = Folder::new("nofiles");
    let pipe = folder.0.join("log.csv");
    assert!(
        std::process::Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    for path in [pipe, "/dev/zero".into()] {
        let log = Log::find(&[path], map("")).unwrap();
        assert!(matches!(log.samples(&[]).map(|_| ()), Err(Error::File(_))));
    }
}
