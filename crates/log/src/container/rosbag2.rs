//! The messages of a SQLite database that rosbag2 wrote.

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;

use super::sqlite::{Cell, Database, Walk};
use super::unpack::Packing;
use super::{
    CHUNK_LIMIT, Channel, Container, DECLARED_LIMIT, Encoding, Found, name_of, room_for, unreadable,
};
use crate::error::{Error, Result};
use crate::source::{Shared, Source, zstd_file};

/// Channels by the numbers of their topics.
type Topics = Vec<(u32, Channel)>;

/// The tables of a recording, and where the reading is.
pub(super) struct Rosbag2 {
    database: Database,
    walk: Walk,
    /// The columns of the messages' topic, time and data.
    columns: [usize; 3],
}

impl Rosbag2 {
    /// The database of a file with its channels, by the numbers of their topics.
    pub(super) fn of(source: &Source) -> Result<(Self, Topics)> {
        let foreign = |kind, advice| Error::Foreign {
            file: source.name(),
            kind,
            advice,
        };
        let mut beside = source.path().as_os_str().to_owned();
        beside.push("-wal");
        if std::fs::metadata(PathBuf::from(beside)).is_ok_and(|file| file.len() > 0) {
            return Err(foreign(
                "a database of rosbag2 whose last messages are in the file `FILE-wal` beside it",
                "`sqlite3 FILE 'PRAGMA wal_checkpoint(TRUNCATE)'` writes them into the database",
            ));
        }
        let opened = Self::open(source.open()?);
        let opened = opened.map_err(|error| unreadable(source.path(), error))?;
        opened.ok_or_else(|| {
            foreign(
                "a SQLite database without the tables of rosbag2",
                "`sqlite3 -header -csv FILE 'SELECT * FROM TABLE' > OUT.csv` makes a CSV table",
            )
        })
    }

    /// `None` where rosbag2 did not write it.
    fn open(source: Shared) -> io::Result<Option<(Self, Topics)>> {
        let limit = usize::try_from(CHUNK_LIMIT).unwrap_or(usize::MAX);
        let database = Database::open(source, limit)?;
        let tables = database.tables()?;
        let table = |name: &str| tables.iter().find(|(own, ..)| own == name);
        let (Some((_, topics, of_topics)), Some((_, messages, of_messages))) =
            (table("topics"), table("messages"))
        else {
            return Ok(None);
        };
        let place = |columns: &[String], name: &str| columns.iter().position(|own| own == name);
        let columns = ["topic_id", "timestamp", "data"].map(|name| place(of_messages, name));
        let [Some(topic), Some(time), Some(data)] = columns else {
            return Ok(None);
        };
        let mut definitions = BTreeMap::new();
        if let Some((_, root, columns)) = table("message_definitions") {
            database.texts(
                *root,
                columns,
                ["topic_type", "encoding", "encoded_message_definition"],
                |_, [name, language, text]| {
                    if language == "ros2msg" {
                        definitions.insert(name, text);
                    }
                },
            )?;
        }
        let mut channels = Vec::new();
        database.texts(
            *topics,
            of_topics,
            ["name", "type", "serialization_format"],
            |id, [topic, type_name, format]| {
                let definition = definitions.get(&type_name).cloned();
                let channel = Channel {
                    topic,
                    type_name,
                    encoding: if format == "cdr" {
                        Encoding::Cdr
                    } else {
                        Encoding::Other
                    },
                    encoding_name: format,
                    definition_language: "ros2msg".to_owned(),
                    definition: definition.unwrap_or_default().into_bytes().into(),
                    metadata: BTreeMap::new(),
                };
                channels.extend(u32::try_from(id).ok().map(|id| (id, channel)));
            },
        )?;
        let own = Self {
            walk: Walk::of(*messages),
            columns: [topic, time, data],
            database,
        };
        Ok(Some((own, channels)))
    }

    /// Moves the next message's bytes into `record`: topic, time and the range of its data.
    fn next(
        &mut self,
        record: &mut Vec<u8>,
    ) -> io::Result<Option<(i64, i64, std::ops::Range<usize>)>> {
        while let Some((_, cells)) = self.database.next(&mut self.walk)? {
            if let [
                Some(Cell::Integer(topic)),
                Some(Cell::Integer(time)),
                Some(Cell::Bytes(data)),
            ] = self.columns.map(|place| cells.get(place))
            {
                std::mem::swap(record, &mut self.walk.row);
                return Ok(Some((*topic, *time, data.clone())));
            }
        }
        Ok(None)
    }
}

