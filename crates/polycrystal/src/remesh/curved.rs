//! Boundaries for elements of second order: corners and middles of edges on the smooth surface, and such that grains keep their volumes.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;
use subzero::{EdgeId, FaceId, TriangleMesh};
use voronoi::Translation;

use crate::mesh::grouped::Grouped;
use crate::mesh::id::id;
use crate::mesh::quadratic_triangle::QuadraticTriangle;
use crate::mesh::volume::{Cone, volumes_of_grains};
use crate::remesh::assembled::Assembled;
use crate::remesh::gradation::Gradation;
use crate::remesh::lines::DividedLine;
use crate::remesh::outline::Numbering;
use crate::remesh::reference::Reference;
use crate::remesh::size_field::Surroundings;
use crate::remesh::torus::{Moved, seen_from_least};
use crate::remesh::volumes::{hold_on_walls, restore_by};
use crate::solver::least_motion::MovingPoint;
use crate::{Boundary, BoundaryId, Mesh, Network, WallSet};

/// The points of a remeshed network on the smooth surface, and one in the middle of each edge: with it edges are parabolas, and triangles parts of quadratic surfaces.
///
/// Flat triangles have their corners beside the smooth surface, half as far from it as their edges on the mean, for grains to keep their volumes. Curved ones need not.
#[derive(Debug, Clone, PartialEq)]
pub struct CurvedBoundaries {
    /// One for each point of the network.
    corners: Vec<DVec3>,
    /// The point that each corner is a copy of.
    original_corners: Vec<u32>,
    /// One for each edge of the finest level's mesh, by its number, in the unit of the domain; in the plane one for each segment.
    middles: Vec<DVec3>,
    /// The edge that each is a copy of, and the periods from there; itself where it is none.
    originals: Vec<Moved<u32>>,
    walls: Vec<WallSet>,
    /// Whether an original and its copies have no bend.
    is_straight: Vec<bool>,
}

/// The middle of a segment of a line.
pub(crate) struct LineMiddle {
    pub(crate) ends: [Moved<u32>; 2],
    pub(crate) place: DVec3,
    pub(crate) walls: WallSet,
}

impl CurvedBoundaries {
    /// A network in the plane, whose points are on the smooth lines, with the middles of all segments in their order.
    pub(crate) fn of_lines(assembled: &Assembled, middles: Vec<LineMiddle>) -> Self {
        let ends: Vec<[Moved<u32>; 2]> = middles.iter().map(|middle| middle.ends).collect();
        let mut of_lines = Self {
            corners: assembled.points(),
            original_corners: assembled.originals.iter().map(|moved| moved.original).collect(),
            originals: originals(ends.into_iter()),
            middles: middles.iter().map(|middle| middle.place).collect(),
            walls: middles.iter().map(|middle| middle.walls).collect(),
            is_straight: vec![false; middles.len()],
        };
        of_lines.put_on_walls(&assembled.network);
        of_lines
    }

