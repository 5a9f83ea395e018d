//! A height map out of any bytes, as picture, grid and `GeoTIFF`: finite heights, or a refusal with words.
use std::path::PathBuf;

use grouser_rover::ground::{HeightFile, parse_heights};

const ENDINGS: [&str; 3] = ["tif", "png", "asc"];

pub fn run(bytes: &[u8]) {
    let Some((&kind, bytes)) = bytes.split_first() else {
        return;
    };
    let file = HeightFile {
        path: PathBuf::from("ground").with_extension(ENDINGS[usize::from(kind) % ENDINGS.len()]),
        cell: (kind & 0x80 == 0).then_some(0.5),
        height_step: 0.01,
    };
    match parse_heights(bytes, &file) {
        Ok(map) => {
            let ((left, low), (right, high)) = map.extent();
            for i in 0..=8 {
                for j in 0..=8 {
                    let x = left + (right - left) * f64::from(i) / 8.0;
                    let y = low + (high - low) * f64::from(j) / 8.0;
                    let height = map.height(x, y);
                    assert!(height.is_finite() && height.abs() <= 1e6);
                }
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
