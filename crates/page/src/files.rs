//! The page's files, which are part of the program: nothing is read from the disk.

use crate::error::{Error, Result};

macro_rules! file {
    ($name:literal) => {
        ($name, include_str!(concat!("../web/", $name)))
    };
}

/// The name and the text of each file.
pub const ALL: &[(&str, &str)] = &[
    file!("brushes.js"),
    file!("chart.js"),
    file!("controls.js"),
    file!("copy_as.js"),
    file!("dom.js"),
    file!("explore.js"),
    file!("face.css"),
    file!("facts.js"),
    file!("figure_file.js"),
    file!("format.js"),
    file!("front_space.js"),
    file!("ground.js"),
    file!("growth.js"),
    file!("index.html"),
    file!("intervals.js"),
    file!("main.js"),
    file!("measured_points.js"),
    file!("opening.js"),
    file!("optimise.js"),
    file!("palette.js"),
    file!("paper_2012.js"),
    file!("physics.js"),
    file!("player.js"),
    file!("report.js"),
    file!("requests.js"),
    file!("robot_draft.js"),
    file!("robot_view.js"),
    file!("run.js"),
    file!("run_charts.js"),
    file!("run_data.js"),
    file!("run_source.js"),
    file!("slip_classes.js"),
    file!("soils.js"),
    file!("state.js"),
    file!("stress.js"),
    file!("style.css"),
    file!("theme.js"),
    file!("ticks.js"),
    file!("track.js"),
    file!("wheel_table.js"),
    file!("worker.js"),
];

/// A file by its name.
///
/// # Errors
/// [`Error::Missing`] for any other name.
///
/// ```
/// assert!(grouser_page::files::text("index.html")?.starts_with("<!doctype html>"));
/// assert!(grouser_page::files::text("../Cargo.toml").is_err());
/// # Ok::<(), grouser_page::Error>(())
/// ```
pub fn text(name: &str) -> Result<&'static str> {
    let found = ALL.iter().find(|(own, _)| *own == name);
    let (_, text) = found.ok_or_else(|| Error::Missing {
        name: name.to_owned(),
    })?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_script(name: &str) -> bool {
        let extension = std::path::Path::new(name).extension();
        extension.is_some_and(|extension| extension == "js")
    }

    /// A name of a soil, a wheel, a topic or a file is never read as markup or as script.
    #[test]
    fn no_script_makes_elements_or_code_out_of_text() {
        for (name, text) in ALL.iter().filter(|(name, _)| is_script(name)) {
            for way in [
                "innerHTML",
                "outerHTML",
                "insertAdjacentHTML",
                "document.write",
                "createContextualFragment",
                "DOMParser",
                "srcdoc",
                "eval(",
                "new Function",
                "javascript:",
            ] {
                assert!(!text.contains(way), "{name} uses {way}");
            }
        }
    }

    #[test]
    fn every_file_of_the_folder_is_part_of_the_page() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/web");
        let mut names: Vec<String> = std::fs::read_dir(folder)
            .expect("the folder")
            .map(|entry| {
                entry
                    .expect("an entry")
                    .file_name()
                    .to_string_lossy()
                    .into_owned()
            })
            .collect();
        names.sort();
        assert_eq!(names, ALL.iter().map(|(name, _)| *name).collect::<Vec<_>>());
    }
}
