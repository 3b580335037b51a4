//! Cells of any seeds: grid-snapped, random, near-duplicate, weighted, in the plane and in space, periodic along any axes. What is
//! accepted is a cell complex that fills its domain.
#![no_main]

#[path = "../../crates/voronoi/tests/common/mod.rs"]
mod common;

use glam::{BVec3, DVec3};
use libfuzzer_sys::arbitrary::{self, Arbitrary};
use libfuzzer_sys::fuzz_target;
use voronoi::{Domain, Tessellation, VoronoiError};

/// Seeds at most: more only take longer.
const SEEDS: usize = 40;

#[derive(Arbitrary, Debug)]
struct Input {
    is_flat: bool,
    periodic: [bool; 3],
    /// Binary logarithms of the sides, around 1.
    sides: [i8; 3],
    seeds: Vec<Seed>,
    /// Sixteenths of the mean spacing; without any, the cells are plain.
    radii: Vec<u8>,
}

#[derive(Arbitrary, Debug)]
enum Seed {
    /// A corner of a grid of so many steps along each axis.
    OnGrid { steps: u8, place: [u8; 3] },
    Anywhere([u32; 3]),
    /// An earlier seed moved by so many steps of 2^-exponent.
    Near { other: u8, steps: [i8; 3], exponent: u8 },
}

impl Input {
    fn domain(&self) -> Domain {
        let upper = DVec3::from_array(self.sides.map(|side| f64::from(side % 4).exp2()));
        let domain = if self.is_flat {
            Domain::rectangle(DVec3::ZERO, upper)
        } else {
            Domain::cuboid(DVec3::ZERO, upper)
        };
        domain.expect("sides are positive").with_periods(BVec3::from_array(self.periodic))
    }

    /// Seeds in the domain, each place once.
    fn seeds(&self, domain: &Domain) -> Vec<DVec3> {
        let mut shares: Vec<DVec3> = Vec::new();
        for seed in self.seeds.iter().take(SEEDS) {
            let share = match seed {
                Seed::OnGrid { steps, place } => {
                    let steps = steps % 12 + 1;
                    DVec3::from_array(place.map(|step| f64::from(step % (steps + 1)) / f64::from(steps)))
                }
                Seed::Anywhere(numbers) => {
                    DVec3::from_array(numbers.map(|number| f64::from(number) / f64::from(u32::MAX)))
                }
                Seed::Near { other, steps, exponent } => match shares.get(usize::from(*other) % shares.len().max(1)) {
                    Some(other) => {
                        let step = (-f64::from(exponent % 52)).exp2();
                        (*other + step * DVec3::from_array(steps.map(f64::from))).clamp(DVec3::ZERO, DVec3::ONE)
                    }
                    None => DVec3::splat(0.5),
                },
            };
            shares.push(share);
        }
        shares.iter().map(|share| *share * domain.size()).collect()
    }
}

fuzz_target!(|input: Input| {
    let domain = input.domain();
    let mut seeds = input.seeds(&domain);
    let result = loop {
        let spacing = domain.size().max_element() / 3.0;
        let weights: Vec<f64> = (0..seeds.len())
            .map(|seed| {
                let radius = input.radii.get(seed % input.radii.len().max(1)).map_or(0, |radius| radius % 32);
                (f64::from(radius) / 16.0 * spacing).powi(2)
            })
            .collect();
        let result = if input.radii.is_empty() {
            Tessellation::new(&domain, &seeds)
        } else {
            Tessellation::power(&domain, &seeds, &weights)
        };
        match result {
            Err(VoronoiError::DuplicateSeeds { second, .. }) => drop(seeds.remove(second)),
            result => break result,
        }
    };
    match result {
        Ok(tessellation) => common::assert_complex(&tessellation),
        Err(error) => assert!(seeds.is_empty() && error == VoronoiError::NoSeeds, "{error}"),
    }
});
