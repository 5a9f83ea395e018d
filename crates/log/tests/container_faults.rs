//! MCAP files and bags with wrong contents: sizes that disagree, lengths that lie, numbers
//! used twice, ends that are missing, paths that are no files, disks that are full, formats of tomorrow.

use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::time::Duration;

use grouser_log::Error;
use grouser_log::container::{Container, Damage, Event, Format};
use grouser_log::write::copy;

use crate::processor_time::ThreadTime;
use crate::scratch::Folder;
use crate::written;
use crate::written::{ChunkAt, Packing, Plan, Row, Written, read};

fn plan(packing: Packing) -> Plan {
    Plan {
        packing,
        bytes: 16 << 10,
        chunk: 3 << 10,
        alike: 60,
    }
}

fn all() -> Vec<(Written, usize)> {
    let mcap = [Packing::None, Packing::Lz4, Packing::Zstd];
    let bag = [Packing::None, Packing::Lz4, Packing::Bz2];
    let mcap = mcap.map(|packing| (written::mcap::write(plan(packing)), 8));
    let bag = bag.map(|packing| (written::bag::write(plan(packing)), 4));
    mcap.into_iter().chain(bag).collect()
}

/// Reads within limits of memory.
fn guarded(bytes: &[u8]) -> (Vec<Row>, Vec<Damage>) {
    let (mut found, begin) = (None, ThreadTime::now());
    let memory = allocation_counter::measure(|| found = Some(read(bytes.to_vec()).unwrap()));
    let limit = (64 << 20) + 2 * bytes.len() as u64;
    assert!(memory.bytes_max < limit, "{} bytes", memory.bytes_max);
    // A program compiled for tests, on a machine that does other things too.
    assert!(
        begin.elapsed() < Duration::from_secs(5),
        "{:?}",
        begin.elapsed()
    );
    found.unwrap()
}

/// The rows of all chunks but one.
fn but(file: &Written, chunk: &ChunkAt) -> Vec<Row> {
    let keep = |k: &usize| !chunk.rows.contains(k);
    (0..file.rows.len())
        .filter(keep)
        .map(|k| file.rows[k].clone())
        .collect()
}

#[test]
fn a_length_that_lies_costs_its_chunk_alone() {
    for (file, width) in all() {
        let chunk = &file.chunks[2];
        let others = but(&file, chunk);
        // Every field of the chunk's head, wherever it begins.
        for at in chunk.record.start..chunk.packed.start {
            for lie in [u64::MAX, 1 << 63, (1 << 31) - 1, 0, 1, 40_000] {
                let mut bytes = file.bytes.clone();
                let end = (at + width).min(chunk.packed.start);
                bytes[at..end].copy_from_slice(&lie.to_le_bytes()[..end - at]);
                if bytes == file.bytes {
                    continue;
                }
                let (rows, damages) = guarded(&bytes);
                let kept = others.iter().all(|row| rows.contains(row));
                assert!(kept, "{:?} at {at}, {lie:x}: {damages:?}", file.packing);
                let strange = rows.iter().any(|row| !file.rows.contains(row));
                assert!(!strange, "{:?} at {at}, {lie:x}: {damages:?}", file.packing);
                assert!(rows.len() == file.rows.len() || !damages.is_empty());
            }
        }
    }
}

#[test]
fn a_padded_chunk_is_read() {
    for packing in [Packing::None, Packing::Lz4, Packing::Zstd] {
        // Bytes behind the last record of the content, which a writer left there: zeros and noise.
        for padding in [vec![0; 9], vec![0; 100], vec![7; 100]] {
            let mut file = written::mcap::MAGIC.to_vec();
            let mut content = Vec::new();
            written::mcap::declare(&mut content);
            written::mcap::message(&mut content, 1, 5, b"five");
            content.extend(&padding);
            written::mcap::chunk(&mut file, packing, &content);
            let mut content = Vec::new();
            written::mcap::message(&mut content, 2, 6, b"six");
            written::mcap::chunk(&mut file, packing, &content);
            let (rows, _) = guarded(&file);
            let data: Vec<_> = rows.iter().map(|row| row.3.clone()).collect();
            assert_eq!(data, [b"five".to_vec(), b"six".to_vec()]);
        }
    }
}

