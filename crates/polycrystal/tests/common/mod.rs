//! Random grains, flat and relaxed; a ball; networks of given triangles.

use glam::DVec3;
use polycrystal::{
    BoundaryId, Elements, FaceMesh, GrainId, Junctions, Network, NetworkError, Relaxation, Side, Surface,
    regular_cells, relax,
};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use voronoi::{Domain, Tessellation};

/// Uniform random seeds in the domain.
pub fn random_seeds(domain: &Domain, count: usize, random_seed: u64) -> Vec<DVec3> {
    let mut generator = ChaCha8Rng::seed_from_u64(random_seed);
    let mut fraction = || (generator.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    let mut point = || DVec3::new(fraction(), fraction(), fraction());
    (0..count).map(|_| domain.lower() + point() * domain.size()).collect()
}

/// A network and its flat control points.
pub fn network(domain: &Domain, seeds: &[DVec3], levels: usize) -> (Network, Vec<DVec3>) {
    let tessellation = Tessellation::new(domain, seeds).expect("valid seeds");
    Network::new(&tessellation, Junctions::Crease, levels).expect("a small network")
}

pub fn random_network(
    domain: &Domain,
    count: usize,
    random_seed: u64,
    levels: usize,
) -> (Network, Vec<DVec3>) {
    network(domain, &random_seeds(domain, count, random_seed), levels)
}

/// The network of 200 or so random grains whose short edges have collapsed, as the program makes it.
pub fn regular_network(
    domain: &Domain,
    count: usize,
    random_seed: u64,
    levels: usize,
) -> (Network, Vec<DVec3>) {
    let tessellation =
        Tessellation::new(domain, &random_seeds(domain, count, random_seed)).expect("valid seeds");
    let regular = regular_cells(&tessellation, 0.15).expect("a small network");
    network_of_regular(&regular.cells, &tessellation, levels)
}

/// The network of regularised cells, whose grains are to have the volumes of the cells as they were.
pub fn network_of_regular(
    regular: &Tessellation,
    original: &Tessellation,
    levels: usize,
) -> (Network, Vec<DVec3>) {
    let volumes = original.cell_measures().iter().map(|cell| cell.volume).collect();
    let (network, flat) = Network::with_face_mesh(regular, FaceMesh::SparseFan, Junctions::Crease, levels)
        .expect("a small network");
    (network.with_cell_volumes(volumes), flat)
}

/// The points of the finest level after relaxation of the default time.
pub fn relaxed(network: &Network, flat: &[DVec3]) -> Vec<DVec3> {
    relax(network, flat, &Relaxation::KEPT_TOPOLOGY, |_, _| ()).expect("relaxes").finest_points(network)
}

/// An icosahedron whose triangles are cut into four so often, pushed out to a sphere.
pub fn ball(radius: f64, center: DVec3, levels: usize) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut points: Vec<DVec3> = Vec::new();
    for [a, b] in [[1.0, golden], [1.0, -golden], [-1.0, golden], [-1.0, -golden]] {
        points.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)]);
    }
    let mut triangles = Vec::new();
    for a in 0..12u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let corners = [a, b, c].map(|id| points[id as usize]);
                let is_edge = |i: usize, j: usize| (corners[i].distance(corners[j]) - 2.0).abs() < 1e-9;
                if is_edge(0, 1) && is_edge(1, 2) && is_edge(2, 0) {
                    let outward =
                        (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[0]) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    assert_eq!(triangles.len(), 20);
    for _ in 0..levels {
        let mesh = subzero::TriangleMesh::new(points.len(), triangles, &subzero::Features::default());
        let refined = mesh.expect("a sphere").midpoint_refine().expect("few triangles");
        points = refined.stencils.apply(&points);
        triangles = refined.mesh.triangles().to_vec();
    }
    (points.iter().map(|point| center + radius * point.normalize()).collect(), triangles)
}

/// Points, triangles with the boundary of each, and sides.
pub struct Labelled {
    pub points: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    pub boundary_of: Vec<BoundaryId>,
    pub sides: Vec<[Side; 2]>,
}

impl Labelled {
    pub fn network(&self, levels: usize) -> Result<(Network, Vec<DVec3>), NetworkError> {
        let Self { points, triangles, boundary_of, sides } = self;
        let surface = Surface { points, elements: Elements::Triangles(triangles), boundary_of, sides };
        Network::of_surface(&Domain::unit_cube(), &surface, Junctions::Crease, levels)
    }

    /// A body, wound outward, as grain 1 within grain 0, which fills the rest of the unit cube.
    pub fn inclusion(points: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let (cube, mut all) = cube();
        let outer = all.len();
        let mut all_points = cube;
        let first = u32::try_from(all_points.len()).expect("few points");
        all.extend(triangles.iter().map(|corners| corners.map(|corner| first + corner)));
        all_points.extend(points);
        let boundary_of = (0..all.len()).map(|triangle| BoundaryId(u32::from(triangle >= outer))).collect();
        let [outer, inner] = [0, 1].map(|grain| Side::Grain(GrainId(grain)));
        // The body's triangles wind from it outward, to grain 0.
        Self {
            points: all_points,
            triangles: all,
            boundary_of,
            sides: vec![[outer, Side::Exterior], [inner, outer]],
        }
    }
}

/// The unit cube, wound outward.
pub fn cube() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let corners = (0..8u32).map(|k| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)));
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    (corners.collect(), triangles.collect())
}
