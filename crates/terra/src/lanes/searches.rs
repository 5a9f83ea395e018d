//! Searches over slip for many points: every point brings its own, all take their next slip at the same time.

use crate::error::Result;
use crate::kernel::Kernel;
use crate::status::SolveStatus;
use crate::wheel_on_soil::WheelOnSoil;

use super::batch::BatchKernel;
use super::columns::{BatchColumns, BatchPoints};

/// Searches at a time: a few full groups of lanes, on a stack that is not large.
const SEARCHES: usize = 64;

/// What a search is fed with: drawbar pull, N, and torque, N m, under its load.
#[derive(Clone, Copy)]
pub(super) struct Traction {
    pub(super) drawbar_pull: f64,
    pub(super) torque: f64,
}

/// How a search ended.
#[derive(Clone, Copy)]
pub(super) enum End<T> {
    Found(T),
    NoSolution,
    /// The general search decides.
    Unsure,
}

/// The search of one point.
pub(super) trait SlipSearch {
    type Found;

    /// The slip in [0, 1] to be evaluated next, and the load, N.
    fn next(&self) -> (f64, f64);

    /// Takes what the wheel does at that slip; `None` where the load is not carried.
    fn feed(&mut self, found: Option<Traction>);

    /// How it ended; `None` while it goes on.
    fn end(&self) -> Option<End<Self::Found>>;
}

/// A search under way.
struct Running<S> {
    point: usize,
    search: S,
    /// Was a slip neither solved nor without solution?
    is_lost: bool,
}

impl BatchKernel {
    /// Searches for `count` points, of which `begin` makes the searches; `done` takes each point's end, in no order. A point
    /// without a search, and every point of a wheel or soil that no lanes serve, ends as unsure.
    pub(super) fn searches<S: SlipSearch>(
        &self,
        on_soil: &WheelOnSoil,
        count: usize,
        begin: impl Fn(usize) -> Option<S>,
        mut done: impl FnMut(usize, End<S::Found>),
    ) -> Result<()> {
        let lanes = self.has_lanes() && on_soil.wheel().is_served_by(Kernel::Lanes);
        let mut rounds = Rounds::new(self, on_soil);
        let mut waiting = 0..count;
        let mut searches = [const { None }; SEARCHES];
        loop {
            for place in &mut searches {
                while place.is_none()
                    && let Some(point) = waiting.next()
                {
                    match begin(point).filter(|_| lanes) {
                        Some(search) => {
                            *place = Some(Running {
                                point,
                                search,
                                is_lost: false,
                            });
                        }
                        None => done(point, End::Unsure),
                    }
                }
            }
            if !rounds.run(&mut searches)? {
                return Ok(());
            }
            for place in &mut searches {
                let Some(running) = place else { continue };
                let end = if running.is_lost {
                    Some(End::Unsure)
                } else {
                    running.search.end()
                };
                if let Some(end) = end {
                    done(running.point, end);
                    *place = None;
                }
            }
        }
    }
}

/// The columns of one round: a slip and a load for each search.
struct Rounds<'a> {
    kernel: &'a BatchKernel,
    on_soil: &'a WheelOnSoil,
    slip: [f64; SEARCHES],
    load: [f64; SEARCHES],
    out: [[f64; SEARCHES]; 4],
    status: [SolveStatus; SEARCHES],
}

impl<'a> Rounds<'a> {
    const fn new(kernel: &'a BatchKernel, on_soil: &'a WheelOnSoil) -> Self {
        Self {
            kernel,
            on_soil,
            slip: [0.0; SEARCHES],
            load: [0.0; SEARCHES],
            out: [[0.0; SEARCHES]; 4],
            status: [SolveStatus::NotConverged; SEARCHES],
        }
    }

    /// Evaluates the next slip of every search; false where there is none.
    fn run<S: SlipSearch>(
        &mut self,
        searches: &mut [Option<Running<S>>; SEARCHES],
    ) -> Result<bool> {
        let mut count = 0;
        for running in searches.iter().flatten() {
            (self.slip[count], self.load[count]) = running.search.next();
            count += 1;
        }
        if count == 0 {
            return Ok(false);
        }
        let wheel = self.on_soil.wheel();
        let points = BatchPoints {
            radius: wheel.radius().into(),
            width: wheel.width().into(),
            rebound: self.kernel.soil().params().rebound.into(),
            slip: (&self.slip[..count]).into(),
        };
        let [sinkage, vertical_force, drawbar_pull, torque] = &mut self.out;
        let mut columns = BatchColumns {
            sinkage: &mut sinkage[..count],
            vertical_force: &mut vertical_force[..count],
            drawbar_pull: &mut drawbar_pull[..count],
            torque: &mut torque[..count],
            status: &mut self.status[..count],
        };
        self.kernel
            .under_load(&points, &self.load[..count], &mut columns)?;
        for (k, running) in searches.iter_mut().flatten().enumerate() {
            match self.status[k] {
                SolveStatus::Solved => running.search.feed(Some(Traction {
                    drawbar_pull: self.out[2][k],
                    torque: self.out[3][k],
                })),
                SolveStatus::NoSolution => running.search.feed(None),
                SolveStatus::NotConverged | SolveStatus::BadInput => running.is_lost = true,
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests;
