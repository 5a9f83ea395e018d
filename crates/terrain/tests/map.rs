//! Maps of relief whose answer is known: an inclined plane against the exact solver, unknown ground, and the file itself.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Cursor;
use std::path::{Path, PathBuf};

use grouser_files::Document;
use grouser_rover::ground::{GeoTiff, TerrainFault};
use grouser_rover::robot::RobotModel;
use grouser_rover::statics::stability_margins;
use grouser_terra::{Soil, catalogue};
use grouser_terrain::plan::PlanMap;
use grouser_terrain::raster::Dem;
use grouser_terrain::{
    Band, Demand, DemandSolver, Envelope, Error, Headings, Journal, MapLayout, MapMaker,
    MapSettings, Quantity, SlipTable, SoilIntervals, State, Strip, SurfacePose, write_map,
};

const JOB: &str = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path =
            std::env::temp_dir().join(format!("grouser-terrain-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn rocker() -> RobotModel {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/robots/rocker-bogie.toml"
    );
    RobotModel::read(file.as_ref()).unwrap()
}

fn soil() -> Soil {
    catalogue::find("dry-sand").unwrap().soil().unwrap()
}

fn grid(path: &Path, columns: u32, rows: u32, height: impl Fn(f64, f64) -> f64) {
    let mut text = format!(
        "ncols {columns}\nnrows {rows}\nxllcorner 100\nyllcorner 50\ncellsize 0.5\nNODATA_value -9999\n"
    );
    for row in 0..rows {
        for column in 0..columns {
            let (x, y) = (0.5 * f64::from(column), 0.5 * f64::from(rows - row));
            let _ = write!(text, "{} ", height(x, y));
        }
        text.push('\n');
    }
    fs::write(path, text).unwrap();
}

struct Made {
    maker: MapMaker,
    layout: MapLayout,
    solver: DemandSolver,
}

fn made(dem: &Dem, headings: u8) -> Made {
    let headings = Headings::new(headings).unwrap();
    let solver = DemandSolver::new(rocker(), soil()).unwrap();
    let envelope = Envelope::within(solver.model(), 0.45, 0.35).unwrap();
    let table = SlipTable::new(&solver, envelope).unwrap();
    let layout = MapLayout::new(dem, solver.model(), headings, 0, JOB);
    let maker = MapMaker::new(
        MapSettings::new(headings, envelope),
        (solver.clone(), table),
        Vec::new(),
        dem.cell(),
    );
    Made {
        maker,
        layout,
        solver,
    }
}

impl Made {
    fn strip(&self, dem: &mut Dem, index: u32) -> Strip {
        let rows = self.layout.rows_of(index);
        let reach = self.maker.reach() + 1;
        let window = dem
            .window(rows.start.saturating_sub(reach)..rows.end + reach)
            .unwrap();
        let cells = self.maker.rows(&window, rows).unwrap();
        Strip::pack(&self.layout, index, &cells)
    }
}

