//! Hashes of message types: REP 2016's RIHS01, SHA-256 over the canonical JSON of a type's description.
//!
//! Source: REP 2016 and `rosidl_generator_type_description` (Jazzy). Compared with the hashes of the Python package rosbags
//! for every type that is known here (`tests/peers.rs`).

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use grouser_log::message::known;
use sha2::{Digest as _, Sha256};

/// What Humble's rmw_zenoh writes, which has no hashes.
pub const UNSUPPORTED: &str = "TypeHashNotSupported";

/// `type_description_interfaces/FieldType`: numbers of the primitive types.
const PRIMITIVES: &[(&str, u32)] = &[
    ("int8", 2),
    ("uint8", 3),
    ("int16", 4),
    ("uint16", 5),
    ("int32", 6),
    ("uint32", 7),
    ("int64", 8),
    ("uint64", 9),
    ("float32", 10),
    ("float64", 11),
    ("char", 13),
    ("bool", 15),
    ("byte", 16),
    ("string", 17),
    ("wstring", 18),
];
const NESTED: u32 = 1;
/// Added to a type's number for arrays of fixed, of bounded, and of any length.
const FIXED_ARRAY: u32 = 48;
const BOUNDED_ARRAY: u32 = 96;
const UNBOUNDED_ARRAY: u32 = 144;

/// The hash of a type of [`known`], `RIHS01_` and 64 hexadecimal digits; `None` for a type that is not known.
///
/// ```
/// let hash = grouser_live::type_hash::of_known("std_msgs/Header").unwrap();
/// assert_eq!(hash, "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01");
/// ```
#[must_use]
pub fn of_known(type_name: &str) -> Option<String> {
    of_definition(type_name, &known::definition(type_name)?)
}

/// The hash of a type by its definition, with all types that it holds after `MSG:` lines.
#[must_use]
pub fn of_definition(type_name: &str, text: &str) -> Option<String> {
    let top = full_name(type_name, type_name);
    let types = fields_of_types(&top, text);
    let mut used = BTreeSet::new();
    collect_used(&top, &types, &mut used);
    used.remove(&top);
    let others: Option<Vec<String>> = used.iter().map(|name| describe(name, &types)).collect();
    let json = format!(
        "{{\"type_description\": {}, \"referenced_type_descriptions\": [{}]}}",
        describe(&top, &types)?,
        others?.join(", ")
    );
    let mut hash = String::from("RIHS01_");
    for byte in Sha256::digest(json) {
        let _ = write!(hash, "{byte:02x}");
    }
    Some(hash)
}

/// `package/msg/Type` of a name within a type of `own`'s package.
fn full_name(own: &str, name: &str) -> String {
    let package = own.split('/').next().unwrap_or_default();
    match name.rsplit_once('/') {
        None if name == "Header" => "std_msgs/msg/Header".to_owned(),
        None => format!("{package}/msg/{name}"),
        Some((package, name)) => {
            format!("{}/msg/{name}", package.trim_end_matches("/msg"))
        }
    }
}

type Fields = Vec<(String, String)>;

/// Type and name of every field of every type; constants and comments are no part of the description.
fn fields_of_types(top: &str, text: &str) -> BTreeMap<String, Fields> {
    let mut types = BTreeMap::from([(top.to_owned(), Fields::new())]);
    let mut at = top.to_owned();
    for line in text.lines() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if let Some(name) = line.strip_prefix("MSG: ") {
            at = full_name(name, name);
            types.insert(at.clone(), Fields::new());
            continue;
        }
        let mut words = line.split_whitespace();
        let (Some(kind), Some(name)) = (words.next(), words.next()) else {
            continue;
        };
        let is_constant = name.contains('=') || words.next().is_some_and(|w| w.starts_with('='));
        if !is_constant && let Some(fields) = types.get_mut(&at) {
            fields.push((kind.to_owned(), name.to_owned()));
        }
    }
    types
}

/// The element type of a field's type: `float64` of `float64[36]`.
fn element(kind: &str) -> &str {
    kind.split('[').next().unwrap_or(kind)
}

fn is_primitive(element: &str) -> bool {
    PRIMITIVES.iter().any(|(name, _)| *name == element)
}

fn collect_used(name: &str, types: &BTreeMap<String, Fields>, used: &mut BTreeSet<String>) {
    if !used.insert(name.to_owned()) {
        return;
    }
    for (kind, _) in types.get(name).into_iter().flatten() {
        let element = element(kind);
        if !is_primitive(element) {
            collect_used(&full_name(name, element), types, used);
        }
    }
}

fn describe(name: &str, types: &BTreeMap<String, Fields>) -> Option<String> {
    let mut out = format!("{{\"type_name\": \"{name}\", \"fields\": [");
    for (index, (kind, field)) in types.get(name)?.iter().enumerate() {
        let (capacity, array) = match kind.split_once('[') {
            None => (0, 0),
            Some((_, "]")) => (0, UNBOUNDED_ARRAY),
            Some((_, rest)) => {
                let rest = rest.trim_end_matches(']');
                match rest.strip_prefix("<=") {
                    Some(bound) => (bound.parse::<u64>().ok()?, BOUNDED_ARRAY),
                    None => (rest.parse::<u64>().ok()?, FIXED_ARRAY),
                }
            }
        };
        let element = element(kind);
        let primitive = PRIMITIVES.iter().find(|(name, _)| *name == element);
        let (number, nested) = primitive.map_or_else(
            || (NESTED, full_name(name, element)),
            |(_, n)| (*n, String::new()),
        );
        let comma = if index > 0 { ", " } else { "" };
        let _ = write!(
            out,
            "{comma}{{\"name\": \"{field}\", \"type\": {{\"type_id\": {}, \"capacity\": {capacity}, \
             \"string_capacity\": 0, \"nested_type_name\": \"{nested}\"}}}}",
            number + array
        );
    }
    out.push_str("]}");
    Some(out)
}
