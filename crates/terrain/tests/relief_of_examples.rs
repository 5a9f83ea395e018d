//! The generated relief of `examples/terrain`: the files have the heights of the shapes that they are said to
//! have. `GROUSER_WRITE_EXAMPLES=1 cargo test -p grouser-terrain --test all relief_of_examples::` writes them anew.

use std::fmt::Write as _;
use std::fs;

use grouser_rover::ground::{Craters, HeightFile, Shape, read_heights};

/// Craters of 1 to 12 m in equilibrium: 64 x 48 cells of 0.5 m.
const CRATERS: Shape = Shape::Craters(Craters {
    density: Craters::EQUILIBRIUM_DENSITY,
    min_diameter: 1.0,
    max_diameter: 12.0,
});
const SEED: u64 = 12;
const COLUMNS: u32 = 64;
const ROWS: u32 = 48;
const CELL_M: f64 = 0.5;

#[test]
fn craters_asc_is_the_field_of_craters_of_its_seed() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/terrain/craters.asc"
    );
    // centres of cells, the first row at the upper edge
    let height = |column: u32, row: u32| {
        let x = (f64::from(column) + 0.5) * CELL_M;
        let y = (f64::from(ROWS - row) - 0.5) * CELL_M;
        CRATERS.height(SEED, x, y)
    };
    if std::env::var_os("GROUSER_WRITE_EXAMPLES").is_some() {
        let mut text =
            format!("ncols {COLUMNS}\nnrows {ROWS}\nxllcorner 0\nyllcorner 0\ncellsize {CELL_M}\n");
        for row in 0..ROWS {
            let heights = (0..COLUMNS).map(|column| format!("{:.3}", height(column, row)));
            let _ = writeln!(text, "{}", heights.collect::<Vec<_>>().join(" "));
        }
        fs::write(path, text).unwrap();
    }
    let file = HeightFile {
        path: path.into(),
        cell: None,
        height_step: 0.001,
    };
    let relief = read_heights(&file).unwrap();
    assert_eq!(relief.cells(), (COLUMNS * ROWS) as usize);
    // nodes begin at the lower left one
    for index in 0..COLUMNS * ROWS {
        let (column, row) = (index % COLUMNS, ROWS - 1 - index / COLUMNS);
        let (x, y) = relief.centre_of(index as usize);
        let read = relief.height(x, y);
        let off = (read - height(column, row)).abs();
        assert!(off < 6e-4, "{column} {row}: {read}");
    }
}
