//! Control meshes other than VirMat's: lines divided once for all their boundaries, boundaries filled to match.

use std::collections::BTreeSet;

use crate::common::{random_seeds, relaxed};
use glam::{BVec3, DVec3};
use polycrystal::{FaceMesh, Junctions, Level, Mesh, Network, NetworkError, NodeType, Side, validate};
use subzero::EdgeId;
use voronoi::{Domain, Tessellation};

const EDGE_LENGTH: f64 = 0.1;

const MESHES: [FaceMesh; 3] =
    [FaceMesh::Fan, FaceMesh::Plain, FaceMesh::Refined { edge_length: EDGE_LENGTH }];

/// Random seeds in a cube, in a plate and in a square, and a lattice with higher-order vertices.
fn tessellations() -> Vec<Tessellation> {
    let plate = Domain::cuboid(DVec3::ZERO, DVec3::new(1.0, 0.8, 0.1)).expect("a plate");
    let random = [Domain::unit_cube(), plate, Domain::unit_square()].map(|domain| {
        let flat = domain.size().z == 0.0;
        let seeds =
            random_seeds(&domain, 25, 3).into_iter().map(|seed| if flat { seed.with_z(0.0) } else { seed });
        Tessellation::new(&domain, &seeds.collect::<Vec<_>>()).expect("valid seeds")
    });
    let cubes = (0..16u8).map(|i| DVec3::new(f64::from(i % 2), f64::from(i / 2 % 2), f64::from(i / 4 % 2)));
    let body_centred = cubes.zip(0..16).map(|(cube, i)| (cube + if i < 8 { 0.25 } else { 0.75 }) / 2.0);
    let lattice = Tessellation::new(&Domain::unit_cube(), &body_centred.collect::<Vec<_>>());
    random.into_iter().chain([lattice.expect("valid seeds")]).collect()
}

/// One and more seeds in domains that repeat, in space and in the plane.
fn periodic_tessellations() -> impl Iterator<Item = Tessellation> {
    let axes = [BVec3::TRUE, BVec3::new(true, false, false)];
    let domains =
        axes.map(|axes| [Domain::unit_cube(), Domain::unit_square()].map(|domain| domain.with_periods(axes)));
    domains.into_iter().flatten().flat_map(|domain| {
        [1, 2, 20].map(|count| {
            let flat = domain.size().z == 0.0;
            let seeds = random_seeds(&domain, count, 4).into_iter();
            let seeds: Vec<DVec3> = seeds.map(|seed| if flat { seed.with_z(0.0) } else { seed }).collect();
            Tessellation::new(&domain, &seeds).expect("valid seeds")
        })
    })
}

fn network(tessellation: &Tessellation, face_mesh: FaceMesh, levels: usize) -> (Network, Vec<DVec3>) {
    Network::with_face_mesh(tessellation, face_mesh, Junctions::Crease, levels).expect("a small network")
}

fn elements(level: &Level) -> Vec<Vec<usize>> {
    let indices = |corners: &[u32]| corners.iter().map(|corner| *corner as usize).collect();
    match &level.mesh {
        Mesh::Triangles(mesh) => mesh.triangles().iter().map(|corners| indices(corners)).collect(),
        Mesh::Segments(mesh) => mesh.segments().iter().map(|ends| indices(ends)).collect(),
    }
}

#[test]
fn networks_are_valid_on_every_level() {
    for tessellation in tessellations().into_iter().chain(periodic_tessellations()) {
        for face_mesh in MESHES {
            for levels in 0..=2 {
                let (network, flat) = network(&tessellation, face_mesh, levels);
                let validation = validate(&network, &network.subdivide(&flat));
                validation.unwrap_or_else(|fault| panic!("{face_mesh:?}, level {levels}: {fault}"));
            }
        }
    }
}

#[test]
fn node_types_are_those_of_the_sides_around() {
    for tessellation in tessellations() {
        for face_mesh in MESHES {
            let (network, _) = network(&tessellation, face_mesh, 1);
            for level in network.levels() {
                let mut around = vec![BTreeSet::new(); level.vertex_count()];
                for (corners, boundary) in elements(level).iter().zip(&level.boundary_of) {
                    for corner in corners {
                        around[*corner].extend(network.boundaries()[boundary.index()].sides);
                    }
                }
                for (vertex, sides) in around.into_iter().enumerate() {
                    let sides: Vec<Side> = sides.into_iter().collect();
                    assert_eq!(
                        level.node_types[vertex],
                        NodeType::of_sides(&sides),
                        "{face_mesh:?}, vertex {vertex}"
                    );
                }
            }
        }
    }
}

