//! What a map's file does not say, and what is to be read of it.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use glam::{BVec3, DVec3};

use super::ebsd_options::EbsdOptions;
use super::number_type::NumberType;
use crate::error::map_file::MapProblem;
use crate::spelling::{axes, whole_number};

/// How a map is read.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Map")]
pub struct MapOptions {
    /// Array of the labels, if a file has several [default: the only integer array, or one with a usual name]
    ///
    /// Example: grainsmooth smooth map.vti --label-array FeatureIds
    #[arg(long, value_name = "NAME")]
    pub label_array: Option<String>,

    /// Edge of a voxel, one length or one along each axis [default: as the file says, else 1]
    ///
    /// Example: grainsmooth smooth map.npy --spacing 0.5 0.5 0.8
    #[arg(long, value_names = ["DX", "DY", "DZ"], num_args = 1..=3, value_parser = positive, allow_negative_numbers = true)]
    pub spacing: Option<Vec<f64>>,

    /// Order of the indices of an array: xyz, as in labels[x, y, z], or zyx [default: xyz]
    ///
    /// Example: grainsmooth smooth map.npy --axes zyx
    #[arg(long, value_name = "ORDER", value_enum)]
    pub axes: Option<Axes>,

    /// Number of voxels along each axis, for files that hold only numbers; x varies fastest
    ///
    /// Example: grainsmooth smooth map.raw --shape 200 200 150 --type u16
    #[arg(long, value_names = ["NX", "NY", "NZ"], num_args = 2..=3, value_parser = whole_number(1..=65_536_u32), allow_negative_numbers = true)]
    pub shape: Option<Vec<u32>>,

    /// Type of the numbers in such a file, little-endian: u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64
    ///
    /// Example: grainsmooth smooth map.raw --shape 200 200 150 --type u16
    #[arg(long = "type", value_name = "TYPE")]
    pub number_type: Option<NumberType>,

    /// Part of the map: along each axis, the first voxel and the one after the last, from 0; in orientation maps, rows count from the top
    ///
    /// Example: grainsmooth smooth map.vti --crop 0:64,0:64,10:40
    #[arg(long, value_name = "X0:X1,Y0:Y1,Z0:Z1")]
    pub crop: Option<Crop>,

    /// Label of everything that is not a grain, such as pores or the surroundings; negative labels are never grains
    ///
    /// Example: grainsmooth smooth map.vti --exterior-label 0
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub exterior_label: Option<i32>,

    /// Least number of voxels, pixels or points of a grain; those of smaller grains go to the neighbours that they touch most
    ///
    /// Example: grainsmooth smooth map.vti --min-voxels 8
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole_number(1..=u64::MAX), allow_negative_numbers = true)]
    pub min_voxels: u64,

    /// What becomes of a label whose voxels hang together in several parts: one grain of several bodies (`keep`), or a grain for each part (`split`)
    ///
    /// Voxels hang together through their faces. `SeedId` is the label of all parts.
    ///
    /// Example: grainsmooth smooth map.vti --parts split --min-voxels 8
    #[arg(long, value_name = "RULE", value_enum, default_value_t)]
    pub parts: LabelParts,

    /// Axes along which the map repeats, such as x,y,z: its last voxels touch the first, and grains stay whole [default: none]
    ///
    /// Example: grainsmooth smooth phase_field.vti --periodic x,y,z
    #[arg(long, value_name = "AXES", value_parser = axes, conflicts_with = "crop")]
    pub periodic: Option<BVec3>,

    /// How grains are found in a map of orientations.
    #[command(flatten)]
    pub ebsd: EbsdOptions,
}

impl MapOptions {
    /// The first option that is given. Those that are not tell what files say, or what is usual.
    pub fn first_given(&self) -> Option<&'static str> {
        let all = [
            ("--label-array", self.label_array.is_some()),
            ("--spacing", self.spacing.is_some()),
            ("--axes", self.axes.is_some()),
            ("--shape", self.shape.is_some()),
            ("--type", self.number_type.is_some()),
            ("--crop", self.crop.is_some()),
            ("--exterior-label", self.exterior_label.is_some()),
            ("--min-voxels", self.min_voxels > 1),
            ("--parts", self.parts != LabelParts::Keep),
            ("--periodic", self.periodic.is_some()),
        ];
        let first = all.into_iter().find(|(_, is_given)| *is_given).map(|(name, _)| name);
        first.or_else(|| self.ebsd.first_given())
    }

    /// The edges of a voxel, where they are given.
    pub(super) fn spacing(&self) -> Option<DVec3> {
        Some(match self.spacing.as_deref()? {
            &[x, y, z] => DVec3::new(x, y, z),
            // The third is not used in the plane.
            &[x, y] => DVec3::new(x, y, x),
            edges => DVec3::splat(edges.first().copied().unwrap_or(1.0)),
        })
    }
}

/// The order of the indices of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Axes {
    /// x first.
    Xyz,
    /// x last.
    Zyx,
}

/// What becomes of a label in several parts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum LabelParts {
    /// One grain of several bodies.
    #[default]
    Keep,
    /// A grain for each.
    Split,
}

/// A part of a map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Crop(Vec<Range<usize>>);

impl Crop {
    /// The part of so many voxels along each axis.
    ///
    /// # Errors
    /// [`MapProblem::Crop`] where it is no part of them.
    pub(super) fn ranges(&self, shape: [usize; 3]) -> Result<[Range<usize>; 3], MapProblem> {
        let range = |axis: usize| {
            let count = shape[axis];
            let range = self.0.get(axis).cloned().unwrap_or(0..count);
            if range.end <= count {
                return Ok(range);
            }
            let axis = ['x', 'y', 'z'][axis];
            Err(MapProblem::Crop { axis, count, first: range.start, end: range.end })
        };
        Ok([range(0)?, range(1)?, range(2)?])
    }
}

impl FromStr for Crop {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let range = |part: &str| {
            let (first, end) = part.split_once(':')?;
            let range = first.trim().parse().ok()?..end.trim().parse().ok()?;
            (range.start < range.end).then_some(range)
        };
        let ranges: Option<Vec<Range<usize>>> = text.split(',').map(range).collect();
        let ranges = ranges.filter(|ranges| (2..=3).contains(&ranges.len()));
        ranges.map(Self).ok_or_else(|| {
            "give the first voxel and the first one behind along each axis, as in 0:64,0:64,10:40".to_owned()
        })
    }
}

impl fmt::Display for Crop {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ranges: Vec<String> =
            self.0.iter().map(|range| format!("{}:{}", range.start, range.end)).collect();
        out.write_str(&ranges.join(","))
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let length = text.parse().ok().filter(|length: &f64| length.is_finite() && *length > 0.0);
    length.ok_or_else(|| "give a positive, finite length".to_owned())
}
