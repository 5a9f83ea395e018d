//! Ways over a slip map: the least energy within a bound on the risk to be immobilised.
//!
//! A way is a chain of cells and headings. It goes straight on by the step of its heading, or turns by one heading where the
//! straight before was long enough that the corner can be rounded on the robot's turning radius.

mod lattice;
mod plan_map;
mod route;
mod search;
mod sources;

pub use lattice::PlanSettings;
pub use plan_map::{PlanMap, read_map};
pub(crate) use route::check_place;
pub use route::{Plan, Route, Waypoint, plan, route_within};
