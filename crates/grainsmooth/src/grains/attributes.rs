//! What is known of each grain, wherever grains come from.

use std::borrow::Cow;

use texture::CrystalSymmetry;

use super::inner::Parents;
use super::phases::GrainPhases;
use super::texture::GrainTexture;
use crate::names::{SPREAD, VOXEL_COUNT};
use crate::vtk::ItemTuples;

/// What grains are besides their shapes. All lists are in the order of the grains.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainAttributes {
    /// The number of each grain's seed, as its file gives it, else in the order in which all were given, from 0: what `SeedId` holds. Where grains are
    /// divided, seeds are those of their parts.
    pub ids: Vec<u32>,
    /// The grains that these are parts of, where some are divided.
    pub parents: Option<Parents>,
    /// The phases of the grains, where they are known.
    pub phases: Option<GrainPhases>,
    /// The symmetry of all crystals, where no phases are known.
    pub symmetry: CrystalSymmetry,
    /// The orientations of the grains, where they are known.
    pub texture: Option<GrainTexture>,
    /// What a map tells of the grains, where they come from one.
    pub measured: Option<MeasuredAttributes>,
}

/// What a map tells of each grain beside phase and orientation.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredAttributes {
    /// Number of voxels, pixels or points.
    pub voxel_counts: Vec<u64>,
    /// Grain orientation spread: the mean angle between the points of a grain and its mean orientation, in degrees.
    pub spreads: Option<Vec<f64>>,
}

impl MeasuredAttributes {
    /// What files hold of each grain.
    pub(crate) fn arrays(&self) -> impl Iterator<Item = ItemTuples> {
        let counts = self.voxel_counts.iter().map(|count| [i32::try_from(*count).unwrap_or(i32::MAX)]);
        let spreads = self.spreads.iter();
        let spreads = spreads.map(|all| ItemTuples::new(SPREAD, all.iter().map(|spread| [*spread])));
        std::iter::once(ItemTuples::new(VOXEL_COUNT, counts)).chain(spreads)
    }
}

impl GrainAttributes {
    /// Index of each grain's phase; 0 without phases.
    pub(crate) fn phase_of(&self) -> Vec<usize> {
        match &self.phases {
            Some(phases) => phases.phase_of().to_vec(),
            None => vec![0; self.ids.len()],
        }
    }

    /// The name of each phase and the symmetry of its crystals; without phases one that is called `grains`.
    pub(crate) fn named_symmetries(&self) -> Vec<(String, CrystalSymmetry)> {
        match &self.phases {
            Some(phases) => phases.names().map(str::to_owned).zip(phases.symmetries()).collect(),
            None => vec![("grains".to_owned(), self.symmetry)],
        }
    }

    /// What grains have, added up by the grains that were drawn: those that are divided as wholes.
    pub(crate) fn by_parents<'a>(&self, of_grains: &'a [f64]) -> Cow<'a, [f64]> {
        match &self.parents {
            Some(parents) => parents.sums(of_grains).into(),
            None => of_grains.into(),
        }
    }

    /// The numbers of the grains' seeds, for formats that tell them only where they are not those of the grains; else nothing.
    pub(crate) fn renumbered(&self) -> &[u32] {
        let is_renumbered = (0u32..).zip(&self.ids).any(|(grain, id)| grain != *id);
        if is_renumbered { &self.ids } else { &[] }
    }
}
