//! A robot's wheels on one soil over load and slip, from the exact laws at nodes that are computed when they are first
//! needed.
//!
//! Tables over pitch and roll solve thousands of poses, under loads and at slips that differ little from pose to pose.
//! Pull and torque per load are smooth in ln(load) and in √|slip|: the place under a braking wheel where the rim turns
//! from driving the soil to dragging it lies at √(2|s|). Between the nodes runs the polynomial through the nearest
//! [`POINTS`] in each direction, driving and braking separately.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use grouser_rover::statics::LoadsOnPlanes;
use grouser_terra::{Accuracy, Kinematics, Slip, WheelOnSoil};

use super::{DemandSolver, Posed, of_wheel};
use crate::error::Result;

/// Nodes from which a polynomial reads, in each direction.
const POINTS: usize = 6;
/// How close the nodes lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeSpacing {
    /// Steps of √|slip| from 0 to 1 on each side.
    slip_steps: usize,
    /// Step of ln(load).
    log_load_step: f64,
    accuracy: Accuracy,
}

impl NodeSpacing {
    /// Slips to a tenth of a table's bound (`tests/table.rs`).
    pub(crate) const FINE: Self = Self {
        slip_steps: 32,
        log_load_step: 0.35,
        accuracy: Accuracy::Standard,
    };
    /// Slips to a hundredth of what learning takes for the error of the laws.
    pub(crate) const COARSE: Self = Self {
        slip_steps: 14,
        log_load_step: 0.6,
        accuracy: Accuracy::Simulation,
    };

    /// Nodes of one side.
    const fn side(self) -> usize {
        self.slip_steps + 1
    }

    /// Nodes over slip: braking from 0 on, then driving.
    const fn slips(self) -> usize {
        2 * self.side()
    }

    /// The slip of a node.
    fn slip(self, node: usize) -> f64 {
        let root = (node % self.side()) as f64 / self.slip_steps as f64;
        if node < self.side() {
            -root * root
        } else {
            root * root
        }
    }

    /// The first node of the side on which a slip lies, and the place there.
    fn along(self, slip: f64) -> (usize, Weights) {
        let place = slip.abs().sqrt() * self.slip_steps as f64;
        let first = if slip < 0.0 { 0 } else { self.side() };
        (first, Weights::at(place, self.side()))
    }
}

/// Smaller and greater loads are computed exactly, as shares of the robot's weight.
const MIN_LOAD_SHARE: f64 = 1e-4;
const MAX_LOAD_SHARE: f64 = 4.0;

/// The node at or before a place.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "not negative; the cast saturates"
)]
fn cell(place: f64) -> usize {
    place.max(0.0) as usize
}

/// The nearest nodes and their weights.
#[derive(Clone, Copy, Debug)]
struct Weights {
    first: usize,
    weights: [f64; POINTS],
}

impl Weights {
    /// At a place on `nodes` nodes; near the ends the outermost ones serve.
    fn at(place: f64, nodes: usize) -> Self {
        let first = cell(place).saturating_sub(POINTS / 2 - 1);
        Self::from(first.min(nodes.saturating_sub(POINTS)), place)
    }

    /// At a place, on the nodes from `first` on.
    fn from(first: usize, place: f64) -> Self {
        let x = place - first as f64;
        // Lagrange's polynomials on the nodes 0, 1, …
        let weights = std::array::from_fn(|own| {
            let others = (0..POINTS).filter(|other| *other != own);
            others
                .map(|other| (x - other as f64) / (own as f64 - other as f64))
                .product()
        });
        Self { first, weights }
    }

    const fn nodes(&self) -> Range<usize> {
        self.first..self.first + POINTS
    }
}

/// What a wheel takes at a node.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Drawbar pull over load.
    pull: f64,
    /// Torque over load, m.
    torque: f64,
    /// m.
    sinkage: f64,
}

impl Node {
    const fn all(value: f64) -> Self {
        Self {
            pull: value,
            torque: value,
            sinkage: value,
        }
    }

    fn add(&mut self, other: &Self, weight: f64) {
        self.pull += weight * other.pull;
        self.torque += weight * other.torque;
        self.sinkage += weight * other.sinkage;
    }
}

/// What is known of a node.
#[derive(Clone, Copy, Debug, Default)]
enum Known {
    #[default]
    Nothing,
    /// Nothing carries the load there.
    Sinks,
    Carries(Node),
}

/// The wheels of a robot on a soil.
pub(crate) struct WheelNodes<'a> {
    solver: &'a DemandSolver,
    loads: LoadsOnPlanes,
    /// Equal wheels are of one kind.
    kinds: Vec<Kind<'a>>,
    kind_of: Vec<usize>,
    spacing: NodeSpacing,
    min_load: f64,
    rows: usize,
}

