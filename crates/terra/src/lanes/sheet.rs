//! The columns of a chunk in work.

use super::plan::ROOM;
use super::vector::Vector;

/// One quantity of all points of a chunk, where whole vectors are loaded and stored.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Column(pub(super) [f64; ROOM]);

impl Column {
    pub(super) const EMPTY: Self = Self([0.0; ROOM]);

    #[inline(always)]
    pub(super) fn load<V: Vector>(&self, at: usize) -> V {
        V::load(&self.0, at)
    }

    #[inline(always)]
    pub(super) fn store<V: Vector>(&mut self, at: usize, x: V) {
        x.store(&mut self.0, at);
    }

    /// The numbers at eight places.
    #[inline(always)]
    pub(super) fn gather<V: Vector>(&self, places: [u8; 8]) -> V {
        let mut eight = [0.0; 8];
        for (x, place) in eight.iter_mut().zip(places) {
            *x = self.0[usize::from(place)];
        }
        V::from_array(eight)
    }
}

/// Eight numbers of a slice from a place on, the last one repeated where it ends.
#[inline(always)]
pub(super) fn eight<V: Vector>(values: &[f64], at: usize) -> V {
    let rest = &values[at..];
    if let Some(whole) = rest.first_chunk() {
        return V::from_array(*whole);
    }
    let mut eight = [values[values.len() - 1]; 8];
    eight[..rest.len()].copy_from_slice(rest);
    V::from_array(eight)
}
