//! Terrain files made by hand, so that they can lie about anything.

use std::path::PathBuf;

use grouser_rover::Error;
use grouser_rover::ground::{HeightFile, HeightMap, TerrainFault, parse_heights};

/// A file of this ending, as a scenario would name it.
pub(crate) fn named(ending: &str) -> HeightFile {
    HeightFile {
        path: PathBuf::from(format!("ground.{ending}")),
        cell: None,
        height_step: 0.01,
    }
}

pub(crate) fn read(ending: &str, bytes: &[u8]) -> Result<HeightMap, TerrainFault> {
    reported(parse_heights(bytes, &named(ending)))
}

pub(crate) fn read_with_cell(ending: &str, bytes: &[u8]) -> Result<HeightMap, TerrainFault> {
    let file = HeightFile {
        cell: Some(0.5),
        ..named(ending)
    };
    reported(parse_heights(bytes, &file))
}

fn reported(read: Result<HeightMap, Error>) -> Result<HeightMap, TerrainFault> {
    read.map_err(|error| match error {
        Error::Terrain { file, fault } => {
            assert!(file.to_string_lossy().starts_with("ground."));
            fault
        }
        other => panic!("{other}"),
    })
}

/// The value of a tag, as it stands in the file.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Short(Vec<u16>),
    Long(Vec<u32>),
    Double(Vec<f64>),
    Text(String),
}

impl Value {
    fn parts(&self) -> (u16, u32, Vec<u8>) {
        let (kind, count, bytes): (u16, usize, Vec<u8>) = match self {
            Self::Text(text) => (2, text.len() + 1, [text.as_bytes(), b"\0"].concat()),
            Self::Short(v) => (3, v.len(), v.iter().flat_map(|x| x.to_le_bytes()).collect()),
            Self::Long(v) => (4, v.len(), v.iter().flat_map(|x| x.to_le_bytes()).collect()),
            Self::Double(v) => (
                12,
                v.len(),
                v.iter().flat_map(|x| x.to_le_bytes()).collect(),
            ),
        };
        (kind, u32::try_from(count).unwrap(), bytes)
    }
}

/// A little-endian TIFF: its tags, and its pieces of image in their order.
#[derive(Clone, Debug)]
pub(crate) struct Tiff {
    pub(crate) tags: Vec<(u16, Value)>,
    pub(crate) pieces: Vec<Vec<u8>>,
}

pub(crate) const WIDTH: u16 = 256;
pub(crate) const HEIGHT: u16 = 257;
pub(crate) const COMPRESSION: u16 = 259;
pub(crate) const BLACK: u16 = 262;
pub(crate) const OFFSETS: u16 = 273;
pub(crate) const ROWS_PER_STRIP: u16 = 278;
pub(crate) const LENGTHS: u16 = 279;
pub(crate) const SCALE: u16 = 33_550;
pub(crate) const TIE_POINTS: u16 = 33_922;
pub(crate) const KEYS: u16 = 34_735;
pub(crate) const NO_DATA: u16 = 42_113;
pub(crate) const TILE_OFFSETS: u16 = 324;
pub(crate) const TILE_LENGTHS: u16 = 325;

impl Tiff {
    /// Floats in one strip, with cells of half a metre in a zone of UTM.
    pub(crate) fn floats(columns: u32, rows: u32, heights: &[f32]) -> Self {
        let strip: Vec<u8> = heights.iter().flat_map(|h| h.to_le_bytes()).collect();
        Self::of(columns, rows, 32, 3, strip)
    }

    pub(crate) fn of(columns: u32, rows: u32, bits: u16, format: u16, strip: Vec<u8>) -> Self {
        Self {
            tags: vec![
                (WIDTH, Value::Long(vec![columns])),
                (HEIGHT, Value::Long(vec![rows])),
                (258, Value::Short(vec![bits])),
                (COMPRESSION, Value::Short(vec![1])),
                (BLACK, Value::Short(vec![1])),
                (277, Value::Short(vec![1])),
                (ROWS_PER_STRIP, Value::Long(vec![rows])),
                (339, Value::Short(vec![format])),
                (SCALE, Value::Double(vec![0.5, 0.5, 0.0])),
                (
                    TIE_POINTS,
                    Value::Double(vec![0.0, 0.0, 0.0, 500e3, 5_300e3, 0.0]),
                ),
                (
                    KEYS,
                    Value::Short(vec![1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 32_632]),
                ),
            ],
            pieces: vec![strip],
        }
    }

    /// Puts a tag in the place of another.
    pub(crate) fn with(mut self, tag: u16, value: Value) -> Self {
        self.tags.retain(|(own, _)| *own != tag);
        self.tags.push((tag, value));
        self
    }

    pub(crate) fn without(mut self, tag: u16) -> Self {
        self.tags.retain(|(own, _)| *own != tag);
        self
    }

