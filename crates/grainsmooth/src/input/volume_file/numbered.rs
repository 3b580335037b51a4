//! Words and numbers of text files, and what they call nodes.

use std::collections::BTreeMap;
use std::str::FromStr;

use crate::mesh::file::MeshFileProblem;

/// The number that a word in a line, counted from 0, stands for.
pub(super) fn number<T: FromStr>(line: usize, word: &str) -> Result<T, MeshFileProblem> {
    let word = word.trim();
    word.parse().map_err(|_| MeshFileProblem::line(line, format!("'{word}' is no number that fits here")))
}

/// The places of things by what a file calls them.
#[derive(Debug, Default)]
pub(super) struct Places {
    kind: &'static str,
    by_number: BTreeMap<u64, u32>,
}

impl Places {
    pub(super) fn new(kind: &'static str) -> Self {
        Self { kind, by_number: BTreeMap::new() }
    }

    /// Notes that the next place has a number, told in some line.
    pub(super) fn push(&mut self, line: usize, number: u64) -> Result<(), MeshFileProblem> {
        let place = u32::try_from(self.by_number.len())
            .map_err(|_| MeshFileProblem::line(line, format!("more {}s than ids can name", self.kind)))?;
        match self.by_number.insert(number, place) {
            None => Ok(()),
            Some(_) => {
                Err(MeshFileProblem::line(line, format!("{} {number} comes a second time", self.kind)))
            }
        }
    }

    /// The place of what a word in some line names.
    pub(super) fn of(&self, line: usize, word: &str) -> Result<u32, MeshFileProblem> {
        let number = number(line, word)?;
        let place = self.by_number.get(&number).copied();
        place.ok_or_else(|| MeshFileProblem::line(line, format!("there is no {} {number}", self.kind)))
    }
}

/// An element has another number of nodes than its kind.
pub(super) fn wrong_node_count(line: usize, count: usize, wanted: usize) -> MeshFileProblem {
    MeshFileProblem::line(line, format!("an element has {count} nodes in place of {wanted}"))
}
