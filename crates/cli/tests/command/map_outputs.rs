//! What `map` writes beside the map, read back as its readers read it: gz-sim's slip map by the formulas of
//! gz-sim, the grid map by ROS's own tools in Python, the table by a Parquet reader.

use std::fs;
use std::process::Command;

use grouser_terrain::plan::read_map;
use grouser_terrain::{Band, MapLayout, Quantity};

use super::program::{Folder, grouser};

/// A map of the dunes with two soils, and its other outputs.
struct Made {
    folder: Folder,
    layout: MapLayout,
    /// Band by band of each cell.
    cells: Vec<f32>,
    result: serde_json::Value,
}

fn example(name: &str) -> String {
    format!("{}/../../examples/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn made(outputs: &[&str]) -> Made {
    let folder = Folder::new();
    let [dem, robot, legend] = [
        "terrain/dunes.asc",
        "robots/skid-steer.toml",
        "terrain/dunes-soils.toml",
    ]
    .map(example);
    let map = folder.path("map.tif");
    let mut words = ["map", &dem, "--robot", &robot, "--soil", "sandy-loam"]
        .map(str::to_owned)
        .to_vec();
    words.extend(["--soil-map", &legend, "--json", "-o"].map(str::to_owned));
    words.push(map.display().to_string());
    for output in outputs {
        words.push("-o".to_owned());
        words.push(folder.path(output).display().to_string());
    }
    let result = grouser(words).assert_done().json();
    let (layout, cells) = read_map(&map).unwrap();
    Made {
        folder,
        layout,
        cells,
        result,
    }
}

impl Made {
    fn value(&self, (row, column): (u32, u32), band: Band) -> f32 {
        let cell = (row * self.layout.columns + column) as usize;
        self.cells[cell * self.layout.bands() + band.index(self.layout.headings)]
    }

    fn places(&self) -> impl Iterator<Item = (u32, u32)> {
        let columns = self.layout.columns;
        (0..self.layout.rows).flat_map(move |row| (0..columns).map(move |column| (row, column)))
    }
}

/// The number in an element of SDF.
fn element(sdf: &str, name: &str) -> f64 {
    let text = sdf.split_once(&format!("<{name}>")).unwrap().1;
    text.split_once('<').unwrap().0.parse().unwrap()
}

#[test]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "as gz-sim casts"
)]
fn gz_sim_finds_the_slip_of_the_map_under_a_wheel() {
    let made = made(&["slip.sdf"]);
    let sdf = fs::read_to_string(made.folder.path("slip.sdf")).unwrap();
    assert!(
        sdf.contains("<slip_map>slip.png</slip_map>") && sdf.contains("link_name=\"rear_left\"")
    );
    let picture = fs::read(made.folder.path("slip.png")).unwrap();
    let picture = resvg::tiny_skia::Pixmap::decode_png(&picture).unwrap();
    let (width, height) = (picture.width(), picture.height());
    let [side_x, side_y] = ["size_x", "size_y"].map(|name| element(&sdf, name));
    let nominal = element(&sdf, "slip_compliance_longitudinal");
    let delta = element(&sdf, "slip_compliance_longitudinal_delta");
    let friction_delta = element(&sdf, "friction_delta");
    let cell = made.layout.cell;
    let (mut compared, mut unknown) = (0, 0);
    for place in made.places() {
        let (row, column) = place;
        // a wheel anywhere in the cell, in the world of gz-sim
        for off in [-0.49, 0.0, 0.49] {
            let x = -0.5 * side_x + (f64::from(column) + off) * cell;
            let y = 0.5 * side_y - (f64::from(row) + off) * cell;
            // LookupWheelSlip.cc, UpdateParams
            let u = ((x + 0.5 * side_x) / (side_x / f64::from(width))).round() as u32;
            let v = ((0.5 * side_y - y) / (side_y / f64::from(height))).round() as u32;
            let index = (v * height + u) as usize;
            let pixel = picture.pixels()[index];
            let compliance = nominal + (f64::from(pixel.green()) - 128.0) * delta;
            let friction = 1.0 + (f64::from(pixel.blue()) - 128.0) * friction_delta;
            assert_eq!(pixel.red(), 128, "sideways slip is not in a map");
            let at = |quantity, heading| f64::from(made.value(place, Band { quantity, heading }));
            let steepest = (0..8)
                .filter(|heading| at(Quantity::Pitch, *heading) >= 0.0)
                .max_by(|a, b| at(Quantity::Pitch, *a).total_cmp(&at(Quantity::Pitch, *b)));
            let Some(heading) = steepest else {
                assert_eq!((pixel.green(), pixel.blue()), (128, 128), "{place:?}");
                unknown += 1;
                continue;
            };
            let soil = at(Quantity::Soil, heading) as usize;
            let steepest_deg = made.result["soils"][soil]["steepest_deg"].as_f64().unwrap();
            let climbs = steepest_deg.to_radians().tan();
            assert!(
                (friction - climbs).abs() <= 0.5 * friction_delta + 1e-9,
                "{place:?}"
            );
            let slip = at(Quantity::Slip, heading);
            if slip.is_nan() {
                assert_eq!(pixel.green(), 255);
                continue;
            }
            // WheelSlip.cc: slip = compliance × pull / load; the pull of a slope, all four wheels driven
            let pull = at(Quantity::Pitch, heading).to_radians().max(0.087).sin();
            let error = (compliance * pull - slip.max(0.0)).abs();
            assert!(
                error <= 0.5 * delta * pull + 1e-6 || pixel.green() == 255,
                "{place:?}: {compliance} × {pull} for {slip}"
            );
            compared += 1;
        }
    }
    assert!(compared > 2000 && unknown > 10, "{compared} {unknown}");
}