#[test]
fn every_cell_of_an_inclined_plane_has_the_exact_demand_of_its_headings() {
    let folder = Folder::new("plane");
    let path = folder.file("plane.asc");
    // up to the east, a little down to the north
    grid(&path, 12, 10, |x, y| 3.0 + 0.16 * x - 0.06 * y);
    let mut dem = Dem::open(&path, None, 0.001).unwrap();
    let made = made(&dem, 16);
    let cells = made.strip(&mut dem, 0).unpack(&made.layout).unwrap();
    let headings = made.layout.headings;
    let middle = &cells[(5 * 12 + 6) * made.layout.bands()..][..made.layout.bands()];
    for heading in 0..headings.count() {
        let (sin, cos) = headings.angle(heading).sin_cos();
        let pose = SurfacePose::on_plane(0.16 * cos - 0.06 * sin, -0.16 * sin - 0.06 * cos);
        let Demand::Drives(exact) = made.solver.demand(pose.pitch, pose.roll).unwrap() else {
            panic!("it drives");
        };
        let value = |quantity| f64::from(middle[Band { quantity, heading }.index(headings)]);
        assert!(
            (value(Quantity::Slip) - exact.slip).abs() < 1e-3,
            "{heading}"
        );
        assert!((value(Quantity::Pitch) - pose.pitch.to_degrees()).abs() < 1e-3);
        let energy = exact.energy_per_metre();
        assert!(
            (value(Quantity::Energy) - energy).abs() <= 0.01 * energy.max(1.0),
            "{heading}"
        );
        assert!((value(Quantity::Sinkage) - exact.sinkage).abs() < 2e-4);
        assert_eq!(value(Quantity::State), 0.0);
        let margins = stability_margins(made.solver.model(), pose.pitch, pose.roll);
        let off = value(Quantity::TipOver) - margins.tip_over.to_degrees();
        assert!(off.abs() < 0.03, "{heading}: {off}");
    }
    assert!(made.maker.tip_over_error().to_degrees() < 0.03);
    // at the edge a wheel stands beyond the model: nothing is known there
    assert!(
        cells[..made.layout.bands()]
            .iter()
            .all(|value| value.is_nan())
    );
}

#[test]
fn unknown_ground_stays_unknown_and_zero_is_a_height() {
    let folder = Folder::new("unknown");
    let path = folder.file("holes.asc");
    // level ground at height 0 with one unknown cell: were it 0, or -9999, something would be known of it
    grid(&path, 13, 13, |x, y| {
        if (x - 3.0).abs() < 0.1 && (y - 3.0).abs() < 0.1 {
            -9999.0
        } else {
            0.0
        }
    });
    let mut dem = Dem::open(&path, None, 0.001).unwrap();
    let made = made(&dem, 8);
    let cells = made.strip(&mut dem, 0).unpack(&made.layout).unwrap();
    let bands = made.layout.bands();
    let (mut unknown, mut level) = (0, 0);
    for cell in cells.chunks_exact(bands) {
        if cell.iter().all(|value| value.is_nan()) {
            unknown += 1;
        }
        let pitch = cell[Band {
            quantity: Quantity::Pitch,
            heading: 0,
        }
        .index(made.layout.headings)];
        assert!(pitch.is_nan() || pitch == 0.0, "{pitch}");
        level += i32::from(pitch == 0.0);
    }
    assert!(
        unknown > 13 && level > 60,
        "{unknown} unknown, {level} level"
    );
}

