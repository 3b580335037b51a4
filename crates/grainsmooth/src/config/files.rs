//! How files are written, apart from their formats.

use std::num::NonZeroU32;

use crate::names::Names;
use crate::vtk::VtkEncoding;

/// How files are written, apart from their formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileOptions {
    /// Whose names and numbers arrays have.
    pub names: Names,
    /// Number of voxels along each axis, for formats of voxels; the third is not used in 2D.
    pub voxels: Option<[NonZeroU32; 3]>,
    /// How STL spells its numbers.
    pub stl: StlEncoding,
    /// Whether VTK files have arrays of what is measured.
    pub arrays: bool,
    /// How VTK's XML files hold their numbers.
    pub encoding: VtkEncoding,
}

impl Default for FileOptions {
    fn default() -> Self {
        Self {
            names: Names::default(),
            voxels: None,
            stl: StlEncoding::Binary,
            arrays: false,
            encoding: VtkEncoding::Raw,
        }
    }
}

/// How an STL file spells its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StlEncoding {
    /// 50 bytes for each triangle.
    Binary,
    /// Text.
    Ascii,
}
