//! A costmap for Nav2's map server: a PGM of occupancies and its YAML.

use std::path::Path;

use grouser_terrain::MapLayout;

use super::summary::Summary;
use crate::error::{Error, Result};
use crate::output::OutputFile;

/// Writes the YAML file `path` and the PGM beside it, in mode `raw`: occupancies 0 to 100, and 255 for unknown cells.
pub(super) fn write(path: &Path, layout: &MapLayout, summary: &Summary) -> Result<String> {
    let image = path.with_extension("pgm");
    let name = image.file_name().and_then(|name| name.to_str());
    let Some(name) = name.filter(|name| name.chars().all(is_plain)) else {
        return Err(Error::usage(
            format!(
                "{} cannot be named in YAML without quotes",
                crate::error::shown(&image)
            ),
            "use letters, digits, `-`, `_` and `.`",
        ));
    };
    let mut bytes = format!("P5\n{} {}\n255\n", layout.columns, layout.rows).into_bytes();
    bytes.extend_from_slice(summary.costs.as_deref().unwrap_or_default());
    let mut text = OutputFile::create(&image)?.write_whole(&bytes)?;
    // the outer corner of the lower left cell
    let [x, y] = layout
        .place_of(0, layout.rows.saturating_sub(1))
        .map(|axis| axis - 0.5 * layout.cell);
    let yaml = format!(
        "image: {name}\nmode: raw\nresolution: {}\norigin: [{x}, {y}, 0.0]\nnegate: 0\noccupied_thresh: 0.99\n\
         free_thresh: 0.05\n",
        layout.cell
    );
    text.push_str(&OutputFile::create(path)?.write_whole(yaml.as_bytes())?);
    Ok(text)
}

fn is_plain(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || matches!(letter, '-' | '_' | '.')
}
