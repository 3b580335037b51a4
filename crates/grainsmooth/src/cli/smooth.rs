//! The command line of `grainsmooth smooth`.

use std::path::PathBuf;

use crate::{MapNetworkOptions, MapOptions};
use clap::Args;

use super::result::ResultArguments;

/// Make a smooth network from a measured map: labels of grains on a grid, or orientations (EBSD)
///
/// Boundaries bend as little as possible while every voxel stays in its grain and every grain has the volume of its voxels. Where grains are at least three voxels
/// thick, no triangle folds back on its neighbour; the summary counts those that do elsewhere. In orientation maps, a grain is a set of neighbouring points with similar
/// orientations.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct SmoothArguments {
    /// Map to smooth: .vti, .npy, .npz, .nrrd, .nhdr, .mhd, .mha, .tesr, .dream3d, .h5, .h5oina, .h5ebsd, .raw, .ang, .ctf or .cpr with .crc; .tif, .tiff or .png; a folder of slices as .tif, .png, .ang or .ctf; or, with --relax, a network: .vtp, .vtu or .vtk with two labels for each triangle, .tess (Neper), .fe or .dmp (Surface Evolver), .stl or a folder of them, or polygons in 2D: .json or .csv
    #[arg(value_name = "MAP")]
    pub map: PathBuf,

    #[command(flatten)]
    pub options: MapOptions,

    #[command(flatten)]
    pub network: MapNetworkOptions,

    #[command(flatten)]
    pub result: ResultArguments,
}

const EXAMPLES: &str = "\
Examples:
  grainsmooth smooth labels.vti                                         to grains.vtp
  grainsmooth smooth labels.npy --axes zyx --spacing 0.5 -o grains.vtu  an array of skimage, its unit told
  grainsmooth smooth ct.raw --shape 200 200 150 --type u16 --exterior-label 0
  grainsmooth smooth slices --spacing 0.5 0.5 0.8                       a folder of numbered images
  grainsmooth smooth sections --align --spacing 0.25 0.25 0.3           a folder of EBSD sections as .ang
  grainsmooth smooth map.ctf --min-voxels 3 -o map.vtp --stats map.csv  grains of an EBSD map, with a table
  grainsmooth smooth map.ang --min-ci 0.1 --min-voxels 5 -o clean.ang    the map as cleaned
  grainsmooth smooth phase_field.vti --periodic x,y,z                   grains go on through the sides of the box
  grainsmooth smooth phase_field.vti --relax equilibrium                boundaries at rest, volumes kept
  grainsmooth smooth network.vtp --relax 0.1 -o relaxed.vtp             a network of any program
  grainsmooth smooth grains --relax equilibrium                         a folder of .stl files, one for each grain
  grainsmooth smooth map.ang --min-ci 0.1 --min-iq 120 --threshold 5 --min-voxels 5

Exit status: 0 good, 1 the map is unreadable or gave no valid network, 2 a mistake on the command line.";
