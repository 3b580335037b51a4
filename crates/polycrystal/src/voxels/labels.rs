//! Labels of voxels.

use glam::DVec3;
use voronoi::Domain;

use crate::{GrainId, Side};

/// The number that stands for no grain.
pub(super) const OUTSIDE: u32 = u32::MAX;

/// What a voxel is part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VoxelLabel(pub(super) u32);

impl VoxelLabel {
    /// No grain: a pore, or what surrounds a body.
    pub const EXTERIOR: Self = Self(OUTSIDE);

    /// A grain.
    ///
    /// # Panics
    /// When the number is 2^32 - 1.
    pub fn of(grain: GrainId) -> Self {
        assert_ne!(grain.0, OUTSIDE, "grains have smaller numbers");
        Self(grain.0)
    }

    /// The grain or the exterior.
    pub fn side(self) -> Side {
        if self == Self::EXTERIOR { Side::Exterior } else { Side::Grain(GrainId(self.0)) }
    }
}

/// Labels of voxels on a regular grid that fills a domain; of pixels in the plane.
#[derive(Debug, Clone)]
pub struct Voxels {
    pub(super) grid: Grid,
    pub(super) labels: Vec<VoxelLabel>,
}

/// A regular grid of voxels that fills a domain.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    pub(super) domain: Domain,
    /// Number of voxels along each axis; 1 along z in the plane.
    pub(super) shape: [usize; 3],
}

impl Voxels {
    /// Labels, x fastest, of a box. In the plane there is one voxel along z. Along the periods of the box, the last voxels touch the first.
    ///
    /// # Panics
    /// When the domain is no box, or when there is not one label for each voxel.
    pub fn new(domain: Domain, shape: [usize; 3], labels: Vec<VoxelLabel>) -> Self {
        assert!(domain.is_box(), "voxels fill a box");
        assert_eq!(labels.len(), shape.iter().product::<usize>(), "each voxel has a label");
        Self { grid: Grid { domain, shape }, labels }
    }

    /// The box.
    pub fn domain(&self) -> &Domain {
        &self.grid.domain
    }

    /// Number of voxels along each axis.
    pub fn shape(&self) -> [usize; 3] {
        self.grid.shape
    }

    /// The label of each voxel, x fastest.
    pub fn labels(&self) -> &[VoxelLabel] {
        &self.labels
    }
}

impl Grid {
    /// Edges of a voxel along each axis; 1 along z in the plane.
    pub(super) fn spacing(&self) -> DVec3 {
        let counts = DVec3::from_array(self.shape.map(|count| count as f64));
        let spacing = self.domain.size() / counts;
        match self.domain.dimension() {
            voronoi::Dimension::Two => spacing.with_z(1.0),
            voronoi::Dimension::Three => spacing,
        }
    }

    /// The box in units of voxels.
    pub(super) fn in_voxels(&self) -> Domain {
        let upper = DVec3::from_array(self.shape.map(|count| count as f64));
        let domain = match self.domain.dimension() {
            voronoi::Dimension::Two => Domain::rectangle(DVec3::ZERO, upper),
            voronoi::Dimension::Three => Domain::cuboid(DVec3::ZERO, upper),
        };
        domain.expect("there are voxels").with_periods(self.domain.periodic())
    }

    /// Lengths of the periods in voxels; 0 along other axes.
    pub(super) fn periods(&self) -> DVec3 {
        let counts = DVec3::from_array(self.shape.map(|count| count as f64));
        DVec3::select(self.domain.periodic(), counts, DVec3::ZERO)
    }
}