    /// A network whose points are on the smooth surface, with the middles of lines along the smooth lines; within boundaries these are the points of the smooth surface that are nearest to
    /// the middles of straight edges.
    pub(crate) fn new(
        assembled: &Assembled,
        around: &Surroundings<'_>,
        lines: &[DividedLine],
        numbering: &Numbering,
    ) -> Self {
        let network = &assembled.network;
        let (domain, sets, boundaries) = (network.domain(), network.wall_sets(), network.boundaries());
        let level = network.finest_level();
        let Mesh::Triangles(mesh) = &level.mesh else { unreachable!("triangles were assembled") };
        let corners = assembled.points();

        let mut on_lines: BTreeMap<[Moved<u32>; 2], (DVec3, WallSet)> = BTreeMap::new();
        for occurrence in &around.skeleton.occurrences {
            let line = &lines[occurrence.line as usize];
            let along = numbering.along(around, occurrence, line.points.len());
            for (ends, middle) in along.windows(2).zip(&line.middles) {
                let place = *middle + occurrence.translation.vector(domain);
                on_lines.insert(sorted([ends[0], ends[1]]), (place, occurrence.walls));
            }
        }
        let references = references(around, boundaries);

        let originals = originals(mesh.edges().map(|ends| ends.map(|end| assembled.originals[end as usize])));
        // Of an edge on no line all triangles are of one boundary.
        let mut boundary_of_edges = vec![0; mesh.edge_count()];
        for (triangle, boundary) in (0u32..).zip(&level.boundary_of) {
            let edges = mesh.triangle_edges(FaceId(triangle));
            edges.iter().for_each(|edge| boundary_of_edges[edge.index()] = boundary.index());
        }
        let place = |(ends, boundary): ([u32; 2], usize)| {
            let middle = corners[ends[0] as usize].midpoint(corners[ends[1] as usize]);
            if let Some(found) = on_lines.get(&sorted(ends.map(|end| assembled.originals[end as usize]))) {
                return *found;
            }
            match &references[boundary] {
                Some(reference) => (reference.foot(middle, 0).place, WallSet::EMPTY),
                None => (middle, sets.only(boundaries[boundary].wall)),
            }
        };
        let edges: Vec<([u32; 2], usize)> = mesh.edges().zip(boundary_of_edges).collect();
        let (middles, walls) = edges.into_par_iter().map(place).unzip();
        let is_straight = vec![false; mesh.edge_count()];
        let original_corners = assembled.originals.iter().map(|moved| moved.original).collect();
        let mut curved = Self { corners, original_corners, middles, originals, walls, is_straight };
        curved.put_on_walls(network);
        curved
    }

    /// The points of the network.
    pub fn corners(&self) -> &[DVec3] {
        &self.corners
    }

    /// The middle of each edge of the finest level's mesh, by its number; in the plane of each segment.
    pub fn middles(&self) -> &[DVec3] {
        &self.middles
    }

    /// Whether an edge was made straight.
    pub fn is_straight(&self, edge: EdgeId) -> bool {
        self.is_straight[self.originals[edge.index()].original as usize]
    }

    /// Moves corners, and middles half as far as each end of their edges.
    ///
    /// # Panics
    /// When there is not one motion for each point of the network.
    pub fn slide(&mut self, network: &Network, motions: &[DVec3]) {
        assert_eq!(motions.len(), self.corners.len(), "there must be one motion for each point");
        self.corners.iter_mut().zip(motions).for_each(|(corner, by)| *corner += *by);
        let level = network.finest_level();
        for (edge, middle) in self.middles.iter_mut().enumerate() {
            *middle +=
                ends(&level.mesh, edge).map(|end| 0.5 * motions[end as usize]).into_iter().sum::<DVec3>();
        }
        self.put_on_walls(network);
    }

    /// Puts some corners where the network has its points, and makes some edges straight, at all that are the same a period away too.
    ///
    /// # Panics
    /// When there are no such edges or points.
    pub fn straighten(
        &mut self,
        network: &Network,
        points: &[DVec3],
        corners: impl Iterator<Item = u32>,
        edges: impl Iterator<Item = EdgeId>,
    ) {
        let mut is_put_back = vec![false; self.corners.len()];
        corners.for_each(|corner| is_put_back[self.original_corners[corner as usize] as usize] = true);
        for (corner, original) in self.original_corners.iter().enumerate() {
            if is_put_back[*original as usize] {
                self.corners[corner] = points[corner];
            }
        }
        edges.for_each(|edge| self.is_straight[self.originals[edge.index()].original as usize] = true);
        let level = network.finest_level();
        for edge in (0..self.middles.len()).filter(|edge| self.is_straight[*edge]) {
            let [from, to] = ends(&level.mesh, edge).map(|end| self.corners[end as usize]);
            self.middles[edge] = from.midpoint(to);
        }
        self.put_on_walls(network);
    }

    /// Moves the middles of edges that are not straight so that grains, within quadratic triangles, have the volumes of their cells.
    ///
    /// Returns the largest error of a grain, as a share of its volume.
    ///
    /// # Panics
    /// When the network is another than the one that they were made for.
    pub fn restore_volumes(&mut self, network: &Network) -> f64 {
        let move_by = |curved: &mut Self, motions: Vec<DVec3>| {
            curved.middles.iter_mut().zip(motions).for_each(|(place, by)| *place += by);
            curved.put_on_walls(network);
        };
        restore_by(
            self,
            (network.cell_volumes(), network.fills_domain()),
            |curved| curved.grain_volumes(network),
            |curved| curved.moving_points(network),
            move_by,
        )
    }

