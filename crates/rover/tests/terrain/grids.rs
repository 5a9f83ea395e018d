//! Pictures and ASCII grids.

use grouser_terra::OutOfRange;
use std::fmt::Write as _;

use grouser_rover::ground::{NoCell, TerrainFault};
use png::{BitDepth, ColorType};

use super::made::{SMALL_GRID, png, read, read_with_cell, small_png};
use crate::processor_time::ThreadTime;

fn grid_refused(text: &str) -> TerrainFault {
    read("asc", text.as_bytes()).unwrap_err()
}

#[test]
fn a_picture_of_16_bits() {
    let map = read_with_cell("png", &small_png()).unwrap();
    // 1 cm a step; row 0 is the upper edge, y = 0.75
    for (row, column) in [(0, 0), (0, 4), (2, 1), (3, 4)] {
        let height = map.height(0.5 * f64::from(column), 0.5 * (1.5 - f64::from(row)));
        let truth = 10.0 * f64::from(5 * row + column);
        assert!((height - truth).abs() < 1e-4, "{row} {column}: {height}");
    }
    assert_eq!(
        read("png", &small_png()).unwrap_err(),
        TerrainFault::NoCell {
            why: NoCell::Picture
        }
    );
}

#[test]
fn transparent_pixels_are_unknown() {
    let grey = [100_u8, 255, 90, 0, 80, 255, 70, 255];
    let map = read_with_cell(
        "png",
        &png(2, 2, ColorType::GrayscaleAlpha, BitDepth::Eight, &grey),
    )
    .unwrap();
    assert!(map.known(0.0, 0.25) && !map.known(0.5, 0.25));
    assert!(map.height(0.5, 0.25) > 0.69);
    // one grey level that stands for transparent
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, 2, 2);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Sixteen);
    encoder.set_trns(vec![0x12, 0x34]);
    let mut writer = encoder.write_header().unwrap();
    writer
        .write_image_data(&[1, 0, 0x12, 0x34, 1, 0, 1, 0])
        .unwrap();
    writer.finish().unwrap();
    let map = read_with_cell("png", &out).unwrap();
    assert!(map.known(0.0, 0.25) && !map.known(0.5, 0.25));
    assert!((map.height(0.5, 0.25) - 2.56).abs() < 1e-6);
}

#[test]
fn pictures_that_are_no_heights() {
    for (color, depth, data) in [
        (ColorType::Rgb, BitDepth::Eight, vec![0; 12]),
        (ColorType::Rgba, BitDepth::Sixteen, vec![0; 32]),
        (ColorType::Grayscale, BitDepth::Four, vec![0; 2]),
        (ColorType::Grayscale, BitDepth::One, vec![0; 2]),
    ] {
        let fault = read_with_cell("png", &png(2, 2, color, depth, &data)).unwrap_err();
        assert!(matches!(fault, TerrainFault::Samples { .. }), "{fault}");
    }
    let line = png(4, 1, ColorType::Grayscale, BitDepth::Eight, &[0; 4]);
    let fault = read_with_cell("png", &line).unwrap_err();
    assert!(matches!(
        fault,
        TerrainFault::Cells {
            columns: 4,
            rows: 1,
            ..
        }
    ));
}

/// The header of a picture says 2³¹ − 1 by as many, with its checksum right.
#[test]
fn a_picture_of_two_to_the_31() {
    let mut bytes = small_png();
    let side = i32::MAX.to_be_bytes();
    bytes[16..20].copy_from_slice(&side);
    bytes[20..24].copy_from_slice(&side);
    let crc = crc32(&bytes[12..29]).to_be_bytes();
    bytes[29..33].copy_from_slice(&crc);
    let fault = read_with_cell("png", &bytes).unwrap_err();
    assert!(
        matches!(
            fault,
            TerrainFault::Cells { .. } | TerrainFault::Damaged { .. }
        ),
        "{fault}"
    );
}

/// CRC-32 as PNG has it (ISO 3309).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 * (crc & 1))
        })
    })
}

#[test]
fn a_grid_and_its_unknown_cells() {
    let map = read("asc", SMALL_GRID.as_bytes()).unwrap();
    assert!((map.height(0.0, 0.25) - 1.5).abs() < 1e-6);
    assert!((map.height(1.0, -0.25) - 6.0).abs() < 1e-6);
    assert!(!map.known(1.0, 0.25) && map.known(0.5, 0.25));
    assert!(map.height(1.0, 0.25) > 2.0);
    // another number for no data, and NaN without any
    let other = SMALL_GRID.replace("-9999", "0").replace("2.5", "NaN");
    let map = read("asc", other.as_bytes()).unwrap();
    assert!(!map.known(1.0, 0.25) && !map.known(0.5, 0.25));
    assert!((map.height(1.0, 0.25) - 1.5).abs() < 1e-6);
}

