//! Lloyd's algorithm: seeds that move to the centroids of their cells.

use crate::common::{assert_power_complex, random_seeds};
use glam::{BVec3, DVec3};
use voronoi::{CellId, Dimension, Domain, Side, Tessellation};

/// The sum over all cells of the integral of `|x - s|^2 - w`, from the second moments of simplices.
fn energy(tessellation: &Tessellation, weights: &[f64]) -> f64 {
    let measures = tessellation.cell_measures();
    let mut energy: f64 =
        -measures.iter().zip(weights).map(|(cell, weight)| cell.volume * weight).sum::<f64>();
    for face in tessellation.faces() {
        let corners = tessellation.face_corners(face);
        for (side, outward) in tessellation.face_sides(face).into_iter().zip([1.0, -1.0]) {
            let Side::Cell(CellId(cell)) = side else { continue };
            let seed = tessellation.seeds()[cell as usize];
            let at = |k: usize| tessellation.vertices()[corners[k].index()] - seed;
            energy += outward
                * match tessellation.domain().dimension() {
                    Dimension::Two => {
                        let (a, b) = (at(0), at(1));
                        let area = 0.5 * a.truncate().perp_dot(b.truncate());
                        area / 6.0 * (a.dot(a) + b.dot(b) + a.dot(b))
                    }
                    Dimension::Three => (1..corners.len() - 1)
                        .map(|k| {
                            let (a, b, c) = (at(0), at(k), at(k + 1));
                            let volume = a.dot(b.cross(c)) / 6.0;
                            volume / 10.0 * (a.dot(a) + b.dot(b) + c.dot(c) + a.dot(b) + b.dot(c) + c.dot(a))
                        })
                        .sum(),
                };
        }
    }
    energy
}

#[test]
fn every_step_lowers_the_energy() {
    let mut weights: Vec<f64> = random_seeds(60, 2).iter().map(|point| 0.01 * point.x).collect();
    // Seed 0 is outweighed by all: it has no cell at first, and stays where it is.
    weights[0] = -0.2;
    let half_periodic = Domain::unit_cube().with_periods(BVec3::new(true, false, true));
    for domain in [Domain::unit_cube(), half_periodic, Domain::unit_square()] {
        let start = random_seeds(60, 1);
        let flat = domain.dimension() == Dimension::Two;
        let mut seeds: Vec<DVec3> =
            start.into_iter().map(|seed| if flat { seed.with_z(0.0) } else { seed }).collect();
        let first = seeds[0];
        let mut energies = Vec::new();
        for _ in 0..30 {
            let tessellation = Tessellation::power(&domain, &seeds, &weights).expect("valid seeds");
            assert_power_complex(&tessellation, &weights);
            energies.push(energy(&tessellation, &weights));
            seeds = tessellation.lloyd_step();
        }
        assert_eq!(seeds[0], first);
        assert!(energies.windows(2).all(|pair| pair[1] < pair[0]), "{energies:?}");
    }
}

/// On a line the centroids' fixed point are equal cells.
#[test]
fn seeds_on_a_line_end_equally_spaced() {
    let mut seeds: Vec<DVec3> = [0.05, 0.1, 0.7, 0.75].map(|x| DVec3::new(x, 0.5, 0.5)).to_vec();
    for _ in 0..300 {
        seeds = Tessellation::new(&Domain::unit_cube(), &seeds).expect("valid seeds").lloyd_step();
    }
    for (seed, x) in seeds.iter().zip([0.125, 0.375, 0.625, 0.875]) {
        // Steps shorter than half of the grid's 2^-40 are none.
        assert!(seed.distance(DVec3::new(x, 0.5, 0.5)) < 4e-12, "{seed}");
    }
}

/// Columns through a periodic box, six of which meet in a point. Centroids that are off by a last place tilted them, and tore such
/// points into edges of 1e-12.
#[test]
fn columns_stay_upright() {
    let domain = Domain::unit_cube().with_periods(BVec3::TRUE);
    let mut seeds: Vec<DVec3> = random_seeds(40, 3).into_iter().map(|seed| seed.with_z(0.121_05)).collect();
    for _ in 0..10 {
        let cells = Tessellation::new(&domain, &seeds).expect("valid seeds");
        assert!(cells.cell_measures().iter().all(|cell| cell.vertex_count == 2 * (cell.face_count - 2)));
        seeds = cells.lloyd_step();
        assert!(seeds.iter().all(|seed| seed.z == seeds[0].z));
    }
}
