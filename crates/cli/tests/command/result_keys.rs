//! The keys of results: the shared list is the command's, and the page and Python are compared with it in their own tests
//! (`page/wasm/tests/result_keys.rs`, `python/tests/test_command.py`).

use std::collections::BTreeSet;

use serde_json::Value;

use super::program::line;

#[test]
fn a_wheel_has_the_keys_of_the_list() {
    let list: Value = serde_json::from_str(include_str!("../result_keys.json")).unwrap();
    let json = line(
        "wheel --soil dry-sand --radius-m 0.125 --width-m 0.1 --load-n 60 --slope-deg 5 --grouser-height-m 0.01 \
         --grouser-count 12 --json",
    )
    .json();
    let found: BTreeSet<&str> = json.as_object().unwrap().keys().map(|key| &**key).collect();
    let keys = list["wheel"]["keys"].as_array().unwrap().iter();
    let keys: BTreeSet<&str> = keys.map(|key| key.as_str().unwrap()).collect();
    assert_eq!(found, keys);
}