#[test]
fn a_map_is_read_back_and_an_interrupted_one_has_the_same_bytes() {
    let folder = Folder::new("resumed");
    let path = folder.file("waves.asc");
    grid(&path, 40, 900, |x, y| {
        0.2 * (x / 2.0).sin() + 0.3 * (y / 3.0).cos()
    });
    let mut dem = Dem::open(&path, None, 0.001).unwrap();
    let made = made(&dem, 8);
    assert!(made.layout.strips() > 10);
    let whole = folder.file("whole.strips");
    let mut journal = Journal::open(&whole, JOB).unwrap();
    for index in 0..made.layout.strips() {
        journal.add(&made.strip(&mut dem, index)).unwrap();
    }
    let write = |journals: &mut [Journal]| {
        let mut bytes = Cursor::new(Vec::new());
        write_map(
            &mut bytes,
            "map.tif".as_ref(),
            &made.layout,
            journals,
            |_, _| (),
        )?;
        Ok::<_, Error>(bytes.into_inner())
    };
    let expected = write(&mut [journal]).unwrap();

    // killed in the middle of a record, and gone on
    let journal_bytes = fs::read(&whole).unwrap();
    for cut in [
        10,
        71,
        72,
        80,
        4000,
        journal_bytes.len() / 2,
        journal_bytes.len() - 1,
    ] {
        let killed = folder.file("killed.strips");
        fs::write(&killed, &journal_bytes[..cut]).unwrap();
        let mut journal = Journal::open(&killed, JOB).unwrap();
        let open: Vec<u32> = (0..made.layout.strips())
            .filter(|strip| !journal.holds(*strip))
            .collect();
        assert!(!open.is_empty());
        for index in open {
            journal.add(&made.strip(&mut dem, index)).unwrap();
        }
        assert!(write(&mut [journal]).unwrap() == expected, "cut at {cut}");
    }
    // a turned byte in a record: that strip and those after it are computed again
    let mut turned = journal_bytes.clone();
    turned[journal_bytes.len() / 2] ^= 0x40;
    let path = folder.file("turned.strips");
    fs::write(&path, &turned).unwrap();
    let journal = Journal::open(&path, JOB).unwrap();
    assert!((0..made.layout.strips()).any(|strip| !journal.holds(strip)));
    // another job's journal is begun anew, and refused as a shard
    let other = JOB.replace('0', "f");
    assert!(Journal::of_shard(&whole, &other).is_err());
    // two shards are the whole, one is not
    let shard = |first: u32| {
        let path = folder.file(&format!("shard-{first}"));
        let mut journal = Journal::open(&path, JOB).unwrap();
        for index in (first..made.layout.strips()).step_by(2) {
            journal
                .add(&made.strip(
                    &mut Dem::open(&folder.file("waves.asc"), None, 0.001).unwrap(),
                    index,
                ))
                .unwrap();
        }
        journal
    };
    assert!(write(&mut [shard(1), shard(0)]).unwrap() == expected);
    assert!(matches!(write(&mut [shard(1)]), Err(Error::NotAMap { .. })));

    let file = folder.file("map.tif");
    fs::write(&file, &expected).unwrap();
    let map = PlanMap::read(&file).unwrap();
    assert_eq!(map.layout, made.layout);
    let cells = made.strip(&mut dem, 3).unpack(&made.layout).unwrap();
    let first = made.layout.rows_of(3).start as usize * 40;
    for (index, cell) in cells.chunks_exact(made.layout.bands()).enumerate() {
        for heading in 0..8 {
            let value = |quantity| cell[Band { quantity, heading }.index(made.layout.headings)];
            let pose = (first + index) * 8 + heading;
            for (read, written) in [
                (map.energy[pose], value(Quantity::Energy)),
                (map.energy_cvar[pose], value(Quantity::EnergyCvar)),
                (map.slip[pose], value(Quantity::Slip)),
                (map.slip_high[pose], value(Quantity::SlipHigh)),
                (map.risk[pose], value(Quantity::Immobilisation)),
                (map.pitch[pose], value(Quantity::Pitch)),
                (map.tip_over[pose], value(Quantity::TipOver)),
            ] {
                assert_eq!(read.to_bits(), written.to_bits());
            }
        }
    }
    // the lower left cell's outer corner is (100, 50)
    assert_eq!(map.place_of(899 * 40), (100.25, 50.25));
}

#[test]
fn damaged_maps_are_errors_and_never_panics() {
    let folder = Folder::new("damaged");
    let path = folder.file("small.asc");
    grid(&path, 8, 8, |x, _| 0.1 * x);
    let mut dem = Dem::open(&path, None, 0.001).unwrap();
    let made = made(&dem, 4);
    let mut journal = Journal::open(&folder.file("j"), JOB).unwrap();
    journal.add(&made.strip(&mut dem, 0)).unwrap();
    let mut bytes = Cursor::new(Vec::new());
    write_map(
        &mut bytes,
        "map.tif".as_ref(),
        &made.layout,
        &mut [journal],
        |_, _| (),
    )
    .unwrap();
    let bytes = bytes.into_inner();
    let file = folder.file("damaged.tif");
    fs::write(&file, &bytes).unwrap();
    PlanMap::read(&file).unwrap();
    let mut maps = 0;
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0xff;
        fs::write(&file, &damaged).unwrap();
        maps += u32::from(PlanMap::read(&file).is_ok());
        if at % 7 == 0 {
            fs::write(&file, &bytes[..at]).unwrap();
            assert!(PlanMap::read(&file).is_err(), "cut at {at}");
        }
    }
    // names and unused tags may change
    assert!(maps < u32::try_from(bytes.len()).unwrap());
    // a map is no elevation model
    fs::write(&file, &bytes).unwrap();
    assert!(matches!(
        Dem::open(&file, None, 0.001),
        Err(Error::Terrain { .. })
    ));
}

