//! A table in and out while it is solved: one thread reads ahead, others solve a chunk each, and this one writes the
//! chunks in order. Few chunks are under way, so that memory stays flat however long the table is.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::BufReader;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;

use grouser_log::csv;

use crate::error::{Error, Result};
use crate::input::Input;
use crate::thread_pool::has_room;

/// Rows of a chunk at most.
const CHUNK_ROWS: usize = 2048;
/// Bytes at which a chunk ends, however few its rows are.
const CHUNK_BYTES: u64 = 1 << 20;
/// Bytes read from the system at a time.
const READ_BYTES: usize = 1 << 16;
/// Chunks under way for each solving thread: one that is solved, one that waits on either side.
const UNDER_WAY: usize = 3;

/// The lines of the table.
pub(super) type Lines = csv::Lines<BufReader<Input>>;

/// A line of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line<'a> {
    /// Its text; bytes that are not UTF-8 became U+FFFD.
    pub(super) text: &'a str,
    /// Was it UTF-8?
    pub(super) is_text: bool,
}

/// Lines for the thread that solves them, in one text: memory for each line of its own would cost more than to read it.
#[derive(Debug, Default)]
pub(super) struct Text {
    text: String,
    /// Where each line ends, and whether it was UTF-8.
    ends: Vec<(usize, bool)>,
}

impl Text {
    fn push(&mut self, line: &str, is_text: bool) {
        self.text.push_str(line);
        self.ends.push((self.text.len(), is_text));
    }

    /// How many lines there are.
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The lines.
    pub(super) fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        let mut from = 0;
        self.ends.iter().map(move |&(end, is_text)| {
            let text = &self.text[from..end];
            from = end;
            Line { text, is_text }
        })
    }
}

/// The lines of `input`.
pub(super) fn lines_of(input: Input) -> Lines {
    let name = input.path().display().to_string();
    Lines::over(BufReader::with_capacity(READ_BYTES, input), &name)
}

/// Moves to the next line; false at the end.
fn advance(lines: &mut Lines) -> Result<bool> {
    lines.advance().map_err(|error| match error {
        grouser_log::Error::Unreadable { at, source } => {
            Error::file("read", Path::new(&at.file), &source)
        }
        error => error.into(),
    })
}

/// The next line; nothing at the end.
pub(super) fn next_line(lines: &mut Lines) -> Result<Text> {
    let mut line = Text::default();
    if advance(lines)? {
        let text = String::from_utf8_lossy(lines.raw());
        line.push(&text, matches!(text, Cow::Borrowed(_)));
    }
    Ok(line)
}

/// Lines read together.
struct Chunk {
    /// Its place in the table, from 0.
    number: u64,
    lines: Text,
    /// How many bytes they took.
    bytes: u64,
}

/// A chunk's answer, or the panic of its thread.
struct Answered<T> {
    number: u64,
    bytes: u64,
    answer: thread::Result<T>,
}

