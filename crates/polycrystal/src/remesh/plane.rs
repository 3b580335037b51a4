//! Grains in the plane: lines divided as in space, and triangles of the size asked for between them.
//!
//! A grain is to its lines what in space a flat boundary is to those that it ends at, and is filled in the same way. Triangles to start from are those of a constrained Delaunay triangulation.

mod assembled;
mod background;

use std::collections::BTreeMap;

use glam::{BVec3, DVec3};

use crate::mesh::id::id;
use crate::remesh::divide_lines::divide_lines;
use crate::remesh::outline::Numbering;
use crate::remesh::parts::Parts;
use crate::remesh::short_lines::ShortLines;
use crate::remesh::size_field::{SizeField, Surroundings};
use crate::remesh::skeleton::Skeleton;
use crate::remesh::torus::Torus;
use crate::remesh::{
    ElementSize, Faulty, RemeshTuning, Remeshed, positions_on_lines, shaped_parts, until_valid, volumes,
};
use crate::{BoundaryId, Fault, Faults, GrainId, Level, Mesh, Network, NetworkError, Side, validate};
use assembled::assemble;

/// Triangles that fill grains in the plane.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PlaneMesh {
    /// The points of the network, by the same numbers, then those inside grains.
    pub points: Vec<DVec3>,
    /// Number of points of the network.
    pub line_points: usize,
    /// Grain by grain, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// The grain of each.
    pub grains: Vec<GrainId>,
    /// The middles of edges that may bend, by their ends, the smaller number first.
    pub middles: BTreeMap<[u32; 2], DVec3>,
}

impl PlaneMesh {
    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|corner| self.points[corner as usize])
    }
}

/// As of [`Network::remeshed`], of a network in the plane.
pub(super) fn remeshed(
    network: &Network,
    lines: &Level,
    points: &[DVec3],
    size: &ElementSize,
    cut: BVec3,
    tuning: &RemeshTuning,
) -> Result<Remeshed, NetworkError> {
    // A finer level has the vertices of a coarser one first.
    let points = &points[..lines.vertex_count()];
    let lengths = [size.length, tuning.shortest * size.length];
    let (level, points) = &background::filled(network, lines, points, lengths)?;
    let torus = Torus::new(network, level, points, cut)?;
    let Mesh::Triangles(mesh) = &level.mesh else { unreachable!("it was filled with triangles") };
    let sets = network.wall_sets();
    // Between two lines of one boundary that go on around a corner.
    let is_corner = |vertex: usize| sets.walls(level.walls[vertex]).len() > 1;
    let skeleton = Skeleton::new((level, mesh), sets, &torus, is_corner);
    let parts = Parts::without_copies((level, mesh), &skeleton);
    // Triangles in the plane have the number of their grain for a boundary.
    let sides = |grain: BoundaryId| [Side::Grain(GrainId(grain.0)); 2];
    let mut around = Surroundings {
        short: ShortLines::default(),
        level,
        mesh,
        points,
        torus: &torus,
        skeleton: &skeleton,
        parts: &parts,
        is_plane: true,
    };
    until_valid(size, tuning, |halved, refinements| {
        if size.merges_short_lines {
            around.short = ShortLines::new(network, &around, sides, tuning.short_line * size.length, halved);
        }
        let sizes = SizeField::new(&around, size, halved, tuning);
        let divided = divide_lines(&around, &sizes, tuning);
        let numbering = Numbering::new(&around, &divided);
        let positions = positions_on_lines(&around, &divided, &numbering);
        let shaped = shaped_parts(network, &around, &sizes, (&divided, &numbering, &positions), tuning);
        let mut new = assemble(network, lines, &around, (&divided, &numbering), positions, shaped)?;
        let curved = size.has_middles.then(|| new.curved(&around, &divided, &numbering));
        volumes::restore(&mut new.assembled);
        let points = new.assembled.points();
        let certificate = match validate(&new.assembled.network, &points) {
            Ok(certificate) => certificate,
            Err(faults) => return Ok(Err(Faulty::of(faults, &new.assembled.network, &points))),
        };
        let network = new.assembled.network;
        let mesh = PlaneMesh {
            line_points: points.len(),
            points: points.iter().copied().chain(new.inner).collect(),
            triangles: new.triangles,
            grains: new.grains,
            middles: BTreeMap::new(),
        };
        let flat: Vec<usize> = (0..mesh.triangles.len())
            .filter(|triangle| doubled_area(mesh.corners(*triangle)) <= 0.0)
            .collect();
        if !flat.is_empty() {
            let faults = flat.iter().map(|triangle| Fault::NoArea { element: id(*triangle) }).collect();
            let places = flat.iter().map(|triangle| mesh.corners(*triangle)[0]).collect();
            return Ok(Err(Faulty { faults: Faults(faults), places }));
        }
        let triangles = Some(mesh);
        let merged = around.short.merged.clone();
        Ok(Ok(Remeshed { network, points, certificate, refinements, merged, curved, triangles }))
    })
}

fn doubled_area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).z
}
