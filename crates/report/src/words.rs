//! Text that came from a file.

/// The text without control characters: a name out of a file cannot move a terminal's cursor.
///
/// ```
/// assert_eq!(grouser_report::printable("left\u{1b}[2J"), "left\u{fffd}[2J");
/// ```
#[must_use]
pub fn printable(text: &str) -> String {
    text.chars()
        .map(|letter| {
            if letter.is_control() {
                char::REPLACEMENT_CHARACTER
            } else {
                letter
            }
        })
        .collect()
}
