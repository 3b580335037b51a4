mod sums;

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use crate::measures::complex::Complex;
use crate::measures::lines::{Line, Lines};
use crate::mesh::angles::edge_length;
use crate::mesh::boundary_elements::BoundaryElements;
use crate::{AngleStatistics, BoundaryId, GrainId, Side, Surface};
use sums::{GrainSums, Rim, Sums};

/// What a network in space is like.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SpaceMeasures {
    /// Every grain, in order of the numbers.
    pub grains: Vec<GrainMeasures>,
    /// Every boundary, by number; a boundary of a periodic network that comes twice once.
    pub boundaries: Vec<BoundaryMeasures>,
    /// Every triple line: where at least three sides meet, of which the exterior may be one.
    pub triple_lines: Vec<TripleLineMeasures>,
    /// Every quadruple point: where at least three triple lines end.
    pub quadruple_points: Vec<QuadruplePointMeasures>,
    /// The dihedral angles where three grains meet, and not the exterior, weighted by length.
    pub dihedral_angles: Option<AngleStatistics>,
}

/// What a grain is like. Walls of the domain count as parts of its surface.
#[derive(Debug, Clone, PartialEq)]
pub struct GrainMeasures {
    /// The grain.
    pub grain: GrainId,
    /// Volume.
    pub volume: f64,
    /// Area of its whole surface.
    pub area: f64,
    /// Centre of mass.
    pub centroid: DVec3,
    /// Inertia about the centroid at density 1: the integral of `r^2 I - r r^T`. Length to the fifth.
    pub inertia: DMat3,
    /// Area of the ball of the same volume over the grain's: 1 for a ball.
    pub sphericity: f64,
    /// Diameter of the ball of the same volume.
    pub equivalent_diameter: f64,
    /// Grains beyond its boundaries, in order; the exterior is none.
    pub neighbors: Vec<GrainId>,
    /// Whether the exterior is beyond one of its boundaries.
    pub is_at_exterior: bool,
    /// Number of its boundaries.
    pub face_count: usize,
    /// Number of lines where its boundaries meet: triple lines, and edges of the domain.
    pub edge_count: usize,
    /// Number of points where these end.
    pub vertex_count: usize,
    /// Mean number of lines around its boundaries.
    pub edges_per_face: f64,
    /// Mean width, over all directions: that of a ball is its diameter, that of a box half the sum of its three sides. Of a
    /// polyhedron, the sum over its edges of length times exterior angle, over 4 pi; concave edges have negative angles
    /// (Hadwiger 1957).
    pub mean_width: f64,
    /// Integral of the mean curvature (the mean of the two principal ones, positive where convex) over the surface, edges
    /// between boundaries counted with half their exterior angle: 2 pi times the mean width.
    pub integral_mean_curvature: f64,
    /// Length of its edges where three or more grains meet, none of them the exterior.
    pub triple_line_length: f64,
    /// Rate of volume under curvature flow with unit mobility and tension, of grains whose angles are in equilibrium: `-2 pi
    /// (2 w - l / 6)` with the mean width w and the length l of triple lines (MacPherson and Srolovitz 2007, whose L is
    /// 2 w). A ball of radius r has -8 pi r. Length. Nothing at the exterior, where it does not hold.
    pub growth_rate: Option<f64>,
    /// The same rate as the boundaries have it, whatever their angles: minus the integral of the sum of the principal
    /// curvatures over the boundaries to other grains. Where all dihedral angles are 120 degrees it equals
    /// [`growth_rate`](Self::growth_rate); at the exterior it holds for walls that do not pull.
    pub curvature_rate: f64,
}

/// What a boundary is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryMeasures {
    /// The boundary.
    pub boundary: BoundaryId,
    /// Its two sides.
    pub sides: [Side; 2],
    /// Area.
    pub area: f64,
    /// Centre of its area.
    pub centroid: DVec3,
    /// Mean of the unit normals from the first side to the second, weighted by area: of length 1 where the boundary is flat.
    pub mean_normal: DVec3,
    /// Number of lines around it.
    pub edge_count: usize,
    /// Length of these lines.
    pub perimeter: f64,
    /// Mean over its area of the mean curvature (the mean of the two principal ones), positive where the first side is
    /// convex. 1 / length.
    pub mean_curvature: f64,
}

