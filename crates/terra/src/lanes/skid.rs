//! Skids of many free wheels.
//!
//! All points share wheel and soil: vertical force and torque at a few slips and entry angles, computed once, show where each
//! point's skid lies and which sinkage carries its load there. From there Broyden's method in both unknowns, slip and
//! ln θ_1, needs no search for a sinkage at each slip: it starts with forces to 1e-6 and ends with those of the general search.

use grouser_real::Real;

use crate::error::{Error, Result};
use crate::followed::{Followed, is_monotone};
use crate::kinematics::Kinematics;
use crate::settings::{Accuracy, Settings};
use crate::sinkage::SCAN_STEPS;
use crate::slip::Slip;
use crate::status::SolveStatus;
use crate::wheel::RigidWheel;
use crate::wheel_on_soil::WheelOnSoil;

use super::batch::BatchKernel;
use super::columns::BatchInput;
use super::searches::End;

/// Slips of the table, from −1 to 0: those at which the general search begins.
const SLIPS: usize = 9;
const SLIP_STEP: f64 = 1.0 / (SLIPS - 1) as f64;
/// Entry angles of the table: neighbours differ by 18 %.
const ANGLES: usize = 32;
/// The least of them, rad: that of the forces to 1e-6.
const LEAST_ENTRY_RAD: f64 = 0.01;

/// The greatest friction of a bearing, as [`WheelOnSoil::free_slip`] has it.
const MAX_BEARING_TORQUE_NM: f64 = 1e9;

/// What an interpolated T/(r W) may lack: between neighbours it is straight to a thousandth.
const TURN_MARGIN: f64 = 0.01;
/// By which factor a vertical force may exceed its neighbours in the table, near its maximum.
const LOAD_MARGIN: f64 = 1.1;

/// Where both residuals (ln(W/load), and T/(r W), 1) are below this, the exact forces go on: they would after a further step anyway,
/// since the rough ones are known to 1e-6.
const MAX_ROUGH_RESIDUAL: f64 = 1e-4;
/// Share of the step between slips of the table up to which a root lies at the first one: interpolation there tells no slope.
const MIN_RUN: f64 = 0.1;
/// After a step below this, in both unknowns, the next one is below rounding.
const LAST_STEP: f64 = 1e-9;
/// Most evaluations of a search; from the table most take four or five.
const MAX_EVALUATIONS: u32 = 16;

impl BatchKernel {
    /// The skid of a free wheel under each `load` (N) with each `bearing_torque` (N m): [`WheelOnSoil::free_slip`] of every
    /// point, within 1e-9. Where the wheel locks, `slip` is NaN and the status [`SolveStatus::NoSolution`].
    ///
    /// A table of forces that all points share takes as long as one point by itself, and each point a twentieth of that. Points
    /// that the table leaves undecided are searched by themselves, and so is every point on soil that springs back, on soil that
    /// a rim carries along, and of a wheel with lugs.
    ///
    /// ```
    /// use grouser_terra::{BatchKernel, RigidWheel, SolveStatus, catalogue};
    ///
    /// let kernel = BatchKernel::new(catalogue::find("dry-sand").expect("in the catalogue").soil()?);
    /// let (mut slip, mut status) = ([0.0; 2], [SolveStatus::default(); 2]);
    /// kernel.free_wheel_skid(&RigidWheel::new(0.05, 0.03)?, 5.0, &[0.0, 1.0], &mut slip, &mut status)?;
    /// assert!((slip[0] + 0.095).abs() < 5e-4); // it lags by nearly a tenth
    /// assert_eq!(status[1], SolveStatus::NoSolution); // 1 N m is more than the soil turns it with
    /// # Ok::<(), grouser_terra::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Lengths`] if the columns differ in length. A bad point is a status.
    pub fn free_wheel_skid<'a>(
        &self,
        wheel: &RigidWheel,
        load: impl Into<BatchInput<'a>>,
        bearing_torque: impl Into<BatchInput<'a>>,
        slip: &mut [f64],
        status: &mut [SolveStatus],
    ) -> Result<()> {
        let (load, bearing_torque) = (load.into(), bearing_torque.into());
        let n = status.len();
        Error::check_length(slip.len(), n)?;
        load.check_length(n)?;
        bearing_torque.check_length(n)?;
        let on_soil = WheelOnSoil::new(*wheel, *self.soil(), Settings::default())?;
        let table = SkidTable::serving(&on_soil);
        for (i, (slip, status)) in slip.iter_mut().zip(status).enumerate() {
            let (load, bearing_torque) = (load.at(i), bearing_torque.at(i));
            let end = table
                .as_ref()
                .map_or(End::Unsure, |table| table.skid(load, bearing_torque));
            (*slip, *status) = match end {
                End::Found(skid) => (skid, SolveStatus::Solved),
                End::NoSolution => (f64::NAN, SolveStatus::NoSolution),
                End::Unsure => match on_soil.free_slip(load, bearing_torque) {
                    Ok(Some(skid)) => (skid.value(), SolveStatus::Solved),
                    Ok(None) => (f64::NAN, SolveStatus::NoSolution),
                    Err(_) => (f64::NAN, SolveStatus::BadInput),
                },
            };
        }
        Ok(())
    }
}

