//! Cells divided by a second tessellation each.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use glam::{BVec3, DVec3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use voronoi::volumes::{DividedCells, Division, PowerDiagram, divide_cells, place_spheres};
use voronoi::{CellId, Domain, Side};

/// Packed cells of a domain, some twice as large as others.
fn cells(domain: &Domain, count: usize) -> PowerDiagram {
    let sizes: Vec<f64> = (0..count).map(|cell| if cell % 3 == 0 { 2.0 } else { 1.0 }).collect();
    let factor = domain.measure() / sizes.iter().sum::<f64>();
    let volumes: Vec<f64> = sizes.iter().map(|size| size * factor).collect();
    let seeds = place_spheres(domain, &volumes, fractions(1)).unwrap();
    PowerDiagram::with_volumes(domain, &seeds, &volumes).and_then(|diagram| diagram.lloyd(5)).unwrap()
}

fn fractions(seed: u64) -> impl FnMut() -> f64 {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    move || (generator.next_u64() >> 11) as f64 / 2f64.powi(53)
}

/// Points a width apart on both sides of each cell's centroid, along a normal of its own.
fn lamellae(diagram: &PowerDiagram, normals: &[DVec3], width: f64) -> Vec<Option<Division>> {
    let measures = diagram.tessellation().cell_measures();
    let division = |(cell, normal): (&voronoi::CellMeasure, &DVec3)| {
        let points = (-20..=20).map(|place| cell.centroid + *normal * (width * f64::from(place)));
        Some(Division { points: points.collect(), weights: vec![0.0; 41] })
    };
    measures.iter().zip(normals).map(division).collect()
}

fn divided(diagram: &PowerDiagram, divisions: &[Option<Division>]) -> DividedCells {
    divide_cells(diagram.tessellation(), diagram.weights(), divisions).unwrap()
}

/// The volumes of a diagram's cells, and of what they are parts of.
fn check_volumes(before: &PowerDiagram, after: &DividedCells) {
    let parts = after.diagram.tessellation().cell_measures();
    let mut sums = vec![0.0; before.volumes().len()];
    for (part, cell) in parts.iter().zip(&after.cell_of) {
        assert!(part.volume > 0.0);
        sums[cell.index()] += part.volume;
    }
    for (sum, volume) in sums.iter().zip(before.volumes()) {
        assert!((sum / volume - 1.0).abs() < 1e-10, "{sum} {volume}");
    }
}

/// Lamellae of parallel walls a width apart, and cells whose faces hardly move.
fn check_lamellae(domain: &Domain) {
    let is_plane = domain.dimension() == voronoi::Dimension::Two;
    let diagram = cells(domain, 24);
    let mut fraction = fractions(2);
    let mut normal = || {
        let z = if is_plane { 0.0 } else { fraction() - 0.5 };
        DVec3::new(fraction() - 0.5, fraction() - 0.5, z).normalize()
    };
    let normals: Vec<DVec3> = (0..24).map(|_| normal()).collect();
    let width = 0.25 * (domain.measure() / 24.0).powf(if is_plane { 0.5 } else { 1.0 / 3.0 });
    let after = divided(&diagram, &lamellae(&diagram, &normals, width));
    check_volumes(&diagram, &after);
    let tessellation = after.diagram.tessellation();
    assert!(tessellation.cell_count() > 48, "{}", tessellation.cell_count());
    let cell = |part: CellId| after.cell_of[part.index()];
    for face in tessellation.faces() {
        let [Side::Cell(first), Side::Cell(second)] = tessellation.face_sides(face) else { continue };
        if cell(first) != cell(second) {
            continue;
        }
        let normal = normals[cell(first).index()];
        let heights = tessellation.face_corners(face).iter();
        let heights: Vec<f64> =
            heights.map(|corner| normal.dot(tessellation.vertices()[corner.index()])).collect();
        let spread = heights.iter().map(|height| (height - heights[0]).abs()).fold(0.0, f64::max);
        assert!(spread < 1e-11, "{spread:e}");
        let steps = after.point_of[second.index()].abs_diff(after.point_of[first.index()]);
        assert_eq!(steps, 1, "neighbours");
    }
    let before = diagram.tessellation().cell_measures();
    let mut sums = vec![DVec3::ZERO; 24];
    for (part, cell) in tessellation.cell_measures().iter().zip(&after.cell_of) {
        let whole = &before[cell.index()];
        let way = (part.centroid - whole.centroid) / domain.size().max(DVec3::splat(1e-300));
        let image = way.round() * domain.size();
        sums[cell.index()] += part.volume / whole.volume * (part.centroid - image - whole.centroid);
    }
    for sum in sums {
        assert!(sum.length() < 0.01 * width, "{sum}");
    }
}

