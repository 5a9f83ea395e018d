//! The border to the browser: texts in this module's memory.
//!
//! The page requests room ([`grouser_room`]), writes a request in UTF-8, calls [`grouser_answer`], reads the
//! answer at the address and length that it returns, and gives both back ([`grouser_release`]). Parts of a run come through
//! the one function that the page gives (`take_part`).
#![allow(
    unsafe_code,
    reason = "a C interface passes addresses; this file alone does"
)]

/// Room for `length` bytes, which [`grouser_answer`] takes over.
#[unsafe(no_mangle)]
pub extern "C" fn grouser_room(length: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; length].into_boxed_slice()).cast()
}

#[cfg(target_arch = "wasm32")]
#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// The page copies the part of a run at this address.
    fn take_part(address: *const u8, length: usize);
}

fn hand_over(part: &[u8]) {
    // SAFETY: the page reads `length` bytes at `address` before it returns
    #[cfg(target_arch = "wasm32")]
    unsafe {
        take_part(part.as_ptr(), part.len());
    }
    #[cfg(not(target_arch = "wasm32"))]
    let _ = part;
}

/// Answers the request of `length` bytes at `request` about the file at `file`: the answer's address in the upper, its
/// length in the lower 32 bits. Parts of a run go to the page before.
///
/// # Safety
/// `request` and `file` are what [`grouser_room`] returned for these lengths, and are not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn grouser_answer(
    request: *mut u8,
    length: usize,
    file: *mut u8,
    file_length: usize,
) -> u64 {
    let taken = |address: *mut u8, length: usize| {
        // SAFETY: the caller passes what `grouser_room` made, whose length and layout these are
        unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(address, length)) }.into_vec()
    };
    let (request, file) = (taken(request, length), taken(file, file_length));
    let request = std::str::from_utf8(&request).unwrap_or_default();
    let answer = crate::answer_with(request, file, &mut |part| hand_over(&part));
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