/// W and T/r, N, or ln W and T/(r W), or slip and ln θ_1.
type Pair = [f64; 2];

/// The forces of one wheel on one soil at slips from −1 to 0.
struct SkidTable<'a> {
    on_soil: &'a WheelOnSoil,
    /// The same to 1e-6.
    rough: WheelOnSoil,
    /// ln θ_1 of the first entry angle, and the step.
    first: f64,
    step: f64,
    /// W and T/r by slip and entry angle.
    rows: [[Pair; ANGLES]; SLIPS],
}

/// What a point's wheel carries and turns against.
struct Wanted {
    load: f64,
    /// T/(r W)
    turn: f64,
    /// ln θ_1 of the first sample of the general search for a sinkage, and from one to the next.
    samples: (f64, f64),
}

/// Is a load carried at a slip of the table?
enum Carrying {
    At(Carried),
    Not,
    Unsure,
}

/// Where a load is carried at a slip of the table.
#[derive(Clone, Copy)]
struct Carried {
    slip: f64,
    /// The last entry angle that carries less, and the forces there and at the next one.
    below: usize,
    nodes: [Pair; 2],
    /// T/(r W)
    turn: f64,
    /// Does no deeper sinkage of the table carry less, and one clearly more?
    is_only: bool,
}

/// Where the search for a skid begins.
struct Start {
    place: Pair,
    slopes: [Pair; 2],
    within: [(f64, f64); 2],
}

impl<'a> SkidTable<'a> {
    /// `None` where the force may fall as even a driven wheel sinks: several sinkages are the rule there.
    fn serving(on_soil: &'a WheelOnSoil) -> Option<Self> {
        (!on_soil.may_fall(&Kinematics::straight(Slip::ZERO))).then(|| Self::new(on_soil))
    }

    fn new(on_soil: &'a WheelOnSoil) -> Self {
        let rough = on_soil.with_accuracy(Accuracy::Simulation);
        let first = Real::ln(LEAST_ENTRY_RAD);
        let last = Real::ln(on_soil.entry_limit(&Kinematics::straight(Slip::ZERO)));
        let step = (last - first) / (ANGLES - 1) as f64;
        let row = |k: usize| {
            core::array::from_fn(|i| {
                let place = [k as f64 * SLIP_STEP - 1.0, first + i as f64 * step];
                forces(&rough, place).unwrap_or([f64::NAN; 2])
            })
        };
        Self {
            on_soil,
            rows: core::array::from_fn(row),
            rough,
            first,
            step,
        }
    }

    /// Where a load is carried at a slip, as the general search for its sinkage finds it: at the least entry angle at which the
    /// vertical force reaches it, where one of that search's samples lies before the force falls below it again.
    fn carried(&self, k: usize, wanted: &Wanted) -> Carrying {
        let row = &self.rows[k];
        let Wanted {
            load,
            samples: (first, spacing),
            ..
        } = *wanted;
        let Some(above) = row.iter().position(|node| node[0] >= load) else {
            let is_clear = row.iter().all(|node| node[0] * LOAD_MARGIN < load);
            return if is_clear {
                Carrying::Not
            } else {
                Carrying::Unsure
            };
        };
        let place = |i: usize| self.first + i as f64 * self.step;
        let count = row[above..]
            .iter()
            .take_while(|node| node[0] >= load)
            .count();
        let end = above + count;
        let is_seen = end == ANGLES
            || (0..SCAN_STEPS).any(|i| {
                let sample = first + f64::from(i) * spacing;
                sample >= place(above) && sample <= place(end - 1)
            });
        let nodes = match above.checked_sub(1) {
            Some(below) if is_seen => [row[below], row[above]],
            _ => return Carrying::Unsure,
        };
        // the torque is nearly straight in the force
        let [low, high] = nodes;
        let torque = low[1] + (load - low[0]) / (high[0] - low[0]) * (high[1] - low[1]);
        Carrying::At(Carried {
            slip: k as f64 * SLIP_STEP - 1.0,
            below: above - 1,
            nodes,
            turn: torque / load,
            // between the slips of the table as well
            is_only: end == ANGLES && row.iter().any(|node| node[0] >= LOAD_MARGIN * load),
        })
    }

