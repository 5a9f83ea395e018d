//! Rows of the tables of a SQLite database, read in the order in which they stand in it.
//!
//! Source: the SQLite file format (sqlite.org/fileformat2.html), sections 1.3, 1.6, 2.1.

use std::io;

use crate::source::Shared;

pub(super) const MAGIC: &[u8] = b"SQLite format 3\0";
/// The tree of a table is not deeper than that: a page of 512 bytes has more than 20 children.
const MAX_DEPTH: usize = 20;
const CIRCLE: &str = "the pages of the database form a circle";
/// Kinds of pages.
const INTERIOR: u8 = 5;
const LEAF: u8 = 13;

/// A database that is read.
pub(super) struct Database {
    source: Shared,
    page_bytes: usize,
    /// Without what each page reserves at its end.
    usable: usize,
    pages: u32,
    /// The maximum size of a row, bytes.
    max_row: usize,
}

/// A value of a row, whose texts and blobs are ranges of its bytes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cell {
    Integer(i64),
    Bytes(std::ops::Range<usize>),
    /// Null, or a number with a point.
    Other,
}

/// Where a walk over a table is: its pages from the root to a leaf, each with the number of its next cell.
#[derive(Default)]
pub(super) struct Walk {
    stack: Vec<(Vec<u8>, u32, usize)>,
    next_root: Option<u32>,
    /// Pages that were read: each belongs to one place, and more than the file has are a circle.
    read: u32,
    /// The bytes of the row that was read last.
    pub(super) row: Vec<u8>,
}

