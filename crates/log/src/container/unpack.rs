//! Chunks taken out of their compression, up to a limit.

use std::cmp::Ordering;
use std::io::Read;

use zrip_decode::context::DecompressContext;

/// How a chunk is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    None,
    Bzip2,
    Lz4,
    Zstd,
}

impl Packing {
    pub(super) fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"" | b"none" => Self::None,
            b"bz2" => Self::Bzip2,
            b"lz4" => Self::Lz4,
            b"zstd" => Self::Zstd,
            _ => return None,
        })
    }
}

/// Room that the decoder of zstd wants behind its output, bytes.
const BEHIND: u64 = 256;

/// The decompressors, whose tables are kept from chunk to chunk.
pub(super) struct Unpacker {
    zstd: DecompressContext,
}

impl Unpacker {
    pub(super) fn new() -> Self {
        Self {
            zstd: DecompressContext::new(),
        }
    }

    /// Unpacks into `out` what can be unpacked of `packed`, whose content must have `declared` bytes and
    /// may have at most `limit`; what is wrong, if anything is.
    pub(super) fn unpack(
        &mut self,
        packing: Packing,
        packed: &[u8],
        (declared, limit): (u64, u64),
        out: &mut Vec<u8>,
    ) -> Result<(), String> {
        out.clear();
        if declared > limit {
            return Err(format!(
                "the chunk declares {declared} bytes, more than the limit of {limit}"
            ));
        }
        // At once and not by doubling, which would hold up to three times as much.
        let room = usize::try_from(declared + BEHIND).unwrap_or(usize::MAX);
        out.try_reserve_exact(room)
            .map_err(|error| error.to_string())?;
        let faulty =
            |error: &dyn std::error::Error| format!("the chunk cannot be decompressed: {error}");
        let mut read = |from: &mut dyn Read| {
            let read = from.take(declared + 1).read_to_end(out);
            read.map(|_| ()).map_err(|error| faulty(&error))
        };
        match packing {
            Packing::None => read(&mut &*packed)?,
            Packing::Bzip2 => read(&mut bzip2::read::BzDecoder::new(packed))?,
            Packing::Lz4 => read(&mut lz4_flex::frame::FrameDecoder::new(packed))?,
            // Straight to where it belongs: no window is held beside the content.
            Packing::Zstd => {
                let most = usize::try_from(declared).unwrap_or(usize::MAX);
                let done = self.zstd.decompress_into_with_limit(packed, out, most);
                done.map_err(|error| faulty(&error))?;
            }
        }
        let found = out.len() as u64;
        match found.cmp(&declared) {
            Ordering::Equal => Ok(()),
            Ordering::Less => Err(format!(
                "the chunk holds {found} bytes, but declares {declared}"
            )),
            Ordering::Greater => {
                out.truncate(usize::try_from(declared).unwrap_or(usize::MAX));
                Err(format!(
                    "the chunk holds more than the {declared} bytes that it declares"
                ))
            }
        }
    }
}
