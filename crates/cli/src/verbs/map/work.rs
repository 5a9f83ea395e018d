//! The strips of a map: computed, resumed, shared among computers.

use grouser_terra::Soil;
use grouser_terrain::raster::Dem;
use grouser_terrain::{Envelope, Journal, LegendSoil, MapLayout, MapMaker, Strip};
use rayon::prelude::*;

use super::Arguments;
use super::outputs::Outputs;
use crate::error::Result;
use crate::input;
use crate::progress::Progress;
use crate::session::Session;

/// Part `index` of `of`, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    pub(super) index: u16,
    pub(super) of: u16,
}

/// The whole map.
const WHOLE: Shard = Shard { index: 1, of: 1 };
/// Strips that a processor computes before they are stored: more balance their work better.
const STRIPS_A_THREAD: usize = 2;

impl Shard {
    const fn has(self, strip: u32) -> bool {
        strip % self.of as u32 == self.index as u32 - 1
    }
}

/// `2/4`
pub(super) fn parse_shard(text: &str) -> std::result::Result<Shard, String> {
    let shard = text.split_once('/').and_then(|(index, of)| {
        Some(Shard {
            index: index.parse().ok()?,
            of: of.parse().ok()?,
        })
    });
    shard
        .filter(|shard| (1..=shard.of).contains(&shard.index) && shard.of <= 9999)
        .ok_or_else(|| "a part and their number are needed, such as 2/4".to_owned())
}

/// The SHA-256 of all that the cells depend on.
pub(super) fn job(
    arguments: &Arguments,
    session: &Session,
    (soil, gravity): (&Soil, f64),
    (drawn, legend, others): (&[Soil], &[LegendSoil], &[Vec<Soil>]),
    envelope: &Envelope,
) -> String {
    let provenance = session.provenance();
    let digests: Vec<String> = provenance["input_sha256"]
        .as_object()
        .into_iter()
        .flat_map(|files| files.values().map(ToString::to_string))
        .collect();
    let drawn: Vec<_> = drawn.iter().map(Soil::params).collect();
    let others: Vec<_> = others.iter().flatten().map(Soil::params).collect();
    let text = format!(
        "{} {:?} {digests:?} {:?} {drawn:?} {legend:?} {others:?} {} {envelope:?} {:?} {:?} {:?} {:?} {:?}",
        env!("CARGO_PKG_VERSION"),
        option_env!("GROUSER_COMMIT"),
        soil.params(),
        arguments.headings,
        arguments.cell_m,
        arguments.height_step_m,
        gravity,
        arguments.cvar,
        arguments.max_slip.max_slip,
    );
    input::digest(text.as_bytes())
}

/// A job.
pub(super) struct Job<'a> {
    pub(super) maker: &'a MapMaker,
    pub(super) layout: &'a MapLayout,
    pub(super) outputs: &'a Outputs,
    pub(super) shard: Option<Shard>,
    pub(super) join: Option<u16>,
}

/// What became of it.
pub(super) struct Made {
    pub(super) computed: u32,
    pub(super) resumed: u32,
    pub(super) shard: Shard,
    /// The strips of the whole map; `None` where a shard alone was computed.
    pub(super) journals: Option<Vec<Journal>>,
}

/// What is reported of a shard.
pub(super) struct Part {
    pub(super) shard: Shard,
    pub(super) strips: u32,
    pub(super) file: String,
}

impl Made {
    pub(super) fn part(&self, outputs: &Outputs) -> Part {
        Part {
            shard: self.shard,
            strips: self.computed + self.resumed,
            file: outputs.journal().display().to_string(),
        }
    }
}

impl Job<'_> {
    pub(super) fn run(&self, dem: &mut Dem) -> Result<Made> {
        if let Some(count) = self.join {
            let open =
                |index| Journal::of_shard(&self.outputs.shard(index, count), &self.layout.job);
            let journals = (1..=count)
                .map(open)
                .collect::<grouser_terrain::Result<Vec<_>>>()?;
            return Ok(Made {
                computed: 0,
                resumed: self.layout.strips(),
                shard: WHOLE,
                journals: Some(journals),
            });
        }
        let shard = self.shard.unwrap_or(WHOLE);
        let mut journal = Journal::open(&self.outputs.journal(), &self.layout.job)?;
        let own = (0..self.layout.strips()).filter(|strip| shard.has(*strip));
        let (done, open): (Vec<u32>, Vec<u32>) = own.partition(|strip| journal.holds(*strip));
        let count = |strips: &[u32]| u32::try_from(strips.len()).unwrap_or(u32::MAX);
        let progress = Progress::of_items((done.len() + open.len()) as u64, "strips");
        progress.advance(done.len() as u64);
        let (computed, resumed) = (count(&open), count(&done));
        for group in open.chunks(STRIPS_A_THREAD * rayon::current_num_threads()) {
            let strips = self.group(group, dem).inspect_err(|error| {
                // after a refusal there is nothing to resume
                if !matches!(error, grouser_terrain::Error::File { .. }) {
                    let _ = std::fs::remove_file(self.outputs.journal());
                }
            })?;
            for strip in strips {
                journal.add(&strip)?;
                progress.advance(1);
            }
        }
        Ok(Made {
            computed,
            resumed,
            shard,
            journals: self.shard.is_none().then(|| vec![journal]),
        })
    }

    /// Strips that are computed side by side.
    fn group(&self, strips: &[u32], dem: &mut Dem) -> grouser_terrain::Result<Vec<Strip>> {
        let (Some(first), Some(last)) = (strips.first(), strips.last()) else {
            return Ok(Vec::new());
        };
        // the cell beyond a wheel's contact takes part in its height
        let reach = self.maker.reach() + 1;
        let rows = self.layout.rows_of(*first).start.saturating_sub(reach)
            ..self.layout.rows_of(*last).end.saturating_add(reach);
        let window = dem.window(rows)?;
        strips
            .par_iter()
            .map(|strip| {
                let cells = self.maker.rows(&window, self.layout.rows_of(*strip))?;
                Ok(Strip::pack(self.layout, *strip, &cells))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_parts_of_a_whole() {
        for of in 1..6 {
            for strip in 0..20 {
                let parts = (1..=of).filter(|index| Shard { index: *index, of }.has(strip));
                assert_eq!(parts.count(), 1);
            }
        }
        assert!(parse_shard("2/4").is_ok());
        for wrong in ["", "0/4", "5/4", "1", "1/0", "-1/4", "1/99999"] {
            assert!(parse_shard(wrong).is_err(), "{wrong}");
        }
    }
}