/// What a triple line is like.
#[derive(Debug, Clone, PartialEq)]
pub struct TripleLineMeasures {
    /// The sides around, in order; a grain that meets itself across a period comes as often as it does there.
    pub sides: Vec<Side>,
    /// The mean angle of each side over the length, in degrees.
    pub mean_angles: Vec<f64>,
    /// The smallest angle between neighbouring boundaries anywhere along the line, in degrees.
    pub smallest_angle: f64,
    /// The largest.
    pub largest_angle: f64,
    /// The residual of Herring's condition, as [`HerringResidual`](crate::HerringResidual) has it, as a mean over the length: 0 at rest.
    /// Nothing where no boundary has tension, or walls leave the line no way to go.
    pub residual: Option<f64>,
    /// The boundaries that meet, in order.
    pub boundaries: Vec<BoundaryId>,
    /// Length.
    pub length: f64,
    /// The points of the surface along the line, in order; of copies in a periodic network their originals.
    pub points: Vec<u32>,
    /// Whether it closes on itself instead of ending.
    pub is_closed: bool,
}

/// What a quadruple point is like.
#[derive(Debug, Clone, PartialEq)]
pub struct QuadruplePointMeasures {
    /// The point of the surface.
    pub point: u32,
    /// Where it is.
    pub position: DVec3,
    /// The sides that meet there, in order, each once.
    pub sides: Vec<Side>,
    /// Number of triple lines that end there.
    pub line_count: usize,
    /// Mean angle between pairs of these lines, in degrees; 109.47 in equilibrium.
    pub mean_angle: f64,
    /// The smallest of these angles.
    pub smallest_angle: f64,
    /// The largest.
    pub largest_angle: f64,
}

pub(crate) fn measure(complex: &Complex<'_>, triangles: &[[u32; 3]]) -> SpaceMeasures {
    let surface = &complex.surface;
    let at = |corner: u32| surface.points[corner as usize];
    let by_boundary = BoundaryElements::new(surface);
    let corners_of = |boundary: usize| {
        by_boundary.of(boundary).into_iter().map(|triangle| triangles[triangle as usize].map(at))
    };
    let mut sums: Vec<Sums> =
        (0..surface.sides.len()).map(|boundary| Sums::of(corners_of(boundary))).collect();
    for pair in &complex.inner_pairs() {
        let boundary = surface.boundary(pair[0]);
        sums[boundary.index()].edges += bend(surface, *pair, &triangles[pair[0] as usize]);
    }
    let mut grains: BTreeMap<GrainId, GrainSums> = BTreeMap::new();
    for (boundary, own) in sums.iter().enumerate().filter(|(_, sums)| sums.area > 0.0) {
        for (end, sign) in [(0, 1.0), (1, -1.0)] {
            let Side::Grain(grain) = surface.sides[boundary][end] else { continue };
            // Of a copy the bends are known at the original only, where the sides are the other way round.
            let original = complex.originals[boundary].index();
            let edges = if original == boundary { sign * own.edges } else { -sums[original].edges };
            let beyond = complex.sides[boundary][1 - end];
            let grain = grains.entry(grain).or_default();
            grain.add_boundary(own, beyond, edges);
            grain.enclosed.add_cones(corners_of(boundary), sign);
        }
    }
    let lines = Lines::of(complex);
    let mut rims = vec![Rim::default(); surface.sides.len()];
    let mut triple_lines = Vec::new();
    let mut tangents: Vec<(u32, DVec3)> = Vec::new();
    for line in &lines.lines {
        let measures = measure_line(complex, line, &mut grains);
        for boundary in &line.boundaries {
            rims[boundary.index()].edge_count += 1;
            rims[boundary.index()].perimeter += measures.length;
        }
        if measures.sides.len() >= 3 {
            if !line.is_closed {
                tangents.extend(end_tangents(complex, line));
            }
            triple_lines.push(measures);
        }
    }
    for (boundary, sides) in surface.sides.iter().enumerate() {
        let rim = &rims[complex.originals[boundary].index()];
        for side in sides {
            if let Some(sums) = side.grain().and_then(|grain| grains.get_mut(&grain)) {
                sums.edges_of_faces += rim.edge_count;
            }
        }
    }
    count_vertices(complex, triangles, &lines.corners, &mut grains);
    let ids = (0u32..).map(BoundaryId);
    let boundaries = ids.zip(&sums).filter(|(id, _)| complex.is_original(*id)).map(|(id, sums)| {
        let sides = complex.sides[id.index()];
        sums.boundary(id, sides, &rims[id.index()])
    });
    SpaceMeasures {
        boundaries: boundaries.collect(),
        grains: grains.into_iter().map(|(grain, sums)| sums.measures(grain)).collect(),
        triple_lines,
        quadruple_points: quadruple_points(complex, triangles, tangents),
        dihedral_angles: AngleStatistics::of(complex.angles()),
    }
}

