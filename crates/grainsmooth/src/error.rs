use std::io;
use std::path::PathBuf;

use crate::OutputFormat;

/// What can go wrong between the user's input and the files written. Each message is one line that names the
/// value, the place and the remedy.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The output path has no extension, or one that names no format.
    #[error("{}: unknown extension; name the file {}", path.display(), OutputFormat::known_extensions())]
    UnknownExtension {
        /// The path as given.
        path: PathBuf,
    },
    /// The directory that the output shall go to does not exist.
    #[error("{}: no directory {}; create it or choose another path", path.display(), directory.display())]
    NoOutputDirectory {
        /// The path as given.
        path: PathBuf,
        /// The missing directory.
        directory: PathBuf,
    },
    /// The output path is taken by something that is not a regular file.
    #[error("{}: is not a regular file; choose another path", path.display())]
    OutputNotAFile {
        /// The path as given.
        path: PathBuf,
    },
    /// Nothing can be written under the output path.
    #[error("{}: cannot be written: {source}; allow it or choose another path", path.display())]
    OutputNotWritable {
        /// The path as given.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Writing the output failed on the way; nothing of it is left behind.
    #[error("{}: writing failed and left nothing: {source}; make room or choose another path", path.display())]
    WriteOutput {
        /// The path as given.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}
