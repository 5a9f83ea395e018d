//! The adapters in `examples/adapters` compile against declarations of what they use of each framework.

use std::path::Path;

use crate::compiler::{folder, needs_compiler, scratch};

/// Framework, and how it compiles its own code.
const FRAMEWORKS: [(&str, &[&str]); 3] = [
    ("ros2_control", &["-std=c++17"]),
    ("ardupilot", &["-std=c++11", "-fno-exceptions", "-fno-rtti"]),
    ("zephyr", &["-std=c++17", "-fno-rtti"]),
];

#[test]
fn the_code_of_each_adapter_compiles_against_its_framework_s_interfaces() {
    let Some(compiler) = needs_compiler("c++") else {
        return;
    };
    for (name, flags) in FRAMEWORKS {
        let adapter = folder().join(format!("examples/adapters/{name}.cpp"));
        let code = std::fs::read_to_string(adapter).unwrap();
        let source = scratch("adapters").join(format!("{name}.cpp"));
        let interfaces = folder().join(format!("tests/adapters/{name}.hpp"));
        std::fs::write(
            &source,
            format!("#include \"{}\"\n{code}", interfaces.display()),
        )
        .unwrap();
        let strict = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"];
        compiler.run(&[flags, &strict[..]].concat(), &[Path::new(&source)]);
    }
}
