//! A GeoTIFF of a plane, with any tags.

use std::io::Cursor;

use tiff::encoder::TiffEncoder;
use tiff::tags::Tag;

pub(super) const COLUMNS: u16 = 12;
pub(super) const ROWS: u16 = 8;
pub(super) const UTM: [f64; 2] = [500e3, 5_300e3];
/// Tags: keys, key doubles, GDAL's metadata, no data.
pub(super) const KEYS: u16 = 34_735;
pub(super) const DOUBLES: u16 = 34_736;
pub(super) const METADATA: u16 = 42_112;
pub(super) const NO_DATA: u16 = 42_113;

/// The numbers of the cells.
pub(super) enum Cells {
    Floats(Vec<f32>),
    Doubles(Vec<f64>),
    Words(Vec<i16>),
}

/// A GeoTIFF: UTM zone 32 north, cells of 1 m, unless changed.
pub(super) struct Plane {
    pub(super) cells: Cells,
    pub(super) scale: Vec<f64>,
    pub(super) matrix: Vec<f64>,
    pub(super) place: [f64; 2],
    pub(super) keys: Vec<[u16; 4]>,
    pub(super) doubles: Vec<f64>,
    pub(super) texts: Vec<(u16, String)>,
    pub(super) bands: u16,
    pub(super) has_mask: bool,
}

/// The height of the plane on a column of cells of 1 m.
pub(super) fn height(column: u16) -> f64 {
    200.0 + f64::from(column) * 10.0_f64.to_radians().tan()
}

pub(super) fn columns() -> impl Iterator<Item = u16> {
    (0..ROWS).flat_map(|_| 0..COLUMNS)
}

#[allow(clippy::cast_possible_truncation, reason = "heights of a test")]
pub(super) fn plane() -> Plane {
    Plane {
        cells: Cells::Floats(columns().map(|column| height(column) as f32).collect()),
        scale: vec![1.0, 1.0, 0.0],
        matrix: Vec::new(),
        place: UTM,
        keys: system(32_632),
        doubles: Vec::new(),
        texts: Vec::new(),
        bands: 1,
        has_mask: false,
    }
}

/// A projected system of EPSG.
pub(super) fn system(code: u16) -> Vec<[u16; 4]> {
    vec![[1024, 0, 1, 1], [1025, 0, 1, 1], [3072, 0, 1, code]]
}

impl Plane {
    pub(super) fn key(mut self, code: u16, value: u16) -> Self {
        self.keys.retain(|key| key[0] != code);
        self.keys.push([code, 0, 1, value]);
        self
    }

    pub(super) fn system(self, code: u16, place: [f64; 2]) -> Self {
        Self {
            keys: system(code),
            place,
            ..self
        }
    }

    /// A projection by its method and parameters.
    pub(super) fn method(mut self, code: u16, parameters: &[(u16, f64)], place: [f64; 2]) -> Self {
        self = self.key(3072, 32_767).key(3075, code);
        for (key, value) in parameters {
            let index = u16::try_from(self.doubles.len()).unwrap();
            self.keys.push([*key, DOUBLES, 1, index]);
            self.doubles.push(*value);
        }
        Self { place, ..self }
    }

    pub(super) fn text(mut self, tag: u16, text: &str) -> Self {
        self.texts.push((tag, text.to_owned()));
        self
    }

    pub(super) fn item(self, name: &str, text: &str) -> Self {
        let role = name.to_ascii_lowercase();
        self.text(
            METADATA,
            &format!(
                "<GDALMetadata>\n  <Item name=\"{name}\" sample=\"0\" role=\"{role}\">{text}</Item>\n</GDALMetadata>"
            ),
        )
    }

