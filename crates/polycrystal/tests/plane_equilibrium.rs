//! Relaxation to equilibrium in the plane, with the changes of topology that it takes.

#[allow(dead_code, reason = "every test file uses its own share")]
mod common;

use common::random_seeds;
use glam::{BVec3, DVec3};
use polycrystal::{Boundary, Equilibrium, Junctions, NetworkError, NetworkRecipe, equilibrate};
use voronoi::{Domain, Tessellation};

fn balanced(domain: &Domain, seeds: &[DVec3], levels: usize) -> Result<Equilibrium, NetworkError> {
    let tessellation = Tessellation::new(domain, seeds).expect("valid seeds");
    let tension = |boundary: &Boundary| if boundary.wall.is_some() { 0.0 } else { 1.0 };
    let recipe = NetworkRecipe { junctions: Junctions::Crease, levels, tension: &tension };
    equilibrate(&tessellation, &recipe, |_| ())
}

fn flat_seeds(domain: &Domain, count: usize, random_seed: u64) -> Vec<DVec3> {
    random_seeds(domain, count, random_seed).into_iter().map(|seed| seed.with_z(0.0)).collect()
}

#[test]
fn scan() {
    for periods in [BVec3::new(true, true, false), BVec3::new(true, false, false), BVec3::FALSE] {
        let domain = Domain::unit_square().with_periods(periods);
        for count in [1, 2, 3, 4, 5, 7, 10, 20, 40, 100] {
            for seed in 0..20 {
                if let Err(error) = balanced(&domain, &flat_seeds(&domain, count, seed), 2) {
                    let said = error.to_string();
                    println!("{periods} {count} {seed} {}", said.chars().take(300).collect::<String>());
                }
            }
        }
    }
}
