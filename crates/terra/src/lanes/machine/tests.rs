use std::vec::Vec;
use std::{format, vec};

use super::*;

/// All sets of instructions that this machine has.
pub(in crate::lanes) fn levels() -> Vec<Level> {
    let mut levels = vec![Level::Portable];
    #[cfg(all(feature = "std", target_arch = "x86_64"))]
    if Level::best() == Level::Avx512 {
        levels.push(Level::Avx2);
    }
    if Level::best() != Level::Portable {
        levels.push(Level::best());
    }
    levels
}

#[test]
fn names_of_instructions() {
    for level in levels() {
        assert_eq!(level.name(), format!("{level:?}").to_lowercase());
    }
}