/// Wheels of one size.
struct Kind<'a> {
    name: &'a str,
    contact: WheelOnSoil,
    /// Friction of the bearing of a free wheel, N m.
    bearing: Option<f64>,
    /// By load and slip, of a free wheel by load.
    nodes: RefCell<Vec<Known>>,
    /// The last skid of a free wheel.
    skid: Cell<Option<Slip>>,
}

impl<'a> WheelNodes<'a> {
    /// Without any node.
    pub(crate) fn new(solver: &'a DemandSolver, spacing: NodeSpacing) -> Self {
        let rows = (MAX_LOAD_SHARE / MIN_LOAD_SHARE).ln() / spacing.log_load_step;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few dozen"
        )]
        let rows = rows as usize + 1 + POINTS / 2;
        let mut kinds: Vec<Kind<'a>> = Vec::new();
        let mut kind_of = Vec::new();
        for (mount, contact) in solver.wheels() {
            let bearing = mount.motor.is_none().then_some(mount.bearing);
            let same = |kind: &Kind<'_>| {
                *kind.contact.wheel() == *contact.wheel() && kind.bearing == bearing
            };
            let known = kinds.iter().position(same);
            kind_of.push(known.unwrap_or(kinds.len()));
            if known.is_none() {
                let slips = if bearing.is_some() {
                    1
                } else {
                    spacing.slips()
                };
                kinds.push(Kind {
                    name: &mount.name,
                    contact: contact.with_accuracy(spacing.accuracy),
                    bearing,
                    nodes: RefCell::new(vec![Known::default(); rows * slips]),
                    skid: Cell::default(),
                });
            }
        }
        Self {
            min_load: MIN_LOAD_SHARE * solver.model().weight(),
            loads: LoadsOnPlanes::new(solver.model()),
            solver,
            kinds,
            kind_of,
            spacing,
            rows,
        }
    }

    /// How many nodes were computed.
    pub(crate) fn computed(&self) -> usize {
        let nodes = self.kinds.iter().map(|kind| kind.nodes.borrow());
        let is_known = |node: &&Known| !matches!(node, Known::Nothing);
        nodes
            .map(|nodes| nodes.iter().filter(is_known).count())
            .sum()
    }

    /// The robot on a plane; `None` where a wheel loses the ground.
    pub(crate) fn posed(&self, pitch: f64, roll: f64) -> Result<Option<Posed<'_>>> {
        let loads = self.loads.at(pitch, roll);
        if !loads.stands {
            return Ok(None);
        }
        let max_load = MAX_LOAD_SHARE / MIN_LOAD_SHARE * self.min_load;
        let limits = self.min_load..max_load;
        let mut powered = Vec::with_capacity(loads.loads.len());
        let (mut pull, mut free_sinkage) = (0.0, 0.0_f64);
        if !loads.loads.iter().all(|load| limits.contains(load)) {
            pull = f64::NAN;
        }
        for (kind, load) in self.kind_of.iter().zip(&loads.loads) {
            let kind = &self.kinds[*kind];
            let place = (load / self.min_load).ln() / self.spacing.log_load_step;
            let wheel = LoadedWheel {
                kind,
                load: *load,
                place,
                across: Weights::at(place, self.rows),
            };
            if kind.bearing.is_none() {
                powered.push(wheel);
            } else if pull.is_finite() {
                let node = self.at_node(&wheel, 0)?;
                pull += load * node.pull;
                free_sinkage = free_sinkage.max(node.sinkage);
            }
        }
        if !pull.is_finite() {
            let posed = self.solver.under(pitch, loads.loads, &mut Vec::new());
            return posed.map(Some);
        }
        let nodes = PosedOnNodes {
            all: self,
            powered,
            pulls: RefCell::new(vec![None; self.spacing.slips()]),
        };
        let free = (pull, free_sinkage);
        Ok(Some(Posed::on_nodes(
            self.solver,
            (pitch, loads.loads),
            free,
            nodes,
        )))
    }

    /// A wheel at a node of slip, interpolated over the load: −∞ where nothing carries the load, NaN where the exact
    /// laws must decide.
    fn at_node(&self, wheel: &LoadedWheel<'_>, slip: usize) -> Result<Node> {
        let below = cell(wheel.place);
        if self.node(wheel.kind, below, slip)?.is_none() {
            return Ok(Node::all(f64::NEG_INFINITY));
        }
        // a greater load may not be carried: then the nodes below it serve
        let mut last = below;
        while last < below + POINTS / 2 && self.node(wheel.kind, last + 1, slip)?.is_some() {
            last += 1;
        }
        if last == below {
            return Ok(Node::all(f64::NAN));
        }
        let first = (last + 1).saturating_sub(POINTS);
        let across = if first == wheel.across.first {
            wheel.across
        } else {
            Weights::from(first, wheel.place)
        };
        let mut sum = Node::all(0.0);
        for (row, weight) in across.nodes().zip(across.weights) {
            let node = self.node(wheel.kind, row, slip)?;
            sum.add(&node.unwrap_or(Node::all(f64::NAN)), weight);
        }
        Ok(sum)
    }

    /// A node, computed if it is not known; `None` where nothing carries the load.
    fn node(&self, kind: &Kind<'_>, row: usize, slip: usize) -> Result<Option<Node>> {
        let slips = if kind.bearing.is_some() {
            1
        } else {
            self.spacing.slips()
        };
        let place = row * slips + slip;
        match kind.nodes.borrow()[place] {
            Known::Nothing => {}
            Known::Sinks => return Ok(None),
            Known::Carries(node) => return Ok(Some(node)),
        }
        let load = self.min_load * (row as f64 * self.spacing.log_load_step).exp();
        let law = |source| of_wheel(kind.name, source);
        let slip = match kind.bearing {
            Some(bearing) => {
                let skid = match kind.skid.get() {
                    Some(near) => kind.contact.free_slip_near(load, bearing, near),
                    None => kind.contact.free_slip(load, bearing),
                };
                let skid = skid.map_err(law)?;
                kind.skid.set(skid);
                // a wheel that cannot turn is dragged, locked
                skid.map_or_else(|| Slip::new(-1.0), Ok)
            }
            None => Slip::new(self.spacing.slip(slip)),
        };
        let motion = Kinematics::straight(slip.map_err(law)?);
        let solved = kind.contact.under_load(load, &motion).map_err(law)?;
        let node = solved.point().map(|point| Node {
            pull: point.forces.drawbar_pull / load,
            torque: point.forces.torque / load,
            sinkage: point.sinkage,
        });
        kind.nodes.borrow_mut()[place] = node.map_or(Known::Sinks, Known::Carries);
        Ok(node)
    }
}

