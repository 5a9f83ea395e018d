//! A table in and out while it is solved: one thread reads ahead, one writes behind, each by few chunks, so
//! that memory stays flat however long the table is.

use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread::{self, ScopedJoinHandle};

use crate::error::Result;
use crate::lines::{Line, Lines};

/// Rows in memory at a time, in each of the chunks that are read, solved and written.
const CHUNK: usize = 4096;
/// Chunks that wait before and behind the solver.
const WAITING: usize = 2;

/// Lines read together, and how many bytes they took.
type Chunk = (Vec<Line>, u64);

/// Feeds `solve` with chunks of the rest of `lines` and writes the lines that it gives, both in order.
/// Gives the lines back, read to their end.
pub(super) fn solve_lines(
    mut lines: Lines,
    mut solve: impl FnMut(Vec<Line>, u64) -> Vec<String>,
    mut write: impl FnMut(&str) -> Result<()> + Send,
) -> Result<Lines> {
    thread::scope(|scope| {
        let (send, chunks) = sync_channel::<Chunk>(WAITING);
        let reader = scope.spawn(move || -> Result<Lines> {
            loop {
                let before = lines.bytes();
                let chunk = next_chunk(&mut lines)?;
                let bytes = lines.bytes() - before;
                // a solver that is gone has its own reason to tell
                if chunk.is_empty() || send.send((chunk, bytes)).is_err() {
                    return Ok(lines);
                }
            }
        });
        let (answers, solved) = sync_channel::<Vec<String>>(WAITING);
        let writer = scope.spawn(move || -> Result<()> {
            let solved: Receiver<Vec<String>> = solved;
            for line in solved.iter().flatten() {
                write(&line)?;
            }
            Ok(())
        });
        for (chunk, bytes) in &chunks {
            if answers.send(solve(chunk, bytes)).is_err() {
                break; // the writer has failed
            }
        }
        drop((chunks, answers));
        let written = ended(writer);
        let read = ended(reader);
        written?;
        read
    })
}

/// What a thread gave; its panic goes on in this one.
fn ended<T>(thread: ScopedJoinHandle<'_, T>) -> T {
    match thread.join() {
        Ok(given) => given,
        Err(panic) => resume_unwind(panic),
    }
}

fn next_chunk(lines: &mut Lines) -> Result<Vec<Line>> {
    let mut chunk = Vec::with_capacity(CHUNK);
    while chunk.len() < CHUNK {
        match lines.next()? {
            Some(line) if line.text.trim().is_empty() && line.is_text => {}
            Some(line) => chunk.push(line),
            None => break,
        }
    }
    Ok(chunk)
}
