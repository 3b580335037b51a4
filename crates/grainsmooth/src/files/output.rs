//! Where results go: the path checked before the work begins, the file complete before it has its name.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::staged_files::{StagedFiles, write_together};
use super::unfinished::{Unfinished, parent};
use crate::error::Error;

/// A path that was found writable, and the format to write there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OutputPath<Format> {
    path: PathBuf,
    /// The path from the root on, or what it links to.
    target: PathBuf,
    format: Format,
}

impl<Format: Copy> OutputPath<Format> {
    /// Checks that a file can be written at `path`, whatever its extension, without changing what is there.
    ///
    /// # Errors
    /// [`Error::NoOutputDirectory`]; [`Error::OutputNotAFile`] when something else has the name; [`Error::OutputNotWritable`] when the directory
    /// takes no new file or the present file is read-only.
    pub fn check_as(path: impl Into<PathBuf>, format: Format) -> Result<Self, Error> {
        let path = path.into();
        let target = match fs::metadata(&path) {
            Ok(present) if !present.is_file() => return Err(Error::OutputNotAFile { path }),
            Ok(present) if present.permissions().readonly() => {
                let cause = io::Error::new(io::ErrorKind::PermissionDenied, "the present file is read-only");
                return Err(Error::OutputNotWritable { path, cause });
            }
            // Renaming over a link would replace the link.
            Ok(_) => fs::canonicalize(&path),
            Err(error) if error.kind() == io::ErrorKind::NotFound => in_full(&path)?,
            Err(error) => Err(error),
        };
        match target.and_then(|target| Unfinished::file(&target).map(|_| target)) {
            Ok(target) => Ok(Self { path, target, format }),
            Err(cause) => Err(Error::OutputNotWritable { path, cause }),
        }
    }

    /// The same path for something else.
    pub(crate) fn as_format<Other>(&self, format: Other) -> OutputPath<Other> {
        OutputPath { path: self.path.clone(), target: self.target.clone(), format }
    }

    /// The path as it was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The format to write.
    pub fn format(&self) -> Format {
        self.format
    }

    /// The path from the root on, or what it links to.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Completes the file under a temporary name, as one of several that appear together.
    ///
    /// # Errors
    /// [`Error::WriteOutput`] when `content` or the file system fails; [`Error::OutputTwice`].
    pub fn stage(
        &self,
        files: &mut StagedFiles,
        content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Error> {
        files.file(&self.target, &self.path, content)
    }

    /// Writes the file: `content` into a temporary file in the same directory, which takes the name when
    /// complete. A present file is replaced then, keeping its permissions.
    ///
    /// # Errors
    /// [`Error::WriteOutput`] when `content` or the file system fails. The temporary file is removed then,
    /// and a present file stays as it was.
    pub fn write(&self, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
        write_together(|files| self.stage(files, content))
    }
}

/// The path of a new file from the root on.
pub(crate) fn in_full(path: &Path) -> Result<io::Result<PathBuf>, Error> {
    let directory = parent(path);
    if !directory.is_dir() {
        return Err(Error::NoOutputDirectory { path: path.to_owned(), directory: directory.to_owned() });
    }
    Ok(fs::canonicalize(directory).map(|directory| directory.join(path.file_name().unwrap_or_default())))
}
