//! Help no wider than a hundred columns.

/// Columns of help.
const MAX_COLUMNS: usize = 100;

/// The text with its long lines broken between words; what follows a break stands below the line's own text.
pub(crate) fn wrapped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for line in text.lines() {
        let margin = " ".repeat(margin(line));
        let mut width = 0;
        for (index, word) in line.split(' ').enumerate() {
            let length = word.chars().count();
            if index > 0 && width + 1 + length > MAX_COLUMNS && !word.is_empty() {
                out.truncate(out.trim_end_matches(' ').len());
                out.push('\n');
                out.push_str(&margin);
                width = margin.len();
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

/// Where the text of a line begins: behind a flag and the blanks that follow it, else behind its indentation.
fn margin(line: &str) -> usize {
    let indented = line.len() - line.trim_start().len();
    let text = &line[indented..];
    let is_entry = text.starts_with('-') || indented == 2;
    match text.find("  ").filter(|_| is_entry) {
        Some(gap) => line.chars().count() - text[gap..].trim_start().chars().count(),
        None => indented,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stay_whole_and_stand_below_the_text() {
        let long = format!("  --flag <X>  {}", "word ".repeat(30).trim_end());
        let text = wrapped(&long);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(lines[0].len() <= MAX_COLUMNS);
        assert!(lines[1].starts_with("              word"), "{text}");
        assert_eq!(text.split_whitespace().count(), 32);
        assert_eq!(wrapped("short\n\n  line\n"), "short\n\n  line\n");
    }
}
