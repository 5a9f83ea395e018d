//! Maps of several soils against the exact solver, and ways whose risk comes from more than one soil.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use grouser_rover::robot::RobotModel;
use grouser_terra::catalogue;
use grouser_terrain::plan::{Plan, PlanMap, PlanSettings, plan};
use grouser_terrain::raster::Dem;
use grouser_terrain::{
    Band, Demand, DemandSolver, Envelope, Error, Headings, MapLayout, MapMaker, MapSettings,
    MapSoil, Quantity, SlipTable, SoilMap, SurfacePose,
};

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path =
            std::env::temp_dir().join(format!("grouser-soils-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, text).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// An ASCII grid whose lower left corner lies at (100, 50).
fn grid((columns, rows): (u32, u32), cell: f64, value: impl Fn(u32, u32) -> f64) -> String {
    let mut text = format!(
        "ncols {columns}\nnrows {rows}\nxllcorner 100\nyllcorner 50\ncellsize {cell}\nNODATA_value -9999\n"
    );
    for row in 0..rows {
        for column in 0..columns {
            let _ = write!(text, "{} ", value(row, column));
        }
        text.push('\n');
    }
    text
}

const LEGEND: &str = "format = 1\nraster = \"soils.asc\"\n\
    [[soil]]\nclass = 7\nname = \"loam\"\nsoil = \"sandy-loam\"\n\
    [[soil]]\nclass = 9\nname = \"drift\"\nsoil = \"snow\"\n";

fn robot() -> RobotModel {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/robots/rocker-bogie.toml"
    );
    RobotModel::read(file.as_ref()).unwrap()
}

fn solver(key: &str) -> DemandSolver {
    let soil = catalogue::find(key).unwrap().soil().unwrap();
    DemandSolver::new(robot(), soil).unwrap()
}

#[test]
fn every_cell_has_the_exact_demand_of_its_own_soil() {
    let folder = Folder::new("exact");
    // cells of 0.5 m, up to the east; soils in columns of 5 m, the first one unlisted
    let rise = 0.1;
    let heights = grid((30, 8), 0.5, |_, column| rise * 0.5 * f64::from(column));
    let dem_file = folder.write("dem.asc", &heights);
    let classes = [-9999.0, 7.0, 9.0];
    folder.write("soils.asc", &grid((3, 2), 5.0, |_, c| classes[c as usize]));
    let legend = folder.write("soils.toml", LEGEND);
    let map = SoilMap::read(&legend).unwrap();
    let mut dem = Dem::open(&dem_file, None, 0.001).unwrap();
    map.check_overlap(&legend, dem.georeference(), dem.size())
        .unwrap();
    let headings = Headings::new(8).unwrap();
    let solvers = ["dry-sand", "sandy-loam", "snow"].map(solver);
    let envelope = Envelope::within(solvers[0].model(), 0.3, 0.3).unwrap();
    let table = |solver: &DemandSolver| {
        let table = SlipTable::new_or_closed(solver, envelope).unwrap();
        (solver.clone(), table)
    };
    let [sand, loam, snow] = [0, 1, 2].map(|index: usize| table(&solvers[index]));
    let settings = MapSettings::new(headings, envelope);
    let others = vec![
        MapSoil::new(loam, Vec::new()),
        MapSoil::new(snow, Vec::new()),
    ];
    let maker = MapMaker::new(settings, sand, Vec::new(), 0.5)
        .with_soil_map(map, others, dem.georeference().clone())
        .unwrap();
    let cells = maker.rows(&dem.window(0..8).unwrap(), 4..5).unwrap();
    let bands = Band::count(headings);
    // far from a border all wheels stand on the soil of the cell; loam is the weakest, and wins at its border
    for (column, soil) in [(4, 0), (14, 1), (19, 1), (25, 2)] {
        for heading in [0, 1, 4] {
            let value = |quantity| {
                f64::from(cells[column * bands + Band { quantity, heading }.index(headings)])
            };
            let (sin, cos) = headings.angle(heading).sin_cos();
            let pose = SurfacePose::on_plane(rise * cos, -rise * sin);
            let exact = solvers[soil].demand(pose.pitch, pose.roll).unwrap();
            assert_eq!(value(Quantity::Soil), soil as f64, "column {column}");
            match exact {
                Demand::Drives(driving) => {
                    assert!((value(Quantity::Slip) - driving.slip).abs() < 1e-3);
                    let energy = driving.energy_per_metre();
                    assert!((value(Quantity::Energy) - energy).abs() < 0.01 * energy.max(1.0));
                }
                _ => assert_eq!(value(Quantity::Immobilisation), 1.0),
            }
        }
    }
}

#[test]
fn a_legend_with_a_fault_is_refused_by_its_name() {
    let folder = Folder::new("refused");
    let read = |legend: &str, raster: &str| {
        folder.write("soils.asc", raster);
        SoilMap::read(Path::new(&folder.write("soils.toml", legend))).unwrap_err()
    };
    let raster = |class: f64| grid((3, 2), 5.0, |_, _| class);
    let unlisted = read(LEGEND, &raster(8.0));
    assert!(matches!(unlisted, Error::NoClass { value, row: 0, column: 0, .. } if value == 8.0));
    let twice = read(&LEGEND.replace("class = 9", "class = 7"), &raster(7.0));
    assert!(matches!(twice, Error::TwoSoils { class: 7, .. }));
    let unknown = read(&LEGEND.replace("sandy-loam", "sandy-loan"), &raster(7.0)).to_string();
    assert!(unknown.contains("did you mean `sandy-loam`"), "{unknown}");
    for wrong in ["class = -1", "class = 1.5", "class = 70000"] {
        let error = read(&LEGEND.replace("class = 9", wrong), &raster(7.0));
        assert!(matches!(error, Error::OwnFile(_)), "{error}");
    }
    let far = folder.write(
        "dem.asc",
        &grid((3, 3), 1.0, |_, _| 0.0).replace("100", "900"),
    );
    folder.write("soils.asc", &raster(7.0));
    let map = SoilMap::read(&folder.write("soils.toml", LEGEND)).unwrap();
    let dem = Dem::open(&far, None, 0.001).unwrap();
    let overlap = map.check_overlap(&far, dem.georeference(), dem.size());
    assert!(matches!(overlap, Err(Error::NotAMap { .. })));
}

/// A corridor of seven level cells: two soils, each with a risk of 0.04 in one cell.
fn corridor(rows: u32) -> PlanMap {
    let layout = MapLayout::plain(7, rows, 1.0, Headings::new(4).unwrap());
    let mut map = PlanMap::unknown(layout);
    map.energy.fill(10.0);
    for band in [
        &mut map.slip,
        &mut map.slip_high,
        &mut map.risk,
        &mut map.pitch,
    ] {
        band.fill(0.0);
    }
    map.tip_over.fill(40.0);
    for (cell, soil) in [(2, 1), (3, 1), (4, 2)] {
        for heading in 0..4 {
            map.risk[cell * 4 + heading] = 0.04;
            map.soil[cell * 4 + heading] = soil;
        }
    }
    map
}

#[test]
fn risks_of_soils_that_are_unknown_by_themselves_add_up() {
    let at = |max_risk| PlanSettings {
        max_risk,
        ..PlanSettings::default()
    };
    let Plan::Found { route, .. } = plan(&corridor(1), (0, 6), &at(0.1), 0).unwrap() else {
        panic!("0.08 is within 0.1")
    };
    // twice the first soil, once the second
    assert!((route.risk - 0.08).abs() < 1e-7, "{}", route.risk);
    let Plan::NoWay { least_risk } = plan(&corridor(1), (0, 6), &at(0.05), 0).unwrap() else {
        panic!("each soil keeps 0.05, both together do not")
    };
    assert!((least_risk.unwrap() - 0.08).abs() < 1e-7);
    // with a second row there is a way round
    let Plan::Found { route, .. } = plan(&corridor(2), (0, 6), &at(0.05), 0).unwrap() else {
        panic!("the second row has no risk")
    };
    assert!(route.risk <= 0.05 && route.length > 6.0);
}
