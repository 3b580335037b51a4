//! Networks of given triangles: a ball in a grain, and what cannot be a network.

use std::f64::consts::PI;

use crate::common::{Labelled, cube};
use glam::{DVec3, swizzles::Vec3Swizzles};
use polycrystal::{
    BoundaryId, Elements, GrainId, Junctions, Network, NetworkError, Relaxation, Side, Surface,
    dihedral_angles, measure_network, relax, validate,
};
use voronoi::{Domain, Tessellation};

fn octahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let points = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z].to_vec();
    let triangles = (0..4).flat_map(|k| [[k, (k + 1) % 4, 4], [(k + 1) % 4, k, 5]]).collect();
    (points, triangles)
}

/// The area of a ball is 4.836 V^(2/3), and MacPherson and Srolovitz 2007 have it shrink by 8 pi R.
#[test]
fn a_grain_in_another_becomes_a_ball() {
    let (cube, cube_triangles) = cube();
    let cube = cube.iter().map(|corner| (*corner - 0.5) * DVec3::new(0.4, 0.45, 0.35) + 0.5);
    let (octahedron, octahedron_triangles) = octahedron();
    let blob =
        octahedron.iter().map(|corner| *corner * 0.3 + DVec3::new(0.5, 0.45, 0.55) + 0.05 * corner.yzx());
    for (points, triangles) in
        [(cube.collect::<Vec<_>>(), cube_triangles), (blob.collect(), octahedron_triangles)]
    {
        let (network, start) = Labelled::inclusion(&points, &triangles).network(4).expect("a network");
        let volume = network.cell_volumes()[1];
        let relaxed = relax(&network, &start, &Relaxation::Equilibrium, |_, _| ()).expect("relaxes");
        let smooth = relaxed.finest_points(&network);
        validate(&network, &smooth).expect("valid");
        let grain = measure_network(&network, &smooth).in_space().expect("surfaces").grains.swap_remove(1);
        assert!((grain.volume / volume - 1.0).abs() < 1e-10);
        let sphericity = grain.area / ((36.0 * PI).cbrt() * volume.powf(2.0 / 3.0));
        let rate = grain.growth_rate.expect("no wall") / (-8.0 * PI * (0.75 * volume / PI).cbrt());
        assert!((sphericity - 1.0).abs() < 2e-3, "{sphericity}");
        assert!((rate - 1.0).abs() < 1e-2, "{rate}");
    }
}

/// The network of a tessellation, given as triangles, is itself.
#[test]
fn triangles_of_a_network_make_it_again() {
    let seeds: Vec<DVec3> =
        [(0.2, 0.3, 0.4), (0.7, 0.2, 0.6), (0.5, 0.8, 0.3), (0.4, 0.6, 0.8), (0.8, 0.7, 0.7)]
            .map(|(x, y, z)| DVec3::new(x, y, z))
            .to_vec();
    for domain in [Domain::unit_cube(), Domain::unit_square()] {
        let is_plane = domain.dimension() == voronoi::Dimension::Two;
        let seeds: Vec<DVec3> =
            seeds.iter().map(|seed| if is_plane { seed.with_z(0.0) } else { *seed }).collect();
        let tessellation = Tessellation::new(&domain, &seeds).expect("valid seeds");
        let (network, flat) = Network::new(&tessellation, Junctions::Crease, 2).expect("a network");
        let sides = network.sides();
        let level = network.control_mesh();
        // Backwards: second side first, and boundaries known by their sides alone.
        let mut pairs = sides.clone();
        pairs.sort_unstable();
        pairs.dedup();
        let number = |boundary: &BoundaryId| {
            let place = pairs.binary_search(&sides[boundary.index()]).expect("a pair of sides");
            BoundaryId(u32::try_from(place).expect("few boundaries"))
        };
        let boundary_of: Vec<BoundaryId> = level.boundary_of.iter().map(number).collect();
        let turned: Vec<[Side; 2]> = pairs.iter().map(|[a, b]| [*b, *a]).collect();
        let surface = Surface::of_level(level, &flat, &sides);
        let triangles: Vec<[u32; 3]>;
        let segments: Vec<[u32; 2]>;
        let elements = match surface.elements {
            Elements::Triangles(all) => {
                triangles = all.iter().map(|&[a, b, c]| [a, c, b]).collect();
                Elements::Triangles(&triangles)
            }
            Elements::Refined(_) => unreachable!("the level is held"),
            Elements::Segments(all) => {
                segments = all.iter().map(|&[a, b]| [b, a]).collect();
                Elements::Segments(&segments)
            }
        };
        let surface = Surface { points: &flat, elements, boundary_of: &boundary_of, sides: &turned };
        let (again, points) =
            Network::of_surface(&domain, &surface, Junctions::Crease, 2).expect("the same network");
        assert_eq!(points, flat);
        assert_eq!(again.junction_counts(), network.junction_counts());
        assert_eq!(again.control_mesh().node_types, level.node_types);
        assert_eq!(again.boundaries().len(), network.boundaries().len());
        let [smooth, smooth_again] = [&network, &again].map(|network| {
            let relaxed = relax(network, &flat, &Relaxation::KEPT_TOPOLOGY, |_, _| ()).expect("relaxes");
            let smooth = relaxed.finest_points(network);
            validate(network, &smooth).expect("valid");
            dihedral_angles(network, network.finest(), &smooth).expect("lines").standard_deviation
        });
        assert!((smooth - smooth_again).abs() < 1e-6, "{smooth}, {smooth_again}");
    }
}

#[test]
fn what_is_no_network_is_refused() {
    let (points, triangles) = octahedron();
    let points: Vec<DVec3> = points.iter().map(|point| *point * 0.3 + 0.5).collect();
    let good = || Labelled::inclusion(&points, &triangles);
    good().network(0).expect("good");
    let mut open = good();
    open.triangles.pop();
    open.boundary_of.pop();
    let error = open.network(0).expect_err("a triangle is missing");
    assert!(error.to_string().contains("not closed"), "{error}");
    let mut off_wall = good();
    off_wall.points[0].x = 1e-9;
    let error = off_wall.network(0).expect_err("a corner off its wall");
    assert!(matches!(error, NetworkError::NotOnWall { .. } | NetworkError::Invalid(_)), "{error}");
    let mut gap = good();
    for side in gap.sides.iter_mut().flatten().filter(|side| **side == Side::Grain(GrainId(1))) {
        *side = Side::Grain(GrainId(2));
    }
    let error = gap.network(0).expect_err("no grain 1");
    assert_eq!(
        error.to_string(),
        "no triangle or segment has grain 1 on a side; number grains from 0 without gaps"
    );
    let periodic = Domain::unit_cube().with_periods(glam::BVec3::TRUE);
    let Labelled { points, triangles, boundary_of, sides } = good();
    let surface = Surface {
        points: &points,
        elements: Elements::Triangles(&triangles),
        boundary_of: &boundary_of,
        sides: &sides,
    };
    let error = Network::of_surface(&periodic, &surface, Junctions::Crease, 0).expect_err("periods");
    assert!(matches!(error, NetworkError::PeriodicSurface));
}
