//! Triangles between lines in the plane, by spade's constrained Delaunay triangulation.

use glam::DVec3;
use spade::handles::VertexHandle;
use spade::{CdtEdge, ConstrainedDelaunayTriangulation, Point2, Triangulation};

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Triangulates the convex hull of points in the plane z = 0 such that each of some segments is an edge: as near to a Delaunay triangulation as these allow. Triangles are
/// counter-clockwise, and have corners at the points alone.
///
/// None where segments cross, or go through other points, or points coincide.
///
/// ```
/// use glam::DVec3;
/// use voronoi::triangulate_between_lines;
///
/// let square = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
/// let triangles = triangulate_between_lines(&square, &[[0, 2]]).expect("a single segment crosses nothing");
/// assert!(triangles.len() == 2 && triangles.iter().all(|corners| corners.contains(&0) && corners.contains(&2)));
/// assert!(triangulate_between_lines(&square, &[[0, 2], [1, 3]]).is_none());
/// ```
pub fn triangulate_between_lines(points: &[DVec3], segments: &[[u32; 2]]) -> Option<Vec<[u32; 3]>> {
    // What spade refuses as too small is zero beside any other coordinate.
    let no_dust = |value: f64| if value.abs() < spade::MIN_ALLOWED_VALUE { 0.0 } else { value };
    let places = points.iter().map(|point| Point2::new(no_dust(point.x), no_dust(point.y))).collect();
    let edges = segments.iter().map(|ends| ends.map(|end| end as usize)).collect();
    let mut has_conflict = false;
    let delaunay = Delaunay::try_bulk_load_cdt(places, edges, |_| has_conflict = true).ok()?;
    // A segment through a point would be several edges.
    let is_whole = delaunay.num_vertices() == points.len() && delaunay.num_constraints() == segments.len();
    if has_conflict || !is_whole {
        return None;
    }
    let number = |vertex: VertexHandle<Point2<f64>, (), CdtEdge<()>>| {
        u32::try_from(vertex.index()).expect("there are no more points than ids")
    };
    Some(delaunay.inner_faces().map(|face| face.vertices().map(number)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_triangulation_is_refused() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0, DVec3::Y];
        assert!(triangulate_between_lines(&points, &[[0, 2]]).is_none(), "a point on the segment");
        assert_eq!(triangulate_between_lines(&points, &[[0, 1], [1, 2]]).map(|all| all.len()), Some(2));
        let twice = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X];
        assert!(triangulate_between_lines(&twice, &[]).is_none());
    }
}
