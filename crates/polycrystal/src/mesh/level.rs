use cancellation::check_cancelled;
use rayon::prelude::*;
use subzero::{EdgeId, MeshError};

use crate::mesh::id::id;
use crate::mesh::node_type::Meeting;
use crate::mesh::periodic::PeriodicCopies;
use crate::{Boundary, BoundaryId, Elements, Mesh, NodeType, WallSet, WallSets};

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

/// One level of a network: held in memory, or known from the level before.
#[derive(Debug, Clone, Copy)]
pub enum LevelView<'a> {
    /// In memory.
    Held(&'a Level),
    /// One subdivision on from a level in space: all of it follows from ids, but for the copies.
    Refined {
        /// The level before.
        parent: &'a Level,
        /// Which vertices are others moved by whole periods.
        copies: &'a PeriodicCopies,
        /// Number of subdivisions of the control mesh that lead to it.
        generation: u8,
    },
}

impl<'a> From<&'a Level> for LevelView<'a> {
    fn from(level: &'a Level) -> Self {
        Self::Held(level)
    }
}

impl<'a> LevelView<'a> {
    /// Number of vertices.
    pub fn vertex_count(self) -> usize {
        match self {
            Self::Held(level) => level.vertex_count(),
            Self::Refined { parent, .. } => parent.vertex_count() + parent.at_edges.len(),
        }
    }

    /// Number of triangles or segments.
    pub fn element_count(self) -> usize {
        self.elements().len()
    }

    /// The triangles or segments.
    pub fn elements(self) -> Elements<'a> {
        match (self, &self.held().mesh) {
            (Self::Refined { .. }, Mesh::Triangles(mesh)) => Elements::Refined(mesh),
            (_, mesh) => mesh.into(),
        }
    }

    /// The boundary of an element.
    pub fn boundary(self, element: u32) -> BoundaryId {
        self.labels()[self.elements().labelled(element) as usize]
    }

    /// The boundaries of all elements, in their order.
    pub fn boundaries(self) -> impl Iterator<Item = BoundaryId> + use<'a> {
        (0..id(self.element_count())).map(move |element| self.boundary(element))
    }

    /// What a vertex is part of.
    pub fn node_type(self, vertex: usize) -> NodeType {
        self.born(vertex).map_or_else(|| self.held().node_types[vertex], |at| at.node_type)
    }

    /// How many grains meet at a vertex, as of [`Level::grain_counts`].
    pub fn grain_count(self, vertex: usize) -> u8 {
        self.born(vertex).map_or_else(|| self.held().grain_counts[vertex], |at| at.grains)
    }

    /// The level on which a vertex was born.
    pub fn generation(self, vertex: usize) -> u8 {
        match self {
            Self::Refined { parent, generation, .. } if vertex >= parent.vertex_count() => generation,
            _ => self.held().generations[vertex],
        }
    }

    /// The walls that a vertex stays on.
    pub(crate) fn walls(self, vertex: usize, sets: &WallSets) -> WallSet {
        let held = self.held();
        match (self, &held.mesh) {
            (Self::Refined { .. }, Mesh::Triangles(mesh)) if vertex >= held.vertex_count() => {
                let edge = vertex - held.vertex_count();
                walls_between(held, mesh.edge(EdgeId(id(edge))), &held.at_edges[edge], sets)
            }
            _ => held.walls[vertex],
        }
    }

    /// Which vertices are others moved by whole periods.
    pub fn copies(self) -> &'a PeriodicCopies {
        match self {
            Self::Held(level) => &level.copies,
            Self::Refined { copies, .. } => copies,
        }
    }

    /// Of each vertex the one that it is a copy of, or itself.
    pub fn originals(self) -> Vec<u32> {
        let mut originals: Vec<u32> = (0u32..).take(self.vertex_count()).collect();
        for pair in &self.copies().vertices {
            originals[pair.secondary as usize] = pair.primary;
        }
        originals
    }

    /// What is in memory of it: the level itself, or the one before.
    pub fn held(self) -> &'a Level {
        match self {
            Self::Held(level) | Self::Refined { parent: level, .. } => level,
        }
    }

    /// The boundary of each element that is in memory.
    pub fn labels(self) -> &'a [BoundaryId] {
        &self.held().boundary_of
    }

    /// What meets where a vertex was born that the level in memory does not have.
    fn born(self, vertex: usize) -> Option<&'a Meeting> {
        let held = self.held();
        vertex.checked_sub(held.vertex_count()).map(|edge| &held.at_edges[edge])
    }
}

/// The walls of a vertex that is born between two others, given what meets there. A triangle inside may have two corners on a wall, where lines
/// are curved: the edge between these is not on it.
fn walls_between(level: &Level, ends: [u32; 2], born: &Meeting, sets: &WallSets) -> WallSet {
    if !born.node_type.is_outer() {
        return WallSet::EMPTY;
    }
    let [a, b] = ends.map(|end| level.walls[end as usize]);
    sets.intersection(a, b)
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

    /// The next level.
    pub(crate) fn refine(&self, boundaries: &[Boundary], sets: &WallSets) -> Result<Self, MeshError> {
        match &self.mesh {
            Mesh::Triangles(mesh) => {
                let finer = Mesh::Triangles(mesh.refine_connectivity()?);
                check_cancelled();
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
                Ok(self.child(finer, boundary_of, (&ends, sets), &self.at_edges, at_edges))
            }
            Mesh::Segments(mesh) => {
                let finer = Mesh::Segments(mesh.refine_connectivity()?);
                let boundary_of = self.boundary_of.iter().flat_map(|boundary| [*boundary; 2]).collect();
                let born: Vec<Meeting> =
                    (0..self.element_count()).map(|s| self.inside(s, boundaries)).collect();
                Ok(self.child(finer, boundary_of, (mesh.segments(), sets), &born, Vec::new()))
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
        walls.extend(ends.iter().zip(born).map(|(ends, born)| walls_between(self, *ends, born, sets)));
        check_cancelled();
        let copies = self.refined_copies((&mesh).into());
        Self { mesh, boundary_of, node_types, grain_counts, generations, walls, copies, at_edges }
    }

    /// The copies on the next level in space, which itself is not made.
    pub(crate) fn finest_copies(&self) -> Result<PeriodicCopies, MeshError> {
        let Mesh::Triangles(mesh) = &self.mesh else { unreachable!("all levels in the plane are held") };
        mesh.counts().refined()?;
        Ok(self.refined_copies(Elements::Refined(mesh)))
    }

    /// The copies on the next level, which has these elements.
    fn refined_copies(&self, finer: Elements<'_>) -> PeriodicCopies {
        self.copies.refined(self.vertex_count(), self.element_count(), finer)
    }

    /// What meets inside an element.
    fn inside(&self, element: usize, boundaries: &[Boundary]) -> Meeting {
        Meeting::inside(&boundaries[self.boundary_of[element].index()])
    }
}
