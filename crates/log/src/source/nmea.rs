//! Sentences of a satellite receiver (NMEA 0183) as a table: a row for each time, from GGA, RMC and GST.

use std::fmt::Write as _;
use std::io::{self, BufRead, Read};

/// The columns of the table, which names describe.
const HEADER: &str =
    "time,latitude,longitude,altitude_m,fix_type,horizontal_accuracy_m,gps_speed_m_per_s\n";
/// Standard deviations by the quality of GGA, from 0 on, m; `None` of no position, and of one that is extrapolated or simulated.
const SIGMAS: [Option<f64>; 6] = [None, Some(2.5), Some(1.0), Some(2.5), Some(0.02), Some(0.5)];
const KNOT_M_PER_S: f64 = 1852.0 / 3600.0;
/// A sentence has 82 bytes; receivers with many digits send more.
const MAX_LINE: u64 = 512;

/// The first bytes of such a file.
pub(super) fn begins(start: &[u8]) -> bool {
    start.starts_with(b"$G")
}

/// The table, written as the sentences are read.
pub(super) struct NmeaTable<R> {
    sentences: R,
    text: Vec<u8>,
    given: usize,
    row: Row,
    /// The date of RMC, as `2026-03-02T`; empty before one, and where the file has none.
    date: String,
    has_dates: bool,
    is_done: bool,
}

/// What sentences of one time hold.
#[derive(Default)]
struct Row {
    time: String,
    place: Option<[f64; 2]>,
    altitude: Option<f64>,
    quality: usize,
    sigma: Option<f64>,
    speed: Option<f64>,
}

impl<R: BufRead> NmeaTable<R> {
    pub(super) fn new(mut sentences: R) -> io::Result<Self> {
        let start = sentences.fill_buf()?;
        let has_dates = start.windows(4).any(|word| word == b"RMC,");
        Ok(Self {
            sentences,
            text: HEADER.into(),
            given: 0,
            row: Row::default(),
            date: String::new(),
            has_dates,
            is_done: false,
        })
    }

    /// Takes a sentence; one whose checksum is wrong, or which is not of interest, has no effect.
    fn take(&mut self, line: &[u8]) -> Option<()> {
        let line = std::str::from_utf8(line).ok()?.trim();
        let (body, sum) = line
            .strip_prefix('$')?
            .split_once('*')
            .unwrap_or((&line[1..], ""));
        let own = body.bytes().fold(0, |sum, byte| sum ^ byte);
        if !sum.is_empty() && u8::from_str_radix(sum, 16).ok() != Some(own) {
            return None;
        }
        let fields: Vec<&str> = body.split(',').collect();
        let at = |place: usize| fields.get(place).copied().unwrap_or_default();
        let number = |place: usize| {
            at(place)
                .parse::<f64>()
                .ok()
                .filter(|number| number.is_finite())
        };
        let kind = at(0).get(2..)?;
        if !matches!(kind, "GGA" | "RMC" | "GST") {
            return None;
        }
        let (clock, rest) = at(1).split_at_checked(6)?;
        let time = format!(
            "{}:{}:{}{rest}",
            clock.get(..2)?,
            clock.get(2..4)?,
            clock.get(4..)?
        );
        if time != self.row.time {
            self.end_row();
            self.row.time = time;
        }
        match kind {
            "GGA" => {
                let degrees = |place: usize, whole: usize, negative: &str| {
                    let (degrees, minutes) = at(place).split_at_checked(whole)?;
                    let size = degrees.parse::<f64>().ok()? + minutes.parse::<f64>().ok()? / 60.0;
                    Some(if at(place + 1) == negative {
                        -size
                    } else {
                        size
                    })
                };
                self.row.place = degrees(2, 2, "S")
                    .zip(degrees(4, 3, "W"))
                    .map(|(a, b)| [a, b]);
                (self.row.altitude, self.row.quality) = (number(9), at(6).parse().unwrap_or(0));
            }
            "RMC" => {
                self.row.speed = number(7).filter(|_| at(2) == "A");
                if let [Some(day), Some(month), Some(year)] =
                    [0..2, 2..4, 4..6].map(|of| at(9).get(of))
                {
                    self.date = format!("20{year}-{month}-{day}T");
                }
            }
            _ => {
                let sigma = number(6)
                    .zip(number(7))
                    .map(|(north, east)| north.max(east));
                self.row.sigma = sigma.filter(|sigma| *sigma > 0.0);
            }
        }
        Some(())
    }

    /// Writes the row of the last time.
    fn end_row(&mut self) {
        let row = std::mem::take(&mut self.row);
        if row.time.is_empty() || (self.has_dates && self.date.is_empty()) {
            return;
        }
        let by_quality = SIGMAS.get(row.quality).copied().flatten();
        let place = row.place.filter(|_| by_quality.is_some());
        let cell = |number: Option<f64>| number.map_or(String::new(), |number| number.to_string());
        let cells = [
            cell(place.map(|place| place[0])),
            cell(place.map(|place| place[1])),
            cell(row.altitude),
            u8::from(by_quality.is_some()).to_string(),
            cell(row.sigma.or(by_quality)),
            cell(row.speed.map(|knots| knots * KNOT_M_PER_S)),
        ];
        // without a date the time of day counts from a day that is not known
        let date = if self.date.is_empty() {
            "1970-01-01T"
        } else {
            &self.date
        };
        let mut text = String::new();
        let _ = writeln!(text, "{date}{}Z,{}", row.time, cells.join(","));
        self.text.extend_from_slice(text.as_bytes());
    }
}

impl<R: BufRead> Read for NmeaTable<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.given == self.text.len() && !self.is_done {
            self.text.clear();
            self.given = 0;
            let mut line = Vec::new();
            let read = (&mut self.sentences)
                .take(MAX_LINE)
                .read_until(b'\n', &mut line)?;
            if read == 0 {
                self.is_done = true;
                self.end_row();
            } else {
                let _of_no_interest = self.take(&line);
            }
        }
        let rest = &self.text[self.given..];
        let length = rest.len().min(buffer.len());
        buffer[..length].copy_from_slice(&rest[..length]);
        self.given += length;
        Ok(length)
    }
}
