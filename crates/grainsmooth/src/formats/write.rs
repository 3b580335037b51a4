//! Writing a polycrystal, in whatever format.

use std::io::{self, Write};

use polycrystal::GrainId;
use rayon::prelude::*;

use super::format::{GrainSurface, Writer};
use super::output::{Output, OutputDirectory};
use super::output_format::{OutputFormat, ToWrite};
use crate::error::Error;
use crate::files::staged_files::{StagedFiles, write_together};
use crate::run::polycrystal::Polycrystal;

impl Polycrystal {
    /// What a format would have to hold.
    pub fn to_write(&self) -> ToWrite {
        ToWrite {
            dimension: self.dimension(),
            voxels: self.file().voxel_count(self.dimension()),
            has_map: self.voxels_of_map().is_some(),
            has_orientations: self.grains().texture.is_some(),
            has_cells: self.synthesis().is_some_and(|made| !made.config.has_grains_of_several_cells()),
            has_element_size: self.elements.is_some(),
            volume: self.file().volume,
        }
    }

    /// Writes the network, every boundary and every point once; its voxels; or its flat cells.
    ///
    /// In the plane each boundary is one polyline. VTK files are written with the arrays `FaceLabels`, `BoundaryId`,
    /// `NodeTypes`, `Generation` and `NumberOfGrains`, and say by which version, command line and random seed they were made.
    ///
    /// Grains of a periodic domain are whole. A boundary between grains a period apart comes at both; its second label is -2 - b
    /// with the `BoundaryId` b of the other one. The cell array `PeriodicNeighbor` has the grain there (-1 elsewhere), the
    /// point array `PeriodicOriginal` the point that each is a copy of, its own number where it is none.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; nothing is left behind then. As of [`Output::check_holds`] and [`OutputFormat::check_voxels`].
    pub fn write(&self, output: &Output) -> Result<(), Error> {
        write_together(|files| self.stage(output, files))
    }

    /// Completes an output, as one of several that appear together.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; [`Error::OutputTwice`]; as of [`Output::check_holds`] and [`OutputFormat::check_voxels`].
    pub fn stage(&self, output: &Output, files: &mut StagedFiles) -> Result<(), Error> {
        let to_write = self.to_write();
        output.check_holds(&to_write)?;
        output.format().check_voxels(&to_write)?;
        match output.format().writer() {
            Writer::File(write) => output.stage(files, |out| write(self, out)),
            Writer::Files(stage) => stage(self, &output.as_format(()), files),
        }
    }

    /// Writes a format that is a single file.
    ///
    /// # Errors
    /// Whatever `out` reports; that the format is several files, or cannot hold this polycrystal.
    pub fn write_to(&self, format: OutputFormat, out: &mut dyn Write) -> io::Result<()> {
        match format.writer() {
            Writer::File(write) => write(self, out),
            Writer::Files(_) => Err(io::Error::other("several files are not written as one")),
        }
    }

    /// Completes a file for each grain that is left, `grain_0.vtp` and so on: its closed surface, all normals outward.
    ///
    /// # Errors
    /// [`Error::WriteOutput`]; [`Error::OutputTwice`]; [`Error::FormatDimension`] in 2D.
    pub fn stage_grains(&self, directory: &OutputDirectory, files: &mut StagedFiles) -> Result<(), Error> {
        directory.check_dimension(self.dimension())?;
        let failed = |cause| Error::WriteOutput { path: directory.path().to_owned(), cause };
        let network = self.surface().map_err(failed)?;
        let parts = network.parts_of_grains(self.network.grain_count());
        let format = directory.format();
        let Some(write) = format.grain_writer() else {
            return Err(failed(io::Error::other("this format is not for surfaces of single grains")));
        };
        let tuples = self.grain_tuples();
        directory.stage(files, |folder| {
            // What has vanished has no surface.
            let grains: Vec<_> = (0u32..).zip(&parts).filter(|(_, parts)| !parts.is_empty()).collect();
            grains.into_par_iter().try_for_each(|(id, parts)| {
                let surface = network.grain(GrainId(id), parts);
                let name = format!("grain_{id}.{}", format.extension());
                let mut out = io::BufWriter::new(std::fs::File::create(folder.join(name))?);
                let file = GrainSurface {
                    polycrystal: self,
                    surface: &surface,
                    grain: GrainId(id),
                    tuples: &tuples,
                };
                write(&file, &mut out)?;
                out.flush()
            })
        })
    }
}
