//! What six wheels take of a Cortex-M4F: memory, stack and instructions, printed by semihosting.
//!
//! `./measure` builds it, runs it in QEMU and compares the figures with their limits. Instructions are counted by SysTick: with
//! `-icount shift=0` an instruction takes a nanosecond of the emulator's time, and a tick of 25 MHz is 40 instructions. A loop
//! of known length checks that.
#![no_std]
#![no_main]

use core::arch::{asm, global_asm};
use core::ffi::c_void;
use core::fmt::Write as _;
use core::ptr::{null_mut, read_volatile, write_volatile};
use core::sync::atomic::{AtomicUsize, Ordering};

use grouser_c::{
    GROUSER_FREE, GROUSER_INERTIAL, GROUSER_OK, GROUSER_POWERED, GROUSER_WHEEL_COUNT,
    GrouserOnBoard, GrouserSample, GrouserSettings, GrouserWheel, GrouserWheelEstimate,
    grouser_default_settings, grouser_new, grouser_push, grouser_tick, grouser_wheel,
};

const WHEELS: usize = 6;
const CYCLES: i64 = 500;
const PERIOD_NS: i64 = 10_000_000;
/// Nanoseconds of a tick of SysTick, which are instructions.
const TICK_NS: u64 = 40;
const PAINT: u32 = 0xA5A5_A5A5;

// the vectors, and the FPU switched on before anything uses it
global_asm!(
    ".section .vectors, \"a\"",
    ".word _stack_top",
    ".word reset",
    ".section .text.reset",
    ".global reset",
    ".thumb_func",
    "reset:",
    "ldr r0, =0xE000ED88",
    "ldr r1, [r0]",
    "orr r1, r1, #0xF00000",
    "str r1, [r0]",
    "dsb",
    "isb",
    "bl run",
    "b .",
);

unsafe extern "C" {
    static _heap_start: u8;
    static _heap_end: u8;
    static _stack_bottom: u8;
}

static NEXT: AtomicUsize = AtomicUsize::new(0);
static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);
static CALLS: AtomicUsize = AtomicUsize::new(0);

/// Memory that is never used again once it is freed: what is in use is counted, what was is not missed in 2 MB. The size is
/// kept before each piece.
#[unsafe(no_mangle)]
extern "C" fn malloc(size: usize) -> *mut c_void {
    CALLS.fetch_add(1, Ordering::Relaxed);
    let begin = &raw const _heap_start as usize;
    let taken = NEXT.fetch_add(size.next_multiple_of(8) + 8, Ordering::Relaxed);
    if begin + taken + size + 8 > &raw const _heap_end as usize {
        return null_mut();
    }
    let live = LIVE.fetch_add(size, Ordering::Relaxed) + size;
    PEAK.fetch_max(live, Ordering::Relaxed);
    let header = (begin + taken) as *mut usize;
    // SAFETY: within the heap, aligned to 8, and given out once
    unsafe { header.write(size) };
    (begin + taken + 8) as *mut c_void
}

#[unsafe(no_mangle)]
extern "C" fn calloc(count: usize, size: usize) -> *mut c_void {
    let memory = malloc(count * size).cast::<u8>();
    if !memory.is_null() {
        // SAFETY: `malloc` gave that much
        unsafe { memory.write_bytes(0, count * size) };
    }
    memory.cast()
}

#[unsafe(no_mangle)]
extern "C" fn free(memory: *mut c_void) {
    if !memory.is_null() {
        // SAFETY: the size stands before what `malloc` gave
        let size = unsafe { memory.cast::<usize>().sub(2).read() };
        LIVE.fetch_sub(size, Ordering::Relaxed);
    }
}

#[unsafe(no_mangle)]
extern "C" fn abort() -> ! {
    print("aborted\n\0");
    end(3)
}

fn semihosting(operation: usize, argument: usize) {
    // SAFETY: the emulator takes it; a text ends with NUL
    unsafe {
        asm!("bkpt #0xAB", inout("r0") operation => _, in("r1") argument, options(nostack));
    }
}

fn print(text: &str) {
    semihosting(0x04, text.as_ptr() as usize);
}

fn end(code: usize) -> ! {
    let block = [0x20026, code];
    semihosting(0x20, block.as_ptr() as usize);
    loop {}
}

/// Formats into a line that ends with NUL.
struct Line([u8; 120], usize);

impl core::fmt::Write for Line {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        let end = self.1 + text.len();
        let room = self.0.get_mut(self.1..end).ok_or(core::fmt::Error)?;
        room.copy_from_slice(text.as_bytes());
        self.1 = end;
        Ok(())
    }
}

fn report(name: &str, value: u64) {
    let mut line = Line([0; 120], 0);
    let _ = write!(line, "{name} {value}\n\0");
    print(core::str::from_utf8(&line.0[..line.1]).unwrap_or("?\n\0"));
}

const SYST_CSR: *mut u32 = 0xE000_E010 as *mut u32;
const SYST_RVR: *mut u32 = 0xE000_E014 as *mut u32;
const SYST_CVR: *mut u32 = 0xE000_E018 as *mut u32;
const RELOAD: u32 = 0x00FF_FFFF;

/// Instructions that `job` takes: fewer than 6.7e8.
fn instructions(job: impl FnOnce()) -> u64 {
    // SAFETY: SysTick of every Cortex-M
    let from = unsafe { read_volatile(SYST_CVR) };
    job();
    // SAFETY: as above
    let to = unsafe { read_volatile(SYST_CVR) };
    u64::from(from.wrapping_sub(to) & RELOAD) * TICK_NS
}

