//! Programs that are not part of this one: they bring more than the command needs, and are found beside it or on the
//! path.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// A program beside this one.
pub(crate) struct Companion {
    /// Its name.
    pub(crate) name: &'static str,
    /// What it does, to follow "which".
    pub(crate) does: &'static str,
    /// How it is built, to follow "build it with".
    pub(crate) built_with: &'static str,
}

impl Companion {
    /// The program beside this one, or the first of its name on the path.
    pub(crate) fn find(&self) -> Result<PathBuf> {
        let name = format!("{}{}", self.name, std::env::consts::EXE_SUFFIX);
        let own = std::env::current_exe().ok();
        let beside = own.as_deref().and_then(Path::parent).map(Path::to_path_buf);
        let path = std::env::var_os("PATH").unwrap_or_default();
        let mut places = beside
            .into_iter()
            .chain(std::env::split_paths(&path))
            .map(|folder| folder.join(&name));
        places.find(|program| program.is_file()).ok_or_else(|| {
            let Self { name, does, built_with } = self;
            Error::usage(
                format!("the program `{name}`, which {does}, is not beside `grouser` and not on the path"),
                format!("build it with {built_with} of the source and put it beside `grouser`; `{name} --help` then works"),
            )
        })
    }
}
