//! The sinkage at which a wheel carries its load.

use grouser_real::{Real, ResultField};

use crate::caution::Caution;
use crate::contact::{Contact, crossing};
use crate::error::{Error, Result};
use crate::followed::Followed;
use crate::kinematics::Kinematics;
use crate::lanes::EightNodes;
use crate::operating_point::OperatingPoint;
use crate::pressure::Pressure;
use crate::status::SolveStatus;
use crate::wheel_on_soil::WheelOnSoil;

/// Largest product of |ln(W/load)| at the last two places from which one more secant step lands within rounding: the
/// error of a step is of the order of that product, and ln W is nearly straight in ln θ_1.
const LAST_STEP: f64 = 1e-14;

/// Share of the load that the vertical force may miss it by without a caution. The search ends within 1e-9, except
/// where large stresses cancel to a load below 1e-7 N (`tests/small_loads.rs`).
pub const MAX_MISS: f64 = 1e-6;

/// Secant steps and bisections before giving up. The secant takes 4 to 7; 80 halvings reach rounding anyway.
const STEPS: u32 = 80;

/// Least depth of a contact over the radius that is searched: where soil is carried away down to the hub, nothing is left.
const MIN_DEPTH: f64 = 1e-12;

/// Entry angles with which a scan begins where the vertical force may fall with sinkage, less one.
pub(crate) const SCAN_STEPS: i32 = 10;

/// Steps of ln θ_1 below which the scan tells no turn: a top that is no wider exceeds its neighbours by less than 1e-6.
const SCAN_RESOLUTION: f64 = 1e-3;

/// Error of the rough forces of a scan at most, over pressure and strength together ([`Contact::most_force`]): the shear may change
/// its sign between two of the eight nodes of a piece. Where the load is nearer the force is evaluated as it should be.
const ROUGH_ERROR: f64 = 0.12;

/// Share of the load below which a force counts as none: from there no neighbouring sample is reached.
const NOTHING: f64 = 1e-3;

/// How the search for the sinkage under a load ended, with its result.
///
/// ```
/// use grouser_terra::{Kinematics, LoadOutcome, RigidWheel, Settings, Slip, WheelOnSoil, catalogue};
/// let soil = catalogue::find("dry-sand").expect("in the catalogue").soil()?;
/// let contact = WheelOnSoil::new(RigidWheel::new(0.125, 0.1)?, soil, Settings::default())?;
/// let motion = Kinematics::straight(Slip::new(0.2)?);
/// match contact.under_load(1e9, &motion)?.outcome {
///     LoadOutcome::NoSolution { max_load } => assert!(max_load < 1e9),
///     other => panic!("{other:?}"),
/// }
/// # Ok::<(), grouser_terra::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadOutcome<T> {
    /// Found, to rounding.
    Solved(T),
    /// No sinkage below the hub carries the load.
    NoSolution {
        /// The greatest load that was found to be carried, N.
        max_load: f64,
    },
    /// The search ended without its result.
    NotConverged,
}

impl<T> LoadOutcome<T> {
    /// The result, where there is one.
    ///
    /// ```
    /// # use grouser_terra::LoadOutcome;
    /// assert_eq!(LoadOutcome::Solved(0.02).solved(), Some(0.02));
    /// assert_eq!(LoadOutcome::<f64>::NotConverged.solved(), None);
    /// ```
    pub fn solved(self) -> Option<T> {
        match self {
            Self::Solved(found) => Some(found),
            Self::NoSolution { .. } | Self::NotConverged => None,
        }
    }

    /// The same outcome without its result.
    pub const fn status(&self) -> SolveStatus {
        match self {
            Self::Solved(_) => SolveStatus::Solved,
            Self::NoSolution { .. } => SolveStatus::NoSolution,
            Self::NotConverged => SolveStatus::NotConverged,
        }
    }

    /// The same outcome with another result.
    fn map<U>(self, f: impl FnOnce(T) -> U) -> LoadOutcome<U> {
        match self {
            Self::Solved(found) => LoadOutcome::Solved(f(found)),
            Self::NoSolution { max_load } => LoadOutcome::NoSolution { max_load },
            Self::NotConverged => LoadOutcome::NotConverged,
        }
    }
}

