//! The command line of `grainsmooth check`.

use std::path::PathBuf;

use clap::Args;

/// Check grain networks: grains closed, orientation consistent, no folds, crossings or duplicate points
///
/// Reads triangles (in the plane: lines) with two labels each, from the cell array FaceLabels, boundary_labels or
/// BoundaryLabels of .vtp, .vtu and .vtk files, whichever program wrote them.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit status: 0 all good, 1 something is wrong or unreadable, 2 a mistake on the command line."
)]
pub struct CheckArguments {
    /// Files to check: .vtp, .vtu or .vtk
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,

    /// Report as JSON: {"files": [...]}
    #[arg(long)]
    pub json: bool,
}