#[inline(never)]
fn stack(job: fn()) -> u64 {
    let bottom = &raw const _stack_bottom as usize;
    let here: usize;
    // SAFETY: reads the stack pointer
    unsafe { asm!("mov {}, sp", out(reg) here, options(nomem, nostack)) };
    // SAFETY: what is below the stack pointer is free; 64 bytes are left for this loop
    unsafe {
        let mut at = bottom;
        while at < here - 64 {
            write_volatile(at as *mut u32, PAINT);
            at += 4;
        }
        job();
        let mut at = bottom;
        while read_volatile(at as *const u32) == PAINT {
            at += 4;
        }
        (here - at) as u64
    }
}

static ON_BOARD: AtomicUsize = AtomicUsize::new(0);

fn on_board() -> *mut GrouserOnBoard {
    ON_BOARD.load(Ordering::Relaxed) as *mut GrouserOnBoard
}

fn must(code: i32) {
    if code != GROUSER_OK {
        report("error", u64::from(code.unsigned_abs()));
        end(2);
    }
}

/// A struct of C that begins with its size, with zeros in the rest.
fn sized<T>() -> T {
    // SAFETY: structs of C without references: zeros are values of them, and they begin with a `uint32_t`
    unsafe {
        let mut value = core::mem::zeroed::<T>();
        (&raw mut value).cast::<u32>().write(size_of::<T>() as u32);
        value
    }
}

fn create() {
    let mut wheels: [GrouserWheel; WHEELS] = [(); WHEELS].map(|()| sized());
    for (index, wheel) in wheels.iter_mut().enumerate() {
        wheel.role = if index < 5 {
            GROUSER_POWERED
        } else {
            GROUSER_FREE
        };
        wheel.x_m = 0.1 * index as f64;
        wheel.y_m = if index % 2 == 1 { 0.2 } else { -0.2 };
        (wheel.radius_m, wheel.load_n, wheel.gear) = (0.1, 40.0, 1.0);
        (wheel.ticks_per_turn, wheel.counter_bits) = (1000.0, 16);
    }
    let mut settings: GrouserSettings = sized();
    let mut made = null_mut();
    // SAFETY: all pointers are to values of this function
    unsafe {
        must(grouser_default_settings(&raw mut settings));
        settings.warm_up_s = 0.0;
        must(grouser_new(
            wheels.as_ptr(),
            WHEELS,
            &raw const settings,
            &raw mut made,
            null_mut(),
            0,
        ));
    }
    ON_BOARD.store(made as usize, Ordering::Relaxed);
}

/// Powered rims run at 0.314 m/s, the free one at 0.251 m/s: a slip of 0.2.
fn push_all(step: i64) {
    let now = step * PERIOD_NS;
    for wheel in 0..WHEELS {
        let mut sample: GrouserSample = sized();
        (sample.kind, sample.time_ns, sample.wheel) = (GROUSER_WHEEL_COUNT, now, wheel as u32);
        sample.raw = (if wheel < 5 { 5 * step } else { 4 * step }) as u64;
        // SAFETY: a live object and a sample
        must(unsafe { grouser_push(on_board(), now, &raw const sample) });
    }
    let mut sample: GrouserSample = sized();
    (sample.kind, sample.time_ns) = (GROUSER_INERTIAL, now);
    sample.values[2] = 9.81;
    // SAFETY: as above; a refusal is counted
    unsafe { grouser_push(on_board(), now, &raw const sample) };
}

fn tick(step: i64) {
    // SAFETY: a live object
    must(unsafe { grouser_tick(on_board(), step * PERIOD_NS, 0.3, 0.0) });
}

fn cycles() {
    for step in 0..CYCLES {
        push_all(step);
        tick(step);
    }
}

#[unsafe(no_mangle)]
extern "C" fn run() -> ! {
    // SAFETY: SysTick of every Cortex-M, from the processor's clock, without interrupts
    unsafe {
        write_volatile(SYST_RVR, RELOAD);
        write_volatile(SYST_CVR, 0);
        write_volatile(SYST_CSR, 0b101);
    }
    // two instructions a turn
    let known = instructions(|| {
        // SAFETY: counts down in a register
        unsafe {
            asm!("2:", "subs {n}, #1", "bne 2b", n = inout(reg) 1_000_000_u32 => _, options(nomem, nostack));
        }
    });
    report("instructions_of_2000000", known);
    report("stack_new_bytes", stack(create));
    report("memory_kept_bytes", LIVE.load(Ordering::Relaxed) as u64);
    report("memory_peak_bytes", PEAK.load(Ordering::Relaxed) as u64);
    let calls = CALLS.load(Ordering::Relaxed);
    report("stack_cycle_bytes", stack(cycles));
    let (mut pushing, mut ticking, mut most) = (0, 0, 0);
    for step in CYCLES..2 * CYCLES {
        let push = instructions(|| push_all(step));
        let own = instructions(|| tick(step));
        pushing += push;
        ticking += own;
        most = most.max(push + own);
    }
    let count = CYCLES as u64;
    report("instructions_push_of_seven_samples", pushing / count);
    report("instructions_tick", ticking / count);
    report("instructions_longest_cycle", most);
    report(
        "allocations_in_cycles",
        (CALLS.load(Ordering::Relaxed) - calls) as u64,
    );
    let mut wheel: GrouserWheelEstimate = sized();
    // SAFETY: a live object and a struct
    must(unsafe { grouser_wheel(on_board(), 0, &raw mut wheel) });
    report("slip_millionths", (wheel.slip * 1e6) as u64);
    report("sigma_millionths", (wheel.slip_sigma * 1e6) as u64);
    end(0)
}
