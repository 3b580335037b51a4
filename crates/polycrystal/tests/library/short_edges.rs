//! Short-edge removal: every cell stays a closed ball, the box stays full, and what is short goes.

use std::collections::HashSet;

use crate::complexes::{assert_changed_complex, assert_closed, complex_counts, random_seeds, tessellate};
use glam::{BVec3, DVec3};
use polycrystal::{Collapsed, remove_edges_that_shorten, remove_short_edges};
use proptest::prelude::*;
use voronoi::{CellId, CellMeasure, Domain, Side, Tessellation, VertexId};

/// A complex all of whose cells are balls: their surfaces are spheres, and around each of their vertices the faces form
/// one ring.
fn assert_balls(tessellation: &Tessellation) {
    // The two copies of a face that is not plane are measured from different corners, so volumes need not sum up exactly.
    assert_closed(tessellation);
    for cell in (0u32..).take(tessellation.cell_count()).map(CellId) {
        let faces: Vec<&[VertexId]> =
            tessellation.cell_faces(cell).iter().map(|face| tessellation.face_corners(*face)).collect();
        let edges_of = |face: &&[VertexId]| -> Vec<[VertexId; 2]> {
            let after = face.iter().cycle().skip(1);
            face.iter().zip(after).map(|(a, b)| [*a.min(b), *a.max(b)]).collect()
        };
        let vertices: HashSet<VertexId> = faces.iter().flat_map(|face| face.iter().copied()).collect();
        let edges: HashSet<[VertexId; 2]> = faces.iter().flat_map(edges_of).collect();
        assert_eq!(vertices.len() + faces.len(), edges.len() + 2, "{cell:?} is no sphere");
        for vertex in vertices {
            let around: Vec<Vec<[VertexId; 2]>> = faces
                .iter()
                .filter(|face| face.contains(&vertex))
                .map(|face| edges_of(face).into_iter().filter(|edge| edge.contains(&vertex)).collect())
                .collect();
            assert!(around.iter().all(|edges| edges.len() == 2), "{cell:?} has a pinched face at {vertex:?}");
            let mut reached = vec![0];
            let mut next = 0;
            while next < reached.len() {
                let from = &around[reached[next]];
                let touching = (0..around.len()).filter(|at| around[*at].iter().any(|e| from.contains(e)));
                let new: Vec<usize> = touching.filter(|at| !reached.contains(at)).collect();
                reached.extend(new);
                next += 1;
            }
            assert_eq!(reached.len(), around.len(), "{cell:?} is pinched at {vertex:?}");
        }
    }
}

/// Edges in the plane are faces, with two corners.
fn shortest_edge(tessellation: &Tessellation) -> f64 {
    let at = |vertex: VertexId| tessellation.vertices()[vertex.index()];
    let ring = |face| {
        let corners = tessellation.face_corners(face);
        corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| at(*a).distance(at(*b)))
    };
    tessellation.faces().flat_map(ring).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_jittered_lattice_becomes_the_lattice() {
    let jitter = random_seeds(64, 5);
    for size in [0.0, 1e-9, 1e-6] {
        let seeds: Vec<DVec3> = (0..64)
            .map(|i| DVec3::new(f64::from(i % 4), f64::from(i / 4 % 4), f64::from(i / 16)) + 0.5)
            .zip(&jitter)
            .map(|(place, jitter)| (place + (*jitter - 0.5) * size) / 4.0)
            .collect();
        let (regular, _) = remove_short_edges(&tessellate(&seeds), 0.1);
        assert_balls(&regular);
        let counts = complex_counts(&regular);
        assert_eq!((counts.vertices, counts.edges, counts.faces), (125, 300, 240), "jitter {size}");
        for vertex in regular.vertices() {
            assert!((*vertex * 4.0).distance((*vertex * 4.0).round()) <= if size > 0.0 { 0.1 } else { 0.0 });
        }
    }
}

