//! The new network in the plane: lines, and triangles between them.

use std::collections::BTreeMap;

use glam::DVec3;
use subzero::CurveMesh;
use voronoi::{PeriodicPair, Translation};

use crate::mesh::id::id;
use crate::mesh::node_type::Meeting;
use crate::mesh::periodic::PeriodicCopies;
use crate::remesh::assembled::{Assembled, At, NewBoundary};
use crate::remesh::curved::{CurvedBoundaries, LineMiddle};
use crate::remesh::lines::DividedLine;
use crate::remesh::outline::Numbering;
use crate::remesh::short_lines::meetings_at;
use crate::remesh::size_field::Surroundings;
use crate::remesh::torus::Moved;
use crate::{BoundaryId, GrainId, Level, Mesh, Network, NetworkError};

/// Where a line stands, as part of a boundary.
struct Piece {
    boundary: BoundaryId,
    /// The first of its segments on the smooth network: pieces of a boundary follow each other as these do.
    first: usize,
    /// By number among all occurrences of lines.
    occurrence: usize,
    /// Whether the boundary runs the other way.
    is_reversed: bool,
}

/// A network of lines, and the triangles between them.
pub(super) struct AssembledPlane {
    pub(super) assembled: Assembled,
    /// By points of the network, then by inner ones; grain by grain.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) grains: Vec<GrainId>,
    pub(super) inner: Vec<DVec3>,
    pieces: Vec<Piece>,
}

/// Puts the network together from divided lines, and from the triangles of each part.
pub(super) fn assemble(
    network: &Network,
    smooth: &Level,
    around: &Surroundings<'_>,
    (lines, numbering): (&[DividedLine], &Numbering),
    positions: Vec<DVec3>,
    parts: Vec<NewBoundary>,
) -> Result<AssembledPlane, NetworkError> {
    let pieces = pieces(smooth, around);
    let occurrences = &around.skeleton.occurrences;
    let along = |piece: &Piece| {
        let occurrence = &occurrences[piece.occurrence];
        let mut along = numbering.along(around, occurrence, lines[occurrence.line as usize].points.len());
        let mut vertices = [occurrence.vertices[0], occurrence.vertices[occurrence.vertices.len() - 1]];
        if piece.is_reversed {
            along.reverse();
            vertices.reverse();
        }
        (along, vertices)
    };
    let mut copies: Vec<Moved<u32>> = pieces.iter().flat_map(|piece| along(piece).0).collect();
    copies.retain(|point| point.translation != Translation::ZERO);
    copies.sort_unstable();
    copies.dedup();
    let number = |point: Moved<u32>| match point.translation {
        Translation::ZERO => point.original,
        _ => id(numbering.count + copies.binary_search(&point).expect("all copies were listed")),
    };
    let point_count = numbering.count + copies.len();
    let mut at: Vec<Option<At>> = vec![None; point_count];
    let (mut segments, mut boundary_of, mut corners) = (Vec::new(), Vec::new(), Vec::new());
    for piece in &pieces {
        let (points, vertices) = along(piece);
        let points: Vec<u32> = points.into_iter().map(number).collect();
        let Meeting { node_type, grains, .. } =
            Meeting::inside(&network.boundaries()[piece.boundary.index()]);
        let inside = At { node_type, grains, walls: occurrences[piece.occurrence].walls };
        points.iter().for_each(|point| at[*point as usize] = Some(inside));
        for (point, vertex) in [points[0], points[points.len() - 1]].into_iter().zip(vertices) {
            at[point as usize] = Some(At::of(smooth, vertex));
            if around.skeleton.is_node[vertex as usize] {
                corners.push(point);
            }
        }
        segments.extend(points.windows(2).map(|ends| [ends[0], ends[1]]));
        boundary_of.resize(segments.len(), piece.boundary);
    }
    let ends = pieces.iter().flat_map(|piece| {
        let points = along(piece).0;
        [points[0], points[points.len() - 1]].map(|point| (point, piece.boundary))
    });
    for (point, meeting) in meetings_at(&numbering.merged(&around.short), network, ends) {
        if let Some(at) = &mut at[number(point) as usize] {
            (at.node_type, at.grains) = (meeting.node_type, meeting.grains);
        }
    }
    let at: Vec<At> = at.into_iter().map(|at| at.expect("every point is on a line")).collect();
    let pairs = (id(numbering.count)..).zip(&copies).map(|(secondary, copy)| PeriodicPair {
        secondary,
        primary: copy.original,
        translation: copy.translation,
    });
    let vertices = if network.domain().is_periodic() { pairs.collect() } else { Vec::new() };
    let level = Level {
        mesh: Mesh::Segments(CurveMesh::new(point_count, segments, &corners)?),
        boundary_of,
        node_types: at.iter().map(|at| at.node_type).collect(),
        grain_counts: at.iter().map(|at| at.grains).collect(),
        generations: vec![0; point_count],
        walls: at.iter().map(|at| at.walls).collect(),
        copies: PeriodicCopies { vertices, elements: Vec::new() },
        at_edges: Vec::new(),
    };
    let mut inner = Vec::new();
    let mut filled: Vec<(GrainId, [u32; 3])> = Vec::new();
    for (part, of) in parts.into_iter().zip(&around.parts.boundaries) {
        let first = point_count + inner.len();
        let corner = |corner: Moved<u32>| match (corner.original as usize).checked_sub(numbering.count) {
            Some(own) => id(first + own),
            None => number(corner),
        };
        // Triangles in the plane have the number of their grain for a boundary.
        filled.extend(part.triangles.into_iter().map(|corners| (GrainId(of.0), corners.map(corner))));
        inner.extend(part.points);
    }
    filled.sort_by_key(|(grain, _)| *grain);
    let (grains, triangles) = filled.into_iter().unzip();
    let unmoved = |original| Moved { original, translation: Translation::ZERO };
    let originals = (0..id(numbering.count)).map(unmoved).chain(copies.iter().copied()).collect();
    let network = network.with_level(level).with_merged_lines(&around.short.sides);
    let assembled = Assembled { network, originals, positions };
    Ok(AssembledPlane { assembled, triangles, grains, inner, pieces })
}

