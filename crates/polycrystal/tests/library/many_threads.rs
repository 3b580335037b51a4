//! Many grains on several threads.

use crate::common::random_seeds;
use polycrystal::{FaceMesh, Junctions, NetworkRecipe, Relaxation, RelaxedCells, relax_cells};
use voronoi::{Domain, Tessellation};

/// So many that threads look at places ahead, each on its own copy of the cells.
#[test]
fn many_grains_switch_neighbors_alike_with_any_number_of_threads() {
    let domain = Domain::unit_cube();
    let tessellation = Tessellation::new(&domain, &random_seeds(&domain, 1700, 6)).expect("valid seeds");
    let recipe = NetworkRecipe {
        face_mesh: FaceMesh::Fan,
        junctions: Junctions::Crease,
        levels: 0,
        tension: &|boundary| if boundary.wall.is_some() { 0.0 } else { 1.0 },
    };
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
        let relaxed = pool.install(|| relax_cells(&tessellation, &recipe, &Relaxation::Time(0.45), |_| ()));
        let RelaxedCells { relaxed, reconnections, .. } = relaxed.expect("relaxes");
        (relaxed.points, reconnections)
    };
    let alone = with_threads(1);
    assert!(alone.1.count() > 1000);
    assert_eq!(alone, with_threads(2));
}
