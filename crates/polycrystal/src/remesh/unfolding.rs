//! Where triangles of a boundary are folded, though its smooth surface is not.
//!
//! Each triangle lies to the smooth surface as it should. But where that bends sharply, as along the edge of a thin grain, two beside each other may still be folded:
//! smaller ones are so no less often. There edges flip, points go, or move, so that the surface bends less.

use crate::remesh::patch::edges;
use crate::remesh::shaping::{BETTER, Shaping};

/// Cosine of the largest angle between neighbouring triangles (84 degrees): at 90 they are folded, and volumes are still to be restored.
const LARGEST_BEND: f64 = 0.1;

/// What triangles must not become narrower than, unless they were, as of [`least_angle`](crate::remesh::patch::least_angle): 10 degrees.
const NARROW: f64 = -0.985;

impl Shaping<'_> {
    /// Changes triangles beside each other that bend too far, as long as that helps.
    pub(super) fn unfold(&mut self) {
        for _ in 0..self.tuning.searches {
            let mut has_changed = false;
            for edge in self.patch.inner_edges() {
                // Those before it may have taken it away.
                let [first, second] = self.patch.at_edge(edge)[..] else { continue };
                let beside = [first, second].map(|triangle| self.patch.corners(triangle));
                if self.normal(beside[0]).dot(self.normal(beside[1])) < LARGEST_BEND {
                    let points = beside.concat();
                    has_changed |=
                        self.flip_to_unfold(edge) || points.into_iter().any(|point| self.unfold_at(point));
                }
            }
            if !has_changed {
                break;
            }
        }
    }

    fn flip_to_unfold(&mut self, edge: [u32; 2]) -> bool {
        self.flip_if(edge, |shaping, old, new| {
            let replaced = shaping.patch.at_edge(edge);
            shaping.is_flatter(new, &replaced, shaping.flatness(old, &replaced))
        })
    }

    /// Moves a point inside, or takes it away.
    fn unfold_at(&mut self, point: u32) -> bool {
        if !self.patch.is_inside(point) {
            return false;
        }
        let (star, triangles) = (self.star(point), self.patch.star(point).to_vec());
        if self.search(point, &star, |shaping| shaping.flatness(&star, &triangles)) {
            return true;
        }
        self.patch.neighbours(point).into_iter().any(|other| {
            let mut replaced = [self.patch.star(point), self.patch.star(other)].concat();
            replaced.sort_unstable();
            replaced.dedup();
            let before: Vec<[u32; 3]> =
                replaced.iter().map(|triangle| self.patch.corners(*triangle)).collect();
            let before = self.flatness(&before, &replaced);
            self.collapse([point, other], |shaping, _, after| shaping.is_flatter(after, &replaced, before))
        })
    }

    fn is_flatter(&self, triangles: &[[u32; 3]], replaced: &[u32], than: f64) -> bool {
        self.flatness(triangles, replaced) > than + BETTER
    }

    /// The least cosine between neighbours of triangles that are to take the place of others; -1 and less where they are narrow.
    fn flatness(&self, triangles: &[[u32; 3]], replaced: &[u32]) -> f64 {
        let mut least = 1.0_f64;
        for corners in triangles {
            let normal = self.normal(*corners);
            for [from, to] in edges(*corners) {
                let is_beside = |other: &[u32; 3]| edges(*other).contains(&[to, from]);
                let around = self.patch.at_edge([from, to]).into_iter();
                let around = around.filter(|other| !replaced.contains(other));
                let mut all =
                    triangles.iter().copied().chain(around.map(|triangle| self.patch.corners(triangle)));
                if let Some(other) = all.find(is_beside) {
                    least = least.min(normal.dot(self.normal(other)));
                }
            }
        }
        let angle = self.worst_angle(triangles);
        if angle < NARROW { least.min(angle - 1.0) } else { least }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::remesh::gradation::Gradation;
    use crate::remesh::patch::Patch;
    use crate::remesh::reference::Reference;
    use crate::remesh::tuning::RemeshTuning;

    /// Along a ridge of 100 degrees, an edge from one flank to the other folds what an edge along the ridge does not.
    #[test]
    fn an_edge_across_a_ridge_flips_into_it() {
        let slope = 50f64.to_radians();
        let flank = |side: f64| DVec3::new(0.5, side * slope.sin(), -slope.cos());
        let points = vec![DVec3::ZERO, flank(-1.0), DVec3::X, flank(1.0)];
        let lines = vec![vec![0, 3], vec![0, 1], vec![1, 2], vec![2, 3]];
        let gradation = Gradation { growth: 0.4, most: 1.0 };
        let reference = Reference::new(points.clone(), vec![1.0; 4], vec![[0, 1, 2], [2, 3, 0]], gradation);
        let patch = Patch::new(points, lines, &[[0, 1, 3], [1, 2, 3]]);
        let tuning = RemeshTuning::default();
        let mut shaping = Shaping::new(patch, reference, &[0; 4], &tuning);
        let all = |shaping: &Shaping<'_>| shaping.patch.all().collect::<Vec<_>>();
        assert!(shaping.flatness(&all(&shaping), &[]) < 0.0);
        shaping.unfold();
        assert!(shaping.patch.is_edge([0, 2]));
        assert!((shaping.flatness(&all(&shaping), &[]) - 80f64.to_radians().cos()).abs() < 1e-12);
    }
}
