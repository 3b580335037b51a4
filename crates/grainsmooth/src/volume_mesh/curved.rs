//! Edges of boundaries on the smooth surface, for elements of second order that stay far from turning inside out.

use std::array;
use std::collections::{BTreeMap, BTreeSet};

use glam::{DMat3, DVec3};
use polycrystal::{CurvedBoundaries, Mesh, Network};
use subzero::EdgeId;

use super::element_nodes::sorted;
use super::element_shape::EDGES;
use super::{CurvedEdges, VolumeMesh, volume};

/// The Jacobian determinant that an element must have everywhere, as a share of what it is with straight edges, and the volume with these, as a share of what it is before points move. Of 200 grains with five elements to a diameter fewer than
/// 2 in 1000 edges became straight for it.
const LEAST: f64 = 0.2;

/// The middle between two corners, by its number in [`EDGES`].
const MIDDLES: [[usize; 4]; 4] = [[0, 0, 2, 3], [0, 1, 1, 4], [2, 1, 2, 5], [3, 4, 5, 3]];

/// What elements are by their corners, and by the middles of their edges.
pub(super) struct Measures<Size, Shares> {
    /// Volume or area, in any unit.
    pub(super) size: Size,
    /// A lower bound of the Jacobian determinant, and its mean, as shares of what they are with straight edges.
    pub(super) jacobian_shares: Shares,
}

/// Moves points and edges of boundaries onto the smooth surface, so that grains keep their volumes. Those of elements that would come near to turning inside out stay where they are, with
/// straight edges.
///
/// `points` begin with those of boundaries; `ends` tells between which corners the edges of an element are. Gives the middles of edges on boundaries by their ends.
pub(super) fn curve<const CORNERS: usize, const EDGES: usize>(
    network: &Network,
    mut boundaries: CurvedBoundaries,
    points: &mut [DVec3],
    elements: &[[u32; CORNERS]],
    ends: [[usize; 2]; EDGES],
    measures: &Measures<
        impl Fn([DVec3; CORNERS]) -> f64,
        impl Fn([DVec3; CORNERS], [DVec3; EDGES]) -> (f64, f64),
    >,
) -> (BTreeMap<[u32; 2], DVec3>, CurvedEdges) {
    let level = network.finest_level();
    let all_edges: Vec<[u32; 2]> = match &level.mesh {
        Mesh::Triangles(mesh) => mesh.edges().collect(),
        Mesh::Segments(mesh) => mesh.segments().to_vec(),
    };
    let edges: BTreeMap<[u32; 2], EdgeId> =
        (0u32..).zip(all_edges).map(|(edge, ends)| (sorted(ends), EdgeId(edge))).collect();
    let places = |points: &[DVec3], corners: &[u32; CORNERS]| corners.map(|corner| points[corner as usize]);
    let sizes: Vec<f64> = elements.iter().map(|corners| (measures.size)(places(points, corners))).collect();
    let flat = points[..boundaries.corners().len()].to_vec();
    loop {
        let largest_volume_error = boundaries.restore_volumes(network);
        points[..flat.len()].copy_from_slice(boundaries.corners());
        let mut least_jacobian = 1.0f64;
        let (mut moved, mut bent) = (BTreeSet::new(), BTreeSet::new());
        for (corners, size) in elements.iter().zip(&sizes) {
            let on_boundaries = corners.iter().filter(|corner| (**corner as usize) < flat.len());
            if on_boundaries.clone().next().is_none() {
                continue;
            }
            let own = ends.map(|ends| edges.get(&sorted(ends.map(|end| corners[end]))).copied());
            let places = places(points, corners);
            let middles = array::from_fn(|k| match own[k] {
                Some(edge) => boundaries.middles()[edge.index()],
                None => places[ends[k][0]].midpoint(places[ends[k][1]]),
            });
            let (share, _) = (measures.jacobian_shares)(places, middles);
            least_jacobian = least_jacobian.min(share);
            if share.min((measures.size)(places) / size) < LEAST {
                let is_moved =
                    |corner: &u32| boundaries.corners()[*corner as usize] != flat[*corner as usize];
                moved.extend(on_boundaries.copied().filter(is_moved));
                bent.extend(own.into_iter().flatten().filter(|edge| !boundaries.is_straight(*edge)));
            }
        }
        if moved.is_empty() && bent.is_empty() {
            let straight = edges.values().filter(|edge| boundaries.is_straight(**edge)).count();
            let curved = edges.len() - straight;
            let middles = boundaries.middles();
            let middles = edges.into_iter().map(|(ends, edge)| (ends, middles[edge.index()])).collect();
            return (middles, CurvedEdges { curved, straight, least_jacobian, largest_volume_error });
        }
        boundaries.straighten(network, &flat, moved.into_iter(), bent.into_iter());
    }
}

impl VolumeMesh {
    /// Gives tetrahedra second order, as of [`curve`].
    pub(crate) fn curve(&mut self, network: &Network, boundaries: CurvedBoundaries) {
        let measures = Measures { size: volume, jacobian_shares };
        let (middles, curved) =
            curve(network, boundaries, &mut self.points, &self.tetrahedra, EDGES, &measures);
        (self.middles, self.curved) = (middles, Some(curved));
    }
}

/// A lower bound of the Jacobian determinant of an element of second order, and its mean, which is that of the volume, as shares of what they are with straight edges.
///
/// The determinant is a cubic polynomial: nowhere less than the least of its Bernstein coefficients, and the mean of these on the mean. A. Johnen, J.-F. Remacle, C. Geuzaine, Journal of Computational Physics 233 (2013) 359.
pub(crate) fn jacobian_shares(corners: [DVec3; 4], middles: [DVec3; 6]) -> (f64, f64) {
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
    least_and_mean(all.map(|at| coefficient(at) / straight))
}

pub(super) fn least_and_mean(shares: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut least, mut sum, mut count) = (f64::INFINITY, 0.0, 0.0);
    for share in shares {
        (least, sum, count) = (least.min(share), sum + share, count + 1.0);
    }
    (least, sum / count)
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
        let (least, mean) = jacobian_shares(CORNERS, straight());
        assert!((least - 1.0).abs() < 1e-14 && (mean - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_bound_is_below_the_least_and_near_it() {
        for (edge, by) in (0..6).flat_map(|edge| [-0.1, 0.05, 0.1].map(|by| (edge, by))) {
            let mut middles = straight();
            middles[edge] += DVec3::new(0.7, -1.0, 0.4) * by;
            let (bound, _) = jacobian_shares(CORNERS, middles);
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
        assert!(jacobian_shares(CORNERS, middles).0 > 0.0);
        middles[0].x = 0.24;
        assert!(jacobian_shares(CORNERS, middles).0 < 0.0);
    }

    /// With the middles below a face moved by -h along z, z changes by -4 h ((1 - x - y - z) (x + y) + x y), and the volume by the integral of 4 h (x + y): h / 3.
    #[test]
    fn the_mean_is_that_of_the_volume() {
        let mut middles = straight();
        middles.iter_mut().filter(|middle| middle.z == 0.0).for_each(|middle| middle.z = -0.1);
        let (_, mean) = jacobian_shares(CORNERS, middles);
        assert!((mean - 1.2).abs() < 1e-13, "{mean}");
    }
}
