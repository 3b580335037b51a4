//! Triangles with a small angle, and whether their place leaves them another.

use glam::DVec3;
use rayon::prelude::*;
use subzero::VertexRule;

use crate::mesh::triangle_quality::squared_sine;
use crate::{Mesh, Network};

/// Triangles that are narrow: their smallest angles are below [`NarrowTriangles::BOUND`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NarrowTriangles {
    /// How many there are.
    pub count: usize,
    /// Those of them whose corners are all on lines: they fill a corner or a strip that is as narrow itself.
    pub between_lines: usize,
}

impl NarrowTriangles {
    /// The smallest angle, in degrees, of a triangle that is not narrow.
    pub const BOUND: f64 = 20.0;
}

impl Network {
    /// How many triangles of the finest level are narrow, for its points; nothing in the plane.
    ///
    /// # Panics
    /// When there is not one point per vertex of the finest level.
    pub fn narrow_triangles(&self, points: &[DVec3]) -> Option<NarrowTriangles> {
        let level = self.finest_level();
        assert_eq!(points.len(), level.vertex_count(), "there must be one point per vertex");
        let Mesh::Triangles(mesh) = &level.mesh else { return None };
        let bound = NarrowTriangles::BOUND.to_radians().sin().powi(2);
        let is_narrow =
            |corners: &&[u32; 3]| squared_sine(corners.map(|corner| points[corner as usize])) < bound;
        let is_on_line = |corner: &u32| mesh.vertex_rule(*corner) != VertexRule::Smooth;
        let narrow = mesh.triangles().par_iter().filter(is_narrow);
        let [count, between_lines] = narrow
            .map(|corners| [1, usize::from(corners.iter().all(is_on_line))])
            .reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        Some(NarrowTriangles { count, between_lines })
    }
}

#[cfg(test)]
mod tests {
    use glam::BVec3;
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::{ElementSize, Junctions, Remeshed};

    /// Triangles of two halves of a cube, all heights a twentieth: those of upright sides are narrow. Their corners are on lines where two of the planes meet that bound the halves.
    #[test]
    fn triangles_of_thin_slabs_are_narrow() {
        let domain = Domain::unit_cube();
        let seeds = [DVec3::new(0.25, 0.5, 0.5), DVec3::new(0.75, 0.5, 0.5)];
        let tessellation = Tessellation::new(&domain, &seeds).expect("valid seeds");
        let (network, flat) = Network::new(&tessellation, Junctions::Crease, 3).expect("two cells");
        let remeshed = network.remeshed(&network.subdivide(&flat), &ElementSize::new(0.4), BVec3::FALSE);
        let Remeshed { network, points, .. } = remeshed.expect("two boxes");
        assert_eq!(network.narrow_triangles(&points), Some(NarrowTriangles { count: 0, between_lines: 0 }));
        let thin: Vec<DVec3> = points.iter().map(|point| *point * DVec3::new(1.0, 1.0, 0.05)).collect();
        let planes = |point: DVec3| {
            [[0.0, 0.5, 1.0], [0.0, 1.0, 1.0], [0.0, 1.0, 1.0]]
                .iter()
                .zip(point.to_array())
                .filter(|(planes, x)| planes.contains(x))
                .count()
        };
        let Mesh::Triangles(mesh) = &network.finest_level().mesh else { panic!("in space") };
        let corners = mesh.triangles().iter().map(|corners| corners.map(|corner| points[corner as usize]));
        let upright = corners.filter(|[a, b, c]| a.z != b.z || b.z != c.z);
        let between: Vec<bool> =
            upright.map(|corners| corners.into_iter().all(|point| planes(point) > 1)).collect();
        let between_lines = between.iter().filter(|between| **between).count();
        assert!((1..between.len()).contains(&between_lines));
        assert_eq!(
            network.narrow_triangles(&thin),
            Some(NarrowTriangles { count: between.len(), between_lines })
        );
    }
}
