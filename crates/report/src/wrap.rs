//! Lines no wider than the terminal.

/// The text with its lines broken between words after `columns` characters. A continuation begins below the text of its line:
/// behind a flag and the blanks that follow it, else behind the indentation and `hanging` blanks.
///
/// ```
/// use grouser_report::wrapped;
///
/// assert_eq!(wrapped("  -v  more words\n", 12, 0), "  -v  more\n      words\n");
/// assert_eq!(wrapped("note: more words", 10, 2), "note: more\n  words\n");
/// ```
#[must_use]
pub fn wrapped(text: &str, columns: usize, hanging: usize) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.lines() {
        let margin = margin(line, hanging);
        let mut width = 0;
        for (index, word) in line.split(' ').enumerate() {
            let length = word.chars().count();
            if index > 0 && width + 1 + length > columns && !word.is_empty() && width > margin {
                out.truncate(out.trim_end_matches(' ').len());
                out.push('\n');
                out.extend(std::iter::repeat_n(' ', margin));
                width = margin;
            } else if index > 0 {
                out.push(' ');
                width += 1;
            }
            out.push_str(word);
            width += length;
        }
        out.push('\n');
    }
    out
}

fn margin(line: &str, hanging: usize) -> usize {
    let indented = line.len() - line.trim_start().len();
    let text = &line[indented..];
    let is_entry = text.starts_with('-') || indented == 2;
    match text.find("  ").filter(|_| is_entry) {
        Some(gap) => line.chars().count() - text[gap..].trim_start().chars().count(),
        None => indented + hanging,
    }
}
