//! Puts the page's modules into the program.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::{env, fs};

/// The modules that `page/build` makes.
const MODULES: [&str; 5] = ["explore", "drive", "figure", "log", "optimize"];

fn main() {
    let here = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let page = here.parent().expect("in the folder of the page");
    let mut table = String::from("&[\n");
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
        let _ = writeln!(
            table,
            "    (\"{module}\", include_bytes!({:?})),",
            path.to_string_lossy()
        );
    }
    table.push(']');
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets it"));
    fs::write(out.join("modules.rs"), table).expect("the build folder");
}
