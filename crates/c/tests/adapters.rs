//! The code of docs/adapters.md compiles against declarations of what it uses of each framework.

use std::path::{Path, PathBuf};

use crate::compiler::{folder, needs_compiler, scratch};

/// Framework, and how it compiles its own code.
const FRAMEWORKS: [(&str, &[&str]); 3] = [
    ("ros2_control", &["-std=c++17"]),
    ("ardupilot", &["-std=c++11", "-fno-exceptions", "-fno-rtti"]),
    ("zephyr", &["-std=c++17", "-fno-rtti"]),
];

fn page() -> PathBuf {
    folder().join("../../docs/adapters.md")
}

/// The page's blocks of C++, in their order.
fn blocks(text: &str) -> Vec<&str> {
    let parts = text.split("```cpp\n").skip(1);
    parts
        .map(|part| part.split("```").next().unwrap())
        .collect()
}

#[test]
fn the_code_of_each_adapter_compiles_against_its_framework_s_interfaces() {
    let Some(compiler) = needs_compiler("c++") else {
        return;
    };
    let text = std::fs::read_to_string(page()).unwrap();
    let blocks = blocks(&text);
    assert_eq!(blocks.len(), FRAMEWORKS.len());
    for ((name, flags), block) in FRAMEWORKS.iter().zip(blocks) {
        let source = scratch("adapters").join(format!("{name}.cpp"));
        let interfaces = folder().join(format!("tests/adapters/{name}.hpp"));
        std::fs::write(
            &source,
            format!("#include \"{}\"\n{block}", interfaces.display()),
        )
        .unwrap();
        let strict = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"];
        compiler.run(&[flags, &strict[..]].concat(), &[Path::new(&source)]);
    }
}
