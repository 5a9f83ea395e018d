//! One line of a CSV file: its fields as they stand, and what they say.

use std::borrow::Cow;

/// Why a line cannot be cut into fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Broken {
    /// A quotation mark is not closed.
    OpenQuote,
    /// Something stands between a closing quotation mark and the next comma.
    AfterQuote,
}

impl Broken {
    /// What is wrong, in words.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::OpenQuote => "a quotation mark is not closed on its line",
            Self::AfterQuote => "there is text behind a closing quotation mark",
        }
    }
}

/// Room for the fields of most tables, so that a line's list does not move while it grows.
const FIELDS: usize = 16;

/// The fields of a line without its line end, quotation marks and all.
pub(crate) fn split(line: &str) -> Result<Vec<&str>, Broken> {
    let mut fields = Vec::with_capacity(FIELDS);
    let mut rest = line;
    loop {
        let end = if rest.starts_with('"') {
            quoted_end(rest)?
        } else {
            let comma = rest.as_bytes().iter().position(|byte| *byte == b',');
            comma.unwrap_or(rest.len())
        };
        let (field, behind) = rest.split_at(end);
        fields.push(field);
        match behind.strip_prefix(',') {
            Some(next) => rest = next,
            None if behind.is_empty() => return Ok(fields),
            None => return Err(Broken::AfterQuote),
        }
    }
}

/// Where the quoted field at the start of `text` ends.
fn quoted_end(text: &str) -> Result<usize, Broken> {
    let bytes = text.as_bytes();
    let mut at = 1;
    while at < bytes.len() {
        match (bytes[at], bytes.get(at + 1)) {
            (b'"', Some(b'"')) => at += 2,
            (b'"', _) => return Ok(at + 1),
            _ => at += 1,
        }
    }
    Err(Broken::OpenQuote)
}

/// A name as a field: in quotation marks where it needs them.
pub(crate) fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

/// What a field says: without its quotation marks and the blanks around it.
pub(crate) fn content(field: &str) -> Cow<'_, str> {
    match field
        .strip_prefix('"')
        .and_then(|inner| inner.strip_suffix('"'))
    {
        Some(inner) if inner.contains("\"\"") => Cow::Owned(inner.replace("\"\"", "\"")),
        Some(inner) => Cow::Borrowed(inner),
        None => Cow::Borrowed(match field.as_bytes() {
            [] => field,
            // nothing to trim, as nearly always
            [first, .., last] if first.is_ascii_graphic() && last.is_ascii_graphic() => field,
            _ => field.trim(),
        }),
    }
}

/// A text as a field, in quotation marks where it needs them.
pub(crate) fn field(text: &str) -> Cow<'_, str> {
    if text.contains(['"', ',', '\n', '\r']) || text.trim() != text {
        Cow::Owned(format!(
            "\"{}\"",
            text.replace('"', "\"\"").replace(['\n', '\r'], " ")
        ))
    } else {
        Cow::Borrowed(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_cut_and_read() {
        assert_eq!(split("a,,b"), Ok(vec!["a", "", "b"]));
        assert_eq!(split(""), Ok(vec![""]));
        let fields = split(r#""x, ""y""", 2 ,"#).unwrap();
        assert_eq!(fields, [r#""x, ""y""""#, " 2 ", ""]);
        assert_eq!(content(fields[0]), r#"x, "y""#);
        assert_eq!(content(fields[1]), "2");
        assert_eq!(content(&field("x, \"y\"")), "x, \"y\"");
    }

    #[test]
    fn broken_lines_are_told() {
        assert_eq!(split(r#"1,"open"#), Err(Broken::OpenQuote));
        assert_eq!(split(r#""a"b,1"#), Err(Broken::AfterQuote));
    }
}
