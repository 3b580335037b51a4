//! What the certificate finds: each kind of damage to a good network, by name and place, and nothing in a good one.

use crate::common::{random_network, relaxed};
use glam::DVec3;
use polycrystal::{
    BoundaryId, Certificate, Elements, Expected, Fault, GrainId, Level, Mesh, NodeType, Place, Side, Surface,
    certify,
};
use voronoi::Domain;

/// A surface that owns its parts, to be damaged.
#[derive(Clone)]
struct Parts {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    boundary_of: Vec<BoundaryId>,
    sides: Vec<[Side; 2]>,
    node_types: Vec<Option<NodeType>>,
}

impl Parts {
    fn good() -> Self {
        let (network, flat) = random_network(&Domain::unit_cube(), 12, 7, 1);
        let points = relaxed(&network, &flat);
        let Level { mesh: Mesh::Triangles(mesh), boundary_of, node_types, .. } = network.finest().held()
        else {
            panic!("a network in space")
        };
        Self {
            points,
            triangles: mesh.triangles().to_vec(),
            boundary_of: boundary_of.clone(),
            sides: network.sides(),
            node_types: node_types.iter().copied().map(Some).collect(),
        }
    }

    fn surface(&self) -> Surface<'_> {
        let Self { points, triangles, boundary_of, sides, .. } = self;
        Surface { points, elements: Elements::Triangles(triangles), boundary_of, sides }
    }

    fn certify(&self) -> Certificate {
        let expected =
            Expected { node_types: Some(&self.node_types), domain_volume: Some(1.0), ..Expected::default() };
        certify(&self.surface(), &expected)
    }

    fn faults(&self) -> Vec<Fault> {
        self.certify().faults.0
    }

    /// A triangle between two grains with no corner where boundaries meet, and a point inside its boundary.
    fn inner_triangle(&self) -> (usize, u32) {
        let is_inner = |corner: &u32| self.node_types[*corner as usize] == Some(NodeType::INTERIOR);
        let found = self.triangles.iter().position(|triangle| triangle.iter().all(is_inner));
        let triangle = found.expect("a triangle inside a boundary");
        (triangle, self.triangles[triangle][0])
    }
}

#[test]
fn good_networks_are_certified() {
    let certificate = Parts::good().certify();
    assert!(certificate.is_good(), "{}", certificate.faults);
    assert_eq!(certificate.grain_volumes.len(), 12);
    assert!(certificate.total_volume_error < 1e-12);
    assert!((certificate.angles.expect("triple lines").mean - 120.0).abs() < 0.1);
}

#[test]
fn a_removed_triangle_is_found() {
    let mut parts = Parts::good();
    let (hole, _) = parts.inner_triangle();
    let [a, b, c] = parts.triangles.remove(hole);
    let sides = parts.sides[parts.boundary_of.remove(hole).index()];
    let grains: Vec<GrainId> = sides.iter().filter_map(|side| side.grain()).collect();
    let mut edges = [[a, b], [b, c], [c, a]].map(|[a, b]| Place::Edge([a.min(b), a.max(b)]));
    edges.sort_unstable();
    let mut faults = parts.faults();
    faults.sort_by_key(|fault| format!("{fault:?}"));
    let mut expected = edges.map(|place| Fault::Open { place, grains: grains.clone() });
    expected.sort_by_key(|fault| format!("{fault:?}"));
    assert_eq!(faults, expected);
}

#[test]
fn a_flipped_triangle_is_found() {
    let mut parts = Parts::good();
    for triangle in [parts.inner_triangle().0, 0] {
        parts = Parts::good();
        parts.triangles[triangle].reverse();
        let element = u32::try_from(triangle).expect("a small network");
        assert_eq!(parts.faults(), [Fault::Turned { element }]);
    }
}

#[test]
fn a_moved_point_is_found() {
    let mut parts = Parts::good();
    let (_, point) = parts.inner_triangle();
    // To the opposite end of the domain, through whatever lies between.
    let place = parts.points[point as usize];
    parts.points[point as usize] = DVec3::ONE - place;
    let faults = parts.faults();
    let touches = |elements: &[u32; 2]| {
        elements.iter().any(|element| parts.triangles[*element as usize].contains(&point))
    };
    assert!(faults.len() > 10, "{faults:?}");
    for fault in &faults {
        match fault {
            Fault::Crossing { elements, .. } | Fault::Folded { elements, .. } => assert!(touches(elements)),
            other => panic!("{other}"),
        }
    }
}

