//! What bare metal lacks: memory and the end of a panic come from the firmware's C library. It provides `malloc`, `free` and
//! `abort`, and `calloc`, which the compiler makes of a `malloc` whose memory is cleared.

use core::alloc::{GlobalAlloc, Layout};
use core::ffi::c_void;

/// `malloc` of newlib, picolibc and FreeRTOS's wrappers aligns to this, bytes.
const MALLOC_ALIGNMENT: usize = 8;

unsafe extern "C" {
    fn malloc(size: usize) -> *mut c_void;
    fn free(memory: *mut c_void);
    fn abort() -> !;
}

struct FirmwareMemory;

// SAFETY: `malloc` and `free` keep the allocator's promises; a larger alignment than theirs is refused
unsafe impl GlobalAlloc for FirmwareMemory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if layout.align() > MALLOC_ALIGNMENT {
            return core::ptr::null_mut();
        }
        // SAFETY: any size is allowed
        unsafe { malloc(layout.size()) }.cast()
    }

    unsafe fn dealloc(&self, memory: *mut u8, _: Layout) {
        // SAFETY: `memory` came from `malloc`
        unsafe { free(memory.cast()) }
    }
}

#[global_allocator]
static MEMORY: FirmwareMemory = FirmwareMemory;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: it has no condition
    unsafe { abort() }
}
