//! A file read from front to back with its offsets, never trusting a declared length.

use std::io;

use crate::source::Shared;

const WINDOW: usize = 1 << 16;

/// Where the reading stands, how far the file goes, and the CRC of what went by.
pub(super) struct Scan {
    source: Shared,
    /// What the file has from `start` on.
    window: Vec<u8>,
    start: u64,
    offset: u64,
    length: u64,
    /// `None` once bytes were skipped.
    crc: Option<crc32fast::Hasher>,
}

impl Scan {
    pub(super) fn over(source: Shared) -> io::Result<Self> {
        Ok(Self {
            length: source.length()?,
            source,
            window: Vec::new(),
            start: 0,
            offset: 0,
            crc: None,
        })
    }

    /// May the file have more bytes later?
    pub(super) fn is_growing(&self) -> bool {
        self.source.is_growing()
    }

    /// The writer has completed the file that ends here: nobody waits for more, unless another one follows.
    pub(super) fn complete(&mut self) -> io::Result<()> {
        if self.is_growing() {
            self.source.complete(self.offset);
            self.length = self.source.length()?;
        }
        Ok(())
    }

    /// Waits until a file that is still written is longer than now; whether it is.
    fn grow(&mut self) -> io::Result<bool> {
        if !self.is_growing() {
            return Ok(false);
        }
        let before = self.length;
        self.length = self.source.grown(before)?;
        Ok(self.length > before)
    }

    /// Waits until a file that is still written has `count` bytes from here.
    pub(super) fn wait(&mut self, count: u64) -> io::Result<()> {
        while self.left() < count && self.grow()? {}
        Ok(())
    }

    /// What stands here is read anew from the file: a writer may have changed it.
    pub(super) fn look_again(&mut self) {
        self.window.clear();
    }

    /// Waits until a file that is still written has the `count` bytes of the record here, or until another record, which
    /// `fits` finds, begins within them: then the writer was ended within this one, and the answer is true.
    pub(super) fn wait_for_record(
        &mut self,
        count: u64,
        reach: usize,
        fits: impl Fn(&[u8], u64) -> bool,
    ) -> io::Result<bool> {
        let mut searched = self.offset + 1;
        while self.left() < count {
            if !self.grow()? {
                break;
            }
            let end = self.length;
            let mut beside = self.beside(searched);
            if beside.find(searched..end, reach, &fits)?.is_some() {
                return Ok(true);
            }
            searched = end.saturating_sub(reach as u64).max(searched);
        }
        Ok(false)
    }

    /// A second scan of the same file that stands at `offset`, with a CRC from there.
    pub(super) fn beside(&self, offset: u64) -> Self {
        Self {
            source: self.source.clone(),
            window: Vec::new(),
            start: 0,
            offset,
            length: self.length,
            crc: Some(crc32fast::Hasher::new()),
        }
    }

    pub(super) fn offset(&self) -> u64 {
        self.offset
    }

    /// Bytes of the file.
    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// Bytes from here to the end.
    pub(super) fn left(&self) -> u64 {
        self.length.saturating_sub(self.offset)
    }

    pub(super) fn begin_crc(&mut self, start: &[u8]) {
        self.crc = Some(crc32fast::Hasher::new_with_initial(crc32fast::hash(start)));
    }

    pub(super) fn crc(&self) -> Option<u32> {
        self.crc.clone().map(crc32fast::Hasher::finalize)
    }

    /// Reads `count` bytes into `buffer`, which it clears, or as many as there are. Memory grows with
    /// what the file holds, not with `count`.
    pub(super) fn read(&mut self, count: u64, buffer: &mut Vec<u8>) -> io::Result<bool> {
        buffer.clear();
        let want = usize::try_from(count.min(self.left())).unwrap_or(usize::MAX);
        buffer
            .try_reserve_exact(want)
            .map_err(|_| io::ErrorKind::OutOfMemory)?;
        while buffer.len() < want {
            let rest = want - buffer.len();
            let here = self.here();
            if !here.is_empty() {
                let taken = &here[..here.len().min(rest)];
                buffer.extend_from_slice(taken);
                self.offset += taken.len() as u64;
            } else if rest < WINDOW {
                self.fill()?;
            } else {
                let begin = buffer.len();
                buffer.resize(want, 0);
                let got = self.source.read_at(self.offset, &mut buffer[begin..]);
                buffer.truncate(begin + *got.as_ref().unwrap_or(&0));
                self.advance(got?);
            }
            if self.left() == 0 {
                break;
            }
        }
        if let Some(crc) = &mut self.crc {
            crc.update(buffer);
        }
        Ok(buffer.len() as u64 == count)
    }

