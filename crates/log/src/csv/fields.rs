//! The fields of a line.

use std::borrow::Cow;
use std::ops::Range;

/// What is wrong with the quotation marks of a line.
///
/// ```
/// use grouser_log::csv::split;
///
/// let bad = split("left,\"open", b',', &mut Vec::new()).unwrap_err();
/// assert_eq!(bad.field, 1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadQuote {
    /// The field, counted from 0.
    pub field: usize,
    /// What is wrong with it, in words.
    pub what: &'static str,
}

/// One field of a line, by its place in that line.
///
/// ```
/// use grouser_log::csv::split;
///
/// let line = "\"a \"\"b\"\"\", c";
/// let mut fields = Vec::new();
/// split(line, b',', &mut fields).expect("closed quotation marks");
/// assert_eq!((fields[0].value(line).as_ref(), fields[1].value(line).as_ref()), ("a \"b\"", "c"));
/// assert_eq!((fields[1].raw(line), fields[1].place()), (" c", 10..12));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    start: usize,
    end: usize,
    quoted: bool,
}

impl Field {
    /// The field as it is written, with its quotation marks.
    #[must_use]
    #[inline]
    pub fn raw(self, line: &str) -> &str {
        &line[self.place()]
    }

    /// The bytes of the line that the field takes, with its quotation marks.
    #[must_use]
    #[inline]
    pub fn place(self) -> Range<usize> {
        let mark = usize::from(self.quoted);
        self.start - mark..self.end + mark
    }

    /// The field without its outer quotation marks; doubled ones inside stay doubled.
    #[must_use]
    #[inline]
    pub fn text(self, line: &str) -> &str {
        &line[self.start..self.end]
    }

    /// The value of the field: a quoted one with its doubled quotation marks halved, another one without the blanks
    /// around it.
    #[must_use]
    #[inline]
    pub fn value(self, line: &str) -> Cow<'_, str> {
        let text = self.text(line);
        if self.quoted {
            unquoted(text)
        } else {
            Cow::Borrowed(trimmed(text))
        }
    }
}

/// A text between quotation marks with the doubled ones halved.
fn unquoted(text: &str) -> Cow<'_, str> {
    if text.contains("\"\"") {
        Cow::Owned(text.replace("\"\"", "\""))
    } else {
        Cow::Borrowed(text)
    }
}

/// The text without the blanks around it: most fields have none, and a look at both ends shows that.
#[inline]
fn trimmed(text: &str) -> &str {
    match (text.as_bytes().first(), text.as_bytes().last()) {
        (Some(first), Some(last)) if first.is_ascii_graphic() && last.is_ascii_graphic() => text,
        _ => text.trim(),
    }
}

/// The first place of a byte, by eight bytes at a time: what lies between separators is short.
#[inline]
fn find(bytes: &[u8], byte: u8) -> Option<usize> {
    const LOW_BITS: u64 = u64::from_le_bytes([0x01; 8]);
    const HIGH_BITS: u64 = u64::from_le_bytes([0x80; 8]);
    let (words, rest) = bytes.as_chunks::<8>();
    for (at, word) in words.iter().enumerate() {
        let differing = u64::from_le_bytes(*word) ^ u64::from_le_bytes([byte; 8]);
        // the lowest high bit that is set is that of the first byte that is 0
        let equal = differing.wrapping_sub(LOW_BITS) & !differing & HIGH_BITS;
        if equal != 0 {
            return Some(8 * at + equal.trailing_zeros() as usize / 8);
        }
    }
    let place = rest.iter().position(|other| *other == byte)?;
    Some(8 * words.len() + place)
}

/// The lines of a text without their ends, LF or CR LF.
///
/// ```
/// use grouser_log::csv::lines;
///
/// assert_eq!(lines("slip\r\n0.2\n\n0.3").collect::<Vec<_>>(), ["slip", "0.2", "", "0.3"]);
/// ```
pub fn lines(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = text;
    core::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let Some(end) = find(rest.as_bytes(), b'\n') else {
            return Some(core::mem::take(&mut rest));
        };
        let line = &rest[..end];
        rest = &rest[end + 1..];
        Some(line.strip_suffix('\r').unwrap_or(line))
    })
}

