//! The nodes of a table.

use std::cell::RefCell;

use grouser_terra::Slip;
use grouser_terra::slope::{SlopeSearch, crossing};

use super::check::check;
use super::{Beyond, Envelope, SLIP_BOUND, Side, SlipTable, TableError};
use crate::demand::{DemandSolver, Driving, NodeSpacing, Posed, WheelNodes};
use crate::error::{Error, Result};

/// Nodes over roll and over t of the coarsest grid, and how often both are doubled at most.
const COARSEST: [usize; 2] = [9, 17];
const MAX_DOUBLINGS: u32 = 2;
/// A pitch is found to this accuracy, rad.
const PITCH_TOLERANCE_RAD: f64 = 1e-11;
/// Share of the bound that the grid may use; the rest is left to cells that were not checked.
const BUILD_SHARE: f64 = 0.625;
/// A node's slip is found to this accuracy, a ten-thousandth of the bound.
const NODE_TOLERANCE: f64 = 1e-7;
/// Slips at which the end of the envelope is looked at first: most soils hold it with brakes on a few percent.
const GENTLE_SLIPS: [f64; 2] = [0.05, 0.15];
/// The error of a limit is never taken smaller, rad.
pub(super) const MIN_LIMIT_ERROR_RAD: f64 = 1e-9;

pub(super) fn refined(solver: &DemandSolver, envelope: Envelope) -> Result<SlipTable> {
    let near = Near::on_nodes(solver, NodeSpacing::FINE);
    let [mut rolls, mut steps] = COARSEST;
    for _ in 0..MAX_DOUBLINGS {
        let table = built(&near, envelope, [rolls, steps])?;
        if table.error.slip <= BUILD_SHARE * SLIP_BOUND {
            return Ok(table);
        }
        (rolls, steps) = (2 * rolls - 1, 2 * steps - 1);
    }
    built(&near, envelope, [rolls, steps])
}

/// The coarsest grid, without a check.
pub(super) fn coarse(solver: &DemandSolver, envelope: Envelope) -> Result<SlipTable> {
    let near = Near::on_nodes(solver, NodeSpacing::COARSE);
    let mut table = filled(&near, envelope, COARSEST)?;
    // a table that was not checked has no marginal poses: what it reads is what it says
    for side in [&mut table.climbing, &mut table.braking] {
        side.limit_error = 0.0;
        side.marginal = 0.0;
        if side.beyond == Beyond::Unknown {
            side.beyond = Beyond::Envelope;
        }
    }
    table.error.slip = f64::NAN;
    Ok(table)
}

/// The robot on one pose after the other.
pub(super) struct Near<'a> {
    pub(super) solver: &'a DemandSolver,
    /// The skids of the free wheels at the pose before.
    skids: RefCell<Vec<Slip>>,
    nodes: Option<WheelNodes<'a>>,
}

impl<'a> Near<'a> {
    /// By the exact laws.
    pub(super) fn exact(solver: &'a DemandSolver) -> Self {
        Self {
            solver,
            skids: RefCell::default(),
            nodes: None,
        }
    }

    /// By the laws at nodes over load and slip.
    pub(super) fn on_nodes(solver: &'a DemandSolver, spacing: NodeSpacing) -> Self {
        Self {
            nodes: Some(WheelNodes::new(solver, spacing)),
            ..Self::exact(solver)
        }
    }

    pub(super) fn posed(&self, pitch: f64, roll: f64) -> Result<Posed<'_>> {
        let posed = if let Some(nodes) = &self.nodes {
            nodes.posed(pitch, roll)?
        } else {
            let mut skids = self.skids.borrow_mut();
            self.solver.posed_near(pitch, roll, &mut skids)?
        };
        posed.ok_or_else(|| Error::DoesNotStand {
            name: self.solver.model().robot.name().to_owned(),
            load: 0.0,
        })
    }
}

/// One roll's limit on one side.
#[derive(Clone, Copy)]
pub(super) struct Limit {
    pub(super) pitch: f64,
    /// The slip there; `None` where the envelope ends before the soil.
    slip: Option<f64>,
    /// A slip that holds it.
    holding: f64,
}

fn built(near: &Near<'_>, envelope: Envelope, [rolls, steps]: [usize; 2]) -> Result<SlipTable> {
    let mut table = filled(near, envelope, [rolls, steps])?;
    let roll_of = |place: f64| envelope.max_roll * (2.0 * place / (rolls - 1) as f64 - 1.0);
    check(&mut table, near, &roll_of)?;
    Ok(table)
}

