//! Every bit of files of 16 KiB flipped. A part of the bits runs always; all of them by
//! `just dense`.

use std::time::Duration;

use grouser_log::container::Damage;

use crate::processor_time::ThreadTime;
use crate::written;
use crate::written::{Packing, Plan, Row, Written, cases, read};

fn plan(packing: Packing) -> Plan {
    Plan {
        packing,
        bytes: 16 << 10,
        chunk: 3 << 10,
        alike: 60,
    }
}

/// Which of the file's messages are lost, and how many are there that it never had.
fn compare(file: &Written, rows: &[Row]) -> (Vec<usize>, usize) {
    let (mut lost, mut strange, mut next) = (Vec::new(), 0, 0);
    for row in rows {
        match file.rows[next..].iter().position(|other| other == row) {
            Some(ahead) => {
                lost.extend(next..next + ahead);
                next += ahead + 1;
            }
            None => strange += 1,
        }
    }
    lost.extend(next..file.rows.len());
    (lost, strange)
}

/// Flips bits; `checked`: does the packing tell by a checksum when its content is not as it was?
fn flip_everywhere(file: &Written, step: usize, magic: usize, checked: bool) {
    assert!(file.bytes.len() >= 16 << 10 && file.chunks.len() >= 3);
    let (mut count, mut longest) = (0, Duration::ZERO);
    for bit in cases(file.bytes.len() * 8, step) {
        count += 1;
        let (byte, mut bytes) = (bit / 8, file.bytes.clone());
        bytes[byte] ^= 1 << (bit % 8);
        let begin = ThreadTime::now();
        let Ok((rows, damages)) = read(bytes) else {
            assert!(byte < magic, "bit {bit}: refused");
            continue;
        };
        longest = longest.max(begin.elapsed());
        let (lost, strange) = compare(file, &rows);
        let hit = file
            .chunks
            .iter()
            .find(|chunk| chunk.with_index.contains(&byte));
        if checked {
            assert_eq!(strange, 0, "bit {bit}: other data; {damages:?}");
            assert!(
                lost.is_empty() || !damages.is_empty(),
                "bit {bit}: {lost:?} silently lost"
            );
        }
        // The other chunks are read.
        for row in &lost {
            let own = hit.is_some_and(|chunk| chunk.rows.contains(row));
            // Without a checksum a topic may be another; the copy at the end contradicts.
            let renamed = |damage: &Damage| damage.what.contains("declared again");
            let reported = !checked && damages.iter().any(renamed);
            assert!(
                own || reported,
                "bit {bit} (byte {byte}) loses message {row}: {damages:?}"
            );
        }
        let in_content = hit.filter(|chunk| chunk.packed.contains(&byte));
        if let Some(chunk) = in_content.filter(|_| checked && !lost.is_empty()) {
            let named = damages.iter().any(|damage| {
                let reason = ["CRC", "decompressed", "holds"];
                let reason = reason.iter().any(|word| damage.what.contains(word));
                let messages = damage.messages == Some(chunk.rows.len() as u64)
                    || damage.messages == Some(lost.len() as u64);
                reason && messages && damage.offset == chunk.record.start as u64
            });
            assert!(named, "bit {bit}: {damages:?}");
        }
    }
    println!(
        "{:?}: {count} bits, the longest reading {longest:?}",
        file.packing
    );
    assert!(longest < Duration::from_secs(1));
}

#[test]
fn mcap_every_bit_flipped() {
    flip_everywhere(&written::mcap::write(plan(Packing::None)), 29, 8, true);
}

#[test]
fn mcap_lz4_every_bit_flipped() {
    flip_everywhere(&written::mcap::write(plan(Packing::Lz4)), 29, 8, true);
}

#[test]
fn mcap_zstd_every_bit_flipped() {
    flip_everywhere(&written::mcap::write(plan(Packing::Zstd)), 29, 8, true);
}

#[test]
fn bag_every_bit_flipped() {
    flip_everywhere(&written::bag::write(plan(Packing::None)), 29, 13, false);
}

#[test]
fn bag_lz4_every_bit_flipped() {
    flip_everywhere(&written::bag::write(plan(Packing::Lz4)), 29, 13, true);
}

#[test]
fn bag_bz2_every_bit_flipped() {
    flip_everywhere(&written::bag::write(plan(Packing::Bz2)), 61, 13, true);
}
