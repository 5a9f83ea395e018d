//! Numbers out of the bytes of a case.

/// The bytes that are left of a case; zeros once they are used up.
pub struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut taken = [0; N];
        let count = N.min(self.0.len());
        taken[..count].copy_from_slice(&self.0[..count]);
        self.0 = &self.0[count..];
        taken
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn u8(&mut self) -> u8 {
        u8::from_le_bytes(self.take())
    }

    pub fn u64(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }

    /// Any bit pattern, or one that breaks things more often.
    pub fn any(&mut self) -> f64 {
        match self.u8() {
            0 => 0.0,
            1 => -0.0,
            2 => f64::NAN,
            3 => f64::INFINITY,
            4 => f64::NEG_INFINITY,
            5 => f64::MAX,
            6 => 5e-324,
            7 => 1.0,
            8 => -1.0,
            9..=60 => f64::from_bits(self.u64()),
            other => f64::from(i16::from_le_bytes(self.take())) / f64::from(other),
        }
    }

    /// A number in a range, ends included.
    pub fn within(&mut self, from: f64, to: f64) -> f64 {
        let share = f64::from(u32::from_le_bytes(self.take())) / f64::from(u32::MAX);
        (from + (to - from) * share).clamp(from, to)
    }
}
