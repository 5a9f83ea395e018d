//! A run in parts, as the page receives it while it grows: a head in JSON, and numbers.
//!
//! ```text
//! length of the head, u32 · head, JSON, filled up with blanks to a multiple of 8 · columns of f64, one after the other
//! ```
//! All little-endian. The head names the columns and counts their rows; a number that is missing is NaN.

use serde_json::{Value, json};

/// The bytes of a part: `head` is an object, every column has as many rows.
pub(super) fn bytes(mut head: Value, columns: &[(String, &[f64])]) -> Vec<u8> {
    let rows = columns.first().map_or(0, |(_, column)| column.len());
    if rows > 0 {
        let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        head["rows"] = json!(rows);
        head["columns"] = json!(names);
    }
    let mut head = head.to_string().into_bytes();
    while !(4 + head.len()).is_multiple_of(8) {
        head.push(b' ');
    }
    let mut out = Vec::with_capacity(4 + head.len() + 8 * rows * columns.len());
    // a head has the names of some columns and some changes: far below 4 GiB
    out.extend_from_slice(&u32::try_from(head.len()).unwrap_or(u32::MAX).to_le_bytes());
    out.extend_from_slice(&head);
    for (_, column) in columns {
        for value in *column {
            out.extend_from_slice(&value.to_le_bytes());
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_at_a_multiple_of_eight_bytes() {
        let (time, slip) = ([0.5, 1.0], [f64::NAN, -0.25]);
        let columns = [
            ("time_s".to_owned(), &time[..]),
            ("slip 0".to_owned(), &slip[..]),
        ];
        for name in ["a", "ab", "abcdefgh"] {
            let part = bytes(json!({ "begin": name }), &columns);
            let length = u32::from_le_bytes([part[0], part[1], part[2], part[3]]) as usize;
            assert_eq!((4 + length) % 8, 0);
            let head: Value = serde_json::from_slice(&part[4..4 + length]).expect("JSON");
            assert_eq!(head["columns"], json!(["time_s", "slip 0"]));
            let numbers = &part[4 + length..];
            assert_eq!(numbers.len(), 32);
            assert_eq!(numbers[8..16], 1.0_f64.to_le_bytes());
            assert_eq!(numbers[24..], (-0.25_f64).to_le_bytes());
        }
    }
}
