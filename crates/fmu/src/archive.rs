//! A zip archive of stored entries: what a unit is packed in.
//!
//! Source: PKWARE, .ZIP File Format Specification (APPNOTE.TXT), sections 4.3.7 (local file header), 4.3.12 (central
//! directory) and 4.3.16 (its end).

use crate::error::{Error, Result};

/// Version of the format that readers need: 1.0, stored entries.
const VERSION: u16 = 10;
/// 1 January 1980, the earliest date of the format: the same unit has the same bytes whenever it is written.
const DATE: u16 = 0x21;
/// Flag of names in UTF-8.
const UTF_8: u16 = 1 << 11;

/// The bytes of an archive of entries by their names.
pub(crate) fn archive(entries: &[(&str, Vec<u8>)]) -> Result<Vec<u8>> {
    let mut out = Vec::new();
    let mut directory = Vec::new();
    for (name, content) in entries {
        let too_long = |_| Error::TooLong {
            name: (*name).to_owned(),
            bytes: content.len(),
        };
        let offset = u32::try_from(out.len()).map_err(too_long)?;
        let length = u32::try_from(content.len()).map_err(too_long)?;
        let name_length = u16::try_from(name.len()).map_err(too_long)?;
        let mut common = Vec::new();
        for half in [VERSION, UTF_8, 0, 0, DATE] {
            common.extend(half.to_le_bytes());
        }
        for word in [crc32fast::hash(content), length, length] {
            common.extend(word.to_le_bytes());
        }
        common.extend(name_length.to_le_bytes());
        common.extend([0; 2]); // no extra field
        out.extend(b"PK\x03\x04");
        out.extend(&common);
        out.extend(name.as_bytes());
        out.extend(content);
        directory.extend(b"PK\x01\x02");
        directory.extend(VERSION.to_le_bytes());
        directory.extend(&common);
        directory.extend([0; 10]); // no comment, first disk, no attributes
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let too_long = |_| Error::TooLong {
        name: "the unit".to_owned(),
        bytes: out.len(),
    };
    let count = u16::try_from(entries.len()).map_err(too_long)?;
    let start = u32::try_from(out.len()).map_err(too_long)?;
    let size = u32::try_from(directory.len()).map_err(too_long)?;
    out.extend(&directory);
    out.extend(b"PK\x05\x06\0\0\0\0");
    out.extend(count.to_le_bytes());
    out.extend(count.to_le_bytes());
    out.extend(size.to_le_bytes());
    out.extend(start.to_le_bytes());
    out.extend([0; 2]);
    Ok(out)
}
