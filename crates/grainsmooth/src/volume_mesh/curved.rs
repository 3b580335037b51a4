//! Edges of boundaries on the smooth surface, for elements of second order that stay far from turning inside out.

use std::array;
use std::collections::{BTreeMap, BTreeSet};

use glam::{DMat3, DVec3};
use polycrystal::{EdgeMiddles, Mesh, Network};
use subzero::EdgeId;

use super::element_nodes::sorted;
use super::element_shape::EDGES;
use super::{CurvedEdges, VolumeMesh};

/// The Jacobian determinant that an element must have everywhere, as a share of what it is with straight edges. Of 200 grains with five elements to a diameter fewer than
/// 2 in 1000 edges became straight for it.
pub(super) const LEAST: f64 = 0.2;

/// The middle between two corners, by its number in [`EDGES`].
const MIDDLES: [[usize; 4]; 4] = [[0, 0, 2, 3], [0, 1, 1, 4], [2, 1, 2, 5], [3, 4, 5, 3]];

impl VolumeMesh {
    /// Bends edges of boundaries onto the smooth surface, to the given middles, so that grains keep their volumes. The edges of elements that would come near to turning inside out stay straight.
    pub(crate) fn curve(&mut self, network: &Network, mut middles: EdgeMiddles) {
        let level = network.finest_level();
        let Mesh::Triangles(mesh) = &level.mesh else { return };
        let edges: BTreeMap<[u32; 2], EdgeId> =
            (0u32..).zip(mesh.edges()).map(|(edge, ends)| (sorted(ends), EdgeId(edge))).collect();
        let surface = &self.points[..self.surface_points];
        loop {
            let largest_volume_error = middles.restore_volumes(network, surface);
            let middle = |ends: [u32; 2]| edges.get(&ends).map(|edge| middles.points()[edge.index()]);
            let mut least_jacobian = 1.0f64;
            let mut bent = BTreeSet::new();
            for corners in &self.tetrahedra {
                let of_edges = EDGES.map(|ends| sorted(ends.map(|end| corners[end])));
                let at_edges = of_edges.map(middle);
                if at_edges.iter().all(Option::is_none) {
                    continue;
                }
                let places = corners.map(|corner| self.points[corner as usize]);
                let straight = EDGES.map(|[from, to]| places[from].midpoint(places[to]));
                let at_middles = array::from_fn(|k| at_edges[k].unwrap_or(straight[k]));
                let share = least_jacobian_share(places, at_middles);
                least_jacobian = least_jacobian.min(share);
                if share < LEAST {
                    let own = of_edges.iter().filter_map(|ends| edges.get(ends));
                    bent.extend(own.copied().filter(|edge| !middles.is_straight(*edge)));
                }
            }
            if bent.is_empty() {
                let straight = edges.values().filter(|edge| middles.is_straight(**edge)).count();
                let curved = edges.len() - straight;
                self.curved = Some(CurvedEdges { curved, straight, least_jacobian, largest_volume_error });
                break;
            }
            middles.straighten(network, surface, bent.into_iter());
        }
        self.middles = edges.into_iter().map(|(ends, edge)| (ends, middles.points()[edge.index()])).collect();
    }
}

/// A lower bound of the Jacobian determinant of an element of second order, as a share of what it is with straight edges.
///
/// The determinant is a cubic polynomial, and nowhere less than the least of its Bernstein coefficients. A. Johnen, J.-F. Remacle, C. Geuzaine, Journal of Computational Physics 233 (2013) 359.
pub(crate) fn least_jacobian_share(corners: [DVec3; 4], middles: [DVec3; 6]) -> f64 {
    // The derivative by a barycentric coordinate, which is linear, at a corner.
    let derivative = |by: usize, at: usize| match by == at {
        true => corners[at] * 3.0,
        false => middles[MIDDLES[by][at]] * 4.0 - corners[by],
    };
    let columns = [0, 1, 2, 3].map(|at| [1, 2, 3].map(|by| derivative(by, at) - derivative(0, at)));
    let determinant = |at: [usize; 3]| {
        DMat3::from_cols(columns[at[0]][0], columns[at[1]][1], columns[at[2]][2]).determinant()
    };
    let coefficient = |[i, j, k]: [usize; 3]| {
        let orders = [[i, j, k], [i, k, j], [j, i, k], [j, k, i], [k, i, j], [k, j, i]];
        orders.map(determinant).iter().sum::<f64>() / 6.0
    };
    let all = (0..4).flat_map(|i| (i..4).flat_map(move |j| (j..4).map(move |k| [i, j, k])));
    let [a, b, c, d] = corners;
    let straight = (b - a).cross(c - a).dot(d - a);
    all.map(|at| coefficient(at) / straight).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [DVec3; 4] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];

    fn straight() -> [DVec3; 6] {
        EDGES.map(|[from, to]| CORNERS[from].midpoint(CORNERS[to]))
    }

    /// The determinant by finite differences at a point.
    fn determinant(middles: [DVec3; 6], [x, y, z]: [f64; 3]) -> f64 {
        let place = |point: DVec3| {
            let weights = [1.0 - point.element_sum(), point.x, point.y, point.z];
            let of_corners = (0..4).map(|k| CORNERS[k] * (weights[k] * (2.0 * weights[k] - 1.0)));
            let of_middles =
                EDGES.iter().zip(middles).map(|([i, j], at)| at * (4.0 * weights[*i] * weights[*j]));
            of_corners.chain(of_middles).sum::<DVec3>()
        };
        let at = DVec3::new(x, y, z);
        let along = |axis: DVec3| (place(at + axis * 1e-5) - place(at - axis * 1e-5)) / 2e-5;
        DMat3::from_cols(along(DVec3::X), along(DVec3::Y), along(DVec3::Z)).determinant()
    }

    #[test]
    fn straight_elements_have_one_jacobian() {
        assert!((least_jacobian_share(CORNERS, straight()) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_bound_is_below_the_least_and_near_it() {
        for (edge, by) in (0..6).flat_map(|edge| [-0.1, 0.05, 0.1].map(|by| (edge, by))) {
            let mut middles = straight();
            middles[edge] += DVec3::new(0.7, -1.0, 0.4) * by;
            let bound = least_jacobian_share(CORNERS, middles);
            let grid = (0..=10)
                .flat_map(|i| (0..=10 - i).flat_map(move |j| (0..=10 - i - j).map(move |k| [i, j, k])));
            let least = grid
                .map(|at| determinant(middles, at.map(|k| f64::from(k) / 10.0)))
                .fold(f64::INFINITY, f64::min);
            assert!((bound - 1e-6..bound + 0.2).contains(&least), "edge {edge}: {bound} {least}");
        }
    }

    /// The middle of an edge beyond a quarter of it turns the element inside out at a corner.
    #[test]
    fn a_middle_beyond_a_quarter_is_found() {
        let mut middles = straight();
        middles[0].x = 0.26;
        assert!(least_jacobian_share(CORNERS, middles) > 0.0);
        middles[0].x = 0.24;
        assert!(least_jacobian_share(CORNERS, middles) < 0.0);
    }
}
