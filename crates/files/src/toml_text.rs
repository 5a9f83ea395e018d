//! The text of a TOML file, key by key.

use std::fmt::Write as _; // writing to a String cannot fail

use crate::document::FORMAT;

/// A TOML file of ours while it is written; the readers read its numbers back to the same bits.
///
/// ```
/// use grouser_files::TomlText;
///
/// let mut text = TomlText::new(&["a cart"]);
/// text.text("name", "cart");
/// text.header("[[wheel]]");
/// text.number("radius_m", 0.1);
/// text.degrees("heading_deg", 90.0_f64.to_radians());
/// assert_eq!(
///     text.finish(),
///     "# a cart\nformat = 1\nname = \"cart\"\n\n[[wheel]]\nradius_m = 0.1\nheading_deg = 90.0\n"
/// );
/// ```
#[derive(Clone, Debug)]
pub struct TomlText(String);

impl TomlText {
    /// Begins a file with remarks, one line each, and its format.
    #[must_use]
    pub fn new(remarks: &[&str]) -> Self {
        let mut text = Self(String::new());
        for line in remarks.iter().flat_map(|remark| remark.lines()) {
            let line: String = line.chars().filter(|c| !c.is_control()).collect();
            let _ = writeln!(text.0, "# {line}");
        }
        text.whole("format", FORMAT);
        text
    }

    /// Begins a table; `header` with its brackets.
    pub fn header(&mut self, header: &str) {
        let _ = writeln!(self.0, "\n{header}");
    }

    /// A line as it stands.
    pub fn line(&mut self, line: &str) {
        let _ = writeln!(self.0, "{line}");
    }

    /// A whole number, which readers hold in 64 bits with a sign.
    ///
    /// ```
    /// # use grouser_files::TomlText;
    /// let mut text = TomlText::new(&[]);
    /// text.whole("starts", 16_usize);
    /// assert_eq!(text.finish(), "format = 1\nstarts = 16\n");
    /// ```
    pub fn whole(&mut self, key: &str, value: impl TryInto<i64>) {
        let _ = writeln!(self.0, "{key} = {}", value.try_into().unwrap_or(i64::MAX));
    }

    /// A whole number, if there is one.
    pub fn optional_whole(&mut self, key: &str, value: Option<impl TryInto<i64>>) {
        if let Some(value) = value {
            self.whole(key, value);
        }
    }

    /// A finite number.
    pub fn number(&mut self, key: &str, value: f64) {
        let _ = writeln!(self.0, "{key} = {value:?}");
    }

    /// A finite number, if there is one.
    pub fn optional_number(&mut self, key: &str, value: Option<f64>) {
        if let Some(value) = value {
            self.number(key, value);
        }
    }

    /// A number, unless it is 0, which the reader assumes.
    ///
    /// ```
    /// # use grouser_files::TomlText;
    /// let mut text = TomlText::new(&[]);
    /// text.nonzero("rebound", 0.0);
    /// assert_eq!(text.finish(), "format = 1\n");
    /// ```
    pub fn nonzero(&mut self, key: &str, value: f64) {
        self.optional_number(key, (value != 0.0).then_some(value));
    }

    /// A number in a unit `scale` times the SI one.
    ///
    /// ```
    /// # use grouser_files::TomlText;
    /// let mut text = TomlText::new(&[]);
    /// text.scaled("cohesion_kpa", 1040.0, 1e3);
    /// assert_eq!(text.finish(), "format = 1\ncohesion_kpa = 1.04\n");
    /// ```
    pub fn scaled(&mut self, key: &str, value: f64, scale: f64) {
        self.number(key, nearest(value / scale, |x| scale * x, value));
    }

    /// An angle in degrees, of `value` radians.
    pub fn degrees(&mut self, key: &str, value: f64) {
        self.number(key, nearest(value.to_degrees(), f64::to_radians, value));
    }

    /// A text.
    pub fn text(&mut self, key: &str, value: &str) {
        let _ = writeln!(self.0, "{key} = {}", quoted(value));
    }

    /// A text, if there is one.
    pub fn optional_text(&mut self, key: &str, value: Option<&str>) {
        if let Some(value) = value {
            self.text(key, value);
        }
    }

    /// A list of texts, unless it is empty.
    ///
    /// ```
    /// # use grouser_files::TomlText;
    /// let mut text = TomlText::new(&[]);
    /// text.texts("ignore", &["/tf".to_owned(), "/odom".to_owned()]);
    /// assert_eq!(text.finish(), "format = 1\nignore = [\"/tf\", \"/odom\"]\n");
    /// ```
    pub fn texts(&mut self, key: &str, values: &[String]) {
        if !values.is_empty() {
            let all: Vec<String> = values.iter().map(|value| quoted(value)).collect();
            let _ = writeln!(self.0, "{key} = [{}]", all.join(", "));
        }
    }

    /// `true`, or nothing for false.
    pub fn flag(&mut self, key: &str, value: bool) {
        if value {
            self.line(&format!("{key} = true"));
        }
    }

    /// A TOML basic string, for keys and lines that a caller composes.
    ///
    /// ```
    /// use grouser_files::TomlText;
    ///
    /// assert_eq!(TomlText::quoted("a \"b\""), r#""a \"b\"""#);
    /// ```
    #[must_use]
    pub fn quoted(text: &str) -> String {
        quoted(text)
    }

    /// The text.
    #[must_use]
    pub fn finish(self) -> String {
        self.0
    }
}

/// Of `guess` and its neighbours the one of fewest digits that `back` takes to `value` exactly, where there is one.
fn nearest(guess: f64, back: impl Fn(f64) -> f64, value: f64) -> f64 {
    let (up, down) = (guess.next_up(), guess.next_down());
    [guess, up, down, up.next_up(), down.next_down()]
        .into_iter()
        .filter(|x| back(*x) == value)
        .min_by_key(|x| format!("{x:?}").len())
        .unwrap_or(guess)
}

/// A TOML basic string.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}
