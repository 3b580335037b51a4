//! The command line of `grainsmooth smooth`.

use std::path::PathBuf;

use crate::MapOptions;
use clap::Args;

use super::files::OutputArguments;
use super::pictures::PictureArguments;
use super::run::SharedArguments;

/// Make a smooth network of a measured map: labels of grains on a grid
///
/// Boundaries bend as little as they can while every voxel stays in its grain, and every grain has the volume of its voxels. Where grains are at least
/// three voxels thick no triangle folds back on its neighbour; how many do elsewhere is told.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct SmoothArguments {
    /// Map to smooth: .vti, .npy, .nrrd, .nhdr, .mhd, .mha, .tesr or .raw
    #[arg(value_name = "MAP")]
    pub map: PathBuf,

    #[command(flatten)]
    pub options: MapOptions,

    #[command(flatten)]
    pub outputs: OutputArguments,

    #[command(flatten)]
    pub pictures: PictureArguments,

    #[command(flatten)]
    pub shared: SharedArguments,
}

const EXAMPLES: &str = "\
Examples:
  grainsmooth smooth labels.vti                                         to grains.vtp
  grainsmooth smooth labels.npy --axes zyx --spacing 0.5 -o grains.vtu  an array of skimage, its unit told
  grainsmooth smooth ct.raw --shape 200 200 150 --type u16 --exterior-label 0

Exit status: 0 good, 1 the map is unreadable or gave no valid network, 2 a mistake on the command line.";
