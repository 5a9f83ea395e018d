# The recipes that `.ci/run` and CONTRIBUTING.md name. The README's two commands need no `just`.

# everything that a change must pass
ci:
    bash .ci/run

# format, lint, document
check:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet

# the README's test command
test:
    cargo test --workspace

# write the five-wheel example anew (a test compares it byte for byte)
example:
    cargo run --release --package grouser-synthetic --example write -- examples/five-wheel

# the kernel beside naive Rust, numba, numpy and scipy, in one run; writes bench/RESULTS.md
rivals:
    cargo build --release --manifest-path bench/Cargo.toml
    test -d bench/target/venv || python3 -m venv bench/target/venv
    bench/target/venv/bin/pip install --quiet numpy scipy numba
    bench/target/venv/bin/python bench/rivals.py

# every cut of 64 KiB files and every bit of 16 KiB ones; a part of them runs in `cargo test`
dense:
    GROUSER_DENSE=all cargo test --release --package grouser-log --no-fail-fast --test e1_cuts --test e2_flips -- --nocapture