#[test]
fn a_jittered_lattice_in_the_plane_becomes_the_lattice() {
    let jitter = random_seeds(16, 5);
    let seeds: Vec<DVec3> = (0..16)
        .map(|i| DVec3::new(f64::from(i % 4) + 0.5, f64::from(i / 4) + 0.5, 0.0))
        .zip(&jitter)
        .map(|(place, jitter)| ((place + (*jitter - 0.5) * 1e-7) / 4.0).with_z(0.0))
        .collect();
    let cells = Tessellation::new(&Domain::unit_square(), &seeds).expect("seeds");
    let (regular, _) = remove_short_edges(&cells, 0.1);
    assert_changed_complex(&regular);
    assert_eq!((regular.vertices().len(), regular.face_count()), (25, 40));
}

#[test]
fn most_short_edges_go_and_what_has_gone_is_counted() {
    let cells = tessellate(&random_seeds(200, 3));
    let (regular, collapsed) = remove_short_edges(&cells, 0.1);
    assert_balls(&regular);
    assert_eq!(cells.vertices().len() - regular.vertices().len(), collapsed.edges);
    assert_eq!(cells.face_count() - regular.face_count(), collapsed.faces);
    // A quarter of a grain's edges are shorter than a tenth of its size or so.
    assert!((150..350).contains(&collapsed.edges), "{collapsed:?}");
    assert!(shortest_edge(&regular) > 100.0 * shortest_edge(&cells));
}

#[test]
fn length_zero_changes_nothing() {
    let cells = tessellate(&random_seeds(50, 3));
    assert_eq!(remove_short_edges(&cells, 0.0).0, cells);
    let cells = periodic(&random_seeds(50, 3), BVec3::TRUE);
    assert_eq!(remove_short_edges(&cells, 0.0).0, cells);
}

/// What is summed while cells are cut, and what the finished complex gives.
#[test]
fn measures_follow_from_the_complex() {
    let seeds = random_seeds(500, 4);
    let mixed = BVec3::new(true, false, true);
    let weights: Vec<f64> = (0..500).map(|k| 1e-3 * f64::from(k % 7)).collect();
    let power = Tessellation::power(&Domain::unit_cube(), &seeds, &weights).expect("seeds are good");
    for cells in [tessellate(&seeds), periodic(&seeds, BVec3::TRUE), periodic(&seeds[..20], mixed), power] {
        let rebuilt = remove_short_edges(&cells, 0.0).0.cell_measures();
        for (k, (kept, rebuilt)) in cells.cell_measures().iter().zip(rebuilt).enumerate() {
            let counts = |cell: &CellMeasure| [cell.face_count, cell.vertex_count, cell.edge_count];
            assert_eq!(counts(kept), counts(&rebuilt), "cell {k}");
            let size = rebuilt.volume.max(1e-6).cbrt();
            assert!((kept.volume - rebuilt.volume).abs() <= 1e-13 * size.powi(3), "cell {k}");
            assert!((kept.area - rebuilt.area).abs() <= 1e-13 * size.powi(2), "cell {k}");
            assert!(kept.centroid.distance(rebuilt.centroid) <= 1e-12 * size, "cell {k}");
        }
    }
}

fn periodic(seeds: &[DVec3], axes: BVec3) -> Tessellation {
    Tessellation::new(&Domain::unit_cube().with_periods(axes), seeds).expect("seeds")
}

/// On the torus as many edges go as in a box without its walls.
#[test]
fn most_short_edges_of_periodic_cells_go() {
    let cells = periodic(&random_seeds(200, 3), BVec3::TRUE);
    let (regular, collapsed) = remove_short_edges(&cells, 0.1);
    assert_balls(&regular);
    let [before, after] = [&cells, &regular].map(complex_counts);
    assert_eq!(before.vertices - after.vertices, collapsed.edges);
    assert_eq!(before.faces - after.faces, collapsed.faces);
    assert!((150..350).contains(&collapsed.edges), "{collapsed:?}");
    assert!(shortest_edge(&regular) > 100.0 * shortest_edge(&cells));
}

