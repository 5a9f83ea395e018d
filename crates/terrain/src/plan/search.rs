//! A*: the cheapest way, the same on every machine.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::lattice::{Lattice, PlanSettings};
use crate::error::{Error, Result};

/// Greatest number of states that are held.
const MAX_STATES: u64 = 1 << 28;

/// Where a search began and ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) max_risk: f64,
}

/// How a state was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum Arrival {
    None,
    Start,
    /// By a step, from one straight step less.
    Step,
    /// By a step, from as long a straight as counts.
    LongStep,
    /// By a turn from the heading to the right or to the left.
    TurnFromRight,
    TurnFromLeft,
}

/// A state in the queue: the cheapest estimate first, then the lowest index.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Open {
    estimate: f64,
    state: usize,
}

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        // a heap gives its greatest
        other
            .estimate
            .total_cmp(&self.estimate)
            .then(other.state.cmp(&self.state))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The cells and headings of the cheapest way, or `None`.
pub(super) fn search(
    lattice: &Lattice<'_>,
    settings: &PlanSettings,
    task: &Task,
) -> Result<Option<Vec<(usize, usize)>>> {
    let map = lattice.map();
    let count = lattice.headings();
    let layers = lattice.most as usize + 1;
    let states = map.cells() as u64 * (count * layers) as u64;
    Error::check(
        "plan",
        "states",
        states as f64,
        (1.0, MAX_STATES as f64),
        "1",
    )?;
    // a state: cell, heading, straight steps since the last turn
    let state_of =
        |cell: usize, heading: usize, straight: usize| (cell * count + heading) * layers + straight;
    let columns = map.layout.columns as usize;
    let least = lattice.least_energy() * map.layout.cell;
    let to_go = |cell: usize| {
        let off = |a: usize, b: usize| a.abs_diff(b) as f64;
        least * off(cell / columns, task.to / columns).hypot(off(cell % columns, task.to % columns))
    };
    let mut cost = vec![f64::INFINITY; map.cells() * count * layers];
    let mut arrival = vec![Arrival::None; cost.len()];
    let mut open = BinaryHeap::new();
    let starts = match settings.start_heading {
        Some(heading) => heading..heading + 1,
        None => 0..count,
    };
    for heading in starts {
        if lattice.allows(task.from, heading, task.max_risk) {
            let state = state_of(task.from, heading, lattice.straight[heading] as usize);
            cost[state] = 0.0;
            arrival[state] = Arrival::Start;
            open.push(Open {
                estimate: to_go(task.from),
                state,
            });
        }
    }
    let mut closed = vec![false; cost.len()];
    while let Some(Open { state, .. }) = open.pop() {
        if closed[state] {
            continue;
        }
        closed[state] = true;
        let (cell, heading, straight) = (
            state / (layers * count),
            state / layers % count,
            state % layers,
        );
        let cap = lattice.straight[heading] as usize;
        let may_turn = straight == cap;
        let is_goal = settings.goal_heading.is_none_or(|goal| goal == heading);
        if cell == task.to && is_goal && may_turn {
            return Ok(Some(traced(lattice, &arrival, (cell, heading, straight))));
        }
        let here = cost[state];
        let mut reach = |next: usize, at: usize, new: f64, how: Arrival| {
            if new < cost[next] {
                cost[next] = new;
                arrival[next] = how;
                open.push(Open {
                    estimate: new + to_go(at),
                    state: next,
                });
            }
        };
        if let Some(to) = lattice.ahead(cell, heading, task.max_risk) {
            let how = if may_turn {
                Arrival::LongStep
            } else {
                Arrival::Step
            };
            let next = state_of(to, heading, (straight + 1).min(cap));
            reach(next, to, here + lattice.cost((cell, to), heading), how);
        }
        if may_turn {
            for (to, how) in [
                ((heading + 1) % count, Arrival::TurnFromRight),
                ((heading + count - 1) % count, Arrival::TurnFromLeft),
            ] {
                if lattice.allows(cell, to, task.max_risk) {
                    reach(
                        state_of(cell, to, 0),
                        cell,
                        here + settings.turn_energy,
                        how,
                    );
                }
            }
        }
    }
    Ok(None)
}

/// The states that led here, from the start on.
fn traced(
    lattice: &Lattice<'_>,
    arrival: &[Arrival],
    (mut cell, mut heading, mut straight): (usize, usize, usize),
) -> Vec<(usize, usize)> {
    let count = lattice.headings();
    let layers = lattice.most as usize + 1;
    let cap = |heading: usize| lattice.straight[heading] as usize;
    let mut way = vec![(cell, heading)];
    loop {
        let state = (cell * count + heading) * layers + straight;
        match arrival[state] {
            Arrival::None | Arrival::Start => break,
            Arrival::Step | Arrival::LongStep => {
                let Some(behind) = lattice.behind(cell, heading) else {
                    break;
                };
                cell = behind;
                straight = if arrival[state] == Arrival::Step {
                    straight - 1
                } else {
                    cap(heading)
                };
            }
            Arrival::TurnFromRight => {
                heading = (heading + count - 1) % count;
                straight = cap(heading);
            }
            Arrival::TurnFromLeft => {
                heading = (heading + 1) % count;
                straight = cap(heading);
            }
        }
        way.push((cell, heading));
    }
    way.reverse();
    way
}
