use cancellation::check_cancelled;
use rayon::prelude::*;
use subzero::{CurveMesh, EdgeId, EdgeParent, FaceId, MeshError, RefinedMesh};

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

/// One level of a network: held in memory, or known from a level before.
#[derive(Debug, Clone, Copy)]
pub enum LevelView<'a> {
    /// In memory.
    Held(&'a Level),
    /// In space: all of it follows from ids, but for the copies.
    Refined(RefinedLevel<'a>),
}

/// The mesh of a level, held or not.
#[derive(Debug, Clone, Copy)]
pub(crate) enum LevelMesh<'a> {
    /// In space.
    Triangles(RefinedMesh<'a>),
    /// In the plane.
    Segments(&'a CurveMesh),
}

/// A level in space that follows from one in memory.
#[derive(Debug, Clone, Copy)]
pub struct RefinedLevel<'a> {
    held: &'a Level,
    mesh: RefinedMesh<'a>,
    boundaries: &'a [Boundary],
    copies: &'a PeriodicCopies,
    /// Number of subdivisions of the control mesh that lead to it.
    generation: usize,
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
            Self::Refined(level) => level.mesh.counts().vertices as usize,
        }
    }

    /// Number of triangles or segments.
    pub fn element_count(self) -> usize {
        self.elements().len()
    }

    /// The triangles or segments.
    pub fn elements(self) -> Elements<'a> {
        match self {
            Self::Held(level) => (&level.mesh).into(),
            Self::Refined(level) => Elements::Refined(level.mesh),
        }
    }

    /// Its mesh.
    pub(crate) fn mesh(self) -> LevelMesh<'a> {
        match self {
            Self::Held(Level { mesh: Mesh::Triangles(mesh), .. }) => LevelMesh::Triangles(mesh.into()),
            Self::Held(Level { mesh: Mesh::Segments(mesh), .. }) => LevelMesh::Segments(mesh),
            Self::Refined(level) => LevelMesh::Triangles(level.mesh),
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
        match self {
            Self::Refined(level) if vertex >= level.held.vertex_count() => level.born(vertex).node_type,
            _ => self.held().node_types[vertex],
        }
    }

    /// How many grains meet at a vertex, as of [`Level::grain_counts`].
    pub fn grain_count(self, vertex: usize) -> u8 {
        match self {
            Self::Refined(level) if vertex >= level.held.vertex_count() => level.born(vertex).grains,
            _ => self.held().grain_counts[vertex],
        }
    }

    /// The level on which a vertex was born.
    pub fn generation(self, vertex: usize) -> u8 {
        match self {
            Self::Refined(level) if vertex >= level.held.vertex_count() => {
                let (parents, _) = level.birth(vertex);
                let first = level.generation - level.mesh.levels();
                u8::try_from(first + parents.levels() + 1).expect("there are fewer than 128 levels")
            }
            _ => self.held().generations[vertex],
        }
    }

    /// The walls that a vertex stays on.
    pub fn walls(self, vertex: usize, sets: &WallSets) -> WallSet {
        match self {
            Self::Refined(level) if vertex >= level.held.vertex_count() => {
                let of_ends = || {
                    let (parents, edge) = level.birth(vertex);
                    parents.edge(edge).map(|end| self.walls(end as usize, sets))
                };
                walls_between(of_ends, &level.born(vertex), sets)
            }
            _ => self.held().walls[vertex],
        }
    }

    /// The element in which one of the next level lies.
    pub(crate) fn parent(self, element: u32) -> u32 {
        match self.mesh() {
            LevelMesh::Triangles(mesh) => mesh.counts().triangle_parent(FaceId(element)).0,
            LevelMesh::Segments(_) => element / 2,
        }
    }

    /// Which vertices are others moved by whole periods.
    pub fn copies(self) -> &'a PeriodicCopies {
        match self {
            Self::Held(level) => &level.copies,
            Self::Refined(level) => level.copies,
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

    /// What is in memory of it: the level itself, or the one from which it follows.
    pub fn held(self) -> &'a Level {
        match self {
            Self::Held(level) => level,
            Self::Refined(level) => level.held,
        }
    }

    /// The boundary of each element that is in memory.
    pub fn labels(self) -> &'a [BoundaryId] {
        &self.held().boundary_of
    }
}

