use glam::DVec3;
use subzero::{FaceId, HalfEdgeId, TriangleMesh};

use crate::mesh::adjacency::{Adjacency, Inner};
use crate::mesh::elements::normal;
use crate::mesh::grouped::Grouped;
use crate::mesh::level_points::LevelPoints;
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
        Self::by_label(surface.elements, surface.boundary_of, surface.sides.len())
    }

    /// Those of a level with so many boundaries.
    pub(crate) fn of_level(level: impl Into<LevelView<'a>>, boundary_count: usize) -> Self {
        let level = level.into();
        Self::by_label(level.elements(), level.labels(), boundary_count)
    }

    fn by_label(elements: Elements<'a>, boundary_of: &[BoundaryId], boundary_count: usize) -> Self {
        let labels = (0u32..).zip(boundary_of).map(|(element, boundary)| (boundary.index(), element));
        Self { elements, labelled: Grouped::new(boundary_count, labels) }
    }

    /// Number of boundaries.
    pub(crate) fn boundary_count(&self) -> usize {
        self.labelled.count()
    }

    /// Number of elements of a boundary.
    pub(crate) fn count(&self, boundary: usize) -> usize {
        self.labelled(boundary).len() * self.per_label()
    }

    /// How many elements come from each that holds a label.
    fn per_label(&self) -> usize {
        self.elements.refined_triangle().triangles.len()
    }

    /// The elements of a boundary that hold its label, in order.
    pub(crate) fn labelled(&self, boundary: usize) -> &[u32] {
        self.labelled.of(boundary)
    }

    /// The element of a boundary with this index.
    pub(crate) fn element(&self, boundary: usize, index: usize) -> u32 {
        let count = self.per_label();
        self.elements.element_in(self.labelled(boundary)[index / count], index % count)
    }

    /// The elements of a boundary: where they are refined, those in one that holds its label follow each other.
    pub(crate) fn of(&self, boundary: usize) -> Vec<u32> {
        let count = self.per_label();
        let labelled = self.labelled(boundary).iter();
        labelled
            .flat_map(|labelled| (0..count).map(|place| self.elements.element_in(*labelled, place)))
            .collect()
    }

    /// The normals of the elements of a boundary, as of [`Elements::normal`].
    pub(crate) fn normals(&self, boundary: usize, points: &LevelPoints<'_>) -> Vec<DVec3> {
        let mut normals = Vec::with_capacity(self.count(boundary));
        for labelled in self.labelled(boundary) {
            points.for_each_in(*labelled, |corners| normals.push(normal(corners)));
        }
        normals
    }
}

/// Which elements of a boundary are neighbours.
pub(crate) enum BoundaryNeighbors<'a> {
    /// As they follow from the mesh of the labelled elements, which have these boundaries and indices in them.
    OfMesh { mesh: &'a TriangleMesh, boundary_of: &'a [BoundaryId], index_of: Vec<u32> },
    /// Pairs of indices, boundary by boundary.
    Listed(Grouped<[u32; 2]>),
}

impl<'a> BoundaryNeighbors<'a> {
    /// Those among elements, of which those that hold labels have these boundaries and meet so.
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
            Inner::OfMesh { mesh, .. } => Self::OfMesh { mesh: mesh.mesh(), boundary_of, index_of },
            Inner::Listed(pairs) => {
                let pairs = pairs.iter().map(|pair| {
                    let boundary = boundary_of[pair[0] as usize].index();
                    (boundary, pair.map(|element| index_of[element as usize]))
                });
                Self::Listed(Grouped::new(boundaries.boundary_count(), pairs))
            }
        }
    }

    /// Looks at all pairs of neighbours in a boundary, by their indices among its elements.
    pub(crate) fn for_each_in(
        &self,
        boundaries: &BoundaryElements<'_>,
        boundary: usize,
        mut look_at: impl FnMut([usize; 2]),
    ) {
        let (mesh, boundary_of, index_of) = match self {
            Self::Listed(pairs) => {
                return pairs.of(boundary).iter().for_each(|pair| look_at(pair.map(|index| index as usize)));
            }
            Self::OfMesh { mesh, boundary_of, index_of } => (mesh, boundary_of, index_of),
        };
        let refined = boundaries.elements.refined_triangle();
        let count = refined.triangles.len();
        let is_own = |triangle: FaceId| boundary_of[triangle.index()].index() == boundary;
        for (index, triangle) in boundaries.labelled(boundary).iter().enumerate() {
            let own = |place: usize| index * count + place;
            refined.neighbours.iter().for_each(|pair| look_at(pair.map(own)));
            for (h, along) in (3 * triangle..).map(HalfEdgeId).zip(refined.along_edges) {
                let beyond = mesh.half_edge_beyond(h).filter(|beyond| *beyond > h);
                let Some(beyond) = beyond.filter(|beyond| is_own(beyond.triangle())) else { continue };
                let other = index_of[beyond.triangle().index()] as usize;
                let against = refined.along_edges[(beyond.0 % 3) as usize].iter().rev();
                along
                    .iter()
                    .zip(against)
                    .for_each(|((here, _), (there, _))| look_at([own(*here), other * count + there]));
            }
        }
    }
}
