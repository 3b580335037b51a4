//! Triangulation of a face in its own plane, by spade's constrained Delaunay triangulation.

use glam::DVec3;
use spade::handles::{FaceHandle, FixedVertexHandle, InnerTag, VertexHandle};
use spade::{
    AngleLimit, CdtEdge, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation,
};

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// The smallest angle that refinement strives for, in degrees. Above 30 degrees it need not end.
const SMALLEST_ANGLE: f64 = 25.0;

/// Edge of the equilateral triangle with the largest area allowed, in units of the longest edge allowed: triangles of that
/// area are seldom equilateral, and too long edges are halved afterwards.
const MEAN_EDGE: f64 = 0.8;

/// Height of the flattest triangle, in units of its longest edge. Circumcentres of flatter ones are infinite for rounding, and
/// spade panics at these: of 20 000 polygons 1e-13 to 1e-20 wide it did at two.
const FLATTEST: f64 = 1e-12;

/// Largest height of a triangle whose corners may lie on one line but for rounding, in units of the rounding of coordinates: each corner is rounded where its line is
/// divided in space, and four times in the sums of the projection.
const ROUNDINGS: f64 = 8.0;

/// A polygon's triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct PolygonTriangulation {
    /// New points inside the polygon.
    pub inner_points: Vec<DVec3>,
    /// Corners of the triangles, wound as the outline: numbers of outline points, and after those of the inner points.
    pub triangles: Vec<[u32; 3]>,
}

/// Triangulates a planar, convex polygon without a point more on its outline, which may have collinear points.
///
/// Without an edge length the triangles are those of the constrained Delaunay triangulation of the outline. With one, points
/// are added inside until no inner edge is longer and, as far as the outline allows, no angle is below 25 degrees
/// (Ruppert's refinement). The outline's own edges must be no longer, as they stay.
///
/// None where double precision does not hold the polygon: when points of its outline coincide in its plane, its triangles are
/// not a triangulation of the outline, one has no area but for rounding, or no number of points makes edges short enough.
///
/// ```
/// use glam::DVec3;
/// use voronoi::triangulate_polygon;
///
/// let square = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
/// let coarse = triangulate_polygon(&square, None).expect("a polygon with an area");
/// assert_eq!(coarse.triangles.len(), 2);
/// assert!(coarse.inner_points.is_empty());
/// ```
pub fn triangulate_polygon(outline: &[DVec3], edge_length: Option<f64>) -> Option<PolygonTriangulation> {
    let plane = Plane::of(outline)?;
    let mut delaunay = Delaunay::new();
    for (number, point) in outline.iter().enumerate() {
        // spade gives the handle of an earlier point at the same place.
        let vertex = delaunay.insert(plane.project(*point)).ok()?;
        if vertex.index() != number {
            return None;
        }
    }
    let vertex = FixedVertexHandle::from_index;
    for number in 0..outline.len() {
        let ends = [vertex(number), vertex((number + 1) % outline.len())];
        if !delaunay.can_add_constraint(ends[0], ends[1]) {
            return None;
        }
        delaunay.add_constraint(ends[0], ends[1]);
    }
    if let Some(edge_length) = edge_length {
        refine(&mut delaunay, outline.len(), edge_length / plane.size, plane.rounding)?;
    }
    let triangles = inner_triangles(&delaunay, outline.len(), plane.rounding)?;
    let inner = delaunay.vertices().skip(outline.len());
    let inner_points = inner.map(|vertex| plane.lift(vertex.position())).collect();
    Some(PolygonTriangulation { inner_points, triangles })
}

/// A plane with coordinates in which its polygon has a size of 1.
struct Plane {
    origin: DVec3,
    axes: [DVec3; 2],
    size: f64,
    /// Largest height, in that unit, of a triangle that may be one for rounding alone.
    rounding: f64,
}

impl Plane {
    fn of(outline: &[DVec3]) -> Option<Self> {
        let origin = *outline.first()?;
        let from_origin = outline.iter().map(|point| *point - origin);
        let farthest = from_origin.max_by(|a, b| a.length().total_cmp(&b.length()))?;
        let size = farthest.length();
        let doubled_area: DVec3 = outline[1..]
            .windows(2)
            .map(|ends| ((ends[0] - origin) / size).cross((ends[1] - origin) / size))
            .sum();
        let normal = doubled_area.try_normalize()?;
        let first = farthest.reject_from_normalized(normal).try_normalize()?;
        let largest = outline.iter().map(|point| point.abs().max_element()).fold(size, f64::max);
        let rounding = ROUNDINGS * f64::EPSILON * largest / size;
        Some(Self { origin, axes: [first, normal.cross(first)], size, rounding })
    }

