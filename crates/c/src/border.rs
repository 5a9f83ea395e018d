//! The border between C and Rust: pointers and sizes are checked here, and panics end here.

use crate::abi::{CStruct, GROUSER_ERROR_POINTER, GROUSER_ERROR_SIZE, GROUSER_OK};

/// A code of an outcome that is not [`GROUSER_OK`].
pub(crate) type Code = i32;

/// The size that the caller must have written into a struct.
fn size_of<T>() -> u32 {
    // no struct of the interface is larger than a kilobyte
    u32::try_from(core::mem::size_of::<T>()).unwrap_or(u32::MAX)
}

/// A pointer that may be followed, as far as a check can find out.
pub(crate) fn check_pointer<T>(pointer: *const T) -> Result<(), Code> {
    if pointer.is_null() || !pointer.is_aligned() {
        return Err(GROUSER_ERROR_POINTER);
    }
    Ok(())
}

/// The size in front of a struct is this library's.
///
/// # Safety
/// `pointer` is NULL or points to at least four readable bytes.
unsafe fn check_size<T: CStruct>(pointer: *const T) -> Result<(), Code> {
    check_pointer(pointer)?;
    // SAFETY: not NULL, aligned, and the first field of `T` is a `u32`
    let size = unsafe { pointer.cast::<u32>().read() };
    if size == size_of::<T>() {
        Ok(())
    } else {
        Err(GROUSER_ERROR_SIZE)
    }
}

/// Copies a struct of the caller.
///
/// # Safety
/// `pointer` is NULL or points to as many readable bytes as the size in front of it has.
pub(crate) unsafe fn read<T: CStruct>(pointer: *const T) -> Result<T, Code> {
    // SAFETY: by this function's own condition
    unsafe { check_size(pointer) }?;
    // SAFETY: not NULL, aligned, of the right size; every bit pattern is a value
    Ok(unsafe { pointer.read() })
}

/// Copies `value` into a struct of the caller, whose size stays as it is.
///
/// # Safety
/// `pointer` is NULL or points to as many writable bytes as the size in front of it has.
pub(crate) unsafe fn write<T: CStruct>(pointer: *mut T, value: T) -> Result<(), Code> {
    // SAFETY: by this function's own condition
    unsafe { check_size(pointer) }?;
    // SAFETY: not NULL, aligned, of the right size
    unsafe { pointer.write(value) };
    // SAFETY: as above; the first field is `size`
    unsafe { pointer.cast::<u32>().write(size_of::<T>()) };
    Ok(())
}

/// Runs `work`; a panic becomes [`GROUSER_ERROR_INTERNAL`](crate::abi::GROUSER_ERROR_INTERNAL) where the standard library can catch it.
pub(crate) fn guarded(work: impl FnOnce() -> Result<(), Code>) -> Code {
    #[cfg(feature = "std")]
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(work))
        .unwrap_or(Err(crate::abi::GROUSER_ERROR_INTERNAL));
    #[cfg(not(feature = "std"))]
    let outcome = work();
    outcome.err().unwrap_or(GROUSER_OK)
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use crate::abi::GROUSER_ERROR_INTERNAL;
    use crate::create::{tests::two_wheels, with};
    use crate::{grouser_free, grouser_wheel_count};

    #[test]
    fn a_panic_ends_at_the_border_and_the_object_is_not_used_again() {
        let on_board = two_wheels();
        // SAFETY: `on_board` is alive
        let code = unsafe { with(on_board, |_| panic!("planted")) };
        assert_eq!(code, GROUSER_ERROR_INTERNAL);
        let mut count = 0;
        // SAFETY: `on_board` is alive, `count` writable
        let code = unsafe { grouser_wheel_count(on_board, &raw mut count) };
        assert_eq!((code, count), (GROUSER_ERROR_INTERNAL, 0));
        // SAFETY: it is used no more
        unsafe { grouser_free(on_board) };
    }
}
