//! Formulas as words: numbers, names, signs.

use super::error::{FormulaError, Result};

/// A word of a formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Word<'a> {
    Number(f64),
    Name(&'a str),
    Plus,
    Minus,
    Times,
    Divide,
    Power,
    Open,
    Close,
    Comma,
    Relation(Relation),
}

/// How the two sides of a constraint relate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// `<=`.
    AtMost,
    /// `>=`.
    AtLeast,
    /// `=`.
    Equal,
}

/// A word with its column.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token<'a> {
    pub(super) word: Word<'a>,
    pub(super) column: usize,
}

impl Token<'_> {
    /// The word as messages show it.
    pub(super) fn shown(&self) -> String {
        match &self.word {
            Word::Number(value) => format!("the number {value}"),
            Word::Name(name) => format!("`{name}`"),
            Word::Plus => "`+`".to_owned(),
            Word::Minus => "`-`".to_owned(),
            Word::Times => "`*`".to_owned(),
            Word::Divide => "`/`".to_owned(),
            Word::Power => "`^`".to_owned(),
            Word::Open => "`(`".to_owned(),
            Word::Close => "`)`".to_owned(),
            Word::Comma => "`,`".to_owned(),
            Word::Relation(Relation::AtMost) => "`<=`".to_owned(),
            Word::Relation(Relation::AtLeast) => "`>=`".to_owned(),
            Word::Relation(Relation::Equal) => "`=`".to_owned(),
        }
    }
}

/// Splits a text into words. Also gives the column just past its end.
pub(super) fn tokens(text: &str) -> Result<(Vec<Token<'_>>, usize)> {
    let bytes = text.as_bytes();
    let mut list = Vec::new();
    let (mut at, mut column) = (0, 1);
    while let Some(character) = text[at..].chars().next() {
        let length = match character {
            c if c.is_whitespace() => {
                at += c.len_utf8();
                column += 1;
                continue;
            }
            '0'..='9' | '.' => number_length(&bytes[at..]),
            'a'..='z' | '_' => name_length(&bytes[at..]),
            '<' | '>' if bytes.get(at + 1) == Some(&b'=') => 2,
            _ => character.len_utf8(),
        };
        let piece = &text[at..at + length];
        let word = match character {
            '0'..='9' | '.' => number(piece, column)?,
            'a'..='z' | '_' => Word::Name(piece),
            '+' => Word::Plus,
            '-' | '\u{2212}' => Word::Minus,
            '*' | '\u{b7}' => Word::Times,
            '/' => Word::Divide,
            '^' => Word::Power,
            '(' => Word::Open,
            ')' => Word::Close,
            ',' => Word::Comma,
            '=' => Word::Relation(Relation::Equal),
            '<' if length == 2 => Word::Relation(Relation::AtMost),
            '>' if length == 2 => Word::Relation(Relation::AtLeast),
            character => return Err(FormulaError::Character { column, character }),
        };
        list.push(Token { word, column });
        at += length;
        column += piece.chars().count();
    }
    Ok((list, column))
}

fn name_length(bytes: &[u8]) -> usize {
    bytes
        .iter()
        .take_while(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || **b == b'_')
        .count()
}

/// Digits, at most one point among them, and an exponent if one is complete: `1e-8`, `.5`, `2.`.
fn number_length(bytes: &[u8]) -> usize {
    let digits = |from: usize| {
        bytes[from..]
            .iter()
            .take_while(|b| b.is_ascii_digit())
            .count()
    };
    let mut length = digits(0);
    if bytes.get(length) == Some(&b'.') {
        length += 1;
        length += digits(length);
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        let exponent = length + 1 + sign;
        if exponent <= bytes.len() && digits(exponent) > 0 {
            return exponent + digits(exponent);
        }
    }
    length
}

fn number(text: &str, column: usize) -> Result<Word<'_>> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Word::Number(value)),
        Ok(_) => Err(FormulaError::NumberTooLarge {
            column,
            text: text.chars().take(32).collect(),
        }),
        Err(_) => Err(FormulaError::Character {
            column,
            character: '.',
        }),
    }
}
