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
    domain: Domain,
    shape: [usize; 3],
    labels: Vec<VoxelLabel>,
}

impl Voxels {
    /// Labels, x fastest, of a box. In the plane there is one voxel along z. Along the periods of the box, the last voxels touch the first.
    ///
    /// # Panics
    /// When the domain is no box, or when there is not one label for each voxel.
    pub fn new(domain: Domain, shape: [usize; 3], labels: Vec<VoxelLabel>) -> Self {
        assert!(domain.is_box(), "voxels fill a box");
        assert_eq!(labels.len(), shape.iter().product::<usize>(), "each voxel has a label");
        Self { domain, shape, labels }
    }

    /// The box.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Number of voxels along each axis.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// The label of each voxel, x fastest.
    pub fn labels(&self) -> &[VoxelLabel] {
        &self.labels
    }

    /// Edges of a voxel along each axis; 1 along z in the plane.
    pub(super) fn spacing(&self) -> DVec3 {
        let counts = DVec3::from_array(self.shape.map(|count| count as f64));
        let spacing = self.domain.size() / counts;
        match self.domain.dimension() {
            voronoi::Dimension::Two => spacing.with_z(1.0),
            voronoi::Dimension::Three => spacing,
        }
    }
}
