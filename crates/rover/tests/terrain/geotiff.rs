//! `GeoTIFF`.

use grouser_rover::ground::{NoCell, TerrainFault};
use grouser_terra::OutOfRange;

use super::made::{
    BLACK, COMPRESSION, HEIGHT, KEYS, LENGTHS, NO_DATA, OFFSETS, ROWS_PER_STRIP, SCALE,
    TILE_LENGTHS, TILE_OFFSETS, Tiff, Value, WIDTH, heights, read, read_with_cell,
};

fn small() -> Tiff {
    Tiff::floats(5, 4, &heights(5, 4))
}

fn refused(tiff: &Tiff) -> TerrainFault {
    read("tif", &tiff.bytes()).unwrap_err()
}

fn no_cell(tiff: &Tiff) -> NoCell {
    match refused(tiff) {
        TerrainFault::NoCell { why } => {
            // with a cell of the scenario's own the same file is read
            assert!(read_with_cell("tif", &tiff.bytes()).is_ok());
            why
        }
        other => panic!("{other}"),
    }
}

/// Heights in the file's order, rows from the upper edge (greatest y) down.
fn looked_up(map: &grouser_rover::ground::HeightMap, columns: usize, rows: usize) -> Vec<f64> {
    let at = |row: usize, column: usize| {
        let y = 0.5 * ((rows - 1) as f64 * 0.5 - row as f64);
        map.height(0.5 * column as f64, y)
    };
    (0..rows)
        .flat_map(|row| (0..columns).map(move |column| (row, column)))
        .map(|(row, column)| at(row, column))
        .collect()
}

#[test]
fn every_cell_is_where_it_was_in_strips_and_in_tiles() {
    for (columns, rows) in [(5, 4), (16, 16), (17, 33), (40, 7)] {
        let truth = heights(columns, rows);
        let [wide, high] = [columns, rows].map(|n| u32::try_from(n).unwrap());
        let whole = Tiff::floats(wide, high, &truth);
        let mut by_rows = whole.clone().with(ROWS_PER_STRIP, Value::Long(vec![1]));
        by_rows.pieces = truth
            .chunks(columns)
            .map(|row| row.iter().flat_map(|h| h.to_le_bytes()).collect())
            .collect();
        let tiled = whole.clone().tiled((columns, rows), &truth, 77.0);
        for tiff in [whole, by_rows, tiled] {
            let map = read("tif", &tiff.bytes()).unwrap();
            let found = looked_up(&map, columns, rows);
            for (found, truth) in found.iter().zip(&truth) {
                assert!(
                    (found - f64::from(*truth)).abs() < 1e-6,
                    "{columns} x {rows}"
                );
            }
        }
    }
}

#[test]
fn whole_numbers_and_doubles() {
    let strip = |bytes: Vec<Vec<u8>>| bytes.concat();
    let values = [-7_i16, 0, 300, 12, 5, 9];
    let signed = Tiff::of(
        3,
        2,
        16,
        2,
        strip(values.iter().map(|v| v.to_le_bytes().into()).collect()),
    );
    let doubles = strip(
        values
            .iter()
            .map(|v| f64::from(*v).to_le_bytes().into())
            .collect(),
    );
    let double = Tiff::of(3, 2, 64, 3, doubles);
    for tiff in [signed, double] {
        let map = read("tif", &tiff.bytes()).unwrap();
        assert_eq!(looked_up(&map, 3, 2), values.map(f64::from));
    }
    // 64 bits of whole numbers are not heights
    let bytes = strip(
        values
            .iter()
            .map(|v| i64::from(*v).to_le_bytes().into())
            .collect(),
    );
    let wide = Tiff::of(3, 2, 64, 2, bytes);
    assert!(matches!(
        refused(&wide),
        TerrainFault::Samples { .. } | TerrainFault::Damaged { .. }
    ));
}

#[test]
fn two_to_the_31_by_two_to_the_31() {
    let side = 1_u32 << 31;
    let huge = small()
        .with(WIDTH, Value::Long(vec![side]))
        .with(HEIGHT, Value::Long(vec![side]));
    assert!(matches!(refused(&huge), TerrainFault::Damaged { .. }));
    // its one strip is as long as it: nothing contradicts the size but its limit
    let huge = huge.with(ROWS_PER_STRIP, Value::Long(vec![side]));
    let TerrainFault::Cells {
        columns,
        rows,
        limit,
    } = refused(&huge)
    else {
        panic!("{}", refused(&huge));
    };
    assert_eq!((columns, rows, limit), (1 << 31, 1 << 31, 1 << 25));
    for (tag, size) in [(WIDTH, 0), (HEIGHT, 0), (WIDTH, 1), (HEIGHT, 1)] {
        let flat = small().with(tag, Value::Long(vec![size]));
        assert!(matches!(
            refused(&flat),
            TerrainFault::Cells { .. } | TerrainFault::Damaged { .. }
        ));
    }
}

