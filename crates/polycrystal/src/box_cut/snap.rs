//! Points near a plane of the cut move into it.
//!
//! A plane that passes near a point cuts slivers from the triangles around it. So before the cut, such points move into the plane:
//! along their boundary or line where they can. A point in the plane must not be where a grain merely touches it: around each of its
//! points, what of a grain's surface lies above hangs together, and what lies below.

use glam::DVec3;
use subzero::{FaceId, VertexRule};
use voronoi::{Domain, PeriodicVertex, Translation};

use crate::box_cut::periodic_axes;
use crate::box_cut::pieces::Torus;
use crate::mesh::triangle_quality::squared_sine;
use crate::{BoundaryId, Freedom, GrainId, Mesh, Network};

/// Distance from a plane, in mean lengths of the edges at a point, within which the point moves into it.
pub(crate) const NEAR: f64 = 0.35;

/// How far beyond the plane, in the same unit, a point goes that cannot lie in it: far enough to be told from it.
const BEYOND: f64 = 0.02;

/// Share of the sine of the smallest angle around a point that has to be left when it moves, where the angle is below the next one.
const LEAST_SHARE: f64 = 0.8;

/// Sine of an angle that is good enough (14 degrees).
const GOOD_SINE: f64 = 0.25;

/// Cosine of the largest angle by which a triangle may turn (8 degrees). At 30 degrees, boundaries that meet a plane at a small angle
/// leave zigzags in it. Of three networks (20, 30, 60 grains, two levels) the angle that a hundredth of the triangles is below falls from
/// 11.5 to 10.2, 12.6 to 11.7 and 13.3 to 12.4 degrees for it.
const LARGEST_TURN: f64 = 0.99;

/// Share of a motion along a boundary or line that must lead toward the plane; else the point leaves the boundary.
const LEAST_GAIN: f64 = 0.2;

/// Passes over all points: where a point could not move, its neighbours may have made room.
const PASSES: usize = 3;

/// Moves points near the planes of the cut into them; those of flat boundaries within these alone.
pub(crate) fn snap(network: &Network, torus: &mut Torus, points: &[DVec3], is_flat: bool) {
    let level = network.finest_level();
    let Mesh::Triangles(mesh) = &level.mesh else { return };
    let triangles = mesh.triangles();
    let mut stars = vec![Vec::new(); points.len()];
    for (number, corners) in (0u32..).zip(triangles) {
        corners.iter().for_each(|corner| stars[*corner as usize].push(number));
    }
    let mut vertices_of = vec![Vec::new(); points.len()];
    for (vertex, original) in (0u32..).zip(&torus.originals) {
        vertices_of[original.vertex as usize].push(vertex);
    }
    let start: Vec<DVec3> = normals(triangles, points);
    let freedoms = (0u32..)
        .zip(&stars)
        .map(|(vertex, star)| {
            let walls = network.freedom(level.walls[vertex as usize]);
            let along = match mesh.vertex_rule(vertex) {
                VertexRule::Smooth => {
                    let normal: DVec3 = star.iter().map(|triangle| start[*triangle as usize]).sum();
                    normal.try_normalize().map(Freedom::InPlane)
                }
                VertexRule::Crease => {
                    let edges = star.iter().flat_map(|triangle| mesh.triangle_edges(FaceId(*triangle)));
                    let ends = edges.filter(|edge| mesh.is_crease(*edge)).map(|edge| mesh.edge(edge));
                    let others = ends.filter(|ends| ends.contains(&vertex)).flatten();
                    let others: Vec<u32> = others.filter(|other| *other != vertex).collect();
                    let first = others.first().copied();
                    let second = others.iter().copied().find(|other| Some(*other) != first);
                    first.zip(second).and_then(|(first, second)| {
                        let along = points[first as usize] - points[second as usize];
                        along.try_normalize().map(Freedom::Along)
                    })
                }
                _ => None,
            };
            let along = along.unwrap_or(Freedom::Nowhere).and(walls);
            [along, if is_flat { Freedom::Nowhere } else { walls }]
        })
        .collect();
    let boundary_sides = |boundary: &BoundaryId| network.boundaries()[boundary.index()].sides;
    let sides = level.boundary_of.iter().map(|boundary| boundary_sides(boundary).map(|side| side.grain()));
    let mut snapping = Snapping {
        domain: network.domain(),
        torus,
        triangles,
        grains: sides.collect(),
        stars,
        vertices_of,
        start,
        freedoms,
    };
    for _ in 0..PASSES {
        let mut moved = false;
        for (_, point, axis) in snapping.candidates() {
            moved |= snapping.try_to_move(point, axis);
        }
        if !moved {
            break;
        }
    }
}