/// The same seeds, moved by a third of the period, make the same complex, but for choices between bends, which go by number.
#[test]
fn where_the_periodic_box_begins_does_not_matter() {
    let seeds = random_seeds(100, 8);
    let moved: Vec<DVec3> = seeds.iter().map(|seed| (*seed + DVec3::new(0.3, 0.6, 0.9)).fract()).collect();
    let [here, there] = [seeds, moved].map(|seeds| remove_short_edges(&periodic(&seeds, BVec3::TRUE), 0.15));
    assert!(here.1.edges.abs_diff(there.1.edges) <= 2, "{:?} and {:?}", here.1, there.1);
    let shape = |cells: &Tessellation, cell: CellId| {
        let faces = cells.cell_faces(cell).iter();
        let mut corners: Vec<usize> = faces.map(|face| cells.face_corners(*face).len()).collect();
        corners.sort_unstable();
        corners
    };
    let is_same = |cell: &CellId| shape(&here.0, *cell) == shape(&there.0, *cell);
    assert!((0..100).map(CellId).filter(is_same).count() >= 90);
}

/// What is short is told by the future places alone.
#[test]
fn edges_collapse_where_they_will_be_short() {
    let cells = tessellate(&random_seeds(60, 2));
    let scaled = |factor: f64| cells.vertices().iter().map(|v| *v * factor).collect::<Vec<_>>();
    assert_eq!(remove_edges_that_shorten(&cells, 0.1, &scaled(1e3)).1, Collapsed::default());
    let (half, as_half) =
        (remove_short_edges(&cells, 0.2), remove_edges_that_shorten(&cells, 0.1, &scaled(0.5)));
    assert_eq!(half.0.vertices().len(), as_half.0.vertices().len());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn cells_stay_balls_and_walls_stay_flat(
        random_seed in 0u64..1_000_000,
        count in 1usize..80,
        length in 0.0..0.6f64,
        height in 0.05..3.0f64,
    ) {
        let domain = Domain::cuboid(DVec3::ZERO, DVec3::new(1.0, 1.0, height)).expect("a box");
        let seeds: Vec<DVec3> = random_seeds(count, random_seed).iter().map(|s| *s * domain.size()).collect();
        let cells = Tessellation::new(&domain, &seeds).expect("seeds");
        let (regular, _) = remove_short_edges(&cells, length);
        assert_balls(&regular);
        for face in regular.faces() {
            if let Side::Wall(wall) = regular.face_sides(face)[1] {
                for corner in regular.face_corners(face) {
                    let corner = regular.vertices()[corner.index()];
                    prop_assert_eq!(corner[wall.axis()], domain.wall_coordinate(wall));
                }
            }
        }
    }

    #[test]
    fn periodic_cells_stay_balls(
        random_seed in 0u64..1_000_000,
        count in 1usize..60,
        length in 0.0..0.6f64,
        axes in any::<[bool; 3]>(),
    ) {
        let cells = periodic(&random_seeds(count, random_seed), BVec3::from(axes));
        let (regular, _) = remove_short_edges(&cells, length);
        assert_balls(&regular);
    }

    #[test]
    fn periodic_cells_in_the_plane_stay_closed(
        random_seed in 0u64..1_000_000,
        count in 1usize..60,
        length in 0.0..0.6f64,
    ) {
        let seeds: Vec<DVec3> = random_seeds(count, random_seed).iter().map(|seed| seed.with_z(0.0)).collect();
        let domain = Domain::unit_square().with_periods(BVec3::TRUE);
        let cells = Tessellation::new(&domain, &seeds).expect("seeds");
        assert_closed(&remove_short_edges(&cells, length).0);
    }

    #[test]
    fn cells_in_the_plane_stay_closed(random_seed in 0u64..1_000_000, count in 1usize..80, length in 0.0..0.6f64) {
        let seeds: Vec<DVec3> = random_seeds(count, random_seed).iter().map(|seed| seed.with_z(0.0)).collect();
        let cells = Tessellation::new(&Domain::unit_square(), &seeds).expect("seeds");
        assert_changed_complex(&remove_short_edges(&cells, length).0);
    }
}
