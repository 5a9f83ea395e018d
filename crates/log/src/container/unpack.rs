//! Chunks taken out of their compression, up to a limit.

use std::io::Read;

use super::CHUNK_LIMIT;

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

/// Unpacks into `out` what can be unpacked of `packed`, whose content must have `declared` bytes; what
/// is wrong, if anything is.
pub(super) fn unpack(
    packing: Packing,
    packed: &[u8],
    declared: u64,
    out: &mut Vec<u8>,
) -> Result<(), String> {
    out.clear();
    if declared > CHUNK_LIMIT {
        return Err(format!(
            "the chunk declares {declared} bytes, more than the limit of {CHUNK_LIMIT}"
        ));
    }
    let mut read = |from: &mut dyn Read| {
        let read = from.take(declared + 1).read_to_end(out);
        read.map_err(|error| format!("the chunk cannot be decompressed: {error}"))
    };
    let done = match packing {
        Packing::None => read(&mut &*packed),
        Packing::Bzip2 => read(&mut bzip2::read::BzDecoder::new(packed)),
        Packing::Lz4 => read(&mut lz4_flex::frame::FrameDecoder::new(packed)),
        Packing::Zstd => match ruzstd::decoding::StreamingDecoder::new(packed) {
            Ok(mut decoder) => read(&mut decoder),
            Err(error) => Err(format!("the chunk cannot be decompressed: {error}")),
        },
    };
    done?;
    let found = out.len() as u64;
    if found == declared {
        return Ok(());
    }
    out.truncate(usize::try_from(declared).unwrap_or(usize::MAX));
    Err(if found > declared {
        format!("the chunk holds more than the {declared} bytes that it declares")
    } else {
        format!("the chunk holds {found} bytes, but declares {declared}")
    })
}