#[test]
fn degrees_are_refused_with_a_hint() {
    let folder = Folder::new("degrees");
    let path = folder.file("arc.asc");
    fs::write(
        &path,
        "ncols 2\nnrows 2\nxllcorner 11.5\nyllcorner 48.1\ncellsize 0.000277777778\n1 2\n3 4\n",
    )
    .unwrap();
    let Err(error) = Dem::open(&path, None, 0.001) else {
        panic!("degrees were taken for metres");
    };
    let text = error.to_string();
    assert!(text.contains("degrees"), "{text}");
}

#[test]
fn mars_keeps_its_place_and_its_relief() {
    let Some(path) = std::env::var_os("GROUSER_DATA")
        .map(|folder| PathBuf::from(folder).join("mars-dem/missionDEM.tif"))
        .filter(|path| path.exists())
    else {
        assert!(
            std::env::var_os("CI").is_none(),
            "the measured data are missing"
        );
        eprintln!("skipped: no mars-dem/missionDEM.tif in GROUSER_DATA");
        return;
    };
    let mut dem = Dem::open(&path, None, 0.001).unwrap();
    assert_eq!((dem.size(), dem.cell()), ((348, 337), 1.0));
    assert!(dem.cautions().is_empty());
    let made = made(&dem, 8);
    let cells = made.strip(&mut dem, 2).unpack(&made.layout).unwrap();
    // the strip again, but by the rows read from the file as a whole and the exact solver at every hundredth pose
    let whole = grouser_rover::ground::read_raster(&grouser_rover::ground::HeightFile {
        path: path.clone(),
        cell: None,
        height_step: 0.001,
    })
    .unwrap();
    let rows = made.layout.rows_of(2);
    let (mut compared, mut worst) = (0, 0.0_f64);
    for (index, cell) in cells
        .chunks_exact(made.layout.bands())
        .enumerate()
        .step_by(101)
    {
        let (row, column) = (rows.start as usize + index / 348, index % 348);
        let at = |down: i64, right: i64| {
            let index = i64::try_from(row * 348 + column).unwrap() + 348 * down + right;
            f64::from(whole.heights[usize::try_from(index).unwrap()])
        };
        if column == 0 || column == 347 {
            continue;
        }
        for heading in [0, 2, 5] {
            let value =
                |quantity| f64::from(cell[Band { quantity, heading }.index(made.layout.headings)]);
            // the wheels of this robot stand within half a metre of the middle: the slope between neighbours, along x
            if heading == 0 {
                let slope = 0.5 * (at(0, 1) - at(0, -1));
                let pitch = value(Quantity::Pitch).to_radians().tan();
                assert!(
                    (pitch - slope).abs()
                        < 0.35 * (at(0, 1) - 2.0 * at(0, 0) + at(0, -1)).abs() + 0.05
                );
            }
            if State::from_code(
                cell[Band {
                    quantity: Quantity::State,
                    heading,
                }
                .index(made.layout.headings)],
            ) == Some(State::Drives)
            {
                compared += 1;
                let slip = value(Quantity::Slip);
                assert!((-0.9..=0.9).contains(&slip));
                worst = worst.max(slip.abs());
            }
        }
    }
    assert!(compared > 100 && worst > 0.05, "{compared}, {worst}");
    let tiff = GeoTiff::open(std::io::BufReader::new(File::open(&path).unwrap())).unwrap();
    assert_eq!(&made.layout.georeference, tiff.georeference());
    assert!(matches!(
        GeoTiff::open(Cursor::new(vec![0; 100])),
        Err(TerrainFault::Damaged { .. })
    ));
}

