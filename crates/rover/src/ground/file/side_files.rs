//! Files next to an elevation model that change what it states: read, or refused by name.
//!
//! Source: GDAL's documentation of its drivers for the names; the well-known text of ISO 19162 and its predecessor
//! (OGC 01-009) for `.prj`.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use super::georeference::{Georeference, KEY_DOUBLES_TAG, USER_DEFINED};
use super::projection::{
    FALSE_EASTING_KEY, FALSE_NORTHING_KEY, METHOD_KEY, ORIGIN_LATITUDE_KEY, PROJECTED_SYSTEM_KEY,
    SCALE_KEY, SEMI_MAJOR_AXIS_KEY, STANDARD_PARALLEL_KEY,
};
use crate::terrain_fault::TerrainFault;

/// More than any of these files has, bytes.
const MAX_BYTES: u64 = 1 << 20;
/// Elements of GDAL's `.aux.xml` that change heights or places, and their value without effect.
const META: [(&str, &str); 6] = [
    ("SRS", ""),
    ("GeoTransform", ""),
    ("NoDataValue", ""),
    ("UnitType", ""),
    ("Offset", "0"),
    ("Scale", "1"),
];
const INTO_THE_FILE: &str = "`gdal_translate in.tif out.tif` writes what it states into the file";
/// Projections by their names in well-known text, without case and underscores: GeoTIFF's code of the method.
const METHODS: [(&str, u32); 9] = [
    ("transversemercator", 1),
    ("gausskruger", 1),
    ("mercator", 7),
    ("mercator1sp", 7),
    ("mercator2sp", 7),
    ("polarstereographic", 15),
    ("equirectangular", 17),
    ("equidistantcylindrical", 17),
    ("platecarree", 17),
];
const WEB_MERCATOR: u32 = 3857;

fn text_of(path: &Path) -> Option<String> {
    let mut text = Vec::new();
    let file = File::open(path).ok()?;
    file.take(MAX_BYTES).read_to_end(&mut text).ok()?;
    Some(String::from_utf8_lossy(&text).into_owned())
}

fn refused(path: &Path, states: &str, convert: &'static str) -> TerrainFault {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    TerrainFault::Beside {
        file: TerrainFault::shown(&name),
        states: states.to_owned(),
        convert,
    }
}

/// Refuses a file whose `.aux.xml`, mask or world file changes heights or places; `is_placed`: it places its cells itself.
pub(super) fn check(path: &Path, is_placed: bool) -> Result<(), TerrainFault> {
    let appended = |ending: &str| {
        let mut name = path.as_os_str().to_owned();
        name.push(ending);
        std::path::PathBuf::from(name)
    };
    let mask = appended(".msk");
    if mask.exists() {
        let convert = "`gdalwarp -dstnodata -9999 in.tif out.tif` writes the mask into the heights";
        return Err(refused(&mask, "a mask of unknown heights", convert));
    }
    let meta = appended(".aux.xml");
    let text = text_of(&meta).unwrap_or_default();
    for (name, usual) in META {
        let value = element(&text, name).unwrap_or(usual);
        let is_usual = value.parse::<f64>().ok() == usual.parse().ok() && !usual.is_empty();
        if value != usual && !is_usual {
            let states = format!("{name} {}", TerrainFault::shown(value));
            return Err(refused(&meta, &states, INTO_THE_FILE));
        }
    }
    if is_placed {
        return Ok(());
    }
    let worlds = ["tfw", "tifw", "tfwx", "tiffw", "pgw", "pngw", "pgwx", "wld"];
    let world = worlds.map(|ending| path.with_extension(ending));
    world
        .iter()
        .find(|path| path.exists())
        .map_or(Ok(()), |path| {
            Err(refused(path, "the place of its cells", INTO_THE_FILE))
        })
}

/// The content of the first element of a name.
fn element<'t>(text: &'t str, name: &str) -> Option<&'t str> {
    let (_, rest) = text
        .match_indices(&format!("<{name}"))
        .map(|(at, found)| text.split_at(at + found.len()))
        .find(|(_, rest)| rest.starts_with(['>', ' ']))?;
    let (_, content) = rest.split_once('>')?;
    Some(content.split_once("</")?.0.trim())
}

