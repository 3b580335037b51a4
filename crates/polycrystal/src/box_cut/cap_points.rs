//! Points inside caps, where the lines of their rims alone would make thin triangles.
//!
//! Delaunay refinement (Chew 1989; points off centre after Üngör 2004) without dividing the rims, which boundaries share: a point is added where it
//! makes the smallest angle around wider, and nowhere else.

use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, PositionInTriangulation, Triangulation};

use glam::DVec3;

use crate::mesh::triangle_quality::squared_sine;

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Sine of the smallest angle that is good enough (24 degrees).
const GOOD_SINE: f64 = 0.4;

/// Factor by which a new point has to widen the smallest angle, squared.
const GAIN: f64 = 1.2;

/// Most points that are added, for each that is there.
const MOST_POINTS: usize = 3;

/// Distance of a point off centre from the middle of a shortest side, in units of that side: it sees the side at 34 degrees.
const OFF_CENTER: f64 = 1.6;

/// Adds points until no triangle gets wider by one more.
pub(crate) fn add_points(delaunay: &mut Delaunay) {
    let most = (1 + MOST_POINTS) * delaunay.num_vertices();
    loop {
        let mut thin: Vec<(f64, [FixedVertexHandle; 3])> = delaunay
            .inner_faces()
            .map(|face| {
                (squared_sine(face.positions().map(in_space)), face.vertices().map(|vertex| vertex.fix()))
            })
            .filter(|(squared, _)| *squared < GOOD_SINE * GOOD_SINE)
            .collect();
        thin.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        let mut is_changed = false;
        for (squared, corners) in thin {
            if delaunay.num_vertices() >= most {
                return;
            }
            if has_face(delaunay, corners) {
                let positions = corners.map(|corner| delaunay.vertex(corner).position());
                is_changed |= candidates(positions)
                    .into_iter()
                    .any(|position| widens(delaunay, positions, position, squared));
            }
        }
        if !is_changed {
            return;
        }
    }
}

fn in_space(point: Point2<f64>) -> DVec3 {
    DVec3::new(point.x, point.y, 0.0)
}

fn has_face(delaunay: &Delaunay, [a, b, c]: [FixedVertexHandle; 3]) -> bool {
    let face = delaunay.get_edge_from_neighbors(a, b).and_then(|edge| edge.face().as_inner());
    face.is_some_and(|face| face.vertices().iter().any(|vertex| vertex.fix() == c))
}

/// Where a point might widen a triangle: off centre from its shortest side, in the middle of its circle, and in its own middle.
fn candidates(corners: [Point2<f64>; 3]) -> Vec<Point2<f64>> {
    let [a, b, c] = corners.map(in_space);
    let sides = [[a, b, c], [b, c, a], [c, a, b]];
    let shortest = sides.into_iter().min_by(|p, q| p[0].distance(p[1]).total_cmp(&q[0].distance(q[1])));
    let [from, to, apex] = shortest.expect("a triangle has three sides");
    let (middle, along) = (from.midpoint(to), to - from);
    let toward = (apex - middle).reject_from(along).normalize_or_zero();
    let off_center = middle + toward * (OFF_CENTER * along.length());
    // From the middle of the side, the centre is where the distances to its ends and to the apex agree.
    let leg = apex - middle;
    let height = (leg.length_squared() - 0.25 * along.length_squared()) / (2.0 * leg.dot(toward));
    let center = middle + toward * height;
    [off_center, center, (a + b + c) / 3.0]
        .into_iter()
        .filter(|position| position.is_finite())
        .map(|position| Point2::new(position.x, position.y))
        .collect()
}

/// Adds a point if that widens the smallest angle; whether it did.
fn widens(delaunay: &mut Delaunay, corners: [Point2<f64>; 3], position: Point2<f64>, squared: f64) -> bool {
    let middle = corners.map(in_space).iter().sum::<DVec3>() / 3.0;
    let is_inside = match delaunay.locate(position) {
        PositionInTriangulation::OnFace(_) => true,
        PositionInTriangulation::OnEdge(edge) => !delaunay.directed_edge(edge).is_constraint_edge(),
        _ => false,
    };
    let middle = Point2::new(middle.x, middle.y);
    if !is_inside || delaunay.get_conflicting_edges_between_points(middle, position).next().is_some() {
        return false;
    }
    let Ok(vertex) = delaunay.insert(position) else { return false };
    let least = delaunay
        .vertex(vertex)
        .out_edges()
        .map(|edge| edge.face().as_inner().map_or(0.0, |face| squared_sine(face.positions().map(in_space))));
    let is_wider = least.fold(f64::INFINITY, f64::min) > GAIN * squared;
    if !is_wider {
        delaunay.remove(vertex);
    }
    is_wider
}
