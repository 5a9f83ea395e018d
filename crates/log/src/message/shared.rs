//! One decoder for all channels of one definition: eight thousand channels may name one of 4 MiB.

use std::sync::Arc;

use super::{Decoder, Value};
use crate::container::{Channel, Encoding};

/// A decoder, or why there is none.
pub(crate) type SharedDecoder = Arc<std::result::Result<Decoder, String>>;

/// Decodes a message into `value`, or says why not.
pub(crate) fn decode(
    decoder: &SharedDecoder,
    data: &[u8],
    value: &mut Value,
) -> Result<(), String> {
    let decoder = decoder.as_ref().as_ref().map_err(String::clone)?;
    let decoded = decoder.decode_into(data, value);
    decoded.map_err(|error| error.to_string())
}

/// The decoders of a file's channels.
#[derive(Default)]
pub(crate) struct Decoders(Vec<Known>);

struct Known {
    type_name: String,
    encoding: Encoding,
    encoding_name: String,
    language: String,
    definition: Arc<[u8]>,
    decoder: SharedDecoder,
}

impl Decoders {
    /// The decoder of a channel: that of an earlier one which is laid out alike, or a new one.
    pub(crate) fn of(&mut self, channel: &Channel) -> SharedDecoder {
        // A file's equal definitions are held once, so that their addresses identify them.
        let alike = |known: &&Known| {
            Arc::ptr_eq(&known.definition, &channel.definition)
                && known.encoding == channel.encoding
                && known.type_name == channel.type_name
                && known.encoding_name == channel.encoding_name
                && known.language == channel.definition_language
        };
        if let Some(known) = self.0.iter().find(alike) {
            return Arc::clone(&known.decoder);
        }
        let decoder = Arc::new(Decoder::new(channel).map_err(|error| error.to_string()));
        self.0.push(Known {
            type_name: channel.type_name.clone(),
            encoding: channel.encoding,
            encoding_name: channel.encoding_name.clone(),
            language: channel.definition_language.clone(),
            definition: Arc::clone(&channel.definition),
            decoder: Arc::clone(&decoder),
        });
        decoder
    }
}