    /// ln θ_1 there, and the derivatives of ln W and T/(r W) by it.
    fn place(&self, carried: &Carried, load: f64) -> (f64, Pair) {
        let [low, high] = carried.nodes;
        let (share, slopes) = if low[0] > 0.0 {
            let rise = Real::ln(high[0] / low[0]);
            let turns = high[1] / high[0] - low[1] / low[0];
            (Real::ln(load / low[0]) / rise, [rise, turns])
        } else {
            let rise = (high[0] - low[0]) / load;
            let turns = (high[1] - low[1]) / load - carried.turn * rise;
            ((load - low[0]) / (high[0] - low[0]), [rise, turns])
        };
        (
            self.first + (carried.below as f64 + share) * self.step,
            slopes.map(|change| change / self.step),
        )
    }

    fn wanted(&self, load: f64, bearing_torque: f64) -> Wanted {
        let last = self.first + (ANGLES - 1) as f64 * self.step;
        let first = Real::ln(self.on_soil.scan_start(load, Real::exp(last)));
        Wanted {
            load,
            turn: -bearing_torque / (load * self.on_soil.size().radius),
            samples: (first, (last - first) / f64::from(SCAN_STEPS)),
        }
    }

    /// The skid of one point.
    fn skid(&self, load: f64, bearing_torque: f64) -> End<f64> {
        if !(load > 0.0 && (0.0..=MAX_BEARING_TORQUE_NM).contains(&bearing_torque)) {
            return End::Unsure;
        }
        let wanted = self.wanted(load, bearing_torque);
        let mut before: Option<Carried> = None;
        let mut followed = Followed::new(0.0);
        for k in 0..SLIPS {
            let now = match (self.carried(k, &wanted), before) {
                (Carrying::At(now), _) => now,
                // a locked wheel may sink where one that turns does not
                (Carrying::Not, None) => continue,
                _ => return End::Unsure,
            };
            let surplus = now.turn - wanted.turn;
            followed.add(now.slip, surplus);
            match before {
                None if k == 0 && surplus >= TURN_MARGIN => return End::NoSolution,
                None if surplus > -TURN_MARGIN => return End::Unsure,
                Some(before) if surplus >= 0.0 => {
                    // of several sinkages the general search may take another than at the slips of the table
                    let is_sure = before.is_only && now.is_only && followed.next_place().is_none();
                    let slope = followed.slope_before_last();
                    let found = is_sure
                        .then(|| self.root((&before, &now), slope, &wanted))
                        .flatten();
                    return found.map_or(End::Unsure, End::Found);
                }
                // between two samples of which the second one is less, a torque with a single maximum exceeds both by no more
                // than it changes beside them
                Some(before) if now.turn < before.turn => {
                    let change = 2.0 * (before.turn - now.turn) + TURN_MARGIN;
                    if before.turn - wanted.turn + change >= 0.0 {
                        return End::Unsure;
                    }
                }
                _ => {}
            }
            before = Some(now);
        }
        End::Unsure
    }

    /// Where a search between two slips of the table begins: slip and ln θ_1, the derivatives of ln W and of T/(r W) by both, and
    /// what it is held within.
    fn start(&self, (low, high): (&Carried, &Carried), wanted: &Wanted) -> Start {
        let ((ln_low, slopes_low), (ln_high, slopes_high)) =
            (self.place(low, wanted.load), self.place(high, wanted.load));
        let share = (wanted.turn - low.turn) / (high.turn - low.turn);
        let between = |low: f64, high: f64| low + share * (high - low);
        let by_angle = [0, 1].map(|j| between(slopes_low[j], slopes_high[j]));
        // along the slip under the load both changes are known
        let deeper = (ln_high - ln_low) / SLIP_STEP;
        let by_slip = [
            -by_angle[0] * deeper,
            (high.turn - low.turn) / SLIP_STEP - by_angle[1] * deeper,
        ];
        Start {
            place: [between(low.slip, high.slip), between(ln_low, ln_high)],
            slopes: [0, 1].map(|j| [by_slip[j], by_angle[j]]),
            // what the table's interpolation lacks is less than these
            within: [
                (low.slip - 0.1 * SLIP_STEP, high.slip + 0.1 * SLIP_STEP),
                (
                    ln_low.min(ln_high) - self.step,
                    ln_low.max(ln_high) + self.step,
                ),
            ],
        }
    }

