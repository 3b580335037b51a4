//! Drawing orientations for volumes.

use rand_core::Rng;
use thiserror::Error;

use crate::{Apportionment, Component, Orientation, Texture};

/// Orientations that were drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// One for each volume.
    pub orientations: Vec<Orientation>,
    /// Index of the component that each comes from.
    pub components: Vec<usize>,
}

/// A volume that nothing can be drawn for.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("volume {volume} of item {index} is not positive and finite")]
pub struct DrawError {
    /// Which it is, from 0.
    pub index: usize,
    /// The volume.
    pub volume: f64,
}

/// Independent numbers that an orientation takes: four of its component, one of its variant in the sample.
const NUMBERS: usize = 5;

impl Texture {
    /// Draws an orientation for each volume, such that the distribution *by volume* is as near to the texture as can be.
    ///
    /// Volumes go, the largest first, to the component that lacks most; equal ones in random order. Within a component each of the
    /// independent numbers behind an orientation is stratified by volume: every volume takes, in random order, an interval as
    /// long as its share (a Latin hypercube), and a random place in it.
    ///
    /// The same texture, volumes and generator give the same orientations.
    ///
    /// # Errors
    /// When a volume is not positive and finite.
    pub fn draw(&self, volumes: &[f64], generator: &mut impl Rng) -> Result<Drawn, DrawError> {
        let bad = volumes.iter().position(|volume| !(*volume > 0.0 && volume.is_finite()));
        if let Some(index) = bad {
            return Err(DrawError { index, volume: volumes[index] });
        }
        let components = self.assign(volumes, generator);
        let mut orientations = vec![Orientation::IDENTITY; volumes.len()];
        for (number, (component, ..)) in self.components().enumerate() {
            let members: Vec<usize> =
                (0..volumes.len()).filter(|index| components[*index] == number).collect();
            self.draw_component(component, &members, volumes, generator, &mut orientations);
        }
        Ok(Drawn { orientations, components })
    }

    /// The component of each volume.
    fn assign(&self, volumes: &[f64], generator: &mut impl Rng) -> Vec<usize> {
        let shares: Vec<f64> = self.components().map(|(_, share, _)| share).collect();
        let count = shares.len();
        let mut parts = Apportionment::new(shares, volumes.iter().sum());
        let mut order: Vec<usize> = (0..volumes.len()).collect();
        // Equal volumes may stand in the order of a lattice, which a texture must not copy.
        shuffle(&mut order, generator);
        order.sort_by(|a, b| volumes[*b].total_cmp(&volumes[*a]));
        let mut components = vec![0; volumes.len()];
        for index in order {
            components[index] = parts.give(volumes[index], 0..count).unwrap_or(0);
        }
        components
    }

    fn draw_component(
        &self,
        component: &Component,
        members: &[usize],
        volumes: &[f64],
        generator: &mut impl Rng,
        orientations: &mut [Orientation],
    ) {
        let total: f64 = members.iter().map(|index| volumes[*index]).sum();
        let mut numbers = vec![[0.0; NUMBERS]; members.len()];
        for axis in 0..NUMBERS {
            let mut order: Vec<usize> = (0..members.len()).collect();
            shuffle(&mut order, generator);
            let mut before = 0.0;
            for member in order {
                let volume = volumes[members[member]];
                let number: &mut [f64; NUMBERS] = &mut numbers[member];
                number[axis] = (before + volume * fraction(generator)) / total;
                before += volume;
            }
        }
        let variants = self.sample_symmetry().rotations();
        for (index, [choice, far, turn, height, variant]) in members.iter().zip(numbers) {
            let orientation = component.at([choice, far, turn, height]);
            // From 0 to the number of variants, at most 4.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let variant = ((variant * variants.len() as f64) as usize).min(variants.len() - 1);
            orientations[*index] = Orientation::new(variants[variant] * orientation.raw());
        }
    }
}

/// A number in [0, 1) from the upper 53 bits, as many as a double holds.
fn fraction(generator: &mut impl Rng) -> f64 {
    (generator.next_u64() >> 11) as f64 * 2f64.powi(-53)
}

/// Puts items in random order (Fisher and Yates).
pub(crate) fn shuffle<T>(items: &mut [T], generator: &mut impl Rng) {
    for last in (1..items.len()).rev() {
        items.swap(last, below(last + 1, generator));
    }
}

/// A random number below another.
pub(crate) fn below(count: usize, generator: &mut impl Rng) -> usize {
    let product = u128::from(generator.next_u64()) * count as u128;
    #[allow(clippy::cast_possible_truncation)] // Below the count.
    let number = (product >> 64) as usize;
    number
}
