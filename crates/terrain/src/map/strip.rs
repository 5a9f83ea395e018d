//! Strips: the rows of a map that are computed, stored and resumed together.

use std::io::{Read as _, Write as _};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use super::layout::MapLayout;
use crate::raster::{from_planes, to_planes};

/// Fast: the predictor does most of the work.
const DEFLATE_LEVEL: u32 = 2;

/// A packed strip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Strip {
    /// Its index from the upper edge.
    pub index: u32,
    /// Deflated rows, as they stand in the file.
    pub bytes: Vec<u8>,
}

impl Strip {
    /// Packs the cells of a strip.
    #[must_use]
    pub fn pack(layout: &MapLayout, index: u32, cells: &[f32]) -> Self {
        let planes = to_planes(cells, layout.columns as usize, layout.bands());
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(DEFLATE_LEVEL));
        // writing to memory cannot fail
        let _ = encoder.write_all(&planes);
        Self {
            index,
            bytes: encoder.finish().unwrap_or_default(),
        }
    }

    /// Its cells; `None` where the bytes are no strip of this layout.
    #[must_use]
    pub fn unpack(&self, layout: &MapLayout) -> Option<Vec<f32>> {
        let cells = layout.rows_of(self.index).len() * layout.columns as usize;
        let expected = cells * layout.bands() * size_of::<f32>();
        let mut planes = Vec::with_capacity(expected);
        let limit = expected as u64 + 1;
        ZlibDecoder::new(&self.bytes[..])
            .take(limit)
            .read_to_end(&mut planes)
            .ok()?;
        if planes.len() != expected {
            return None;
        }
        Some(from_planes(
            &mut planes,
            layout.columns as usize,
            layout.bands(),
        ))
    }
}
