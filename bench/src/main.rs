//! `kernel`: the direct kernel at 1e-9 against the naive program, in one run, on one core.
//!
//! `points`: the operating points and their exact forces, for rivals in other languages.
//!
//! `filter`: the slip filter in a control loop, cycle by cycle.
//!
//! `drives`: whole drives, one by one and many at once.
//!
//! `paths`: every path that is not the common one.
//!
//! `cargo run --release --manifest-path bench/Cargo.toml -- kernel [--json] | filter | drives | paths | points`

mod drives;
mod filter;
mod kernel;
mod naive;
mod paths;
mod points;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["kernel"] => kernel::run(false),
        ["kernel", "--json"] => kernel::run(true),
        ["filter"] => filter::run(),
        ["drives"] => drives::run(),
        ["points"] => points::print(kernel::BATCH),
        ["paths"] => paths::run(),
        _ => {
            eprintln!("usage: grouser-bench kernel [--json] | filter | drives | paths | points");
            std::process::exit(2);
        }
    }
}
