use voronoi::{Domain, Tessellation};

use super::descent::{LARGEST_COTANGENT, LEAST_COTANGENT};
use super::*;

/// Lines that are too short elsewhere are no reason against an event here.
#[test]
fn only_edges_of_vertices_that_move_count_as_short() {
    let seeds = [
        (0.2, 0.3, 0.1),
        (0.7, 0.2, 0.4),
        (0.4, 0.8, 0.3),
        (0.9, 0.9, 0.8),
        (0.1, 0.6, 0.9),
        (0.5, 0.5, 0.6),
    ]
    .map(|(x, y, z)| DVec3::new(x, y, z));
    let cells = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds");
    let complex = CellComplex::from(&cells);
    let volumes: Vec<f64> = cells.cell_measures().iter().map(|cell| cell.volume).collect();
    let pressures = vec![0.0; volumes.len()];
    let shape = Shape::default();
    let conditions =
        Conditions { shape: &shape, tension: &|_| 1.0, volumes: &volumes, pressures: &pressures };
    let edges = complex.edges();
    for vertex in 0..u32::try_from(complex.vertices.len()).expect("few vertices") {
        let area = LocalArea::new(&complex, &[vertex], &conditions, &vec![0.0; volumes.len()]);
        let own = edges.iter().filter(|edge| edge.start == vertex || edge.end.vertex == vertex);
        let lengths =
            own.map(|edge| complex.vertices[edge.start as usize].distance(complex.position(edge.end)));
        assert_eq!(area.shortest_edge(), lengths.fold(f64::INFINITY, f64::min));
    }
}

/// Four cells of a periodic cube, most of which are their own neighbours; some vertices are a little off.
fn check_moved(mut check: impl FnMut(&LocalArea, &[DVec3])) {
    let seeds = [(0.2, 0.3, 0.1), (0.7, 0.2, 0.4), (0.4, 0.8, 0.3), (0.9, 0.9, 0.8)]
        .map(|(x, y, z)| DVec3::new(x, y, z));
    let domain = Domain::unit_cube().with_periods(glam::BVec3::TRUE);
    let cells = Tessellation::new(&domain, &seeds).expect("valid seeds");
    let complex = CellComplex::from(&cells);
    let volumes: Vec<f64> = cells.cell_measures().iter().map(|cell| cell.volume).collect();
    let shape = Shape::default();
    let pressures = [0.5, -1.0, 2.0, 0.7];
    let conditions =
        Conditions { shape: &shape, tension: &|_| 1.0, volumes: &volumes, pressures: &pressures };
    for edge in complex.edges() {
        let area = LocalArea::new(&complex, &[edge.start, edge.end.vertex], &conditions, &[0.0; 4]);
        let moved: Vec<DVec3> =
            area.points.iter().map(|point| *point + 0.02 * DVec3::new(point.z, -0.6, point.x)).collect();
        check(&area, &moved);
    }
}

/// Its energy is negative there: the search would end where it began.
#[test]
fn the_search_goes_down_where_cells_lack_volume_under_high_pressure() {
    let mut searched = 0;
    check_moved(|area, _| {
        let mut pressed = area.clone();
        for cell in &mut pressed.cells {
            cell.pressure *= 1e3;
            cell.volume -= 0.02 * cell.pressure.signum();
        }
        let (before, _) = pressed.area(&pressed.rings());
        let after = pressed.minimize(f64::NEG_INFINITY);
        assert!(after.is_finite() && after < before - 1e-3, "{before} {after}");
        searched += usize::from(before < 0.0);
    });
    assert!(searched > 10, "{searched}");
}

#[test]
fn what_one_cell_loses_others_gain() {
    check_moved(|area, moved| {
        let mut rings = SmallVec::new();
        area.place_rings(moved, &mut rings);
        let volumes = area.volumes(&rings);
        let gains = || area.cells.iter().zip(&volumes).map(|(cell, volume)| volume - cell.volume);
        assert!(gains().sum::<f64>().abs() < 1e-15);
        assert!(gains().map(f64::abs).fold(0.0, f64::max) > 1e-4);
    });
}

/// The energy of stiffness with the same constants, point by point.
#[test]
fn the_stiffness_is_that_of_springs_along_the_edges_of_fans() {
    check_moved(|area, _| {
        let rings = area.rings();
        let stiffness = area.stiffness(&rings);
        let count = area.points.len();
        let moves: Vec<f64> = (0..count).map(|i| 0.3 + 0.7 * i as f64).collect();
        let of_matrix: f64 = (0..count * count)
            .map(|entry| stiffness[entry] * moves[entry / count] * moves[entry % count])
            .sum();
        let mut of_springs = 0.0;
        for (face, Fan { ring, center }) in area.fans(&rings) {
            let by = |corner: usize| match face.corners[corner] {
                Place::Moving(moving, _) => moves[moving],
                Place::Fixed(_) => 0.0,
            };
            let of_center = (0..ring.len()).map(by).sum::<f64>() / ring.len() as f64;
            for k in 0..ring.len() {
                let next = (k + 1) % ring.len();
                let triangle = [(ring[k], by(k)), (ring[next], by(next)), (center, of_center)];
                for opposite in 0..3 {
                    let [apex, from, to] = [0, 1, 2].map(|turn| triangle[(opposite + turn) % 3]);
                    let (a, b) = (from.0 - apex.0, to.0 - apex.0);
                    let cotangent =
                        (a.dot(b) / a.cross(b).length()).clamp(LEAST_COTANGENT, LARGEST_COTANGENT);
                    of_springs += 0.5 * face.tension * cotangent * (from.1 - to.1).powi(2);
                }
            }
        }
        assert!((of_matrix - of_springs).abs() < 1e-12 * of_springs, "{of_matrix} {of_springs}");
    });
}

#[test]
fn slopes_are_those_of_the_area() {
    const STEP: f64 = 1e-6;
    check_moved(|area, moved| {
        let area_at = |points: &[DVec3]| {
            let mut rings = SmallVec::new();
            area.place_rings(points, &mut rings);
            area.area(&rings)
        };
        let (_, slope) = area_at(moved);
        for (point, axis) in (0..moved.len()).flat_map(|point| DVec3::AXES.map(|axis| (point, axis))) {
            let at = |step: f64| {
                let mut moved = moved.to_vec();
                moved[point] += axis * step;
                area_at(&moved).0
            };
            let difference = (at(STEP) - at(-STEP)) / (2.0 * STEP);
            assert!(
                (slope[point].dot(axis) - difference).abs() < 1e-6,
                "{} {difference}",
                slope[point].dot(axis)
            );
        }
    });
}
