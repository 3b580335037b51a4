//! The new network: boundaries with their triangles, copies, and what points are part of.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;
use subzero::{Crease, EdgeId, Features, TriangleMesh};
use voronoi::{PeriodicPair, Translation};

use crate::mesh::id::id;
use crate::mesh::node_type::Meeting;
use crate::mesh::periodic::PeriodicCopies;
use crate::remesh::lines::DividedLine;
use crate::remesh::outline::Numbering;
use crate::remesh::short_lines::meetings_at;
use crate::remesh::size_field::Surroundings;
use crate::remesh::torus::Moved;
use crate::{Level, Mesh, Network, NetworkError, NodeType, WallSet};

/// The triangles of one boundary, by new points; those inside it come after all points on lines, and are its own.
pub(crate) struct NewBoundary {
    pub(crate) triangles: Vec<[Moved<u32>; 3]>,
    pub(crate) points: Vec<DVec3>,
}

/// What a point is part of, and the walls that it lies on.
#[derive(Clone, Copy)]
pub(super) struct At {
    pub(super) node_type: NodeType,
    pub(super) grains: u8,
    pub(super) walls: WallSet,
}

impl At {
    /// What a vertex of the smooth network is part of. Both ends of a line that becomes a point lie on the same walls.
    pub(super) fn of(level: &Level, vertex: u32) -> Self {
        let vertex = vertex as usize;
        Self {
            node_type: level.node_types[vertex],
            grains: level.grain_counts[vertex],
            walls: level.walls[vertex],
        }
    }
}

/// A network of one level, its points, and the original of each.
pub(crate) struct Assembled {
    pub(crate) network: Network,
    pub(crate) originals: Vec<Moved<u32>>,
    /// By number of originals.
    pub(crate) positions: Vec<DVec3>,
}

