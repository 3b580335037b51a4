//! Files before anything is in them: paths found writable, text read as lines, and what appears together or not at all.

pub(crate) mod output;
pub(crate) mod staged_files;
pub(crate) mod text_table;
pub(crate) mod unfinished;