/// A wheel of a robot on a plane.
struct LoadedWheel<'a> {
    kind: &'a Kind<'a>,
    /// N.
    load: f64,
    /// Among the loads of the nodes.
    place: f64,
    across: Weights,
}

/// The powered wheels of a robot on a plane.
pub(crate) struct PosedOnNodes<'a> {
    all: &'a WheelNodes<'a>,
    powered: Vec<LoadedWheel<'a>>,
    /// Their pull at the slips of the nodes, N.
    pulls: RefCell<Vec<Option<f64>>>,
}

impl PosedOnNodes<'_> {
    /// The pull of all, N: −∞ where a wheel is not carried, NaN where the exact laws must decide.
    pub(crate) fn pull(&self, slip: f64) -> Result<f64> {
        let (side, along) = self.all.spacing.along(slip);
        let mut pulls = self.pulls.borrow_mut();
        let (mut sum, mut carried) = (0.0, 0);
        for (node, weight) in along.nodes().zip(along.weights) {
            let known = &mut pulls[side + node];
            let pull = match *known {
                Some(pull) => pull,
                None => *known.insert(self.pull_at(side + node)?),
            };
            sum += weight * pull;
            carried += usize::from(pull != f64::NEG_INFINITY);
        }
        Ok(match carried {
            0 => f64::NEG_INFINITY,
            POINTS => sum,
            _ => f64::NAN,
        })
    }

    fn pull_at(&self, slip: usize) -> Result<f64> {
        let mut sum = 0.0;
        for wheel in &self.powered {
            sum += wheel.load * self.all.at_node(wheel, slip)?.pull;
            if !sum.is_finite() {
                break;
            }
        }
        Ok(sum)
    }

    /// Work per metre, J/m, and maximum sinkage, m, of all wheels; not finite where the exact laws must decide.
    pub(crate) fn work_and_sinkage(&self, slip: f64) -> Result<(f64, f64)> {
        let (side, along) = self.all.spacing.along(slip);
        let q = if slip < 0.0 {
            1.0 / (1.0 + slip)
        } else {
            1.0 - slip
        };
        let (mut work, mut sinkage) = (0.0, 0.0_f64);
        for wheel in &self.powered {
            let mut sum = Node::all(0.0);
            for (node, weight) in along.nodes().zip(along.weights) {
                sum.add(&self.all.at_node(wheel, side + node)?, weight);
            }
            work += wheel.load * sum.torque / (q * wheel.kind.contact.wheel().radius());
            sinkage = sinkage.max(sum.sinkage);
        }
        Ok((work, sinkage))
    }
}