/// A sinkage that carries a load.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sinkage {
    /// Sinkage, m.
    pub sinkage: f64,
    /// Does another sinkage carry the same load?
    pub several: bool,
    /// Entry angle, rad.
    pub theta_1: f64,
}

/// The result of a search for the sinkage alone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SinkageSolution {
    /// How the search ended.
    pub outcome: LoadOutcome<Sinkage>,
    /// Evaluations of the stress integrals.
    pub evaluations: u32,
}

impl SinkageSolution {
    /// Sinkage, m; `None` unless solved.
    #[must_use]
    pub fn sinkage(&self) -> Option<f64> {
        self.outcome.solved().map(|found| found.sinkage)
    }
}

/// A wheel under its load, or at a prescribed sinkage.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct LoadSolution {
    /// How the search for the sinkage ended, with the operating point.
    pub outcome: LoadOutcome<OperatingPoint>,
    /// The load, N; `None` at a prescribed sinkage.
    pub load: Option<f64>,
    /// Evaluations of the stress integrals.
    pub evaluations: u32,
}

type Own = ResultField<LoadSolution>;

/// A further quantity of a point does not build: it needs a row in the list below, or is none of the interfaces'.
const _: fn(OperatingPoint) = |OperatingPoint {
                                   kinematics: _,
                                   sinkage: _,
                                   angles: _,
                                   forces: _,
                                   side_force: _,
                                   cautions: _,
                                   contact: _,
                                   radius: _,
                                   finer: _,
                                   model_error: _,
                               }| ();

impl LoadSolution {
    /// The operating point; `None` unless solved.
    #[must_use]
    pub fn point(&self) -> Option<OperatingPoint> {
        self.outcome.solved()
    }

    /// Vertical force less load, N; `None` unless solved.
    #[must_use]
    pub fn residual(&self) -> Option<f64> {
        let point = self.outcome.solved().zip(self.load);
        point.map(|(point, load)| point.forces.vertical_force - load)
    }

    /// The greatest load that was found to be carried, N, where the load is greater.
    #[must_use]
    pub const fn max_load(&self) -> Option<f64> {
        match self.outcome {
            LoadOutcome::NoSolution { max_load } => Some(max_load),
            LoadOutcome::Solved(_) | LoadOutcome::NotConverged => None,
        }
    }

    fn solved(&self) -> Option<&OperatingPoint> {
        match &self.outcome {
            LoadOutcome::Solved(point) => Some(point),
            LoadOutcome::NoSolution { .. } | LoadOutcome::NotConverged => None,
        }
    }