#[test]
fn a_tile_count_that_lies() {
    let truth = heights(40, 20);
    let tiff = Tiff::floats(40, 20, &truth).tiled((40, 20), &truth, 0.0);
    for count in [1_usize, 5, 7, 100_000] {
        for tag in [TILE_OFFSETS, TILE_LENGTHS] {
            let lying = tiff.clone().with(tag, Value::Long(vec![8; count]));
            let fault = refused(&lying);
            assert!(
                matches!(fault, TerrainFault::Count { field: "tiles", found, expected: 6 } if found == count as u64)
                    || matches!(fault, TerrainFault::Damaged { .. }),
                "{count}: {fault}"
            );
        }
    }
    for (tag, size) in [(322, 0), (323, 0), (322, u32::MAX), (323, 1 << 26)] {
        let lying = tiff.clone().with(tag, Value::Long(vec![size]));
        let fault = refused(&lying);
        assert!(
            matches!(
                fault,
                TerrainFault::OutOfRange(_)
                    | TerrainFault::Cells { .. }
                    | TerrainFault::Damaged { .. }
            ),
            "{tag} {size}: {fault}"
        );
    }
    let lying = small().with(ROWS_PER_STRIP, Value::Long(vec![0]));
    assert!(matches!(
        refused(&lying),
        TerrainFault::OutOfRange(OutOfRange {
            field: "RowsPerStrip",
            ..
        }) | TerrainFault::Damaged { .. }
    ));
}

#[test]
fn a_strip_beyond_the_end() {
    for start in [100_000_u32, u32::MAX] {
        let lying = small().with(OFFSETS, Value::Long(vec![start]));
        let fault = refused(&lying);
        assert!(
            matches!(
                fault,
                TerrainFault::OutOfRange(OutOfRange { field: "StripOffsets", value, unit: "byte", .. })
                    if value == f64::from(start)
            ),
            "{fault}"
        );
    }
    // fewer bytes than its cells need, and more than there are
    for length in [4_u32, 79] {
        let lying = small().with(LENGTHS, Value::Long(vec![length]));
        assert_eq!(
            refused(&lying),
            TerrainFault::Count {
                field: "bytes in a piece",
                found: u64::from(length),
                expected: 80
            }
        );
    }
    let lying = small().with(LENGTHS, Value::Long(vec![u32::MAX]));
    assert!(matches!(
        refused(&lying),
        TerrainFault::OutOfRange(OutOfRange {
            field: "StripOffsets",
            ..
        })
    ));
}

/// No data, NaN and missing tiles: never a height of 0, and marked.
#[test]
fn no_data_is_no_height() {
    let mut truth = heights(5, 4);
    for height in &mut truth {
        *height += 100.0;
    }
    let marked = [-9999.0_f32, f32::NAN, f32::MIN];
    let texts = ["-9999", "nan", "-3.4028234663852886e+38"];
    for (nothing, text) in marked.into_iter().zip(texts) {
        let mut holed = truth.clone();
        holed[7] = nothing;
        holed[8] = f32::NAN;
        let tiff = Tiff::floats(5, 4, &holed).with(NO_DATA, Value::Text(text.into()));
        let map = read("tif", &tiff.bytes()).unwrap();
        // row 1, columns 2 and 3
        for x in [1.0, 1.5] {
            assert!(!map.known(x, 0.25), "{text}: {x}");
            assert!(
                map.height(x, 0.25) > 90.0,
                "{text}: {}",
                map.height(x, 0.25)
            );
        }
        assert!(map.known(0.0, 0.75));
    }
    // numbers that no ground has and files write for no data are unknown without the tag
    let mut holed = truth.clone();
    for nothing in [f32::MIN, f32::MAX, -9999.0, -32_768.0, -32_767.0] {
        holed[7] = nothing;
        let map = read("tif", &Tiff::floats(5, 4, &holed).bytes()).unwrap();
        assert!(!map.known(1.0, 0.25) && map.known(1.5, 0.25), "{nothing}");
    }
    // the heights next to them are heights
    for height in [-9998.0, 32_767.0, 1e6] {
        holed[7] = height;
        let map = read("tif", &Tiff::floats(5, 4, &holed).bytes()).unwrap();
        assert!(map.known(1.0, 0.25), "{height}");
    }
    // infinite is not unknown
    holed[7] = f32::INFINITY;
    let fault = refused(&Tiff::floats(5, 4, &holed));
    assert!(
        matches!(
            fault,
            TerrainFault::OutOfRange(OutOfRange {
                field: "height",
                ..
            })
        ),
        "{fault}"
    );
    // nothing known at all
    let fault = refused(&Tiff::floats(5, 4, &[f32::NAN; 20]));
    assert!(
        matches!(
            fault,
            TerrainFault::OutOfRange(OutOfRange {
                field: "known heights",
                ..
            })
        ),
        "{fault}"
    );
}

