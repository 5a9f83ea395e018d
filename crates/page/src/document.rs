//! The page as one HTML file: one style and one script, both allowed by their hash, and the modules as data.

use std::borrow::Cow;
use std::io::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use sha2::{Digest, Sha256};

use crate::bundle::bundle;
use crate::error::{Error, Result};
use crate::files;

/// The page as one HTML file.
///
/// ```
/// use grouser_page::Document;
///
/// let table = "time_s,wheel,slip,slip_sigma,motion,health\n";
/// let html = Document::of_file("slips.csv", table.as_bytes()).html()?;
/// assert!(html.contains("data-name=\"slips.csv\""));
/// # Ok::<(), grouser_page::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Document<'a> {
    modules: Vec<(&'a str, &'a [u8])>,
    opens: Option<(&'a str, Cow<'a, [u8]>)>,
}

impl<'a> Document<'a> {
    /// The page without a run.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The page that opens with a file: a table of `grouser estimate -o`, or a report.
    #[must_use]
    pub fn of_file(name: &'a str, bytes: &'a [u8]) -> Self {
        Self::new().opening(name, Cow::Borrowed(bytes))
    }

    /// The page that opens with a report: an object with `title`, `runs` of [`run`](crate::run), and `provenance`.
    #[must_use]
    pub fn of_report(name: &'a str, report: &serde_json::Value) -> Self {
        Self::new().opening(name, Cow::Owned(report.to_string().into_bytes()))
    }

    /// Adds a module that computes in the page, compressed by gzip.
    #[must_use]
    pub fn module(mut self, name: &'a str, gzip: &'a [u8]) -> Self {
        self.modules.push((name, gzip));
        self
    }

    fn opening(mut self, name: &'a str, bytes: Cow<'a, [u8]>) -> Self {
        self.opens = Some((name, bytes));
        self
    }

    /// The file.
    ///
    /// # Errors
    /// Never for what is in it: only for a page that is not complete.
    pub fn html(&self) -> Result<String> {
        let script = bundle("main.js", &files::text)?;
        let style = [files::text("style.css")?, files::text("face.css")?].concat();
        for (name, text) in [("main.js", script.as_str()), ("style.css", style.as_str())] {
            if text.contains("</script") || text.contains("</style") || text.contains("<!--") {
                return Err(Error::Script {
                    file: name.to_owned(),
                    line: "a tag that would end the script".to_owned(),
                });
            }
        }
        let policy = policy(&[
            (
                "script-src",
                &format!("'{}' 'wasm-unsafe-eval'", hash(&script)),
            ),
            ("style-src", &format!("'{}'", hash(&style))),
            ("connect-src", "'none'"),
            // long computations beside the page; the worker's script is the page's
            ("worker-src", "blob:"),
        ]);
        let mut data = String::new();
        for (name, bytes) in &self.modules {
            data.push_str(&block(&format!("wasm-{name}"), None, bytes));
        }
        if let Some((name, bytes)) = &self.opens {
            data.push_str(&block("embedded", Some(name), &gzip(bytes)));
        }
        let html = files::text("index.html")?;
        let html = between(
            html,
            "<meta http-equiv=\"Content-Security-Policy\"",
            ">",
            &format!("<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">"),
        )?;
        let html = between(
            &html,
            "<link rel=\"stylesheet\"",
            ">",
            &format!("<style>{style}</style>"),
        )?;
        let html = between(&html, "<link rel=\"stylesheet\"", ">\n", "")?;
        let html = between(&html, "<script type=\"module\"", "</script>\n", "")?;
        // after the body: the script finds the page and the data
        between(
            &html,
            "</body>",
            "</body>",
            &format!("{data}<script id=\"script\">{script}</script>\n</body>"),
        )
    }
}

/// A content security policy that allows these sources beside the page's own data, and nothing else.
fn policy(allowed: &[(&str, &str)]) -> String {
    let mut policy = String::from(
        "default-src 'none'; img-src data: blob:; font-src data:; base-uri 'none'; form-action 'none'; object-src 'none'",
    );
    for (kind, sources) in allowed {
        policy.push_str("; ");
        policy.push_str(kind);
        policy.push(' ');
        policy.push_str(sources);
    }
    policy
}

/// The policy of a page from a server, which allows the page's own files.
#[must_use]
pub fn server_policy() -> String {
    let mut policy = policy(&[
        ("script-src", "'self' 'wasm-unsafe-eval'"),
        ("style-src", "'self'"),
        ("connect-src", "'self'"),
        ("worker-src", "'self'"),
    ]);
    policy.push_str("; frame-ancestors 'none'");
    policy
}

fn hash(text: &str) -> String {
    format!(
        "sha256-{}",
        STANDARD.encode(Sha256::digest(text.as_bytes()))
    )
}

/// Bytes compressed, as browsers unpack them.
fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    // writing to a vector cannot fail
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

/// Bytes as a block that no browser runs.
fn block(id: &str, name: Option<&str>, bytes: &[u8]) -> String {
    let name = name.map_or_else(String::new, |name| {
        format!(" data-name=\"{}\"", attribute(name))
    });
    format!(
        "<script type=\"application/octet-stream\" id=\"{id}\"{name}>{}</script>\n",
        STANDARD.encode(bytes)
    )
}

/// A text as the value of an attribute.
#[must_use]
pub fn attribute(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_control())
        .map(|c| match c {
            '&' => "&amp;".to_owned(),
            '<' => "&lt;".to_owned(),
            '>' => "&gt;".to_owned(),
            '"' => "&quot;".to_owned(),
            c => c.to_string(),
        })
        .collect()
}

/// `html` with the part from `from` to the next `to` replaced.
fn between(html: &str, from: &str, to: &str, by: &str) -> Result<String> {
    let missing = || Error::Missing {
        name: format!("{from} in index.html"),
    };
    let start = html.find(from).ok_or_else(missing)?;
    let length = html[start..].find(to).ok_or_else(missing)? + to.len();
    Ok([&html[..start], by, &html[start + length..]].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_needs_nothing_from_elsewhere() {
        let html = Document::new()
            .module("explore", b"bytes")
            .html()
            .expect("complete");
        // the face is in the page
        let html = html.replace("url(\"data:font/woff2;base64,", "");
        for needs in [
            " src=",
            "rel=\"stylesheet",
            "\nimport ",
            "import(",
            "@import",
            "url(",
        ] {
            assert!(!html.contains(needs), "{needs}");
        }
        assert_eq!(html.matches("<script id=").count(), 1);
        assert!(html.contains("id=\"wasm-explore\">Ynl0ZXM=</script>"));
    }

    #[test]
    fn the_policy_has_the_hash_of_the_script_that_is_there() {
        let html = Document::new().html().expect("complete");
        let script = html
            .split("<script id=\"script\">")
            .nth(1)
            .expect("a script");
        let script = script.split("</script>").next().expect("its end");
        assert!(html.contains(&hash(script)));
        assert!(!html.contains("unsafe-inline") && !html.contains("'unsafe-eval'"));
    }

    #[test]
    fn a_hostile_file_name_stays_a_value() {
        let name = "\"><img src=x onerror=alert(1)>\0.csv";
        let html = Document::of_file(name, b"<script>")
            .html()
            .expect("complete");
        assert!(!html.contains("<img"));
        assert!(html.contains("data-name=\"&quot;&gt;&lt;img src=x onerror=alert(1)&gt;.csv\""));
    }
}
