//! Modules of script as one script: a file opened from the disk cannot import others.
//!
//! Each module becomes a function that returns what it exports, called once, after the modules that it imports.
//! The forms known are those that the page uses: `import { a, b as c } from './x.js';` and `export` before
//! `function`, `async function`, `class` and `const` at the start of a line.

use std::fmt::Write as _; // writing to a string cannot fail

use crate::error::{Error, Result};

/// One script of the module `main` and all that it imports; `read` gives a module's text.
pub(crate) fn bundle<'a>(main: &str, read: &dyn Fn(&str) -> Result<&'a str>) -> Result<String> {
    let mut bundle = Bundle {
        read,
        done: Vec::new(),
        open: Vec::new(),
        script: String::from("'use strict';\n"),
    };
    bundle.add(main)?;
    Ok(bundle.script)
}

struct Bundle<'r, 'a> {
    read: &'r dyn Fn(&str) -> Result<&'a str>,
    done: Vec<String>,
    open: Vec<String>,
    script: String,
}

impl Bundle<'_, '_> {
    fn add(&mut self, file: &str) -> Result<()> {
        if self.done.iter().any(|done| done == file) {
            return Ok(());
        }
        if self.open.iter().any(|open| open == file) {
            return Err(Error::Circle {
                file: file.to_owned(),
            });
        }
        self.open.push(file.to_owned());
        let text = (self.read)(file)?;
        let mut body = String::new();
        let mut exports = Vec::new();
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            if line.starts_with("import ") {
                let mut whole = line.to_owned();
                while !whole.trim_end().ends_with(';') {
                    let next = lines.next().ok_or_else(|| unknown(file, line))?;
                    whole.push(' ');
                    whole.push_str(next.trim());
                }
                let (names, from) = import(&whole).ok_or_else(|| unknown(file, &whole))?;
                self.add(from)?;
                let _ = writeln!(body, "const {{{names}}} = {};", variable(from));
            } else if let Some(declared) = line.strip_prefix("export ") {
                exports.push(exported(declared).ok_or_else(|| unknown(file, line))?);
                body.push_str(declared);
                body.push('\n');
            } else {
                body.push_str(line);
                body.push('\n');
            }
        }
        let _ = write!(
            self.script,
            "const {} = (() => {{\n{body}return {{ {} }};\n}})();\n",
            variable(file),
            exports.join(", ")
        );
        self.open.pop();
        self.done.push(file.to_owned());
        Ok(())
    }
}

fn unknown(file: &str, line: &str) -> Error {
    Error::Script {
        file: file.to_owned(),
        line: line.to_owned(),
    }
}

/// The names of an import as a pattern, and the file.
fn import(line: &str) -> Option<(String, &str)> {
    let rest = line.strip_prefix("import {")?;
    let (names, from) = rest.split_once("} from './")?;
    let file = from.trim_end().strip_suffix("';")?;
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
    (!file.is_empty() && file.chars().all(plain)).then(|| (names.replace(" as ", ": "), file))
}

/// The name that a declaration declares.
fn exported(declaration: &str) -> Option<&str> {
    let rest = ["async function ", "function ", "class ", "const "]
        .iter()
        .find_map(|kind| declaration.strip_prefix(kind))?;
    let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))?;
    (end > 0).then(|| &rest[..end])
}

fn variable(file: &str) -> String {
    format!("module_{}", file.replace('.', "_"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(file: &str) -> Result<&'static str> {
        match file {
            "main.js" => Ok(
                "import {\n  one,\n  two as zwei,\n} from './a.js';\nimport { three } from './b.js';\nzwei(one, three);\n",
            ),
            "a.js" => Ok(
                "import { three } from './b.js';\nexport const one = 1;\nexport async function two() { return three; }\n",
            ),
            "b.js" => Ok("export class three { }\nexport const FOUR = 4;\n"),
            "circle.js" => Ok("import { x } from './circle.js';\n"),
            "default.js" => Ok("export default 3;\n"),
            "far.js" => Ok("import { x } from 'https://example.org/x.js';\n"),
            other => Err(Error::Missing {
                name: other.to_owned(),
            }),
        }
    }

    #[test]
    fn a_module_comes_after_those_that_it_imports_and_once() {
        let script = bundle("main.js", &read).expect("known forms");
        let place = |text: &str| script.find(text).expect(text);
        assert!(place("const module_b_js") < place("const module_a_js"));
        assert!(place("const module_a_js") < place("const module_main_js"));
        assert_eq!(script.matches("const module_b_js").count(), 1);
        assert!(script.contains("two: zwei"));
        assert!(script.contains("return { three, FOUR };"));
        assert!(!script.contains("import ") && !script.contains("export "));
    }

    #[test]
    fn what_is_not_known_is_refused() {
        assert!(matches!(
            bundle("circle.js", &read),
            Err(Error::Circle { .. })
        ));
        assert!(matches!(
            bundle("default.js", &read),
            Err(Error::Script { .. })
        ));
        assert!(matches!(bundle("far.js", &read), Err(Error::Script { .. })));
        assert!(matches!(
            bundle("none.js", &read),
            Err(Error::Missing { .. })
        ));
    }
}