#[test]
fn a_tile_that_the_file_leaves_out_is_unknown() {
    let truth: Vec<f32> = heights(40, 20).iter().map(|h| h + 50.0).collect();
    let tiff = Tiff::floats(40, 20, &truth).tiled((40, 20), &truth, 0.0);
    let size = 16 * 16 * 4;
    let sparse = tiff
        .clone()
        .with(
            TILE_LENGTHS,
            Value::Long(vec![size, 0, size, size, size, size]),
        )
        .with(TILE_OFFSETS, {
            let start = |i: u32| 8 + i * size;
            Value::Long(vec![start(0), 0, start(2), start(3), start(4), start(5)])
        });
    let map = read("tif", &sparse.bytes()).unwrap();
    let whole = read("tif", &tiff.bytes()).unwrap();
    // the second tile of the upper row: columns 16 to 31, rows 0 to 15
    for (column, row, known) in [
        (15, 3, true),
        (20, 3, false),
        (31, 15, false),
        (32, 3, true),
        (20, 16, true),
    ] {
        let (x, y) = (0.5 * f64::from(column), 0.5 * (9.5 - f64::from(row)));
        assert_eq!(map.known(x, y), known, "column {column}, row {row}");
        assert!(map.height(x, y) > 40.0);
        if known {
            assert!((map.height(x, y) - whole.height(x, y)).abs() < 1e-6);
        }
    }
}

#[test]
fn a_missing_system_of_coordinates() {
    assert_eq!(no_cell(&small().without(KEYS)), NoCell::NoSystem);
    let odd = small().with(KEYS, Value::Short(vec![1, 1, 0]));
    assert_eq!(no_cell(&odd), NoCell::NoSystem);
    assert_eq!(no_cell(&small().without(SCALE)), NoCell::NoScale);
}

#[test]
fn degrees_and_feet_are_not_metres() {
    let with_keys = |keys: &[u16]| {
        let mut all = vec![1, 1, 0, u16::try_from(keys.len() / 4).unwrap()];
        all.extend(keys);
        small().with(KEYS, Value::Short(all))
    };
    assert_eq!(no_cell(&with_keys(&[1024, 0, 1, 2])), NoCell::Degrees);
    let feet = with_keys(&[1024, 0, 1, 1, 3076, 0, 1, 9003]);
    assert_eq!(no_cell(&feet), NoCell::Unit { code: 9003 });
    let metres = with_keys(&[
        1024, 0, 1, 1, 3072, 0, 1, 32_632, 3076, 0, 1, 9001, 4099, 0, 1, 9001,
    ]);
    assert!(read("tif", &metres.bytes()).is_ok());
    let high_feet = with_keys(&[1024, 0, 1, 1, 3072, 0, 1, 32_632, 4099, 0, 1, 9002]);
    // a cell of the scenario's own says nothing of heights
    assert!(read_with_cell("tif", &high_feet.bytes()).is_err());
    // and what is said names value and unit
    assert!(refused(&high_feet).to_string().contains("9002"));
}

#[test]
fn scales_that_are_none() {
    for (x, y) in [(0.5, 0.6), (f64::NAN, 0.5), (0.5, f64::NAN)] {
        let tiff = small().with(SCALE, Value::Double(vec![x, y, 0.0]));
        assert!(matches!(
            refused(&tiff),
            TerrainFault::NoCell {
                why: NoCell::NotSquare { .. }
            }
        ));
    }
    for cell in [0.0, 1e-9, 2e3] {
        let tiff = small().with(SCALE, Value::Double(vec![cell, cell, 0.0]));
        let fault = refused(&tiff);
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
    // a matrix in the place of the scale; one that turns is refused
    let mut matrix = vec![0.0; 16];
    (matrix[0], matrix[5], matrix[15]) = (0.5, -0.5, 1.0);
    let straight = small()
        .without(SCALE)
        .with(34_264, Value::Double(matrix.clone()));
    let map = read("tif", &straight.bytes()).unwrap();
    assert_eq!(
        looked_up(&map, 5, 4),
        heights(5, 4)
            .iter()
            .map(|h| f64::from(*h))
            .collect::<Vec<_>>()
    );
    matrix[1] = 0.1;
    let turned = small().without(SCALE).with(34_264, Value::Double(matrix));
    for found in [
        read("tif", &turned.bytes()),
        read_with_cell("tif", &turned.bytes()),
    ] {
        let fault = found.unwrap_err();
        assert!(matches!(fault, TerrainFault::Tag { .. }), "{fault}");
    }
}

#[test]
fn colours_white_as_lowest_and_unknown_codes_are_refused() {
    let upside_down = small().with(BLACK, Value::Short(vec![0]));
    assert!(matches!(
        refused(&upside_down),
        TerrainFault::Samples { .. } | TerrainFault::Damaged { .. }
    ));
    let coloured = small()
        .with(BLACK, Value::Short(vec![2]))
        .with(277, Value::Short(vec![3]));
    assert!(matches!(
        refused(&coloured),
        TerrainFault::Samples { .. } | TerrainFault::Damaged { .. }
    ));
    let packed = small().with(COMPRESSION, Value::Short(vec![34_712]));
    assert!(matches!(refused(&packed), TerrainFault::Damaged { .. }));
}
