//! Reading a container out of any bytes.

use std::io::Cursor;
use std::path::Path;

use grouser_log::container::{Container, Event};
use grouser_log::message::{Decoder, View};

/// Reads `bytes` behind the magic bytes, which hardly a mutation would find.
pub fn read(magic: &[u8], bytes: &[u8]) {
    let file = if bytes.starts_with(magic) {
        bytes.to_vec()
    } else {
        [magic, bytes].concat()
    };
    let length = file.len() as u64;
    let Ok(mut container) = Container::over(Path::new("bytes"), Cursor::new(file)) else {
        return;
    };
    let mut decoders: Vec<Option<Decoder>> = Vec::new();
    let mut events = 0_u64;
    loop {
        for channel in &container.channels()[decoders.len()..] {
            decoders.push(Decoder::new(channel).ok());
        }
        let Some(event) = container.next() else { break };
        events += 1;
        // Chunks unfold, but each event costs at least a record's head out of what may unfold.
        assert!(events < (64 << 20) + 512 * length, "no end");
        match event {
            Event::Damage(damage) => {
                assert!(damage.offset <= length, "{damage:?}");
                assert!(damage.offset + damage.bytes <= length, "{damage:?}");
            }
            Event::Message(message) => {
                let decoder = decoders.get(message.channel).and_then(Option::as_ref);
                if let Some(Ok(value)) = decoder.map(|decoder| decoder.decode(message.data)) {
                    let _ = View::new(&message.of.type_name, &value);
                }
            }
        }
    }
    assert!(container.next().is_none(), "the end is not the end");
}
