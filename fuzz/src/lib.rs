//! Every reader and every promise, as functions of any bytes. A function that panics, hangs or grows has found a defect.
//!
//! libFuzzer runs them on nightly Rust (`fuzz/run`), a mutator of fixed seeds on any Rust (`src/bin/mutate.rs`).

mod bytes;
mod container;
mod controller_stream;
mod csv;
mod filter_stream;
mod heightmap;
mod kernel_eval;
mod lanes;
mod message;
mod onboard_stream;
mod point;
mod recover;
mod settings;
mod solve;
mod stream;
mod tables;
mod toml_config;
mod urdf;

/// A property that holds for any bytes.
pub struct Target {
    /// Its name in `fuzz/run` and the folder of its seeds.
    pub name: &'static str,
    /// Panics where the property does not hold.
    pub run: fn(&[u8]),
}

/// All of them, by name.
pub const TARGETS: &[Target] = &[
    target("bag_read", |bytes| {
        container::read(b"#ROSBAG V2.0\n", bytes)
    }),
    target("controller_stream", controller_stream::run),
    target("csv", csv::run),
    target("database_read", |bytes| {
        container::read(b"SQLite format 3\0", bytes)
    }),
    target("filter_stream", filter_stream::run),
    target("heightmap", heightmap::run),
    target("kernel_eval", kernel_eval::run),
    target("lanes", lanes::run),
    target("mcap_read", |bytes| {
        container::read(b"\x89MCAP0\r\n", bytes)
    }),
    target("message", message::run),
    target("onboard_stream", onboard_stream::run),
    target("recover", recover::run),
    target("solve", solve::run),
    target("tables", tables::run),
    target("toml_config", toml_config::run),
    target("urdf", urdf::run),
];

const fn target(name: &'static str, run: fn(&[u8])) -> Target {
    Target { name, run }
}

/// The target of a name.
#[must_use]
pub fn find(name: &str) -> Option<&'static Target> {
    TARGETS.iter().find(|target| target.name == name)
}
