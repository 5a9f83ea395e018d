//! The fields of a line.

/// What is wrong with a line's quotes, and in which field (from 0).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BadQuote {
    pub(crate) field: usize,
    pub(crate) what: &'static str,
}

/// Splits `line` at `separator` into `fields` (byte ranges of the line, quotes left out).
///
/// A field that begins with `"` ends with the next one that is not doubled; it cannot reach into the
/// next line, which in a log would swallow rows. Doubled quotes stay doubled: no number has any.
pub(crate) fn split(
    line: &str,
    separator: u8,
    fields: &mut Vec<(usize, usize)>,
) -> Result<(), BadQuote> {
    fields.clear();
    let bytes = line.as_bytes();
    let mut at = 0;
    loop {
        if bytes.get(at) == Some(&b'"') {
            let bad = |what| BadQuote {
                field: fields.len(),
                what,
            };
            let start = at + 1;
            let mut end = start;
            loop {
                match (bytes.get(end), bytes.get(end + 1)) {
                    (None, _) => return Err(bad("begins with a quote that its line does not end")),
                    (Some(b'"'), Some(b'"')) => end += 2,
                    (Some(b'"'), _) => break,
                    _ => end += 1,
                }
            }
            at = end + 1;
            if bytes.get(at).is_some_and(|next| *next != separator) {
                return Err(bad("goes on after its closing quote"));
            }
            fields.push((start, end));
        } else {
            let rest = &bytes[at..];
            let length = rest
                .iter()
                .position(|byte| *byte == separator)
                .unwrap_or(rest.len());
            fields.push((at, at + length));
            at += length;
        }
        if at >= bytes.len() {
            return Ok(());
        }
        at += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(line: &str) -> Result<Vec<&str>, BadQuote> {
        let mut ranges = Vec::new();
        split(line, b',', &mut ranges)?;
        Ok(ranges.iter().map(|&(a, b)| &line[a..b]).collect())
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
}
