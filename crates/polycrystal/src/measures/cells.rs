//! The angles between the faces of cells.

use std::f64::consts::TAU;

use glam::DVec3;
use rayon::prelude::*;
use voronoi::{FaceId, Side, Tessellation};

use crate::mesh::angles::WeightedAngle;
use crate::{CellComplex, ComplexEdge};

/// An edge of a face, and the way from there into the face.
struct EdgeOfFace {
    edge: ComplexEdge,
    leg: DVec3,
    is_wall: bool,
}

/// The angles at all edges where three cells in space meet, each edge once: what [`angles_between_boundaries`](crate::angles_between_boundaries)
/// finds in their network while it is flat. There are none in the plane.
pub fn angles_between_cells(cells: &Tessellation) -> Vec<WeightedAngle> {
    let complex = CellComplex::from(cells);
    let of_face = |face: FaceId| {
        let corners = complex.corners(face);
        let places: Vec<DVec3> = corners.iter().map(|corner| complex.position(*corner)).collect();
        let middle = places.iter().sum::<DVec3>() / places.len() as f64;
        let is_wall = matches!(complex.sides(face)[1], Side::Wall(_));
        let edges = (0..corners.len()).map(|k| {
            let next = (k + 1) % corners.len();
            let along = (places[next] - places[k]).normalize_or_zero();
            let leg = (middle - places[k]).reject_from_normalized(along).normalize_or_zero();
            EdgeOfFace { edge: ComplexEdge::between([corners[k], corners[next]]), leg, is_wall }
        });
        edges.collect::<Vec<_>>()
    };
    let mut edges: Vec<EdgeOfFace> = complex.faces().into_par_iter().flat_map_iter(of_face).collect();
    edges.par_sort_by_key(|at| at.edge);
    let places = edges.par_chunk_by(|a, b| a.edge == b.edge);
    let triple = places.filter(|at| at.len() == 3 && !at.iter().any(|at| at.is_wall));
    triple.flat_map_iter(|at| angles_at(&complex, at)).collect()
}

/// The angles between three faces around their edge.
fn angles_at(complex: &CellComplex, at: &[EdgeOfFace]) -> impl Iterator<Item = WeightedAngle> + use<> {
    let [start, end] = at[0].edge.across(false).map(|end| complex.position(end));
    let zero = at[0].leg;
    let quarter = (end - start).normalize_or_zero().cross(zero);
    let mut directions = [0, 1, 2].map(|k| at[k].leg.dot(quarter).atan2(at[k].leg.dot(zero)));
    directions.sort_by(f64::total_cmp);
    let [first, second, third] = directions;
    let weight = start.distance(end);
    let angles = [second - first, third - second, first + TAU - third];
    angles.into_iter().map(move |angle| WeightedAngle { degrees: angle.to_degrees(), weight })
}

#[cfg(test)]
mod tests {
    use glam::BVec3;
    use voronoi::Domain;

    use super::*;
    use crate::{AngleStatistics, Junctions, Network, angles_between_boundaries};

    #[test]
    fn angles_are_those_of_the_flat_network() {
        let seeds: Vec<DVec3> =
            (1..=40).map(|k| (DVec3::new(0.819, 0.671, 0.550) * f64::from(k)).fract()).collect();
        for domain in [Domain::unit_cube(), Domain::unit_cube().with_periods(BVec3::TRUE)] {
            let cells = Tessellation::new(&domain, &seeds).expect("valid seeds");
            let (network, flat) = Network::new(&cells, Junctions::Crease, 0).expect("a small network");
            let of_network = angles_between_boundaries(&network, network.control_mesh(), &flat);
            let of_cells = angles_between_cells(&cells);
            // Each line of the network has two edges.
            assert_eq!(2 * of_cells.len(), of_network.len());
            let [a, b] = [of_cells, of_network].map(|angles| AngleStatistics::of(angles).expect("some"));
            assert!((a.mean - 120.0).abs() < 1e-9 && (b.mean - 120.0).abs() < 1e-9);
            assert!((a.standard_deviation - b.standard_deviation).abs() < 1e-6, "{a:?} {b:?}");
        }
    }
}
