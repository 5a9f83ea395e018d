//! One run of the command: what was read, and how the result is printed.

use std::io;
use std::path::Path;

use grouser_files::Document;
use grouser_report::{Fields, Object, fields};
use grouser_terra::catalogue;
use serde_json::Value;

use crate::error::{Error, Result};
use crate::exit::Outcome;
use crate::files_in_use;
use crate::input::{self, Input};
use crate::terminal;
use crate::verb_report::{Medium, Report};

/// The run: remembers what went into the result.
#[derive(Debug)]
pub(crate) struct Session {
    json: bool,
    seed: Option<u64>,
    input_sha256: Object,
    soil: Option<Object>,
}

impl Session {
    /// A run that has read nothing yet.
    pub(crate) fn new(json: bool) -> Self {
        Self {
            json,
            seed: None,
            input_sha256: Object::new(),
            soil: None,
        }
    }

    /// Is the result one JSON object on standard output?
    pub(crate) fn is_json(&self) -> bool {
        self.json
    }

    /// A file was read to its end.
    pub(crate) fn used_input(&mut self, input: Input) {
        if let Some((path, digest)) = input.digest() {
            self.input_sha256.insert(path, Value::from(digest));
        }
    }

    /// A random stream was drawn from `seed`.
    pub(crate) fn used_seed(&mut self, seed: u64) {
        self.seed = Some(seed);
    }

    /// A file was read as a whole.
    pub(crate) fn used_document(&mut self, document: &Document) {
        let digest = input::digest(document.text().as_bytes());
        files_in_use::reads(Path::new(document.name()));
        self.input_sha256
            .insert(document.name().to_owned(), Value::from(digest));
    }

    /// A file was read by a library: its digest is of what it holds now.
    pub(crate) fn used_file(&mut self, path: &Path) -> Result<()> {
        let mut input = Input::open(path)?;
        io::copy(&mut input, &mut io::sink()).map_err(|error| Error::file("read", path, &error))?;
        self.used_input(input);
        Ok(())
    }

    /// A soil of the catalogue entered the result, named by a file.
    pub(crate) fn used_catalogue_soil(&mut self, key: &str) {
        let source = catalogue::find(key).map(|entry| entry.source);
        self.used_soil(key, source, None);
    }

    /// A soil entered the result, with the numbers that complete or override it.
    pub(crate) fn used_soil(&mut self, key: &str, source: Option<&str>, given: Option<Object>) {
        self.soil = Some(Object::from_iter([
            ("key".to_owned(), Value::from(key)),
            ("source".to_owned(), Value::from(source)),
            ("overrides".to_owned(), Value::from(given)),
        ]));
    }

    /// Prints the report, as JSON or as text, and its warnings.
    pub(crate) fn print(&self, report: Report) -> Result<Outcome> {
        let Report {
            outcome,
            mut object,
            text,
            medium,
            failure,
            warnings,
        } = report;
        if self.json {
            object.insert("provenance".to_owned(), Value::Object(self.provenance()));
            terminal::print_json(&Value::Object(object))?;
        } else {
            match medium {
                Medium::Text => terminal::print(&text)?,
                Medium::File => terminal::print_file(&text)?,
                Medium::Aside => terminal::remark(&text),
            }
        }
        if let Some(failure) = &failure {
            terminal::fail(failure);
        }
        // one screen would show twice what the text has
        let is_shown =
            |warning: &String| !self.json && terminal::is_one() && text.contains(warning);
        for warning in warnings.iter().filter(|of| !is_shown(of)) {
            terminal::warn(warning);
        }
        Ok(outcome)
    }

    /// Version, commit, seed, inputs and soil, as the JSON has them.
    pub(crate) fn provenance(&self) -> Object {
        fields().object(self)
    }
}

/// Version, commit, instruction set, seed, inputs and soil.
pub(crate) fn fields<'a>() -> Fields<'a, &'a Session> {
    let soil = fields! { |soil: &'a Object|
        "key" "key of the catalogue, or the file" = soil["key"].clone();
        "source" "where its numbers come from" = soil["source"].clone();
        "overrides" "numbers that complete or override it" = soil["overrides"].clone();
    };
    fields! { |session: &'a Session|
        "version" "version of the program" = env!("CARGO_PKG_VERSION");
        "commit" "commit that it was built from" = option_env!("GROUSER_COMMIT");
        "instructions" "the processor's instructions that it was computed with: `avx512`, `avx2` or `portable`; between \
            them last digits differ. `deterministic` in a build that has the same digits on all" = grouser_terra::instructions();
        "seed" "seed of random numbers" = session.seed;
        "input_sha256" "files that were read, with their SHA-256" values = Some(session.input_sha256.clone());
        "soil" "the soil" group(soil) = session.soil.as_ref();
    }
}
