use rayon::prelude::*;
use subzero::{EdgeId, MeshError, Refinement, StencilTable};

use crate::mesh::node_type::Meeting;
use crate::mesh::periodic::PeriodicCopies;
use crate::{Boundary, BoundaryId, Mesh, NodeType, WallSet, WallSets};

/// The network's connectivity on one level of subdivision, without positions.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Triangles or segments.
    pub mesh: Mesh,
    /// The boundary of each element.
    pub boundary_of: Vec<BoundaryId>,
    /// What each vertex is part of.
    pub node_types: Vec<NodeType>,
    /// How many grains meet at each vertex, one a period away being another one; 255 stands for that many and more.
    pub grain_counts: Vec<u8>,
    /// The level on which each vertex was born.
    pub generations: Vec<u8>,
    /// The walls that each vertex stays on.
    pub walls: Vec<WallSet>,
    /// Which vertices are others moved by whole periods.
    pub copies: PeriodicCopies,
    /// What meets along each edge of the triangles; empty in the plane.
    pub(crate) at_edges: Vec<Meeting>,
}

impl Level {
    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.node_types.len()
    }

    /// Number of triangles or segments.
    pub fn element_count(&self) -> usize {
        self.boundary_of.len()
    }

    /// Of each vertex the one that it is a copy of, or itself.
    pub fn originals(&self) -> Vec<u32> {
        let mut originals: Vec<u32> = (0u32..).take(self.vertex_count()).collect();
        for pair in &self.copies.vertices {
            originals[pair.secondary as usize] = pair.primary;
        }
        originals
    }

    /// The next level, and how its points follow from this one's.
    pub(crate) fn refine(
        &self,
        boundaries: &[Boundary],
        sets: &WallSets,
    ) -> Result<(Self, StencilTable), MeshError> {
        match &self.mesh {
            Mesh::Triangles(mesh) => {
                let Refinement { mesh: finer, stencils } = mesh.loop_refine()?;
                let edges = (0..mesh.counts().edges).into_par_iter();
                let ends: Vec<[u32; 2]> = edges.map(|edge| mesh.edge(EdgeId(edge))).collect();
                let triangles = self.element_count();
                // The three corner triangles of each triangle come first, then all the centre triangles.
                let corners = self.boundary_of.iter().flat_map(|boundary| [*boundary; 3]);
                let boundary_of = corners.chain(self.boundary_of.iter().copied()).collect();
                // Two halves of each edge, then three edges inside each triangle.
                let halves = self.at_edges.iter().flat_map(|at| [*at; 2]);
                let inside = (0..triangles).flat_map(|t| [self.inside(t, boundaries); 3]);
                let at_edges = halves.chain(inside).collect();
                let born = &self.at_edges;
                let finer = Mesh::Triangles(finer);
                Ok((self.child(finer, boundary_of, (&ends, sets), born, at_edges), stencils))
            }
            Mesh::Segments(mesh) => {
                let Refinement { mesh: finer, stencils } = mesh.refine()?;
                let boundary_of = self.boundary_of.iter().flat_map(|boundary| [*boundary; 2]).collect();
                let born: Vec<Meeting> =
                    (0..self.element_count()).map(|s| self.inside(s, boundaries)).collect();
                let ends = (mesh.segments(), sets);
                Ok((self.child(Mesh::Segments(finer), boundary_of, ends, &born, Vec::new()), stencils))
            }
        }
    }

    /// The finer level, whose new vertices lie between `ends`, where `born` meet.
    fn child(
        &self,
        mesh: Mesh,
        boundary_of: Vec<BoundaryId>,
        (ends, sets): (&[[u32; 2]], &WallSets),
        born: &[Meeting],
        at_edges: Vec<Meeting>,
    ) -> Self {
        let generation = self.generations.iter().max().map_or(0, |newest| newest + 1);
        let mut generations = self.generations.clone();
        generations.resize(generations.len() + born.len(), generation);
        let mut node_types = self.node_types.clone();
        node_types.extend(born.iter().map(|at| at.node_type));
        let mut grain_counts = self.grain_counts.clone();
        grain_counts.extend(born.iter().map(|at| at.grains));
        let mut walls = self.walls.clone();
        // A line between two points of a wall lies in the wall: no element joins walls through the inside.
        let common = |[a, b]: &[u32; 2]| sets.intersection(self.walls[*a as usize], self.walls[*b as usize]);
        walls.extend(ends.iter().map(common));
        let copies = self.copies.refined(self.vertex_count(), self.element_count(), &mesh);
        Self { mesh, boundary_of, node_types, grain_counts, generations, walls, copies, at_edges }
    }

    /// What meets inside an element.
    fn inside(&self, element: usize, boundaries: &[Boundary]) -> Meeting {
        Meeting::inside(&boundaries[self.boundary_of[element].index()])
    }
}
