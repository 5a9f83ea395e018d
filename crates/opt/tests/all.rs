//! All integration tests of the crate as one program: each program is compiled and linked with every library again.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it measured or why it is skipped"
)]

#[path = "support/lagrangian.rs"]
mod lagrangian;
#[path = "support/random_starts.rs"]
mod random_starts;

mod best_seen;
mod certified;
mod certified_fronts;
mod certified_limits;
mod certified_methods;
mod certified_searches;
mod conditions;
mod convex;
mod enclosures;
mod exact_limits;
mod fronts;
mod joint_problems;
mod literature;
mod methods;
mod optimal_starts;
mod outcomes;
mod probes;
mod proofs;
mod refuted;
mod robust;
mod searches;
mod stops;
mod tails;
mod whole_numbers;