impl Database {
    /// Gives the number of each row of a table, and three of its texts.
    fn texts(
        &self,
        root: u32,
        columns: &[String],
        wanted: [&str; 3],
        mut give: impl FnMut(i64, [String; 3]),
    ) -> io::Result<()> {
        let places = wanted.map(|name| columns.iter().position(|own| own == name));
        let mut walk = Walk::of(root);
        let mut bytes = 0;
        while let Some((number, cells)) = self.next(&mut walk)? {
            bytes += walk.row.len();
            if bytes > DECLARED_LIMIT {
                return Err(io::Error::other(
                    "its definitions and names are longer than the limit",
                ));
            }
            give(
                number,
                places.map(|place| match place.and_then(|place| cells.get(place)) {
                    Some(Cell::Bytes(range)) => {
                        String::from_utf8_lossy(&walk.row[range.clone()]).into_owned()
                    }
                    _ => String::new(),
                }),
            );
        }
        Ok(())
    }
}

impl Container {
    /// Enters the channels of a database.
    pub(super) fn begin_rosbag2(&mut self, database: Rosbag2, channels: Topics) {
        self.rosbag2 = Some(database);
        for (id, mut channel) in channels {
            let names = [&channel.topic, &channel.type_name]
                .map(|name| name_of(name.as_bytes(), "a name").err());
            let definition = self.definition(&channel.definition);
            let faulty = names.into_iter().flatten().next();
            let entered = match (faulty, definition) {
                (Some(fault), _) | (None, Err(fault)) => Err(fault),
                (None, Ok(text)) => {
                    channel.definition = text;
                    self.enter(id, channel)
                }
            };
            if let Err(fault) = entered {
                self.lose(0, 0, fault);
            }
        }
    }

    /// The next message of a database.
    pub(super) fn rosbag2_row(&mut self) -> io::Result<Option<Found>> {
        let next = self.rosbag2.as_mut().map(|own| {
            self.scan.go_to(own.database.read_by(&own.walk));
            own.next(&mut self.record)
        });
        let Some((topic, time_ns, data)) = next.transpose()?.flatten() else {
            self.ended = true;
            return Ok(None);
        };
        let id = u32::try_from(topic).unwrap_or(u32::MAX);
        let Some(&channel) = self.ids.get(&id) else {
            self.orphan(id);
            return Ok(None);
        };
        let time_ns = u64::try_from(time_ns).unwrap_or(0);
        Ok(Some(Found {
            channel,
            log_time_ns: time_ns,
            publish_time_ns: time_ns,
            sequence: 0,
            in_chunk: false,
            start: data.start,
            end: data.end,
        }))
    }

    /// A message that rosbag2 compressed by itself, expanded; no CDR begins like it.
    pub(super) fn expanded(&mut self, mut found: Found) -> Option<Found> {
        let buffer = if found.in_chunk {
            &self.chunk.content
        } else {
            &self.record
        };
        let packed = buffer.get(found.start..found.end).unwrap_or_default();
        let is_cdr = self.channels[found.channel].encoding == Encoding::Cdr;
        if !is_cdr || !packed.starts_with(&zstd_file::MAGIC) {
            return Some(found);
        }
        let mut head = [0; 18];
        let known = packed.len().min(head.len());
        head[..known].copy_from_slice(&packed[..known]);
        let declared = zstd_file::content_size(&head).unwrap_or(u64::MAX);
        let room = room_for(declared, Packing::Zstd, &self.scan, &mut self.unfolded);
        let limits = (declared, room);
        match (self.unpacker).unpack(Packing::Zstd, packed, limits, &mut self.message) {
            Ok(()) => {
                std::mem::swap(&mut self.record, &mut self.message);
                (found.in_chunk, found.start, found.end) = (false, 0, self.record.len());
                Some(found)
            }
            Err(fault) => {
                let (offset, bytes) = (self.scan.offset(), packed.len() as u64);
                self.lose(offset, bytes, fault.replace("the chunk", "a message"));
                None
            }
        }
    }
}