#[test]
fn a_chunk_of_32_mib_of_zeros_is_read() {
    for packing in [Packing::Lz4, Packing::Zstd] {
        let mut file = written::mcap::MAGIC.to_vec();
        let mut content = Vec::new();
        written::mcap::declare(&mut content);
        for time in 0..31 {
            written::mcap::message(&mut content, 1, time, &vec![0; 1 << 20]);
        }
        written::mcap::chunk(&mut file, packing, &content);
        assert!(
            content.len() > 90 * file.len(),
            "{packing:?}: {}",
            file.len()
        );
        drop(content);
        let mut container = Container::over(Path::new("zeros"), Cursor::new(file.clone())).unwrap();
        let mut count = 0;
        let memory = allocation_counter::measure(|| {
            while let Some(event) = container.next() {
                match event {
                    Event::Message(message) => count += message.data.len() >> 20,
                    Event::Damage(damage) => assert!(damage.what.contains("footer"), "{damage:?}"),
                }
            }
        });
        assert_eq!(count, 31);
        assert!(memory.bytes_max < (64 << 20) + 2 * file.len() as u64);
    }
}

#[test]
fn bombs_in_bags_are_refused_or_read_within_the_memory() {
    for packing in [Packing::Lz4, Packing::Bz2] {
        let packed = packing.pack(&vec![0; 100 << 20]);
        for declared in [100_u32 << 20, 1 << 20, u32::MAX, u32::MAX / 2] {
            let mut file = written::bag::MAGIC.to_vec();
            file.extend(written::bag::bag_header(0, 2));
            let name = packing.names().1.as_bytes();
            let size = declared.to_le_bytes();
            let fields: [(&str, &[u8]); 3] = [("op", &[5]), ("compression", name), ("size", &size)];
            written::bag::record(&mut file, &fields, &packed);
            let mut content = Vec::new();
            written::bag::connection(&mut content, 0, b"/t", b"a/B");
            written::bag::message(&mut content, 0, 5, b"five");
            let size = u32::try_from(content.len()).unwrap().to_le_bytes();
            let fields: [(&str, &[u8]); 3] =
                [("op", &[5]), ("compression", b"none"), ("size", &size)];
            written::bag::record(&mut file, &fields, &content);
            let (rows, damages) = guarded(&file);
            assert_eq!(rows.len(), 1, "{damages:?}");
            let reported = damages.iter().any(|damage| {
                damage.what.contains("limit") || damage.what.contains("more than the")
            });
            assert!(reported, "{packing:?} {declared}: {damages:?}");
        }
    }
}