    /// The same image in tiles of 16 by 16, filled up with `fill`.
    pub(crate) fn tiled(
        mut self,
        (columns, rows): (usize, usize),
        heights: &[f32],
        fill: f32,
    ) -> Self {
        self.pieces = Vec::new();
        for top in (0..rows).step_by(16) {
            for left in (0..columns).step_by(16) {
                let mut tile = Vec::new();
                for row in top..top + 16 {
                    for column in left..left + 16 {
                        let inside = row < rows && column < columns;
                        let height = if inside {
                            heights[row * columns + column]
                        } else {
                            fill
                        };
                        tile.extend(height.to_le_bytes());
                    }
                }
                self.pieces.push(tile);
            }
        }
        self.without(ROWS_PER_STRIP)
            .with(322, Value::Long(vec![16]))
            .with(323, Value::Long(vec![16]))
    }

    /// Offsets and lengths of the pieces are filled in where the tags do not lie about them.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let is_tiled = self.tags.iter().any(|(tag, _)| *tag == 322);
        let (offsets, lengths) = if is_tiled {
            (TILE_OFFSETS, TILE_LENGTHS)
        } else {
            (OFFSETS, LENGTHS)
        };
        let mut out = b"II*\0\0\0\0\0".to_vec();
        let mut starts = Vec::new();
        for piece in &self.pieces {
            starts.push(u32::try_from(out.len()).unwrap());
            out.extend(piece);
        }
        let sizes = self.pieces.iter().map(|p| u32::try_from(p.len()).unwrap());
        let mut tags = self.tags.clone();
        for (tag, value) in [(offsets, starts), (lengths, sizes.collect())] {
            if !tags.iter().any(|(own, _)| *own == tag) {
                tags.push((tag, Value::Long(value)));
            }
        }
        tags.sort_by_key(|(tag, _)| *tag);
        let mut entries = Vec::new();
        for (tag, value) in &tags {
            let (kind, count, bytes) = value.parts();
            let mut held = [0; 4];
            if bytes.len() <= 4 {
                held[..bytes.len()].copy_from_slice(&bytes);
            } else {
                held = u32::try_from(out.len()).unwrap().to_le_bytes();
                out.extend(&bytes);
            }
            entries.extend(tag.to_le_bytes());
            entries.extend(kind.to_le_bytes());
            entries.extend(count.to_le_bytes());
            entries.extend(held);
        }
        let at = u32::try_from(out.len()).unwrap();
        out[4..8].copy_from_slice(&at.to_le_bytes());
        out.extend(u16::try_from(tags.len()).unwrap().to_le_bytes());
        out.extend(entries);
        out.extend([0; 4]);
        out
    }
}

/// A PNG of grey levels.
pub(crate) fn png(
    columns: u32,
    rows: u32,
    color: png::ColorType,
    depth: png::BitDepth,
    data: &[u8],
) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, columns, rows);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
    writer.finish().unwrap();
    out
}

/// A PNG of 16 bits, 5 × 4, whose row and column can be read off.
pub(crate) fn small_png() -> Vec<u8> {
    let grey = (0..20_u16).flat_map(|i| (1000 * i).to_be_bytes());
    let grey: Vec<u8> = grey.collect();
    png(
        5,
        4,
        png::ColorType::Grayscale,
        png::BitDepth::Sixteen,
        &grey,
    )
}

pub(crate) const SMALL_GRID: &str = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0.5\n\
    NODATA_value -9999\n1.5 2.5 -9999\n4 5e0 6\n";

/// Heights that differ everywhere.
pub(crate) fn heights(columns: usize, rows: usize) -> Vec<f32> {
    (0_u16..)
        .take(columns * rows)
        .map(|i| f32::from(i) * 0.25 - 3.0)
        .collect()
}

/// Writes the small files that fuzzing begins with; the first byte says the kind of file:
/// `cargo test -p grouser-rover --test all terrain:: -- --ignored`.
#[test]
#[ignore = "writes fuzz/seeds/heightmap"]
fn write_the_seeds() {
    let folder = PathBuf::from(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../fuzz/seeds/heightmap"
    ));
    std::fs::create_dir_all(&folder).unwrap();
    let strips = Tiff::floats(5, 4, &heights(5, 4));
    let holed = strips
        .clone()
        .with(NO_DATA, Value::Text("-9999".into()))
        .bytes();
    let tiles = strips.clone().tiled((5, 4), &heights(5, 4), 0.0).bytes();
    let words = Tiff::of(3, 2, 16, 2, vec![1, 0, 255, 255, 9, 0, 7, 0, 5, 0, 3, 0]);
    for (name, kind, bytes) in [
        ("strips", 0, strips.bytes()),
        ("own-cell", 129, holed.clone()),
        ("no-data", 0, holed),
        ("tiles", 0, tiles),
        ("words", 0, words.bytes()),
        ("picture", 1, small_png()),
        ("grid", 2, SMALL_GRID.as_bytes().to_vec()),
    ] {
        std::fs::write(folder.join(name), [&[kind][..], &bytes].concat()).unwrap();
    }
}
