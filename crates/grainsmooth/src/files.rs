//! Files before anything is in them: paths found writable, text read as lines, and what appears together or not at all.

pub(crate) mod output;
pub(crate) mod staged_files;
pub(crate) mod text_table;
pub(crate) mod unfinished;

use std::path::Path;

use crate::Error;

/// What messages call a file that is read as text.
pub(crate) const TEXT_FILE: &str = "text file";

/// The content of a file of input, which a message calls by what it should be.
///
/// # Errors
/// [`Error::Unreadable`].
pub(crate) fn read_input(path: &Path, kind: &'static str) -> Result<Vec<u8>, Error> {
    std::fs::read(path).map_err(|cause| Error::Unreadable { path: path.to_owned(), kind, cause })
}
