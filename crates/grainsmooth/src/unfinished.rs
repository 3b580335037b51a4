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
    temporary: T,
}

impl<T> Unfinished<T> {
    /// Makes what stands at the path that `path` tells.
    pub(crate) fn new(
        make: impl FnOnce() -> io::Result<T>,
        path: impl FnOnce(&T) -> &Path,
    ) -> io::Result<Self> {
        // Locked until it is listed: an interruption in between would leave it behind.
        let mut paths = paths();
        let temporary = make()?;
        let path = path(&temporary).to_owned();
        paths.insert(path.clone());
        Ok(Self { path, temporary })
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Unfinished<NamedTempFile> {
    /// The file, to write into.
    pub(crate) fn as_file(&self) -> &fs::File {
        self.temporary.as_file()
    }

    /// Gives the file its name.
    pub(crate) fn persist(self, target: &Path) -> io::Result<()> {
        let mut paths = paths();
        self.temporary.persist(target)?;
        paths.remove(&self.path);
        Ok(())
    }
}

impl Unfinished<TempDir> {
    /// Gives the directory its name.
    pub(crate) fn persist(self, target: &Path) -> io::Result<()> {
        let mut paths = paths();
        fs::rename(self.temporary.keep(), target)?;
        paths.remove(&self.path);
        Ok(())
    }

    /// Moves the directory's files into `target`, which is made where it is missing; the directory goes.
    pub(crate) fn persist_files(self, target: &Path) -> io::Result<()> {
        let mut paths = paths();
        fs::create_dir_all(target)?;
        for entry in fs::read_dir(&self.path)? {
            let entry = entry?;
            fs::rename(entry.path(), target.join(entry.file_name()))?;
        }
        paths.remove(&self.path);
        Ok(())
    }
}
