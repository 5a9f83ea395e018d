// The module `mutant` of a mutated crate. The environment variable GROUSER_MUTANT has the number of the mutant that is
// active, or `trace`, which appends the number of each mutant that is reached to the file GROUSER_MUTANT_TRACE.
extern crate std;

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

const UNREAD: u32 = u32::MAX;
const TRACE: u32 = u32::MAX - 1;
const NONE: u32 = u32::MAX - 2;

static ACTIVE: AtomicU32 = AtomicU32::new(UNREAD);
static REACHED: [AtomicBool; 1 << 16] = [const { AtomicBool::new(false) }; 1 << 16];

#[inline]
pub fn active(id: u32) -> bool {
    match ACTIVE.load(Relaxed) {
        UNREAD | TRACE => slow(id),
        active => active == id,
    }
}

#[cold]
#[inline(never)]
fn slow(id: u32) -> bool {
    if ACTIVE.load(Relaxed) == UNREAD {
        let active = match std::env::var("GROUSER_MUTANT").as_deref() {
            Ok("trace") => TRACE,
            Ok(number) => number.parse().unwrap(),
            Err(_) => NONE,
        };
        ACTIVE.store(active, Relaxed);
        return self::active(id);
    }
    if !REACHED[id as usize].swap(true, Relaxed) {
        use std::io::Write;
        let path = std::env::var("GROUSER_MUTANT_TRACE").unwrap();
        let mut file = std::fs::OpenOptions::new()
            .append(true)
            .create(true)
            .open(path)
            .unwrap();
        file.write_all(std::format!("{id}\n").as_bytes()).unwrap();
    }
    false
}
