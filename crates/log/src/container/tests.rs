//! What a test can reach of a container from inside alone.

use super::*;

#[test]
fn files_behind_each_other_have_so_many_channels_and_no_more() {
    let channel = |topic: &str| Channel {
        topic: topic.to_owned(),
        type_name: String::new(),
        encoding: Encoding::Json,
        encoding_name: "json".to_owned(),
        definition_language: String::new(),
        definition: [].into(),
        metadata: BTreeMap::new(),
    };
    let file = std::io::Cursor::new(mcap::MAGIC);
    let mut container = Container::over("channels".as_ref(), file).unwrap();
    container.channels = vec![channel("/before"); CHANNEL_LIMIT - 1];
    assert_eq!(container.enter(1, channel("/last")), Ok(()));
    assert_eq!(
        container.enter(2, channel("/more")),
        Err(too_many("channels"))
    );
    // one that is known is no other
    assert_eq!(container.enter(3, channel("/last")), Ok(()));
    assert_eq!(
        (container.channels.len(), container.ids.len()),
        (CHANNEL_LIMIT, 2)
    );
}
