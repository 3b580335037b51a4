//! Temporary files and directories that are being written, so that an interrupted program can take them away.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{NamedTempFile, TempDir};

static PATHS: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn paths() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    PATHS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what is half written, for a program that is about to end: from then on, whoever begins or completes a file
/// waits for ever.
pub fn discard_unfinished() {
    let paths = paths();
    for path in paths.iter() {
        // What is gone already needs no removal, and nobody is left to be told of more.
        let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    }
    std::mem::forget(paths);
}

/// A temporary file or directory that is removed when dropped or interrupted.
pub(crate) struct Unfinished<T> {
    path: PathBuf,
    temporary: Option<T>,
}

impl Unfinished<NamedTempFile> {
    /// Makes a file.
    pub(crate) fn file(make: impl FnOnce() -> io::Result<NamedTempFile>) -> io::Result<Self> {
        Self::new(make, |file| file.path().to_owned())
    }

    /// The file, to write into.
    pub(crate) fn as_file(&self) -> &fs::File {
        self.temporary.as_ref().expect("there until completed").as_file()
    }

    /// Gives the file its name.
    pub(crate) fn persist(mut self, target: &Path) -> io::Result<()> {
        self.temporary.take().expect("there until completed").persist(target)?;
        Ok(())
    }
}

impl Unfinished<TempDir> {
    /// Makes a directory.
    pub(crate) fn directory(make: impl FnOnce() -> io::Result<TempDir>) -> io::Result<Self> {
        Self::new(make, |directory| directory.path().to_owned())
    }

    /// Gives the directory its name.
    pub(crate) fn persist(mut self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)?;
        // Nothing is left under the temporary name.
        self.temporary.take().expect("there until completed").keep();
        Ok(())
    }
}

impl<T> Unfinished<T> {
    fn new(make: impl FnOnce() -> io::Result<T>, path: impl FnOnce(&T) -> PathBuf) -> io::Result<Self> {
        let mut paths = paths();
        let temporary = make()?;
        let path = path(&temporary);
        paths.insert(path.clone());
        Ok(Self { path, temporary: Some(temporary) })
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl<T> Drop for Unfinished<T> {
    fn drop(&mut self) {
        self.temporary.take();
        paths().remove(&self.path);
    }
}