    /// The slip between two of the table at which the wheel carries the wanted load and turns as wanted; `None` where the torque,
    /// which grows by `slope` per slip at the first one, need not rise steadily up to there.
    fn root(&self, between: (&Carried, &Carried), slope: f64, wanted: &Wanted) -> Option<f64> {
        let low = between.0;
        let start = self.start(between, wanted);
        let ln_load = Real::ln(wanted.load);
        let off = |is_rough: bool, place: Pair| {
            let on_soil = if is_rough { &self.rough } else { self.on_soil };
            let [force, torque] = forces(on_soil, place)?;
            (force > 0.0).then(|| [Real::ln(force) - ln_load, torque / force - wanted.turn])
        };
        let start_of = (start.place, inverse(start.slopes));
        let ([slip, _], slope_there) = broyden(start_of, start.within, off)?;
        let run = slip - low.slip;
        let is_steady = run < MIN_RUN * SLIP_STEP
            || is_monotone((wanted.turn - low.turn) / run, [slope, slope_there]);
        (is_steady && slope_there > 0.0).then_some(slip)
    }
}

/// Where both residuals vanish, by Broyden's method from a place and the inverse of the slopes there: the unknowns, and the
/// growth of the second residual with the first unknown where the first one vanishes. `off` gives the residuals of the rough forces or of the
/// exact ones, at places within the bounds.
fn broyden(
    (mut place, mut inverse): (Pair, [Pair; 2]),
    within: [(f64, f64); 2],
    off: impl Fn(bool, Pair) -> Option<Pair>,
) -> Option<(Pair, f64)> {
    let mut is_rough = true;
    let mut before: Option<(Pair, Pair)> = None;
    for _ in 0..MAX_EVALUATIONS {
        let off = off(is_rough, place)?;
        if let Some((step, off_before)) = before {
            // Broyden: the least change of the inverse that explains the last step
            let change = times(&inverse, [off[0] - off_before[0], off[1] - off_before[1]]);
            let row = [0, 1].map(|j| step[0] * inverse[0][j] + step[1] * inverse[1][j]);
            let scale = step[0] * change[0] + step[1] * change[1];
            // no step explains nothing
            if scale != 0.0 {
                for (row_of, (step, change)) in inverse.iter_mut().zip(step.into_iter().zip(change))
                {
                    for (x, row) in row_of.iter_mut().zip(row) {
                        *x += (step - change) * row / scale;
                    }
                }
            }
        }
        let whole = times(&inverse, off).map(|x| -x);
        let next = [0, 1].map(|j| (place[j] + whole[j]).max(within[j].0).min(within[j].1));
        let step = [next[0] - place[0], next[1] - place[1]];
        place = next;
        if !is_rough && whole[0].abs() <= LAST_STEP && whole[1].abs() <= LAST_STEP {
            return Some((place, 1.0 / inverse[0][1]));
        }
        is_rough &= off[0].abs() > MAX_ROUGH_RESIDUAL || off[1].abs() > MAX_ROUGH_RESIDUAL;
        before = Some((step, off));
    }
    None
}

/// W and T/r at a slip and ln θ_1; `None` where the soil's laws have no value.
fn forces(on_soil: &WheelOnSoil, [slip, ln_theta_1]: Pair) -> Option<Pair> {
    let motion = Kinematics::straight(Slip::new(slip).ok()?);
    on_soil.check_exponent(&motion).ok()?;
    let contact = on_soil.contact(Real::exp(ln_theta_1), &motion);
    let forces = contact.forces_by(on_soil.tables(), on_soil.order());
    Some([forces.vertical_force, forces.torque / on_soil.size().radius])
}

/// The inverse of a matrix of two rows.
fn inverse([[a, b], [c, d]]: [Pair; 2]) -> [Pair; 2] {
    let scale = 1.0 / (a * d - b * c);
    [[scale * d, -scale * b], [-scale * c, scale * a]]
}

fn times(rows: &[Pair; 2], x: Pair) -> Pair {
    rows.map(|row| row[0] * x[0] + row[1] * x[1])
}

#[cfg(test)]
mod tests;
