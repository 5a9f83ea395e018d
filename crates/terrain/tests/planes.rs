//! One plane of 10 degrees, stated in many ways: each is read as 10.0 ± 0.1 degrees by both readers of heights, or
//! refused by both with the name of the tag.

mod plane;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use grouser_rover::ground::{HeightFile, read_heights};
use grouser_terrain::raster::Dem;

use self::plane::{COLUMNS, Cells, NO_DATA, Plane, ROWS, UTM, columns, height, plane};

/// 60 degrees north in the coordinates of EPSG:3857, m.
const WEB_60_NORTH: [f64; 2] = [1_224_514.0, 8_399_738.0];
/// What the answer must be.
#[derive(Clone, Copy, Debug)]
enum Right {
    /// 10 degrees.
    Read,
    /// Refused, with these words.
    Refused(&'static str),
}
use Right::{Read, Refused};

/// By both readers: the smallest and the largest slope between neighbours along x, the largest along y, degrees; or
/// the message with its hint.
fn slopes(path: &Path) -> [Result<[f64; 3], String>; 2] {
    let file = HeightFile::new(path.to_owned(), None);
    let message = |text: String, hint: Option<String>| {
        format!("{text}\n{}", hint.expect("a refusal has a hint"))
    };
    let of_drive = read_heights(&file)
        .map_err(|error| message(error.to_string(), error.hint()))
        .map(|map| {
            let ((left, bottom), (right, _)) = map.extent();
            let cell = (right - left) / f64::from(COLUMNS - 1);
            steepest(cell, |row, column| {
                let (x, y) = (
                    left + cell * f64::from(column),
                    bottom + cell * f64::from(ROWS - 1 - row),
                );
                map.known(x, y).then(|| map.height(x, y))
            })
        });
    let of_map = Dem::open(path, None, 0.001)
        .and_then(|mut dem| {
            let cell = dem.cell();
            let window = dem.window(0..ROWS.into())?;
            Ok(steepest(cell, |row, column| {
                window.height(row.into(), column.into()).map(f64::from)
            }))
        })
        .map_err(|error| message(error.to_string(), error.hint()));
    [of_drive, of_map]
}

fn steepest(cell: f64, height: impl Fn(u16, u16) -> Option<f64>) -> [f64; 3] {
    let mut out = [f64::INFINITY, f64::NEG_INFINITY, 0.0_f64];
    let mut known = 0;
    for row in 0..ROWS - 1 {
        for column in 0..COLUMNS - 1 {
            let here = [(row, column), (row, column + 1), (row + 1, column)]
                .map(|(row, column)| height(row, column));
            if let [Some(own), Some(right), Some(below)] = here {
                let slope = ((right - own) / cell).atan().to_degrees();
                out = [
                    out[0].min(slope),
                    out[1].max(slope),
                    out[2].max(((below - own) / cell).atan().to_degrees().abs()),
                ];
                known += 1;
            }
        }
    }
    assert!(known > 60, "{known} cells are known");
    out
}

/// What is wrong with the answers of both readers to a file.
fn wrong(folder: &Path, (name, ending): (&str, &str), bytes: &[u8], right: Right) -> Vec<String> {
    let path: PathBuf = folder.join(format!("{}.{ending}", name.replace([' ', '/'], "-")));
    fs::write(&path, bytes).unwrap();
    let is_right = |found: &Result<[f64; 3], String>| match (found, right) {
        (Ok([low, high, across]), Read) => {
            (low - 10.0).abs() <= 0.1 && (high - 10.0).abs() <= 0.1 && *across <= 0.1
        }
        (Err(message), Refused(words)) => message.contains(words),
        _ => false,
    };
    slopes(&path)
        .into_iter()
        .zip(["drive", "map"])
        .filter(|(found, _)| !is_right(found))
        .map(|(found, reader)| format!("{name}, {reader}: {found:?} in place of {right:?}"))
        .collect()
}

#[test]
fn a_plane_of_ten_degrees_is_read_as_one_or_refused_however_it_is_stated() {
    let folder = std::env::temp_dir().join(format!("grouser-planes-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let cases = [numbers(), systems(), units(), projections(), placements()]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>();
    assert!(cases.len() >= 55, "{}", cases.len());
    let mut all = Vec::new();
    for (name, plane, right) in cases {
        all.extend(wrong(&folder, (name, "tif"), &plane.bytes(), right));
    }
    for (name, head, nothing, right) in [
        ("a grid", "xllcorner 0\nyllcorner 0\ncellsize 1", 0, Read),
        (
            "a grid by its centre",
            "xllcenter 5\nyllcenter 5\ncellsize 1",
            0,
            Read,
        ),
        ("a grid without its no data", "cellsize 1", -32_768, Read),
        (
            "a grid of another no data",
            "cellsize 1\nNODATA_value -1",
            -9999,
            Read,
        ),
        (
            "a grid of seconds",
            "xllcorner 11.5\nyllcorner 48.1\ncellsize 0.00027777777",
            0,
            Refused("degrees"),
        ),
    ] {
        let mut text = format!("ncols {COLUMNS}\nnrows {ROWS}\n{head}\n");
        for (index, column) in columns().enumerate() {
            let is_hole = nothing != 0 && index == 29;
            let value = if is_hole {
                nothing.into()
            } else {
                height(column)
            };
            write!(text, "{value:.5} ").unwrap();
        }
        all.extend(wrong(&folder, (name, "asc"), text.as_bytes(), right));
    }
    fs::remove_dir_all(&folder).unwrap();
    assert!(all.is_empty(), "{}", all.join("\n"));
}

/// A model with a file next to it that has this ending.
fn wrong_beside(
    folder: &Path,
    (name, ending): (&str, &str),
    bytes: &[u8],
    (beside, text): (&str, &str),
    right: Right,
) -> Vec<String> {
    let other = format!("{}{beside}", name.replace(' ', "-"));
    fs::write(folder.join(other), text).unwrap();
    wrong(folder, (name, ending), bytes, right)
}

#[test]
fn a_file_next_to_an_image_is_refused_where_it_changes_the_heights() {
    let folder = std::env::temp_dir().join(format!("grouser-beside-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let tiff = plane().bytes();
    let meta = |inside: &str| {
        format!("<PAMDataset><PAMRasterBand band=\"1\">{inside}</PAMRasterBand></PAMDataset>")
    };
    let harmless = "<Metadata><MDI key=\"STATISTICS_MAXIMUM\">2</MDI></Metadata><Histograms/>\
        <Offset>0</Offset><Scale>1.0</Scale>";
    let mut all = Vec::new();
    for (name, inside, right) in [
        ("statistics", harmless, Read),
        ("a scale", "<Scale>0.1</Scale>", Refused("Scale 0.1")),
        ("an offset", "<Offset>5</Offset>", Refused("Offset 5")),
        ("a unit", "<UnitType>ft</UnitType>", Refused("UnitType ft")),
        (
            "a hole",
            "<NoDataValue>200</NoDataValue>",
            Refused("NoDataValue"),
        ),
        (
            "a system",
            "<SRS dataAxis=\"1,2\">EPSG:4326</SRS>",
            Refused("SRS"),
        ),
        (
            "a place",
            "<GeoTransform>0, 2, 0, 0, 0, -2</GeoTransform>",
            Refused("GeoTransform"),
        ),
    ] {
        let beside = (".tif.aux.xml", &*meta(inside));
        all.extend(wrong_beside(&folder, (name, "tif"), &tiff, beside, right));
    }
    let mask = (".tif.msk", "");
    all.extend(wrong_beside(
        &folder,
        ("a mask", "tif"),
        &tiff,
        mask,
        Refused("mask"),
    ));
    let world = (".tfw", "2\n0\n0\n-2\n0\n0\n");
    all.extend(wrong_beside(
        &folder,
        ("its own place", "tif"),
        &tiff,
        world,
        Read,
    ));
    assert!(all.is_empty(), "{}", all.join("\n"));

    let unplaced = Plane {
        scale: Vec::new(),
        ..plane()
    };
    let path = folder.join("unplaced.tif");
    fs::write(&path, unplaced.bytes()).unwrap();
    fs::write(folder.join("unplaced.tfw"), "1\n0.5\n0.5\n-1\n0\n0\n").unwrap();
    let of_drive = read_heights(&HeightFile::new(path.clone(), Some(1.0)));
    let of_map = Dem::open(&path, Some(1.0), 0.001);
    for refusal in [
        of_drive.err().map(|error| error.to_string()),
        of_map.err().map(|error| error.to_string()),
    ] {
        assert!(
            refusal
                .as_ref()
                .is_some_and(|text| text.contains("unplaced.tfw")),
            "{refusal:?}"
        );
    }
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn the_system_of_a_grid_is_read_or_refused() {
    const GEOGRAPHIC: &str = "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
        PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]";
    let folder = std::env::temp_dir().join(format!("grouser-prj-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let grid = |[x, y]: [f64; 2]| {
        let mut text =
            format!("ncols {COLUMNS}\nnrows {ROWS}\nxllcorner {x}\nyllcorner {y}\ncellsize 1\n");
        for column in columns() {
            write!(text, "{:.5} ", height(column)).unwrap();
        }
        text.into_bytes()
    };
    let projected = |rest: &str| format!("PROJCS[\"own\",{GEOGRAPHIC},{rest}]");
    let utm = |unit: &str| {
        projected(&format!(
            "PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"False_Easting\",500000.0],\
             PARAMETER[\"Central_Meridian\",9.0],PARAMETER[\"Scale_Factor\",0.9996],{unit}"
        ))
    };
    let metres = "UNIT[\"Meter\",1.0]";
    let web = projected(&format!(
        "PROJECTION[\"Mercator_Auxiliary_Sphere\"],{metres}"
    ));
    let polar = projected(&format!(
        "PROJECTION[\"Stereographic_North_Pole\"],PARAMETER[\"Standard_Parallel_1\",70.0],{metres}"
    ));
    let code = |code: u16| projected(&format!("AUTHORITY[\"EPSG\",\"{code}\"]"));
    let (system, method) = (Refused("coordinate system"), Refused("ProjMethodGeoKey"));
    let mut all = Vec::new();
    for (name, place, text, right) in [
        ("degrees", [11.0, 48.0], GEOGRAPHIC.to_owned(), system),
        ("utm", UTM, utm(metres), Read),
        ("utm far", [2e6, 5e6], utm(metres), method),
        (
            "feet",
            UTM,
            utm("UNIT[\"Foot_US\",0.304800609601219]"),
            system,
        ),
        ("a code", UTM, code(32_632), Read),
        ("a code of feet", UTM, code(2227), Refused("2227")),
        ("web", WEB_60_NORTH, web, Refused("3857")),
        ("polar", [0.0, -2.2e6], polar.clone(), Read),
        ("polar far", [0.0, -4.5e6], polar, method),
        ("a conic", UTM, projected("PROJECTION[\"Albers\"]"), system),
        (
            "old words",
            UTM,
            "Projection UTM\nUnits METERS\n".into(),
            system,
        ),
    ] {
        let beside = (".prj", &*text);
        all.extend(wrong_beside(
            &folder,
            (name, "asc"),
            &grid(place),
            beside,
            right,
        ));
    }
    fs::remove_dir_all(&folder).unwrap();
    assert!(all.is_empty(), "{}", all.join("\n"));
}

type Case = (&'static str, Plane, Right);

/// Kinds of numbers, no data, units of a band.
fn numbers() -> Vec<Case> {
    let doubles = Cells::Doubles(columns().map(height).collect());
    let feet = "US survey foot";
    vec![
        ("floats", plane(), Read),
        (
            "doubles",
            Plane {
                cells: doubles,
                ..plane()
            },
            Read,
        ),
        ("words with scale and offset", plane().words(), Read),
        (
            "words with no data",
            plane().words().text(NO_DATA, "-1").hole(-1.0),
            Read,
        ),
        (
            "words without their no data",
            plane().words().hole(-32_768.0),
            Read,
        ),
        (
            "a scale in words",
            plane().item("SCALE", "one"),
            Refused("SCALE"),
        ),
        (
            "an endless offset",
            plane().item("OFFSET", "inf"),
            Refused("OFFSET"),
        ),
        (
            "a unit of feet",
            plane().item("UNITTYPE", feet),
            Refused("UNITTYPE"),
        ),
        (
            "a unit of ft",
            plane().item("UNITTYPE", "ft"),
            Refused("UNITTYPE"),
        ),
        ("a unit of metres", plane().item("UNITTYPE", "metre"), Read),
        (
            "no data",
            plane().text(NO_DATA, "-9999").hole(-9999.0),
            Read,
        ),
        (
            "no data of nan",
            plane().text(NO_DATA, "nan").hole(f32::NAN),
            Read,
        ),
        (
            "no data in words",
            plane().text(NO_DATA, "none").hole(-1.0),
            Refused("GDAL_NODATA"),
        ),
        ("-9999 undeclared", plane().hole(-9999.0), Read),
        ("-32768 undeclared", plane().hole(-32_768.0), Read),
        ("-32767 undeclared", plane().hole(-32_767.0), Read),
        (
            "the smallest float undeclared",
            plane().hole(f32::MIN),
            Read,
        ),
        ("the largest float undeclared", plane().hole(f32::MAX), Read),
        (
            "another no data declared",
            plane().text(NO_DATA, "-32768").hole(-9999.0),
            Read,
        ),
        (
            "a mask",
            Plane {
                has_mask: true,
                ..plane()
            },
            Refused("NewSubfileType"),
        ),
        (
            "two bands",
            Plane {
                bands: 2,
                ..plane()
            },
            Refused("bands"),
        ),
    ]
}

/// Systems of EPSG and units of a system.
fn systems() -> Vec<Case> {
    let refused = Refused("ProjectedCRSGeoKey (3072)");
    vec![
        ("Lambert 93", plane().system(2154, [7e5, 6.6e6]), Read),
        ("the British grid", plane().system(27_700, [4e5, 3e5]), Read),
        (
            "Mercator of the web at 60 N",
            plane().system(3857, WEB_60_NORTH).size(2.0, 2.0),
            refused,
        ),
        (
            "Mercator of the web, south",
            plane().system(3857, [0.0, -4e6]),
            refused,
        ),
        (
            "Mercator of the web at the equator",
            plane().system(3857, [2e6, 1e4]),
            Read,
        ),
        (
            "World Mercator",
            plane().system(3395, [0.0, 8.36e6]),
            refused,
        ),
        (
            "equidistant at 60 N",
            plane().system(4087, [1e6, 6.68e6]),
            refused,
        ),
        (
            "equidistant at the equator",
            plane().system(4087, [1e6, 1e4]),
            Read,
        ),
        ("polar at 70 N", plane().system(3413, [0.0, -2.2e6]), Read),
        (
            "polar at 50 N",
            plane().system(3413, [0.0, -4.5e6]),
            refused,
        ),
        (
            "polar at the pole",
            plane().system(3413, [0.0, 0.0]),
            refused,
        ),
        (
            "Antarctic at 71 S",
            plane().system(3031, [0.0, 2.08e6]),
            Read,
        ),
        (
            "Antarctic far north",
            plane().system(3031, [4e6, 4e6]),
            refused,
        ),
        ("universal polar", plane().system(32_661, [2e6, 2e6]), Read),
        (
            "feet of California",
            plane().system(2227, [6e6, 2e6]),
            refused,
        ),
        (
            "feet of New York",
            plane().system(2263, [1e6, 2e5]),
            refused,
        ),
        (
            "axes to the south",
            plane().system(2048, [0.0, 3.7e6]),
            refused,
        ),
        (
            "equal area of the United States",
            plane().system(2163, [2e6, 0.0]),
            refused,
        ),
        (
            "far from the zone",
            plane().system(32_632, [1.9e6, 5.3e6]),
            refused,
        ),
        ("an unknown system", plane().system(31, UTM), refused),
    ]
}

/// Units of a system, systems of heights, and no projected system.
fn units() -> Vec<Case> {
    let none = Plane {
        keys: Vec::new(),
        ..plane()
    };
    vec![
        (
            "feet",
            plane().key(3076, 9003),
            Refused("ProjLinearUnitsGeoKey (3076)"),
        ),
        ("metres", plane().key(3076, 9001), Read),
        (
            "heights in feet",
            plane().key(4099, 9002),
            Refused("VerticalUnitsGeoKey (4099)"),
        ),
        ("heights in metres", plane().key(4099, 9001), Read),
        (
            "a system of feet upwards",
            plane().key(4096, 6360),
            Refused("VerticalGeoKey (4096)"),
        ),
        (
            "a system of depths",
            plane().key(4096, 5715),
            Refused("VerticalGeoKey (4096)"),
        ),
        ("a system of metres upwards", plane().key(4096, 3855), Read),
        (
            "degrees",
            Plane {
                keys: vec![[1024, 0, 1, 2], [2048, 0, 1, 4326]],
                ..plane()
            },
            Refused("GTModelTypeGeoKey"),
        ),
        ("geocentric", plane().key(1024, 3), refusal_without_system()),
        ("nothing stated", none, refusal_without_system()),
    ]
}

const fn refusal_without_system() -> Right {
    Refused("ProjectedCRSGeoKey (3072)")
}

/// Projections by their parameters.
fn projections() -> Vec<Case> {
    let refused = Refused("ProjMethodGeoKey (3075)");
    let mars = [(2057, 3_396_190.0), (3078, 0.0)];
    vec![
        (
            "a transverse Mercator",
            plane().method(1, &[(3092, 0.9996), (3082, 5e5)], UTM),
            Read,
        ),
        (
            "a transverse Mercator far away",
            plane().method(1, &[(3092, 0.9996), (3082, 5e5)], [2e6, 5e6]),
            refused,
        ),
        (
            "a Mercator true at 60 N",
            plane().method(7, &[(3078, 60.0)], [0.0, 4.2e6]),
            Read,
        ),
        (
            "a Mercator true at the equator",
            plane().method(7, &[], [0.0, 8.4e6]),
            refused,
        ),
        (
            "a polar stereographic of the Moon",
            plane().method(15, &[(2057, 1_737_400.0), (3081, -90.0)], [1e5, 5e4]),
            Read,
        ),
        (
            "the same at 75 S",
            plane().method(15, &[(2057, 1_737_400.0), (3081, -90.0)], [3e5, 3.6e5]),
            refused,
        ),
        (
            "Mars near the equator",
            plane().method(17, &mars, [8.1e6, -2.8e5]),
            Read,
        ),
        (
            "Mars at 45 N",
            plane().method(17, &mars, [8.1e6, 2.67e6]),
            refused,
        ),
        (
            "Mars with its own parallel",
            plane().method(17, &[(2057, 3_396_190.0), (3078, 45.0)], [5.7e6, 2.66e6]),
            Read,
        ),
        (
            "a conic",
            plane().method(8, &[(3078, 45.0), (3079, 49.0)], UTM),
            Refused("ProjMethodGeoKey (3075)"),
        ),
    ]
}

/// Places of the cells.
fn placements() -> Vec<Case> {
    vec![
        ("pixels are points", plane().key(1025, 2), Read),
        ("a matrix", plane().matrix([1.0, 0.0, 0.0, -1.0]), Read),
        (
            "rows to the north",
            plane().matrix([1.0, 0.0, 0.0, 1.0]),
            Refused("ModelTransformationTag"),
        ),
        (
            "columns to the west",
            plane().matrix([-1.0, 0.0, 0.0, -1.0]),
            Refused("ModelTransformationTag"),
        ),
        (
            "turned by 30 degrees",
            plane().matrix([0.866, 0.5, 0.5, -0.866]),
            Refused("ModelTransformationTag"),
        ),
        (
            "a negative scale",
            plane().size(1.0, -1.0),
            Refused("ModelPixelScaleTag"),
        ),
        (
            "cells that are not square",
            plane().size(1.0, 2.0),
            Refused("square"),
        ),
        (
            "no scale",
            Plane {
                scale: Vec::new(),
                ..plane()
            },
            Refused("scale"),
        ),
    ]
}
