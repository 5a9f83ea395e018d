//! Damage to the content of a file.

use super::random::Random;

/// What stands in a text in place of a word.
pub(crate) const WORDS: [&str; 34] = [
    "nan",
    "NaN",
    "inf",
    "-inf",
    "0",
    "-0",
    "-1",
    "1",
    "1e300",
    "-1e300",
    "1e-300",
    "5e-324",
    "1.7976931348623157e308",
    "1e999",
    "9223372036854775807",
    "9223372036854775808",
    "-1e18",
    "90",
    "",
    "\"\"",
    "[]",
    "{}",
    "[[",
    "true",
    "0x7fffffff",
    "1_000",
    "\u{1b}[31mred",
    "\u{9b}2J",
    "../../../../etc/passwd",
    "/dev/zero",
    "\u{202e}",
    "٣",
    "a.b.c = 1",
    "1979-05-27",
];

/// Text or not: what is damaged by words, and what by bytes.
pub(crate) fn damage(content: &[u8], random: &mut Random) -> Vec<u8> {
    let mut content = content.to_vec();
    for _ in 0..=random.below(3) {
        content = match String::from_utf8(content) {
            Ok(text) if random.below(3) > 0 => by_words(&text, random).into_bytes(),
            Ok(text) => by_bytes(text.into_bytes(), random),
            Err(binary) => by_bytes(binary.into_bytes(), random),
        };
    }
    content
}

fn by_words(text: &str, random: &mut Random) -> String {
    let is_end = |c: char| matches!(c, ',' | ' ' | '\n' | '=' | '[' | ']' | '"' | '<' | '>');
    match random.below(5) {
        // another word in place of one
        0..3 => {
            let ends: Vec<usize> = text.match_indices(is_end).map(|(at, _)| at).collect();
            if ends.len() < 2 {
                return text.to_owned();
            }
            let place = random.below(ends.len() - 1);
            let (from, to) = (ends[place] + 1, ends[place + 1]);
            let word = random.one_of(&WORDS);
            format!("{}{word}{}", &text[..from], &text[to..])
        }
        // a line twice, or not at all
        3 => {
            let lines: Vec<&str> = text.lines().collect();
            let place = random.below(lines.len());
            let times = 2 * random.below(2);
            let mut out = String::new();
            for (i, line) in lines.iter().enumerate() {
                for _ in 0..if i == place { times } else { 1 } {
                    out.push_str(line);
                    out.push('\n');
                }
            }
            out
        }
        // something endless
        _ => {
            let many = ["[", "x", ",", "\n", "a.", "<a>", "1 "][random.below(7)];
            format!("{text}{}", many.repeat(1 << (4 + random.below(13))))
        }
    }
}

fn by_bytes(mut bytes: Vec<u8>, random: &mut Random) -> Vec<u8> {
    let length = bytes.len();
    if length == 0 {
        return vec![0xff; random.below(100)];
    }
    let at = random.below(length);
    match random.below(6) {
        0 => bytes.truncate(at),
        1 => bytes[at] ^= 1 << random.below(8),
        2 => {
            for _ in 0..=random.below(20) {
                let at = random.below(length);
                bytes[at] = random.bits().to_le_bytes()[0];
            }
        }
        // eight bytes of a length
        3 => {
            let length = [u64::MAX, 1 << 63, 1 << 31, (1 << 31) - 1, 0, 1][random.below(6)];
            let end = (at + 8).min(bytes.len());
            bytes[at..end].copy_from_slice(&length.to_le_bytes()[..end - at]);
        }
        4 => {
            let end = (at + random.below(1000)).min(length);
            bytes.drain(at..end);
        }
        _ => {
            let end = (at + random.below(1000)).min(length);
            let piece = bytes[at..end].to_vec();
            bytes.splice(at..at, piece);
        }
    }
    bytes
}