/// Files keep points in single precision, but volumes in double.
#[test]
fn rounding_that_is_stated_is_no_fault_but_a_moved_point_is() {
    let good = Parts::good();
    let volumes = good.certify().grain_volumes;
    let rounded = Parts {
        points: good.points.iter().map(|point| point.as_vec3().as_dvec3()).collect(),
        ..good.clone()
    };
    let faults = |parts: &Parts, rounding: f64| {
        let expected = Expected {
            grain_volumes: Some(&volumes),
            domain_volume: Some(1.0),
            rounding,
            ..Expected::default()
        };
        certify(&parts.surface(), &expected).faults.0
    };
    let rounding = 0.5 * f64::from(f32::EPSILON);
    assert_eq!(faults(&rounded, rounding), []);
    let unexpected = faults(&rounded, 0.0);
    assert!(unexpected.iter().any(|fault| matches!(fault, Fault::WrongVolume { .. })), "{unexpected:?}");
    let mut moved = rounded;
    let (_, point) = moved.inner_triangle();
    moved.points[point as usize] += 1e-3;
    let found = faults(&moved, rounding);
    assert!(found.iter().any(|fault| matches!(fault, Fault::WrongVolume { .. })), "{found:?}");
}

#[test]
fn a_point_off_its_wall_is_found() {
    let mut parts = Parts::good();
    let at = parts.node_types.iter().position(|node_type| *node_type == Some(NodeType::OUTER));
    parts.points[at.expect("a point on a wall")] *= 1.001;
    let faults = parts.faults();
    assert!(matches!(faults[..], [Fault::WrongTotal { .. }]), "{faults:?}");
}

#[test]
fn swapped_labels_are_found() {
    let mut parts = Parts::good();
    let (triangle, _) = parts.inner_triangle();
    let stated = [Side::Grain(GrainId(0)), Side::Grain(GrainId(11))];
    let fitting = parts.sides[parts.boundary_of[triangle].index()];
    assert_ne!(stated, fitting);
    parts.boundary_of[triangle] = BoundaryId(u32::try_from(parts.sides.len()).expect("few boundaries"));
    parts.sides.push(stated);
    let element = u32::try_from(triangle).expect("a small network");
    let faults = parts.faults();
    assert!(faults.contains(&Fault::WrongSides { element, stated, fitting }), "{faults:?}");
    let others = faults.iter().filter(|fault| !matches!(fault, Fault::WrongSides { .. }));
    // The corners of the triangle seem to be in touch with more grains than they are.
    assert_eq!(others.filter(|fault| matches!(fault, Fault::WrongNodeType { .. })).count(), 3);

    parts.sides.pop();
    parts.sides.push([fitting[1], fitting[0]]);
    assert_eq!(parts.faults(), [Fault::Turned { element }]);
}

#[test]
fn a_wrong_number_of_grains_is_found() {
    let parts = Parts::good();
    let (network, _) = random_network(&Domain::unit_cube(), 12, 7, 1);
    let mut grain_counts = network.finest().held().grain_counts.clone();
    let faults = |grain_counts: &[u8]| {
        certify(&parts.surface(), &Expected { grain_counts: Some(grain_counts), ..Expected::default() })
            .faults
            .0
    };
    assert_eq!(faults(&grain_counts), []);
    let (_, point) = parts.inner_triangle();
    grain_counts[point as usize] = 5;
    assert_eq!(faults(&grain_counts), [Fault::WrongGrainCount { point, stated: 5, derived: 2 }]);
}

#[test]
fn a_duplicated_point_is_found() {
    let mut parts = Parts::good();
    let (triangle, point) = parts.inner_triangle();
    let copy = u32::try_from(parts.points.len()).expect("a small network");
    parts.points.push(parts.points[point as usize]);
    parts.node_types.push(None);
    let unused = parts.clone();
    assert_eq!(
        unused.faults(),
        [Fault::DuplicatePoints { points: [point, copy] }, Fault::Orphan { point: copy }]
    );

    let corner = parts.triangles[triangle].iter_mut().find(|corner| **corner == point);
    *corner.expect("the triangle has the point") = copy;
    let faults = parts.faults();
    assert_eq!(faults[0], Fault::DuplicatePoints { points: [point, copy] });
    assert!(faults.iter().any(|fault| matches!(fault, Fault::Open { .. })));
}

