//! Measured maps: labels of grains on a grid, or orientations point by point, in the files of other programs.

pub(crate) mod cleaning;
mod ebsd;
pub(crate) mod ebsd_options;
pub(crate) mod hdf5;
pub(crate) mod label_map;
pub(crate) mod map_slice;
mod mhd;
mod neighbors;
pub(crate) mod network_options;
mod npy;
mod npz;
mod nrrd;
mod number_type;
pub(crate) mod options;
pub(crate) mod orientation_map;
pub(crate) mod orientations;
mod png;
mod raw;
pub(crate) mod read;
pub(crate) mod sets;
pub(crate) mod slices;
mod stored_numbers;
mod tesr;
mod tiff;
mod vti;