impl<'a> RefinedLevel<'a> {
    /// Level `generation`, which has these copies and is so many subdivisions on from a level in space.
    pub(crate) fn new(
        held: &'a Level,
        levels: usize,
        boundaries: &'a [Boundary],
        copies: &'a PeriodicCopies,
        generation: usize,
    ) -> Self {
        let mesh = held.refined_mesh(levels).expect("ids were counted when the network was made");
        Self { held, mesh, boundaries, copies, generation }
    }

    /// The level before that on which a vertex that is not in memory was born, and the edge there.
    fn birth(&self, vertex: usize) -> (RefinedMesh<'a>, EdgeId) {
        let before = |levels: &usize| self.mesh.counts_of(*levels).vertices as usize <= vertex;
        let parents = (0..self.mesh.levels()).rev().find(before).expect("it is not in memory");
        let parents = self.mesh.at(parents);
        (parents, EdgeId(id(vertex) - parents.counts().vertices))
    }

    /// What meets where such a vertex was born.
    fn born(&self, vertex: usize) -> Meeting {
        let (mut parents, mut edge) = self.birth(vertex);
        while let Some(levels) = parents.levels().checked_sub(1) {
            parents = parents.at(levels);
            match parents.counts().edge_parent(edge) {
                EdgeParent::Edge(parent) => edge = parent,
                EdgeParent::Triangle(triangle) => {
                    let boundary = self.held.boundary_of[parents.ancestor(triangle).index()];
                    return Meeting::inside(&self.boundaries[boundary.index()]);
                }
            }
        }
        self.held.at_edges[edge.index()]
    }
}

/// The walls of a vertex that is born between two others, given theirs and what meets there. A triangle inside may have two corners on a wall, where lines
/// are curved: the edge between these is not on it.
fn walls_between(of_ends: impl FnOnce() -> [WallSet; 2], born: &Meeting, sets: &WallSets) -> WallSet {
    if !born.node_type.is_outer() {
        return WallSet::EMPTY;
    }
    let [a, b] = of_ends();
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
        walls.extend(
            ends.iter()
                .zip(born)
                .map(|(ends, born)| walls_between(|| ends.map(|end| self.walls[end as usize]), born, sets)),
        );
        check_cancelled();
        let copies = self.copies.refined(self.vertex_count(), self.element_count(), (&mesh).into());
        Self { mesh, boundary_of, node_types, grain_counts, generations, walls, copies, at_edges }
    }

    /// The mesh of a level in space refined so many times.
    fn refined_mesh(&self, levels: usize) -> Result<RefinedMesh<'_>, MeshError> {
        let Mesh::Triangles(mesh) = &self.mesh else { unreachable!("all levels in the plane are held") };
        RefinedMesh::new(mesh, levels)
    }

    /// The copies on so many levels after one in space, none of which is made.
    pub(crate) fn copies_beyond(&self, levels: usize) -> Result<Vec<PeriodicCopies>, MeshError> {
        let mut copies: Vec<PeriodicCopies> = Vec::new();
        for level in 0..levels {
            let counts = self.refined_mesh(level)?.counts();
            let finer = Elements::Refined(self.refined_mesh(level + 1)?);
            let before = copies.last().unwrap_or(&self.copies);
            copies.push(before.refined(counts.vertices as usize, counts.triangles as usize, finer));
        }
        Ok(copies)
    }

    /// What meets inside an element.
    fn inside(&self, element: usize, boundaries: &[Boundary]) -> Meeting {
        Meeting::inside(&boundaries[self.boundary_of[element].index()])
    }
}