    /// What the window has from where the scan stands.
    fn here(&self) -> &[u8] {
        let at = self
            .offset
            .checked_sub(self.start)
            .and_then(|at| usize::try_from(at).ok());
        at.and_then(|at| self.window.get(at..)).unwrap_or_default()
    }

    fn fill(&mut self) -> io::Result<()> {
        self.window.resize(WINDOW, 0);
        self.start = self.offset;
        let got = self.source.read_at(self.offset, &mut self.window);
        self.window.truncate(*got.as_ref().unwrap_or(&0));
        if got? == 0 {
            self.advance(0);
        }
        Ok(())
    }

    /// A file that has become shorter ends where it gives no more.
    fn advance(&mut self, got: usize) {
        self.offset += got as u64;
        if got == 0 {
            self.length = self.offset;
        }
    }

    /// Passes over `count` bytes.
    pub(super) fn skip(&mut self, count: u64) -> io::Result<bool> {
        let mut rest = count;
        let mut buffer = Vec::new();
        while rest > 0 {
            let step = rest.min(WINDOW as u64);
            if !self.read(step, &mut buffer)? {
                return Ok(false);
            }
            rest -= step;
        }
        Ok(true)
    }

    /// Goes to `offset`; the CRC of the whole is lost.
    pub(super) fn go_to(&mut self, offset: u64) {
        self.crc = None;
        self.offset = offset;
    }

    /// What stands here, `count` bytes or fewer.
    pub(super) fn peek(&mut self, count: usize) -> io::Result<&[u8]> {
        if self.here().len() < count && self.left() > self.here().len() as u64 {
            self.fill()?;
        }
        let here = self.here();
        Ok(&here[..here.len().min(count)])
    }

    /// Does `what` stand here?
    pub(super) fn stands(&mut self, what: &[u8]) -> io::Result<bool> {
        Ok(self.peek(what.len())? == what)
    }

    /// The first of these places where `fits` finds a record, given what stands there and how many bytes the
    /// file has from there. The scan stands there, or behind the last. Places without an end in a file that is still
    /// written are waited for.
    pub(super) fn find(
        &mut self,
        places: std::ops::Range<u64>,
        reach: usize,
        fits: impl Fn(&[u8], u64) -> bool,
    ) -> io::Result<Option<u64>> {
        let mut at = places.start;
        let mut end = places.end.min(self.length);
        let mut window = Vec::new();
        loop {
            if at >= end {
                let behind = self.length.saturating_sub(reach as u64);
                if places.end == u64::MAX && self.grow()? {
                    // what began before the end can be judged now
                    at = behind.max(places.start);
                    end = self.length;
                    continue;
                }
                break;
            }
            self.go_to(at);
            self.read((WINDOW + reach) as u64, &mut window)?;
            if window.is_empty() {
                break;
            }
            let rest = usize::try_from(end - at).unwrap_or(usize::MAX);
            let starts = window.len().min(WINDOW).min(rest);
            for start in 0..starts {
                let place = at + start as u64;
                let left = if self.is_growing() {
                    u64::MAX
                } else {
                    self.length - place
                };
                if fits(&window[start..], left) {
                    self.go_to(place);
                    return Ok(Some(place));
                }
            }
            at += starts as u64;
        }
        self.go_to(end.min(self.length));
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Read, Seek, SeekFrom};

    use super::*;
    use crate::source::Source;

    /// Gives no more than this at once.
    const PIECE: usize = 50_000;

    struct Slow(Cursor<Vec<u8>>);