    /// Its fields in all interfaces.
    pub const FIELDS: &'static [Own] = &[
        Own::text("status", "status", |of| of.outcome.status().key()).shown(""),
        Own::optional("sinkage_m", "sinkage", |of| Some(of.solved()?.sinkage)).shown("mm"),
        Own::optional("theta_1_deg", "entry angle", |of| {
            Some(of.solved()?.angles.theta_1.to_degrees())
        }),
        Own::optional("theta_2_deg", "exit angle", |of| {
            Some(of.solved()?.angles.theta_2.to_degrees())
        }),
        Own::optional("theta_m_deg", "angle of the peak stress", |of| {
            Some(of.solved()?.angles.theta_m.to_degrees())
        }),
        Own::optional("vertical_force_n", "vertical force", |of| {
            Some(of.solved()?.forces.vertical_force)
        })
        .shown("N"),
        Own::optional("drawbar_pull_n", "drawbar pull", |of| {
            Some(of.solved()?.forces.drawbar_pull)
        })
        .shown("N"),
        Own::optional("side_force_n", "side force", |of| {
            Some(of.solved()?.side_force)
        })
        .shown("N"),
        Own::optional("torque_nm", "torque", |of| Some(of.solved()?.forces.torque)).shown("N m"),
        Own::optional("tractive_efficiency", "tractive efficiency", |of| {
            of.solved()?.tractive_efficiency()
        })
        .shown_or("%", "none"),
        Own::optional("energy_j_per_m", "energy", |of| {
            of.solved()?.energy_per_metre()
        })
        .shown_or("J/m", "none"),
        Own::optional(
            "pull_coefficient",
            "drawbar pull over vertical force",
            |of| of.solved()?.pull_coefficient(),
        ),
        Own::optional("compaction_resistance_n", "compaction resistance", |of| {
            Some(of.solved()?.forces.compaction_resistance)
        })
        .shown("N"),
        Own::optional(
            "running_radius_m",
            "radius at which the wheel runs on its soil, lugs included",
            |of| Some(of.solved()?.radius),
        ),
        Own::optional(
            "residual",
            "difference between the load and the vertical force",
            Self::residual,
        ),
        Own::optional(
            "energy_residual_nm",
            "torque that the energy balance leaves",
            |of| Some(of.solved()?.forces.energy_residual),
        ),
        Own::optional("error_estimate_n", "error of the integrals at most", |of| {
            Some(of.solved()?.error_estimate())
        })
        .shown("N"),
        Own::optional(
            "pull_model_error_n",
            "half of the interval about the drawbar pull that holds 90 % of measurements",
            |of| {
                let point = of.solved()?;
                Some(point.model_error?.pull_per_load * point.forces.vertical_force)
            },
        ),
        Own::optional("side_model_error_n", "the same of the side force", |of| {
            let point = of.solved()?;
            Some(point.model_error?.side_per_load * point.forces.vertical_force)
        }),
        Own::optional("sinkage_model_error_m", "the same of the sinkage", |of| {
            let point = of.solved()?;
            Some(point.model_error?.sinkage_per_radius * point.radius)
        }),
        Own::whole("evaluations", "evaluations of the forces", |of| {
            of.evaluations
        }),
        Own::optional(
            "max_load_n",
            "the maximum load that was found",
            Self::max_load,
        ),
        Own::texts("cautions", "cautions", |of, take| {
            if let Some(point) = of.solved() {
                point
                    .cautions
                    .iter()
                    .for_each(|caution| take(caution.key()));
            }
        }),
    ];
}

/// Bounds of the entry angle between which the wanted load lies, and what was spent on them.
struct Search {
    low: f64,
    high: f64,
    /// Is the load known to be reached at `high`?
    proven: bool,
    evaluations: u32,
}

/// The quantity that an operating point is solved at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prescribed {
    /// The load that the wheel carries, N.
    Load(f64),
    /// How deep it has sunk, m.
    Sinkage(f64),
}

impl Prescribed {
    /// The load, if it is prescribed.
    #[must_use]
    pub const fn load(self) -> Option<f64> {
        match self {
            Self::Load(load) => Some(load),
            Self::Sinkage(_) => None,
        }
    }

    /// The sinkage, if it is prescribed.
    #[must_use]
    pub const fn sinkage(self) -> Option<f64> {
        match self {
            Self::Load(_) => None,
            Self::Sinkage(sinkage) => Some(sinkage),
        }
    }
}

