//! The certificate of a network: what any surface must be, and the volumes and types that its cells give.

use glam::DVec3;
use rayon::prelude::*;

use crate::check::certificate::inspect;
use crate::mesh::adjacency::Adjacency;
use crate::{Certificate, Expected, Faults, GrainId, Network, Surface, dihedral_angles};

/// Checks the finest level of a network with the given points: everything that [`certify`](crate::certify) finds in any
/// surface, grains that have the volumes of their cells, and the types of points.
///
/// ```
/// use glam::DVec3;
/// use polycrystal::{Junctions, Network, validate};
/// use voronoi::{Domain, Tessellation};
///
/// let seeds = [DVec3::new(0.3, 0.4, 0.5), DVec3::new(0.7, 0.3, 0.2), DVec3::new(0.6, 0.8, 0.9)];
/// let cells = Tessellation::new(&Domain::unit_cube(), &seeds)?;
/// let (network, mut points) = Network::new(&cells, Junctions::Crease, 0)?;
/// assert!(validate(&network, &points)?.total_volume_error < 1e-12);
/// // Twice as large, the grains no longer have the volumes of their cells.
/// points.iter_mut().for_each(|point| *point *= 2.0);
/// assert!(validate(&network, &points).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// All that is wrong.
///
/// # Panics
/// When there is not one point per vertex.
pub fn validate(network: &Network, points: &[DVec3]) -> Result<Certificate, Faults> {
    let certificate = certificate(network, points, network.cell_volumes());
    if certificate.is_good() { Ok(certificate) } else { Err(certificate.faults) }
}

/// What [`validate`] finds where grains are to have these volumes, with all that is wrong.
pub(crate) fn certificate(network: &Network, points: &[DVec3], volumes: &[f64]) -> Certificate {
    let level = network.finest();
    let sides = network.sides();
    let surface = Surface::of_level(level, points, &sides);
    let volumes: Vec<(GrainId, f64)> = (0u32..).map(GrainId).zip(volumes.iter().copied()).collect();
    let stated_points = || (0..surface.refined_at_most(1).points.len()).into_par_iter();
    let node_types: Vec<_> = stated_points().map(|point| Some(level.node_type(point))).collect();
    let grain_counts: Vec<u8> = stated_points().map(|point| level.grain_count(point)).collect();
    let originals = network.domain().is_periodic().then(|| level.originals());
    let expected = Expected {
        // Types in a periodic domain count the grains a period away, which the surface calls exterior.
        node_types: (!network.domain().is_periodic()).then_some(&node_types),
        grain_counts: Some(&grain_counts),
        originals: originals.as_deref(),
        grain_volumes: Some(&volumes),
        domain_volume: network.fills_domain().then(|| network.domain().measure()),
        rounding: surface.last_place(),
    };
    let mut certificate = inspect(&surface, &Adjacency::of_level(level), &expected);
    // The surface does not know what it is like through the walls.
    if certificate.is_good() && network.domain().is_periodic() {
        certificate.angles = dihedral_angles(network, level, points);
    }
    certificate
}

#[cfg(test)]
mod tests {
    use voronoi::{Domain, Tessellation};

    use super::*;
    use crate::{Boundary, Fault, Junctions, Mesh, Side};

    fn cubes(domain: &Domain) -> (Network, Vec<DVec3>) {
        let middle = 0.5 * domain.size().z;
        let seeds: Vec<DVec3> = (0..4)
            .map(|i| DVec3::new(f64::from(i % 2) * 0.5 + 0.25, f64::from(i / 2) * 0.5 + 0.25, middle))
            .collect();
        let tessellation = Tessellation::new(domain, &seeds).expect("valid seeds");
        let (network, flat) = Network::new(&tessellation, Junctions::Crease, 1).expect("a small network");
        let points = network.subdivide(&flat);
        (network, points)
    }

    /// What is wrong, in the order in which it is found.
    fn kinds(network: &Network, points: &[DVec3]) -> Vec<&'static str> {
        let faults = validate(network, points).expect_err("something is wrong");
        let mut kinds: Vec<&str> = faults.0.iter().map(Fault::kind).collect();
        kinds.dedup();
        kinds
    }

    /// A point inside a boundary, for the faults to start from.
    fn inner_point(network: &Network) -> usize {
        let node_types = &network.finest_level().into_owned().node_types;
        node_types.iter().position(|node_type| *node_type == crate::NodeType::INTERIOR).expect("a boundary")
    }

    #[test]
    fn good_networks_pass() {
        for domain in [Domain::unit_cube(), Domain::unit_square()] {
            let (network, points) = cubes(&domain);
            let validation = validate(&network, &points).expect("valid");
            assert!(validation.largest_volume_error < 1e-14 && validation.total_volume_error < 1e-14);
        }
    }

    #[test]
    fn a_point_that_is_no_number_is_found() {
        let (network, mut points) = cubes(&Domain::unit_cube());
        points[7].y = f64::NAN;
        let faults = validate(&network, &points).expect_err("no number");
        assert_eq!(faults.0, [Fault::NotFinite { point: 7 }]);
    }

    #[test]
    fn points_at_the_same_place_are_found_wherever_they_are() {
        for domain in [Domain::unit_cube(), Domain::unit_square()] {
            let (network, points) = cubes(&domain);
            // With a triangle in common, a point, or nothing.
            for (second, place) in (0u32..).zip(&points) {
                for first in (0..second).step_by(7) {
                    let mut points = points.clone();
                    points[first as usize] = *place;
                    let faults = validate(&network, &points).expect_err("a point twice").0;
                    let points = [first, second];
                    assert!(faults.contains(&Fault::DuplicatePoints { points }), "{faults:?}");
                }
            }
        }
    }

    #[test]
    fn triangles_and_segments_without_size_are_found() {
        for domain in [Domain::unit_cube(), Domain::unit_square()] {
            let (network, mut points) = cubes(&domain);
            let (a, b) = match &network.finest_level().mesh {
                Mesh::Triangles(mesh) => (mesh.triangles()[0][0], mesh.triangles()[0][1]),
                Mesh::Segments(mesh) => (mesh.segments()[0][0], mesh.segments()[0][1]),
            };
            points[a as usize] = points[b as usize];
            assert_eq!(kinds(&network, &points)[..2], ["no area", "duplicate points"]);
        }
    }

    #[test]
    fn folds_are_found() {
        for domain in [Domain::unit_cube(), Domain::unit_square()] {
            let (network, mut points) = cubes(&domain);
            // Out of its own fan, within the plane of its boundary, which stands across x or y: never along the other.
            let inner = inner_point(&network);
            let across = if points[inner].x == 0.5 { 0 } else { 1 };
            points[inner][1 - across] += 0.9;
            points[inner][across] += 0.01;
            assert!(kinds(&network, &points).contains(&"folded"));
        }
    }

    #[test]
    fn grains_of_the_wrong_volume_are_found() {
        for domain in [Domain::unit_cube(), Domain::unit_square()] {
            let (network, mut points) = cubes(&domain);
            points[inner_point(&network)] += DVec3::new(1e-4, 1e-4, 0.0);
            assert_eq!(kinds(&network, &points), ["wrong volume"]);
        }
    }

    #[test]
    fn grains_that_are_not_closed_are_found() {
        for domain in [Domain::unit_cube(), Domain::unit_square()] {
            let (mut network, points) = cubes(&domain);
            let wrong: &mut Boundary = network.boundary_mut(0);
            wrong.sides = [Side::Grain(GrainId(2)), Side::Grain(GrainId(3))];
            assert!(kinds(&network, &points).contains(&"open"));
        }
    }
}
