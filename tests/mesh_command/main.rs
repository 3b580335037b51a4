//! `grainsmooth mesh` as its users meet it: run as a process, judged by what it prints, returns and writes.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod bad_meshes;
mod corrupt_files;
mod curves;
mod data;
mod edits;
mod formats;
#[allow(dead_code, reason = "shared with other tests")]
#[path = "../common/programs.rs"]
mod programs;
#[path = "../formats/quiet_reader.rs"]
mod quiet_reader;
mod references;
mod shapes;
mod shown;
#[allow(dead_code, reason = "shared with the tests of the command line")]
#[path = "../command_line/workplace.rs"]
mod workplace;