/// On draws of a soil: the mean of the worst part of their exact energies, by the definition that sorts
/// nothing.
#[test]
fn the_cvar_of_a_cell_is_that_of_the_exact_solver_on_every_draw() {
    const CVAR_LEVEL: f64 = 0.7;
    let folder = Folder::new("cvar");
    let headings = Headings::new(4).unwrap();
    let text = "format = 1\nsource = \"made up\"\nphi_deg = { low = 24.0, high = 34.0 }\n";
    let intervals = Document::from_text("intervals.toml", text.into()).unwrap();
    let drawn = SoilIntervals::parse(&intervals)
        .unwrap()
        .draw(&soil(), 9, 5)
        .unwrap();
    let solver_of = |soil: &Soil| DemandSolver::new(rocker(), *soil).unwrap();
    let own = solver_of(&soil());
    let envelope = Envelope::within(own.model(), 0.45, 0.35).unwrap();
    let tabled = |solver: DemandSolver| {
        let table = SlipTable::new(&solver, envelope).unwrap();
        (solver, table)
    };
    let draws: Vec<_> = drawn.iter().map(|soil| tabled(solver_of(soil))).collect();
    let weakest = |draws: &[(DemandSolver, SlipTable)]| {
        let slopes = draws.iter().map(|(_, table)| table.steepest());
        slopes.fold(f64::INFINITY, f64::min)
    };
    let limit = weakest(&draws);
    // well within all draws; and where the weakest one fails
    for (slope, fails) in [(0.5 * limit.tan(), false), (1.02 * limit.tan(), true)] {
        let path = folder.file("plane.asc");
        grid(&path, 12, 10, |x, _| 3.0 + slope * x);
        let mut dem = Dem::open(&path, None, 0.001).unwrap();
        let settings = MapSettings::new(headings, envelope)
            .with_cvar_level(CVAR_LEVEL)
            .unwrap();
        let maker = MapMaker::new(settings, tabled(own.clone()), draws.clone(), dem.cell());
        let window = dem.window(0..10).unwrap();
        let cells = maker.rows(&window, 0..10).unwrap();
        let bands = Band::count(headings);
        let middle = &cells[(5 * 12 + 6) * bands..][..bands];
        let value = |quantity| {
            let uphill = Band {
                quantity,
                heading: 0,
            };
            f64::from(middle[uphill.index(headings)])
        };
        let pose = SurfacePose::on_plane(slope, 0.0);
        let exact: Vec<Option<f64>> = draws
            .iter()
            .map(
                |(solver, _)| match solver.demand(pose.pitch, pose.roll).unwrap() {
                    Demand::Drives(driving) => Some(driving.energy_per_metre()),
                    _ => None,
                },
            )
            .collect();
        let driving: Vec<f64> = exact.iter().copied().flatten().collect();
        assert_eq!(driving.len() < draws.len(), fails);
        assert_eq!(value(Quantity::Immobilisation) > 0.0, fails);
        let over = |t: f64| driving.iter().map(|e| (e - t).max(0.0)).sum::<f64>();
        let at = |t: f64| t + over(t) / draws.len() as f64 / (1.0 - CVAR_LEVEL);
        let expected = driving.iter().map(|t| at(*t)).fold(f64::INFINITY, f64::min);
        let found = value(Quantity::EnergyCvar);
        if fails {
            // a draw that does not drive counts with more than any that does
            assert!(
                found > 1.1 * expected && found.is_finite(),
                "{found} {expected}"
            );
        } else {
            assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
            assert!(found > 1.01 * value(Quantity::Energy));
        }
    }
}
