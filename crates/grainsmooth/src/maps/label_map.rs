//! Labels of grains on a grid, as a file tells them and as they are used.

use std::fmt;

use glam::{BVec3, DVec3};
use texture::{CrystalSymmetry, Orientation};
use voronoi::Domain;

use super::cleaning::{NO_GRAIN, clean};
use super::neighbors::Grid;
use super::options::{Crop, LabelParts, MapOptions};
use super::orientation_map::PointList;
use super::sets::Sets;
use crate::error::map_file::MapProblem;
use crate::figures::significant::significant;

/// Labels of voxels, x fastest; in the plane of pixels, whose grid has one layer.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelMap {
    /// Number of voxels along each axis.
    pub shape: [usize; 3],
    /// Edges of a voxel.
    pub spacing: DVec3,
    /// The lower corner of the first voxel.
    pub origin: DVec3,
    /// The axes along which the map repeats: the last voxels touch the first.
    pub periodic: BVec3,
    /// The label of each voxel: as many as there are voxels.
    pub labels: Vec<i32>,
}

impl LabelMap {
    /// Whether the map is one of pixels.
    pub fn is_plane(&self) -> bool {
        self.shape[2] == 1
    }

    /// The box that the voxels fill.
    ///
    /// # Errors
    /// [`VoronoiError`](voronoi::VoronoiError) where it has no size.
    pub fn domain(&self) -> Result<Domain, voronoi::VoronoiError> {
        let upper = self.origin + self.spacing * DVec3::from_array(self.shape.map(|count| count as f64));
        let domain = if self.is_plane() { Domain::rectangle } else { Domain::cuboid }(self.origin, upper)?;
        Ok(domain.with_periods(self.periodic))
    }

    /// The lower and the upper corner of the box around all grains, whose labels are not below 0.
    pub(crate) fn grain_bounds(&self) -> [DVec3; 2] {
        let [nx, ny, _] = self.shape;
        let grains = self.labels.iter().enumerate().filter(|(_, label)| **label >= 0);
        let bounds = grains.fold([self.shape, [0; 3]], |[lower, upper], (voxel, _)| {
            let at = [voxel % nx, voxel / nx % ny, voxel / (nx * ny)];
            [[0, 1, 2].map(|k| lower[k].min(at[k])), [0, 1, 2].map(|k| upper[k].max(at[k] + 1))]
        });
        bounds.map(|corner| self.origin + self.spacing * DVec3::from_array(corner.map(|at| at as f64)))
    }

    /// The part that is asked for.
    ///
    /// # Errors
    /// [`MapProblem::Crop`].
    fn cropped(self, crop: &Crop) -> Result<Self, MapProblem> {
        let [xs, ys, zs] = crop.ranges(self.shape)?;
        let [nx, ny, _] = self.shape;
        let mut labels = Vec::with_capacity(xs.len() * ys.len() * zs.len());
        for z in zs.clone() {
            for y in ys.clone() {
                let row = (z * ny + y) * nx;
                labels.extend_from_slice(&self.labels[row + xs.start..row + xs.end]);
            }
        }
        let first = DVec3::new(xs.start as f64, ys.start as f64, zs.start as f64);
        Ok(Self {
            shape: [xs.len(), ys.len(), zs.len()],
            origin: self.origin + first * self.spacing,
            spacing: self.spacing,
            periodic: self.periodic,
            labels,
        })
    }

    /// The same without small grains, its grains numbered from 0 in the order of their labels, and parts of one label in the order of their first voxels.
    ///
    /// # Errors
    /// [`MapProblem::NoGrain`].
    fn cleaned(mut self, options: &MapOptions) -> Result<MeasuredMap, MapProblem> {
        for label in &mut self.labels {
            if *label < 0 || Some(*label) == options.exterior_label {
                *label = NO_GRAIN;
            }
        }
        let grid = Grid::Voxels(self.shape, self.periodic);
        let label_of_part = match options.parts {
            LabelParts::Keep => None,
            LabelParts::Split => Some(split(&mut self.labels, grid)),
        };
        let is_hole = vec![false; self.labels.len()];
        let cleaned = clean(&mut self.labels, is_hole, grid, options.min_voxels)?;
        let label = |kept: i32| {
            let kept = kept.cast_unsigned();
            label_of_part.as_ref().map_or(kept, |labels| labels[kept as usize])
        };
        let labels = cleaned.kept.into_iter().map(label).collect();
        Ok(MeasuredMap {
            map: self,
            labels,
            voxel_counts: cleaned.counts,
            dropped: cleaned.dropped,
            crystals: None,
        })
    }
}

/// Gives each part of a label that hangs together through faces a number of its own, in the order of labels and first voxels, and returns the label of each.
fn split(labels: &mut [i32], grid: Grid) -> Vec<u32> {
    let mut sets = Sets::new(labels.len());
    for (place, label) in labels.iter().enumerate() {
        for other in grid.neighbors(place).filter(|other| labels[*other] == *label) {
            sets.join(place, other);
        }
    }
    let parts = sets.numbers(|place| labels[place] != NO_GRAIN);
    let mut known: Vec<(i32, i32)> = labels.iter().copied().zip(parts.iter().copied()).collect();
    known.retain(|(_, part)| *part != NO_GRAIN);
    known.sort_unstable();
    known.dedup();
    let mut numbers = vec![NO_GRAIN; known.len()];
    for (number, (_, part)) in (0..).zip(&known) {
        numbers[part.cast_unsigned() as usize] = number;
    }
    for (label, part) in labels.iter_mut().zip(parts) {
        *label = usize::try_from(part).map_or(NO_GRAIN, |part| numbers[part]);
    }
    known.into_iter().map(|(label, _)| label.cast_unsigned()).collect()
}