impl WheelOnSoil {
    /// The operating point at a load or a sinkage.
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`] and [`WheelOnSoil::at_sinkage`].
    pub fn solve(&self, prescribed: Prescribed, kinematics: &Kinematics) -> Result<LoadSolution> {
        match prescribed {
            Prescribed::Load(load) => self.under_load(load, kinematics),
            Prescribed::Sinkage(sinkage) => Ok(LoadSolution {
                outcome: LoadOutcome::Solved(self.at_sinkage(sinkage, kinematics)?),
                load: None,
                evaluations: 1,
            }),
        }
    }

    /// The operating point at which the wheel carries `load` (N).
    ///
    /// The result is the lowest sinkage at which the vertical force reaches the load from below; where it does so or falls below it
    /// again deeper, with a caution. Only a braked wheel and one on soil that springs back have several. The force is followed from
    /// a tenth of the entry angle that is expected without shear: eleven samples, and more wherever a cubic through them may turn and
    /// reach the load. A top that all of them miss, or one below the first, is not found (`tests/properties.rs` has the share).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a negative load and for an exponent n(s) outside its range. A load that
    /// nothing carries is a status, not an error.
    pub fn under_load(&self, load: f64, kinematics: &Kinematics) -> Result<LoadSolution> {
        let found = self.sinkage_under(load, kinematics)?;
        let outcome = found.outcome.map(|found| {
            let mut point = self.point(found.theta_1, kinematics);
            point.sinkage = found.sinkage;
            point
                .cautions
                .insert_if(found.several, Caution::SeveralSinkages);
            let missed = (point.forces.vertical_force - load).abs();
            point
                .cautions
                .insert_if(!(missed <= MAX_MISS * load), Caution::LoadBelowResolution);
            point
        });
        let last = u32::from(matches!(outcome, LoadOutcome::Solved(_)));
        Ok(LoadSolution {
            outcome,
            load: Some(load),
            evaluations: found.evaluations + last,
        })
    }

    /// The sinkage alone: the fast way.
    ///
    /// # Errors
    /// As [`WheelOnSoil::under_load`].
    pub fn sinkage_under(&self, load: f64, kinematics: &Kinematics) -> Result<SinkageSolution> {
        Error::check_range("load", load, 0.0, 1e12, "N")?;
        self.check_exponent(kinematics)?;
        let mut search = Search {
            low: 0.0,
            high: self.entry_limit(kinematics),
            proven: false,
            evaluations: 0,
        };
        let outcome = self.search(load, kinematics, &mut search);
        Ok(SinkageSolution {
            outcome,
            evaluations: search.evaluations,
        })
    }

    fn search(
        &self,
        load: f64,
        kinematics: &Kinematics,
        search: &mut Search,
    ) -> LoadOutcome<Sinkage> {
        if load == 0.0 {
            return LoadOutcome::Solved(Sinkage {
                sinkage: 0.0,
                several: false,
                theta_1: 0.0,
            });
        }
        let contact = self.contacts(kinematics);
        let force = |theta_1| {
            contact(theta_1)
                .forces_by(self.tables(), self.order())
                .vertical_force
        };
        let mut several = false;
        if self.may_fall(kinematics) {
            let least = self.scan_start(load, search.high);
            let ladder = Ladder::new(least, search.high);
            let rough = self.rough_forces(&ladder, (load, &contact), search);
            let turns = self.turning_angles(kinematics);
            // the greatest load is known from forces as they should be
            let scanned = search
                .scan(load, (&ladder, rough), turns, &force)
                .or_else(|_| search.scan(load, (&ladder, [None; Ladder::COUNT]), turns, &force));
            match scanned {
                Ok(more) => several = more,
                Err(max_load) => return LoadOutcome::NoSolution { max_load },
            }
        }
        let start = self.bekker_start(load);
        let slope = 2.0 * self.laws().exponent.n_0 + 1.0;
        search
            .secant(load, (start, slope), &force)
            .map(|theta_1| Sinkage {
                sinkage: self.sinkage_at(theta_1, kinematics),
                several,
                theta_1,
            })
    }

    /// The vertical force (N) at each place of a ladder, where a rough one shows on which side of the load it lies.
    fn rough_forces(
        &self,
        ladder: &Ladder,
        (load, contact): (f64, &impl Fn(f64) -> Contact<f64>),
        search: &mut Search,
    ) -> [Option<f64>; Ladder::COUNT] {
        let mut found = [None; Ladder::COUNT];
        if self.settings().shear.restart().0 {
            return found;
        }
        for (places, found) in ladder.places.chunks(8).zip(found.chunks_mut(8)) {
            let last = places[places.len() - 1];
            let contacts = core::array::from_fn(|k| contact(*places.get(k).unwrap_or(&last)));
            search.evaluations += 1;
            let integrals = EightNodes::best().rough(&contacts);
            for ((contact, integrals), found) in contacts.iter().zip(&integrals).zip(found) {
                let force = contact.assemble(integrals).vertical_force;
                let near = ROUGH_ERROR * contact.most_force(integrals);
                *found = ((force - load).abs() > near).then_some(force);
            }
        }
        found
    }

    /// Can the vertical force fall as the wheel sinks? Driving on soil that does not rise behind the
    /// wheel it cannot: every angle of the contact is positive and every stress grows with θ_1.
    pub(crate) fn may_fall(&self, kinematics: &Kinematics) -> bool {
        let params = self.soil().params();
        params.rebound > 0.0 || !kinematics.slip().is_driving()
    }

    /// The entry angle just below which the hub, or the soil behind the wheel, is reached: z max(1, λ) = r less what is carried away, with the law for a buried hub
    /// z max(2/3, λ) = r.
    pub(crate) fn entry_limit(&self, kinematics: &Kinematics) -> f64 {
        let carried = self
            .laws()
            .transport_depth(&self.motion_of(kinematics), self.size());
        let left = (self.depth_limit(kinematics) - carried / self.size().radius).max(MIN_DEPTH);
        self.angle_limit(1.0 / left)
    }

    /// The entry angle just below which z max(`least`, λ) = r.
    fn angle_limit(&self, least: f64) -> f64 {
        let reach = self.soil().params().rebound.max(least);
        2.0 * Real::asin(Real::sqrt(0.5 / reach)) * (1.0 - 1e-12)
    }

    /// The least entry angle of a coarse scan that ends at `top`: a tenth of the expected angle.
    pub(crate) fn scan_start(&self, load: f64, top: f64) -> f64 {
        0.1 * self.bekker_start(load).min(0.5 * top)
    }

    /// Entry angles between which the vertical force of a braked wheel falls and from which it rises again, where soil rises behind
    /// it and K is less than its displacement: soil that was pushed forwards supports the rear, until none of the displacement is
    /// forwards any more. `None` where the displacement only grows or is less than K.
    fn turning_angles(&self, kinematics: &Kinematics) -> Option<[f64; 2]> {
        let (params, q) = (self.soil().params(), kinematics.slip().speed_ratio());
        if !(params.rebound > 0.0 && q > 1.0 && q.is_finite()) {
            return None;
        }
        // the rim moves along with the soil here, and is pushed forwards furthest
        let turn = Real::acos(1.0 / q);
        if params.k_shear > self.size().radius * (Real::tan(turn) - turn) {
            return None;
        }
        let rear = |theta_1: f64| {
            let share = Real::sqrt(params.rebound) * Real::sin(0.5 * theta_1);
            turn.min(2.0 * Real::asin(share.min(1.0)))
        };
        let left = |theta_1: f64| {
            let rear = rear(theta_1);
            theta_1 + rear - q * (Real::sin(theta_1) + Real::sin(rear))
        };
        // j/r at the lowest point vanishes at about √3 times that angle
        let bottom = Real::sqrt(3.0_f64) * turn;
        let ends = [turn, core::f64::consts::PI].map(|place| (place, left(place)));
        (ends[1].1 > 0.0).then(|| {
            let none = crossing(left, ends, (0.0, SCAN_RESOLUTION));
            [0.5 * (bottom + none), none]
        })
    }

    /// Entry angle by Bekker's z = [3 W/((3 − n) b k √(2r))]^(2/(2n + 1)), held inside the model.
    fn bekker_start(&self, load: f64) -> f64 {
        let laws = self.laws();
        let n = laws.exponent.n_0;
        let (radius, width) = (self.size().radius, self.size().width);
        let modulus = match laws.pressure {
            Pressure::Bekker(law) => law.modulus(width),
            Pressure::Reece(_) => laws.modulus(width, n),
        };
        let shape = (3.0 - n).max(0.5);
        let base = 3.0 * load / (shape * width * modulus * Real::sqrt(2.0 * radius));
        let sinkage = Real::powf(base, 2.0 / (2.0 * n + 1.0));
        let limit = self.angle_limit(1.0);
        let relative = (0.5 * sinkage / radius).min(0.5);
        (2.0 * Real::asin(Real::sqrt(relative))).clamp(1e-9, 0.9 * limit)
    }
}

/// The entry angles (rad) with which a scan begins: a geometric ladder from the least to the greatest.
struct Ladder {
    places: [f64; Self::COUNT],
}

impl Ladder {
    const COUNT: usize = SCAN_STEPS as usize + 1;

    fn new(least: f64, top: f64) -> Self {
        let ratio = Real::powf(top / least, 1.0 / f64::from(SCAN_STEPS));
        let mut places = [top; Self::COUNT];
        for (place, i) in places.iter_mut().zip(0..SCAN_STEPS) {
            *place = least * Real::powi(ratio, i);
        }
        Self { places }
    }
}

impl Search {
    /// Narrows the bracket to the lowest interval in which the vertical force (N) rises through `load`: a coarse scan of a ladder,
    /// and more samples where the force may turn between them. `force` to 1e-6 may decide. Returns whether there is another
    /// interval. `Err` with the greatest force seen if there is none.
    fn scan(
        &mut self,
        load: f64,
        (ladder, rough): (&Ladder, [Option<f64>; Ladder::COUNT]),
        turns: Option<[f64; 2]>,
        force: &impl Fn(f64) -> f64,
    ) -> core::result::Result<bool, f64> {
        let top = self.high;
        let mut most = f64::NEG_INFINITY;
        let mut look = |search: &mut Self, theta_1: f64, rough: Option<f64>| {
            let force = rough.unwrap_or_else(|| search.look(theta_1, force));
            most = most.max(force);
            // straight in ln θ_1, and what is far below the load never decides
            Real::ln((force / load).max(NOTHING))
        };
        let mut followed = Followed::new(SCAN_RESOLUTION);
        let (mut before, mut bracket) = ((0.0, -1.0), None);
        for (theta_1, rough) in ladder.places.into_iter().zip(rough) {
            let now = (theta_1, look(self, theta_1, rough));
            if before.1 < 0.0 && now.1 >= 0.0 && bracket.is_none() {
                bracket = Some((before.0, theta_1));
            }
            followed.add(Real::ln(theta_1), now.1);
            before = now;
        }
        let passes = followed.passes();
        for theta_1 in turns.into_iter().flatten().filter(|turn| *turn < top) {
            followed.add(Real::ln(theta_1), look(self, theta_1, None));
        }
        while let Some(place) = followed.next_place() {
            followed.add(place, look(self, Real::exp(place), None));
        }
        if followed.passes() > passes
            && let Some([low, high]) = followed.first_rise()
        {
            bracket = Some((Real::exp(low.0), Real::exp(high.0)));
        }
        let (low, high) = bracket.ok_or(most)?;
        self.low = low;
        self.high = high;
        self.proven = true;
        Ok(followed.passes() > 1)
    }

    /// The secant method in (ln θ_1, ln W), inside the bracket; bisection where W is not positive or not
    /// rising. Source of the start and of its slope: Bekker's closed form for a wheel without shear \[Bekker69\].
    fn secant(
        &mut self,
        load: f64,
        (mut theta_1, mut slope): (f64, f64),
        force: &impl Fn(f64) -> f64,
    ) -> LoadOutcome<f64> {
        let mut before: Option<(f64, f64)> = None;
        for _ in 0..STEPS {
            if theta_1 >= self.high && !self.proven {
                let top = self.look(self.high, force);
                if !(top >= load) {
                    return LoadOutcome::NoSolution { max_load: top };
                }
                self.proven = true;
            }
            if !(theta_1 > self.low && theta_1 < self.high) {
                theta_1 = self.middle();
            }
            let force = self.look(theta_1, force);
            if force >= load {
                self.high = theta_1;
                self.proven = true;
            } else {
                self.low = theta_1;
            }
            let off = if force > 0.0 {
                Real::ln(force / load)
            } else {
                f64::NEG_INFINITY
            };
            let place = Real::ln(theta_1);
            let mut last = off == 0.0;
            if let Some((place_before, off_before)) = before {
                slope = (off - off_before) / (place - place_before);
                last |= (off * off_before).abs() <= LAST_STEP;
            }
            before = off.is_finite().then_some((place, off));
            if off.is_finite() && slope > 0.0 {
                let next = theta_1 * Real::exp(-off / slope);
                if last {
                    return LoadOutcome::Solved(next);
                }
                theta_1 = next;
            } else {
                theta_1 = self.middle();
            }
            if self.proven && self.high - self.low <= 2.0 * f64::EPSILON * self.high {
                return LoadOutcome::Solved(self.high);
            }
        }
        LoadOutcome::NotConverged
    }

    fn look(&mut self, theta_1: f64, force: &impl Fn(f64) -> f64) -> f64 {
        self.evaluations += 1;
        force(theta_1)
    }

    /// The bracket's geometric middle (its upper part while nothing is known below).
    fn middle(&self) -> f64 {
        if self.low > 0.0 {
            Real::sqrt(self.low * self.high)
        } else {
            0.1 * self.high
        }
    }
}

#[cfg(test)]
mod tests;
