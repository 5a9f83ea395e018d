//! A way as a scenario that `drive` follows.

use std::fmt::Write as _; // writing to a string cannot fail
use std::path::Path;

use grouser_report::number::exact;
use grouser_terrain::plan::{PlanMap, Route};

/// The drive may take this much longer than the plan.
const TIME_FACTOR: f64 = 3.0;

/// The files that a scenario names.
pub(super) struct Names<'a> {
    /// Where the scenario itself will lie.
    pub(super) beside: Option<&'a Path>,
    pub(super) dem: &'a Path,
    pub(super) robot: &'a Path,
    pub(super) soil: &'a str,
}

/// The scenario's text: one leg for each straight.
///
/// A scenario's ground has x = 0 in its first column and y = 0 in its middle row.
pub(super) fn toml(map: &PlanMap, route: &Route, names: &Names<'_>, speed: f64) -> String {
    let layout = &map.layout;
    let columns = layout.columns as usize;
    let place = |cell: usize| {
        let (row, column) = (cell / columns, cell % columns);
        let middle = 0.5 * f64::from(layout.rows - 1);
        [
            column as f64 * layout.cell,
            (middle - row as f64) * layout.cell,
        ]
    };
    let heading = |index: usize| layout.headings.angle(index).to_degrees();
    // the first leg's heading is the first one that moves
    let legs = straights(route);
    let start = route.waypoints.first().map_or(0, |point| point.cell);
    let first = legs.first().map_or(0, |(index, ..)| *index);
    let [x, y] = place(start);
    let mut out = format!(
        "# Written by `grouser plan`.\nformat = 1\ntitle = \"A planned way\"\nrobot = {}\ngravity_m_per_s2 = {}\nduration_s = {}\n\n\
         [start]\nx_m = {}\ny_m = {}\nheading_deg = {}\n\n\
         [ground]\nkind = \"file\"\nfile = {}\ncell_m = {}\nsoil = {}\n",
        quoted(&reachable(names.robot, names.beside)),
        exact(layout.gravity),
        exact((TIME_FACTOR * route.time).ceil().max(10.0)),
        exact(x),
        exact(y),
        exact(heading(first)),
        quoted(&reachable(names.dem, names.beside)),
        exact(layout.cell),
        quoted(names.soil),
    );
    for (index, from, to) in legs {
        let ([x_1, y_1], [x_2, y_2]) = (place(from), place(to));
        let _ = write!(
            out,
            "\n[[leg]]\nspeed_m_per_s = {}\nheading_deg = {}\ndistance_m = {}\n",
            exact(speed),
            exact(heading(index)),
            exact((x_2 - x_1).hypot(y_2 - y_1))
        );
    }
    out
}

/// Heading, first and last cell of each straight.
fn straights(route: &Route) -> Vec<(usize, usize, usize)> {
    let mut out: Vec<(usize, usize, usize)> = Vec::new();
    for pair in route.waypoints.windows(2) {
        let (from, to) = (&pair[0], &pair[1]);
        if from.cell == to.cell {
            continue;
        }
        match out.last_mut() {
            Some((heading, _, last)) if *heading == to.heading => *last = to.cell,
            _ => out.push((to.heading, from.cell, to.cell)),
        }
    }
    out
}

/// A file's name as a scenario in another folder reaches it.
fn reachable(file: &Path, beside: Option<&Path>) -> String {
    let absolute = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    let folder = beside.and_then(|folder| std::path::absolute(folder).ok());
    let near = folder
        .as_deref()
        .and_then(|folder| absolute.strip_prefix(folder).ok());
    near.unwrap_or(&absolute).display().to_string()
}

/// A TOML string.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => out.extend(['\\', letter]),
            letter if letter.is_control() => {
                let _ = write!(out, "\\u{:04x}", u32::from(letter));
            }
            letter => out.push(letter),
        }
    }
    out.push('"');
    out
}