#[test]
fn a_triangle_twice_is_found() {
    let mut parts = Parts::good();
    let (triangle, _) = parts.inner_triangle();
    let elements = [triangle, parts.triangles.len()].map(|id| u32::try_from(id).expect("a small network"));
    parts.triangles.push(parts.triangles[triangle]);
    parts.boundary_of.push(parts.boundary_of[triangle]);
    let faults = parts.faults();
    assert_eq!(faults.iter().filter(|fault| **fault == Fault::DuplicateElements { elements }).count(), 1);
}

/// Octahedra with these middles and radii, and the sides of the surface of each.
fn octahedra(parts: &[(DVec3, f64, [Side; 2])]) -> Parts {
    let ends = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let faces = (0..4u32).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]);
    let numbered = || (0u32..).take(parts.len());
    Parts {
        points: parts
            .iter()
            .flat_map(|(middle, radius, _)| ends.map(|end| *middle + end * *radius))
            .collect(),
        triangles: numbered()
            .flat_map(|part| faces.clone().map(move |face| face.map(|corner| corner + 6 * part)))
            .collect(),
        boundary_of: numbered().flat_map(|part| [BoundaryId(part); 8]).collect(),
        sides: parts.iter().map(|(.., sides)| *sides).collect(),
        node_types: Vec::new(),
    }
}

/// Two closed balls of one grain each that overlap: nothing but crossings is wrong.
#[test]
fn crossing_is_found_where_each_grain_is_good() {
    let sides = [0, 1].map(|grain| [Side::Grain(GrainId(grain)), Side::Exterior]);
    let mut parts = octahedra(&[(DVec3::ZERO, 1.0, sides[0]), (DVec3::new(0.9, 0.1, 0.2), 1.0, sides[1])]);
    let certificate = certify(&parts.surface(), &Expected::default());
    assert!(certificate.faults.0.len() > 4, "{}", certificate.faults);
    assert!(certificate.faults.0.iter().all(|fault| matches!(fault, Fault::Crossing { .. })));
    // Each grain has the volume 4/3, and the planes through the second grain's corner decide.
    assert!(certificate.grain_volumes.iter().all(|(_, volume)| (volume - 4.0 / 3.0).abs() < 1e-15));

    for point in &mut parts.points[6..] {
        *point += DVec3::X * 1.2;
    }
    assert!(certify(&parts.surface(), &Expected::default()).is_good());
}

/// A grain within a grain within a grain, and one apart: wherever they are, no volume tells.
#[test]
fn a_grain_outside_the_one_around_it_is_found() {
    let grain = |grain: u32| Side::Grain(GrainId(grain));
    let outer = (DVec3::ZERO, 1.0, [grain(0), Side::Exterior]);
    let apart = (DVec3::X * 3.0, 1.0, [grain(3), Side::Exterior]);
    let faults = |parts: &[(DVec3, f64, [Side; 2])]| {
        certify(&octahedra(parts).surface(), &Expected::default()).faults.0
    };
    let nested = |middles: [DVec3; 2]| {
        let inner = [(middles[0], 0.2, [grain(1), grain(0)]), (middles[1], 0.1, [grain(2), grain(1)])];
        faults(&[outer, inner[0], inner[1], apart])
    };
    let misplaced = |piece: u32, around: Side| Fault::Misplaced { point: 6 * piece, around };
    let here = DVec3::new(0.1, -0.2, 0.1);
    assert_eq!(nested([DVec3::ZERO; 2]), []);
    assert_eq!(nested([here; 2]), []);
    // Outside of all, on either side, within the wrong grain, and together.
    for elsewhere in [DVec3::Y * 2.0, DVec3::NEG_X * 2.0, DVec3::X * 3.0] {
        assert_eq!(nested([elsewhere; 2]), [misplaced(1, grain(0))], "{elsewhere}");
        assert_eq!(nested([here, elsewhere]), [misplaced(2, grain(1))], "{elsewhere}");
    }
    assert_eq!(nested([here, here + DVec3::Z * 0.4]), [misplaced(2, grain(1))]);
    // A grain apart that stands within one that has no room for it.
    let swallowed = faults(&[outer, (here, 0.2, [grain(1), Side::Exterior])]);
    assert_eq!(swallowed, [misplaced(1, Side::Exterior)]);
}

