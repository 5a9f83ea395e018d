//! Random starts for searches that try to refute a solution.

/// How many starts for each problem: `GROUSER_STARTS` overrides the default.
pub(crate) fn starts(default: u64) -> u64 {
    let given = std::env::var("GROUSER_STARTS").ok();
    given.map_or(default, |given| given.parse().unwrap())
}

/// Numbers in [0, 1) from a seed (SplitMix64).
pub(crate) struct Stream(pub(crate) u64);

impl Stream {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
