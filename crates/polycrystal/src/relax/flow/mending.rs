//! What a flow to rest does about folds, which it has the time to come back to.

use glam::DVec3;
use subzero::VertexRule;

use super::{ATTEMPTS, Flow, Wedged};
use crate::Mesh;

impl Flow<'_> {
    /// Takes folds out of the finest level, as far as that goes.
    pub(super) fn iron_folds(&self, points: &mut [DVec3], finest: &Wedged) {
        for _ in 0..ATTEMPTS {
            let places = self.folded_places(&self.finest_points(points), finest);
            if places.is_empty() {
                break;
            }
            self.iron(points, &places.concat());
        }
    }

    /// Puts some points where their neighbours have their mean: those inside boundaries, and those on lines between the two on
    /// the same line.
    pub(super) fn iron(&self, points: &mut [DVec3], some: &[u32]) {
        let Mesh::Triangles(mesh) = self.control_mesh() else { return };
        let mut is_folded = vec![false; points.len()];
        some.iter().for_each(|point| is_folded[*point as usize] = true);
        let mut sums = vec![(DVec3::ZERO, 0.0); points.len()];
        for edge in 0..u32::try_from(mesh.edge_count()).expect("edge ids fit 32 bits") {
            let ends = mesh.edge(edge);
            for [point, other] in [ends, [ends[1], ends[0]]] {
                let counts = match mesh.vertex_rule(point) {
                    VertexRule::Smooth => true,
                    VertexRule::Crease => mesh.is_crease(edge),
                    _ => false,
                };
                if is_folded[point as usize] && counts {
                    let (sum, count) = &mut sums[point as usize];
                    *sum += points[other as usize];
                    *count += 1.0;
                }
            }
        }
        let mut moves: Vec<DVec3> = points
            .iter()
            .zip(&sums)
            .map(|(point, (sum, count))| if *count > 0.0 { *sum / *count - *point } else { DVec3::ZERO })
            .collect();
        self.unite(&self.clusters, &mut moves, 0);
        points.iter_mut().zip(&moves).for_each(|(point, by)| *point += *by);
    }
}
