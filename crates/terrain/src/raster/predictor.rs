//! TIFF's floating-point predictor: bytes of equal weight side by side, each as the difference from its left neighbour, which
//! deflates to about half.
//!
//! Source: Adobe Photoshop TIFF Technical Note 3 (2005), predictor 3.

/// The rows of `values` as predicted bytes; `columns` cells of `bands` numbers each.
pub(crate) fn to_planes(values: &[f32], columns: usize, bands: usize) -> Vec<u8> {
    let count = columns * bands;
    let mut out = Vec::with_capacity(4 * values.len());
    for row in values.chunks_exact(count) {
        let start = out.len();
        for plane in 0..4 {
            out.extend(row.iter().map(|value| value.to_be_bytes()[plane]));
        }
        let bytes = &mut out[start..];
        for index in (bands..bytes.len()).rev() {
            bytes[index] = bytes[index].wrapping_sub(bytes[index - bands]);
        }
    }
    out
}

/// The numbers of predicted bytes.
pub(crate) fn from_planes(bytes: &mut [u8], columns: usize, bands: usize) -> Vec<f32> {
    let count = columns * bands;
    let mut out = Vec::with_capacity(bytes.len() / 4);
    for row in bytes.chunks_exact_mut(4 * count) {
        for index in bands..row.len() {
            row[index] = row[index].wrapping_add(row[index - bands]);
        }
        out.extend((0..count).map(|i| {
            f32::from_be_bytes([
                row[i],
                row[count + i],
                row[2 * count + i],
                row[3 * count + i],
            ])
        }));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_back_as_the_same_numbers() {
        let values: Vec<f32> = (0_i16..60).map(|i| f32::from(i) * 0.37 - 5.0).collect();
        let mut bytes = to_planes(&values, 5, 4);
        assert_eq!(from_planes(&mut bytes, 5, 4), values);
    }
}
