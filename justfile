# The recipes that `.ci/run` and CONTRIBUTING.md name. The README's two commands need no `just`.

# everything that a change must pass
ci:
    bash .ci/run

# the same with all of packages, page and node, of which a commit tests one
ci-full:
    CI_FULL=1 bash .ci/run

# format, lint, document
check:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet

# the README's test command
test:
    cargo test --workspace

# the property tests with other random cases: seeds FIRST to LAST; hours
seeds first="1" last="50":
    for seed in $(seq {{first}} {{last}}); do echo "seed $seed"; PROPTEST_RNG_SEED=$seed cargo test --workspace --lib --test all --quiet || exit 1; done

# the share of a crate's lines that its tests run, at least 98 %, by cargo-llvm-cov; minutes
coverage crate="slip":
    cargo llvm-cov --release --package grouser-{{crate}} --lib --test all --summary-only --fail-under-lines 98

# write the five-wheel example anew (a test compares it byte for byte)
example:
    cargo run --release --package grouser-synthetic --example write -- examples/five-wheel

# render RESULTS.md from results/, and measure again what is cheap (GROUSER_DATA has the measured data)
results:
    GROUSER_WRITE_RESULTS=1 cargo test --package grouser --test all results::

# write the pictures of the documentation again; `data` has the measured data
pictures data:
    cargo build --release
    target/release/grouser validate --data {{data}} --figure docs/pictures/measured.png
    target/release/grouser wheel --soil lunar --radius-m 0.125 --width-m 0.15 --load-n 65 --slip 0.25 --figure docs/pictures/wheel.png
    target/release/grouser wheel --soil dry-sand --radius-m 0.15 --width-m 0.08 --load-n 60 --slip 0:0.8 --points 81 -o docs/pictures/slip-curves.png
    target/release/grouser identify examples/bevameter/tests.toml --figure docs/pictures/residuals.png
    target/release/grouser optimize examples/problems/pull-against-torque.toml -o docs/pictures/front.png
    target/release/grouser design examples/robots/rocker-bogie.toml --soil dry-sand=0.7,sandy-loam=0.3 --slope-deg 0=0.8,5=0.2 --points 5 -o docs/pictures/design.png
    target/release/grouser estimate examples/five-wheel/log.csv --robot examples/five-wheel/robot.toml --soil dry-sand -o docs/pictures/five-wheel-slip.png
    target/release/grouser drive examples/scenarios/sandbox.toml -o target/sandbox.csv
    target/release/grouser estimate target/sandbox.csv --robot examples/robots/five-wheel.toml -o docs/pictures/drive-slip.png
    target/release/grouser map examples/terrain/dunes.asc --robot examples/robots/skid-steer.toml --soil sandy-loam -o target/dunes.tif -o docs/pictures/slip-map.svg
    target/release/grouser paper -o target/paper
    cp target/paper/figure-9.png docs/pictures/paper-figure-9.png

# each way to install in a bare Debian system without Rust (release/installs): time to a first right number; needs root.
# What it tries is made before, by `release/make`
installs *kinds:
    release/installs {{kinds}}

# the same of what tests built: packs target/debug first, without the programs that are not there
installs-of-tests *kinds:
    release/built
    RELEASE=target/built-files release/installs {{kinds}}

# one reader or promise under libFuzzer, a million executions (fuzz/README.md): just fuzz mcap_read
fuzz target executions="1000000":
    fuzz/run {{target}} {{executions}}

# every mutant of a crate against its fast tests (mutants/README.md): just mutants real, just mutants slip --share 3/50
mutants crate *options:
    python3 mutants/run.py {{crate}} {{options}}

# changes in stages on a copy of the tree: what they miss must not build or fail a named test; all drills, or those named; minutes
drills *names:
    drills/run {{names}}

# what a point costs over the common case: slip sign, depth, lugs, rebound, slip angle, laws
cliffs:
    cargo test --release -p grouser-terra --test all cliffs:: -- --nocapture

# reading of logs beside the mcap crate, decoders of zstd and Python's rosbags
bench-log:
    cargo run --release --manifest-path bench/log/Cargo.toml

