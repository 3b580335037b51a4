//! The mesh that the benches refine: the convex hull of random points on a sphere.

use glam::DVec3;
use spade::{DelaunayTriangulation, Point2, Triangulation};
use subzero::CurveOrder;

/// Random numbers by splitmix64, so that the mesh is the same on every machine.
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 to 1.
    #[allow(clippy::cast_precision_loss)]
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The hull of `count` random points on the unit sphere, outward and with `2 count - 4` triangles.
///
/// Vertices as they were drawn, triangles as the triangulation lists them. Seen from one point, the others' hull is the Delaunay triangulation of their stereographic projection.
pub fn sphere_hull(count: u32) -> (Vec<[u32; 3]>, Vec<DVec3>) {
    let mut random = Random(1);
    let mut points: Vec<DVec3> = (1..count)
        .map(|_| {
            let (z, angle) = (2.0 * random.unit() - 1.0, std::f64::consts::TAU * random.unit());
            let radius = (1.0 - z * z).sqrt();
            DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
        })
        .collect();
    let flat = points.iter().map(|p| Point2::new(p.x / (1.0 - p.z), p.y / (1.0 - p.z))).collect();
    let delaunay: DelaunayTriangulation<Point2<f64>> =
        DelaunayTriangulation::bulk_load_stable(flat).expect("the points are finite");
    let index = |v: usize| u32::try_from(v).expect("the count is a u32");
    // The projection looks from inside, so turn the triangles round.
    let mut triangles: Vec<[u32; 3]> = delaunay
        .inner_faces()
        .map(|face| {
            let [a, b, c] = face.vertices().map(|v| index(v.index()));
            [a, c, b]
        })
        .collect();
    let pole = count - 1;
    points.push(DVec3::Z);
    triangles.extend(delaunay.convex_hull().map(|edge| {
        let [a, b] = edge.vertices().map(|v| index(v.index()));
        [b, a, pole]
    }));
    (triangles, points)
}

/// The same hull, numbered along a space-filling curve.
pub fn sphere_hull_along_curve(count: u32) -> (Vec<[u32; 3]>, Vec<DVec3>) {
    let (triangles, points) = sphere_hull(count);
    let order = CurveOrder::new(&points, &triangles);
    (order.renumbered(&triangles), order.points(&points))
}
