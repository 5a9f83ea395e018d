//! Pictures of pixels, such as the relief of a map.

use crate::style::Colour;

/// A picture of pixels, row by row from the top.
///
/// ```
/// use grouser_figure::{Colour, Picture};
///
/// let picture = Picture::new([2, 1], |column, _| if column == 0 { Colour::SAND } else { Colour::INK });
/// # #[cfg(feature = "png")]
/// assert!(picture.png()?.starts_with(b"\x89PNG"));
/// # Ok::<(), grouser_figure::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    size: [u32; 2],
    pixels: Vec<Colour>,
}

impl Picture {
    /// A picture of `size` (columns, rows); `colour` is that of each column and row.
    #[must_use]
    pub fn new(size: [u32; 2], colour: impl Fn(u32, u32) -> Colour) -> Self {
        let [columns, rows] = size;
        let pixels = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        Self {
            size,
            pixels: pixels.map(|(column, row)| colour(column, row)).collect(),
        }
    }

    /// The picture as PNG.
    ///
    /// # Errors
    /// [`Error::PictureSize`](crate::Error::PictureSize) for a picture without pixels or too large for memory.
    #[cfg(feature = "png")]
    pub fn png(&self) -> Result<Vec<u8>, crate::Error> {
        let [columns, rows] = self.size;
        let refused = || crate::Error::PictureSize {
            width: f64::from(columns),
            height: f64::from(rows),
            limit: crate::png::MAX_SIDE_PX,
        };
        let mut canvas = tiny_skia::Pixmap::new(columns, rows).ok_or_else(refused)?;
        for (pixel, Colour(red, green, blue)) in
            canvas.data_mut().chunks_exact_mut(4).zip(&self.pixels)
        {
            pixel.copy_from_slice(&[*red, *green, *blue, u8::MAX]);
        }
        canvas.encode_png().map_err(|_| refused())
    }
}
