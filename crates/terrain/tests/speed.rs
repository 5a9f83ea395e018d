//! How long a large map takes, on two threads, beside the exact solver in the same run:
//! `cargo test --release -p grouser-terrain --test speed -- --ignored --nocapture`.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(
    clippy::too_many_lines,
    reason = "one job from its terrain to its file"
)]
#![allow(clippy::print_stderr, reason = "the figures that RESULTS.md quotes")]

use std::fmt::Write as _;
use std::fs;
use std::hint::black_box;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::time::Instant;

use grouser_files::Document;
use grouser_rover::drive::read_scenario;
use grouser_rover::ground::{Noise, Shape};
use grouser_rover::robot::RobotModel;
use grouser_terra::catalogue;
use grouser_terrain::mission::drive;
use grouser_terrain::raster::Dem;
use grouser_terrain::{
    Demand, DemandSolver, Envelope, Headings, Journal, MapLayout, MapMaker, MapSettings, SlipTable,
    SoilIntervals, Strip, write_map,
};

const HEADINGS: u8 = 8;
const THREADS: usize = 2;
/// Poses that the exact solver answers, of each soil.
const EXACT: u32 = 40;

fn peak_mebibytes() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:"));
    let kibibytes = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<f64>().ok());
    kibibytes.map_or(f64::NAN, |kibibytes| kibibytes / 1024.0)
}

/// Processor time of all threads so far, s: wall time says little on a machine that others use.
fn processor_seconds() -> f64 {
    const TICKS_PER_SECOND: f64 = 100.0;
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // user and system time are the 14th and 15th words; the second one is a name in brackets
    let words: Vec<&str> = stat
        .rsplit(')')
        .next()
        .unwrap_or_default()
        .split_whitespace()
        .collect();
    let ticks = |index: usize| {
        words
            .get(index)
            .and_then(|word| word.parse::<f64>().ok())
            .unwrap_or(f64::NAN)
    };
    (ticks(11) + ticks(12)) / TICKS_PER_SECOND
}

/// A smaller job: `GROUSER_MAP_SIDE=300 GROUSER_MAP_DRAWS=8`.
fn size(name: &str, default: u32) -> u32 {
    let given = std::env::var(name).ok();
    given.and_then(|word| word.parse().ok()).unwrap_or(default)
}

/// Processor time of the first step of planned drives, the mean of ten:
/// `cargo test -p grouser-terrain --test speed first_step -- --ignored --nocapture`.
#[test]
#[ignore = "figures that RESULTS.md quotes"]
fn first_step_of_planned_drives() {
    const RUNS: u32 = 10;
    for name in ["plan-and-learn", "lunar-craters"] {
        let file = format!(
            "{}/../../examples/scenarios/{name}.toml",
            env!("CARGO_MANIFEST_DIR")
        );
        let began = processor_seconds();
        for _ in 0..RUNS {
            let scenario = read_scenario(file.as_ref()).unwrap();
            let optimum = scenario.slip_setpoint().unwrap();
            black_box(drive(&scenario, optimum, scenario.seed, |_| false).unwrap());
        }
        let each = (processor_seconds() - began) / f64::from(RUNS);
        eprintln!("{name}: {:.0} ms", 1e3 * each);
    }
}

