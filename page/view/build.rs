//! Puts the page's files and modules into the program.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// The modules that `page/build` makes.
const MODULES: [&str; 4] = ["explore", "drive", "log", "optimize"];

fn main() {
    let here = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let page = here.parent().expect("in the folder of the page");
    let mut table = String::from("&[\n");
    let mut names: Vec<PathBuf> = fs::read_dir(page.join("web"))
        .expect("page/web")
        .map(|entry| entry.expect("page/web").path())
        .filter(|path| path.is_file())
        .collect();
    names.sort();
    for path in &names {
        add(&mut table, path);
    }
    for module in MODULES {
        let path = page.join("dist").join(format!("{module}.wasm.gz"));
        println!("cargo::rerun-if-changed={}", path.display());
        if !path.exists() {
            println!(
                "cargo::error={} is missing: run page/build, which makes it",
                path.display()
            );
            return;
        }
        add(&mut table, &path);
    }
    table.push(']');
    println!("cargo::rerun-if-changed={}", page.join("web").display());
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets it"));
    fs::write(out.join("assets.rs"), table).expect("the build folder");
}

fn add(table: &mut String, path: &Path) {
    let name = path.file_name().expect("a file").to_string_lossy();
    let _ = writeln!(
        table,
        "    (\"{name}\", include_bytes!({:?})),",
        path.to_string_lossy()
    );
}
