//! The picture and the page of a run.

use std::path::Path;

use grainsmooth::{Error, Html, Output, Png, Scene, ScenePicture, SceneReport, StagedFiles};

use grainsmooth::cli::mesh::FileArguments;

/// Where a run shows its result, found writable.
pub(super) struct Shown {
    picture: Option<(ScenePicture, Output<Png>)>,
    report: Option<Output<Html>>,
}

/// What there is to show.
pub(super) struct Scenes {
    /// What was read.
    pub(super) before: Scene,
    /// What was made; several for a picture that moves.
    pub(super) levels: Vec<Scene>,
}

impl Shown {
    pub(super) fn new(files: &FileArguments) -> Result<Self, Error> {
        Ok(Self { picture: files.shown.picture()?, report: files.shown.report()? })
    }

    pub(super) fn is_any(&self) -> bool {
        self.picture.is_some() || self.report.is_some()
    }

    pub(super) fn paths(&self) -> impl Iterator<Item = &Path> {
        let picture = self.picture.iter().map(|(_, output)| output.path());
        picture.chain(self.report.iter().map(Output::path))
    }

    /// Completes both. `lines` are what the run says.
    pub(super) fn stage(
        &self,
        scenes: &Scenes,
        command: &str,
        lines: &[String],
        files: &mut StagedFiles,
    ) -> Result<(), Error> {
        let Scenes { before, levels } = scenes;
        if let Some((picture, output)) = &self.picture {
            picture.stage(levels, command, output, files)?;
        }
        match &self.report {
            Some(output) => SceneReport { command, lines, before, levels }.stage(output, files),
            None => Ok(()),
        }
    }
}