#[test]
fn grids_that_lie() {
    let changed = |from: &str, to: &str| grid_refused(&SMALL_GRID.replace(from, to));
    let side = "ncols 2147483648";
    let fault = grid_refused(
        &SMALL_GRID
            .replace("ncols 3", side)
            .replace("nrows 2", "nrows 2147483648"),
    );
    assert!(matches!(
        fault,
        TerrainFault::OutOfRange(OutOfRange { field: "ncols", value, unit: "1", .. }) if value == 2_147_483_648.0
    ));
    // within a header's limits, yet more than a map holds
    let fault = grid_refused(
        &SMALL_GRID
            .replace("ncols 3", "ncols 100000")
            .replace("nrows 2", "nrows 100000"),
    );
    assert!(matches!(
        fault,
        TerrainFault::Cells {
            columns: 100_000,
            rows: 100_000,
            ..
        }
    ));
    for (from, to) in [
        ("ncols 3", "ncols 2.5"),
        ("ncols 3", "ncols nan"),
        ("nrows 2", "nrows -2"),
        ("nrows 2", "nrows 1e400"),
    ] {
        assert!(
            matches!(changed(from, to), TerrainFault::OutOfRange(_)),
            "{to}"
        );
    }
    assert_eq!(
        changed("nrows 2", "nrows 3"),
        TerrainFault::Count {
            field: "heights",
            found: 6,
            expected: 9
        }
    );
    assert_eq!(
        changed("ncols 3", "ncols 2"),
        TerrainFault::Count {
            field: "heights",
            found: 5,
            expected: 4
        }
    );
    for (line, field) in [
        ("ncols 3\n", "ncols"),
        ("nrows 2\n", "nrows"),
        ("cellsize 0.5\n", "cellsize"),
    ] {
        assert_eq!(changed(line, ""), TerrainFault::Missing { field });
    }
    assert_eq!(
        changed("5e0", "five"),
        TerrainFault::NotANumber {
            word: "five".into(),
            row: 2,
            column: 2
        }
    );
    assert_eq!(
        changed("cellsize", "cell"),
        TerrainFault::Header {
            word: "cell".into()
        }
    );
    for (to, field) in [("1e30", "height"), ("inf", "height")] {
        assert!(
            matches!(changed("5e0", to), TerrainFault::OutOfRange(OutOfRange { field: found, .. }) if found == field)
        );
    }
    for cell in ["0", "-1", "nan", "1e9"] {
        let fault = changed("cellsize 0.5", &format!("cellsize {cell}"));
        assert!(
            matches!(
                fault,
                TerrainFault::OutOfRange(OutOfRange {
                    field: "cell",
                    unit: "m",
                    ..
                })
            ),
            "{fault}"
        );
    }
}

#[test]
fn a_grid_in_degrees_differs_from_one_in_metres() {
    let with = |corner: [&str; 2], cell: &str| {
        let text = SMALL_GRID
            .replace("xllcorner 0", &format!("xllcorner {}", corner[0]))
            .replace("yllcorner 0", &format!("yllcorner {}", corner[1]))
            .replace("cellsize 0.5", &format!("cellsize {cell}"));
        (
            read("asc", text.as_bytes()).map(|_| ()),
            read_with_cell("asc", text.as_bytes()).is_ok(),
        )
    };
    // 1/3, 1, 3 and 30 seconds of arc, as elevation models have them
    for cell in [
        "9.25925926e-5",
        "0.000277777777778",
        "0.00083333333333333",
        "0.008333333333",
    ] {
        let (found, with_cell) = with(["8.5", "47.2"], cell);
        let fault = found.unwrap_err();
        assert!(
            matches!(
                fault,
                TerrainFault::NoCell {
                    why: NoCell::LooksLikeDegrees { .. }
                }
            ),
            "{cell}: {fault}"
        );
        assert!(with_cell);
    }
    // a sandbox that was scanned, and a national grid
    for (corner, cell) in [
        (["0", "0"], "0.01"),
        (["2600000", "1200000"], "0.01"),
        (["8.5", "47.2"], "0.5"),
    ] {
        assert_eq!(with(corner, cell).0, Ok(()), "{corner:?} {cell}");
    }
}

/// 5 000 × 5 000 are read, and a small file that announces as many is refused at once.
#[test]
fn limits_of_time() {
    let begun = ThreadTime::now();
    let mut text = String::from("ncols 5000\nnrows 5000\ncellsize 0.1\n");
    let fault = grid_refused(&text);
    assert!(matches!(
        fault,
        TerrainFault::Count {
            found: 0,
            expected: 25_000_000,
            ..
        }
    ));
    assert!(begun.elapsed().as_secs_f64() < 1.0);
    text = String::from("ncols 500\nnrows 500\ncellsize 0.1\n");
    for i in 0..250_000 {
        let _ = write!(text, "{} ", i % 997);
    }
    let map = read("asc", text.as_bytes()).unwrap();
    assert!((map.height(0.1, 24.95) - 1.0).abs() < 1e-6);
}