/// The coordinate system of a grid's `.prj`, at the place of its cells; `None` where there is no such file.
pub(super) fn system(
    path: &Path,
    grid: Georeference,
) -> Result<Option<Georeference>, TerrainFault> {
    let path = path.with_extension("prj");
    let Some(text) = text_of(&path) else {
        return Ok(None);
    };
    let keyed = keyed(&text, grid);
    keyed.map(Some).ok_or_else(|| {
        let convert = "project it first to metres that are true to scale, for example to the UTM zone of its place by \
            `gdalwarp -r bilinear -t_srs EPSG:32632 in.asc out.tif`";
        let states = "a coordinate system that is not read as metres true to scale";
        refused(&path, states, convert)
    })
}

/// A georeference with the keys that a GeoTIFF of the system would have.
fn keyed(text: &str, mut grid: Georeference) -> Option<Georeference> {
    let (_, projected) = text.split_once("PROJC")?;
    // lengths of any other unit, of coordinates or of heights
    let units = text.match_indices("UNIT[").filter_map(|(at, _)| {
        let factor = text[at..].split(',').nth(1)?;
        number(factor)
    });
    let is_degree = |factor: f64| (factor - 1.0_f64.to_radians()).abs() < 1e-6;
    if units
        .filter(|factor| !is_degree(*factor))
        .any(|factor| factor != 1.0)
    {
        return None;
    }
    let mut keys = vec![[1, 1, 0, 0], [1024, 0, 1, 1]];
    let whole = |key: u32, value: u32| Some([short(key)?, 0, 1, short(value)?]);
    let plain = |name: &str| name.replace(['_', ' '], "").to_ascii_lowercase();
    let name = quoted(projected, "PROJECTION[").or_else(|| quoted(projected, "METHOD["));
    let name = name.map(plain).unwrap_or_default();
    if let Some(code) = own_code(text) {
        keys.push(whole(PROJECTED_SYSTEM_KEY, code)?);
    } else if name == "mercatorauxiliarysphere" {
        keys.push(whole(PROJECTED_SYSTEM_KEY, WEB_MERCATOR)?);
    } else {
        let is_polar = name.starts_with("stereographic") && name.ends_with("pole");
        let method = METHODS.iter().find(|(own, _)| *own == name);
        let code = method.map(|(_, code)| *code).or(is_polar.then_some(15))?;
        keys.push(whole(PROJECTED_SYSTEM_KEY, USER_DEFINED)?);
        keys.push(whole(METHOD_KEY, code)?);
        let mut put = |key: u32, value: f64| {
            let index = short(grid.key_doubles.len())?;
            keys.push([short(key)?, KEY_DOUBLES_TAG, 1, index]);
            grid.key_doubles.push(value);
            Some(())
        };
        let radius = text.split("SPHEROID[").nth(1)?.split(',').nth(1)?;
        put(SEMI_MAJOR_AXIS_KEY, number(radius)?)?;
        for part in projected.split("PARAMETER[").skip(1) {
            let mut words = part.split([',', ']']);
            let (name, value) = (words.next()?, number(words.next()?)?);
            match plain(name.trim_matches(['"', ' '])).as_str() {
                "scalefactor" => put(SCALE_KEY, value)?,
                "falseeasting" => put(FALSE_EASTING_KEY, value)?,
                "falsenorthing" => put(FALSE_NORTHING_KEY, value)?,
                "standardparallel1" if code == 15 => put(ORIGIN_LATITUDE_KEY, value)?,
                "standardparallel1" => put(STANDARD_PARALLEL_KEY, value)?,
                "latitudeoforigin" => put(ORIGIN_LATITUDE_KEY, value)?,
                _ => {}
            }
        }
    }
    keys[0][3] = short(keys.len() - 1)?;
    grid.keys = keys.concat();
    Some(grid)
}

fn short(value: impl TryInto<u16>) -> Option<u16> {
    value.try_into().ok()
}

fn number(text: &str) -> Option<f64> {
    text.trim_matches([']', ' ', '\r', '\n', '\t']).parse().ok()
}

fn quoted<'t>(text: &'t str, before: &str) -> Option<&'t str> {
    text.split_once(before)?.1.split('"').nth(1)
}

/// The code of EPSG of the system as a whole: the last of the text.
fn own_code(text: &str) -> Option<u32> {
    let (_, last) = text.rsplit_once("AUTHORITY[").or(text.rsplit_once("ID["))?;
    let (own, rest) = last.split_once(']')?;
    let (authority, code) = own.split_once(',')?;
    let is_own = authority.contains("EPSG") && rest.trim_matches([']', ' ', '\r', '\n']).is_empty();
    let code = code.trim_matches(['"', ' ']).parse().ok()?;
    is_own.then_some(code)
}
