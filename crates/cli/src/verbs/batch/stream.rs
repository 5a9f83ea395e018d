//! A table in and out while it is solved: one thread reads ahead, others solve a block of lines each, and this one
//! writes the blocks in order. Few blocks are under way, so that memory stays flat however long the table is.

use std::collections::BTreeMap;
use std::io::{self, Read as _};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;

use grouser_log::Cell;
use grouser_log::csv::{self, LINE_LIMIT};

use crate::error::{Error, Result};
use crate::input::Input;
use crate::thread_pool::has_room;

/// Bytes read of the table at a time: rows enough to fill the lanes of each soil where rows are long, few enough for
/// 22 MiB of memory. Half of it takes 2 % more processor time on rows of 38 bytes, and 6 MiB less.
const BLOCK_BYTES: usize = 1 << 17;
/// Blocks under way for each solving thread: one that is solved, one that waits on either side.
const UNDER_WAY: usize = 3;

/// A line of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line<'a> {
    /// Its text; bytes that are not UTF-8 became U+FFFD.
    pub(super) text: &'a str,
    /// Was it UTF-8?
    pub(super) is_text: bool,
}

/// Whole lines as they are read.
struct Block {
    bytes: Vec<u8>,
    /// How many line ends there are.
    lines: usize,
}

/// Whole lines.
#[derive(Debug)]
pub(super) struct Text {
    content: String,
    /// How many lines end.
    lines: usize,
    /// The lines that were not UTF-8, by their numbers from 0.
    broken: Vec<usize>,
}

impl Text {
    fn new(block: Block) -> Self {
        let mut broken = Vec::new();
        let content = String::from_utf8(block.bytes).unwrap_or_else(|error| {
            let lines = error.as_bytes().split(|byte| *byte == b'\n').enumerate();
            let lines = lines.filter(|(_, line)| str::from_utf8(line).is_err());
            broken.extend(lines.map(|(number, _)| number));
            String::from_utf8_lossy(error.as_bytes()).into_owned()
        });
        Self {
            content,
            lines: block.lines,
            broken,
        }
    }

    /// How many lines there are at most.
    pub(super) fn max_lines(&self) -> usize {
        self.lines + 1
    }

    /// The lines without their ends, LF or CR LF.
    pub(super) fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        csv::lines(&self.content)
            .enumerate()
            .map(|(number, text)| Line {
                text,
                is_text: self.broken.binary_search(&number).is_err(),
            })
    }

    /// The lines that are not blank.
    pub(super) fn rows(&self) -> impl Iterator<Item = Line<'_>> {
        self.lines()
            .filter(|line| !line.text.trim_start().is_empty())
    }
}

/// The table, block by block.
pub(super) struct Blocks {
    input: Input,
    /// What is read, but given to nobody yet.
    rest: Vec<u8>,
    /// How many lines were given.
    lines: u64,
}

impl Blocks {
    pub(super) fn new(input: Input) -> Self {
        Self {
            input,
            rest: Vec::new(),
            lines: 0,
        }
    }

    /// The input, read to its end.
    pub(super) fn into_input(self) -> Input {
        self.input
    }

    /// The first line, without a byte-order mark; empty where there is none.
    pub(super) fn header(&mut self) -> Result<Text> {
        // whoever writes a pipe may wait for an answer to the header
        let mut block = self.next(1)?.bytes;
        let end = block.iter().position(|byte| *byte == b'\n');
        let mut rest = block.split_off(end.map_or(block.len(), |end| end + 1));
        rest.append(&mut self.rest);
        self.rest = rest;
        self.lines = 1;
        if block.starts_with(b"\xef\xbb\xbf") {
            block.drain(..3);
        }
        Ok(Text::new(Block {
            bytes: block,
            lines: 1,
        }))
    }

    /// The next whole lines after a read of `enough` bytes; none at the end.
    fn next(&mut self, enough: usize) -> Result<Block> {
        let mut bytes = Vec::with_capacity(self.rest.len() + BLOCK_BYTES);
        bytes.append(&mut self.rest);
        let mut searched = 0;
        while self.fill(&mut bytes, enough)? {
            let end = bytes[searched..].iter().rposition(|byte| *byte == b'\n');
            if let Some(end) = end {
                self.rest = bytes.split_off(searched + end + 1);
                break;
            }
            if bytes.len() > LINE_LIMIT + "\r".len() {
                break;
            }
            searched = bytes.len();
        }
        self.check_lengths(&bytes)?;
        let lines = count_lines(&bytes);
        self.lines += lines as u64;
        Ok(Block { bytes, lines })
    }

