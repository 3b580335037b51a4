//! What a page shows.

use std::path::PathBuf;

use super::answer::Answer;
use super::grains::Grains;
use crate::Error;

/// What a server shows: the grains of some files, or what is edited.
#[derive(Debug)]
pub struct PageDocument(Kind);

#[derive(Debug)]
enum Kind {
    Grains(Grains),
}

impl PageDocument {
    /// Networks of grains to look at: of one file, or one after the other of several, or of a collection (.pvd). The first is read.
    ///
    /// # Errors
    /// As of [`LabelledFile::read`](crate::LabelledFile::read); [`Error::Collection`].
    pub fn grains(paths: &[PathBuf]) -> Result<Self, Error> {
        Grains::open(paths).map(|grains| Self(Kind::Grains(grains)))
    }

    /// A number that grows with each change.
    pub(super) fn revision(&self) -> u64 {
        match &self.0 {
            Kind::Grains(_) => 0,
        }
    }

    /// What a command says.
    pub(super) fn answer(&mut self, path: &str, body: &[u8]) -> Answer {
        let said = match &mut self.0 {
            Kind::Grains(grains) => grains.answer(path, body),
        };
        said.unwrap_or_else(|refusal| refusal.0)
    }
}
