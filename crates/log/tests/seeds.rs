//! Writes the small files that fuzzing begins with: `cargo test -p grouser-log --test all seeds:: -- --ignored`.

use std::path::Path;

use crate::written;
use crate::written::{Packing, Plan, Written};

#[test]
#[ignore = "writes fuzz/seeds"]
fn write_the_seeds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds");
    let write = |target: &str, write: fn(Plan) -> Written, packings: &[Packing]| {
        for packing in packings {
            let plan = Plan {
                packing: *packing,
                bytes: 700,
                chunk: 300,
                alike: 20,
            };
            let name = packing.names().1;
            std::fs::write(folder.join(target).join(name), write(plan).bytes).unwrap();
        }
    };
    write(
        "mcap_read",
        written::mcap::write,
        &[Packing::None, Packing::Lz4, Packing::Zstd],
    );
    write(
        "bag_read",
        written::bag::write,
        &[Packing::None, Packing::Lz4, Packing::Bz2],
    );
}