#[test]
fn the_first_of_two_declarations_is_kept_and_the_other_reported() {
    let mut file = written::mcap::MAGIC.to_vec();
    written::mcap::schema(&mut file, 1, b"a/A", b"bool a\n");
    written::mcap::schema(&mut file, 1, b"a/Other", b"bool b\n");
    written::mcap::channel(&mut file, 1, 1, b"/first", b"ros1");
    written::mcap::channel(&mut file, 1, 1, b"/second", b"ros1");
    written::mcap::channel(&mut file, 2, 9, b"/no-schema", b"ros1");
    written::mcap::channel(&mut file, 3, 0, b"/strange", b"morse");
    written::mcap::channel(&mut file, 4, 0, b"/\xff\xfe", b"json");
    written::mcap::schema(&mut file, 5, b"\xc3\x28", b"");
    for id in 1..=4 {
        written::mcap::message(&mut file, id, 5, b"1");
    }
    let (rows, damages) = guarded(&file);
    let topics: Vec<_> = rows
        .iter()
        .map(|row| (row.0.as_str(), row.1.as_str()))
        .collect();
    assert_eq!(topics, [("/first", "a/A"), ("/strange", "")]);
    let reported = |what: &str| {
        damages
            .iter()
            .filter(|damage| damage.what.contains(what))
            .count()
    };
    assert_eq!(
        reported("schema 1 is declared again as another: the first is kept"),
        1,
        "{damages:?}"
    );
    assert_eq!(
        reported("channel 1 is declared again as another: the first is kept"),
        1
    );
    assert_eq!(reported("has schema 9, which is not there"), 1);
    assert_eq!(reported("is not UTF-8"), 2);
    assert_eq!(reported("1 messages belong to channel"), 2);

    let mut file = written::bag::MAGIC.to_vec();
    file.extend(written::bag::bag_header(0, 0));
    written::bag::connection(&mut file, 0, b"/first", b"a/A");
    written::bag::connection(&mut file, 0, b"/second", b"a/A");
    written::bag::connection(&mut file, 1, b"/\xff", b"a/A");
    written::bag::message(&mut file, 0, 5, b"1");
    written::bag::message(&mut file, 1, 5, b"1");
    let (rows, damages) = guarded(&file);
    assert_eq!((rows.len(), rows[0].0.as_str()), (1, "/first"));
    let reported = |what: &str| damages.iter().any(|damage| damage.what.contains(what));
    assert!(
        reported("the first is kept")
            && reported("is not UTF-8")
            && reported("belong to channel 1")
    );
}

#[test]
fn declarations_come_from_the_end_when_the_first_chunk_is_lost() {
    for (file, _) in all() {
        let mut bytes = file.bytes.clone();
        let first = &file.chunks[0];
        // Destroyed as a bad block destroys it.
        let half = first.packed.start + first.packed.len() / 2;
        bytes[first.record.start..half].fill(0xa5);
        let (rows, damages) = guarded(&bytes);
        assert!(
            rows == but(&file, first),
            "{:?}: {} rows, {damages:?}",
            file.packing,
            rows.len()
        );
        assert!(!damages.is_empty());
    }
}

#[test]
fn another_files_end_declares_nothing_for_this_one() {
    for packing in [Packing::None, Packing::Zstd] {
        // The same numbers for other topics, in a file behind this one.
        let file = written::mcap::write(plan(packing));
        let mut other = written::mcap::MAGIC.to_vec();
        written::mcap::channel(&mut other, 1, 0, b"/other", b"json");
        written::mcap::message(&mut other, 1, 1, b"1");
        let start = other.len();
        written::mcap::channel(&mut other, 1, 0, b"/other", b"json");
        other.extend([2]);
        other.extend(20_u64.to_le_bytes());
        other.extend((start as u64).to_le_bytes());
        other.extend([0; 8]);
        let crc = crc32fast::hash(&other[start..]);
        other.extend(crc.to_le_bytes());
        other.extend(written::mcap::MAGIC);
        let mut bytes = [file.bytes.clone(), other].concat();
        bytes[file.chunks[0].packed.start] ^= 1;
        bytes[file.chunks[0].packed.start + 9] ^= 1;
        let (rows, damages) = guarded(&bytes);
        assert_eq!(
            rows.iter().filter(|row| row.0 == "/other").count(),
            1,
            "{damages:?}"
        );
        assert!(
            rows.iter()
                .all(|row| row.0 == "/other" || file.rows.contains(row))
        );
    }
}

#[test]
fn an_end_that_is_missing_or_wrong_costs_no_message() {
    for (file, _) in all() {
        let end = file.chunks.last().unwrap().record.end;
        for from in end..file.bytes.len() {
            let mut bytes = file.bytes.clone();
            bytes[from] ^= 0xff;
            assert!(
                guarded(&bytes).0 == file.rows,
                "{:?}, byte {from}",
                file.packing
            );
        }
        assert!(guarded(&file.bytes[..end]).0 == file.rows);
        let noise: Vec<u8> = (0..400_u32)
            .map(|k| k.wrapping_mul(2_654_435_761).to_be_bytes()[0])
            .collect();
        let (rows, damages) = guarded(&[&file.bytes[..end], &noise].concat());
        assert!(rows == file.rows && !damages.is_empty());
    }
}