    /// The volume of each grain within quadratic triangles.
    ///
    /// # Panics
    /// When the network is another than the one that they were made for.
    pub fn grain_volumes(&self, network: &Network) -> Vec<f64> {
        let level = network.finest_level();
        let mesh = match &level.mesh {
            Mesh::Triangles(mesh) => mesh,
            Mesh::Segments(mesh) => return self.grain_areas(network, mesh.segments()),
        };
        let boundary_count = network.boundaries().len();
        let triangles = triangles_of_boundaries(boundary_count, &level.boundary_of);
        let cone = |boundary: usize| {
            let triangles = triangles.of(boundary);
            let apex = triangles
                .first()
                .map_or(DVec3::ZERO, |first| self.corners[mesh.triangles()[*first as usize][0] as usize]);
            let (mut volume, mut area) = (0.0, DVec3::ZERO);
            for triangle in triangles {
                for (_, place, normal) in self.quadratic(mesh, *triangle).at_abscissas() {
                    volume += (place - apex).dot(normal) / 3.0;
                    area += normal;
                }
            }
            Cone::new(apex, volume, area, voronoi::Dimension::Three)
        };
        let cones: Vec<Cone> = (0..boundary_count).into_par_iter().map(cone).collect();
        volumes_of_grains(network.boundaries(), &cones, network.grain_count())
    }

    fn quadratic(&self, mesh: &TriangleMesh, triangle: u32) -> QuadraticTriangle {
        // An edge of this number joins the corner of the same number and the next.
        QuadraticTriangle {
            corners: mesh.triangles()[triangle as usize].map(|corner| self.corners[corner as usize]),
            middles: mesh.triangle_edges(FaceId(triangle)).map(|edge| self.middles[edge.index()]),
        }
    }

    /// How the volumes of grains grow as each original moves, which stands for its copies.
    fn moving_points(&self, network: &Network) -> Vec<MovingPoint> {
        let level = network.finest_level();
        let mesh = match &level.mesh {
            Mesh::Triangles(mesh) => mesh,
            Mesh::Segments(mesh) => return self.moving_on_lines(network, mesh.segments()),
        };
        let mut moving = of_equal_weight(self.middles.len());
        for (triangle, boundary) in (0u32..).zip(&level.boundary_of) {
            let edges = mesh.triangle_edges(FaceId(triangle));
            let mut normals = [DVec3::ZERO; 3];
            for (weights, _, normal) in self.quadratic(mesh, triangle).at_abscissas() {
                let of_middles = [0, 1, 2].map(|k| 4.0 * weights[k] * weights[(k + 1) % 3]);
                normals.iter_mut().zip(of_middles).for_each(|(sum, share)| *sum += normal * share);
            }
            for (edge, normal) in edges.into_iter().zip(normals) {
                let original = self.originals[edge.index()].original as usize;
                if self.is_straight[original] {
                    continue;
                }
                for (grain, sign) in network.boundaries()[boundary.index()].signed_grains() {
                    *moving[original].gradients.entry(grain.0).or_default() += normal * sign;
                }
            }
        }
        hold_on_walls(network, &mut moving, self.originals.iter().zip(&self.walls));
        moving
    }

    /// In the plane, the area of each grain within parabolas.
    fn grain_areas(&self, network: &Network, segments: &[[u32; 2]]) -> Vec<f64> {
        let level = network.finest_level();
        let mut areas = network.grain_volumes(&*level, &self.corners);
        for (([from, to], middle), boundary) in segments.iter().zip(&self.middles).zip(&level.boundary_of) {
            let [from, to] = [from, to].map(|end| self.corners[*end as usize]);
            // A parabola encloses two thirds of the parallelogram around it with its chord.
            let bulge = 2.0 / 3.0 * (*middle - from.midpoint(to)).dot((to - from).cross(DVec3::Z));
            for (grain, sign) in network.boundaries()[boundary.index()].signed_grains() {
                areas[grain.index()] += sign * bulge;
            }
        }
        areas
    }