    fn project(&self, point: DVec3) -> Point2<f64> {
        let [x, y] = self.axes.map(|axis| axis.dot(point - self.origin) / self.size);
        // What spade refuses as too small is zero in a polygon of size 1.
        let no_dust = |value: f64| if value.abs() < spade::MIN_ALLOWED_VALUE { 0.0 } else { value };
        Point2::new(no_dust(x), no_dust(y))
    }

    fn lift(&self, point: Point2<f64>) -> DVec3 {
        self.origin + (self.axes[0] * point.x + self.axes[1] * point.y) * self.size
    }
}

/// None when the outline is none, or too narrow to be filled.
fn refine(delaunay: &mut Delaunay, outline_count: usize, edge_length: f64, rounding: f64) -> Option<()> {
    // Refinement leaves alone what is outside, between points on one side of the polygon, and as flat as rounding has it.
    let is_inside = inside_faces(delaunay, outline_count)?;
    if delaunay.inner_faces().any(|face| is_inside[face.fix().index()] && is_flat(face, rounding)) {
        return None;
    }
    let mean_edge = MEAN_EDGE * edge_length;
    let equilateral = 3f64.sqrt() / 4.0 * mean_edge * mean_edge;
    // The polygon lies in a circle of radius 1. Twice as many points as there are triangles in it, and some at the outline.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates, and is positive")]
    let most_points = (2.0 * std::f64::consts::PI / equilateral) as usize + 20 * outline_count;
    let parameters = RefinementParameters::new()
        .keep_constraint_edges()
        .exclude_outer_faces(true)
        .with_angle_limit(AngleLimit::from_deg(SMALLEST_ANGLE))
        .with_max_allowed_area(equilateral)
        .with_max_additional_vertices(most_points);
    delaunay.refine(parameters);
    for _ in 0..most_points {
        let is_inside = inside_faces(delaunay, outline_count)?;
        let inner_edges = delaunay.directed_edges().filter(|edge| {
            let inside = edge.face().as_inner().is_some_and(|face| is_inside[face.fix().index()]);
            inside && !edge.is_constraint_edge()
        });
        let longest = inner_edges.max_by(|a, b| a.length_2().total_cmp(&b.length_2()));
        let Some(longest) = longest.filter(|edge| edge.length_2() > edge_length * edge_length) else {
            return Some(());
        };
        let middle = longest.as_undirected().center();
        delaunay.insert(middle).ok()?;
    }
    // In needles, rounding puts middles where they shorten nothing.
    None
}

fn is_flat(face: FaceHandle<'_, InnerTag, Point2<f64>, (), CdtEdge<()>, ()>, rounding: f64) -> bool {
    let longest = face.adjacent_edges().map(|edge| edge.length_2()).into_iter().fold(0.0, f64::max).sqrt();
    2.0 * face.area() < longest * rounding.max(FLATTEST * longest)
}

/// Of each face by number, whether it lies inside the outline. None when that is no closed line of edges.
fn inside_faces(delaunay: &Delaunay, outline_count: usize) -> Option<Vec<bool>> {
    let mut is_inside = vec![false; delaunay.num_all_faces()];
    let mut ahead = Vec::new();
    for number in 0..outline_count {
        let [from, to] = [number, (number + 1) % outline_count].map(FixedVertexHandle::from_index);
        // A constraint through another point of the outline is not one edge.
        ahead.push(delaunay.get_edge_from_neighbors(from, to)?.face());
    }
    while let Some(face) = ahead.pop() {
        // The outside of all triangles on the outline's left: it winds the wrong way somewhere.
        let face = face.as_inner()?;
        if std::mem::replace(&mut is_inside[face.fix().index()], true) {
            continue;
        }
        let passable = face.adjacent_edges().into_iter().filter(|edge| !edge.is_constraint_edge());
        ahead.extend(passable.map(|edge| edge.rev().face()));
    }
    Some(is_inside)
}

