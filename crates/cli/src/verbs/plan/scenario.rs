//! A way as a scenario that `drive` follows.

use std::path::{Path, PathBuf};

use grouser_files::soil::names_file;
use grouser_rover::drive::{
    GroundShape, GroundSpec, Leg, Scenario, SoilChanges, SoilOrigin, SoilSpec, to_toml,
};
use grouser_rover::ground::HeightFile;
use grouser_rover::robot::RobotModel;
use grouser_terrain::plan::{PlanMap, Route};
use grouser_terrain::raster::Dem;

use crate::output::OutputFile;

/// The drive may take this much longer than the plan.
const TIME_FACTOR: f64 = 3.0;

/// What a scenario takes besides the way.
pub(super) struct Names<'a> {
    pub(super) dem: &'a Path,
    pub(super) robot: &'a Path,
    /// A key of the catalogue or a soil file, as `--soil` takes it elsewhere.
    pub(super) soil: &'a str,
}

/// Refuses what the map was not made for: its way would lie on another relief.
pub(super) fn check(map: &PlanMap, names: &Names<'_>) -> grouser_terrain::Result<()> {
    let cell = Some(map.layout.cell);
    let height_step = HeightFile::new(names.dem.to_owned(), cell).height_step;
    let mut dem = Dem::open(names.dem, cell, height_step)?;
    let model = RobotModel::read(names.robot)?.under_gravity(map.layout.gravity);
    let soil = soil(names.soil, Path::to_owned)?.soil;
    map.check_sources(&mut dem, &model, (names.soil, &soil))
}

/// The scenario's text, as `file` will hold it: one leg for each straight.
///
/// A scenario's ground has x = 0 in its first column and y = 0 in its middle row.
pub(super) fn toml(
    map: &PlanMap,
    route: &Route,
    names: &Names<'_>,
    speed: f64,
    file: &OutputFile,
) -> grouser_rover::Result<String> {
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
    let reachable = |name: &Path| file.reaches(name);
    let shape = GroundShape::File(HeightFile::new(reachable(names.dem), Some(layout.cell)));
    let ground = GroundSpec::new(shape, soil(names.soil, reachable)?);
    let robot = RobotModel::read(names.robot)?.under_gravity(layout.gravity);
    let duration = (TIME_FACTOR * route.time).ceil().max(10.0);
    let robot = (reachable(names.robot), robot);
    let mut scenario = Scenario::new("A planned route", robot, ground, duration);
    let legs = straights(route);
    // the first leg's heading is the first one that moves
    let first = legs.first().map_or(0, |(index, ..)| *index);
    let [x, y] = place(route.waypoints.first().map_or(0, |point| point.cell));
    scenario.start = (x, y, layout.headings.angle(first));
    scenario.legs = legs
        .into_iter()
        .map(|(index, from, to)| {
            let ([x_1, y_1], [x_2, y_2]) = (place(from), place(to));
            Leg::over(
                speed,
                layout.headings.angle(index),
                (x_2 - x_1).hypot(y_2 - y_1),
            )
        })
        .collect();
    Ok(to_toml(&scenario, &["Written by `grouser plan`."]))
}

/// The soil, from the catalogue or from a file.
fn soil(name: &str, reachable: impl Fn(&Path) -> PathBuf) -> grouser_rover::Result<SoilSpec> {
    if !names_file(name.as_ref()) {
        let origin = SoilOrigin::Catalogue(name.to_owned());
        return SoilSpec::new(name, origin, SoilChanges::default());
    }
    let file = Path::new(name);
    let origin = SoilOrigin::File(file.to_owned());
    let mut spec = SoilSpec::new("soil", origin, SoilChanges::default())?;
    spec.origin = SoilOrigin::File(reachable(file));
    Ok(spec)
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
