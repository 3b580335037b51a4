//! Physical groups of boundaries: those between grains each have their own; those at a side of the box have that of the side.

use std::collections::BTreeMap;
use std::io::{self, Write};

use polycrystal::BoundaryId;

use super::tag;
use crate::Polycrystal;
use crate::names::side_of_box;

/// The physical surfaces, in the plane curves.
pub(super) struct Groups {
    /// The number of each boundary's group: its own, counted from 1, or that of the side of the box.
    pub(super) of_boundary: Vec<usize>,
    /// The sides of the box, by name, with the numbers of their groups.
    sides: BTreeMap<String, usize>,
}

impl Groups {
    pub(super) fn of(polycrystal: &Polycrystal) -> Self {
        let network = &polycrystal.network;
        let boundaries = network.boundaries();
        let side = |wall| side_of_box(network.domain(), wall);
        let mut sides: BTreeMap<String, usize> =
            boundaries.iter().filter_map(|boundary| Some((side(boundary.wall?)?, 0))).collect();
        for (number, group) in (boundaries.len() + 1..).zip(sides.values_mut()) {
            *group = number;
        }
        let numbered = (0u32..).map(BoundaryId).zip(boundaries);
        let group = |(id, boundary): (BoundaryId, &polycrystal::Boundary)| {
            boundary.wall.and_then(side).map_or(tag(id), |side| sides[&side])
        };
        Self { of_boundary: numbered.map(group).collect(), sides }
    }

    /// Writes the names: `grain0`, `boundary0` and `x0`, where boundaries have a dimension.
    pub(super) fn write_names(
        &self,
        grain_count: usize,
        dimension: usize,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let boundaries = (0..).zip(&self.of_boundary).filter(|(boundary, group)| **group == boundary + 1);
        let boundaries = boundaries.map(|(boundary, group)| (format!("boundary{boundary}"), *group));
        let surfaces: Vec<(String, usize)> =
            boundaries.chain(self.sides.iter().map(|(side, group)| (side.clone(), *group))).collect();
        writeln!(out, "$PhysicalNames\n{}", surfaces.len() + grain_count)?;
        surfaces.iter().try_for_each(|(name, group)| writeln!(out, "{dimension} {group} \"{name}\""))?;
        (0..grain_count)
            .try_for_each(|grain| writeln!(out, "{} {} \"grain{grain}\"", dimension + 1, grain + 1))?;
        writeln!(out, "$EndPhysicalNames")
    }
}
