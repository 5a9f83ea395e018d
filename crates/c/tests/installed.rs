//! The installed library: C++ by pkg-config and by CMake, and what it takes of a firmware's stack.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::compiler::{folder, library, needs_compiler, scratch};

/// Most stack of one push or tick for six wheels, bytes: what a task of a microcontroller is usually given.
const MAX_STACK_BYTES: u64 = 16_384;

/// Most memory of six wheels, bytes: 62,016 were measured by this test with 64-bit pointers; more needs a reason.
const MAX_MEMORY_BYTES: u64 = 64_000;

fn output(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {errors}");
    String::from_utf8(output.stdout).unwrap()
}

/// Installs into a folder of the test's own.
fn install(name: &str) -> PathBuf {
    let prefix = scratch(name).join("prefix");
    let _ = std::fs::remove_dir_all(&prefix);
    let mut command = Command::new(folder().join("install"));
    output(command.arg(&prefix).env("GROUSER_LIBRARY", library()));
    prefix
}

/// Both powered wheels slip by 0.2, within what the filter itself states.
fn check(program: &Path) {
    let printed = output(&mut Command::new(program));
    let number = |text: Option<&str>| -> f64 { text.unwrap().parse().unwrap() };
    let mut wheels = 0;
    for line in printed.lines() {
        let mut cells = line.split(' ');
        let (slip, sigma) = (number(cells.next()), number(cells.next()));
        assert!(sigma < 0.06 && (slip - 0.2).abs() < sigma, "{printed}");
        wheels += 1;
    }
    assert_eq!(wheels, 2, "{printed}");
}

#[test]
fn the_cpp_example_is_built_by_pkg_config() {
    if needs_compiler("c++").is_none() || needs_compiler("pkg-config").is_none() {
        return;
    }
    let prefix = install("pkg-config");
    let flags = output(
        Command::new("pkg-config")
            .args(["--cflags", "--libs", "grouser"])
            .env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig")),
    );
    let program = prefix.join("cart");
    let source = folder().join("examples/cart.cpp");
    let strict = ["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror"];
    let mut command = Command::new("c++");
    command
        .args(strict)
        .arg(source)
        .args(flags.split_whitespace());
    output(command.arg("-o").arg(&program));
    check(&program);
}

#[test]
fn the_cpp_example_is_built_by_cmake() {
    // not in CI's image: skipped where it is missing
    if Command::new("cmake").arg("--version").output().is_err() {
        eprintln!("skipped: there is no `cmake`");
        return;
    }
    let prefix = install("cmake");
    let project = scratch("cmake").join("project");
    std::fs::create_dir_all(&project).unwrap();
    let source = folder().join("examples/cart.cpp");
    let text = format!(
        "cmake_minimum_required(VERSION 3.10)\nproject(cart CXX)\nset(CMAKE_CXX_STANDARD 17)\n\
         find_package(grouser 0.1 REQUIRED)\nadd_executable(cart {})\n\
         target_link_libraries(cart grouser::grouser)\n",
        source.display()
    );
    std::fs::write(project.join("CMakeLists.txt"), text).unwrap();
    let build = project.join("build");
    let path = format!("-DCMAKE_PREFIX_PATH={}", prefix.display());
    let mut configure = Command::new("cmake");
    output(
        configure
            .arg(path)
            .arg("-S")
            .arg(&project)
            .arg("-B")
            .arg(&build),
    );
    output(Command::new("cmake").arg("--build").arg(&build));
    check(&build.join("cart"));
}

#[test]
fn a_cycle_fits_a_firmware_s_stack() {
    let Some(cc) = needs_compiler("cc") else {
        return;
    };
    let program = scratch("stack").join("stack");
    let source = folder().join("tests/stack.c");
    cc.run(
        &[
            "-std=c11",
            "-D_GNU_SOURCE",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-o",
            program.to_str().unwrap(),
        ],
        &[&source, &library()],
    );
    let printed = output(&mut Command::new(&program));
    let bytes: Vec<u64> = printed
        .split_whitespace()
        .map(|number| number.parse().unwrap())
        .collect();
    eprintln!(
        "on this machine, bytes: stack of new {}, of push and tick {}; memory of six wheels {}",
        bytes[0], bytes[1], bytes[2]
    );
    assert!(
        bytes[1] <= MAX_STACK_BYTES && bytes[2] <= MAX_MEMORY_BYTES,
        "{bytes:?}"
    );
}
