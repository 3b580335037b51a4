//! How small the grains around a place are.
//!
//! Under curvature flow a grain of size l changes within a time of order l^2. A step that suits the mean grain turns over those a
//! thousandth of it across, whatever solves it. So what is around small grains flows slower, as if in its own units of length: mass
//! grows as one over the square of the size, and lengths that count as short shrink with it.

use rayon::prelude::*;
use voronoi::{Dimension, Side};

use crate::energy::patches::Patches;
use crate::mesh::id::id;
use crate::{Boundary, CellComplex, Network, Volumes};

/// Sizes of grains, in units of a share of the mean, at most 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LocalSize {
    dimension: Dimension,
    unit: f64,
}

impl LocalSize {
    /// In units of a size; where that is 0 all grains count as large.
    pub(crate) fn new(dimension: Dimension, unit: f64) -> Self {
        Self { dimension, unit }
    }

    /// That of a grain of the given volume.
    pub(crate) fn of_volume(self, volume: f64) -> f64 {
        if self.unit > 0.0 { (self.dimension.cube_edge(volume) / self.unit).min(1.0) } else { 1.0 }
    }

    /// That of the smallest grain at some vertices.
    pub(crate) fn at_vertices(self, complex: &CellComplex, vertices: &[u32], volumes: &[f64]) -> f64 {
        let faces = complex.faces_at(vertices);
        let sides = faces.into_iter().flat_map(|face| complex.sides(face));
        sides
            .filter_map(Side::cell)
            .map(|(cell, _)| self.of_volume(volumes[cell.index()]))
            .fold(1.0, f64::min)
    }

    /// That of the smallest grain at each control point of a level. Where grains grow, time is the same for all, and so is 1.
    pub(crate) fn at_points(
        self,
        network: &Network,
        level: usize,
        patches: &Patches,
        volumes: Volumes,
    ) -> Vec<f64> {
        let level = &network.levels()[level];
        if volumes == Volumes::Free {
            return vec![1.0; level.vertex_count()];
        }
        let of_grain: Vec<f64> =
            network.cell_volumes().iter().map(|volume| self.of_volume(*volume)).collect();
        let of_boundary = |boundary: &Boundary| {
            boundary.signed_grains().map(|(grain, _)| of_grain[grain.index()]).fold(1.0, f64::min)
        };
        let of_boundaries: Vec<f64> = network.boundaries().iter().map(of_boundary).collect();
        let at_point = |point: u32| {
            let places = patches.places_of_point(point).iter();
            places.map(|place| of_boundaries[patches.patch_of_place(*place)]).fold(1.0, f64::min)
        };
        let mut sizes: Vec<f64> = (0..id(level.vertex_count())).into_par_iter().map(at_point).collect();
        // What is a copy has around it what its original has.
        for pair in &level.copies.vertices {
            sizes[pair.primary as usize] = sizes[pair.primary as usize].min(sizes[pair.secondary as usize]);
        }
        for pair in &level.copies.vertices {
            sizes[pair.secondary as usize] = sizes[pair.primary as usize];
        }
        sizes
    }
}