/// All occurrences of lines, boundary by boundary, in the order of the smooth network.
fn pieces(smooth: &Level, around: &Surroundings<'_>) -> Vec<Piece> {
    let Mesh::Segments(segments) = &smooth.mesh else { unreachable!("a network in the plane has lines") };
    let segments = segments.segments();
    let by_ends: BTreeMap<[u32; 2], usize> =
        segments.iter().enumerate().map(|(segment, ends)| (sorted(*ends), segment)).collect();
    let mut pieces = Vec::new();
    for (number, occurrence) in around.skeleton.occurrences.iter().enumerate() {
        let steps = occurrence.vertices.windows(2).map(|ends| by_ends[&sorted([ends[0], ends[1]])]);
        let own: Vec<usize> = steps.collect();
        pieces.push(Piece {
            boundary: smooth.boundary_of[own[0]],
            first: own.iter().copied().min().unwrap_or(own[0]),
            occurrence: number,
            is_reversed: segments[own[0]][0] != occurrence.vertices[0],
        });
    }
    pieces.sort_by_key(|piece| (piece.boundary, piece.first));
    pieces
}

impl AssembledPlane {
    /// The points, as long as they are on the smooth lines, and the middles of all segments along these.
    pub(super) fn curved(
        &self,
        around: &Surroundings<'_>,
        lines: &[DividedLine],
        numbering: &Numbering,
    ) -> CurvedBoundaries {
        let domain = self.assembled.network.domain();
        let mut middles = Vec::new();
        for piece in &self.pieces {
            let occurrence = &around.skeleton.occurrences[piece.occurrence];
            let line = &lines[occurrence.line as usize];
            let along = numbering.along(around, occurrence, line.points.len());
            let first = middles.len();
            middles.extend(along.windows(2).zip(&line.middles).map(|(ends, middle)| LineMiddle {
                ends: [ends[0], ends[1]],
                place: *middle + occurrence.translation.vector(domain),
                walls: occurrence.walls,
            }));
            if piece.is_reversed {
                middles[first..].reverse();
            }
        }
        CurvedBoundaries::of_lines(&self.assembled, middles)
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