# the robot's linkage beside rapier's multibody; rapier takes minutes to build
bench-rover:
    cargo run --release --manifest-path bench/rover/Cargo.toml

# the kernel beside naive Rust, numba, jax, numpy and scipy, in one run; writes bench/RESULTS.md
rivals:
    cargo build --release --manifest-path bench/Cargo.toml
    test -d bench/target/venv || python3 -m venv bench/target/venv
    bench/target/venv/bin/pip install --quiet numpy scipy numba jax
    bench/target/venv/bin/python bench/rivals.py

# `batch` on a table beside polars, which reads and writes the same tables: processor time, cores, memory, values
bench-tables rows="1000000" rounds="9":
    cargo build --release
    test -d bench/target/venv || python3 -m venv bench/target/venv
    bench/target/venv/bin/pip install --quiet polars
    bench/target/venv/bin/python bench/tables.py {{rows}} {{rounds}}

# `estimate` on a hundred random robots, sensors and courses of a world of its own, beside naive means (bench/random_logs.py);
# with wheels read `hz` times a second where that is not 0, and one of the troubles that `just random-logs 0 1 0 list` names
random-logs first="0" count="100" hz="0" trouble="":
    cargo build --release
    test -d bench/target/venv || python3 -m venv bench/target/venv
    bench/target/venv/bin/pip install --quiet numpy
    bench/target/venv/bin/python bench/random_logs.py {{first}} {{count}} {{hz}} {{trouble}}

# 47 habits of drivers (angles that wrap, stamps of 0, frozen poses, two publishers on a topic …): are slips called Ok right, and is
# the habit named? (bench/drivers.py)
drivers cases="all" seeds="0:3":
    cargo build --release -p grouser
    test -d bench/target/venv || python3 -m venv bench/target/venv
    bench/target/venv/bin/pip install --quiet numpy mcap-ros2-support
    bench/target/venv/bin/python bench/drivers.py target/release/grouser {{cases}} {{seeds}}

# slip estimators on measured logs, known steps, random logs and drives, with the stored figures of `main` next to them
# (bench/estimators; `just estimators --help`). What it runs is built before: `cargo build --release -p grouser`.
# All rows of `main`: just estimators; one row of another: just estimators robotino-5hz offline. The rows of MuJoCo need `mujoco` in the venv
estimators rows="all" *entrants:
    test -d bench/target/venv || python3 -m venv bench/target/venv
    bench/target/venv/bin/pip install --quiet numpy
    bench/target/venv/bin/python bench/estimators {{rows}} {{entrants}}

# the controller beside open loop on a hundred drives with robots, soils, reliefs, gravities and sensors drawn at random
# (bench/random_drives.py); minutes
random-drives first="0" count="100":
    cargo build --release
    python3 bench/random_drives.py {{first}} {{count}}

# the lanes' tests under the address sanitizer (needs a nightly compiler); minutes
sanitize:
    RUSTFLAGS=-Zsanitizer=address CARGO_TARGET_DIR=target/sanitize cargo +nightly test --package grouser-terra --target x86_64-unknown-linux-gnu --lib --test all -- lanes:: batches::

# a long search for random cases in which standard and reference mode disagree; minutes
search:
    PROPTEST_CASES=20000 cargo test --release --package grouser-terra --test all -- properties:: batches::

# every cut of 64 KiB files, every bit of 16 KiB ones, a thousand kills of a logger; a part runs in `cargo test`
dense:
    GROUSER_DENSE=all cargo test --release --package grouser-log --no-fail-fast --test all -- --nocapture truncated_files:: flipped_bits:: killed_loggers::

# ten thousand runs with random faults from a seed on, 3.3e8 samples (about five minutes of one core); twice the same seeds print the same bits
soak first="0":
    GROUSER_SOAK_RUNS=10000 GROUSER_SOAK_FIRST={{first}} cargo test --release --package grouser-synthetic --test all soak:: -- --nocapture

