//! The declarations that a file repeats at its end, for when the chunk that made them is lost.

use std::collections::BTreeMap;
use std::io;

use super::mcap::{CHANNEL, CHUNK, DATA_END, FOOTER, HEAD, MAGIC, SCHEMA};
use super::{Container, DECLARED_LIMIT, Fields, bag};

/// Bytes of the footer of an MCAP file, its head included.
const FOOTER_BYTES: u64 = 29;

/// The repeated declarations by kind and number.
pub(super) type Spare = BTreeMap<(u8, u32), Vec<u8>>;

impl Container {
    /// Enters schema or channel `id` of an MCAP file as the summary repeats it, if it does.
    pub(super) fn mcap_spare(&mut self, opcode: u8, id: u16) {
        if self.spare.is_none() {
            self.spare = Some(self.mcap_summary().ok().flatten().unwrap_or_default());
        }
        let found = self.spare.as_mut();
        // Taken out, so that a schema is not looked for again and again.
        if let Some(content) = found.and_then(|spare| spare.remove(&(opcode, id.into()))) {
            // An error in a copy is not reported: the loss of its chunk has been.
            let _ = self.mcap_content(opcode, &content, (0, false));
        }
    }

    /// The schemas and channels of the summary, if the footer at the end belongs to the file that is read
    /// and all up to there is as it was written.
    fn mcap_summary(&self) -> io::Result<Option<Spare>> {
        let Some(footer) = (self.scan.length()).checked_sub(FOOTER_BYTES + MAGIC.len() as u64)
        else {
            return Ok(None);
        };
        let mut record = Vec::new();
        self.scan.beside(footer).read(FOOTER_BYTES, &mut record)?;
        let mut fields = Fields(&record);
        let head = (|| Some((fields.bytes(1)?[0], fields.u64()?, fields.u64()?)))();
        fields.u64();
        let (Some((FOOTER, 20, start)), Some(stored)) = (head, fields.u32()) else {
            return Ok(None);
        };
        let (mut spare, mut held) = (Spare::new(), 0_u64);
        let mut scan = self.scan.beside(self.base.saturating_add(start));
        while scan.offset() < footer {
            scan.read(HEAD, &mut record)?;
            let mut fields = Fields(&record);
            let (Some(opcode), Some(length)) = (fields.bytes(1), fields.u64()) else {
                return Ok(None);
            };
            let opcode = opcode[0];
            let known = (SCHEMA..=DATA_END).contains(&opcode) && opcode != CHUNK;
            if !known || length > footer.saturating_sub(scan.offset()) {
                return Ok(None);
            }
            if matches!(opcode, SCHEMA | CHANNEL) {
                held += length;
                if held > DECLARED_LIMIT as u64 {
                    return Ok(None);
                }
                scan.read(length, &mut record)?;
                if let Some(id) = Fields(&record).u16() {
                    spare.entry((opcode, id.into())).or_insert(record.clone());
                }
            } else {
                scan.skip(length)?;
            }
        }
        // The CRC goes up to the field that holds it.
        scan.read(FOOTER_BYTES - 4, &mut record)?;
        Ok((stored == 0 || scan.crc() == Some(stored)).then_some(spare))
    }

    /// Enters connection `id` of a bag as its index repeats it, if it does.
    pub(super) fn bag_spare(&mut self, id: u32) {
        if self.spare.is_none() {
            self.spare = Some(self.bag_connections().unwrap_or_default());
        }
        let found = self.spare.as_mut();
        if let Some(content) = found.and_then(|spare| spare.remove(&(bag::CONNECTION, id)))
            && let mut fields = Fields(&content)
            && let (Some(header), Some(data)) = (fields.counted(), fields.counted())
        {
            let _ = self.bag_content(bag::CONNECTION, header, data, (0, false));
        }
    }

    fn bag_connections(&self) -> io::Result<Spare> {
        let (mut spare, mut held) = (Spare::new(), 0_u64);
        let Some(at) = self.index_at else {
            return Ok(spare);
        };
        let mut scan = self.scan.beside(self.base.saturating_add(at));
        let (mut header, mut data) = (Vec::new(), Vec::new());
        while bag::record(&mut scan, &mut header, &mut data)? {
            let (Some(bag::CONNECTION), Some(id)) =
                (bag::opcode(&header), bag::number(&header, b"conn"))
            else {
                break;
            };
            held += (header.len() + data.len()) as u64;
            if held > DECLARED_LIMIT as u64 {
                break;
            }
            let mut content = Vec::new();
            for part in [&header, &data] {
                content.extend(u32::try_from(part.len()).unwrap_or(0).to_le_bytes());
                content.extend(part.as_slice());
            }
            spare.entry((bag::CONNECTION, id)).or_insert(content);
        }
        Ok(spare)
    }
}
