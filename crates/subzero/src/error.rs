//! Why a mesh cannot be made.

use crate::{FaceId, HalfEdgeId};

/// Why a mesh, a curve or a feature of theirs was refused; each case names the place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// More vertices or half-edges than 32-bit ids can count.
    #[error("{count} {what} are too many: ids are 32 bits wide; use fewer levels or part of the mesh")]
    TooLarge {
        /// What there are too many of.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// A face or segment refers to a vertex that does not exist.
    #[error(
        "{what} {index} refers to vertex {vertex}, but there are only {vertex_count} vertices, counted from 0"
    )]
    VertexOutOfRange {
        /// "triangle", "segment", "crease", ...
        what: &'static str,
        /// Which one, counted from 0.
        index: usize,
        /// The vertex it refers to.
        vertex: u32,
        /// How many vertices there are.
        vertex_count: usize,
    },
    /// A face or segment has the same vertex twice.
    #[error("{what} {index} is degenerate: it uses vertex {vertex} twice; remove it")]
    Degenerate {
        /// "triangle" or "segment".
        what: &'static str,
        /// Which one, counted from 0.
        index: usize,
        /// The vertex that occurs twice.
        vertex: u32,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} is at {point:?}: every coordinate must be finite")]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// Where it is.
        point: [f64; 3],
    },
    /// An edge with one face where a closed surface is needed.
    #[error("the surface is open: edge {}-{} has one face only; close the hole", ends[0], ends[1])]
    Open {
        /// The ends of the edge.
        ends: [u32; 2],
    },
    /// A face has fewer than three corners.
    #[error("face {face} has {corners} corners: it needs at least three")]
    TooFewCorners {
        /// Which face.
        face: FaceId,
        /// How many corners it has.
        corners: usize,
    },
    /// More than two faces share an edge of a mesh that has to be manifold.
    #[error("{faces} faces share edge {}-{}: a manifold mesh has at most two; split it there into several", ends[0], ends[1])]
    NonManifoldEdge {
        /// The ends of the edge.
        ends: [u32; 2],
        /// How many faces share it.
        faces: u32,
    },
    /// The faces around a vertex of a mesh that has to be manifold form more than one fan.
    #[error(
        "the faces around vertex {vertex} touch only in this point: a manifold mesh has one fan around it; give each fan a vertex of its own"
    )]
    NonManifoldVertex {
        /// The vertex.
        vertex: u32,
    },
    /// Doo-Sabin subdivision of an inner vertex with two edges.
    #[error(
        "vertex {vertex} has only two edges: Doo-Sabin subdivision would give it a face with two corners; merge the faces beside it"
    )]
    ValenceTwo {
        /// The vertex.
        vertex: u32,
    },
    /// Two faces have the same vertices.
    #[error("faces {first} and {second} have the same vertices; remove one")]
    DuplicateFace {
        /// The face with the lower number.
        first: FaceId,
        /// The face with the higher number.
        second: FaceId,
    },
    /// Two faces that share an edge wind opposite ways, and nothing says that the surface breaks there.
    #[error(
        "faces {first} and {second} both run along edge {}-{} in the same direction: make their winding agree, or crease the edge infinitely",
        ends[0], ends[1]
    )]
    Winding {
        /// The face with the lower number.
        first: FaceId,
        /// The face with the higher number.
        second: FaceId,
        /// The ends of the edge, in the direction in which both run.
        ends: [u32; 2],
    },
    /// The winding of faces cannot be made to agree, as on a Moebius strip.
    #[error(
        "the winding cannot agree: the surface has only one side, as can be seen at edge {}-{} of faces {first} and {second}; cut it open there",
        ends[0], ends[1]
    )]
    NotOrientable {
        /// A face at the edge.
        first: FaceId,
        /// The other face at the edge.
        second: FaceId,
        /// The ends of the edge.
        ends: [u32; 2],
    },
    /// A polygon without area cannot be cut into triangles.
    #[error("face {face} has no area: remove it, or move a corner off the line")]
    FlatFace {
        /// Which face.
        face: FaceId,
    },
    /// A polygon that crosses or touches itself cannot be cut into triangles.
    #[error("face {face} crosses or touches itself, as seen along its normal: divide it there")]
    CrossedFace {
        /// Which face.
        face: FaceId,
    },
    /// A crease joins two vertices that share no edge.
    #[error("crease {index} joins vertices {} and {}, but the mesh has no such edge; name the two ends of an edge", ends[0], ends[1])]
    CreaseWithoutEdge {
        /// Which crease, counted from 0.
        index: usize,
        /// The vertices it joins.
        ends: [u32; 2],
    },
    /// A sharpness is negative or not a number.
    #[error("the sharpness of {what} {index} is {sharpness}: it must be 0 or more")]
    Sharpness {
        /// "crease" or "corner".
        what: &'static str,
        /// Which one, counted from 0.
        index: usize,
        /// The value given.
        sharpness: f32,
    },
    /// The vertex has a sharpness that will run out, so that its limit needs further refinement.
    #[error("vertex {vertex} is semi-sharp: refine until its sharpness has run out")]
    SemiSharp {
        /// The vertex.
        vertex: u32,
    },
    /// An edit of a half-edge mesh that would not leave a manifold mesh.
    #[error("edge {}-{} cannot be {edit}: {why}", ends[0], ends[1])]
    Edit {
        /// "flipped", "split" or "collapsed".
        edit: &'static str,
        /// The ends of the edge.
        ends: [u32; 2],
        /// What is in the way.
        why: &'static str,
    },
    /// A half-edge that does not exist, or does no longer.
    #[error("there is no half-edge {half_edge}; it is out of range, or an edit has removed it")]
    NoHalfEdge {
        /// The half-edge.
        half_edge: HalfEdgeId,
    },
    /// Two vertices that share no edge.
    #[error("there is no edge {}-{}; name two neighbours", ends[0], ends[1])]
    NoEdge {
        /// The vertices.
        ends: [u32; 2],
    },
}