/// Feeds `solve` with chunks of the rest of `lines`, on all processors, and gives `write` each answer and the bytes of
/// its lines, in order. Gives the lines back, read to their end.
///
/// Where the system grants no thread to read and one to solve (`ulimit -u`), the calling thread does all of it.
pub(super) fn solve_lines<T: Send>(
    lines: Lines,
    solve: impl Fn(Text) -> T + Sync,
    mut write: impl FnMut(T, u64) -> Result<()>,
) -> Result<Lines> {
    let wanted = thread::available_parallelism().map_or(1, usize::from);
    let (permit, permits) = channel();
    let (send, chunks) = channel();
    let (answer, answers) = channel();
    let (chunks, solve) = (&Mutex::new(chunks), &solve);
    let lines = Mutex::new(lines);
    let held = || lines.lock().unwrap_or_else(PoisonError::into_inner);
    thread::scope(|scope| {
        let start_one = |_| {
            let answer = answer.clone();
            let work = move || solve_chunks(chunks, solve, &answer);
            if !has_room() {
                return None;
            }
            thread::Builder::new().spawn_scoped(scope, work).ok()
        };
        let threads = (0..wanted).map_while(start_one).count();
        drop(answer);
        let work = move || read(&mut held(), &permits, &send);
        let reader = match threads {
            0 => None,
            _ if !has_room() => None,
            _ => thread::Builder::new().spawn_scoped(scope, work).ok(),
        };
        let Some(reader) = reader else {
            return solve_alone(&mut held(), solve, write);
        };
        for _ in 0..UNDER_WAY * threads {
            let _ = permit.send(()); // a reader that is gone needs none
        }
        let written = write_in_order(&permit, &answers, &mut write);
        // without the ends of this thread the others end as well
        drop((permit, answers));
        let read = reader.join().unwrap_or_else(|panic| resume_unwind(panic));
        written.unwrap_or_else(|panic| resume_unwind(panic))?;
        read
    })?;
    Ok(lines.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Reads, solves and writes chunk after chunk.
fn solve_alone<T>(
    lines: &mut Lines,
    solve: impl Fn(Text) -> T,
    mut write: impl FnMut(T, u64) -> Result<()>,
) -> Result<()> {
    loop {
        let before = lines.bytes();
        let chunk = next_chunk(lines)?;
        if chunk.len() == 0 {
            return Ok(());
        }
        write(solve(chunk), lines.bytes() - before)?;
    }
}

/// Reads chunk after chunk, each by a permit.
fn read(lines: &mut Lines, permits: &Receiver<()>, send: &Sender<Chunk>) -> Result<()> {
    for number in 0.. {
        let before = lines.bytes();
        let chunk = next_chunk(lines)?;
        let bytes = lines.bytes() - before;
        // a writer that is gone has its own reason to tell
        if chunk.len() == 0 || permits.recv().is_err() {
            break;
        }
        let _ = send.send(Chunk {
            number,
            lines: chunk,
            bytes,
        });
    }
    Ok(())
}

/// Solves chunk after chunk until there is none.
fn solve_chunks<T>(
    chunks: &Mutex<Receiver<Chunk>>,
    solve: impl Fn(Text) -> T,
    answers: &Sender<Answered<T>>,
) {
    loop {
        let chunk = match chunks.lock() {
            Ok(chunks) => chunks.recv(),
            Err(_) => return, // never: nothing panics while it holds the lock
        };
        let Ok(chunk) = chunk else { return };
        let (number, bytes) = (chunk.number, chunk.bytes);
        let answer = catch_unwind(AssertUnwindSafe(|| solve(chunk.lines)));
        let answered = Answered {
            number,
            bytes,
            answer,
        };
        if answers.send(answered).is_err() {
            return;
        }
    }
}

/// Writes the answers by their numbers; `Err` with the panic of a thread that solves.
fn write_in_order<T>(
    permit: &Sender<()>,
    answers: &Receiver<Answered<T>>,
    mut write: impl FnMut(T, u64) -> Result<()>,
) -> thread::Result<Result<()>> {
    let mut early = BTreeMap::new();
    let mut next = 0;
    for answered in answers {
        early.insert(answered.number, answered);
        while let Some(answered) = early.remove(&next) {
            next += 1;
            if let Err(error) = write(answered.answer?, answered.bytes) {
                return Ok(Err(error));
            }
            let _ = permit.send(()); // a reader that is gone needs none
        }
    }
    Ok(Ok(()))
}

fn next_chunk(lines: &mut Lines) -> Result<Text> {
    let mut chunk = Text::default();
    let from = lines.bytes();
    while chunk.len() < CHUNK_ROWS && lines.bytes() - from < CHUNK_BYTES && advance(lines)? {
        match str::from_utf8(lines.raw()) {
            Ok(line) if line.trim().is_empty() => {}
            Ok(line) => chunk.push(line, true),
            Err(_) => chunk.push(&String::from_utf8_lossy(lines.raw()), false),
        }
    }
    Ok(chunk)
}