/// The nodes.
fn filled(near: &Near<'_>, envelope: Envelope, [rolls, steps]: [usize; 2]) -> Result<SlipTable> {
    let solver = near.solver;
    let roll_of = |place: f64| envelope.max_roll * (2.0 * place / (rolls - 1) as f64 - 1.0);
    let mut rolling = Vec::with_capacity(rolls);
    let mut limits = [Vec::with_capacity(rolls), Vec::with_capacity(rolls)];
    for index in 0..rolls {
        let roll = roll_of(index as f64);
        let range = (-envelope.max_pitch, envelope.max_pitch);
        let level = pitch_of(near, (roll, 0.0), range, rolling.last().copied())?
            .ok_or_else(|| does_not_move(solver))?;
        rolling.push(level);
        for (limits, sense) in limits.iter_mut().zip([1.0, -1.0]) {
            let found = limit(near, envelope, (roll, level), sense, limits.last())?;
            limits.push(found);
        }
    }
    // the one slope that is printed is that of the exact laws
    let middle = rolls / 2;
    let (exact, beside) = (Near::exact(solver), Some(&limits[0][middle]));
    let straight_on = (roll_of(middle as f64), rolling[middle]);
    let steepest = limit(&exact, envelope, straight_on, 1.0, beside)?.pitch;
    let mut sides = Vec::with_capacity(2);
    for (limits, sense) in limits.iter().zip([1.0, -1.0]) {
        sides.push(side(
            near,
            envelope,
            &rolling,
            (limits, sense),
            steps,
            &roll_of,
        )?);
    }
    let (Some(braking), Some(climbing)) = (sides.pop(), sides.pop()) else {
        return Err(does_not_move(solver));
    };
    let energies = climbing.work.iter().zip(&climbing.slip);
    let max_energy = energies
        .map(|(work, slip)| work / (1.0 - slip))
        .fold(0.0, f64::max);
    Ok(SlipTable {
        envelope,
        rolls,
        steps,
        steepest,
        rolling,
        climbing,
        braking,
        error: TableError::default(),
        max_energy,
        is_closed: false,
        wheel_solves: near.nodes.as_ref().map_or(0, WheelNodes::computed),
    })
}

fn does_not_move(solver: &DemandSolver) -> Error {
    Error::DoesNotMove {
        name: solver.model().robot.name().to_owned(),
        draw: 0,
    }
}

/// The pitch between two that demands this slip, perhaps near `guess`; `None` where neither end encloses it.
fn pitch_of(
    near: &Near<'_>,
    (roll, slip): (f64, f64),
    (low, high): (f64, f64),
    guess: Option<f64>,
) -> Result<Option<f64>> {
    let surplus = |pitch: f64| -> Result<f64> {
        Ok(near.posed(pitch, roll)?.surplus(slip)?.unwrap_or(f64::NAN))
    };
    let weight = near.solver.model().weight();
    let inside = guess.filter(|guess| low < *guess && *guess < high);
    if let Some(found) = inside.map(|guess| secant(guess, weight, (low, high), surplus)) {
        let found = found?;
        if found.is_some() {
            return Ok(found);
        }
    }
    let (from, to) = ((low, surplus(low)?), (high, surplus(high)?));
    if !(from.1 >= 0.0 && to.1 <= 0.0) {
        return Ok(None);
    }
    let (first, last) = ((-to.0, to.1), (-from.0, from.1));
    let mirrored = |pitch: f64| surplus(-pitch).map(Some);
    Ok(Some(-crossing(first, last, PITCH_TOLERANCE_RAD, mirrored)?))
}

/// The pitch at which the surplus vanishes, by the method of secants from a pitch that is near it; `None`
/// where it leaves the range or does not converge. A change of pitch moves loads from wheel to wheel, which
/// changes their pull by little: the surplus falls nearly by the weight's share along the slope, which is the
/// first step.
fn secant(
    guess: f64,
    weight: f64,
    (low, high): (f64, f64),
    surplus: impl Fn(f64) -> Result<f64>,
) -> Result<Option<f64>> {
    const MAX_STEPS: u32 = 8;
    let (mut before, mut at_before) = (guess, surplus(guess)?);
    let mut pitch = before + at_before / (weight * before.cos());
    for _ in 0..MAX_STEPS {
        if !(low..=high).contains(&pitch) {
            return Ok(None);
        }
        if (pitch - before).abs() <= PITCH_TOLERANCE_RAD {
            return Ok(Some(pitch));
        }
        let here = surplus(pitch)?;
        if here == 0.0 {
            return Ok(Some(pitch));
        }
        let next = pitch - here * (pitch - before) / (here - at_before);
        (before, at_before, pitch) = (pitch, here, next);
    }
    Ok(None)
}