/// Four triangles of two grains at one edge, as voxels that touch along an edge have.
#[test]
fn a_grain_that_touches_itself_is_found() {
    let (network, flat) = {
        let seeds = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]];
        crate::common::network(&Domain::unit_cube(), &seeds.map(|[x, y]| DVec3::new(x, y, 0.5)), 0)
    };
    // Diagonal neighbours become one grain each.
    let sides: Vec<[Side; 2]> = network
        .sides()
        .iter()
        .map(|sides| {
            sides.map(|side| match side {
                Side::Grain(GrainId(id)) => Side::Grain(GrainId([0, 1, 1, 0][id as usize])),
                Side::Exterior => side,
            })
        })
        .collect();
    let surface = Surface { sides: &sides, ..Surface::of_level(network.finest(), &flat, &sides) };
    let certificate = certify(&surface, &Expected::default());
    let pinched =
        certificate.faults.0.iter().filter(|fault| matches!(fault, Fault::Pinched { elements: 4, .. }));
    // Two edges, two grains.
    assert_eq!((pinched.count(), certificate.faults.0.len()), (4, 4), "{}", certificate.faults);
}

/// Tetrahedra with one corner in common, and all of these within a larger one.
fn pinches_of_touching_tetrahedra(grains: [u32; 2]) -> Vec<Fault> {
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let points = [
        DVec3::ZERO,
        corner(1.0, 0.0, 0.0),
        corner(1.0, 1.0, 0.0),
        corner(1.0, 0.0, 1.0),
        corner(-1.0, 0.0, 0.0),
        corner(-1.0, 1.0, 0.0),
        corner(-1.0, 0.0, 1.0),
        corner(-9.0, -9.0, -9.0),
        corner(29.0, -9.0, -9.0),
        corner(-9.0, 29.0, -9.0),
        corner(-9.0, -9.0, 29.0),
    ];
    let faces = |[a, b, c, d]: [u32; 4]| [[a, c, b], [a, b, d], [b, c, d], [a, d, c]];
    // The second is the first's mirror image.
    let triangles = [faces([0, 1, 2, 3]), faces([0, 5, 4, 6]), faces([7, 8, 9, 10])].concat();
    let boundary_of: Vec<BoundaryId> = (0u32..12).map(|triangle| BoundaryId(triangle / 4)).collect();
    let around = Side::Grain(GrainId(7));
    let sides = [
        [Side::Grain(GrainId(grains[0])), around],
        [Side::Grain(GrainId(grains[1])), around],
        [around, Side::Exterior],
    ];
    let elements = Elements::Triangles(&triangles);
    let surface = Surface { points: &points, elements, boundary_of: &boundary_of, sides: &sides };
    let faults = certify(&surface, &Expected::default()).faults.0;
    // The edges of the tetrahedra are folds within their boundaries.
    faults.into_iter().filter(|fault| fault.kind() != "folded").collect()
}

#[test]
fn grains_that_touch_in_one_point_only_are_found() {
    // Of two grains each is closed, but that around them is pinched.
    let pinched = |grain: u32| Fault::PinchedPoint { point: 0, grain: GrainId(grain), fans: 2 };
    assert_eq!(pinches_of_touching_tetrahedra([0, 1]), [pinched(7)]);
    assert_eq!(pinches_of_touching_tetrahedra([3, 3]), [pinched(3), pinched(7)]);
}

#[test]
fn points_of_many_grains_are_no_pinches() {
    let centre = |i: u32| (f64::from(i) + 0.5) / 3.0;
    let seeds: Vec<DVec3> =
        (0..27).map(|i| DVec3::new(centre(i % 3), centre(i / 3 % 3), centre(i / 9))).collect();
    let (network, flat) = crate::common::network(&Domain::unit_cube(), &seeds, 1);
    let points = network.subdivide(&flat);
    let sides = network.sides();
    let certificate = certify(&Surface::of_level(network.finest(), &points, &sides), &Expected::default());
    assert!(certificate.is_good(), "{}", certificate.faults);
}

#[test]
fn lines_in_the_plane_are_certified() {
    let (network, flat) = random_network(&Domain::unit_square(), 20, 3, 2);
    let mut points = relaxed(&network, &flat);
    points.iter_mut().for_each(|point| point.z = 0.0);
    let sides = network.sides();
    let expected = Expected { domain_volume: Some(1.0), ..Expected::default() };
    let certificate = certify(&Surface::of_level(network.finest(), &points, &sides), &expected);
    assert!(certificate.is_good(), "{}", certificate.faults);

    let inner =
        network.finest().held().node_types.iter().position(|node_type| *node_type == NodeType::INTERIOR);
    points[inner.expect("a line between grains")] += DVec3::new(0.6, 0.2, 0.0);
    let certificate = certify(&Surface::of_level(network.finest(), &points, &sides), &expected);
    assert!(certificate.faults.0.iter().any(|fault| matches!(fault, Fault::Crossing { .. })));
}