/// What programs call the labels of grains: DREAM.3D, DAMASK and Neper, ParaView's filters, this program, LabDCT.
pub(super) const USUAL_NAMES: [&str; 7] =
    ["FeatureIds", "material", "labels", "GrainId", "GrainIds", "grain_id", "MaterialId"];

/// What a file tells of a map. Labels stand x fastest; without spacing or origin the file tells none.
pub(super) struct FileMap {
    pub(super) shape: [usize; 3],
    pub(super) spacing: Option<DVec3>,
    pub(super) origin: Option<DVec3>,
    pub(super) labels: Vec<i32>,
}

/// What a file holds that may have either.
pub(super) enum MapContent {
    Labels(FileMap),
    Points(PointList),
}

/// What is known of measured grains.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredMap {
    /// The labels as cleaned: below 0 what is no grain, others from 0 on, with none left out.
    pub map: LabelMap,
    /// The label in the file of each grain; where orientations make the grains, their numbers before small ones were dropped.
    pub labels: Vec<u32>,
    /// Number of voxels, pixels or points of each grain.
    pub voxel_counts: Vec<u64>,
    /// Grains with fewer voxels than are asked for, which went to others, and their voxels.
    pub dropped: [u64; 2],
    /// What a map of orientations tells.
    pub crystals: Option<MeasuredCrystals>,
}

impl MeasuredMap {
    /// The grains of labels in memory, cropped and cleaned as options say.
    ///
    /// # Errors
    /// [`MapProblem`] where labels and options do not go together.
    pub fn of_labels(mut map: LabelMap, options: &MapOptions) -> Result<Self, MapProblem> {
        map.periodic |= options.periodic.unwrap_or_default();
        if map.is_plane() && map.periodic.z {
            return Err(MapProblem::Unfit {
                what: "is a map of pixels, which does not repeat along z",
                remedy: "give x, y or x,y with --periodic",
            });
        }
        if let Some(crop) = &options.crop {
            map = map.cropped(crop)?;
        }
        map.cleaned(options)
    }
}

/// What a map of orientations tells of its grains.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredCrystals {
    /// The phases of the file by name, and the symmetry of their crystals.
    pub phases: Vec<(String, CrystalSymmetry)>,
    /// Index of each grain's phase.
    pub phase_of: Vec<usize>,
    /// The mean orientation of each grain.
    pub orientations: Vec<Orientation>,
    /// The mean angle between the points of each grain and its mean orientation, in degrees.
    pub spreads: Vec<f64>,
    /// How the points became grains.
    pub points: PointCounts,
}

/// How the points of a map of orientations became grains: in words with [`Display`](fmt::Display).
#[derive(Debug, Clone, PartialEq)]
pub struct PointCounts {
    /// Points of each row, rows, and sections.
    pub shape: [usize; 3],
    /// Sections that were shifted against the first.
    pub shifted: usize,
    /// Whether every second row is shifted by half a step.
    pub is_hexagonal: bool,
    /// Between neighbours along a row, in the unit of the map.
    pub step: f64,
    /// Points without a solution.
    pub unsolved: u64,
    /// Points with a solution that is too uncertain.
    pub masked: u64,
    /// Points of both kinds that lie in pores, which were left open.
    pub pores: u64,
    /// Grains before small ones were dropped.
    pub grains: u64,
    /// Grains that are twins of others and became one with them.
    pub merged: u64,
    /// What the header of the file says of its points that they do not, in words.
    pub contradicted: Option<String>,
}

impl fmt::Display for PointCounts {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            shape: [columns, rows, sections],
            shifted,
            is_hexagonal,
            step,
            unsolved,
            masked,
            pores,
            grains,
            merged,
            contradicted,
        } = self;
        let lattice = if *is_hexagonal { "a hexagonal" } else { "a square" };
        write!(out, "{columns} x {rows} points")?;
        if *sections > 1 {
            write!(out, " in each of {sections} sections")?;
        }
        write!(out, " on {lattice} grid, step {}, in {grains} grains", significant(*step, 6))?;
        if *shifted > 0 {
            write!(out, ", {shifted} sections shifted")?;
        }
        if *merged > 0 {
            write!(out, ", after {merged} twins became one with others")?;
        }
        if *unsolved > 0 {
            write!(out, "; {unsolved} points without a solution")?;
        }
        if *masked > 0 {
            write!(out, "; {masked} too uncertain")?;
        }
        if *pores > 0 {
            write!(out, "; {pores} in pores")?;
        }
        match contradicted {
            Some(told) => write!(out, "; its head says {told}, which its points do not bear out"),
            None => Ok(()),
        }
    }
}