/// Reads a grid map as grid_map does, and prints layer, x, y and value of every cell.
const READER: &str = r#"
import sys
from pathlib import Path
import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

def show(who, message):
    info = message.info
    for layer, array in zip(message.layers, message.data):
        columns, rows = array.layout.dim
        assert (columns.label, rows.label) == ("column_index", "row_index")
        assert columns.stride == rows.size * columns.size and rows.stride == rows.size
        # Eigen, column by column; grid_map_core, getPositionFromIndex: indices run against the axes
        matrix = np.array(array.data, dtype=np.float32).reshape(columns.size, rows.size).T
        for i in range(rows.size):
            for j in range(columns.size):
                x = info.pose.position.x + 0.5 * info.length_x - (i + 0.5) * info.resolution
                y = info.pose.position.y + 0.5 * info.length_y - (j + 0.5) * info.resolution
                print(who, layer, repr(x), repr(y), repr(float(matrix[i, j])))
    assert message.outer_start_index == 0 and message.inner_start_index == 0
    assert list(message.basic_layers) == ["elevation"] and message.header.frame_id == "map"

path = sys.argv[1]
with open(path, "rb") as file:
    for schema, channel, _, message in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
        assert schema.name == "grid_map_msgs/msg/GridMap"
        show("mcap", message)
with AnyReader([Path(path)]) as reader:
    for connection, _, raw in reader.messages():
        show("rosbags", reader.deserialize(raw, connection.msgtype))
"#;

/// Heights by row, from the text of an ASCII grid whose header has six lines.
fn heights(text: &str) -> Vec<Vec<f32>> {
    let rows = text.lines().skip(6);
    rows.map(|line| {
        line.split_whitespace()
            .map(|word| word.parse().unwrap())
            .collect()
    })
    .collect()
}