#[test]
fn lamellae_are_parallel_and_keep_their_cells_volumes() {
    check_lamellae(&Domain::unit_cube());
    check_lamellae(&Domain::unit_cube().with_periods(BVec3::TRUE));
    check_lamellae(&Domain::ball(DVec3::splat(3.0), 1.0, 0.01).unwrap());
    check_lamellae(&Domain::unit_square());
    check_lamellae(&Domain::unit_square().with_periods(BVec3::TRUE));
}

#[test]
fn parts_of_given_volumes_have_them() {
    for periodic in [BVec3::FALSE, BVec3::TRUE] {
        let domain = Domain::unit_cube().with_periods(periodic);
        let diagram = cells(&domain, 12);
        let mut wanted = Vec::new();
        let divisions = (0u32..12).map(|cell| {
            if cell % 2 == 1 {
                wanted.push(diagram.volumes()[cell as usize]);
                return None;
            }
            let inside = diagram.tessellation().cell_domain(CellId(cell)).unwrap();
            let volumes: Vec<f64> = (1..=10).map(|part| inside.measure() * f64::from(part) / 55.0).collect();
            let seeds = place_spheres(&inside, &volumes, fractions(u64::from(cell))).unwrap();
            let parts = PowerDiagram::with_volumes(&inside, &seeds, &volumes).unwrap();
            wanted.extend(&volumes);
            Some(Division { points: seeds, weights: parts.weights().to_vec() })
        });
        let divisions: Vec<_> = divisions.collect();
        let after = divided(&diagram, &divisions);
        check_volumes(&diagram, &after);
        let parts = after.diagram.tessellation().cell_measures();
        assert_eq!(parts.len(), wanted.len());
        for (part, wanted) in parts.iter().zip(&wanted) {
            assert!((part.volume / wanted - 1.0).abs() < 1e-9, "{} {wanted}", part.volume);
        }
    }
}

/// A tip of a cell that a wall cuts off would be a grain of a hundredth of the others' volume.
#[test]
fn what_is_too_small_goes_to_its_neighbour() {
    let domain = Domain::unit_cube();
    let diagram = PowerDiagram::with_volumes(&domain, &[DVec3::splat(0.5)], &[1.0]).unwrap();
    // Walls at right angles to the diagonal, at 0.05 of it from the corner and in the middle.
    let diagonal = DVec3::ONE;
    let points = vec![diagonal * 0.0, diagonal * 0.1, diagonal * 0.9];
    let division = Division { points, weights: vec![0.0; 3] };
    let after = divided(&diagram, &[Some(division)]);
    assert_eq!(after.point_of, [1, 2]);
    let volumes = after.diagram.tessellation().cell_measures();
    volumes.iter().for_each(|part| assert!((part.volume - 0.5).abs() < 1e-10));
}

#[test]
fn a_seed_on_a_wall_is_no_obstacle() {
    let domain = Domain::unit_cube();
    let seeds = [DVec3::new(0.0, 0.5, 0.5), DVec3::ONE];
    let diagram = PowerDiagram::with_volumes(&domain, &seeds, &[0.6, 0.4]).unwrap();
    let normals = [DVec3::X, DVec3::new(1.0, 2.0, -3.0).normalize()];
    let after = divided(&diagram, &lamellae(&diagram, &normals, 0.1));
    check_volumes(&diagram, &after);
    assert!(after.cell_of.len() > 8);
}
