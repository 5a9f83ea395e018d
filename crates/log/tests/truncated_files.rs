//! Files of 64 KiB cut at every byte. A part of the cuts runs always; all of them by `just dense`.

use std::time::Duration;

use crate::processor_time::ThreadTime;
use crate::written;
use crate::written::{Packing, Plan, Written, cases, read};

/// Chunks of several blocks, where the packing has blocks that can be read alone.
fn plan(packing: Packing) -> Plan {
    let (chunk, alike) = match packing {
        Packing::None | Packing::Bz2 => (6 << 10, 60),
        Packing::Lz4 | Packing::Zstd => (300 << 10, 460),
    };
    Plan {
        packing,
        bytes: 64 << 10,
        chunk,
        alike,
    }
}

fn cut_everywhere(file: &Written, step: usize) {
    assert!(
        file.bytes.len() >= 64 << 10 && file.chunks.len() >= 2,
        "{} bytes",
        file.bytes.len()
    );
    let (whole, damages) = read(file.bytes.clone()).unwrap();
    assert_eq!(
        (whole.len(), damages.len()),
        (file.rows.len(), 0),
        "{damages:?}"
    );
    assert!(whole == file.rows);
    let (mut count, mut longest) = (0, Duration::ZERO);
    for cut in cases(file.bytes.len(), step) {
        count += 1;
        let begin = ThreadTime::now();
        let Ok((rows, damages)) = read(file.bytes[..cut].to_vec()) else {
            assert!(cut < 16, "cut at {cut}: no log");
            continue;
        };
        longest = longest.max(begin.elapsed());
        let (least, most) = file.readable(cut);
        let expected = least..=most;
        assert!(
            expected.contains(&rows.len()),
            "cut at {cut}: {} of {expected:?}, {damages:?}",
            rows.len()
        );
        assert!(rows == file.rows[..rows.len()], "cut at {cut}: other data");
        assert!(
            rows.len() == file.rows.len() || !damages.is_empty(),
            "cut at {cut}: silent"
        );
        for damage in &damages {
            assert!(
                damage.offset + damage.bytes <= cut as u64,
                "cut at {cut}: {damage:?}"
            );
        }
        // What was cut is reported from the place on where the record began that the cut is in.
        if let Some(open) = file.chunks.iter().find(|chunk| chunk.record.contains(&cut))
            && cut > open.record.start
        {
            let at = (open.record.start as u64, (cut - open.record.start) as u64);
            let reported = damages
                .iter()
                .any(|damage| (damage.offset, damage.bytes) == at);
            assert!(
                reported,
                "cut at {cut}, in the chunk at {}: {damages:?}",
                open.record.start
            );
        }
    }
    println!(
        "{:?}: {count} cuts, the longest reading {longest:?}",
        file.packing
    );
    assert!(longest < Duration::from_secs(1));
}

#[test]
fn mcap_cut_at_every_byte() {
    cut_everywhere(&written::mcap::write(plan(Packing::None)), 37);
}

#[test]
fn mcap_lz4_cut_at_every_byte() {
    cut_everywhere(&written::mcap::write(plan(Packing::Lz4)), 151);
}

#[test]
fn mcap_zstd_cut_at_every_byte() {
    cut_everywhere(&written::mcap::write(plan(Packing::Zstd)), 151);
}

#[test]
fn bag_cut_at_every_byte() {
    cut_everywhere(&written::bag::write(plan(Packing::None)), 37);
}

#[test]
fn bag_lz4_cut_at_every_byte() {
    cut_everywhere(&written::bag::write(plan(Packing::Lz4)), 151);
}

#[test]
fn bag_bz2_cut_at_every_byte() {
    cut_everywhere(&written::bag::write(plan(Packing::Bz2)), 151);
}
