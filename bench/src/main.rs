//! `kernel`: the direct kernel at 1e-9 against the naive program, in one run, on one core.
//!
//! `cargo run --release --manifest-path bench/Cargo.toml -- kernel [--json]`

mod kernel;
mod naive;
mod points;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["kernel"] => kernel::run(false),
        ["kernel", "--json"] => kernel::run(true),
        _ => {
            eprintln!("usage: grouser-bench kernel [--json]");
            std::process::exit(2);
        }
    }
}