#[test]
fn boundaries_have_the_area_of_their_faces_and_end_at_their_lines() {
    for tessellation in tessellations().into_iter().chain(periodic_tessellations()) {
        for face_mesh in MESHES {
            let (network, points) = network(&tessellation, face_mesh, 0);
            let Mesh::Triangles(mesh) = &network.control_mesh().mesh else { continue };
            let mut areas = vec![DVec3::ZERO; tessellation.face_count()];
            for (corners, boundary) in mesh.triangles().iter().zip(&network.control_mesh().boundary_of) {
                let [a, b, c] = corners.map(|corner| points[corner as usize]);
                areas[boundary.index()] += (b - a).cross(c - a);
            }
            for face in tessellation.faces() {
                let corners = tessellation.face_corners(face);
                let at = |k: usize| tessellation.vertices()[corners[k].index()];
                let exact: DVec3 = (2..corners.len()).map(|k| (at(k - 1) - at(0)).cross(at(k) - at(0))).sum();
                assert!((areas[face.index()] - exact).length() < 1e-14, "{face_mesh:?}");
            }

            // Creases are the lines, and nothing else is.
            let length = |[a, b]: [u32; 2]| points[a as usize].distance(points[b as usize]);
            let edges = (0..).zip(mesh.edges());
            let along: f64 =
                edges.filter(|(edge, _)| mesh.is_crease(EdgeId(*edge))).map(|(_, ends)| length(ends)).sum();
            let ends = tessellation.edges().ends;
            let lines = ends.iter().map(|ends| ends.map(|end| tessellation.vertices()[end.index()]));
            let lines: f64 = lines.map(|[start, end]| start.distance(end)).sum();
            assert!((along - lines).abs() < 1e-12 * lines, "{face_mesh:?}: {along}, not {lines}");
        }
    }
}

#[test]
fn no_edge_is_longer_than_asked_for() {
    for tessellation in tessellations() {
        for edge_length in [0.4, EDGE_LENGTH, 0.05] {
            let (network, points) = network(&tessellation, FaceMesh::Refined { edge_length }, 0);
            for corners in elements(network.control_mesh()) {
                for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                    let length = points[*a].distance(points[*b]);
                    assert!(length <= edge_length * (1.0 + 1e-12), "{length}, not {edge_length}");
                }
            }
        }
    }
}

#[test]
fn sizes_are_foretold() {
    for tessellation in tessellations() {
        for face_mesh in MESHES {
            let (network, points) = network(&tessellation, face_mesh, 0);
            let size = face_mesh.control_mesh_size(&tessellation);
            let elements = network.control_mesh().element_count() as u128;
            let foretold = if size.triangles == 0 { size.edges } else { size.triangles };
            match face_mesh {
                FaceMesh::Refined { .. } if size.triangles > 0 => {
                    assert!((elements / 2..3 * elements).contains(&foretold), "{foretold}, {elements}");
                }
                _ => assert_eq!((foretold, size.points), (elements, points.len() as u128), "{face_mesh:?}"),
            }
        }
    }
}

#[test]
fn finer_control_meshes_relax_with_the_volumes_kept() {
    let seeds = random_seeds(&Domain::unit_cube(), 20, 7);
    let tessellation = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
    let (network, flat) = network(&tessellation, FaceMesh::Refined { edge_length: 0.15 }, 1);
    let points = relaxed(&network, &flat);
    let validation = validate(&network, &points).expect("valid");
    assert!(validation.largest_volume_error < 1e-9);
}

#[test]
fn an_edge_length_that_is_none_is_refused() {
    let tessellation = Tessellation::new(&Domain::unit_cube(), &[DVec3::splat(0.5)]).expect("a seed");
    for edge_length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let result =
            Network::with_face_mesh(&tessellation, FaceMesh::Refined { edge_length }, Junctions::Crease, 0);
        assert!(matches!(result, Err(NetworkError::BadEdgeLength(_))));
    }
    // A cube of 1e9 edges a side would need more points than ids.
    let result =
        Network::with_face_mesh(&tessellation, FaceMesh::Refined { edge_length: 1e-9 }, Junctions::Crease, 0);
    assert!(matches!(result, Err(NetworkError::TooLarge { .. })));
}
