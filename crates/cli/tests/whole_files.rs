//! Every whole file that a program of the project writes goes through the one atomic writer.

use std::fs;

use crate::repository::{files, root};

/// What creates or truncates a file in place.
const IN_PLACE: [&str; 5] = [
    "fs::write(",
    "File::create(",
    ".write_text(",
    ".write_bytes(",
    "fs::rename(",
];
/// The writer itself.
const WRITER: &str = "crates/files/src/whole_file.rs";

#[test]
fn nothing_else_writes_whole_files() {
    let root = root();
    let mut sources = Vec::new();
    for krate in fs::read_dir(root.join("crates")).unwrap() {
        sources.extend(files(&krate.unwrap().path().join("src"), "rs"));
    }
    for folder in ["page/view/src", "page/wasm/src", "live/src", "python/src"] {
        sources.extend(files(&root.join(folder), "rs"));
    }
    sources.extend(files(&root.join("python/python"), "py"));
    assert!(sources.len() > 500, "{}", sources.len());
    let mut writer_has_it = false;
    for path in sources {
        let name = path.strip_prefix(&root).unwrap().display().to_string();
        let text = fs::read_to_string(&path).unwrap();
        // tests write their inputs as they like
        let program = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        let program = program.split("#[cfg(test)]\n#[allow").next().unwrap();
        let program = program.replace("OutputFile::create(", "");
        let program = program.replace("WholeFile::create(", "");
        let found = IN_PLACE.iter().find(|way| program.contains(**way));
        if name == WRITER {
            writer_has_it = found.is_some();
        } else if !name.contains("tests") {
            let way = found.unwrap_or(&"");
            assert!(way.is_empty(), "{name} uses `{way}`: use `WholeFile`");
        }
    }
    assert!(writer_has_it);
}
