//! Networks of grains that several cells make up.

use std::collections::HashMap;

use crate::common::random_seeds;
use glam::{BVec3, DVec3};
use polycrystal::{
    BoundaryId, FaceMesh, GrainId, GrainPart, Junctions, Mesh, Network, NetworkError, Relaxation,
    measure_network, relax, remove_short_edges, validate,
};
use subzero::VertexRule;
use voronoi::{Dimension, Domain, Side, Tessellation, Translation};

fn domains() -> [Domain; 5] {
    let square = Domain::unit_square();
    [
        Domain::unit_cube(),
        Domain::unit_cube().with_periods(BVec3::TRUE),
        Domain::unit_cube().with_periods(BVec3::new(true, false, false)),
        square.clone(),
        square.with_periods(BVec3::TRUE),
    ]
}

fn of_grains(
    tessellation: &Tessellation,
    grains: &[GrainId],
    levels: usize,
) -> Result<(Network, Vec<DVec3>), NetworkError> {
    let parts: Vec<GrainPart> = grains.iter().copied().map(GrainPart::from).collect();
    Network::of_grains(tessellation, &parts, FaceMesh::Fan, Junctions::Crease, 0.0, levels)
}

/// Cells join their neighbours, the nearest seeds first, as long as both are alone.
fn pairs(tessellation: &Tessellation) -> Vec<GrainId> {
    let mut neighbors = Vec::new();
    for face in tessellation.faces() {
        if let [Side::Cell(a), Side::Cell(b)] = tessellation.face_sides(face) {
            let [a, b] = [a.index(), b.index()];
            neighbors.push((tessellation.seeds()[a].distance(tessellation.seeds()[b]), a, b));
        }
    }
    neighbors.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut partner = vec![None; tessellation.cell_count()];
    for (_, a, b) in neighbors {
        if partner[a].is_none() && partner[b].is_none() {
            partner[a] = Some(b);
            partner[b] = Some(a);
        }
    }
    let mut grains: Vec<GrainId> = Vec::new();
    let mut next = (0u32..).map(GrainId);
    for (cell, partner) in partner.into_iter().enumerate() {
        let joined = partner.filter(|partner| *partner < cell).map(|partner| grains[partner]);
        grains.push(joined.unwrap_or_else(|| next.next().expect("endless")));
    }
    grains
}

#[test]
fn grains_of_one_cell_each_have_the_network_of_the_cells() {
    for domain in domains() {
        let tessellation = Tessellation::new(&domain, &random_seeds(&domain, 30, 5)).expect("valid seeds");
        let grains: Vec<GrainId> = (0..30).map(GrainId).collect();
        let (network, points) = of_grains(&tessellation, &grains, 2).expect("a network");
        let (of_cells, flat) = Network::new(&tessellation, Junctions::Crease, 2).expect("a network");
        if !domain.is_periodic() {
            assert_eq!(points, flat, "{domain}");
            assert_eq!(network, of_cells, "{domain}");
        }
        // Copies may be numbered otherwise.
        assert_eq!(elements(&network, &points), elements(&of_cells, &flat), "{domain}");
        assert_eq!(network.junction_counts(), of_cells.junction_counts(), "{domain}");
    }
}

/// What lies beside each element of the control mesh and where its corners are, in units of 1e-12, in order.
fn elements(network: &Network, points: &[DVec3]) -> Vec<([polycrystal::Side; 2], Vec<[i64; 3]>)> {
    let level = network.control_mesh();
    let corners: Vec<Vec<u32>> = match &level.mesh {
        Mesh::Triangles(mesh) => mesh.triangles().iter().map(|corners| corners.to_vec()).collect(),
        Mesh::Segments(mesh) => mesh.segments().iter().map(|corners| corners.to_vec()).collect(),
    };
    let place = |corner: &u32| (1e12 * points[*corner as usize]).round().as_i64vec3().to_array();
    let element = |(corners, boundary): (&Vec<u32>, &BoundaryId)| {
        let mut places: Vec<[i64; 3]> = corners.iter().map(place).collect();
        places.sort_unstable();
        (network.boundaries()[boundary.index()].sides, places)
    };
    let mut elements: Vec<_> = corners.iter().zip(&level.boundary_of).map(element).collect();
    elements.sort_unstable();
    elements
}

#[test]
fn grains_of_two_cells_are_as_large_as_these() {
    for domain in domains() {
        let tessellation = Tessellation::new(&domain, &random_seeds(&domain, 40, 1)).expect("valid seeds");
        let grains = pairs(&tessellation);
        let (network, flat) = of_grains(&tessellation, &grains, 0).expect("a network");
        assert!(network.grain_count() < 30, "{domain}");
        let volumes = network.grain_volumes(network.control_mesh(), &flat);
        for (grain, volume) in network.cell_volumes().iter().zip(volumes) {
            assert!((grain / volume - 1.0).abs() < 1e-12, "{domain}");
        }
    }
}

#[test]
fn grains_of_two_cells_relax_to_valid_networks() {
    for domain in domains() {
        let tessellation = Tessellation::new(&domain, &random_seeds(&domain, 40, 1)).expect("valid seeds");
        let (regular, _) = remove_short_edges(&tessellation, 0.2);
        let grains = pairs(&regular);
        let (network, flat) = of_grains(&regular, &grains, 2).expect("a network");
        let mut volumes = vec![0.0; network.grain_count()];
        for (grain, cell) in grains.iter().zip(tessellation.cell_measures()) {
            volumes[grain.index()] += cell.volume;
        }
        let network = network.with_cell_volumes(volumes);
        let relaxed = relax(&network, &flat, &Relaxation::KEPT_TOPOLOGY, |_, _| ());
        let relaxed = relaxed.unwrap_or_else(|error| panic!("{domain}: {error}"));
        let validation = validate(&network, &relaxed.finest_points(&network));
        let validation = validation.unwrap_or_else(|error| panic!("{domain}: {error}"));
        assert!(validation.largest_volume_error < 1e-9, "{domain}");
    }
}

