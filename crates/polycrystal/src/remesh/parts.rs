//! The parts of boundaries between lines.

use std::collections::BTreeMap;

use subzero::{EdgeId, TriangleMesh};
use voronoi::Translation;

use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::remesh::skeleton::Skeleton;
use crate::remesh::torus::{Moved, Torus};
use crate::{Boundary, BoundaryId, Level, NetworkError, Side};

/// What hangs together of boundaries without a line between: the whole boundary, but where a line on the opposite wall divides a wall's.
#[derive(Debug)]
pub(crate) struct Parts {
    /// The triangles of each.
    pub(crate) triangles: Grouped<u32>,
    /// The boundary that each is part of.
    pub(crate) boundaries: Vec<BoundaryId>,
    /// Of each that is a copy, what of.
    pub(crate) copies: Vec<Option<Moved<u32>>>,
}

impl Parts {
    pub(crate) fn new(
        (level, mesh): (&Level, &TriangleMesh),
        skeleton: &Skeleton,
        torus: &Torus,
        boundaries: &[Boundary],
    ) -> Result<Self, NetworkError> {
        let parts = Self::without_copies((level, mesh), skeleton);
        let copies = copies(mesh, torus, &parts.triangles, &parts.boundaries, boundaries)?;
        Ok(Self { copies, ..parts })
    }

    /// Parts that each stand for themselves.
    pub(crate) fn without_copies((level, mesh): (&Level, &TriangleMesh), skeleton: &Skeleton) -> Self {
        let mut pieces = DisjointSets::new(level.element_count());
        for (edge, line) in (0u32..).zip(&skeleton.of_edge) {
            if let (None, Some([a, b])) =
                (line, mesh.edge_triangles(EdgeId(edge)).map(|pair| pair.map(|triangle| triangle.0)))
            {
                pieces.join(a, b);
            }
        }
        let mut numbers = vec![None; level.element_count()];
        let mut of_parts = Vec::new();
        let mut part_of = Vec::with_capacity(level.element_count());
        for (triangle, boundary) in (0u32..).zip(&level.boundary_of) {
            let part = *numbers[pieces.root(triangle) as usize].get_or_insert_with(|| {
                of_parts.push(*boundary);
                of_parts.len() - 1
            });
            part_of.push(part);
        }
        let triangles = Grouped::new(of_parts.len(), part_of.iter().copied().zip(0u32..));
        Self { copies: vec![None; of_parts.len()], triangles, boundaries: of_parts }
    }

    /// The parts that stand for themselves.
    pub(crate) fn originals(&self) -> impl Iterator<Item = usize> {
        (0..self.copies.len()).filter(|part| self.copies[*part].is_none())
    }
}

/// Which parts at the exterior have the triangles of others.
fn copies(
    mesh: &TriangleMesh,
    torus: &Torus,
    triangles: &Grouped<u32>,
    of_parts: &[BoundaryId],
    boundaries: &[Boundary],
) -> Result<Vec<Option<Moved<u32>>>, NetworkError> {
    // A triangle as seen from its first corner on the torus, and where that is.
    let seen = |triangle: u32| {
        let mut corners = mesh.triangles()[triangle as usize].map(|corner| torus.vertices[corner as usize]);
        corners.sort_unstable();
        let from = corners[0].translation;
        (corners.map(|corner| Moved { translation: corner.translation - from, ..corner }), from)
    };
    let mut known: BTreeMap<[Moved<u32>; 3], (u32, Translation)> = BTreeMap::new();
    let mut copies = vec![None; of_parts.len()];
    for part in 0..of_parts.len() {
        if boundaries[of_parts[part].index()].sides[1] != Side::Exterior {
            continue;
        }
        let own = triangles.of(part);
        let (key, at) = seen(own[0]);
        let Some((original, there)) = known.get(&key).copied() else {
            for (key, at) in own.iter().map(|triangle| seen(*triangle)) {
                known.insert(key, (id(part), at));
            }
            continue;
        };
        let is_alike = own.len() == triangles.of(original as usize).len()
            && own
                .iter()
                .all(|triangle| known.get(&seen(*triangle).0).is_some_and(|(other, _)| *other == original));
        if !is_alike {
            return Err(NetworkError::NoCopyOnWall { point: mesh.triangles()[own[0] as usize][0] });
        }
        copies[part] = Some(Moved { original, translation: at - there });
    }
    Ok(copies)
}