/// Length times exterior angle of the edge between two triangles of a boundary, positive where its first side is convex.
fn bend(surface: &Surface<'_>, [a, b]: [u32; 2], corners: &[u32; 3]) -> f64 {
    let others = surface.elements.corners(b);
    let Some(apex) = (0..3).find(|k| !others.contains(&corners[*k])) else { return 0.0 };
    let at = |corner: u32| surface.points[corner as usize];
    let [start, end] = [corners[(apex + 1) % 3], corners[(apex + 2) % 3]];
    let Some(beyond) = others.iter().find(|corner| **corner != start && **corner != end) else { return 0.0 };
    let [one, other] = [a, b].map(|element| normal(surface, element));
    // The arc cosine would lose the small angles within a boundary.
    let angle = one.cross(other).length().atan2(one.dot(other));
    // The first side is convex where what lies beyond the edge is below the first triangle.
    let sign = if one.dot(at(*beyond) - at(start)) > 0.0 { -1.0 } else { 1.0 };
    at(start).distance(at(end)) * angle * sign
}

fn normal(surface: &Surface<'_>, element: u32) -> DVec3 {
    let corners = surface.elements.corners(element);
    let [a, b, c] = [0, 1, 2].map(|k| surface.points[corners[k] as usize]);
    (b - a).cross(c - a)
}

/// Measures a line, and adds it to the grains around.
fn measure_line(
    complex: &Complex<'_>,
    line: &Line<'_>,
    grains: &mut BTreeMap<GrainId, GrainSums>,
) -> TripleLineMeasures {
    let mut length = 0.0;
    let mut sides: Vec<Side> = Vec::new();
    let mut sums: Vec<f64> = Vec::new();
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for at in &line.edges {
        let mut dihedral_sectors = complex.dihedral_sectors(at);
        dihedral_sectors.sort_by_key(|dihedral_sector| dihedral_sector.side);
        let own = edge_length(&complex.surface, at);
        length += own;
        if sides.is_empty() {
            sides = dihedral_sectors.iter().map(|dihedral_sector| dihedral_sector.side).collect();
            sums = vec![0.0; sides.len()];
        }
        let is_inside = dihedral_sectors.len() >= 3
            && dihedral_sectors.iter().all(|dihedral_sector| dihedral_sector.side != Side::Exterior);
        for (dihedral_sector, sum) in dihedral_sectors.iter().zip(&mut sums) {
            let degrees = dihedral_sector.angle.to_degrees();
            *sum += own * degrees;
            range = [range[0].min(degrees), range[1].max(degrees)];
            let Side::Grain(grain) = dihedral_sector.side else { continue };
            let grain = grains.entry(grain).or_default();
            grain.edges += own * (PI - dihedral_sector.angle);
            if is_inside {
                grain.triple_line_length += own;
            }
        }
    }
    for side in &sides {
        if let Side::Grain(grain) = side {
            grains.entry(*grain).or_default().edge_count += 1;
        }
    }
    let per_length = if length > 0.0 { 1.0 / length } else { 0.0 };
    TripleLineMeasures {
        mean_angles: sums.iter().map(|sum| sum * per_length).collect(),
        sides,
        smallest_angle: range[0],
        largest_angle: range[1],
        residual: complex.residual_of_line(line),
        boundaries: line.boundaries.clone(),
        length,
        points: line.points.clone(),
        is_closed: line.is_closed,
    }
}

