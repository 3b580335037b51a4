use subzero::{HalfEdgeId, TriangleMesh};

use crate::mesh::adjacency::{Adjacency, Inner};
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
        if let Elements::Refined(_) = self.elements { 4 * labelled } else { labelled }
    }

    /// The elements of a boundary, in order.
    pub(crate) fn of(&self, boundary: usize) -> impl Iterator<Item = u32> + Clone {
        let labelled = self.labelled.of(boundary);
        let (whole, parents) = match self.elements {
            // The triangles at the corners come before those in the centres.
            Elements::Refined(mesh) => (&[][..], Some((labelled, id(3 * mesh.triangles().len())))),
            Elements::Triangles(_) | Elements::Segments(_) => (labelled, None),
        };
        let children = parents.into_iter().flat_map(|(parents, first_centre)| {
            let corners = parents.iter().flat_map(|parent| [3 * parent, 3 * parent + 1, 3 * parent + 2]);
            corners.chain(parents.iter().map(move |parent| first_centre + parent))
        });
        whole.iter().copied().chain(children)
    }
}

/// Which elements of a boundary are neighbours.
pub(crate) enum BoundaryNeighbors<'a> {
    /// As the mesh of the labelled elements has them, which have these boundaries and indices in them.
    OfMesh { mesh: &'a TriangleMesh, boundary_of: &'a [BoundaryId], index_of: Vec<u32> },
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
            Inner::OfMesh { mesh, .. } => Self::OfMesh { mesh, boundary_of, index_of },
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
        let counted = |h: HalfEdgeId| 3 * index_of[h.triangle().index()] + h.0 % 3;
        let mut pairs = Vec::with_capacity(2 * boundaries.count(boundary));
        for (index, triangle) in (0u32..).zip(labelled) {
            for k in 0..3 {
                let h = HalfEdgeId(3 * triangle + k);
                let is_own = |beyond: &HalfEdgeId| {
                    *beyond > h && boundary_of[beyond.triangle().index()].index() == boundary
                };
                let beyond = mesh.half_edge_beyond(h).filter(is_own);
                match boundaries.elements {
                    Elements::Refined(_) => {
                        let centre = id(3 * labelled.len()) + index;
                        pairs.push([3 * index + k, centre]);
                        if let Some(beyond) = beyond {
                            // The halves of the edge: a triangle at a corner has the number of the half-edge that starts there.
                            pairs.push([3 * index + k, counted(beyond.next())]);
                            pairs.push([3 * index + (k + 1) % 3, counted(beyond)]);
                        }
                    }
                    Elements::Triangles(_) | Elements::Segments(_) => {
                        pairs.extend(beyond.map(|beyond| [index, index_of[beyond.triangle().index()]]));
                    }
                }
            }
        }
        pairs
    }
}
