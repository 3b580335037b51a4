//! Numbers in the lines of a text file.

use std::str::{FromStr, SplitWhitespace};

use glam::DVec3;

use super::MeshFileProblem;

/// Words of a line longer than this are cut in messages.
const LONGEST_WORD: usize = 40;

/// The words of one line, and which line it is, from 0.
pub(super) struct Words<'a> {
    pub(super) index: usize,
    pub(super) words: SplitWhitespace<'a>,
}

impl Words<'_> {
    /// The next word as a number of any kind; `what` says what it stands for.
    pub(super) fn number<T: FromStr>(&mut self, what: &str) -> Result<T, MeshFileProblem> {
        let Some(word) = self.words.next() else {
            return Err(self.problem(format!("ends before {what}")));
        };
        word.parse().map_err(|_| self.problem(format!("'{}' is not {what}", short(word))))
    }

    /// The next three words as a point.
    pub(super) fn point(&mut self) -> Result<DVec3, MeshFileProblem> {
        let mut point = DVec3::ZERO;
        for (coordinate, what) in
            point.as_mut().iter_mut().zip(["an x coordinate", "a y coordinate", "a z coordinate"])
        {
            *coordinate = self.number(what)?;
            if !coordinate.is_finite() {
                return Err(self.problem(format!("{coordinate} is {what} that is not finite")));
            }
        }
        Ok(point)
    }

    pub(super) fn problem(&self, what: impl Into<String>) -> MeshFileProblem {
        MeshFileProblem::line(self.index, what)
    }
}

/// A word as messages show it.
pub(super) fn short(word: &str) -> String {
    if word.chars().count() > LONGEST_WORD {
        word.chars().take(LONGEST_WORD).chain("...".chars()).collect()
    } else {
        word.to_owned()
    }
}