struct Snapping<'a> {
    domain: &'a Domain,
    torus: &'a mut Torus,
    triangles: &'a [[u32; 3]],
    /// Of each triangle, the grains on both sides.
    grains: Vec<[Option<GrainId>; 2]>,
    /// The triangles at each vertex.
    stars: Vec<Vec<u32>>,
    /// The vertices that are copies of each point, itself one of them.
    vertices_of: Vec<Vec<u32>>,
    /// The normal of each triangle at first.
    start: Vec<DVec3>,
    /// How each vertex can move: first along its boundary or line, then off it.
    freedoms: Vec<[Freedom; 2]>,
}

/// Where a point is, to be put back there.
type State = (DVec3, Translation, [bool; 3]);

impl Snapping<'_> {
    /// The points near planes and the axes across these, nearest first.
    fn candidates(&self) -> Vec<(f64, u32, usize)> {
        let mut candidates = Vec::new();
        for (point, vertices) in (0u32..).zip(&self.vertices_of) {
            if vertices.is_empty() {
                continue;
            }
            for axis in periodic_axes(self.domain).filter(|axis| !self.torus.planes[point as usize][*axis]) {
                let position = self.torus.positions[point as usize][axis];
                let distance =
                    (position - self.domain.lower()[axis]).min(self.domain.upper()[axis] - position);
                // Most points are far from all planes, whatever their edges.
                let length = self.mean_edge(vertices[0]);
                if distance < NEAR * length {
                    candidates.push((distance / length, point, axis));
                }
            }
        }
        candidates.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        candidates
    }

    fn mean_edge(&self, vertex: u32) -> f64 {
        let star = &self.stars[vertex as usize];
        let others = star.iter().flat_map(|triangle| self.triangles[*triangle as usize]);
        let at = self.position(vertex);
        let sum: f64 =
            others.filter(|other| *other != vertex).map(|other| self.position(other).distance(at)).sum();
        sum / (2 * star.len()).max(1) as f64
    }

    fn corner(&self, vertex: u32) -> PeriodicVertex {
        self.torus.corner(vertex)
    }

    fn position(&self, vertex: u32) -> DVec3 {
        let PeriodicVertex { vertex: point, translation } = self.corner(vertex);
        self.torus.positions[point as usize] + translation.vector(self.domain)
    }

    /// Moves a point into the plane, or where it cannot lie there, to its other side. Whether it moved.
    fn try_to_move(&mut self, point: u32, axis: usize) -> bool {
        let position = self.torus.positions[point as usize];
        let [below, above] =
            [position[axis] - self.domain.lower()[axis], self.domain.upper()[axis] - position[axis]];
        let is_above = below < above;
        let to_plane = if is_above { -below } else { above };
        let beyond = BEYOND * self.mean_edge(self.vertices_of[point as usize][0]) * to_plane.signum();
        for freedom in 0..2 {
            if self.moved(point, axis, freedom, to_plane, is_above, true)
                || self.moved(point, axis, freedom, to_plane + beyond, is_above, false)
            {
                return true;
            }
        }
        false
    }

    /// Moves a point by so much across the plane, if that is allowed.
    fn moved(
        &mut self,
        point: u32,
        axis: usize,
        freedom: usize,
        by: f64,
        was_above: bool,
        into_plane: bool,
    ) -> bool {
        let index = point as usize;
        let mut free = self.freedoms[index][freedom];
        for held in (0..3).filter(|held| self.torus.planes[index][*held]) {
            free = free.and(Freedom::InPlane(DVec3::AXES[held]));
        }
        let direction = free.project(DVec3::AXES[axis]);
        let gain = direction[axis];
        if gain < LEAST_GAIN {
            return false;
        }
        let before: State = (self.torus.positions[index], self.torus.moved[index], self.torus.planes[index]);
        let least_before = self.least_sine(point);
        let (mut position, translation, mut planes) = before;
        position += direction * (by / gain);
        let mut step = Translation::ZERO;
        if into_plane {
            position[axis] = self.domain.lower()[axis];
            planes[axis] = true;
            step.0[axis] = i8::from(!was_above);
        }
        for held in (0..3).filter(|held| planes[*held]) {
            position[held] = self.domain.lower()[held];
        }
        // Beyond a plane, the place is at the opposite wall.
        for other in periodic_axes(self.domain).filter(|other| !planes[*other]) {
            if position[other] <= self.domain.lower()[other] {
                position[other] += self.domain.size()[other];
                step.0[other] -= 1;
            } else if position[other] >= self.domain.upper()[other] {
                position[other] -= self.domain.size()[other];
                step.0[other] += 1;
            }
        }
        let translation = translation + step;
        (self.torus.positions[index], self.torus.moved[index], self.torus.planes[index]) =
            (position, translation, planes);
        let least = self.least_sine(point);
        let is_good = least >= (LEAST_SHARE * least_before).min(GOOD_SINE) && !self.is_turned(point);
        if is_good && self.is_cut_well(point, axis, into_plane) {
            return true;
        }
        (self.torus.positions[index], self.torus.moved[index], self.torus.planes[index]) = before;
        false
    }

    fn triangles_at(&self, point: u32) -> impl Iterator<Item = u32> {
        self.vertices_of[point as usize]
            .iter()
            .flat_map(|vertex| self.stars[*vertex as usize].iter().copied())
    }

    /// The sine of the smallest angle of the triangles at a point.
    fn least_sine(&self, point: u32) -> f64 {
        let of_triangle = |triangle: u32| {
            squared_sine(self.triangles[triangle as usize].map(|corner| self.position(corner)))
        };
        self.triangles_at(point).map(of_triangle).fold(f64::INFINITY, f64::min).sqrt()
    }

    fn is_turned(&self, point: u32) -> bool {
        self.triangles_at(point).any(|triangle| {
            let [a, b, c] = self.triangles[triangle as usize].map(|corner| self.position(corner));
            let (normal, start) = ((b - a).cross(c - a), self.start[triangle as usize]);
            normal.dot(start) < LARGEST_TURN * normal.length() * start.length()
        })
    }

    /// Whether grains around a point that has moved meet the plane as they should.
    fn is_cut_well(&self, point: u32, axis: usize, into_plane: bool) -> bool {
        self.vertices_of[point as usize].iter().all(|vertex| {
            let star = &self.stars[*vertex as usize];
            let neighbors = star.iter().flat_map(|triangle| self.triangles[*triangle as usize]);
            // What is beyond the plane now must leave nothing of the star behind.
            let own_side = |other: u32| {
                self.corner(other).translation.0[axis] == self.corner(*vertex).translation.0[axis]
            };
            let is_behind = |other: u32| !own_side(other) && !self.is_on_plane(other, axis);
            if !into_plane && neighbors.clone().any(is_behind) {
                return false;
            }
            let mut checked: Vec<u32> = neighbors.filter(|other| self.is_on_plane(*other, axis)).collect();
            checked.sort_unstable();
            checked.dedup();
            checked.into_iter().all(|vertex| self.meets_plane_well(vertex, axis))
        })
    }

    fn is_on_plane(&self, vertex: u32, axis: usize) -> bool {
        self.torus.planes[self.torus.originals[vertex as usize].vertex as usize][axis]
    }

    /// Whether, around a vertex in a plane, what of each grain's surface lies above hangs together, and what lies below, and neither is all.
    fn meets_plane_well(&self, vertex: u32, axis: usize) -> bool {
        let plane = self.corner(vertex).translation.0[axis];
        let side = |other: u32| match self.corner(other).translation.0[axis] - plane {
            0 if self.is_on_plane(other, axis) => 0,
            0.. => 1usize,
            _ => 2,
        };
        let star = &self.stars[vertex as usize];
        let mut grains: Vec<GrainId> =
            star.iter().flat_map(|triangle| self.grains[*triangle as usize]).flatten().collect();
        grains.sort_unstable();
        grains.dedup();
        grains.into_iter().all(|grain| {
            // In the plane, above and below: vertices of the ring, and edges between two of them.
            let (mut vertices, mut edges) = ([0; 3], [0; 3]);
            for triangle in star {
                let sides = self.grains[*triangle as usize];
                if !sides.contains(&Some(grain)) {
                    continue;
                }
                let corners = self.triangles[*triangle as usize];
                let position =
                    corners.iter().position(|corner| *corner == vertex).expect("a star has its centre");
                let mut ends = [corners[(position + 1) % 3], corners[(position + 2) % 3]];
                if sides[0] != Some(grain) {
                    ends.reverse();
                }
                let [first, second] = ends.map(side);
                vertices[first] += 1;
                edges[first] += usize::from(first == second);
            }
            let hangs_together = |side: usize| vertices[side] == 0 || vertices[side] == edges[side] + 1;
            let is_crossed = (vertices[1] > 0 && vertices[2] > 0) || vertices[0] >= 2;
            hangs_together(1) && hangs_together(2) && is_crossed
        })
    }
}

fn normals(triangles: &[[u32; 3]], points: &[DVec3]) -> Vec<DVec3> {
    let normal = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| points[corner as usize]);
        (b - a).cross(c - a)
    };
    triangles.iter().map(normal).collect()
}
