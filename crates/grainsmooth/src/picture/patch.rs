use std::io;

use glam::DVec3;
use polycrystal::Side;
use rayon::prelude::*;

use super::parts::Parts;
use crate::Polycrystal;
use crate::formats::surface::{Part, Surface};

/// One side of a boundary, where its grain is moved to.
pub(super) struct Patch {
    pub(super) grain: usize,
    pub(super) boundary: usize,
    /// Points of its own.
    pub(super) points: Vec<DVec3>,
    /// Unit normals at the points, out of the grain.
    pub(super) normals: Vec<DVec3>,
    /// Triangles, winding counter-clockwise as seen from outside the grain.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The edges at its rim.
    pub(super) rim: Vec<[u32; 2]>,
    /// The edges inside it, where its triangles are elements of a size.
    pub(super) element_edges: Vec<[u32; 2]>,
}

/// What can be seen of a network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Seen {
    /// Its outer surface.
    Outside,
    /// The boundaries between grains, without the outer surface.
    Boundaries,
    /// In an exploded view: both sides of every boundary.
    Grains,
}

/// What can be seen, with each piece of a grain moved away from a middle by a share of its distance from there.
pub(super) fn patches(
    polycrystal: &Polycrystal,
    (middle, explode): (DVec3, f64),
    seen: Seen,
) -> io::Result<Vec<Patch>> {
    let surface = polycrystal.surface()?;
    let sides: Vec<[Option<u32>; 2]> =
        surface.parts.iter().map(|part| part.sides.map(|side| side.grain().map(|grain| grain.0))).collect();
    let parts = Parts {
        points: &surface.points,
        sides: &sides,
        triangles_of: |part: usize| surface.triangles_of(&surface.parts[part]),
    };
    let facets = parts.facet_edges();
    let pieces = parts.pieces();
    let is_seen = |part: &Part| match seen {
        Seen::Outside => part.sides[1] == Side::Exterior,
        Seen::Boundaries => part.sides[1] != Side::Exterior,
        Seen::Grains => true,
    };
    let both_sides: Vec<(usize, usize)> = (0..surface.parts.len())
        .filter(|part| is_seen(&surface.parts[*part]))
        .flat_map(|part| [(part, 0), (part, 1)])
        .collect();
    let patch = |(part, side): (usize, usize)| {
        let grain = sides[part][side]?;
        let shift = explode * (pieces.centers[pieces.of_sides[part][side]?] - middle);
        let is_facet = |ends: [u32; 2]| facets.binary_search(&(grain, ends)).is_ok();
        let mut patch =
            Patch::new(&surface, &surface.parts[part], side == 1, (grain as usize, shift), is_facet);
        if polycrystal.elements.is_some() {
            patch.element_edges = edges(&patch.triangles, 2);
        }
        Some(patch)
    };
    Ok(both_sides.into_par_iter().filter_map(patch).collect())
}

impl Patch {
    fn new(
        surface: &Surface<'_>,
        part: &Part,
        is_second: bool,
        (grain, shift): (usize, DVec3),
        is_facet: impl Fn([u32; 2]) -> bool,
    ) -> Self {
        let turned = |[a, b, c]: [u32; 3]| if is_second { [a, c, b] } else { [a, b, c] };
        let mut triangles: Vec<[u32; 3]> = surface.triangles_of(part).map(turned).collect();
        let mut rim = edges(&triangles, 1);
        rim.retain(|ends| !is_facet(*ends));
        let mut ids: Vec<u32> = triangles.iter().flatten().copied().collect();
        ids.sort_unstable();
        ids.dedup();
        let points: Vec<DVec3> = ids.iter().map(|&id| surface.points[id as usize] + shift).collect();
        let local = |id: u32| {
            let place = ids.partition_point(|other| *other < id);
            u32::try_from(place).expect("a boundary has no more points than the network")
        };
        triangles.iter_mut().flatten().chain(rim.iter_mut().flatten()).for_each(|id| *id = local(*id));
        let mut normals = vec![DVec3::ZERO; points.len()];
        for triangle in &triangles {
            let [a, b, c] = triangle.map(|point| points[point as usize]);
            // Twice the area long, so that large triangles count more.
            let normal = (b - a).cross(c - a);
            triangle.iter().for_each(|point| normals[*point as usize] += normal);
        }
        normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
        Self {
            grain,
            boundary: part.boundary.index(),
            points,
            normals,
            triangles,
            rim,
            element_edges: Vec::new(),
        }
    }
}

/// The edges that so many triangles have.
fn edges(triangles: &[[u32; 3]], count: usize) -> Vec<[u32; 2]> {
    let edges = triangles.iter().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut edges: Vec<[u32; 2]> = edges.map(|[a, b]| [*a.min(b), *a.max(b)]).collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).filter(|uses| uses.len() == count).map(|uses| uses[0]).collect()
}
