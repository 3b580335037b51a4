//! Temporary files and directories that are being written, so that an interrupted program can take them away.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The end of the names of what is not complete.
const PARTIAL: &str = ".part";

static PATHS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// The paths of all that is unfinished. An interruption waits as long as they are held.
pub(crate) fn unfinished_paths() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    PATHS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what is half written, for a program that is about to end: from then on, whoever begins or completes a file
/// waits for ever.
pub fn discard_unfinished() {
    let paths = unfinished_paths();
    paths.iter().for_each(|path| remove(path));
    std::mem::forget(paths);
}

/// A temporary file or directory, hidden beside what it is to become. It is removed when dropped or interrupted.
#[derive(Debug)]
pub(crate) struct Unfinished {
    path: PathBuf,
}

impl Unfinished {
    /// A new file, and the same open.
    pub(crate) fn file(target: &Path) -> io::Result<(Self, File)> {
        let prefix = hidden(target);
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(PARTIAL);
        // What any new file gets; the system takes the umask away from it.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        // Held until it is listed: an interruption in between would leave it behind.
        let mut paths = unfinished_paths();
        let (file, path) = builder.tempfile_in(parent(target))?.keep()?;
        paths.insert(path.clone());
        Ok((Self { path }, file))
    }

    /// A new directory.
    pub(crate) fn directory(target: &Path) -> io::Result<Self> {
        let prefix = hidden(target);
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(PARTIAL);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
        let mut paths = unfinished_paths();
        let path = builder.tempdir_in(parent(target))?.keep();
        paths.insert(path.clone());
        Ok(Self { path })
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        let mut paths = unfinished_paths();
        remove(&self.path);
        paths.remove(&self.path);
    }
}

/// Removes a file or a directory. What is gone already needs no removal, and nobody is left to be told of more.
pub(crate) fn remove(path: &Path) {
    let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
}

/// The beginning of the name of a hidden neighbour.
pub(crate) fn hidden(path: &Path) -> OsString {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name
}

/// The directory that the path is in.
pub(crate) fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(directory) if directory != Path::new("") => directory,
        _ => Path::new("."),
    }
}