    /// Whole numbers of tenths of a millimetre less 200 m.
    pub(super) fn words(mut self) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "heights of a test")]
        let words = columns().map(|column| ((height(column) - 200.0) * 1e4).round() as i16);
        self.cells = Cells::Words(words.collect());
        self.text(
            METADATA,
            "<GDALMetadata><Item name=\"OFFSET\" sample=\"0\" role=\"offset\">200</Item>\
             <Item name=\"SCALE\" sample=\"0\" role=\"scale\">0.0001</Item></GDALMetadata>",
        )
    }

    /// Two cells are this number.
    pub(super) fn hole(mut self, number: f32) -> Self {
        match &mut self.cells {
            Cells::Floats(cells) => cells[29..31].fill(number),
            #[allow(clippy::cast_possible_truncation, reason = "a whole number of 16 bits")]
            Cells::Words(cells) => cells[29..31].fill(number as i16),
            Cells::Doubles(cells) => cells[29..31].fill(number.into()),
        }
        self
    }

    pub(super) fn matrix(mut self, [a, b, d, e]: [f64; 4]) -> Self {
        let [x, y] = self.place;
        self.scale.clear();
        self.matrix = vec![
            a, b, 0.0, x, d, e, 0.0, y, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
        ];
        self
    }

    pub(super) fn size(mut self, width: f64, height: f64) -> Self {
        self.scale = vec![width, height, 0.0];
        self
    }

    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut out = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut out).unwrap();
        for is_mask in [false, true] {
            if is_mask && !self.has_mask {
                break;
            }
            let mut directory = encoder.image_directory().unwrap();
            let tag = Tag::from_u16_exhaustive;
            let (bytes, bits, format): (Vec<u8>, u16, u16) = match &self.cells {
                Cells::Floats(cells) => (floats(cells, self.bands), 32, 3),
                Cells::Doubles(cells) => {
                    let bytes = cells.iter().flat_map(|cell| cell.to_le_bytes());
                    (bytes.collect(), 64, 3)
                }
                Cells::Words(cells) => {
                    let bytes = cells.iter().flat_map(|cell| cell.to_le_bytes());
                    (bytes.collect(), 16, 2)
                }
            };
            let start = directory.write_data(&bytes[..]).unwrap();
            for (code, value) in [
                (254, if is_mask { 4 } else { 0 }),
                (256, u32::from(COLUMNS)),
                (257, u32::from(ROWS)),
                (273, u32::try_from(start).unwrap()),
                (278, u32::from(ROWS)),
                (279, u32::try_from(bytes.len()).unwrap()),
            ] {
                directory.write_tag(tag(code), value).unwrap();
            }
            let bands = usize::from(self.bands);
            for (code, value) in [(258, bits), (339, format)] {
                directory
                    .write_tag(tag(code), &vec![value; bands][..])
                    .unwrap();
            }
            for (code, value) in [(259, 1_u16), (262, 1), (277, self.bands), (284, 1)] {
                directory.write_tag(tag(code), value).unwrap();
            }
            if self.bands > 1 {
                directory
                    .write_tag(tag(338), &vec![0_u16; bands - 1][..])
                    .unwrap();
            }
            let tie = [0.0, 0.0, 0.0, self.place[0], self.place[1], 0.0];
            let tie = if self.scale.is_empty() {
                &tie[..0]
            } else {
                &tie
            };
            for (code, value) in [
                (33_550, &self.scale[..]),
                (33_922, tie),
                (34_264, &self.matrix),
                (DOUBLES, &self.doubles),
            ] {
                if !value.is_empty() {
                    directory.write_tag(tag(code), value).unwrap();
                }
            }
            if !self.keys.is_empty() {
                let mut keys = self.keys.clone();
                keys.sort_unstable();
                let count = u16::try_from(keys.len()).unwrap();
                let all = [&[[1, 1, 0, count]][..], &keys].concat().concat();
                directory.write_tag(tag(KEYS), &all[..]).unwrap();
            }
            for (code, text) in &self.texts {
                directory.write_tag(tag(*code), text.as_str()).unwrap();
            }
            directory.finish().unwrap();
        }
        out.into_inner()
    }
}

pub(super) fn floats(cells: &[f32], bands: u16) -> Vec<u8> {
    let of_cell = |cell: &f32| vec![cell.to_le_bytes(); bands.into()].concat();
    cells.iter().flat_map(of_cell).collect()
}
