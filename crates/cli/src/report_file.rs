//! `--report`: a result as one HTML file, the page that shows it.

use std::path::{Path, PathBuf};

use grouser_page::Document;
use grouser_report::Object;
use serde_json::{Value, json};

use crate::error::{Error, Result, shown};
use crate::figure_file::ending;
use crate::output::OutputFile;
use crate::session::Session;

/// The flag.
#[derive(clap::Args, Debug)]
pub(crate) struct ReportFlag {
    /// Write a report, a self-contained page for the browser (.html)
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
}

impl ReportFlag {
    /// Is a report required?
    pub(crate) const fn is_given(&self) -> bool {
        self.report.is_some()
    }

    /// Begins the file, so that a path that cannot be written is refused before the work; `None` without the flag.
    pub(crate) fn begin(&self) -> Result<Option<ReportFile>> {
        let Some(path) = &self.report else {
            return Ok(None);
        };
        if !matches!(ending(path).as_deref(), Some("html" | "htm")) {
            return Err(Error::usage_without_hint(format!(
                "the report {} does not end in `.html`",
                shown(path)
            )));
        }
        OutputFile::create(path).map(|file| Some(ReportFile(file)))
    }
}

/// A report that has been begun.
pub(crate) struct ReportFile(OutputFile);

impl ReportFile {
    /// Writes a page that is complete; gives the line that says so.
    pub(crate) fn write_page(self, html: &str) -> Result<String> {
        self.0.write_whole(html.as_bytes())
    }

    /// Writes the page; gives the line that says so. `shown` is what the page reads: `runs`, or an `answer`.
    pub(crate) fn write(self, title: &str, shown: Object, session: &Session) -> Result<String> {
        let mut report = json!({ "title": title, "provenance": provenance(session) });
        if let Some(report) = report.as_object_mut() {
            report.extend(shown);
        }
        let html = Document::of_report("report.json", &report)
            .html()
            .map_err(|error| Error::usage_without_hint(error.to_string()))?;
        self.write_page(&html)
    }
}

/// Words and values that say where the numbers come from.
fn provenance(session: &Session) -> Vec<(String, String)> {
    let mut rows = Vec::new();
    for (name, value) in session.provenance() {
        match value {
            Value::Null => {}
            Value::String(text) => rows.push((name, text)),
            Value::Object(files) if name == "input_sha256" => {
                for (file, hash) in files {
                    let name = Path::new(&file)
                        .file_name()
                        .map_or(file.clone(), |name| name.to_string_lossy().into_owned());
                    rows.push((
                        name,
                        format!("SHA-256 {}", hash.as_str().unwrap_or_default()),
                    ));
                }
            }
            Value::Object(soil) => {
                let of = |key: &str| soil[key].as_str().unwrap_or_default().to_owned();
                rows.push((format!("soil {}", of("key")), of("source")));
            }
            other => rows.push((name, other.to_string())),
        }
    }
    rows
}
