//! Files cut at every byte and with every bit turned: heights or a typed refusal, never a panic or a hang.

use std::time::Duration;

use grouser_rover::ground::HeightMap;

use super::made::{SMALL_GRID, Tiff, heights, read_with_cell, small_png};
use crate::processor_time::ThreadTime;

/// Every height that is read is a number that the map's limits allow.
fn look(map: &HeightMap) {
    for i in 0..12 {
        for j in -6..6 {
            let height = map.height(0.37 * f64::from(i), 0.41 * f64::from(j));
            assert!(height.is_finite() && height.abs() <= 1e6);
        }
    }
}

/// Cuts and turned bits; gives how many were read and how many refused.
fn damaged(ending: &str, whole: &[u8]) -> (usize, usize) {
    let (mut read, mut refused, mut slowest) = (0, 0, Duration::ZERO);
    let mut try_one = |bytes: &[u8]| {
        let begun = ThreadTime::now();
        match read_with_cell(ending, bytes) {
            Ok(map) => {
                look(&map);
                read += 1;
            }
            Err(fault) => {
                assert!(!fault.to_string().is_empty());
                refused += 1;
            }
        }
        slowest = slowest.max(begun.elapsed());
    };
    for end in 0..whole.len() {
        try_one(&whole[..end]);
    }
    for bit in 0..8 * whole.len() {
        let mut bytes = whole.to_vec();
        bytes[bit / 8] ^= 1 << (bit % 8);
        try_one(&bytes);
    }
    assert!(slowest < Duration::from_secs(2), "{ending}: {slowest:?}");
    (read, refused)
}

#[test]
fn every_cut_and_every_bit_of_a_geotiff() {
    let truth = heights(5, 4);
    let strips = Tiff::floats(5, 4, &truth).bytes();
    let tiles = Tiff::floats(18, 3, &heights(18, 3))
        .tiled((18, 3), &heights(18, 3), 0.0)
        .bytes();
    for whole in [strips, tiles] {
        let (read, refused) = damaged("tif", &whole);
        // a bit of a height makes another height; one of a tag makes nonsense
        assert!(read > 20 && refused > whole.len(), "{read} {refused}");
    }
}

#[test]
fn every_cut_and_every_bit_of_a_picture() {
    let (read, refused) = damaged("png", &small_png());
    // its checksums leave little: no height changes unseen
    assert!(refused > 500 && read < 200, "{read} {refused}");
}

#[test]
fn every_cut_and_every_bit_of_a_grid() {
    let (read, refused) = damaged("asc", SMALL_GRID.as_bytes());
    assert!(
        read > 20 && refused > SMALL_GRID.len() / 2,
        "{read} {refused}"
    );
}

/// Every tag of a small file in turn holds the greatest and the least number.
#[test]
fn tags_that_hold_extremes() {
    let whole = Tiff::floats(5, 4, &heights(5, 4)).bytes();
    let at = u32::from_le_bytes(whole[4..8].try_into().unwrap()) as usize;
    let count = usize::from(u16::from_le_bytes(whole[at..at + 2].try_into().unwrap()));
    for entry in 0..count {
        let begin = at + 2 + 12 * entry;
        for field in [0..2, 2..4, 4..8, 8..12] {
            for byte in [0, 0x7f, 0xff] {
                let mut bytes = whole.clone();
                bytes[begin + field.start..begin + field.end].fill(byte);
                let begun = ThreadTime::now();
                if let Ok(map) = read_with_cell("tif", &bytes) {
                    look(&map);
                }
                assert!(
                    begun.elapsed() < Duration::from_secs(2),
                    "{entry} {field:?} {byte}"
                );
            }
        }
    }
}