/// The points where a line ends, and its unit direction away from there.
fn end_tangents(complex: &Complex<'_>, line: &Line<'_>) -> Vec<(u32, DVec3)> {
    let [Some(first), Some(last)] = [line.edges.first(), line.edges.last()] else { return Vec::new() };
    let [start, end] = [line.points[0], line.points[line.points.len() - 1]];
    let away = |edge: &[crate::mesh::adjacency::Incidence], corner: u32| {
        let ends = edge[0].ends(complex.surface.elements);
        let [a, b] = ends.map(|end| complex.surface.points[end as usize]);
        let direction = if complex.original(ends[0]) == corner { b - a } else { a - b };
        (corner, direction.normalize_or_zero())
    };
    let mut both = vec![away(first, start), away(last, end)];
    if line.edges.len() == 1 {
        // Both ends may be copies of one point: they still lie opposite each other.
        both[1].1 = -both[0].1;
    }
    both
}

fn quadruple_points(
    complex: &Complex<'_>,
    triangles: &[[u32; 3]],
    mut tangents: Vec<(u32, DVec3)>,
) -> Vec<QuadruplePointMeasures> {
    tangents.sort_by_key(|(point, _)| *point);
    let ends: Vec<&[(u32, DVec3)]> =
        tangents.chunk_by(|a, b| a.0 == b.0).filter(|ends| ends.len() >= 3).collect();
    let mut around: Vec<(u32, Side)> = Vec::new();
    for (triangle, boundary) in triangles.iter().zip(complex.surface.boundary_of) {
        for corner in triangle.map(|corner| complex.original(corner)) {
            if ends.binary_search_by_key(&corner, |ends| ends[0].0).is_ok() {
                around.extend(complex.sides[boundary.index()].map(|side| (corner, side)));
            }
        }
    }
    around.sort_unstable();
    around.dedup();
    let measure = |ends: &[(u32, DVec3)], sides: &[(u32, Side)]| {
        let mut sum = 0.0;
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for (index, (_, one)) in ends.iter().enumerate() {
            for (_, other) in &ends[..index] {
                let angle = one.angle_between(*other).to_degrees();
                sum += angle;
                range = [range[0].min(angle), range[1].max(angle)];
            }
        }
        let pairs = ends.len() * (ends.len() - 1) / 2;
        QuadruplePointMeasures {
            point: ends[0].0,
            position: complex.surface.points[ends[0].0 as usize],
            sides: sides.iter().map(|(_, side)| *side).collect(),
            line_count: ends.len(),
            mean_angle: sum / pairs as f64,
            smallest_angle: range[0],
            largest_angle: range[1],
        }
    };
    let points = ends.iter().zip(around.chunk_by(|a, b| a.0 == b.0));
    points.map(|(ends, sides)| measure(ends, sides)).collect()
}

/// Counts the corners on each grain's own surface, where a periodic network has those that are copies too.
fn count_vertices(
    complex: &Complex<'_>,
    triangles: &[[u32; 3]],
    corners: &[u32],
    grains: &mut BTreeMap<GrainId, GrainSums>,
) {
    let mut on_grains: Vec<(GrainId, u32)> = Vec::new();
    for (triangle, boundary) in triangles.iter().zip(complex.surface.boundary_of) {
        for corner in triangle {
            if corners.binary_search(&complex.original(*corner)).is_ok() {
                let sides = complex.surface.sides[boundary.index()];
                on_grains.extend(sides.iter().filter_map(|side| Some((side.grain()?, *corner))));
            }
        }
    }
    on_grains.sort_unstable();
    on_grains.dedup();
    for of_grain in on_grains.chunk_by(|a, b| a.0 == b.0) {
        grains.entry(of_grain[0].0).or_default().vertex_count = of_grain.len();
    }
}
