//! Limits of the system: threads, memory, the size of files. Each ends as an error, never as a panic or a signal.
#![cfg(target_os = "linux")]

use std::process::{Command, Stdio};

use super::program::{Folder, Said, wait};

/// Runs the program in a shell that has set a limit.
fn limited(limit: &str, stack: Option<&str>, words: &str) -> Said {
    let line = format!("{limit} && exec {} {words}", env!("CARGO_BIN_EXE_grouser"));
    let mut command = Command::new("sh");
    command.args(["-c", &line]).env("COLUMNS", "10000");
    if let Some(bytes) = stack {
        command.env("RUST_MIN_STACK", bytes);
    }
    let child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait(child)
}

/// A thread wants 64 GiB of stack, where 4 GiB are left: none can be started, and the results are the same.
#[test]
fn without_threads_the_verbs_do_the_same() {
    let folder = Folder::new();
    let rows = "lunar,0.1,0.1,0.2,40\n".repeat(3000);
    let table = folder.file(
        "in.csv",
        format!("soil,radius_m,width_m,slip,load_n\n{rows}"),
    );
    let batch = |name: &str| {
        format!(
            "batch {} -o {}",
            table.display(),
            folder.path(name).display()
        )
    };
    let curve =
        "wheel --soil lunar --radius-m 0.1 --width-m 0.1 --load-n 40 --slip 0:0.9 --points 9"
            .to_owned();
    let problem = concat!(
        "optimize ",
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/problems/paper.toml"
    );
    for words in [&batch("few.csv"), &curve, &problem.to_owned()] {
        let few = limited("ulimit -v 4000000", Some("68719476736"), words);
        assert!(matches!(few.code, Some(0 | 1 | 3)), "{words}: {few:?}");
        assert!(!few.err.contains("panicked"), "{words}: {few:?}");
        let words = words.replace("few.csv", "all.csv");
        let all = limited("true", None, &words);
        assert_eq!(few.code, all.code);
        assert_eq!(few.out.replace("few.csv", "all.csv"), all.out, "{words}");
    }
    let read = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert!(read("few.csv") == read("all.csv"));
}

#[test]
fn without_memory_the_exit_is_an_error() {
    let folder = Folder::new();
    let wide = 150_000;
    let (names, numbers) = (",x".repeat(wide), ",1".repeat(wide));
    let mut text = format!("soil,radius_m,width_m,slip,load_n{names}\n");
    for _ in 0..20 {
        text.push_str("lunar,0.1,0.1,0.2,40");
        text.push_str(&numbers);
        text.push('\n');
    }
    let table = folder.file("wide.csv", text);
    let output = folder.path("out.csv");
    let words = format!("batch {} -o {}", table.display(), output.display());
    // as much as the program itself needs, and more and more of what the table needs
    let mut without = 0;
    for limit in (30_000..110_000).step_by(20_000) {
        let said = limited(&format!("ulimit -v {limit}"), None, &words);
        assert!(matches!(said.code, Some(0 | 2)), "{limit}: {said:?}");
        assert!(!said.err.contains("panicked"), "{limit}: {said:?}");
        without += u32::from(said.code == Some(2));
    }
    assert!(without > 0, "the limit was never met");
    limited("true", None, &words).assert_done();
    assert_eq!(folder.names(), ["out.csv", "wide.csv"]);
}

#[test]
fn a_file_that_grows_too_large_is_an_error_and_leaves_nothing() {
    let folder = Folder::new();
    let rows = "lunar,0.1,0.1,0.2,40\n".repeat(3000);
    let table = folder.file(
        "in.csv",
        format!("soil,radius_m,width_m,slip,load_n\n{rows}"),
    );
    let output = folder.file("out.csv", "old");
    let words = format!("batch {} -o {}", table.display(), output.display());
    // blocks of 512 or 1024 bytes; the table has 200 000
    let said = limited("ulimit -f 20", None, &words);
    said.assert_refused("a limit of size");
    assert!(said.err.contains("too large"), "{said:?}");
    assert_eq!(folder.names(), ["in.csv", "out.csv"]);
    assert_eq!(std::fs::read_to_string(output).unwrap(), "old");
}

/// 150 000 columns by 400 rows are 120 MB of text; what is held of them at a time is bounded in bytes.
#[test]
fn a_wide_table_takes_little_memory() {
    let folder = Folder::new();
    let wide = 150_000;
    let mut text = format!("soil,radius_m,width_m,slip,load_n{}\n", ",x".repeat(wide));
    let row = format!("lunar,0.1,0.1,0.2,40{}\n", ",1".repeat(wide));
    text.extend(std::iter::repeat_n(row.as_str(), 100));
    let table = folder.file("wide.csv", text);
    let words = format!(
        "batch {} -o {}",
        table.display(),
        folder.path("out.csv").display()
    );
    // address space, of which two processors' stacks and arenas take 270 MB before the first row
    limited("ulimit -v 1000000", None, &words).assert_done();
}
