//! Whatever is wrong with a file, what is written of it reads without damage and is the same.

use std::fs::{self, File};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use grouser_log::container::{Container, Event, Format};
use grouser_log::write::{copy, verify};
use proptest::prelude::*;

use crate::others_files::shipped;
use crate::scratch::Folder;

/// Written by others (`interop/write.py`).
const FILES: [(&str, Format); 6] = [
    ("joints_none.mcap", Format::Mcap),
    ("joints_lz4.mcap", Format::Mcap),
    ("joints_zstd.mcap", Format::Mcap),
    ("joints_none.bag", Format::Bag),
    ("joints_bz2.bag", Format::Bag),
    ("joints_lz4.bag", Format::Bag),
];

/// Each case has a folder of its own.
static CASE: AtomicUsize = AtomicUsize::new(0);

/// Messages and damages of a file.
fn counts(path: &Path) -> (u64, u64) {
    let mut container = Container::open(path).unwrap();
    let (mut messages, mut damages) = (0, 0);
    while let Some(event) = container.next() {
        match event {
            Event::Message(_) => messages += 1,
            Event::Damage(_) => damages += 1,
        }
    }
    (messages, damages)
}

#[test]
fn a_whole_file_stays_whole() {
    let folder = Folder::new("e7-whole");
    for (name, format) in FILES {
        let out = folder.0.join("out");
        let copied = copy(&shipped(name), File::create(&out).unwrap(), format, |_| ()).unwrap();
        assert!(!copied.is_partial(), "{name}: {copied:?}");
        verify(&out, &copied).unwrap();
        assert_eq!(counts(&out), (40, 0), "{name}");
        // And follows whose conventions it followed.
        let profile = |path: &Path| {
            let mut container = Container::open(path).unwrap();
            container.next();
            container.profile().to_owned()
        };
        assert_eq!(profile(&out), profile(&shipped(name)), "{name}");
        assert!(profile(&out).starts_with("ros"), "{name}");
    }
}

#[test]
fn what_was_not_written_as_read_is_reported() {
    let folder = Folder::new("e7-differs");
    let out = folder.0.join("out");
    let source = shipped("joints_none.bag");
    let copied = copy(&source, File::create(&out).unwrap(), Format::Bag, |_| ()).unwrap();
    // A disk that loses the end, and one that changes a byte in a chunk.
    let whole = fs::read(&out).unwrap();
    fs::write(&out, &whole[..whole.len() / 2]).unwrap();
    verify(&out, &copied).unwrap_err();
    let mut changed = whole.clone();
    changed[4096 + 600] ^= 1;
    fs::write(&out, &changed).unwrap();
    verify(&out, &copied).unwrap_err();
    fs::write(&out, &whole).unwrap();
    verify(&out, &copied).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn whatever_is_damaged_the_copy_is_whole(
        file in 0..FILES.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        cut in any::<prop::sample::Index>(),
        cuts in any::<bool>(),
        twice in any::<bool>(),
    ) {
        let (name, format) = FILES[file];
        let folder = Folder::new(&format!("e7-{}", CASE.fetch_add(1, Ordering::Relaxed)));
        let mut bytes = fs::read(shipped(name)).unwrap();
        if twice {
            bytes.extend_from_within(..);
        }
        for (at, byte) in changes {
            // The first bytes say what kind of file it is.
            let at = 16 + at.index(bytes.len() - 16);
            bytes[at] = byte;
        }
        if cuts {
            bytes.truncate(16 + cut.index(bytes.len() - 16));
        }
        let source = folder.file("source", &bytes);
        let out = folder.0.join("out");
        let copied = copy(&source, File::create(&out).unwrap(), format, |_| ());
        // What a bag cannot hold is refused, as an error of the output.
        let Ok(copied) = copied else { return Ok(()) };
        let (messages, damages) = counts(&source);
        prop_assert_eq!((copied.messages, copied.damage_count), (messages, damages));
        prop_assert!(verify(&out, &copied).is_ok(), "{:?}", verify(&out, &copied));
        prop_assert_eq!(counts(&out), (messages, 0));
    }
}
