//! The caller's buffer for the text of an error.

use core::ffi::c_char;
use core::fmt::{self, Write};

/// A buffer of the caller, into which text is written as far as it fits, always with a NUL at its end.
pub(crate) struct Message {
    buffer: *mut c_char,
    capacity: usize,
    used: usize,
}

impl Message {
    /// The buffer, emptied. NULL or no bytes: nothing is written.
    ///
    /// # Safety
    /// `buffer` is NULL or points to `capacity` writable bytes that outlive the message.
    pub(crate) unsafe fn new(buffer: *mut c_char, capacity: usize) -> Self {
        let capacity = if buffer.is_null() { 0 } else { capacity };
        let mut message = Self {
            buffer,
            capacity,
            used: 0,
        };
        message.end();
        message
    }

    /// Writes `text`.
    pub(crate) fn set(&mut self, text: impl fmt::Display) {
        self.used = 0;
        self.end();
        // a text that is cut is no error
        let _ = write!(self, "{text}");
    }

    fn end(&mut self) {
        if self.used < self.capacity {
            // SAFETY: `used` lies inside the buffer
            unsafe { self.buffer.add(self.used).write(0) };
        }
    }
}

impl Write for Message {
    /// An error where the text does not fit: nothing is appended after a cut.
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let room = self.capacity.saturating_sub(self.used + 1);
        // no character is cut
        let length = text.floor_char_boundary(room);
        for &byte in &text.as_bytes()[..length] {
            // SAFETY: `length` leaves room for these bytes and the NUL
            unsafe {
                self.buffer
                    .add(self.used)
                    .write(byte.cast_signed() as c_char);
            }
            self.used += 1;
        }
        self.end();
        if length == text.len() {
            Ok(())
        } else {
            Err(fmt::Error)
        }
    }
}
