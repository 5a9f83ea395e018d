//! The border to the browser: texts in this module's memory.
//!
//! The page requests room ([`grouser_room`]), writes a request in UTF-8, calls [`grouser_answer`], reads the
//! answer at the address and length that it returns, and gives both back ([`grouser_release`]).
#![allow(
    unsafe_code,
    reason = "a C interface passes addresses; this file alone does"
)]

/// Room for `length` bytes, which [`grouser_answer`] takes over.
#[unsafe(no_mangle)]
pub extern "C" fn grouser_room(length: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; length].into_boxed_slice()).cast()
}

/// Answers the request of `length` bytes at `request`: the answer's address in the upper, its length in the lower
/// 32 bits.
///
/// # Safety
/// `request` is what [`grouser_room`] returned for this `length`, and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_answer(request: *mut u8, length: usize) -> u64 {
    // SAFETY: the caller passes what `grouser_room` made, whose length and layout these are
    let bytes = unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(request, length)) };
    let answer = match std::str::from_utf8(&bytes) {
        Ok(request) => crate::answer(request),
        Err(_) => crate::answer(""),
    };
    let answer = answer.into_bytes().into_boxed_slice();
    let length = answer.len() as u64;
    let address = Box::into_raw(answer).cast::<u8>() as u64;
    address << 32 | length
}

/// Gives an answer's memory back.
///
/// # Safety
/// `answer` and `length` are those of one answer, which is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_release(answer: *mut u8, length: usize) {
    // SAFETY: the caller passes an answer's own address and length, once
    drop(unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(answer, length)) });
}
