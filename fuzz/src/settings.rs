//! Settings out of the bytes of a case: anywhere within their limits, the limits included.

use grouser_slip::settings::Field;

use crate::bytes::Bytes;

/// Settings of which some numbers are drawn; a first byte of zero leaves them as they are.
pub fn drawn<S: Copy + Default>(bytes: &mut Bytes<'_>, fields: &[Field<S>]) -> S {
    let mut settings = S::default();
    for _ in 0..bytes.u8() % 8 {
        let field = &fields[usize::from(bytes.u8()) % fields.len()];
        let (low, high) = field.limits;
        let value = match bytes.u8() % 4 {
            0 => low,
            1 => high,
            // numbers of one sign spread over their powers of ten
            2 if low >= 0.0 && high > 0.0 => {
                let low = low.max(1e-7 * high);
                (low * (high / low).powf(bytes.within(0.0, 1.0))).clamp(low, high)
            }
            _ => bytes.within(low, high),
        };
        field.set(&mut settings, value);
    }
    settings
}
