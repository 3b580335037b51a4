//! Numbers at the points of a surface, to colour it by.

use glam::DVec3;

/// The numbers that a page asks for; nothing where there are none.
pub(super) fn values(
    color: &str,
    points: &[DVec3],
    edges: &[[u32; 2]],
    triangles: &[[u32; 3]],
    generations: Option<&[i8]>,
) -> Option<Vec<f64>> {
    match color {
        "generation" => match generations {
            Some(generations) => Some(generations.iter().map(|level| f64::from(*level)).collect()),
            None => Some(vec![0.0; points.len()]),
        },
        "valence" => {
            let mut valences = vec![0.0; points.len()];
            let there = edges.iter().filter(|[start, end]| start != end);
            there.flatten().for_each(|point| valences[*point as usize] += 1.0);
            Some(valences)
        }
        "curvature" => Some(mean_curvatures(points, triangles)),
        _ => None,
    }
}

/// The mean of the two principal curvatures at each point, positive where convex: half the cotangent Laplacian along the normal, by a
/// third of the area around (Meyer, Desbrun, Schroeder and Barr 2003). At boundaries it means nothing and is NaN.
fn mean_curvatures(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut laplacians = vec![DVec3::ZERO; points.len()];
    let mut areas = vec![DVec3::ZERO; points.len()];
    let mut turns = vec![0_i64; points.len()];
    for triangle in triangles.iter().filter(|[first, second, _]| first != second) {
        let [a, b, c] = triangle.map(|point| points[point as usize]);
        let area = (b - a).cross(c - a);
        for corner in 0..3 {
            let [one, next, last] = [0, 1, 2].map(|step| triangle[(corner + step) % 3] as usize);
            areas[one] += area / 6.0;
            // Around an inner point each neighbour comes once as the next and once as the last.
            turns[one] += i64::from(triangle[(corner + 1) % 3]) - i64::from(triangle[(corner + 2) % 3]);
            let (to_next, to_last) = (points[next] - points[one], points[last] - points[one]);
            let cotangent = to_next.dot(to_last) / to_next.cross(to_last).length();
            let side = 0.5 * cotangent * (points[next] - points[last]);
            laplacians[next] += side;
            laplacians[last] -= side;
        }
    }
    let curvature = |((laplacian, area), turn): ((DVec3, DVec3), i64)| match turn {
        0 => 0.5 * laplacian.dot(area.normalize_or_zero()) / area.length(),
        _ => f64::NAN,
    };
    laplacians.into_iter().zip(areas).zip(turns).map(curvature).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of radius 2, whose mean curvature is 1/2.
    #[test]
    fn a_sphere_is_curved_by_its_radius() {
        let octahedron =
            vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let corners = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
        let mut mesh = subzero::TriangleMesh::new(6, octahedron, &subzero::Features::default()).unwrap();
        let mut points = corners.to_vec();
        for _ in 0..4 {
            let finer = mesh.midpoint_refine().unwrap();
            points = finer.stencils.apply(&points);
            mesh = finer.mesh;
        }
        points.iter_mut().for_each(|point| *point = 2.0 * point.normalize());
        let curvatures = mean_curvatures(&points, mesh.triangles());
        let mean = curvatures.iter().sum::<f64>() / curvatures.len() as f64;
        assert!((mean - 0.5).abs() < 5e-3, "{mean}");
        let open = mean_curvatures(&points, &mesh.triangles()[1..]);
        assert_eq!(open.iter().filter(|curvature| curvature.is_nan()).count(), 3);
    }
}
