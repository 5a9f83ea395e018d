//! The node in ROS 2's graph: DDS names participants, readers and writers, but no nodes, so each participant publishes which
//! node has which of them.
//!
//! Source: `rmw_dds_common`, messages `ParticipantEntitiesInfo`, `NodeEntitiesInfo` and `Gid`, topic `ros_discovery_info`.

use grouser_log::message::{Definition, Value, build};

use crate::error::{Error, Result};

/// The topic, without the prefix of messages.
pub(super) const TOPIC: &str = "ros_discovery_info";
/// Its type, in DDS.
pub(super) const TYPE: &str = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";
const MESSAGE: &str = "rmw_dds_common/msg/ParticipantEntitiesInfo";

/// The bytes of a DDS entity's identifier.
pub(super) type Guid = [u8; 16];

/// The length of a `Gid`: up to Humble, which has no hashes of types either, 24 bytes, the last eight zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GidLength {
    Humble = 24,
    Later = 16,
}

/// What a participant has, as the message.
pub(super) fn message(
    length: GidLength,
    participant: Guid,
    node: &str,
    [readers, writers]: [&[Guid]; 2],
) -> Result<Vec<u8>> {
    let text = format!(
        "Gid gid\nNodeEntitiesInfo[] node_entities_info_seq\n\
         ===\nMSG: rmw_dds_common/Gid\nuint8[{length}] data\n\
         ===\nMSG: rmw_dds_common/NodeEntitiesInfo\n\
         string node_namespace\nstring node_name\nGid[] reader_gid_seq\nGid[] writer_gid_seq\n",
        length = length as usize
    );
    let gid = |guid: &Guid| {
        let mut bytes = guid.to_vec();
        bytes.resize(length as usize, 0);
        build::message([("data", Value::Bytes(bytes))])
    };
    let gids = |guids: &[Guid]| Value::Array(guids.iter().map(gid).collect());
    let (namespace, name) = node.rsplit_once('/').unwrap_or(("", node));
    let namespace = if namespace.is_empty() { "/" } else { namespace };
    let node = build::message([
        ("node_namespace", Value::Text(namespace.into())),
        ("node_name", Value::Text(name.into())),
        ("reader_gid_seq", gids(readers)),
        ("writer_gid_seq", gids(writers)),
    ]);
    let info = build::message([
        ("gid", gid(&participant)),
        ("node_entities_info_seq", Value::Array(vec![node])),
    ]);
    let failed = |error: grouser_log::message::MessageError| Error::Transport {
        name: "dds",
        what: error.to_string(),
    };
    let definition = Definition::parse(MESSAGE, &text).map_err(failed)?;
    definition.encode(&info).map_err(failed)
}