/// Puts the network together from boundaries, those that are no copies in order, and the positions of points on lines.
pub(crate) fn assemble(
    network: &Network,
    around: &Surroundings<'_>,
    lines: &[DividedLine],
    numbering: &Numbering,
    mut positions: Vec<DVec3>,
    new: Vec<NewBoundary>,
) -> Result<Assembled, NetworkError> {
    let boundaries = network.boundaries();
    let parts = around.parts;
    let mut of_part: Vec<Vec<[Moved<u32>; 3]>> = vec![Vec::new(); parts.boundaries.len()];
    for (part, new) in parts.originals().zip(new) {
        let first = positions.len();
        let number = |corner: Moved<u32>| {
            let is_inner = corner.original as usize >= numbering.count;
            let moved_by = if is_inner { first - numbering.count } else { 0 };
            Moved { original: corner.original + id(moved_by), ..corner }
        };
        of_part[part] = new.triangles.iter().map(|corners| corners.map(number)).collect();
        positions.extend(new.points);
    }
    for (copy, of) in parts.copies.iter().enumerate() {
        let Some(Moved { original, translation }) = *of else { continue };
        let moved = |corner: Moved<u32>| Moved { translation: corner.translation + translation, ..corner };
        let turned = of_part[original as usize].iter().map(|[a, b, c]| [*a, *c, *b].map(moved));
        of_part[copy] = turned.collect();
    }
    // Originals first, in order, so that the number of an original is its place.
    let mut copies: Vec<Moved<u32>> = of_part.iter().flatten().flatten().copied().collect();
    copies.retain(|point| point.translation != Translation::ZERO);
    copies.par_sort_unstable();
    copies.dedup();
    let count = positions.len();
    let number = |point: Moved<u32>| match point.translation {
        Translation::ZERO => point.original,
        _ => id(count + copies.binary_search(&point).expect("all copies were listed")),
    };
    let (mut triangles, mut boundary_of) = (Vec::new(), Vec::new());
    for (of, boundary) in of_part.iter().zip(&parts.boundaries) {
        triangles.extend(of.iter().map(|corners| corners.map(number)));
        boundary_of.resize(triangles.len(), *boundary);
    }
    let point_count = count + copies.len();
    let mut at: Vec<Option<At>> = vec![None; point_count];
    let mut creases = Vec::new();
    let mut at_lines: BTreeMap<[u32; 2], Meeting> = BTreeMap::new();
    for occurrence in &around.skeleton.occurrences {
        let line = occurrence.line as usize;
        let meeting = occurrence.meeting;
        let along: Vec<u32> =
            numbering.along(around, occurrence, lines[line].points.len()).into_iter().map(number).collect();
        for ends in along.windows(2) {
            creases.push(Crease::infinite([ends[0], ends[1]]));
            at_lines.insert([ends[0].min(ends[1]), ends[0].max(ends[1])], meeting);
        }
        if along.len() > 2 {
            let inner = At { node_type: meeting.node_type, grains: meeting.grains, walls: occurrence.walls };
            along[1..along.len() - 1].iter().for_each(|point| at[*point as usize] = Some(inner));
        }
        let ends = [occurrence.vertices[0], occurrence.vertices[occurrence.vertices.len() - 1]];
        for (point, vertex) in [along[0], along[along.len() - 1]].into_iter().zip(ends) {
            at[point as usize] = Some(At::of(around.level, vertex));
        }
    }
    let corners = of_part
        .iter()
        .zip(&parts.boundaries)
        .flat_map(|(of, boundary)| of.iter().flatten().map(|corner| (*corner, *boundary)));
    for (point, meeting) in meetings_at(&numbering.merged(&around.short), network, corners) {
        if let Some(at) = &mut at[number(point) as usize] {
            (at.node_type, at.grains) = (meeting.node_type, meeting.grains);
        }
    }
    for (of, boundary) in of_part.iter().zip(&parts.boundaries) {
        let boundary = &boundaries[boundary.index()];
        let inside = Meeting::inside(boundary);
        let walls = network.wall_sets().only(boundary.wall);
        for corner in of.iter().flatten().filter(|corner| corner.original as usize >= numbering.count) {
            at[number(*corner) as usize] =
                Some(At { node_type: inside.node_type, grains: inside.grains, walls });
        }
    }
    let at: Vec<At> =
        at.into_iter().map(|at| at.expect("every point is on a line or in a boundary")).collect();
    let corners: Vec<u32> = Vec::new();
    let features = Features { creases: &creases, corners: &corners, ..Features::default() };
    let mesh = TriangleMesh::new(point_count, triangles, &features)?;
    let at_edges = (0..id(mesh.edge_count())).map(|edge| {
        let [a, b] = mesh.edge(EdgeId(edge));
        at_lines.get(&[a.min(b), a.max(b)]).copied().unwrap_or_else(|| {
            let triangle = mesh
                .edge_triangles(EdgeId(edge))
                .map(|pair| pair.map(|triangle| triangle.0))
                .map_or(0, |pair| pair[0]);
            Meeting::inside(&boundaries[boundary_of[triangle as usize].index()])
        })
    });
    let at_edges = at_edges.collect();
    let pairs = (id(count)..).zip(&copies).map(|(secondary, copy)| PeriodicPair {
        secondary,
        primary: copy.original,
        translation: copy.translation,
    });
    let is_periodic = network.domain().is_periodic();
    let level_copies = PeriodicCopies {
        vertices: if is_periodic { pairs.collect() } else { Vec::new() },
        elements: Vec::new(),
    };
    let level = Level {
        mesh: Mesh::Triangles(mesh),
        boundary_of,
        node_types: at.iter().map(|at| at.node_type).collect(),
        grain_counts: at.iter().map(|at| at.grains).collect(),
        generations: vec![0; point_count],
        walls: at.iter().map(|at| at.walls).collect(),
        copies: level_copies,
        at_edges,
    };
    let originals =
        (0..id(count)).map(|original| Moved { original, translation: Translation::ZERO }).chain(copies);
    let network = network.with_level(level).with_merged_lines(&around.short.sides);
    Ok(Assembled { originals: originals.collect(), network, positions })
}

impl Assembled {
    /// All points: originals on their walls, copies where their translations lead.
    pub(crate) fn points(&self) -> Vec<DVec3> {
        let (domain, sets) = (self.network.domain(), self.network.wall_sets());
        let level = self.network.finest_level();
        let walls = &level.walls;
        let on_walls = |(point, moved): (usize, &Moved<u32>)| {
            let place =
                sets.put_on_walls(walls[moved.original as usize], self.positions[moved.original as usize]);
            match moved.translation {
                Translation::ZERO => place,
                translation => sets.put_on_walls(walls[point], place + translation.vector(domain)),
            }
        };
        self.originals.iter().enumerate().map(on_walls).collect()
    }
}