#[test]
#[allow(clippy::print_stderr, reason = "a test that is skipped is reported")]
fn ros_finds_every_cell_of_the_grid_map_at_its_place() {
    let made = made(&["map.mcap"]);
    let Some(python) = std::env::var_os("GROUSER_PYTHON") else {
        eprintln!("skipped: GROUSER_PYTHON names no Python with rosbags and mcap-ros2-support");
        return;
    };
    let read = Command::new(python)
        .args(["-c", READER])
        .arg(made.folder.path("map.mcap"))
        .output()
        .unwrap();
    assert!(
        read.status.success(),
        "{}",
        String::from_utf8_lossy(&read.stderr)
    );
    let shown = String::from_utf8(read.stdout).unwrap();
    let heights = heights(&fs::read_to_string(example("terrain/dunes.asc")).unwrap());
    let layout = &made.layout;
    let mut expected = Vec::new();
    for place in made.places() {
        let [x, y] = layout.georeference.centre(place.1, place.0).unwrap();
        for quantity in Quantity::ALL {
            for heading in 0..8 {
                let band = Band { quantity, heading };
                let name = format!("{}_heading_{}", quantity.key(), 45 * heading);
                expected.push((name, x, y, made.value(place, band)));
            }
        }
        let height = heights[place.0 as usize][place.1 as usize];
        let height = if height > -9000.0 { height } else { f32::NAN };
        expected.push(("elevation".to_owned(), x, y, height));
    }
    for who in ["mcap", "rosbags"] {
        let mut found: Vec<_> = shown
            .lines()
            .filter_map(|line| line.strip_prefix(who)?.strip_prefix(' '))
            .map(|line| {
                let words: Vec<&str> = line.split(' ').collect();
                let number = |index: usize| words[index].parse::<f64>().unwrap();
                #[allow(clippy::cast_possible_truncation, reason = "it was a float of 32 bits")]
                let value = number(3) as f32;
                (words[0].to_owned(), number(1), number(2), value)
            })
            .collect();
        assert_eq!(found.len(), expected.len(), "{who}");
        let order = |a: &(String, f64, f64, f32), b: &(String, f64, f64, f32)| {
            (a.0.cmp(&b.0))
                .then(a.1.total_cmp(&b.1))
                .then(a.2.total_cmp(&b.2))
        };
        found.sort_by(order);
        expected.sort_by(order);
        for (found, expected) in found.iter().zip(&expected) {
            let is_same = found.0 == expected.0
                && (found.1 - expected.1).abs() < 1e-9
                && (found.2 - expected.2).abs() < 1e-9
                && (found.3 == expected.3 || found.3.is_nan() && expected.3.is_nan());
            assert!(is_same, "{who}: {found:?}, not {expected:?}");
        }
    }
}

#[cfg(not(feature = "parquet"))]
#[test]
fn a_table_that_this_build_does_not_write_is_refused_before_the_work() {
    let folder = Folder::new();
    let said = grouser([
        "map",
        "no.asc",
        "--robot",
        "no.toml",
        "--soil",
        "lunar",
        "-o",
        &folder.path("map.tif").display().to_string(),
        "-o",
        &folder.path("map.parquet").display().to_string(),
    ]);
    said.assert_refused("Parquet without the feature");
    assert!(said.err.contains("--features parquet"), "{}", said.err);
    assert!(!folder.path("map.parquet").exists());
}

#[cfg(feature = "parquet")]
#[test]
fn the_table_has_a_row_for_every_cell() {
    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::Field;

    let made = made(&["map.parquet"]);
    let file = fs::File::open(made.folder.path("map.parquet") as std::path::PathBuf).unwrap();
    let reader = SerializedFileReader::new(file).unwrap();
    let rows: Vec<_> = reader
        .get_row_iter(None)
        .unwrap()
        .map(Result::unwrap)
        .collect();
    assert_eq!(
        rows.len(),
        (made.layout.columns * made.layout.rows) as usize
    );
    for (row, place) in rows.iter().zip(made.places()) {
        let fields: std::collections::BTreeMap<&str, &Field> = row
            .get_column_iter()
            .map(|(name, field)| (name.as_str(), field))
            .collect();
        let [x, y] = made.layout.georeference.centre(place.1, place.0).unwrap();
        assert_eq!(fields["row"], &Field::Int(place.0.cast_signed()));
        assert_eq!(fields["column"], &Field::Int(place.1.cast_signed()));
        assert_eq!(
            (fields["x_m"], fields["y_m"]),
            (&Field::Double(x), &Field::Double(y))
        );
        for quantity in Quantity::ALL {
            for heading in 0..8 {
                let name = format!("{}_heading_{}", quantity.key(), 45 * heading);
                let value = made.value(place, Band { quantity, heading });
                let expected = if value.is_nan() {
                    Field::Null
                } else {
                    Field::Float(value)
                };
                assert_eq!(fields[name.as_str()], &expected, "{place:?} {name}");
            }
        }
    }
}