/// How far up (`sense` 1) or down (−1) the robot drives at this roll, perhaps near the limit of a roll beside it.
pub(super) fn limit(
    near: &Near<'_>,
    envelope: Envelope,
    (roll, rolling): (f64, f64),
    sense: f64,
    beside: Option<&Limit>,
) -> Result<Limit> {
    // many slips are tried on one slope
    let last = RefCell::new(None);
    let surplus = |slope: f64, slip: f64| -> Result<Option<f64>> {
        let mut last = last.borrow_mut();
        let posed = match last.take() {
            Some((at, posed)) if at == slope => posed,
            _ => near.posed(sense * slope, roll)?,
        };
        let surplus = posed.surplus(sense * slip)?;
        *last = Some((slope, posed));
        Ok(surplus.map(|surplus| sense * surplus))
    };
    // a gentle slip that holds the whole envelope spares the search, and wheels at high slip
    for slip in GENTLE_SLIPS {
        let is_allowed = slip <= near.solver.max_slip();
        if is_allowed && surplus(envelope.max_pitch, slip)?.is_some_and(|left| left >= 0.0) {
            return Ok(Limit {
                pitch: sense * envelope.max_pitch,
                slip: None,
                holding: sense * slip,
            });
        }
    }
    let search = SlopeSearch {
        weight: near.solver.model().weight(),
        slopes: (sense * rolling, envelope.max_pitch),
        max_slip: near.solver.max_slip(),
        near: beside.and_then(|beside| beside.slip).map(f64::abs),
    };
    let found = search.steepest(surplus, surplus)?;
    let (slope, slip) = found.unwrap_or((sense * rolling, 0.0));
    Ok(Limit {
        pitch: sense * slope,
        slip: (slope < envelope.max_pitch).then_some(sense * slip),
        holding: sense * slip,
    })
}

fn side(
    near: &Near<'_>,
    envelope: Envelope,
    rolling: &[f64],
    (limits, sense): (&[Limit], f64),
    steps: usize,
    roll_of: &impl Fn(f64) -> f64,
) -> Result<Side> {
    let capped = limits.iter().filter(|limit| limit.slip.is_none()).count();
    let (limit, beyond) = if capped == 0 {
        (
            limits.iter().map(|limit| limit.pitch).collect(),
            Beyond::Soil,
        )
    } else if capped == limits.len() {
        (
            vec![sense * envelope.max_pitch; limits.len()],
            Beyond::Envelope,
        )
    } else {
        // one limit for all rolls, the nearest: a kink in it would spoil the cubics
        let nearest = limits
            .iter()
            .map(|limit| limit.pitch * sense)
            .fold(f64::INFINITY, f64::min);
        (vec![nearest * sense; limits.len()], Beyond::Unknown)
    };
    let count = limits.len() * steps;
    let mut out = Side {
        limit,
        beyond,
        slip: vec![0.0; count],
        work: vec![f64::NAN; count],
        sinkage: vec![f64::NAN; count],
        limit_error: MIN_LIMIT_ERROR_RAD,
        marginal: 0.0,
    };
    for (index, own) in limits.iter().enumerate() {
        let roll = roll_of(index as f64);
        let (rolling, limit) = (rolling[index], out.limit[index]);
        // from rolling (t = 1) to the limit (t = 0)
        // the slips of the three nodes before, the last one first
        let mut slips = [0.0; 3];
        for step in (0..steps).rev() {
            let t = step as f64 / (steps - 1) as f64;
            let pitch = limit - (limit - rolling) * t * t;
            let here = near.posed(pitch, roll)?;
            let slip = match own.slip {
                Some(end) if step == 0 && own.pitch == limit => end,
                _ if step == steps - 1 => 0.0,
                _ => {
                    let known = steps - 1 - step;
                    next_slip(&here, (slips, known), own.holding, sense)?
                }
            };
            slips = [slip, slips[0], slips[1]];
            let at = index * steps + step;
            out.slip[at] = slip;
            let Driving {
                work_per_metre,
                sinkage,
                ..
            } = here.driving(slip)?;
            out.work[at] = work_per_metre * (1.0 - slip.max(0.0));
            out.sinkage[at] = sinkage;
        }
    }
    Ok(out)
}

/// The slip that is demanded a little further on, between the one before and the limit's; `known` of the
/// slips before are those of nodes.
///
/// It is sought near the parabola through three of them.
fn next_slip(
    here: &Posed<'_>,
    (slips, known): ([f64; 3], usize),
    end: f64,
    sense: f64,
) -> Result<f64> {
    /// Half of the bracket about the parabola, as a share of the step before.
    const BRACKET_SHARE: f64 = 0.05;
    let before = slips[0];
    let value = |slip: f64| -> Result<f64> { Ok(here.surplus(slip)?.unwrap_or(f64::NAN)) };
    let guess = 3.0 * (slips[0] - slips[1]) + slips[2];
    let half = BRACKET_SHARE * (slips[0] - slips[1]).abs() * sense;
    let [near, far] = [guess - half, guess + half];
    if known >= 3 && (near - before) * sense > 0.0 && (end - far) * sense > 0.0 {
        let bracket = [(near, value(near)?), (far, value(far)?)];
        if bracket[0].1 * sense < 0.0 && bracket[1].1 * sense >= 0.0 {
            return here.between(bracket[0], bracket[1], NODE_TOLERANCE);
        }
    }
    let at_before = value(before)?;
    // not enough yet at the slip before; rounding may say otherwise right beside it
    if !(at_before * sense < 0.0) {
        return Ok(before);
    }
    let at_end = value(end)?;
    if !(at_end * sense >= 0.0) {
        return Ok(end);
    }
    here.between((before, at_before), (end, at_end), NODE_TOLERANCE)
}
