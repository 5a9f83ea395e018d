//! What stands in pages: text that came from a user, pictures as part of the page.

use std::fmt::Write as _;

/// Text that came from a user, safe as content and as an attribute of HTML and of SVG.
///
/// XML has no place for most control characters, not even escaped: they become spaces.
///
/// ```
/// assert_eq!(grouser_figure::escaped("a < b"), "a &lt; b");
/// ```
#[must_use]
pub fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '&' => safe.push_str("&amp;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            letter if letter.is_control() => safe.push(' '),
            letter => safe.push(letter),
        }
    }
    safe
}

/// A PNG as an address that holds the picture itself (RFC 2397, RFC 4648).
///
/// ```
/// assert_eq!(grouser_figure::png_address(b"foo"), "data:image/png;base64,Zm9v");
/// ```
#[must_use]
pub fn png_address(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len() * 4 / 3 + 32);
    out.push_str("data:image/png;base64,");
    for group in bytes.chunks(3) {
        let byte = |index: usize| u32::from(group.get(index).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            if place <= group.len() {
                let letter = LETTERS[(bits >> (18 - 6 * place) & 63) as usize];
                // writing to a string cannot fail
                let _ = out.write_char(char::from(letter));
            } else {
                out.push('=');
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_a_name_is_markup() {
        assert_eq!(
            escaped("<img src=x onerror='a(\"b\")'>&\u{7}"),
            "&lt;img src=x onerror=&#39;a(&quot;b&quot;)&#39;&gt;&amp; "
        );
    }

    /// The test vectors of RFC 4648, section 10.
    #[test]
    fn base64_is_the_standards() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            let expected = format!("data:image/png;base64,{text}");
            assert_eq!(png_address(bytes.as_bytes()), expected);
        }
    }
}