# the node for an hour with each transport: eight wheels at 200 Hz with bursts; needs GROUSER_LIVE_PYTHON (live/ci installs it)
live-soak seconds="3600":
    cd live && GROUSER_LIVE_SOAK_S={{seconds}} cargo test --locked --release --test soak -- --nocapture --test-threads=1

# slip maps: 100 000 random poses against the exact solver, and a million cells with 64 soils; minutes
terrain:
    cargo test --release --package grouser-terrain --test all table:: -- --ignored --nocapture
    cargo test --release --package grouser-terrain --test speed -- --ignored --nocapture

# five ways to a goal over hidden patches of soil on the relief of Mars ($GROUSER_DATA/mars-dem), 50 missions; minutes
mission:
    GROUSER_MISSION_ROWS=1 cargo test --release --package grouser-terrain --test all mission:: -- --ignored --nocapture

# SHA-256 of reference cases, batches, drives and an estimate on x86-64 (also without AVX), AArch64, ARMv7, RISC-V and
# WebAssembly, the others emulated; builds each, an hour. One machine: just same-bits x86_64 aarch64 -- reference batch
same-bits *arguments="-- canary reference batch drives scenarios estimate 20":
    crates/synthetic/same-bits {{arguments}}

# Miri over numbers, portable lanes and unit tests of the estimators and the C interface, half an hour; needs nightly Rust.
# The platform's functions have random last bits in Miri, hence the features. Left out: tests over whole drives (hours), and
# lanes on vector instructions, which Miri does not know (`just sanitize` runs those)
miri:
    rustup +nightly component add miri rust-src
    MIRIFLAGS=-Zmiri-disable-isolation cargo +nightly miri test --package grouser-real --features deterministic --lib
    MIRIFLAGS=-Zmiri-disable-isolation cargo +nightly miri test --package grouser-terra --no-default-features --lib -- lanes::vector
    MIRIFLAGS=-Zmiri-disable-isolation cargo +nightly miri test --package grouser-slip --package grouser-c --features grouser-slip/deterministic --lib

# soil learnt while driving, on nine soils under two laws of shear: what was predicted against what was true; minutes
learnt-soil seeds="2":
    GROUSER_SEEDS={{seeds}} cargo test --release --package grouser-rover --test all learnt_soil:: -- --ignored --nocapture

# 6000 black-box cases against the program, with overflow checks; minutes. Another first case draws others
attack cases="6000" first="0":
    GROUSER_ATTACK_CASES={{cases}} GROUSER_ATTACK_FIRST={{first}} cargo test --package grouser --test attack -- --nocapture

# what a release consists of, in target/release-files: static programs for two machines, wheels, bill of materials, checksums; an hour
release:
    release/make

# `grouser` from two folders: the same bytes
reproducible:
    release/make --check

# the Python package: build the wheel, install it in a fresh environment, run its tests
python:
    bash python/ci

# the Python wheels of a release: x86-64 and aarch64, with and without a global lock; the aarch64 one tested under qemu
python-wheels:
    bash python/wheels
    bash python/under_qemu python/target/release-wheels/*abi3*aarch64.whl tests/test_wheel.py tests/test_command.py tests/test_arguments.py

# ten thousand random problems with kinks and jumps of each kind: no search returns less than it has seen; minutes
best-seen problems="10000":
    GROUSER_STARTS={{problems}} cargo test --release --package grouser-opt --test all best_seen:: -- --nocapture

# random starts of each published and each shipped problem: no solution may be refuted by 200 probes of 1e-4 around it; minutes
refuted starts="450":
    GROUSER_STARTS={{starts}} cargo test --release --package grouser-opt --package grouser-design --test all refuted:: -- --nocapture

# proofs of the published problems' global optima over boxes of ±5 around their starts, 60 s each, with their logs checked
certify seconds="60":
    mkdir -p target/proofs
    GROUSER_CERTIFY_S={{seconds}} GROUSER_CERTIFY_LOGS="$PWD/target/proofs" cargo test --release --package grouser-opt --test all certified::published -- --nocapture
    python3 checker/check.py target/proofs/*.jsonl