/// Splits `line` at `separator` into `fields`.
///
/// Blanks separate as a run, and none begins or ends the line, so that columns may be aligned.
///
/// A quoted field ends on its own line: in a log an open quotation mark would swallow the rows after it.
///
/// ```
/// use grouser_log::csv::split;
///
/// let line = r#"2.5, "sand, dry",left"#.replace(", \"", ",\"");
/// let mut fields = Vec::new();
/// split(&line, b',', &mut fields)?;
/// assert_eq!(fields[1].raw(&line), "\"sand, dry\"");
/// assert_eq!(fields[1].value(&line), "sand, dry");
/// # Ok::<(), grouser_log::csv::BadQuote>(())
/// ```
///
/// # Errors
/// [`BadQuote`] for a quotation mark that is not closed, or that text follows.
pub fn split(line: &str, separator: u8, fields: &mut Vec<Field>) -> Result<(), BadQuote> {
    fields.clear();
    let separates_in_runs = separator == b' ';
    let line = if separates_in_runs {
        line.trim_end_matches(' ')
    } else {
        line
    };
    let bytes = line.as_bytes();
    let mut at = 0;
    loop {
        while separates_in_runs && bytes.get(at) == Some(&b' ') {
            at += 1;
        }
        let quoted = bytes.get(at) == Some(&b'"');
        let (start, mut end) = (at + usize::from(quoted), at);
        if quoted {
            let field = fields.len();
            let bad = |what| BadQuote { field, what };
            end = start;
            loop {
                match (bytes.get(end), bytes.get(end + 1)) {
                    (None, _) => {
                        return Err(bad("has a quotation mark that is not closed on its line"));
                    }
                    (Some(b'"'), Some(b'"')) => end += 2,
                    (Some(b'"'), _) => break,
                    _ => end += 1,
                }
            }
            at = end + 1;
            if bytes.get(at).is_some_and(|next| *next != separator) {
                return Err(bad("has text behind its closing quotation mark"));
            }
        } else {
            let rest = &bytes[at..];
            end += find(rest, separator).unwrap_or(rest.len());
            at = end;
        }
        fields.push(Field { start, end, quoted });
        if at >= bytes.len() {
            return Ok(());
        }
        at += 1;
    }
}

/// `text` as a field: in quotation marks where a comma, a quotation mark or outer blanks require them. Line ends
/// become blanks, because a row is a line.
///
/// ```
/// assert_eq!(grouser_log::csv::quoted("sand, dry"), "\"sand, dry\"");
/// assert_eq!(grouser_log::csv::quoted("sand"), "sand");
/// ```
#[must_use]
pub fn quoted(text: &str) -> Cow<'_, str> {
    if text.contains(['"', ',', '\n', '\r']) || text.trim() != text {
        let doubled = text.replace('"', "\"\"").replace(['\n', '\r'], " ");
        Cow::Owned(format!("\"{doubled}\""))
    } else {
        Cow::Borrowed(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(line: &str) -> Result<Vec<&str>, BadQuote> {
        let mut found = Vec::new();
        split(line, b',', &mut found)?;
        Ok(found.iter().map(|field| field.text(line)).collect())
    }

    #[test]
    fn lines_split_as_tables_do() {
        assert_eq!(fields("a,b,c").unwrap(), ["a", "b", "c"]);
        assert_eq!(fields("a,,").unwrap(), ["a", "", ""]);
        assert_eq!(fields("").unwrap(), [""]);
        assert_eq!(fields("\"a,b\",c").unwrap(), ["a,b", "c"]);
        assert_eq!(fields("\"a\"\"b\"").unwrap(), ["a\"\"b"]);
        assert_eq!(fields("µ,\"é\"").unwrap(), ["µ", "é"]);
        assert_eq!(fields("a,\"b").unwrap_err().field, 1);
        assert_eq!(fields("\"a\"b,c").unwrap_err().field, 0);
        assert_eq!(fields("\"").unwrap_err().field, 0);
    }

    #[test]
    fn blanks_separate_as_a_run() {
        for line in ["0.5 -1 2", "0.5   -1 2", "  0.5 -1  2 "] {
            let mut found = Vec::new();
            split(line, b' ', &mut found).unwrap();
            let texts: Vec<&str> = found.iter().map(|field| field.text(line)).collect();
            assert_eq!(texts, ["0.5", "-1", "2"], "{line:?}");
        }
        let mut found = Vec::new();
        split("   ", b' ', &mut found).unwrap();
        assert_eq!(found.len(), 1);
    }

    #[test]
    fn bytes_are_found_at_every_place() {
        for length in 0..40 {
            for place in 0..length {
                // neighbours differ by the lowest bit: a borrow must not make one of them equal
                let mut bytes = vec![b'-'; length];
                assert_eq!(find(&bytes, b','), None);
                bytes[place..].fill(b',');
                assert_eq!(find(&bytes, b','), Some(place));
                bytes[..place].fill(0x80 | b',');
                assert_eq!(find(&bytes, b','), Some(place));
            }
        }
    }

    #[test]
    fn lines_end_as_those_of_the_standard_library() {
        for text in [
            "",
            "\n",
            "a",
            "a\r",
            "a\r\n",
            "µ\n\r\n\nb\r\r\nc\rd\n",
            "\n\na,b,c,d,e,f,g",
        ] {
            assert!(lines(text).eq(text.lines()), "{text:?}");
        }
    }

    #[test]
    fn outer_blanks_are_left_out() {
        for text in ["", " ", "a", " a", "a ", "ab", "\u{a0}a b\t", "µ", " µ"] {
            assert_eq!(trimmed(text), text.trim(), "{text:?}");
        }
    }

    #[test]
    fn what_is_quoted_reads_back() {
        for text in ["x, \"y\"", " 2 ", "plain", "", "\""] {
            let line = quoted(text);
            let mut found = Vec::new();
            split(&line, b',', &mut found).unwrap();
            assert_eq!(found.len(), 1);
            assert_eq!(found[0].value(&line), text);
            assert_eq!(found[0].raw(&line), line);
        }
        assert_eq!(quoted("a\nb"), "\"a b\"");
    }
}