#[test]
fn a_wrong_crc_of_the_data_costs_no_message_and_is_reported() {
    const DATA_END: [u8; 9] = [0x0f, 4, 0, 0, 0, 0, 0, 0, 0];
    for packing in [Packing::None, Packing::Lz4, Packing::Zstd] {
        let file = written::mcap::write(plan(packing));
        let mut bytes = file.bytes.clone();
        let mut places = bytes.windows(DATA_END.len());
        let at = places.rposition(|bytes| bytes == DATA_END).unwrap() + DATA_END.len();
        bytes[at..at + 4].copy_from_slice(&0xdead_beef_u32.to_le_bytes());
        let (rows, damages) = guarded(&bytes);
        assert!(rows == file.rows, "{packing:?}");
        let reported = |damage: &Damage| damage.what.contains("the CRC of the data");
        assert!(damages.iter().any(reported), "{packing:?}: {damages:?}");
    }
}

#[test]
fn paths_that_are_no_files_are_refused_at_once() {
    let folder = Folder::new("paths");
    let refused = |path: &Path| Container::open(path).map(|_| ()).unwrap_err().to_string();
    assert!(refused(&folder.0).contains("a directory"));
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        use std::os::unix::fs::{PermissionsExt, symlink};
        assert!(refused(Path::new("/dev/zero")).contains("a device"));
        let [a, b] = ["a", "b"].map(|name| folder.0.join(name));
        symlink(&a, &b).unwrap();
        symlink(&b, &a).unwrap();
        assert!(refused(&a).contains("symbolic links"), "{}", refused(&a));
        let pipe = folder.0.join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        if made.is_ok_and(|status| status.success()) {
            assert!(refused(&pipe).contains("a pipe"));
        } else {
            eprintln!("skipped: no mkfifo here");
        }
        let file = written::mcap::write(plan(Packing::None)).bytes;
        let secret = folder.file("secret", &file);
        std::fs::set_permissions(&secret, std::fs::Permissions::from_mode(0o000)).unwrap();
        if std::fs::File::open(&secret).is_err() {
            assert!(refused(&secret).contains("ermission"));
        } else {
            eprintln!("skipped: this user may read everything");
        }
        let strange = folder.0.join(std::ffi::OsStr::from_bytes(b"\xff\xfe.mcap"));
        if std::fs::write(&strange, &file).is_ok() {
            assert!(Container::open(&strange).is_ok());
        }
    }
}

#[test]
fn a_file_that_shrinks_while_it_is_read_ends() {
    let folder = Folder::new("shrinks");
    for (file, _) in all() {
        let path = folder.file("log", &file.bytes.repeat(20));
        let mut container = Container::open(&path).unwrap();
        let mut rows = 0;
        while rows < 30 {
            rows += usize::from(matches!(container.next().unwrap(), Event::Message(_)));
        }
        std::fs::OpenOptions::new()
            .write(true)
            .open(&path)
            .unwrap()
            .set_len(20)
            .unwrap();
        let begin = ThreadTime::now();
        let mut reported = false;
        while let Some(event) = container.next() {
            reported |= matches!(event, Event::Damage(_));
        }
        assert!(reported && begin.elapsed() < Duration::from_secs(1));
    }
}

/// A disk that fails at its `left`th call, reading or writing: from then on, or `once`.
struct Failing {
    inner: Cursor<Vec<u8>>,
    left: usize,
    once: bool,
}

impl Failing {
    fn call(&mut self) -> io::Result<()> {
        if let Some(left) = self.left.checked_sub(1) {
            self.left = left;
            return Ok(());
        }
        if self.once {
            self.left = usize::MAX;
        }
        Err(io::Error::from_raw_os_error(5))
    }

    /// The same for what writes.
    fn call_to_write(&mut self) -> io::Result<()> {
        let full = |_| io::Error::from(io::ErrorKind::StorageFull);
        self.call().map_err(full)
    }
}

