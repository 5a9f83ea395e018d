//! `map` and `plan`: files, shards, jobs that are killed, and input that is refused.

use std::fmt::Write as _;
use std::fs;
use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

use super::program::{Folder, LIMIT, Said, grouser, start};

fn example(name: &str) -> String {
    format!("{}/../../examples/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Relief of 120 by 700 cells: several strips.
fn relief(folder: &Folder) -> String {
    let mut text = String::from("ncols 120\nnrows 700\nxllcorner 0\nyllcorner 0\ncellsize 1\n");
    for row in 0..700 {
        for column in 0..120 {
            let (x, y) = (f64::from(column), f64::from(row));
            let _ = write!(
                text,
                "{:.3} ",
                0.5 * (x / 7.0).sin() + 0.4 * (y / 9.0).cos()
            );
        }
        text.push('\n');
    }
    let path = folder.path("relief.asc");
    fs::write(&path, text).unwrap();
    path.display().to_string()
}

fn arguments(dem: &str, output: &str, more: &[&str]) -> Vec<String> {
    let robot = example("robots/skid-steer.toml");
    let fixed = [
        "map",
        dem,
        "--robot",
        &robot,
        "--soil",
        "sandy-loam",
        "--headings",
        "4",
        "-o",
        output,
    ];
    fixed
        .iter()
        .chain(more)
        .map(|word| (*word).to_owned())
        .collect()
}

fn map(dem: &str, output: &str, more: &[&str]) -> Said {
    grouser(arguments(dem, output, more))
}

#[test]
fn shards_and_a_killed_job_have_the_bytes_of_one_run() {
    let folder = Folder::new();
    let dem = relief(&folder);
    let path = |name: &str| folder.path(name).display().to_string();
    map(&dem, &path("whole.tif"), &[]).assert_done();
    let whole = fs::read(folder.path("whole.tif")).unwrap();

    for shard in ["1/3", "2/3", "3/3"] {
        map(&dem, &path("joined.tif"), &["--shard", shard]).assert_done();
    }
    assert!(!folder.path("joined.tif").exists());
    map(&dem, &path("joined.tif"), &["--join", "3"]).assert_done();
    assert!(fs::read(folder.path("joined.tif")).unwrap() == whole);
    // a shard that is missing
    map(&dem, &path("joined.tif"), &["--join", "4"]).assert_refused("a missing shard");
    // a shard of other settings
    map(
        &dem,
        &path("other.tif"),
        &["--shard", "1/1", "--max-roll-deg", "20"],
    )
    .assert_done();
    map(&dem, &path("other.tif"), &["--join", "1"]).assert_refused("another job's shard");

    let mut child = start(arguments(&dem, &path("killed.tif"), &[]), Stdio::null());
    let begun = Instant::now();
    let journal = folder.path("killed.tif.strips");
    // the first strip behind the header of 72 bytes, with its number, length and checksum; on a loaded machine the job may end
    // before anybody looks
    let has_strip = || {
        let bytes = fs::read(&journal).unwrap_or_default();
        let length = bytes.get(76..80).map(|length| length.try_into().unwrap());
        length.is_some_and(|length| bytes.len() >= 84 + u32::from_le_bytes(length) as usize)
    };
    while !has_strip() && child.try_wait().unwrap().is_none() {
        assert!(begun.elapsed() < LIMIT, "no strip was ever stored");
        thread::sleep(Duration::from_millis(1));
    }
    let _ = child.kill();
    let was_killed = child.wait().unwrap().code().is_none();
    let resumed = map(&dem, &path("killed.tif"), &["--json"])
        .assert_done()
        .json();
    assert!(fs::read(folder.path("killed.tif")).unwrap() == whole);
    // the stored strips were not computed again
    assert!(resumed["resumed_strips"].as_u64() > Some(0) || !was_killed);
    assert!(!journal.exists());
}

#[test]
fn a_planned_way_is_a_scenario_that_drives() {
    let folder = Folder::new();
    let path = |name: &str| folder.path(name).display().to_string();
    let dem = example("terrain/dunes.asc");
    let robot = example("robots/skid-steer.toml");
    map(
        &dem,
        &path("map.tif"),
        &[
            "-o",
            &path("cost.yaml"),
            "-o",
            &path("map.svg"),
            "-o",
            &path("map.png"),
        ],
    )
    .assert_done();
    let pgm = fs::read(folder.path("cost.pgm")).unwrap();
    assert!(pgm.starts_with(b"P5\n48 36\n255\n") && pgm.len() == 13 + 48 * 36);
    // the hole in the relief, and what cannot be known beside it
    assert_eq!(pgm[13 + 5 * 48 + 40], 255);
    let way = grouser([
        "plan",
        &path("map.tif"),
        "--from",
        "3,3",
        "--to",
        "9,9",
        "--turn-energy-j",
        "20",
        "--json",
        "--scenario",
        &path("way.toml"),
        "--dem",
        &dem,
        "--robot",
        &robot,
        "--soil",
        "sandy-loam",
    ])
    .assert_done()
    .json();
    assert_eq!(way["status"], "found");
    assert!(way["route"]["energy_j"].as_f64().unwrap() > 0.0);
    let drive = grouser(["drive", &path("way.toml"), "--json"]);
    drive.assert_sane("the planned way");
    assert!(matches!(drive.code, Some(0 | 3)), "{drive:?}");
}

#[test]
fn a_plan_begins_and_ends_at_the_headings_that_are_given() {
    let folder = Folder::new();
    let map_file = folder.path("map.tif").display().to_string();
    map(&example("terrain/dunes.asc"), &map_file, &[]).assert_done();
    for (start, goal) in [("0", "90"), ("90", "180"), ("180", "0")] {
        let line = format!(
            "plan {map_file} --from 3,3 --to 9,9 --start-heading-deg {start} --goal-heading-deg {goal} --json"
        );
        let way = grouser(line.split(' ')).assert_done().json();
        let waypoints = way["route"]["waypoints"].as_array().unwrap();
        let ends = [waypoints.first(), waypoints.last()];
        for (end, wanted) in ends.into_iter().zip([start, goal]) {
            let heading = end.unwrap()["heading_deg"].as_f64().unwrap();
            assert_eq!(heading.to_string(), wanted, "{start} {goal}");
        }
    }
}

#[test]
fn a_plan_is_written_for_the_relief_the_robot_and_the_soil_of_its_map_alone() {
    let folder = Folder::new();
    let path = |name: &str| folder.path(name).display().to_string();
    let dunes = example("terrain/dunes.asc");
    let rover = example("robots/skid-steer.toml");
    map(&dunes, &path("map.tif"), &[]).assert_done();
    let text = fs::read_to_string(&dunes).unwrap();
    let (header, heights) = text.split_at(text.find("NODATA").unwrap());
    // the last row is the southern one; a dune of 3 m at its end
    let (start, _) = heights.trim_end().rsplit_once(' ').unwrap();
    fs::write(path("other.asc"), format!("{header}{start} 3.0\n")).unwrap();
    let moved = text.replace("xllcorner 0", "xllcorner 100");
    assert_ne!(moved, text);
    fs::write(path("moved.asc"), moved).unwrap();
    let plan = |dem: &str, robot: &str, soil: &str| {
        let (map, way) = (path("map.tif"), path("way.toml"));
        let to = ["plan", &map, "--from", "3,3", "--to", "9,9", "--json"];
        let by = [
            "--scenario",
            &way,
            "--dem",
            dem,
            "--robot",
            robot,
            "--soil",
            soil,
        ];
        grouser([&to[..], &by].concat())
    };
    let craters = example("terrain/craters.asc");
    let bogie = example("robots/rocker-bogie.toml");
    for (dem, robot, soil, field) in [
        (craters.as_str(), rover.as_str(), "sandy-loam", "size"),
        (&path("other.asc"), &rover, "sandy-loam", "pitch"),
        (&path("moved.asc"), &rover, "sandy-loam", "upper left cell"),
        (&dunes, &bogie, "sandy-loam", "name"),
        (&dunes, &rover, "dry-sand", "name"),
    ] {
        let refused = plan(dem, robot, soil);
        assert_eq!(refused.code, Some(2), "{refused:?}");
        let error = &refused.json()["error"];
        assert_eq!(error["field"], field, "{error}");
        assert!(
            error["value"] != error["limit"] && error["hint"].is_string(),
            "{error}"
        );
        assert!(!folder.path("way.toml").exists());
    }
    plan(&dunes, &rover, "sandy-loam").assert_done();
}

#[test]
fn a_plan_is_not_written_for_a_soil_of_the_same_name_with_other_numbers() {
    let folder = Folder::new();
    let path = |name: &str| folder.path(name).display().to_string();
    let (dunes, rover) = (
        example("terrain/dunes.asc"),
        example("robots/skid-steer.toml"),
    );
    let (soil, out) = (path("sand.toml"), path("map.tif"));
    let write = |cohesion: &str, more: &str| {
        let text = format!(
            "format = 1\nname = \"sand\"\nk_c_kn_per_m_n1 = 0.99\nk_phi_kn_per_m_n2 = 1528.0\nn = 1.1\n\
             cohesion_kpa = {cohesion}\nphi_deg = 28.0\nk_shear_m = 0.018\nc_1 = 0.4\nc_2 = 0.2\n{more}"
        );
        fs::write(&soil, text).unwrap();
    };
    let plan = |soil: &str| {
        let to = ["plan", &out, "--from", "3,3", "--to", "9,9", "--json"];
        let way = path("way.toml");
        let by = [
            "--scenario",
            &way,
            "--dem",
            &dunes,
            "--robot",
            &rover,
            "--soil",
            soil,
        ];
        grouser([&to[..], &by].concat())
    };
    let refused = |soil: &str, field: &str, value: &str, limit: &str| {
        let refused = plan(soil);
        assert_eq!(refused.code, Some(2), "{refused:?}");
        let error = &refused.json()["error"];
        let found = ["field", "value", "limit"].map(|key| error[key].as_str().unwrap());
        assert_eq!(found, [field, value, limit], "{error}");
    };
    write("1.04", "");
    let map = |soil: &str, more: &[&str]| {
        let made = ["map", &dunes, "--robot", &rover, "--soil", soil, "-o", &out];
        grouser([&made[..], more].concat()).assert_done();
    };
    map(&soil, &[]);
    plan(&soil).assert_done();
    write("2.5", "");
    refused(&soil, "cohesion_kpa", "2.5", "1.04");
    write("1.04", "n_1 = 0.2\n");
    refused(&soil, "n_1", "0.2", "left out");
    write("1.04", "slip_sinkage = \"whole\"\n");
    refused(&soil, "slip_sinkage", "\"whole\"", "left out");
    // a number that a flag has changed is not the catalogue's
    fs::remove_file(&out).unwrap();
    map("sandy-loam", &["--k-shear-m", "0.02"]);
    let of_catalogue = grouser_terra::catalogue::find("sandy-loam").unwrap();
    let own = of_catalogue.k_shear.unwrap().to_string();
    refused("sandy-loam", "k_shear_m", &own, "0.02");
}

#[test]
fn no_way_is_no_result_and_bad_places_are_refused() {
    let folder = Folder::new();
    let path = |name: &str| folder.path(name).display().to_string();
    let dem = example("terrain/dunes.asc");
    map(&dem, &path("map.tif"), &[]).assert_done();
    let plan = |words: &str| {
        let map = path("map.tif");
        let fixed = ["plan", map.as_str()];
        grouser(fixed.into_iter().chain(words.split_whitespace()))
    };
    let none = plan("--from 3,3 --to 44,20 --min-tip-over-deg 70 --json");
    assert_eq!(none.code, Some(1), "{none:?}");
    assert_eq!(none.json()["status"], "no-way");
    for (words, what) in [
        ("--from 3,3 --to 44,200", "a goal off the map"),
        ("--from 40.5,30.5 --to 44,20", "a start on unknown ground"),
        ("--from 3 --to 44,20", "a place of one number"),
        ("--from 3,nan --to 44,20", "a place that is no number"),
        ("--from 3,3 --to 44,20 --max-risk 2", "a risk beyond 1"),
        ("--from 3,3 --to 44,20 -o way.docx", "an unknown ending"),
    ] {
        plan(words).assert_refused(what);
    }
    // of four headings 90 degrees are one, 30 are none
    for (angle, nearest) in [
        ("90.5", None),
        ("-271", None),
        ("30", Some("0")),
        ("-100", Some("270")),
        ("719", None),
    ] {
        let found = plan(&format!(
            "--from 3,3 --to 9,9 --start-heading-deg {angle} --json"
        ))
        .assert_done();
        let said = found.err;
        let snapped =
            nearest.map(|nearest| format!("--start-heading-deg {angle} counts as {nearest}, "));
        assert_eq!(
            said.contains("--start-heading-deg"),
            nearest.is_some(),
            "{angle}: {said}"
        );
        assert!(
            snapped.is_none_or(|text| said.contains(&text)),
            "{angle}: {said}"
        );
    }
    let huge = plan("--from 1e300,3 --to 44,20");
    assert!(
        huge.err.contains("(1e300, 3.0)") && huge.err.len() < 300,
        "{huge:?}"
    );
    let not_a_map = grouser(["plan", dem.as_str(), "--from", "1,1", "--to", "2,2"]);
    not_a_map.assert_refused("an elevation model in place of a map");
}

#[test]
fn bad_terrain_and_flags_are_refused() {
    let folder = Folder::new();
    let path = |name: &str| folder.path(name).display().to_string();
    let arc = path("arc.asc");
    fs::write(
        &arc,
        "ncols 2\nnrows 2\nxllcorner 11.5\nyllcorner 48.1\ncellsize 0.000277777778\n1 2\n3 4\n",
    )
    .unwrap();
    let said = map(&arc, &path("map.tif"), &[]);
    said.assert_refused("degrees");
    assert!(said.err.contains("degrees"), "{said:?}");
    let dem = example("terrain/dunes.asc");
    for (more, what) in [
        (&["--headings", "7"] as &[&str], "7 headings"),
        (&["--max-pitch-deg", "80"], "a pitch beyond the limits"),
        (&["--shard", "3/2"], "part 3 of 2"),
        (&["--soil-draws", "8"], "draws without intervals"),
        (&["-o", "map.docx"], "an unknown ending"),
        (&["-o", "second.tif"], "two maps"),
        (&["--cell-m", "nan"], "a cell that is no number"),
        (
            &["--soil-intervals", "no-such.toml"],
            "a file that does not exist",
        ),
    ] {
        map(&dem, &path("map.tif"), more).assert_refused(what);
    }
    fs::write(
        folder.path("wrong.toml"),
        "format = 1\nsource = \"x\"\nphi_deg = { low = 40.0, high = 45.0 }\n",
    )
    .unwrap();
    map(
        &dem,
        &path("map.tif"),
        &["--soil-intervals", &path("wrong.toml")],
    )
    .assert_refused("an interval beside the soil's own number");
    assert!(!folder.path("map.tif").exists());
    // nothing known at all
    fs::write(folder.path("empty.asc"), "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n-9999 -9999 -9999\n-9999 -9999 -9999\n-9999 -9999 -9999\n").unwrap();
    let empty = map(&path("empty.asc"), &path("empty.tif"), &[]);
    assert_eq!(empty.code, Some(1), "{empty:?}");
}

/// A GeoTIFF of 20 by 20 floats, whose last one is infinite: the file is refused only when its cells are read.
fn endless_height() -> Vec<u8> {
    let mut heights = [0.0_f32; 400];
    heights[399] = f32::INFINITY;
    let mut out = b"II*\0".to_vec();
    out.extend(1608_u32.to_le_bytes());
    out.extend(heights.iter().flat_map(|height| height.to_le_bytes()));
    let entries: [(u16, u16, u32); 9] = [
        (256, 4, 20),
        (257, 4, 20),
        (258, 3, 32),
        (259, 3, 1),
        (262, 3, 1),
        (273, 4, 8),
        (278, 4, 20),
        (279, 4, 1600),
        (339, 3, 3),
    ];
    out.extend(9_u16.to_le_bytes());
    for (tag, kind, value) in entries {
        out.extend(tag.to_le_bytes());
        out.extend(kind.to_le_bytes());
        out.extend(1_u32.to_le_bytes());
        out.extend(value.to_le_bytes());
    }
    out.extend([0; 4]);
    out
}

#[test]
fn a_refused_map_leaves_no_file() {
    let folder = Folder::new();
    let path = |name: &str| folder.path(name).display().to_string();
    fs::write(folder.path("dem.tif"), endless_height()).unwrap();
    let refused = map(&path("dem.tif"), &path("map.tif"), &["--cell-m", "1"]);
    refused.assert_refused("an endless height");
    assert!(refused.err.contains("height"), "{refused:?}");
    let left = fs::read_dir(folder.path("")).unwrap();
    let names: Vec<_> = left.map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["dem.tif"]);
}