    /// Appends what is read, a block at most, and `enough` bytes unless there are fewer; false at the end.
    fn fill(&mut self, bytes: &mut Vec<u8>, enough: usize) -> Result<bool> {
        let before = bytes.len();
        let mut filled = before;
        let mut is_end = false;
        bytes.resize(before + BLOCK_BYTES, 0);
        while filled < before + enough && !is_end {
            match self.input.read(&mut bytes[filled..]) {
                Ok(count) => {
                    filled += count;
                    is_end = count == 0;
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(Error::file("read", self.input.path(), &error)),
            }
        }
        bytes.truncate(filled);
        Ok(!is_end)
    }

    /// Refuses a line that is too long.
    fn check_lengths(&self, block: &[u8]) -> Result<()> {
        if block.len() <= LINE_LIMIT {
            return Ok(());
        }
        for (number, line) in (self.lines + 1..).zip(block.split_inclusive(|byte| *byte == b'\n')) {
            let line = line
                .strip_suffix(b"\n")
                .map_or(line, |line| line.strip_suffix(b"\r").unwrap_or(line));
            if line.len() > LINE_LIMIT {
                let at = Cell {
                    file: self.input.path().display().to_string(),
                    line: number,
                    column: None,
                    name: None,
                };
                let limit = LINE_LIMIT;
                return Err(grouser_log::Error::LongLine { at, limit }.into());
            }
        }
        Ok(())
    }
}

/// How many line ends there are: bytes are counted in bytes, many at a time.
fn count_lines(bytes: &[u8]) -> usize {
    let count = |part: &[u8]| -> u8 { part.iter().map(|byte| u8::from(*byte == b'\n')).sum() };
    let parts = bytes.chunks(usize::from(u8::MAX));
    parts.map(|part| usize::from(count(part))).sum()
}

/// Lines read together.
struct Chunk {
    /// Its place in the table, from 0.
    number: u64,
    block: Block,
}

/// A chunk's answer, or the panic of its thread.
struct Answered<T> {
    number: u64,
    bytes: u64,
    answer: thread::Result<T>,
}

/// Feeds `solve` with the rest of `blocks`, on all processors, and gives `write` each answer and the bytes of
/// its lines, in order. Gives the blocks back, read to their end.
///
/// Where the system grants no thread to read and one to solve (`ulimit -u`), the calling thread does all of it.
pub(super) fn solve_lines<T: Send>(
    blocks: Blocks,
    solve: impl Fn(Text) -> T + Sync,
    mut write: impl FnMut(T, u64) -> Result<()>,
) -> Result<Blocks> {
    let wanted = thread::available_parallelism().map_or(1, usize::from);
    let (permit, permits) = channel();
    let (send, chunks) = channel();
    let (answer, answers) = channel();
    let (chunks, solve) = (&Mutex::new(chunks), &solve);
    let blocks = Mutex::new(blocks);
    let held = || blocks.lock().unwrap_or_else(PoisonError::into_inner);
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
    Ok(blocks.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Reads, solves and writes block after block.
fn solve_alone<T>(
    blocks: &mut Blocks,
    solve: impl Fn(Text) -> T,
    mut write: impl FnMut(T, u64) -> Result<()>,
) -> Result<()> {
    loop {
        let block = blocks.next(BLOCK_BYTES)?;
        if block.bytes.is_empty() {
            return Ok(());
        }
        let bytes = block.bytes.len() as u64;
        write(solve(Text::new(block)), bytes)?;
    }
}

/// Reads block after block, each by a permit.
fn read(blocks: &mut Blocks, permits: &Receiver<()>, send: &Sender<Chunk>) -> Result<()> {
    for number in 0.. {
        let block = blocks.next(BLOCK_BYTES)?;
        // a writer that is gone has its own reason to tell
        if block.bytes.is_empty() || permits.recv().is_err() {
            break;
        }
        let _ = send.send(Chunk { number, block });
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
        let (number, bytes) = (chunk.number, chunk.block.bytes.len() as u64);
        let answer = catch_unwind(AssertUnwindSafe(|| solve(Text::new(chunk.block))));
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