impl Read for Failing {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.call()?;
        // little at a time: a file takes many calls
        let most = buffer.len().min(1000);
        self.inner.read(&mut buffer[..most])
    }
}

impl Write for Failing {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.call_to_write()?;
        self.inner.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.call_to_write()
    }
}

impl Seek for Failing {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}

#[test]
fn a_disk_that_fails_at_the_nth_read_is_reported() {
    for (file, _) in all() {
        let mut failures = 0;
        for left in 0.. {
            let inner = Cursor::new(file.bytes.clone());
            let source = Failing {
                inner,
                left,
                once: false,
            };
            let Ok(mut container) = Container::over(Path::new("disk"), source) else {
                failures += 1;
                continue;
            };
            let (mut rows, mut reported) = (0, false);
            while let Some(event) = container.next() {
                match event {
                    Event::Message(message) => {
                        assert!(file.rows[rows].3 == message.data);
                        rows += 1;
                    }
                    Event::Damage(damage) => reported |= damage.what.contains("os error 5"),
                }
            }
            if rows == file.rows.len() && !reported {
                break;
            }
            failures += 1;
            assert!(reported, "{left}");
        }
        assert!(failures > 0);
    }
}

#[test]
fn a_disk_that_is_full_at_the_nth_write_is_an_error_and_what_it_holds_is_read() {
    let folder = Folder::new("full");
    let mcap = written::mcap::write(plan(Packing::Zstd));
    let bag = written::bag::write(plan(Packing::None));
    // a disk that recovers does not hide the error: a later write that succeeds would
    let cases = [(&mcap, Format::Mcap), (&bag, Format::Bag)];
    for ((file, format), once) in cases
        .into_iter()
        .flat_map(|case| [(case, false), (case, true)])
    {
        let from = &folder.file("log", &file.bytes);
        let mut failures = 0;
        for left in 0.. {
            let mut disk = Failing {
                inner: Cursor::new(Vec::new()),
                left,
                once,
            };
            let done = copy(from, &mut disk, format, |_| ());
            let failed = disk.left > usize::MAX / 2;
            let held = disk.inner.into_inner();
            // Whatever it holds is a log as far as it goes.
            let rows = read(held).map(|(rows, _)| rows).unwrap_or_default();
            assert!(rows.iter().all(|row| file.rows.contains(row)));
            match done {
                Ok(copied) => {
                    assert!(!failed, "{format:?}: call {left} failed and nobody knows");
                    assert_eq!(copied.messages, file.rows.len() as u64);
                    assert_eq!(rows.len(), file.rows.len());
                    break;
                }
                Err(Error::Output(error)) => {
                    assert_eq!(error.kind(), io::ErrorKind::StorageFull);
                    failures += 1;
                }
                Err(other) => panic!("{other}"),
            }
        }
        assert!(failures > 0);
    }
}

#[test]
fn formats_of_tomorrow_are_refused_by_number() {
    for (bytes, found, known) in [
        (&b"\x89MCAP1\r\n........"[..], "1", "0"),
        (b"\x89MCAPZ\r\n........", "Z", "0"),
        (b"#ROSBAG V2.1\n.....", "2.1", "2.0"),
        (b"#ROSBAG V9.9\n.....", "9.9", "2.0"),
    ] {
        let refused = read(bytes.to_vec()).unwrap_err();
        let Error::Version {
            found: version,
            known: ours,
            ..
        } = &refused
        else {
            panic!("{refused}");
        };
        assert_eq!((version.as_str(), ours.as_str()), (found, known));
        assert!(refused.to_string().contains(found));
    }
    for bytes in [
        &b"\x89MCAP"[..],
        b"#ROSBAG",
        b"\x89MCAP0\r",
        b"MCAP0\r\n\x89",
        b"",
        b"PCAM\x890",
    ] {
        assert!(read(bytes.to_vec()).is_err(), "{bytes:?}");
    }
}