    /// As of [`Self::moving_points`] in the plane.
    fn moving_on_lines(&self, network: &Network, segments: &[[u32; 2]]) -> Vec<MovingPoint> {
        let level = network.finest_level();
        let mut moving = of_equal_weight(self.middles.len());
        for (segment, ([from, to], boundary)) in segments.iter().zip(&level.boundary_of).enumerate() {
            let original = self.originals[segment].original as usize;
            if self.is_straight[original] {
                continue;
            }
            let normal =
                (self.corners[*to as usize] - self.corners[*from as usize]).cross(DVec3::Z) * (2.0 / 3.0);
            for (grain, sign) in network.boundaries()[boundary.index()].signed_grains() {
                *moving[original].gradients.entry(grain.0).or_default() += normal * sign;
            }
        }
        hold_on_walls(network, &mut moving, self.originals.iter().zip(&self.walls));
        moving
    }

    /// Puts originals on their walls, and copies where their translations lead.
    fn put_on_walls(&mut self, network: &Network) {
        let (domain, sets) = (network.domain(), network.wall_sets());
        // An original comes before its copies.
        for edge in 0..self.middles.len() {
            let Moved { original, translation } = self.originals[edge];
            let mut place = self.middles[original as usize];
            if translation != Translation::ZERO {
                place += translation.vector(domain);
            }
            self.middles[edge] = sets.put_on_walls(self.walls[edge], place);
        }
    }
}

/// The ends of an edge, in the plane of a segment.
fn ends(mesh: &Mesh, edge: usize) -> [u32; 2] {
    match mesh {
        Mesh::Triangles(mesh) => mesh.edge(EdgeId(id(edge))),
        Mesh::Segments(mesh) => mesh.segments()[edge],
    }
}

/// Middles that move in proportion to the area that they sweep, so that short edges bend no more than long ones. If all moved as far, an edge of a fifteenth of the others' length, where a line
/// ends at the side of a box that cuts grains, was bent by a quarter of its length.
fn of_equal_weight(count: usize) -> Vec<MovingPoint> {
    vec![MovingPoint { weight: 1.0, ..MovingPoint::default() }; count]
}

/// Of edges by their ends, the first that is the same on the torus, and the periods from there.
fn originals(edges: impl Iterator<Item = [Moved<u32>; 2]>) -> Vec<Moved<u32>> {
    let mut known: BTreeMap<[Moved<u32>; 2], (u32, Translation)> = BTreeMap::new();
    let moved = |(edge, ends): (u32, [Moved<u32>; 2])| {
        let (key, from) = seen_from_least(ends);
        let (original, there) = *known.entry(key).or_insert((edge, from));
        Moved { original, translation: from - there }
    };
    (0u32..).zip(edges).map(moved).collect()
}

/// The smooth surface of each boundary; none of walls, which are flat.
fn references(around: &Surroundings<'_>, boundaries: &[Boundary]) -> Vec<Option<Reference>> {
    let triangles = triangles_of_boundaries(boundaries.len(), &around.level.boundary_of);
    let reference = |boundary: usize| {
        let of_boundary = triangles.of(boundary);
        if of_boundary.is_empty() || boundaries[boundary].wall.is_some() {
            return None;
        }
        let corners = || of_boundary.iter().map(|triangle| around.mesh.triangles()[*triangle as usize]);
        let mut vertices: Vec<u32> = corners().flatten().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let own = |vertex: u32| id(vertices.binary_search(&vertex).expect("all were listed"));
        let own_corners = corners().map(|corners| corners.map(own)).collect();
        let points = vertices.iter().map(|vertex| around.points[*vertex as usize]).collect();
        Some(Reference::new(points, vec![0.0; vertices.len()], own_corners, Gradation::default()))
    };
    (0..boundaries.len()).into_par_iter().map(reference).collect()
}

fn triangles_of_boundaries(boundary_count: usize, boundary_of: &[BoundaryId]) -> Grouped<u32> {
    Grouped::new(boundary_count, boundary_of.iter().map(|boundary| boundary.index()).zip(0u32..))
}

fn sorted([a, b]: [Moved<u32>; 2]) -> [Moved<u32>; 2] {
    [a.min(b), a.max(b)]
}
