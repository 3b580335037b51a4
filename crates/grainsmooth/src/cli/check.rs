//! The command line of `grainsmooth check`.

use std::path::PathBuf;

use clap::{Arg, Args};

use crate::MapOptions;

/// Check grain networks: grains closed, orientation consistent, no folds, crossings or duplicate points; and volume meshes
///
/// Reads triangles (in the plane: lines) with two labels each, from the cell array FaceLabels, boundary_labels or
/// BoundaryLabels of .vtp, .vtu and .vtk files, whichever program wrote them. Also reads tetrahedra, in the plane triangles that fill grains, from .inp, .msh, .bdf and .vtu: they must fit together, none inverted, sets of grains, sides and
/// boundaries must be complete, and nodes tied to others whole periods away.
#[derive(Debug, Args)]
#[command(
    mut_args = of_map,
    after_help = "Exit status: 0 all good, 1 something is wrong or unreadable, 2 a mistake on the command line."
)]
pub struct CheckArguments {
    /// Files to check: .vtp, .vtu, .vtk, .tess, .fe, .dmp, .stl or a folder of them, .json or .csv; volume meshes: .inp, .msh, .bdf or .vtu
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,

    /// Report as JSON: {"files": [...]}
    #[arg(long)]
    pub json: bool,

    /// Map of labels or orientations to compare with, as for `grainsmooth smooth`: reports the voxels that lie in another grain, volumes and distances
    ///
    /// Example: grainsmooth check grains.vtp --labels map.vti --exterior-label 0
    #[arg(long, value_name = "MAP")]
    pub labels: Option<PathBuf>,

    #[command(flatten)]
    pub options: MapOptions,
}

/// Options of a map need one.
fn of_map(argument: Arg) -> Arg {
    let is_of_map = argument.get_help_heading().is_some_and(|heading| heading.starts_with("Map"));
    if is_of_map { argument.requires("labels") } else { argument }
}
