//! Programs and examples that are not part of this program: they bring more than the command needs, and are found next to
//! it or on the path.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// A program next to this one.
pub(crate) struct Companion {
    /// Its name.
    pub(crate) name: &'static str,
    /// What it does, to follow "which".
    pub(crate) does: &'static str,
    /// What builds it.
    pub(crate) built_with: &'static str,
}

impl Companion {
    /// The program next to this one, or the first of its name on the path.
    pub(crate) fn find(&self) -> Result<PathBuf> {
        let name = format!("{}{}", self.name, std::env::consts::EXE_SUFFIX);
        let mut places = folders().map(|folder| folder.join(&name));
        places.find(|program| program.is_file()).ok_or_else(|| {
            let Self { name, does, built_with } = self;
            Error::usage(
                format!("the program `{name}`, which {does}, is neither next to `grouser` nor on the path"),
                format!("{INSTALLED_WITH} it; {built_with} in the source builds it"),
            )
        })
    }
}

/// What installs more than the command.
const INSTALLED_WITH: &str =
    "the archive, the Debian package and `pip install grouser-tools` contain";

/// The folder of the examples: `share/grouser/examples` of the folder in which this program, or one on the path, is installed.
pub(crate) fn examples() -> Result<PathBuf> {
    let mut places =
        folders().filter_map(|folder| Some(folder.parent()?.join("share/grouser/examples")));
    places.find(|folder| folder.is_dir()).ok_or_else(|| {
        Error::usage(
            "the examples are not installed",
            format!("{INSTALLED_WITH} them; the source has them in `examples/`"),
        )
    })
}

/// The folder of this program, then those of the path.
fn folders() -> impl Iterator<Item = PathBuf> {
    let own = std::env::current_exe().ok();
    let own = own.as_deref().and_then(Path::parent).map(Path::to_path_buf);
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path: Vec<PathBuf> = std::env::split_paths(&path).collect();
    own.into_iter().chain(path)
}