/// Such a triangle goes flat when its line is smooth: grains of 3:3:1 had triangles of 0.1 degrees. There were 31 of them; those stay whose edge may not
/// flip.
#[test]
fn few_triangles_of_many_cells_are_between_two_edges_of_one_line() {
    let domain = Domain::unit_cube();
    let centers = random_seeds(&domain, 12, 2);
    let tessellation = Tessellation::new(&domain, &random_seeds(&domain, 1000, 1)).expect("valid seeds");
    let nearest = |seed: &DVec3| {
        let distances = centers.iter().map(|center| (center.distance(*seed), center));
        let nearest = distances.min_by(|one, other| one.0.total_cmp(&other.0)).expect("some").1;
        centers.iter().position(|center| center == nearest).expect("one of them")
    };
    let number = |seed| GrainId(u32::try_from(nearest(seed)).expect("few"));
    let parts: Vec<GrainPart> =
        tessellation.seeds().iter().map(|seed| GrainPart::from(number(seed))).collect();
    let (network, _) = Network::of_grains(&tessellation, &parts, FaceMesh::Fan, Junctions::Crease, 0.3, 0)
        .expect("a network");
    let control = network.control_mesh();
    let Mesh::Triangles(mesh) = &control.mesh else { unreachable!("three dimensions") };
    let mut at_points: HashMap<(u32, BoundaryId), usize> = HashMap::new();
    for (corners, boundary) in mesh.triangles().iter().zip(&control.boundary_of) {
        corners.iter().for_each(|corner| *at_points.entry((*corner, *boundary)).or_default() += 1);
    }
    let on_line = |point: u32| mesh.vertex_rule(point) == VertexRule::Crease;
    let alone = at_points.iter().filter(|((point, _), count)| on_line(*point) && **count == 1).count();
    assert!(alone <= 14, "{alone}");
}

/// One boundary without a line. On the walls the host's pieces are thin: subdivision folded them where they lie, and relaxation gave up.
#[test]
fn a_grain_within_a_host_of_several_cells_becomes_round() {
    for domain in domains() {
        let is_plane = domain.dimension() == Dimension::Two;
        let mut seeds = vec![DVec3::splat(0.5)];
        for (axis, step) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, -0.27), (axis, 0.3)]) {
            let mut seed = DVec3::splat(0.5);
            seed[axis] += step;
            seeds.push(seed);
        }
        if is_plane {
            seeds.truncate(5);
            seeds.iter_mut().for_each(|seed| seed.z = 0.0);
        }
        let tessellation = Tessellation::new(&domain, &seeds).expect("valid seeds");
        let grains: Vec<GrainId> = (0..seeds.len()).map(|cell| GrainId(u32::from(cell == 0))).collect();
        let (network, flat) = of_grains(&tessellation, &grains, 2).expect("a network");
        let relaxed = relax(&network, &flat, &Relaxation::KEPT_TOPOLOGY, |_, _| ()).expect("relaxes");
        let points = relaxed.finest_points(&network);
        validate(&network, &points).expect("valid");
        let inner = network.sides().iter().filter(|sides| sides.iter().all(|s| s.grain().is_some())).count();
        assert_eq!(inner, 1, "one boundary around the grain within");
        if let Some(space) = measure_network(&network, &points).in_space() {
            let grain = &space.grains[1];
            let sphericity = (36.0 * std::f64::consts::PI).cbrt() * grain.volume.powf(2.0 / 3.0) / grain.area;
            assert!(sphericity > 0.98, "{domain}: {sphericity}");
        }
    }
}

#[test]
fn grains_in_pieces_and_numbers_left_out_are_refused() {
    let domain = Domain::unit_cube();
    let seeds = [0.2, 0.5, 0.8].map(|x| DVec3::new(x, 0.5, 0.5));
    let tessellation = Tessellation::new(&domain, &seeds).expect("valid seeds");
    let error = of_grains(&tessellation, &[0, 1, 0].map(GrainId), 0).expect_err("two pieces");
    assert_eq!(
        error.to_string(),
        "the cells of grain 0 are not connected by faces; number its pieces separately"
    );
    let error = of_grains(&tessellation, &[0, 2, 2].map(GrainId), 0).expect_err("no grain 1");
    assert!(matches!(error, NetworkError::MissingGrain { grain: GrainId(1) }), "{error}");
    let periodic = Tessellation::new(&domain.with_periods(BVec3::TRUE), &seeds).expect("valid seeds");
    let error = of_grains(&periodic, &[0, 1, 0].map(GrainId), 0).expect_err("they touch a period away");
    assert!(matches!(error, NetworkError::GrainInPieces { grain: GrainId(0) }), "{error}");
    let moved = |moved| GrainPart { grain: GrainId(0), moved };
    let parts = [moved(Translation::ZERO), GrainId(1).into(), moved(Translation([-1, 0, 0]))];
    let (network, flat) =
        Network::of_grains(&periodic, &parts, FaceMesh::Fan, Junctions::Crease, 0.0, 0).expect("two grains");
    let volumes = network.grain_volumes(network.control_mesh(), &flat);
    assert!((volumes[0] - 0.7).abs() < 1e-12, "{volumes:?}");
    let [least, most] = [f64::min, f64::max].map(|end| flat.iter().map(|point| point.x).reduce(end));
    assert!((least.expect("points") + 0.35).abs() < 1e-12, "the grain stands about the box's lower side");
    assert!((most.expect("points") - 0.65).abs() < 1e-12);
}