fn fault(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

fn u16_at(bytes: &[u8], at: usize) -> io::Result<usize> {
    let two = bytes
        .get(at..at + 2)
        .ok_or_else(|| fault("a page of the database ends early"))?;
    Ok(usize::from(u16::from_be_bytes([two[0], two[1]])))
}

fn u32_at(bytes: &[u8], at: usize) -> io::Result<u32> {
    let four = bytes.get(at..).and_then(<[u8]>::first_chunk);
    four.map(|four| u32::from_be_bytes(*four))
        .ok_or_else(|| fault("a page of the database ends early"))
}

/// A number of one to nine bytes, and what is behind it.
fn varint(bytes: &[u8], at: &mut usize) -> io::Result<u64> {
    let mut value = 0;
    for place in 0..9 {
        let byte = *bytes
            .get(*at)
            .ok_or_else(|| fault("a number of the database is truncated"))?;
        *at += 1;
        if place == 8 {
            return Ok(value << 8 | u64::from(byte));
        }
        value = value << 7 | u64::from(byte & 0x7f);
        if byte < 0x80 {
            break;
        }
    }
    Ok(value)
}

impl Database {
    pub(super) fn open(source: Shared, max_row: usize) -> io::Result<Self> {
        let mut database = Self {
            source,
            page_bytes: 100,
            usable: 100,
            pages: 1,
            max_row,
        };
        let head = database.page(1)?;
        // 1 is 65 536
        let page_bytes = match u16_at(&head, 16)? {
            1 => 1 << 16,
            bytes => bytes,
        };
        if !page_bytes.is_power_of_two() || page_bytes < 512 {
            return Err(fault("its pages have no valid size"));
        }
        database.page_bytes = page_bytes;
        database.usable = page_bytes.saturating_sub(usize::from(head[20])).max(480);
        let pages = database.source.length()? / page_bytes as u64;
        database.pages = u32::try_from(pages).unwrap_or(u32::MAX);
        Ok(database)
    }

    /// How much of the file a walk has read, bytes.
    pub(super) const fn read_by(&self, walk: &Walk) -> u64 {
        walk.read as u64 * self.page_bytes as u64
    }

    /// A page by its number, from 1 on.
    fn page(&self, number: u32) -> io::Result<Vec<u8>> {
        if number == 0 || number > self.pages {
            return Err(fault(
                "a page of the database is missing: the file is truncated or damaged",
            ));
        }
        let mut page = vec![0; self.page_bytes];
        let start = u64::from(number - 1) * self.page_bytes as u64;
        let mut known = 0;
        while known < page.len() {
            match self
                .source
                .read_at(start + known as u64, &mut page[known..])?
            {
                0 => return Err(fault("the database ends within a page")),
                more => known += more,
            }
        }
        Ok(page)
    }

    /// Every table by its name: the page of its root, and the names of its columns.
    pub(super) fn tables(&self) -> io::Result<Vec<(String, u32, Vec<String>)>> {
        let mut walk = Walk::of(1);
        let mut tables = Vec::new();
        while let Some((_, cells)) = self.next(&mut walk)? {
            let text = |cell: usize| match cells.get(cell) {
                Some(Cell::Bytes(range)) => String::from_utf8_lossy(&walk.row[range.clone()]),
                _ => "".into(),
            };
            if let (Some(Cell::Integer(root)), "table") = (cells.get(3), &*text(0)) {
                let root = u32::try_from(*root).unwrap_or(0);
                tables.push((text(1).into_owned(), root, columns(&text(4))));
            }
        }
        Ok(tables)
    }

    /// The next row: its number, and its cells, whose bytes are [`Walk::row`].
    pub(super) fn next(&self, walk: &mut Walk) -> io::Result<Option<(i64, Vec<Cell>)>> {
        if let Some(root) = walk.next_root.take() {
            self.enter(walk, root)?;
        }
        while let Some((page, number, next)) = walk.stack.last_mut() {
            // the first page begins behind the header of the file
            let head = if *number == 1 { 100 } else { 0 };
            let (kind, count) = (page[head], u16_at(page, head + 3)?);
            let cell = *next;
            *next += 1;
            if kind == INTERIOR && cell <= count {
                let at = if cell < count {
                    u16_at(page, head + 12 + 2 * cell)?
                } else {
                    head + 8
                };
                let child = u32_at(page, at)?;
                self.enter(walk, child)?;
            } else if kind == LEAF && cell < count {
                let at = u16_at(page, head + 8 + 2 * cell)?;
                let page = std::mem::take(page);
                let done = self.row(&page, at, (&mut walk.row, &mut walk.read));
                if let Some((place, ..)) = walk.stack.last_mut() {
                    *place = page;
                }
                let number = done?;
                return Ok(Some((number, cells(&walk.row)?)));
            } else if kind == INTERIOR || kind == LEAF {
                walk.stack.pop();
            } else {
                return Err(fault("a page of the database is not of a table"));
            }
        }
        Ok(None)
    }

    fn enter(&self, walk: &mut Walk, number: u32) -> io::Result<()> {
        let page = self.next_page(&mut walk.read, number)?;
        if walk.stack.len() >= MAX_DEPTH {
            return Err(fault(CIRCLE));
        }
        walk.stack.push((page, number, 0));
        Ok(())
    }

    /// A page, counted.
    fn next_page(&self, read: &mut u32, number: u32) -> io::Result<Vec<u8>> {
        *read += 1;
        if *read > self.pages {
            return Err(fault(CIRCLE));
        }
        self.page(number)
    }

    /// Reads the row whose cell is at `at`, with its pages of overflow; its number.
    fn row(
        &self,
        page: &[u8],
        mut at: usize,
        (row, read): (&mut Vec<u8>, &mut u32),
    ) -> io::Result<i64> {
        let size = usize::try_from(varint(page, &mut at)?).unwrap_or(usize::MAX);
        let number = varint(page, &mut at)?.cast_signed();
        if size > self.max_row {
            return Err(fault("a row of the database is larger than the limit"));
        }
        let (max, min) = (self.usable - 35, (self.usable - 12) * 32 / 255 - 23);
        let mut local = size;
        if size > max {
            local = min + (size - min) % (self.usable - 4);
            local = if local > max { min } else { local };
        }
        let own = page.get(at..at + local);
        row.clear();
        row.extend_from_slice(own.ok_or_else(|| fault("a row of the database leaves its page"))?);
        let mut next = if local < size {
            u32_at(page, at + local)?
        } else {
            0
        };
        while row.len() < size {
            let more = self.next_page(read, next)?;
            next = u32_at(&more, 0)?;
            let length = (size - row.len()).min(self.usable - 4);
            row.extend_from_slice(&more[4..4 + length]);
        }
        Ok(number)
    }
}

impl Walk {
    /// Over the table whose root is that page.
    pub(super) fn of(root: u32) -> Self {
        Self {
            next_root: Some(root),
            ..Self::default()
        }
    }
}

/// The cells of a row.
fn cells(row: &[u8]) -> io::Result<Vec<Cell>> {
    let mut at = 0;
    let head = usize::try_from(varint(row, &mut at)?).unwrap_or(usize::MAX);
    let mut content = head;
    let mut cells = Vec::new();
    while at < head {
        let kind = varint(row, &mut at)?;
        let length = match kind {
            0 | 8 | 9 => 0,
            1..=4 => kind,
            5 => 6,
            6 | 7 => 8,
            10 | 11 => return Err(fault("a cell of the database has no valid kind")),
            _ => (kind - 12) / 2,
        };
        let end = content.saturating_add(usize::try_from(length).unwrap_or(usize::MAX));
        let bytes = row
            .get(content..end)
            .ok_or_else(|| fault("a cell of the database leaves its row"))?;
        let sign = i64::from(bytes.first().is_some_and(|first| *first > 0x7f));
        cells.push(match kind {
            8 => Cell::Integer(0),
            9 => Cell::Integer(1),
            0 | 7 => Cell::Other,
            1..=6 => Cell::Integer(
                bytes
                    .iter()
                    .fold(-sign, |value, byte| value << 8 | i64::from(*byte)),
            ),
            _ => Cell::Bytes(content..end),
        });
        content = end;
    }
    Ok(cells)
}

/// The names of the columns by the statement that made a table.
fn columns(statement: &str) -> Vec<String> {
    let inside = statement.split_once('(').map_or("", |(_, inside)| inside);
    let words = inside
        .split(',')
        .filter_map(|column| column.split_whitespace().next());
    words
        .map(|name| name.trim_matches(['"', '`', '[', ']', ')']).to_owned())
        .collect()
}