#[test]
#[ignore = "a minute in release; `just terrain` runs it"]
fn a_million_cells_with_64_soils() {
    let side = size("GROUSER_MAP_SIDE", 1000);
    let draw_count = size("GROUSER_MAP_DRAWS", 64) as usize;
    let folder = std::env::temp_dir().join(format!("grouser-speed-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("fractal.asc");
    let shape = Shape::Fractal {
        height: 12.0,
        length: 120.0,
        roughness: 0.45,
    };
    {
        let mut text =
            format!("ncols {side}\nnrows {side}\nxllcorner 0\nyllcorner 0\ncellsize 1\n");
        for row in 0..side {
            for column in 0..side {
                let _ = write!(
                    text,
                    "{:.3} ",
                    shape.height(5, f64::from(column), f64::from(row))
                );
            }
            text.push('\n');
        }
        fs::write(&path, text).unwrap();
    }
    for robot in ["rocker-bogie"] {
        let file = format!(
            "{}/../../examples/robots/{robot}.toml",
            env!("CARGO_MANIFEST_DIR")
        );
        let model = RobotModel::read(file.as_ref()).unwrap();
        let soil = catalogue::find("dry-sand").unwrap().soil().unwrap();
        let intervals = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../examples/terrain/dry-sand-intervals.toml"
        );
        let intervals = SoilIntervals::parse(&Document::read(intervals.as_ref()).unwrap()).unwrap();
        let drawn = intervals.draw(&soil, draw_count, 1).unwrap();
        let envelope = Envelope::within(&model, 0.52, 0.43).unwrap();

        let (began, cpu) = (Instant::now(), processor_seconds());
        let soils: Vec<_> = std::iter::once(soil).chain(drawn).collect();
        let next = AtomicUsize::new(0);
        let tables = Mutex::new(Vec::new());
        std::thread::scope(|scope| {
            for _ in 0..THREADS {
                scope.spawn(|| {
                    loop {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        let Some(soil) = soils.get(index) else { break };
                        let solver = DemandSolver::new(model.clone(), *soil).unwrap();
                        let table = SlipTable::new(&solver, envelope).unwrap();
                        tables.lock().unwrap().push((index, (solver, table)));
                    }
                });
            }
        });
        let mut tables = tables.into_inner().unwrap();
        tables.sort_by_key(|(index, _)| *index);
        let mut tables: Vec<_> = tables.into_iter().map(|(_, table)| table).collect();
        let built = began.elapsed().as_secs_f64();
        let cpu_built = processor_seconds() - cpu;
        eprintln!("tables: {built:.1} s, {cpu_built:.1} s of processor time");
        let draws = tables.split_off(1);
        let solvers: Vec<DemandSolver> = draws.iter().map(|(solver, _)| solver.clone()).collect();

        let headings = Headings::new(HEADINGS).unwrap();
        let mut dem = Dem::open(&path, None, 0.001).unwrap();
        let job = "0".repeat(64);
        let layout = MapLayout::new(&dem, &model, headings, draw_count, &job);
        let own = tables.remove(0);
        let maker = MapMaker::new(MapSettings::new(headings, envelope), own, draws, dem.cell());
        let mut journal = Journal::open(&folder.join("strips"), &job).unwrap();
        let window = dem.window(0..side).unwrap();
        let next = AtomicU32::new(0);
        let shared = Mutex::new(&mut journal);
        std::thread::scope(|scope| {
            for _ in 0..THREADS {
                scope.spawn(|| {
                    loop {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        if index >= layout.strips() {
                            break;
                        }
                        let cells = maker.rows(&window, layout.rows_of(index)).unwrap();
                        let strip = Strip::pack(&layout, index, &cells);
                        shared.lock().unwrap().add(&strip).unwrap();
                    }
                });
            }
        });
        let computed = began.elapsed().as_secs_f64() - built;
        let cpu_computed = processor_seconds() - cpu - cpu_built;
        eprintln!("cells: {computed:.1} s, {cpu_computed:.1} s of processor time");
        let map = folder.join("map.tif");
        let mut known = 0_u64;
        write_map(
            fs::File::create(&map).unwrap(),
            &map,
            &layout,
            &mut [journal],
            |_, cells| {
                known += cells
                    .chunks_exact(layout.bands())
                    .filter(|cell| !cell[layout.bands() - 1].is_nan())
                    .count() as u64;
            },
        )
        .unwrap();
        let whole = began.elapsed().as_secs_f64();
        let cpu_whole = processor_seconds() - cpu;
        let peak = peak_mebibytes();

        let mut noise = Noise::new(1, 1);
        let cpu_exact = processor_seconds();
        let mut drives = 0;
        for solver in &solvers {
            for _ in 0..EXACT {
                let pitch = 0.2 * (2.0 * noise.uniform() - 1.0);
                let roll = 0.2 * (2.0 * noise.uniform() - 1.0);
                let demand = black_box(solver.demand(pitch, roll).unwrap());
                drives += u32::from(matches!(demand, Demand::Drives(_)));
            }
        }
        let exact = (processor_seconds() - cpu_exact) / (f64::from(EXACT) * draw_count as f64);
        let poses = known as f64 * f64::from(HEADINGS) * (draw_count + 1) as f64;
        let each = cpu_computed / poses;
        eprintln!(
            "{robot}: {whole:.1} s in all (tables {built:.1}, cells {computed:.1}, file {:.1}), {cpu_whole:.1} s of processor time; {known} cells x {HEADINGS} headings x \
             {} soils, {:.1} ns each on a thread; exact solver {:.1} us ({drives} of {} drive): {:.0} times; with the tables {:.0} times; \
             peak {peak:.0} MiB, map {:.0} MB, table error {:?}",
            whole - built - computed,
            draw_count + 1,
            1e9 * each,
            1e6 * exact,
            EXACT * u32::try_from(draw_count).unwrap(),
            exact / each,
            exact / (cpu_whole / poses),
            fs::metadata(&map).unwrap().len() as f64 / 1e6,
            maker.table_error(),
        );
    }
    let _ = fs::remove_dir_all(&folder);
}
