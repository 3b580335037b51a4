//! What several test files need: random seeds, and the check that a tessellation is a cell complex.

use std::collections::HashMap;

use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use voronoi::{Dimension, Domain, Side, Tessellation, VertexId};

/// Uniform random seeds in the unit cube.
pub fn random_seeds(count: usize, random_seed: u64) -> Vec<DVec3> {
    let mut generator = ChaCha8Rng::seed_from_u64(random_seed);
    let mut fraction = || (generator.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    (0..count).map(|_| DVec3::new(fraction(), fraction(), fraction())).collect()
}

/// Volumes sum to the domain, only cells without faces are empty, the Euler number is that of a box, and each cell is a
/// closed polyhedron.
pub fn assert_complex(tessellation: &Tessellation) {
    let measures = tessellation.cell_measures();
    let volumes: Vec<f64> = measures.iter().map(|cell| cell.volume).collect();
    assert!(measures.iter().all(|cell| (cell.volume > 0.0) == (cell.face_count > 0)), "{volumes:?}");
    let cell_count = tessellation.cell_count() - tessellation.empty_cells().len();
    let (sum, whole) = (volumes.iter().sum::<f64>(), tessellation.domain().measure());
    assert!((sum - whole).abs() <= 1e-12 * whole, "volumes sum to {sum}, not {whole}");
    if tessellation.domain().dimension() == Dimension::Two {
        let (vertices, edges) = (tessellation.vertices().len(), tessellation.face_count());
        assert_eq!(vertices + cell_count, edges + 1, "Euler number in the plane");
        return;
    }
    let edge_count = tessellation.edges().ends.len();
    let even = tessellation.vertices().len() + tessellation.face_count();
    assert_eq!(even, edge_count + cell_count + 1, "Euler number of a box");
    let mut walks: HashMap<(Side, VertexId, VertexId), i32> = HashMap::new();
    for face in tessellation.faces() {
        let corners = tessellation.face_corners(face);
        for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let [first, second] = tessellation.face_sides(face);
            *walks.entry((first, from, to)).or_default() += 1;
            *walks.entry((second, to, from)).or_default() += 1;
        }
    }
    for ((side, from, to), count) in &walks {
        if matches!(side, Side::Cell(_)) {
            assert_eq!(*count, 1, "an edge of a cell is walked once each way");
            assert!(walks.contains_key(&(*side, *to, *from)), "{side:?} is open at {from:?}-{to:?}");
        }
    }
}

pub fn tessellate(seeds: &[DVec3]) -> Tessellation {
    Tessellation::new(&Domain::unit_cube(), seeds).expect("valid seeds")
}
