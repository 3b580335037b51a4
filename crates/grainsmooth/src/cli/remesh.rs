//! The command line of `grainsmooth remesh`.

use std::path::PathBuf;

use crate::ElementOptions;
use clap::Args;

use super::result::ResultArguments;

/// Remesh a network from a file with triangles of one size, for finite elements
///
/// Grains keep their volumes, triple lines and quadruple points stay, and new points lie on the triangles of the file. Grains, their phases and orientations keep their numbers, and what
/// repeats periodically stays periodic.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct RemeshArguments {
    /// Network to remesh: .vtp, .vtu or .vtk with two labels for each triangle, whichever program wrote it; .tess (Neper), .fe or .dmp (Surface Evolver), or .stl or a folder of them
    #[arg(value_name = "FILE")]
    pub file: PathBuf,

    #[command(flatten)]
    pub elements: ElementOptions,

    #[command(flatten)]
    pub result: ResultArguments,
}

const EXAMPLES: &str = "\
Examples:
  grainsmooth remesh grains.vtp --elements-per-grain 5 -o grains.inp   tetrahedra for Abaqus and CalculiX
  grainsmooth remesh grains.vtp --element-size 0.05 -o coarse.vtp      boundaries alone
  grainsmooth smooth labels.vti -o map.vtp && grainsmooth remesh map.vtp --elements-per-grain 4 --volume-mesh -o map.vtu

Exit status: 0 good, 1 the file is unreadable or gave no valid mesh, 2 a mistake on the command line.";