/// The triangles inside the outline, if they are a triangulation of it and none is flat.
fn inner_triangles(delaunay: &Delaunay, outline_count: usize, rounding: f64) -> Option<Vec<[u32; 3]>> {
    let is_inside = inside_faces(delaunay, outline_count)?;
    let inside = delaunay.inner_faces().filter(|face| is_inside[face.fix().index()]);
    let number = |vertex: VertexHandle<Point2<f64>, (), CdtEdge<()>>| {
        u32::try_from(vertex.index()).expect("the points of a face fit 32 bits")
    };
    let corners = |face| (!is_flat(face, rounding)).then(|| face.vertices().map(number));
    let triangles: Vec<[u32; 3]> = inside.map(corners).collect::<Option<_>>()?;
    // Euler's formula: what is inside has no holes and holds every point.
    let inner_count = delaunay.num_vertices() - outline_count;
    (triangles.len() == 2 * inner_count + outline_count - 2).then_some(triangles)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Points on an ellipse and between them, turned into space.
    fn outline(angles: &[f64], longest_edge: f64) -> Vec<DVec3> {
        let turn = glam::DMat3::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7);
        let corner =
            |angle: f64| turn * DVec3::new(angle.cos(), 2.0 * angle.sin(), 0.0) + DVec3::new(5.0, 3.0, 1.0);
        let ends = angles.iter().zip(angles.iter().cycle().skip(1));
        let points = ends.flat_map(|(from, to)| {
            let [from, to] = [from, to].map(|angle| corner(*angle));
            let count = (from.distance(to) / longest_edge).ceil();
            (0..100).map(f64::from).take_while(move |k| *k < count).map(move |k| from.lerp(to, k / count))
        });
        points.collect()
    }

    fn doubled_areas(outline: &[DVec3], mesh: &PolygonTriangulation) -> Vec<DVec3> {
        let points: Vec<DVec3> = outline.iter().chain(&mesh.inner_points).copied().collect();
        let area = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|corner| points[corner as usize]);
            (b - a).cross(c - a)
        };
        mesh.triangles.iter().map(area).collect()
    }

    fn edges(mesh: &PolygonTriangulation) -> Vec<[u32; 2]> {
        mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect()
    }

    proptest! {
        #[test]
        fn triangles_fill_the_outline_and_no_more(
            mut angles in prop::collection::vec(0.0..6.0f64, 3..12),
            longest_edge in 0.1..5.0f64,
            is_refined in any::<bool>(),
        ) {
            angles.sort_unstable_by(f64::total_cmp);
            angles.dedup_by(|a, b| *a - *b < 1e-3);
            prop_assume!(angles.len() >= 3);
            let outline = outline(&angles, longest_edge);
            let edge_length = is_refined.then_some(longest_edge);
            let mesh = triangulate_polygon(&outline, edge_length).expect("a good polygon");
            let areas = doubled_areas(&outline, &mesh);
            let whole: DVec3 =
                outline.windows(2).map(|ends| (ends[0] - outline[0]).cross(ends[1] - outline[0])).sum();
            prop_assert!(areas.iter().all(|area| area.dot(whole) > 0.0), "every triangle winds as the outline");
            prop_assert!((areas.iter().sum::<DVec3>() - whole).length() < 1e-12 * whole.length().max(1.0));

            let count = u32::try_from(outline.len()).expect("a small polygon");
            let mut all = edges(&mesh);
            all.sort_unstable();
            let is_once = |[a, b]: &[u32; 2]| all.binary_search(&[*b, *a]).is_err();
            let once: Vec<[u32; 2]> = all.iter().copied().filter(is_once).collect();
            let mut expected: Vec<[u32; 2]> = (0..count).map(|k| [k, (k + 1) % count]).collect();
            expected.sort_unstable();
            prop_assert_eq!(once, expected, "the mesh ends at the outline's edges");
            let again = triangulate_polygon(&outline, edge_length);
            prop_assert_eq!(Some(mesh), again);
        }

        #[test]
        fn slivers_and_needles_give_a_triangulation_or_nothing(
            mut angles in prop::collection::vec(prop_oneof![0.0..6.0f64, 1.0..1.0 + 1e-12f64], 3..9),
            flat in prop_oneof![Just(1.0), Just(1e-9), Just(1e-15), Just(0.0)],
            scale in prop_oneof![Just(1.0), Just(1e-30), Just(1e30)],
        ) {
            angles.sort_unstable_by(f64::total_cmp);
            let outline: Vec<DVec3> =
                angles.iter().map(|angle| DVec3::new(angle.cos(), flat * angle.sin(), 0.3) * scale).collect();
            if let Some(mesh) = triangulate_polygon(&outline, Some(0.3 * scale)) {
                prop_assert!(mesh.triangles.iter().flatten().all(|v| (*v as usize) < outline.len() + mesh.inner_points.len()));
                let sum: DVec3 = doubled_areas(&outline, &mesh).into_iter().map(|area| area / scale / scale).sum();
                let ends = outline.windows(2).map(|ends| [(ends[0] - outline[0]) / scale, (ends[1] - outline[0]) / scale]);
                let whole: DVec3 = ends.map(|[a, b]| a.cross(b)).sum();
                prop_assert!((sum - whole).length() < 1e-12, "{sum} and {whole}");
            }
        }

        /// A lattice of cells with seeds moved a little has such faces. Triangles between the points of the short line had no area.
        #[test]
        fn a_short_line_in_three_points_gives_triangles_with_an_area_or_nothing(
            corner in prop::array::uniform2(1.0..1e4f64),
            length in (-10.0..-5.0f64).prop_map(|power| 1e4 * 10f64.powf(power)),
            slope in prop_oneof![Just(1.0), 0.1..1.0f64],
            edge_length in prop::option::of(1e3..5e3f64),
        ) {
            let start = DVec3::new(corner[0], corner[1], 0.0);
            let end = start + length * DVec3::new(slope, 1.0, 0.0);
            let others = [DVec3::new(end.x, end.y + 5e3, 0.0), DVec3::new(start.x - 5e3, end.y + 5e3, 0.0)];
            let outline = [others[1], start - 5e3 * DVec3::X, start, start.midpoint(end), end, others[0]];
            if let Some(mesh) = triangulate_polygon(&outline, edge_length) {
                let areas = doubled_areas(&outline, &mesh);
                prop_assert!(areas.iter().all(|area| area.z > 0.0), "{areas:?}");
            }
        }
    }

    #[test]
    fn refined_triangles_have_short_edges_and_no_small_angles() {
        let hexagon: Vec<f64> = (0..6).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_3).collect();
        for edge_length in [0.6, 0.25, 0.08] {
            let outline = outline(&hexagon, edge_length);
            let mesh = triangulate_polygon(&outline, Some(edge_length)).expect("a good polygon");
            let points: Vec<DVec3> = outline.iter().chain(&mesh.inner_points).copied().collect();
            let longest = edges(&mesh)
                .iter()
                .map(|[a, b]| points[*a as usize].distance(points[*b as usize]))
                .fold(0.0, f64::max);
            assert!(longest <= edge_length * (1.0 + 1e-12), "{longest}");
            let smallest = mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]]);
            let angle = |[a, b, c]: [u32; 3]| {
                let [a, b, c] = [a, b, c].map(|v| points[v as usize]);
                (b - a).angle_between(c - a).to_degrees()
            };
            let smallest = smallest.map(angle).fold(180.0, f64::min);
            assert!(smallest >= 20.0, "{smallest} degrees at {edge_length}");
            // Equilateral triangles of that edge would be half as many at least.
            let area = doubled_areas(&outline, &mesh).iter().map(|area| area.length() / 2.0).sum::<f64>();
            let equilateral = area / (3f64.sqrt() / 4.0 * edge_length * edge_length);
            assert!((mesh.triangles.len() as f64) < 5.0 * equilateral + 2.0 * outline.len() as f64);
        }
    }

    #[test]
    fn a_polygon_without_area_or_with_a_point_twice_gives_nothing() {
        let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(triangulate_polygon(&[a, b, b * 2.0], None), None);
        assert_eq!(triangulate_polygon(&[a, b, b, c], None), None);
        assert_eq!(triangulate_polygon(&[a, b], None), None);
        assert_eq!(triangulate_polygon(&[], None), None);
        let mesh = triangulate_polygon(&[a, b, c], None).expect("a triangle");
        assert_eq!((mesh.triangles.len(), mesh.inner_points.len()), (1, 0));
    }

    /// Twelve points round a needle, 1e-20 wide: spade panicked in refinement.
    #[test]
    fn needles_thinner_than_rounding_are_not_refined() {
        let across = [1.0, 1.18, 1.37, 0.87, 0.37, -0.32, -1.0, -1.18, -1.37, -0.87, -0.37, 0.32];
        let along = [
            std::f64::consts::FRAC_1_SQRT_2,
            0.224_143_868_042_013_47,
            -0.258_819_045_102_520_63,
            -0.612_372_435_695_795_1,
            -0.965_925_826_289_069_8,
            -0.836_516_303_737_808_7,
            -0.707_106_781_186_547_7,
            -0.224_143_868_042_013_7,
            0.258_819_045_102_520_3,
            0.612_372_435_695_794_2,
            0.965_925_826_289_068_3,
            0.836_516_303_737_807_9,
        ];
        let aside = [0.0, 0.0, 0.0, 7.5e-12, 1.5e-11, 7.5e-12, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let points = along.iter().zip(across).zip(aside);
        let outline: Vec<DVec3> = points.map(|((x, y), z)| DVec3::new(*x, y * 7.07e-21, z)).collect();
        assert_eq!(triangulate_polygon(&outline, Some(1.0)), None);
    }
}
