//! Random grains, flat and relaxed.

use glam::DVec3;
use polycrystal::{FaceMesh, Junctions, Network, Relaxation, regular_cells, relax};
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
    relax(network, flat, &Relaxation::default(), |_, _| ()).expect("relaxes").finest_points(network)
}
