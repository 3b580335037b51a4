use subzero::{FaceId, HalfEdgeId, RefinedMesh};

use crate::mesh::adjacency::{Adjacency, Inner, refined_half_edges};
use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::{BoundaryId, Elements, LevelView, Surface};

/// The elements of each boundary.
pub(crate) struct BoundaryElements<'a> {
    elements: Elements<'a>,
    /// The labelled elements: where elements are refined, those that they come from.
    labelled: Grouped<u32>,
}

impl<'a> BoundaryElements<'a> {
    /// Those of a surface.
    pub(crate) fn new(surface: &Surface<'a>) -> Self {
        Self::labelled(surface.elements, surface.boundary_of, surface.sides.len())
    }

    /// Those of a level with so many boundaries.
    pub(crate) fn of_level(level: impl Into<LevelView<'a>>, boundary_count: usize) -> Self {
        let level = level.into();
        Self::labelled(level.elements(), level.labels(), boundary_count)
    }

    fn labelled(elements: Elements<'a>, boundary_of: &[BoundaryId], boundary_count: usize) -> Self {
        let labels = (0u32..).zip(boundary_of).map(|(element, boundary)| (boundary.index(), element));
        Self { elements, labelled: Grouped::new(boundary_count, labels) }
    }

    /// Number of boundaries.
    pub(crate) fn boundary_count(&self) -> usize {
        self.labelled.count()
    }

    /// Number of elements of a boundary.
    pub(crate) fn count(&self, boundary: usize) -> usize {
        let labelled = self.labelled.of(boundary).len();
        labelled << (2 * self.levels())
    }

    /// How many levels elements are finer than those that hold their labels.
    fn levels(&self) -> usize {
        match self.elements {
            Elements::Refined(mesh) => mesh.levels(),
            Elements::Triangles(_) | Elements::Segments(_) => 0,
        }
    }

    /// The elements of a boundary, in order. Where they are refined, they are numbered among themselves as [`MeshCounts`](subzero::MeshCounts) says, too.
    pub(crate) fn of(&self, boundary: usize) -> Vec<u32> {
        let labelled = self.labelled.of(boundary).to_vec();
        let Elements::Refined(mesh) = self.elements else { return labelled };
        (0..mesh.levels()).fold(labelled, |parents, level| {
            let children = |parent: &u32| mesh.counts_of(level).triangle_children(FaceId(*parent));
            let corners = parents.iter().flat_map(|parent| children(parent).into_iter().take(3));
            let centres = parents.iter().map(|parent| children(parent)[3]);
            corners.chain(centres).map(|child| child.0).collect()
        })
    }
}

/// Which elements of a boundary are neighbours.
pub(crate) enum BoundaryNeighbors<'a> {
    /// As they follow from the mesh of the labelled elements, which have these boundaries and indices in them.
    OfMesh { mesh: RefinedMesh<'a>, boundary_of: &'a [BoundaryId], index_of: Vec<u32> },
    /// Pairs of indices, boundary by boundary.
    Listed(Grouped<[u32; 2]>),
}

impl<'a> BoundaryNeighbors<'a> {
    /// Those among elements that meet in these adjacency; the labelled ones have these boundaries.
    pub(crate) fn new(
        boundary_of: &'a [BoundaryId],
        boundaries: &BoundaryElements<'a>,
        adjacency: &Adjacency<'a>,
    ) -> Self {
        let mut index_of = vec![0; boundary_of.len()];
        for boundary in 0..boundaries.boundary_count() {
            let labelled = boundaries.labelled.of(boundary);
            (0u32..).zip(labelled).for_each(|(index, element)| index_of[*element as usize] = index);
        }
        match &adjacency.inner {
            Inner::OfMesh { mesh, .. } => Self::OfMesh { mesh: *mesh, boundary_of, index_of },
            Inner::Listed(pairs) => {
                let pairs = pairs.iter().map(|pair| {
                    let boundary = boundary_of[pair[0] as usize].index();
                    (boundary, pair.map(|element| index_of[element as usize]))
                });
                Self::Listed(Grouped::new(boundaries.boundary_count(), pairs))
            }
        }
    }

    /// The pairs of neighbours in a boundary, by their indices among its elements.
    pub(crate) fn of(&self, boundaries: &BoundaryElements<'_>, boundary: usize) -> Vec<[u32; 2]> {
        let (mesh, boundary_of, index_of) = match self {
            Self::Listed(pairs) => return pairs.of(boundary).to_vec(),
            Self::OfMesh { mesh, boundary_of, index_of } => (mesh, boundary_of, index_of),
        };
        let labelled = boundaries.labelled.of(boundary);
        // The half-edge counted by the triangle's index.
        let counted = |h: HalfEdgeId| HalfEdgeId(3 * index_of[h.triangle().index()] + h.0 % 3);
        let is_own = |triangle: FaceId| boundary_of[triangle.index()].index() == boundary;
        let half_edges =
            labelled.iter().flat_map(|triangle| (3 * triangle..3 * triangle + 3).map(HalfEdgeId));
        let pairs = half_edges.filter_map(|h| {
            let beyond = mesh.mesh().half_edge_beyond(h)?;
            (beyond > h && is_own(beyond.triangle())).then(|| [h, beyond].map(counted))
        });
        let count = id(labelled.len());
        let pairs = (0..mesh.levels())
            .fold(pairs.collect(), |pairs: Vec<_>, level| refined_half_edges(&pairs, count << (2 * level)));
        pairs.into_iter().map(|pair| pair.map(|h| h.triangle().0)).collect()
    }
}