    impl Read for Slow {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let most = buffer.len().min(PIECE);
            self.0.read(&mut buffer[..most])
        }
    }

    impl Seek for Slow {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.0.seek(to)
        }
    }

    fn bytes(count: u32) -> Vec<u8> {
        let drawn = |i: u32| i.wrapping_mul(2_654_435_761).to_be_bytes()[0];
        (0..count).map(drawn).collect()
    }

    fn scan(bytes: &[u8]) -> Scan {
        Scan::over(Shared::new(Slow(Cursor::new(bytes.to_vec())))).unwrap()
    }

    #[test]
    fn what_is_read_is_the_file() {
        let all = bytes(500_000);
        let mut scan = scan(&all);
        assert_eq!((scan.length(), scan.crc()), (500_000, None));
        scan.begin_crc(b"start");
        let (mut at, mut buffer) = (0, Vec::new());
        for count in [10, 65_526, 65_536, 70_000, 5, 65_535, 131_072, 1, 65_537] {
            assert!(scan.read(count as u64, &mut buffer).unwrap());
            assert!(buffer == all[at..at + count], "{count} bytes at {at}");
            at += count;
            assert_eq!(
                (scan.offset(), scan.left()),
                (at as u64, 500_000 - at as u64)
            );
        }
        assert!(scan.skip(20_000).unwrap());
        at += 20_000;
        let crc = crc32fast::hash(&[b"start", &all[..at]].concat());
        assert_eq!(scan.crc(), Some(crc));
        // as many as there are
        assert!(!scan.read(100_000, &mut buffer).unwrap());
        assert!(buffer == all[at..] && scan.left() == 0);
        assert!(scan.read(0, &mut buffer).unwrap() && !scan.skip(1).unwrap());
        scan.go_to(499_990);
        assert!(scan.crc().is_none() && !scan.skip(11).unwrap());
        scan.go_to(499_990);
        assert!(scan.skip(10).unwrap());
    }

    #[test]
    fn what_stands_here_is_seen_without_reading_it() {
        let all = bytes(100_000);
        let mut scan = scan(&all);
        // 50 000 bytes come at once
        for at in [0, 49_990, 49_999, 50_000, 30, 99_995, 100_000] {
            scan.go_to(at as u64);
            let end = all.len().min(at + 20);
            assert_eq!(scan.peek(20).unwrap(), &all[at..end], "{at}");
            assert!(scan.stands(&all[at..end]).unwrap());
            assert!(at > 99_999 || !scan.stands(b"something else").unwrap());
            assert_eq!(scan.offset(), at as u64);
        }
        let mut beside = scan.beside(7);
        let mut buffer = Vec::new();
        beside.read(13, &mut buffer).unwrap();
        assert_eq!(
            (beside.crc(), scan.offset()),
            (Some(crc32fast::hash(&all[7..20])), 100_000)
        );
    }

    #[test]
    fn the_first_place_that_fits_is_found() {
        const WHAT: &[u8] = b"here it is";
        let plain = vec![0; 200_000];
        for place in [0, 1, 70, 65_530, 65_536, 131_071, 199_990] {
            let mut all = plain.clone();
            all[place..place + WHAT.len()].copy_from_slice(WHAT);
            let fits = |bytes: &[u8], left: u64| {
                let at = all.len() - usize::try_from(left).unwrap();
                let reach = bytes.len().min(WHAT.len());
                assert!(reach == WHAT.len() || reach == all.len() - at, "{at}");
                bytes[..reach] == all[at..at + reach] && bytes.starts_with(WHAT)
            };
            let mut scan = scan(&all);
            let place = place as u64;
            for (places, found) in [
                (0..u64::MAX, true),
                (place..place + 1, true),
                (0..place, false),
                (place + 1..u64::MAX, false),
            ] {
                let end = places.end.min(200_000);
                let given = scan.find(places, WHAT.len(), fits).unwrap();
                assert_eq!(given, found.then_some(place));
                assert_eq!(scan.offset(), if found { place } else { end });
            }
        }
    }

    #[test]
    fn what_is_there_is_not_waited_for() {
        let wait = || panic!("nothing more comes");
        let source = Source::growing("growing".as_ref(), Cursor::new(bytes(100)), wait);
        let mut scan = Scan::over(source.open().unwrap()).unwrap();
        scan.wait(100).unwrap();
        scan.go_to(60);
        scan.wait(40).unwrap();
        assert!(!scan.wait_for_record(40, 8, |_, _| true).unwrap());
        assert!(scan.is_growing());
    }
}
